#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Dense packings of disks and spheres by discrete elements, as the samples of Frank, Radjai, Nezamabadi and Delenne,
/// Phys. Rev. E 102 (2020) 022906, section III: polydisperse grains, pressed together isotropically and weakly until
/// they are at rest.
namespace lamella::packing
{

enum class Sizes
{
  Volume,      ///< areas (3D: volumes) spread evenly between the smallest and the largest
  VolumeShare, ///< every diameter fills the same share of the volume: many small grains, few large ones
  Diameter,    ///< diameters spread evenly
};

struct PackingState;

/// The grains' sizes are quantiles of their distribution, the same in every sample; the seed says who has which and
/// where all begin.
struct PackingOptions
{
  int dimension = 2;
  std::int64_t count = 400;
  double meanDiameter = 1e-3; ///< number mean [m]
  double diameterRatio = 2;   ///< largest over smallest
  Sizes sizes = Sizes::Volume;
  double aspect = 2;     ///< edge of the box along the last axis over the other edges
  bool periodic = false; ///< along all axes; otherwise smooth walls
  double friction = 0;   ///< Coulomb's coefficient between grains, and between grains and walls
  double pressure = 1e3; ///< on the walls [Pa]
  /// Pressure over the contact stiffness (3D: times the diameter): about the mean overlap over the diameter.
  double softness = 1e-6;
  /// Ends the compaction at this share of the box, below jamming: grains that do not touch.
  std::optional<double> packingFraction;
  std::uint64_t seed = 1;
  double tolerance = 1e-4; ///< mean net force on a grain over the mean contact force, at rest
  /// Called often with 0 … 1, which never falls, and with what is done.
  std::function<void(double share, const char* stage)> progress;
  std::function<bool()> interrupted; ///< asked now and then; true ends it with Cancelled
  /// Steps of relaxation from one state on the way to the next; 0: none is told. The packing is the same, to the bit.
  std::int64_t every = 0;
  std::function<void(const PackingState&)> state; ///< called with each; the end is what pack() returns
};

/// Two grains, or a grain and a wall, that press on each other.
struct Contact
{
  std::int32_t first = 0;
  std::int32_t second = 0; ///< another grain, or −1 … −6: the walls at low x, high x, low y, high y, low z, high z
  std::array<double, 3> branch{}; ///< from the first grain's centre to the second's, or to the wall [m]
  std::array<double, 3> normal{}; ///< unit vector from the first to the second
  std::array<double, 3> force{};  ///< on the second by the first [N]; in 2D per metre of thickness [N/m]
  double overlap = 0;             ///< [m]
};

struct Packing
{
  int dimension = 2;
  std::array<double, 3> size{ 0, 0, 0 }; ///< edges of the box, from the origin [m]; size[2] = 0 in 2D
  std::array<bool, 3> periodic{ false, false, false };
  std::vector<std::array<double, 3>> centre; ///< #grains; z = 0 in 2D [m]
  std::vector<double> radius;                ///< #grains [m]
  std::vector<Contact> contacts;
  double pressure = 0;               ///< mean stress [Pa]
  double unbalanced = 0;             ///< mean net force on a grain over the mean contact force
  std::int64_t steps = 0;            ///< of all relaxations
  std::vector<std::string> warnings; ///< where it is not all that was asked for

  [[nodiscard]] std::size_t count() const noexcept { return radius.size(); }
  /// Area of the box in 2D [m²], its volume in 3D [m³].
  [[nodiscard]] double volume() const noexcept;
  [[nodiscard]] double grainVolume(std::size_t grain) const noexcept;
};

/// Grains on their way to rest, after so many steps (Packing::steps). Forces are those of the contacts' stiffness,
/// pressure over softness, so that in the first states, where grains still overlap, they are far above the pressure.
/// Attempts that were undone are among the states: from one to the next grains may be where they were before.
struct PackingState
{
  const Packing& packing;
  const char* stage; ///< "compressing", "settling", "turning", "hardening"; with friction "squeezing"
};

/// Presses `count` grains together: from a loose, random start in small steps, each to rest, until they are jammed;
/// then at constant pressure, softly at first, down to the pressure asked for. Each pair of walls carries the same
/// pressure, so that the stress is isotropic but for shear, and the aspect is kept to ± 1 %: where it drifted the
/// grains are sheared back and relaxed again. Where contacts or stress are more than 3 % anisotropic, small regions are
/// turned by 90° and relaxed again, until they are not; of some hundred grains or fewer the best of six attempts is
/// taken. With friction the shape is kept instead, and the axes' stresses differ by several per cent.
///
/// One thread; the same options give the same bytes. 400 disks take a fifth of a second, some three quarters;
/// 1000 spheres ten.
/// @throws ParameterError: values outside their range (says which), a packing fraction that jams before it is reached
/// (says where); DivergenceError when it does not come to rest; Cancelled
[[nodiscard]] Packing pack(const PackingOptions& options);

/// Packs one sample a seed, `threads` at once. The order is that of the seeds. No states are told.
/// @throws as pack(), for the first seed that fails
[[nodiscard]] std::vector<Packing> packMany(
  const PackingOptions& options, std::span<const std::uint64_t> seeds, int threads);

/// A packing of somebody else: centres and radii [m], (#grains) each. Grains that overlap or are nearer than
/// `touching` × the mean diameter are in contact, without a force.
/// @param size edges of the box; none: that of the grains, moved to the origin
/// @throws InputError: no grain, a radius that is not positive, a number that is not finite, grains outside a given
/// box, two that overlap by more than 2 % of the smaller one's diameter; says which, counting from 1
[[nodiscard]] Packing packingOf(int dimension, std::span<const std::array<double, 3>> centre,
  std::span<const double> radius, std::optional<std::array<double, 3>> size = {}, double touching = 1e-3);

struct PackingStatistics
{
  double packingFraction = 0; ///< share of the box that is grains
  double aspect = 0;
  std::int64_t rattlers = 0;      ///< grains that nothing holds: fewer than dimension + 1 contacts (friction: 2), again
                                  ///< and again without those found
  std::int64_t grainContacts = 0; ///< between grains that are no rattlers
  std::int64_t wallContacts = 0;
  double coordination = 0;           ///< contacts a grain that is no rattler
  std::array<double, 9> fabric{};    ///< mean of n ⊗ n over the contacts between grains; trace 1
  std::array<double, 9> stress{};    ///< Σ f ⊗ r / volume, compression positive [Pa]
  double fabricAnisotropy = 0;       ///< of the principal values, (largest − smallest)/sum
  double stressAnisotropy = 0;       ///< 0 without forces
  std::vector<std::uint8_t> rattler; ///< #grains: 1 for rattlers
};

[[nodiscard]] PackingStatistics statistics(const Packing& packing, bool friction = false);

} // namespace lamella::packing
