#pragma once

#include "core/Communicator.h"
#include "io/Checkpoint.h"
#include "mpm/BackgroundGrid.h"
#include "mpm/GridWalls.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PointLaw.h"
#include "mpm/PointRanks.h"
#include "mpm/WaveFactor.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/// The material point method, explicit in time (Sulsky, Zhou and Schreyer, Comput. Phys. Commun. 87 (1995) 236; the
/// first paper, section 3.2): points carry everything, the grid is laid anew every step.
namespace lamella::mpm
{

enum class Shape : std::uint8_t
{
  Linear, ///< the paper's
  Gimp,   ///< uniform generalised interpolation
  QuadraticSpline
};

/// How points get their velocity back from the grid.
enum class Transfer : std::uint8_t
{
  Flip, ///< v += S Δv; keeps every energy, noise too
  Pic,  ///< v = S v; damps
  Apic, ///< PIC, and points carry the velocity's gradient (Jiang et al., ACM Trans. Graph. 34 (2015) 51): keeps momenta
  Xpic  ///< FLIP less what the grid does not see (Hammerquist and Nairn, Comput. Methods Appl. Mech. Eng. 318 (2017)
        ///< 724)
};

enum class MassMatrix : std::uint8_t
{
  Lumped,
  Consistent ///< by terms of the series M⁻¹ = Σ (1 − M_L⁻¹ M)ᵏ M_L⁻¹ (Nairn and Hammerquist, Comput. Methods Appl.
             ///< Mech. Eng. 377 (2021) 113679): M alone can be singular, since points may be fewer than nodes
};

/// Of the points' state while they move on the fast path; what nodes sum up is double.
enum class Precision : std::uint8_t
{
  Double,
  Single
};

enum class StressUpdate : std::uint8_t
{
  Last,        ///< with the velocities that moved the points (USL)
  ModifiedLast ///< with those that the points give back to the grid (MUSL)
};

/// An end of an axis.
struct Side
{
  Edge edge = Edge::Open;
  double position = 0;   ///< of a wall, or of the ends of the first period [m]
  double velocity = 0;   ///< of a wall along the axis; of an upper periodic end: how fast the period grows [m/s]
  bool straight = false; ///< no force: its velocity is found; also the rate of a period
  bool sticks = false;   ///< a wall that does not let slide
  double friction = 0;   ///< Coulomb's coefficient of a wall that is neither straight nor sticks, 0 or above
};

template <int Dim>
struct PointDynamicsOptions
{
  double spacing = 0; ///< of the grid [m]; between walls the nearest that divides their distance
  std::array<std::array<Side, 2>, Dim> sides{};
  /// What is not joined; its densities are found. Like friction, with lumped mass only.
  Bodies bodies{};
  Shape shape = Shape::QuadraticSpline;
  Transfer transfer = Transfer::Apic;
  int xpicOrder = 2; ///< m ≥ 1; 1 is PIC
  MassMatrix mass = MassMatrix::Lumped;
  int massTerms = 20; ///< of the consistent mass, at least 1; 1 is lumped
  StressUpdate update = StressUpdate::Last;
  /// Takes the fused kernels for quadratic splines, lumped mass, USL and APIC with no `acceleration`; the same to
  /// round-off.
  bool fused = true;
  Precision precision = Precision::Double; ///< Single: with the fused kernels only
  std::optional<double> step{}; ///< [s]; none: `share` times the largest stable one, followed as the body deforms
  double share = 0.9;           ///< 0 … 1
  Vector<Dim> gravity{};        ///< [m/s²]
  /// Acceleration by body forces, of the point with a number, at a time [m/s²].
  std::function<Vector<Dim>(std::uint32_t id, double time)> acceleration{};
  /// Some times a second, and every hundred steps at least; true asks to stop. The constructor asks too, of step 0.
  std::function<bool(std::int64_t step, double time)> progress{};
  /// Ranks that share the points; several take lumped mass and PIC or APIC only. Options are the same on all, but for
  /// `progress`, which each may have: one that asks is enough.
  Communicator comm{};
};

/// [J], [J/m] in 2D.
struct PointEnergies
{
  double kinetic = 0;  ///< half a step ago, what the affine velocities hold included
  double elastic = 0;  ///< now
  double supplied = 0; ///< by walls and body forces since the start
  double initial = 0;  ///< kinetic and elastic at the start
  double plastic = 0;  ///< work that walls have taken that yield, of what was dissipated
  /// What was dissipated, by the transfer or by flow; error of second order in the step included.
  [[nodiscard]] double dissipated() const noexcept { return initial + supplied - kinetic - elastic; }
};

template <int Dim>
class FusedStep;
enum class Look : std::uint8_t;

/// On several ranks everything that is not a plain look at a member is collective; errors are thrown by all.
template <int Dim>
class PointDynamics
{
public:
  /// @param points their velocities are those of time 0. Of several ranks together: all on one rank or some on each, no
  /// two with one number. With the first step each point goes to the rank in whose slab of the grid it is.
  /// @throws ParameterError: options outside their range; a step above the stable one, which it names; fewer than three
  /// cells between walls; a law with fewer phases than the points have; several ranks and a transfer or mass that they
  /// do not take, or fewer than four rows of cells each; friction below 0, or with walls that are straight or stick, or
  /// with a consistent mass
  /// @throws InputError: no points, or points without mass or volume, outside the walls, or not finite
  /// @throws Cancelled: progress() asked to stop
  PointDynamics(
    MaterialPoints<Dim> points, std::shared_ptr<const PointLaw<Dim>> law, PointDynamicsOptions<Dim> options);
  ~PointDynamics();
  PointDynamics(const PointDynamics&) = delete;
  PointDynamics& operator=(const PointDynamics&) = delete;

