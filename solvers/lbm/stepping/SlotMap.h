#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/NodeSet.h"
#include "lbm/stepping/StepKernels.h"
#include "lbm/stepping/Velocities.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace lamella::lbm
{

/// What holds at the ends of the box, for stepping.
struct SlotSides
{
  std::array<Boundary, 3> boundary{ Boundary::Fixed, Boundary::Insulated, Boundary::Insulated };
  std::array<std::array<double, 2>, 3> value{}; ///< on the low and the high fixed face of each axis
  std::array<double, 3> drop{};                 ///< periodic: by how much the value falls over a box length
  bool onNodes = false; ///< faces and mirrors on the outer nodes (BGK), not half a spacing outside
};

/// Where the populations of every stored node wait, and where those that arrive come from: bounce-back at nodes that
/// are not stored, faces, mirrors, periodic sides and other ranks are all a matter of which slot is read. Built once.
/// Arriving population q of a node is the slot of its source node in the direction back to it; source and node
/// share that slot, which no other node uses.
class SlotMap
{
public:
  /// A row along x of this rank's block.
  struct Row
  {
    std::int32_t first = 0;    ///< its first stored node
    std::int32_t count = 0;    ///<
    std::int32_t firstRun = 0; ///<
    std::int32_t runs = 0;     ///<
    bool special = false;      ///< mirrors or fixed values on its nodes in even steps, too
    bool late = false;         ///< some populations come from another rank
  };
  /// Slots shared with another rank, in the order that both use.
  struct Neighbour
  {
    int rank = 0;
    std::vector<std::int64_t> mine;  ///< of my nodes, read and written over there in odd steps
    std::vector<std::int64_t> ghost; ///< of theirs, read and written here
  };
  /// A weighted sum of slots plus a constant: what crosses a plane in one step.
  struct Plane
  {
    std::vector<std::pair<std::int64_t, double>> terms;
    double constant = 0;
  };

  /// @param stored the nodes that take part, ghost rows included, numbered
  SlotMap(const Lattice& lattice, const Decomposition& parts, const Halo& halo, const Communicator& comm,
    const Velocities& velocities, const SlotSides& sides, NodeSet stored);

  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }
  [[nodiscard]] const std::vector<SlotRun>& runs() const noexcept { return runs_; }
  [[nodiscard]] const std::vector<std::int32_t>& sources() const noexcept { return sources_; }
  [[nodiscard]] const std::vector<SlotPattern>& patterns() const noexcept { return patterns_; }
  [[nodiscard]] const std::vector<Neighbour>& neighbours() const noexcept { return neighbours_; }
  [[nodiscard]] std::int64_t stride() const noexcept { return stride_; }
  [[nodiscard]] std::int64_t stored() const noexcept { return stored_; } ///< nodes of this rank
  [[nodiscard]] std::uint64_t bytes() const noexcept;

  /// The planes whose flux along an axis is watched: the two faces; on-node faces: the links next to them; periodic:
  /// the low side and half-way across.
  [[nodiscard]] std::array<Plane, 2> planes(int axis) const;

  /// Calls f(node, index in the block) for every stored node of a row, x rising.
  template <class F>
  void forEach(std::size_t row, F&& f) const
  {
    std::int32_t node = rows_[row].first;
    const std::int64_t begin = static_cast<std::int64_t>(row) * nx_;
    set_.forEach(setRow(row), [&](std::int64_t x) { f(node++, begin + x); });
  }
  /// Position in the whole lattice of a node of the block, by its row and x.
  [[nodiscard]] std::array<std::int64_t, 3> position(std::size_t row, std::int64_t x) const;
  /// Is a node on a side whose nodes count half (mirrors on the nodes)? The share of its volume inside the box.
  [[nodiscard]] double share(const std::array<std::int64_t, 3>& p) const;

private:
  struct Source
  {
    std::int64_t row = 0; ///< of the set
    std::int64_t x = 0;
    int slot = 0;
    bool own = false;
    bool wall = false; ///< own because a face or a mirror is there
    bool ghost = false;
    double sign = 1;
    double shift = 0;
  };
  [[nodiscard]] std::int64_t setRow(std::size_t row) const;
  [[nodiscard]] Source source(const std::array<std::int64_t, 3>& p, int q) const;
  [[nodiscard]] bool wholeAround(std::size_t row) const;
  std::int32_t patternOf(const std::array<std::int64_t, 3>& p, const std::vector<Source>& sources);
  void addNode(const std::array<std::int64_t, 3>& p, std::int32_t node, std::int32_t count, Row& row);
  void matchGhosts();

  Lattice lattice_;
  const Decomposition& parts_;
  const Communicator& comm_;
  Halo halo_;
  Velocities velocities_;
  SlotSides sides_;
  NodeSet set_;
  Block block_;
  std::int64_t nx_ = 0;
  std::int64_t stride_ = 0;
  std::int64_t stored_ = 0;
  std::vector<Row> rows_;
  std::vector<SlotRun> runs_;
  std::vector<std::int32_t> sources_;
  std::vector<SlotPattern> patterns_;
  std::int32_t innerPattern_ = -1;
  std::vector<Neighbour> neighbours_;
};

} // namespace lamella::lbm
