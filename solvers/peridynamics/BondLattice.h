#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "peridynamics/BondModel.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/Stencil.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

struct RowKernels;

/// The rows of this rank: the lattice in slabs along its slowest axis (y in 2D, z in 3D).
/// @throws ParameterError when a slab would be thinner than the horizon
[[nodiscard]] Block slab(const Lattice& lattice, const Stencil& stencil, const Communicator& comm);

/// A bond by its first node and its place in Stencil::half().
struct Bond
{
  std::array<std::int64_t, 3> node{ 0, 0, 0 }; ///< of the whole lattice
  int offset = 0;

  bool operator==(const Bond&) const = default;
  bool operator<(const Bond& other) const noexcept
  {
    return node != other.node ? node < other.node : offset < other.offset;
  }
};

/// A bond that may be gone, and the kind of it while it was there.
struct KnownBond
{
  Bond bond;
  int kind = 0;
};

/// Runs of 16 nodes of a row, by what their bonds are.
struct StripCounts
{
  std::int64_t empty = 0;   ///< no bond: not visited
  std::int64_t uniform = 0; ///< all bonds there and of one kind: no look at the bits
  std::int64_t mixed = 0;
};

/// The bonds of a sample on this rank: no list of neighbours, but ⌈log₂(kinds + 1)⌉ bits a bond, each bond stored once,
/// at its first node. Kept for the owned nodes and for the rim, so that every bond with an owned end is at hand.
///
/// Memory: with two or three kinds and h = 3 in 2D 8 bytes a node and 4 for the strips.
class BondLattice
{
public:
  /// @param lattice the whole one
  /// @param phase of the nodes of slab(), in lattice order; that of the whole lattice on one rank
  /// @param grain likewise; may be empty
  /// @param comm must outlive this
  /// @throws ParameterError: see BondKinds; a pair of phases that are neighbours without data; a horizon that does not
  /// fit into the sample; a notch that does not touch it
  /// @throws InputError: arrays of the wrong length; no solid node
  /// @throws MemoryError before anything is allocated
  BondLattice(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
    std::span<const std::int32_t> grain, const Communicator& comm);
  /// Bytes that the making of one takes on one rank: what the constructor checks against the memory that is free.
  /// @throws ParameterError as the constructor, but for what depends on the sample
  [[nodiscard]] static double bytesNeeded(const BondModel& model, const Lattice& lattice, int ranks, bool grains);
  /// The bonds that all ranks have at this time, whole on each of them. Collective.
  /// @param alone one rank; must outlive what is returned
  [[nodiscard]] BondLattice whole(const Communicator& alone) const;
  BondLattice(BondLattice&&) = default;
  BondLattice& operator=(BondLattice&&) = default;