  /// @param energies whether energies() will be asked for: the last step then sums them up, at a fraction of what it
  /// costs to find them point by point
  /// @return false when progress() asked to stop
  /// @throws DivergenceError: what is no longer finite, turned inside out or out of the grid; a given step that the
  /// deformed body makes unstable. Names the step.
  bool advance(std::int64_t steps, bool energies = false);
  /// To a time [s], by as many equal steps as it takes.
  bool advanceTo(double time, bool energies = false);
  /// Of a wall or a period, from now on [m/s].
  void setVelocity(int axis, int side, double velocity);
  /// Multiplies all velocities, those of walls and periods too; the kinetic energy that this brings counts as supplied.
  void scaleVelocities(double factor);
  /// Adds to the velocities those of an even stretching along an axis, rate (x − still); walls keep theirs. The kinetic
  /// energy counts as supplied.
  /// @param rate [1/s] @param still where nothing is added [m]
  void addStretching(int axis, double rate, double still);
  /// Multiplies what velocities differ by from those of an even stretching: friction against a frame that deforms
  /// evenly, which dissipates.
  void calm(double factor, int axis, double rate, double still);

  /// In the order of cells where the step is fused: id() tells which is which. Beyond the ends of a period by a quarter
  /// of a cell at most. This rank's.
  [[nodiscard]] const MaterialPoints<Dim>& points() const noexcept { return points_; }
  /// The affine velocity C of a point [1/s], which those of a fused step do not have themselves.
  [[nodiscard]] Matrix<Dim> affine(std::size_t p) const;
  /// Those of all ranks in the order of their numbers, each with its C, on rank 0; none on the others.
  [[nodiscard]] MaterialPoints<Dim> gather() const;
  /// Those whose numbers are from this rank's of `firsts` to the next one's, in no order. @param firsts as PointRanks
  /// takes them
  [[nodiscard]] MaterialPoints<Dim> byNumber(std::span<const std::int64_t> firsts) const
  {
    return ranks_.byNumber(points_, firsts);
  }
  [[nodiscard]] const BackgroundGrid<Dim>& grid() const noexcept { return grid_; }
  /// Velocities and forces of the last step.
  [[nodiscard]] const Wall& wall(int axis, int side) const { return walls_(axis, side); }
  [[nodiscard]] double time() const noexcept { return time_; } ///< [s]
  [[nodiscard]] std::int64_t steps() const noexcept { return step_; }
  /// The last one, or before it the one to come [s].
  [[nodiscard]] double step() const noexcept { return before_ > 0 ? before_ : dt_; }
  [[nodiscard]] double pace() const noexcept { return dt_; } ///< the step to come, where no time is to be hit [s]
  /// The largest stable step for the body as it is [s]: 2/ω, ω² = κ a/(ρ₀ h²) at the stiffest point, a its stiffness.
  /// κ with quadratic splines and lumped mass: the largest WaveFactor seen so far and 7 % more, times 1.5
  /// where the transfer smooths velocities (all but FLIP), at least 4.5; it is measured at the start and every two
  /// thousand steps. Else 6, and half the step with a consistent mass, which has no such bound, nor have linear shapes.
  [[nodiscard]] double stableStep() const;
  [[nodiscard]] PointEnergies energies() const;
  /// Momentum that the body gave to a wall, along its axis, since the start [N s], [N s/m] in 2D.
  [[nodiscard]] double impulse(int axis, int side) const
  {
    return impulse_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
  }
  /// Where a wall, or an end of a period, is now [m].
  [[nodiscard]] double position(int axis, int side) const
  {
    return options_.sides[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)].position;
  }
  /// Volume of the points now over their volume at the start, both summed [m³], [m²] in 2D.
  [[nodiscard]] std::array<double, 2> volumes() const;

