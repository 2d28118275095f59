#pragma once

#include "io/RunCheckpoint.h"
#include "mpm/PointDynamics.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// A specimen of material points pressed between two platens, quasi-statically and honestly so (the first paper,
/// sections 3.2 and 4.2): the explicit method in time, at a speed that keeps the kinetic energy small beside the
/// elastic one, and says by how much.
namespace lamella::mpm
{

/// Both ends of the axes across the pressed one.
enum class LateralSides : std::uint8_t
{
  Straight, ///< walls that stay straight and move so that the force on them is nothing: the paper's
  Open,
  Fixed,   ///< walls that stay where they are and let slide
  Periodic ///< a period that grows so that there is no mean stress
};

template <int Dim>
struct CompressionOptions
{
  int axis = 1;                    ///< pressed along
  std::array<double, Dim> lower{}; ///< corners of the specimen's box [m]: platens and sides stand there
  std::array<double, Dim> upper{};
  double strain = 0.48; ///< to end at, 1 − H/H₀, below 1
  LateralSides sides = LateralSides::Straight;
  bool grip = false;         ///< platens do not let slide
  double platenFriction = 0; ///< Coulomb's coefficient of both platens, 0 or above; not with grip

  /// Kinetic over elastic energy that is allowed from strain `calmFrom` on, or from half of `strain` where that is
  /// less; before it (calmFrom/ε)² times as much, which is what a body whose stiffness does not change has at one
  /// speed.
  double energyRatio = 0.01;
  double calmFrom = 0.05;
  /// Of the platens towards each other, over the wave's (CompressionSummary::waveSpeed): where it starts, and what the
  /// control keeps it between. One value for all three: no control.
  double firstSpeed = 1e-3;
  double leastSpeed = 5e-5;
  double mostSpeed = 2e-2;
  bool affineStart = true; ///< begins with the velocities of an even stretching, not at rest: no shock
  /// Friction against a frame that deforms evenly: 1/s, over the lowest circular frequency π c/H of a bar of the wall's
  /// material as high as the specimen. 0: none.
  double damping = 0;

  int rows = 240;                  ///< of the stress-strain table, evenly over the strain
  std::vector<double> atStrains{}; ///< strains at which state() is called
  std::function<void(double strain)> state{};
  /// Share of the strain done; true asks to stop. Called some times a second, and every few hundred steps at least. The
  /// constructor calls it too, with the share 0.
  std::function<bool(double share)> progress{};

  io::CheckpointOptions checkpoint{}; ///< `every` in steps; looked at every 200 or so
  std::filesystem::path continueFrom{};
  /// How the points move: spacing, bodies, shape, transfer, mass, update, fused, step, share. Its sides, gravity,
  /// acceleration and progress are not used.
  PointDynamicsOptions<Dim> motion{};
};

/// A line of the table. Stresses are forces over the specimen's section at the start, positive in compression, means
/// over the strains up to half a row before and after.
struct CompressionRow
{
  double strain = 0;    ///< 1 − H/H₀
  double stress = 0;    ///< mean of both platens [Pa]
  double imbalance = 0; ///< upper platen's stress less the lower one's [Pa]
  double lateral = 0;   ///< mean stress on the sides, over their present area [Pa]; 0 where they are open or periodic
  double lateralStrain = 0; ///< W/W₀ − 1, mean of the axes across; 0 where the sides are open
  double porosity = 0; ///< 1 − volume of the points over that of the box; over the box at the start across open sides
  double elastic = 0;  ///< [J], [J/m] in 2D
  double kinetic = 0;
  double work = 0;       ///< of the platens
  double dissipated = 0; ///< by the method, by damping, by walls that yield
  double speed = 0;      ///< of the platens towards each other, over the wave's
  double steps = 0;
  double time = 0;    ///< [s]
  double plastic = 0; ///< work of walls that yield, of what was dissipated
};

struct CompressionSummary
{
  double strain = 0; ///< reached
  bool finished = false;
  double calmFrom = 0;       ///< strain from which the energy ratio is kept: the one given, or half of the last
  double worstRatio = 0;     ///< of kinetic over elastic energy at the rows from calmFrom on
  double worstRatioAt = 0;   ///< strain
  double earlyRatio = 0;     ///< the same at the rows before it, whose first ones have next to no elastic energy
  double earlyRatioAt = 0;   ///< strain
  double worstLateral = 0;   ///< |mean stress on the sides| over the axial stress from calmFrom on
  double worstImbalance = 0; ///< |difference| of the platens' stresses over their mean from calmFrom on
  /// That speeds are over: the fastest wave in the wall at the start, or √8 times the slowest of its material where
  /// that is less, as where it hardly changes its volume [m/s].
  double waveSpeed = 0;
  std::int64_t steps = 0;
  std::int64_t slowdowns = 0; ///< times that the control took speed away
  std::int64_t checkpoints = 0;
  std::int64_t lastCheckpoint = 0; ///< steps in it; 0: none
  double firstTouch = 0;           ///< strain of the first row with stress
  std::vector<std::string> warnings;
};

/// On several ranks (`motion.comm`) run() and the constructor are collective, and rows and summary the same on all;
/// state() is called by all.
template <int Dim>
class PointCompression
{
public:
  /// @param points at rest, inside the box; of several ranks together, as PointDynamics takes them
  /// @throws ParameterError: strain not above 0 and below 1, ratios, speeds or rows outside their range, a box without
  /// extent, and what PointDynamics refuses
  /// @throws InputError: points that touch no platen; what io::readCheckpoint() refuses
  /// @throws Cancelled: progress() asked to stop
  PointCompression(
    MaterialPoints<Dim> points, std::shared_ptr<const PointLaw<Dim>> law, CompressionOptions<Dim> options);
  ~PointCompression();
  PointCompression(const PointCompression&) = delete;
  PointCompression& operator=(const PointCompression&) = delete;

