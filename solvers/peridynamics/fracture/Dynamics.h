#pragma once

#include "core/Clock.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/fracture/FractureCheckpoint.h"
#include "peridynamics/fracture/LoadingRate.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/// Bonds in motion: velocity Verlet with the nonlinear force, bonds that break as they reach their critical elongation,
/// and every energy accounted for.
namespace lamella::peridynamics
{

/// The energies of a sample [J], [J/m in 2D], all ranks together.
struct EnergyBalance
{
  double kinetic = 0;
  double elastic = 0;
  double broken = 0;   ///< that bonds held when they broke, since the start
  double damped = 0;   ///< lost to viscous damping, since the start
  double supplied = 0; ///< by moved nodes and loads, since the start
  double initial = 0;  ///< kinetic and elastic at the start

  /// What is missing, over the largest of the terms: 0 for an exact integration. It falls with the square of the step.
  [[nodiscard]] double defect() const noexcept;
};

struct DynamicsProgress
{
  std::int64_t step = 0;
  double time = 0; ///< [s]
  std::int64_t broken = 0;
  std::int64_t checkpoint = 0; ///< steps in the last file that was written; 0: none yet
};

struct DynamicsOptions
{
  double density = 1000; ///< of all that is solid [kg/m³]
  /// Of each node instead, one component [kg/m³]; 0 in voids. The rim need not be filled.
  std::optional<NodeField<double>> densities{};
  /// [s]; none: `safety` times the largest stable one.
  std::optional<double> step{};
  double safety = 0.8; ///< 1e-5 … 1
  /// Refuses a step above the stable one; false only to study what becomes of it: bonds that break at random, and
  /// energy out of nothing, which advance() names.
  bool checkStep = true;
  /// Viscous force −ν u̇ on every node, ν as a share of the least critical viscosity √(2 m k/|ξ|) of its bonds (second
  /// paper, appendix A): 0 none, at most 1.
  double damping = 0;
  bool breaking = true;
  /// Makes the imposed velocities follow what breaks; none: they are constant.
  std::optional<RegulatedRate> rate{};
  /// Called between steps, every hundred at least; true asks to stop.
  std::function<bool(const DynamicsProgress&)> progress{};
  double progressEvery = 0.05; ///< from one call to the next, about; 0: after every step [s]
  /// After every so many steps, a thousand where it does not say; and where progress() asks to stop, which is called
  /// once more then to be told so.
  CheckpointOptions checkpoint{};
  std::filesystem::path continueFrom{}; ///< a checkpoint of the same scene; empty: at rest, undeformed
  /// Called on every rank with a checkpoint that is about to be written, to put more into it, and with the one that the
  /// motion goes on from.
  std::function<void(io::Checkpoint&)> keepWith{};
  std::function<void(const io::Checkpoint&)> takeBack{};
};

/// A bond that broke, and when.
struct DynamicBreak
{
  Bond bond;
  std::int64_t step = 0;
  double time = 0;   ///< [s]
  double energy = 0; ///< it held [J], [J/m in 2D]
};

/// The largest stable step of velocity Verlet, from below [s]. With Bᵢ = Σ k/|ξ| e ⊗ e over the bonds of node i every
/// frequency is at most ω² = 2 maxᵢ λmax(Bᵢ)/mᵢ, since (e·(uᵢ − uⱼ))² ≤ 2 (e·uᵢ)² + 2 (e·uⱼ)²; the step is 2/ω.
/// Tension raises frequencies by its strain, compression by none. Collective.
/// @param mass of a node [kg], [kg/m in 2D]
[[nodiscard]] double stableStep(const BondLattice& bonds, double mass);
/// @param masses of the nodes, one component, above 0 where there is matter
[[nodiscard]] double stableStep(const BondLattice& bonds, const NodeField<double>& masses);

class BondDynamics
{
public:
  /// At rest, undeformed; or as it was when DynamicsOptions::continueFrom was written, velocities and loads included:
  /// it then goes on to the last bit as if it had not stopped, on as many ranks as wrote it.
  /// @param bonds not broken yet, also when it goes on; loses the bonds that break; must outlive this
  /// @param fixed components that move as told (setVelocities) or not at all
  /// @throws ParameterError: options outside their range; a step above the stable one, which it names; no solid node
  /// @throws InputError: a checkpoint of another scene, cut off, damaged or newer; a place where none can be written
  /// Memory: 8 · 3 · dimension bytes a node beside the bonds, rim and padding included.
  BondDynamics(BondLattice& bonds, FixedComponents fixed, DynamicsOptions options);
  BondDynamics(const BondDynamics&) = delete;
  BondDynamics& operator=(const BondDynamics&) = delete;