  /// Puts all that goes on from one step to the next into a checkpoint, which changes nothing: a run that takes it back
  /// goes on as this one, to the last bit. Of several ranks rank 0's has the points, in the order of their numbers, and
  /// it is to round-off that runs are the same; they may go on on another number of ranks. On one rank the points must
  /// stay as they are until the checkpoint is written, or holds them (Checkpoint::hold()): they go into it from here.
  void keep(io::Checkpoint& checkpoint) const;
  /// Sorts its points by cells before the next step.
  void sortAnew();
  /// @param checkpoint the whole of it on every rank
  /// @throws InputError where it is of other points
  void takeBack(const io::Checkpoint& checkpoint);
  [[nodiscard]] bool fused() const noexcept { return fused_ != nullptr; }

private:
  void check() const;
  /// Points of all ranks are to store C, or none; and none but where it is used.
  void shareAffines();
  void checkContact(std::size_t phases) const;
  [[nodiscard]] std::vector<double> densities() const; ///< of the bodies. Collective
  /// Cells where the walls are now; of open axes where the points are, unless `keep`.
  void layGrid(bool keep);
  [[nodiscard]] GridAxis layAxis(int a, bool keep) const;
  void moveWalls(double dt);
  void wrap();
  /// Largest component of the points' velocity gradients [1/s]; 0 where the transfer has none.
  [[nodiscard]] double fastestStrain() const;
  [[nodiscard]] bool stops() const; ///< whether progress() of any rank asks to. Collective
  // false where that asked to stop on the way: all is as before then
  bool measureFactor();
  bool chooseStep();
  bool run(std::int64_t steps, double dt, bool energies);
  void generalStep(double dt, double kick);
  /// Points to their ranks and cells, and what they have to the nodes.
  void prepare(double kick);
  /// @param keep whether anyone may look at the points before the next step
  void fusedStep(double dt, double kick, bool keep, Look look);
  void noteLooked(Look look);
  void addWork(double kick);
  [[nodiscard]] double stiffest() const;      // stiffness over density [m²/s²]; infinite where one is not finite
  [[nodiscard]] double gravityMoment() const; // of this rank
  [[nodiscard]] double kineticEnergy() const;
  [[nodiscard]] double elasticEnergy() const;
  /// Velocities become keep (v − w) + w + add w, w those of the stretching. @return kinetic energy gained
  double changeVelocities(double keep, double add, int axis, double rate, double still);
  /// f(point) over all points of all ranks, in blocks, so that it is the same for any number of threads.
  template <class F>
  [[nodiscard]] double sumOver(F&& f) const;
  [[nodiscard]] double plasticWork() const;
  [[nodiscard]] std::array<double, 2> extent(int a) const;

  MaterialPoints<Dim> points_;
  std::shared_ptr<const PointLaw<Dim>> law_;
  PointDynamicsOptions<Dim> options_;
  BackgroundGrid<Dim> grid_;
  Walls<Dim> walls_;
  PointRanks<Dim> ranks_;
  std::int64_t count_;                    ///< of all ranks
  std::unique_ptr<FusedStep<Dim>> fused_; ///< none: the general step
  bool walled_ = true;                    ///< all round: no point may have to be taken to another place or grid
  double time_ = 0;
  double dt_ = 0;
  double before_ = 0; ///< the step before; 0 at the start: velocities are then those of the same time
  std::int64_t step_ = 0;
  double supplied_ = 0;
  double initial_ = 0;
  WaveFactor<Dim> measured_;
  double factor_ = 0;       ///< κ
  std::int64_t looks_;      ///< steps from one call of progress() to the next
  std::int64_t evenTo_ = 0; ///< steps up to which advanceTo() takes equal ones, also where it was stopped on the way
  double evenStep_ = 0;
  double startMoment_ = 0; ///< Σ m g·x at the start [J], this rank's share
  /// What a fused step has summed up, of all ranks.
  struct Looked
  {
    // numbers of steps after which they hold; −1: never
    std::int64_t stiffestAt = -1;
    std::int64_t elasticAt = -1;
    std::int64_t kineticAt = -1; ///< until velocities are changed
    double kinetic = 0;
    double elastic = 0;
    double stiffest = 0; ///< as stiffest() gives it
  };
  Looked looked_;
  std::array<std::array<double, 2>, Dim> impulse_{};
};

extern template class PointDynamics<2>;
extern template class PointDynamics<3>;

} // namespace lamella::mpm