  /// To the end. @return false when progress() asked to stop; a checkpoint then stands where one was asked for, and the
  /// run has made a step: before the first there is nothing that a new run would not have too
  /// @throws DivergenceError as PointDynamics::advance()
  bool run();

  [[nodiscard]] const std::vector<CompressionRow>& rows() const noexcept { return rows_; }
  [[nodiscard]] CompressionSummary summary() const;
  [[nodiscard]] const PointDynamics<Dim>& body() const noexcept { return *body_; }
  [[nodiscard]] double strain() const; ///< now

private:
  void check() const;
  void checkTouch(const MaterialPoints<Dim>& points) const; ///< collective
  /// What a checkpoint is of, the same text on all ranks. Collective.
  [[nodiscard]] std::string scene(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law) const;
  bool advance(double strain);
  [[nodiscard]] bool stops() const; ///< whether progress() of any rank asks to. Collective
  void control();
  void press(double speed);
  void openRow();
  void measure();
  void closeRow();
  void save();
  void restore();
  [[nodiscard]] double allowed(double strain) const;
  [[nodiscard]] double calmFrom() const;

  CompressionOptions<Dim> options_;
  std::string scene_; ///< where checkpoints are written or read
  std::unique_ptr<PointDynamics<Dim>> body_;
  std::vector<CompressionRow> rows_;
  CompressionRow row_{};
  std::array<double, 2 * Dim + 1> from_{}; ///< impulses and the time where the row began
  double height_ = 0;
  double area_ = 0;           ///< section at the start [m²], [m] in 2D
  double wave_ = 0;           ///< [m/s]
  double speed_ = 0;          ///< over the wave's
  std::int64_t halfRows_ = 0; ///< gone through
  std::int64_t slowdowns_ = 0;
  std::int64_t checkpoints_ = 0;
  io::CheckpointPace pace_;
  std::int64_t lookAt_ = 0;    ///< steps at which the control looks next; not yet known where that is not beyond now
  double until_ = 0;           ///< time to which the body goes where there is no look on the way [s]; 0: not yet known
  std::int64_t sortedAt_ = 0;  ///< steps where the points were sorted for good measure
  std::int64_t savedAt_ = 0;   ///< steps where a file was written last, or could have been
  std::int64_t writtenAt_ = 0; ///< steps where one was
  std::size_t states_ = 0;     ///< called
  std::vector<std::string> warnings_;
};

extern template class PointCompression<2>;
extern template class PointCompression<3>;

} // namespace lamella::mpm