  /// The state to start from: displacements [m] and velocities [m/s] of all nodes; of fixed components the velocity is
  /// the one that they keep, times the regulated rate where there is one. The balance of energy begins anew.
  void setState(const NodeField<double>& displacement, const NodeField<double>& velocity);
  /// Forces on the nodes from now on [N], [N/m in 2D].
  void setLoad(NodeField<double> load);

  /// @return false when progress() asked to stop: after any step, and with a checkpoint of it where there are any
  /// @throws DivergenceError: displacements that are no longer finite, or energy that grows out of nothing; names the
  /// step
  bool advance(std::int64_t steps);

  [[nodiscard]] double step() const noexcept { return dt_; }       ///< [s]
  [[nodiscard]] double stable() const noexcept { return stable_; } ///< the largest stable step [s]
  [[nodiscard]] double viscosity() const noexcept { return nu_; }  ///< ν [kg/s], [kg/(m s) in 2D]
  [[nodiscard]] double time() const noexcept { return time_; }     ///< [s]
  [[nodiscard]] std::int64_t steps() const noexcept { return step_; }
  [[nodiscard]] std::int64_t checkpoints() const noexcept { return checkpoints_; }   ///< written
  [[nodiscard]] std::int64_t checkpointAt() const noexcept { return checkpointAt_; } ///< steps in the last; 0: none
  /// Of a node of DynamicsOptions::density [kg], [kg/m in 2D].
  [[nodiscard]] double mass() const noexcept { return mass_; }
  /// Of the imposed velocities: 1 without regulation.
  [[nodiscard]] double rate() const noexcept { return rate_ ? rate_->rate() : 1; }
  [[nodiscard]] const NodeField<double>& displacement() const noexcept { return u_; }
  [[nodiscard]] const NodeField<double>& velocity() const noexcept { return v_; } ///< at the time of displacement()
  /// Of the bonds on the nodes, at the time of displacement() [N], [N/m in 2D]; own nodes.
  [[nodiscard]] const NodeField<double>& force() const noexcept { return f_; }
  /// In the order of steps; the same on every rank, bonds of a step in order.
  [[nodiscard]] const std::vector<DynamicBreak>& broken() const noexcept { return broken_; }
  [[nodiscard]] EnergyBalance energies() const;

private:
  struct Sums
  {
    double supplied = 0;
    double damped = 0;
  };
  bool forces(); ///< are bonds critical?
  void breakCritical();
  template <class F>
  void forEachRow(F&& f);
  void halfKick(bool first);
  void drift();
  void guard();
  [[nodiscard]] DynamicsProgress progress() const;
  bool stops();
  [[nodiscard]] std::string scene() const;
  void save();
  void restore();

  BondLattice& bonds_;
  FixedComponents fixed_;
  DynamicsOptions options_;
  double mass_ = 0;
  std::optional<NodeField<double>> masses_; ///< where they are not all alike, rim filled
  double stable_ = 0;
  double dt_ = 0;
  double nu_ = 0;
  double time_ = 0;
  std::int64_t step_ = 0;
  io::CheckpointPace pace_;
  std::int64_t checkpoints_ = 0;
  std::int64_t checkpointAt_ = 0;
  Clock::time_point lookedAt_ = Clock::now(); ///< when progress() was called last
  std::int64_t lookedStep_ = 0;               ///< likewise
  std::int64_t lookStep_ = 0;                 ///< after which it is to be called again
  NodeField<double> u_;
  NodeField<double> v_;
  NodeField<double> f_;
  std::optional<NodeField<double>> load_;
  std::optional<NodeField<double>> imposed_; ///< velocities of fixed components at a rate of 1
  std::optional<RegulatedRate> rate_;
  std::vector<DynamicBreak> broken_;
  Sums sums_; ///< of this rank
  double brokenEnergy_ = 0;
  double initial_ = 0;
  mutable std::optional<EnergyBalance> balance_; ///< of this step and state, where it is known
  std::string scene_;                            ///< of the unbroken sample; empty where no file needs it
};

} // namespace lamella::peridynamics
