#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "pores/Unfilled.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Which nodes of a phase hang together: pores, lumina, grains.
namespace lamella::pores
{

/// Does `body(i)` for i = 0 … count − 1, on as many threads as it likes. An empty one: in turn, here.
using ForEach = std::function<void(int count, const std::function<void(int)>& body)>;
/// Told the share done, 0 to 1, by the calling thread; false stops.
using Progress = std::function<bool(double share)>;

struct LabelOptions
{
  /// 4 (sides) or 8 (and corners) in 2D; 6 (faces), 18 (and edges) or 26 (and corners) in 3D.
  int connectivity = 4;
  std::array<bool, 3> periodic{ false, false, false }; ///< the box goes on at its other end along this axis
  std::int64_t minimumSize = 1;                        ///< smaller pores get no label [nodes]
  bool sortBySize = true; ///< label 1 is the largest; false: in the order of the pores' first nodes in memory
  std::int64_t mostLabels = std::numeric_limits<std::int32_t>::max();
  int slabs = 1; ///< parts that threads may work on at once; the result does not depend on it
  ForEach forEach;
  Progress progress;
};

/// One pore. Nodes are counted from the lattice's first one.
struct Pore
{
  std::int64_t size;  ///< nodes
  std::int64_t first; ///< lowest index in memory of its nodes
  /// Mean of its nodes. Along a periodic axis the pore is put together first, and the mean then moved into the box,
  /// from −½ to n − ½; where it has no end (it percolates), it is the mean of the places in the box.
  std::array<double, 3> centre;
  /// Box, both ends included. Of a pore that goes on over a periodic side `high` is n or more; of one that percolates
  /// along a periodic axis it is the whole axis.
  std::array<std::int32_t, 3> low;
  std::array<std::int32_t, 3> high;
  std::uint8_t touches; ///< bit 2 · axis: has a node in the first layer along it; bit 2 · axis + 1: in the last one
  std::uint8_t percolates; ///< bit axis: leads from the first to the last layer; if periodic: meets itself again
};

/// The same on every rank.
struct PoreSummary
{
  std::int64_t count = 0;        ///< pores with a label
  std::int64_t total = 0;        ///< their nodes
  std::int64_t largest = 0;      ///< nodes of the largest
  std::int64_t phaseNodes = 0;   ///< nodes of the phase, in labelled pores or not
  std::int64_t dropped = 0;      ///< pores below the minimum size
  std::int64_t droppedNodes = 0; ///< their nodes
  std::int64_t largestDropped = 0;
  std::int64_t touching = 0;   ///< labelled pores that are open: touch a border that is not periodic, or percolate
  std::int64_t openNodes = 0;  ///< their nodes
  std::uint8_t percolates = 0; ///< bit axis: some labelled pore percolates along it

  [[nodiscard]] double mean() const noexcept
  {
    return count > 0 ? static_cast<double>(total) / static_cast<double>(count) : 0.0;
  }
};

struct Slab;

/// Labels the connected pores of one phase of a lattice that ranks share in blocks of whole rows.
///
/// Rows are cut into runs of the phase, runs of neighbouring rows that touch are united (a forest whose
/// roots are the lowest runs; Rem's way: Dijkstra, A Discipline of Programming, 1976, chapter 23), and sizes, boxes and
/// centres are summed by runs. Parts of the block that threads did, periodic sides and the blocks of other ranks are
/// joined afterwards, from the nodes on both sides of the seams; what ranks exchange is these layers and one record (64
/// bytes) a part of a pore. All sums are whole numbers and pores are numbered by what they are, so labels do not depend
/// on threads or ranks.
///
/// Time: a few operations a 64 nodes and a few a run. Memory beside the labels: 1.5 bits a node, 4 bytes a run, about
/// 200 bytes a pore on rank 0. Sums hold while size · 2n < 2⁶³.
class PoreLabelling
{
public:
  /// Collective.
  /// @param phase ids of the nodes of this rank's block, whole rows along x as Decomposition shares them out (of the
  ///   whole lattice on one rank); the nodes that are `wanted` are labelled
  /// @throws ParameterError (on every rank): a connectivity that does not fit the dimension; a minimum size below 0
  /// @throws InputError (on every rank): more pores than `mostLabels`
  /// @throws Cancelled (on every rank)
  PoreLabelling(const Lattice& lattice, const Communicator& comm, std::span<const std::uint8_t> phase,
    std::uint8_t wanted, const LabelOptions& options);
  ~PoreLabelling();
  PoreLabelling(const PoreLabelling&) = delete;
  PoreLabelling& operator=(const PoreLabelling&) = delete;

  [[nodiscard]] const PoreSummary& summary() const noexcept { return summary_; }
  /// On rank 0 the pore with label i + 1 is pores()[i]; empty elsewhere.
  [[nodiscard]] std::span<const Pore> pores() const noexcept { return pores_; }

  /// Labels of the block's nodes, 1 … count, 0 outside. @param labels block.count()
  void labels(std::span<std::int32_t> labels) const;
  /// Size of each node's pore [nodes], NaN outside; exact up to 2²⁴. @param sizes block.count()
  void sizes(std::span<float> sizes) const;

private:
  class Work;

  std::vector<Slab> slabs_;
  std::int64_t rowLength_ = 0;
  ForEach forEach_;
  UnfilledVector<std::int32_t> labelOf_; ///< by piece of the block
  UnfilledVector<float> sizeOf_;         ///< likewise; empty on one rank, where pores_ tells
  UnfilledVector<Pore> pores_;
  PoreSummary summary_;
};

/// The first of the phases that is called void, pore, lumen or air, in this order and in whatever case; none: nothing.
[[nodiscard]] std::optional<std::size_t> voidPhase(std::span<const std::string> names);

/// Is this a connectivity in that many dimensions?
[[nodiscard]] bool fits(int connectivity, int dimension) noexcept;

/// Pores of one class of sizes.
struct SizeClass
{
  std::int64_t low;   ///< smallest size [nodes]
  std::int64_t high;  ///< largest size, included
  std::int64_t count; ///< pores
  std::int64_t nodes; ///< of these pores
};

/// How sizes are distributed: classes that each reach twice as far as the one before (1, 2–3, 4–7, …), from that of the
/// smallest pore to that of the largest. Empty without pores.
[[nodiscard]] std::vector<SizeClass> sizeDistribution(std::span<const Pore> pores);

/// Diameter of the circle of this area, 2 √(A/π) (dimension 2), or of the sphere of this volume, ∛(6V/π) (3).
/// @param size nodes  @param spacing [m]  @returns [m]
[[nodiscard]] double equivalentDiameter(double size, double spacing, int dimension) noexcept;

} // namespace lamella::pores
