#pragma once

#include "peridynamics/Loading.h"
#include "peridynamics/fracture/Dynamics.h"
#include "peridynamics/fracture/Fracture.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

/// Strength as the papers compute it: a sample between platens under a slow pull, in damped motion.
namespace lamella::peridynamics
{

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

/// Pulls a sample until it is broken. Both platens move, so that the middle stands still: half the drag. Collective.
/// @param bonds loses those that break
/// @param loading Stretch or Shear; its strain gives the sign and no more
/// @throws ParameterError: other loads, a strain rate that is not positive, a strain to start at that is negative; as
/// applyLoading(), Equilibrium and BondDynamics
[[nodiscard]] DampedPullRecord pullApart(BondLattice& bonds, const Loading& loading, const DampedPullOptions& options);

/// Of a wave from platen to platen [s]. @param modulus of the sample [Pa]
[[nodiscard]] double travelTime(double length, double modulus, double density) noexcept;

} // namespace lamella::peridynamics
