#pragma once

#include "core/AlignedAllocator.h"
#include "io/Checkpoint.h"
#include "mpm/BackgroundGrid.h"
#include "mpm/BodyContact.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PastVelocity.h"
#include "mpm/PointLaw.h"
#include "mpm/kernels/PointKernels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lamella::mpm
{

/// What a step finds besides of the points that it moves.
enum class Look : std::uint8_t
{
  No,
  Stiffness, ///< what the next steps' length is chosen by
  Sums       ///< and the energies
};

/// The fast path of PointDynamics: points sorted by cell, one pass a step from grid to points to the next grid, by the
/// kernels of PointKernels.h. Rows of cells are shared out in tiles, of eight rows in a plane and of eight by eight in
/// space, every other one along each axis at a time, so that no two threads add to a node and the order of every sum is
/// the same whatever their number. Bodies that are not joined follow each other: each has cells, tiles and nodes of its
/// own. The points' affine velocities are not stored after a step: they are had from the grid that it began with.
template <int Dim>
class FusedStep
{
public:
  /// @param points, bodies must outlive this
  /// @param single whether the points' state is moved in single precision: places in their cells and F − I, which are
  /// given back to the points whenever those are sorted, or to be looked at
  FusedStep(MaterialPoints<Dim>& points, const PointLaw<Dim>& law, const Bodies& bodies, const Vector<Dim>& gravity,
    bool single = false);

  /// Whether the nodes hold mass and momentum of the points, and forces over some time.
  [[nodiscard]] bool ready() const noexcept { return held_; }
  /// Where they do: adds what the forces over this time [s] have more.
  void adjust(double kick);
  /// Where ranks share the grid: whether a point is half a cell beyond the rows of this one. One more step can be run,
  /// and has to keep velocities; then the point has to go to the other rank.
  [[nodiscard]] bool leaving() const noexcept { return leaving_; }
  /// Whether one is so far beyond that the nodes do not hold it, and has not kept its velocity.
  [[nodiscard]] bool lost() const noexcept { return lost_; }
  void forget() noexcept { held_ = false; }
  /// Other points have taken the place of those that it knew, with their C.
  void startAnew() noexcept;
  /// C of a point [1/s], which has kept its velocity.
  [[nodiscard]] Matrix<Dim> affine(std::size_t p) const;
  /// The largest component of all, of this rank [1/s].
  [[nodiscard]] double fastest() const;
  /// Has the points store C, as those must that go to other ranks.
  void storeAffines();
  /// Keeps C of points that are about to be taken to the other end of a period.
  void setAside(std::span<const std::size_t> points);
  /// Does to the nodes, and to C, what is done to the points' velocities: v becomes keep v + rate (x − still) along an
  /// axis.
  void change(double keep, int axis, double rate, double still);
  /// Which points lie in which cell, and what the nodes hold: a step that takes it back goes on to the last bit.
  void keep(io::Checkpoint& checkpoint) const;
  /// @param grid that it was kept on; the points in the order that they were kept in. Forgets where the checkpoint has
  /// none of this, or of another grid.
  void takeBack(const io::Checkpoint& checkpoint, const BackgroundGrid<Dim>& grid);
  /// Sorts the points and gives to the grid.
  /// @throws DivergenceError: a point outside the grid, or not finite
  void prepare(const BackgroundGrid<Dim>& grid, double kick);
  /// Mass and momentum, nodeValues a node, of one body after another; to be made velocities before run().
  [[nodiscard]] std::span<double> nodes() noexcept { return nodes_; }
  /// Moves the points by the velocities on the nodes, and gives to the next grid, which has as many nodes.
  /// @param keep whether the points get their velocities, which cost memory traffic and are needed only where they are
  /// looked at or given to a grid anew
  /// @param look what to find of looked() @return whether it was, which single precision is too coarse for
  bool run(
    const BackgroundGrid<Dim>& from, const BackgroundGrid<Dim>& to, double dt, double kick, bool keep, Look look);
  /// Of this rank's points after a step.
  struct Looked
  {
    double kinetic = 0;  ///< energy, of the velocities half a step ago [J], [J/m] in 2D
    double elastic = 0;  ///< energy
    double stiffest = 0; ///< greatest stiffness over density [m²/s²]; infinite where one is not finite
  };
  [[nodiscard]] const Looked& looked() const noexcept { return looked_; }

private:
  /// Of points that are outside of a rank's part of the grid: beyond its ends, across its cuts, or out of reach?
  /// @return whether the nodes are to be given to anew
  bool beyondEnds(const BackgroundGrid<Dim>& grid, bool kept);
  void sort(const BackgroundGrid<Dim>& grid);
  /// @throws DivergenceError: this point is outside
  void throwOutside(const BackgroundGrid<Dim>& grid, std::size_t p) const;
  /// State in single precision from the points, which lie in their cells, and back.
  void pack(const BackgroundGrid<Dim>& grid);
  void unpack(const BackgroundGrid<Dim>& grid);
  /// All of a sweep but the nodes.
  [[nodiscard]] PointSweep jobOf(
    const BackgroundGrid<Dim>& from, const BackgroundGrid<Dim>& to, double dt, double kick);
  void sweep(const PointSweep& job, const BackgroundGrid<Dim>& to, bool whole);
  /// Goes by what a sweep has seen: notes points that are outside, sorts those that are astray.
  void settle(const BackgroundGrid<Dim>& to, double kick, bool whole, bool keep);
  /// Cells of a tile, whose points' C is found first.
  void giveCells(SweepCells kernel, PointSweep& job, std::int64_t first, std::int64_t last) const;

  MaterialPoints<Dim>& points_;
  LawKind kind_;
  const Bodies& bodies_;
  Vector<Dim> gravity_;
  std::vector<double> constants_; ///< phase by phase
  bool onePhase_ = true;
  bool single_;
  double massScale_ = 1; ///< of the state in single precision [kg]
  std::vector<float, AlignedAllocator<float>>
    state_;                         ///< by the columns of StateColumns, each as long as those of the points
  std::vector<PointCell> cells_;    ///< and one behind the last
  std::vector<std::int64_t> tiles_; ///< first cell of each, and one behind the last; of each body as many
  std::vector<double> nodes_;
  std::vector<double> next_;                                 ///< after a step the velocities that it began with
  BackgroundGrid<Dim> grid_;                                 ///< of the nodes
  PastVelocity<Dim> past_;                                   ///< known: C is that of next_; else the points have it
  std::vector<std::pair<std::uint32_t, Matrix<Dim>>> aside_; ///< C of those set aside, by number
  double fastest_ = -1;                                      ///< largest component of C; below 0: not known
  bool held_ = false;                                        ///< whether the nodes hold what the points give
  double kick_ = 0;                                          ///< that they were given forces for
  struct Seen
  {
    std::int64_t strays = 0;
    bool far = false;
    bool outside = false;
  };
  Seen seen_;               ///< by the last sweep
  std::int64_t strays_ = 0; ///< of every step since points were sorted
  Looked looked_;
  bool leaving_ = false;
  bool lost_ = false;
};

extern template class FusedStep<2>;
extern template class FusedStep<3>;

} // namespace lamella::mpm
