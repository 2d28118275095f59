#pragma once

#include "peridynamics/Loading.h"
#include "peridynamics/fracture/Dynamics.h"
#include "peridynamics/fracture/Fracture.h"
#include "peridynamics/fracture/PlatenForce.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

/// Strength as the second paper computes it: a sample between platens under a slow pull, in damped motion.
namespace lamella::peridynamics
{

/// A sample in the midst of a slow pull: in the equilibrium of small strains, with the speeds that the pull would have
/// given it. Both platens move, so that the middle stands still: half the drag.
class SlowPull
{
public:
  /// Collective. @param bonds not broken yet; must outlive this
  /// @param loading Stretch or Shear; its strain gives the sign and no more
  /// @param progress as EquilibriumOptions
  /// @throws ParameterError: other loads; as applyLoading() and Equilibrium
  SlowPull(const BondLattice& bonds, const Loading& loading, std::function<bool(double)> progress = {});

  [[nodiscard]] int axis() const noexcept { return axis_; }
  /// Component of displacement and force along which the platens move.
  [[nodiscard]] int along() const noexcept { return along_; }
  [[nodiscard]] const LoadedSample& sample() const noexcept { return sample_; }
  [[nodiscard]] double area() const noexcept { return force_.area(); } ///< of the section [m²], [m] in the plane
  [[nodiscard]] double modulus() const noexcept { return modulus_; }   ///< stress over strain, unbroken [Pa]
  /// Strain at which the first bond breaks; infinite where none does.
  [[nodiscard]] double firstBreak() const noexcept { return firstBreak_; }
  /// At a strain of one [m], rim filled.
  [[nodiscard]] const NodeField<double>& unit() const noexcept { return unit_; }
  [[nodiscard]] NodeField<double> displacement(double strain) const; ///< [m]
  [[nodiscard]] NodeField<double> velocity(double strainRate) const; ///< [m/s] @param strainRate [1/s]
  /// Mean force on both platens over the section, positive along the pull [Pa]. Collective.
  /// @param force on every node, those of the platens included
  [[nodiscard]] double stress(const NodeField<double>& force) const { return force_.of(bonds_, force) / area(); }

private:
  const BondLattice& bonds_;
  Loading loading_;
  int axis_;
  int along_;
  LoadedSample sample_;
  PlatenForce force_;
  NodeField<double> unit_;
  std::array<double, 3> centre_{}; ///< what the middle moves at a strain of one
  double modulus_ = 0;
  double firstBreak_ = 0;
};

struct DampedPullOptions
{
  double density = 1000; ///< sets the unit of time, no more [kg/m³]
  /// [1/s]. Drag makes the strength too great, by about 0.8 r/n of it: n travel times of a wave from platen to platen
  /// until the peak, r the damping over the critical one of the slowest wave; see travelTime().
  double strainRate = 1;
  double damping = 0.1; ///< DynamicsOptions::damping
  double safety = 0.8;  ///< DynamicsOptions::safety
  /// Starts at this strain, in the equilibrium of small strains and with the speeds that the pull would have given it.
  /// Below that of the first break.
  double startStrain = 0;
  double stopShare = 0.05; ///< ends when the stress has fallen to this share of the peak
  double maxStrain = std::numeric_limits<double>::infinity(); ///< ends at this strain at the latest
  /// Makes the pull follow what breaks; start it at a rate of 1.
  std::optional<RegulatedRate> rate{};
  std::int64_t every = 10;                                 ///< steps between two points of the curve
  std::function<bool(const DynamicsProgress&)> progress{}; ///< as DynamicsOptions
};

struct DampedPullRecord
{
  FractureEnd end = FractureEnd::Running; ///< StressFell, MaxStrain or Interrupted
  std::vector<DynamicBreak> broken;
  std::vector<CurvePoint> curve; ///< every DampedPullOptions::every steps; stress by the mean force on both platens
  CurvePoint peak;
  double kineticShare = 0; ///< of the elastic energy, at the peak
  std::int64_t steps = 0;
  double step = 0;      ///< [s]
  double viscosity = 0; ///< ν [kg/s], [kg/(m s) in 2D]
  EnergyBalance energies;
  NodeField<double> startVelocity; ///< [m/s]
};

/// Pulls a sample until it is broken, as SlowPull begins it. Collective.
/// @param bonds loses those that break
/// @param loading Stretch or Shear; its strain gives the sign and no more
/// @throws ParameterError: other loads, a strain rate that is not positive, a strain to start at that is negative; as
/// applyLoading(), Equilibrium and BondDynamics
[[nodiscard]] DampedPullRecord pullApart(BondLattice& bonds, const Loading& loading, const DampedPullOptions& options);

/// Of a wave from platen to platen [s]. @param modulus of the sample [Pa]
[[nodiscard]] double travelTime(double length, double modulus, double density) noexcept;

} // namespace lamella::peridynamics