  [[nodiscard]] const Stencil& stencil() const noexcept { return stencil_; }
  [[nodiscard]] const NodeLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] const Communicator& communicator() const noexcept { return *comm_; }
  [[nodiscard]] int dimension() const noexcept { return layout_.dimension; }
  [[nodiscard]] double spacing() const noexcept { return spacing_; }
  [[nodiscard]] const std::array<bool, 3>& periodic() const noexcept { return periodic_; }
  /// [0] is no bond.
  [[nodiscard]] const std::vector<BondKind>& kinds() const noexcept { return kinds_; }
  /// Bits a bond.
  [[nodiscard]] int planes() const noexcept { return planes_; }
  [[nodiscard]] bool corrected() const noexcept { return corrected_; }

  /// Is there matter at a position of the layout? Rim included.
  [[nodiscard]] bool solid(std::int64_t index) const noexcept { return solid_[index] != 0; }
  /// Kind of the bond from a position to the one at half()[offset] from it; 0: none.
  [[nodiscard]] int kind(std::int64_t index, int offset) const noexcept
  {
    int code = 0;
    for (int p = 0; p < planes_; ++p)
      code |= static_cast<int>((plane(p, offset >> 5)[index] >> (offset & 31)) & 1U) << p;
    return code;
  }
  /// k/|ξ| of a bond, surface correction included: [N/m], [N/m²] in the plane; 0 without a bond.
  [[nodiscard]] double springConstant(std::int64_t index, int offset) const noexcept;
  /// The same were the bond of this kind, there or broken.
  [[nodiscard]] double springConstant(std::int64_t index, int offset, int kind) const noexcept;
  /// From the first node of a bond to its second, in positions of the layout.
  [[nodiscard]] std::int64_t jump(int offset) const noexcept { return jump_[static_cast<std::size_t>(offset)]; }
  /// Directed bonds of a node of the layout that must have its whole neighbourhood in it (an owned one).
  [[nodiscard]] int degree(std::int64_t index) const noexcept;

  /// Calls f(i, j, offset, kind) for every bond with at least one owned end whose *first* node lies in this row of the
  /// layout (rim rows included: -ghost ≤ y < size[1]); i, j are positions. Bonds between two ends of the rim are left
  /// out. Over all rows each bond of the rank is met once; one that crosses a periodic side is met once from each.
  template <class F>
  void forEachBond(std::int64_t y, std::int64_t z, F&& f) const;

  /// Undirected bonds of all ranks that are not broken.
  [[nodiscard]] std::int64_t bonds() const noexcept { return bonds_; }
  /// Of all ranks.
  [[nodiscard]] std::int64_t solidNodes() const noexcept { return solidNodes_; }
  /// Of this rank's owned rows.
  [[nodiscard]] StripCounts strips() const noexcept;
  /// That this object holds.
  [[nodiscard]] std::int64_t bytes() const noexcept;

  /// Fills the rim of a field: images at periodic sides, the neighbours' rows. Collective.
  template <class Real>
  void exchange(NodeField<Real>& field) const;
  /// The same, while other work goes on.
  template <class Real>
  [[nodiscard]] RimInFlight<Real> startExchange(NodeField<Real>& field) const;

  /// A field of whole numbers of this rank's nodes, x fastest, its rim filled. Collective.
  [[nodiscard]] NodeField<float> fieldOf(std::span<const std::uint8_t> numbers) const;

  /// Takes bonds out, wherever this rank's rim shows them too. Collective: every rank gives those that it found.
  /// @return how many there were, over all ranks; bonds that are no more or that two ranks name count once
  std::int64_t breakBonds(std::span<const Bond> bonds);

  /// Puts bonds back, wherever this rank's rim shows them too. Collective: every rank gives those that it found.
  /// @param bonds with their kinds, kinds()[1] or a later one
  /// @return how many were not there, over all ranks; bonds that two ranks name count once
  std::int64_t restoreBonds(std::span<const KnownBond> bonds);

  /// Takes out a bond that there is, and that every rank names in the same call: nothing is sent.
  void breakKnown(const Bond& bond);

  /// A bond as ranks agree on it, from a position of the layout.
  [[nodiscard]] Bond bond(std::int64_t index, int offset) const noexcept;

  // ---- for the kernels
  /// Words w = offset / 32 of all nodes.
  [[nodiscard]] const std::uint32_t* plane(int p, int word) const noexcept
  {
    return bits_.data() + (p * words_ + word) * layout_.count();
  }
  [[nodiscard]] int words() const noexcept { return words_; }
  /// A byte a strip of 16 nodes, pitch / 16 a row: 0 none, 255 mixed, else the kind of all bonds.
  [[nodiscard]] const std::uint8_t* stripsOf(std::int64_t row) const noexcept
  {
    return strips_.data() + row * (layout_.pitch / 16);
  }
  /// Squares of the shares of energy along an axis of every node (BondModel::surfaceCorrection); null without.
  [[nodiscard]] const float* shares(int axis) const noexcept { return corrected_ ? shares_.component(axis) : nullptr; }
  [[nodiscard]] const RowKernels& rowKernels() const noexcept { return *rowKernels_; }
  /// Takes another instruction set than the best; see rowKernelSets().
  void use(const RowKernels& kernels) noexcept { rowKernels_ = &kernels; }

private:
  friend class BondLatticeBuilder;
  BondLattice(const BondLattice&) = default; // whole() begins with one

  void classify(std::int64_t row, std::int64_t strip);
  /// Makes a bond one of this kind (0: none) in all its images here. @return how many owned ones were of another
  std::int64_t put(const Bond& bond, int kind);
  /// Of all ranks' lists.
  std::int64_t putAll(std::vector<std::int64_t> mine);

  Stencil stencil_;
  const Communicator* comm_;
  double spacing_ = 1;
  std::array<bool, 3> periodic_{};
  NodeLayout layout_;
  std::vector<BondKind> kinds_;
  std::vector<std::int64_t> jump_;
  int planes_ = 1;
  int words_ = 1;
  bool corrected_ = false;
  AlignedArray<std::uint32_t> bits_;
  AlignedArray<std::uint8_t> strips_;
  AlignedArray<std::uint8_t> solid_;
  NodeField<float> shares_;
  std::int64_t bonds_ = 0;
  std::int64_t solidNodes_ = 0;
  const RowKernels* rowKernels_ = nullptr;
};

template <class F>
void BondLattice::forEachBond(std::int64_t y, std::int64_t z, F&& f) const
{
  const auto& half = stencil_.half();
  const auto inside = [&](std::int64_t a, std::int64_t n) { return a >= 0 && a < n; };
  const bool ownRow = inside(y, layout_.size[1]) && inside(z, layout_.size[2]);
  for (std::size_t o = 0; o < half.size(); ++o)
  {
    const auto& step = half[o].step;
    const bool ownTarget = inside(y + step[1], layout_.size[1]) && inside(z + step[2], layout_.size[2]);
    if (!ownRow && !ownTarget)
      continue;
    for (std::int64_t x = -layout_.ghost; x < layout_.size[0] + layout_.ghost; ++x)
    {
      if (!(ownRow && inside(x, layout_.size[0])) && !(ownTarget && inside(x + step[0], layout_.size[0])))
        continue;
      const std::int64_t i = layout_.index(x, y, z);
      if (const int k = kind(i, static_cast<int>(o)); k != 0)
        f(i, i + jump_[o], static_cast<int>(o), k);
    }
  }
}

} // namespace lamella::peridynamics
