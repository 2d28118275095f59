#pragma once

#include "peridynamics/Fragments.h"
#include "peridynamics/fracture/BondGraph.h"
#include "peridynamics/fracture/PlatenForce.h"

#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// The bonds of pieces without a fixed component, at nodes of this rank.
/// @param fragments of PlatenForce::marks()
[[nodiscard]] std::vector<Bond> bondsOfLoosePieces(const BondLattice& bonds, const Fragments& fragments);

/// Finds what a broken bond lets go of, by looking no further than it must: where its ends have a neighbour in common,
/// no further than that; else from both ends at once, until they meet or one side is exhausted. One rank.
class LoosePieces
{
public:
  LoosePieces(const BondLattice& bonds, const LoadedSample& sample, const PlatenForce& platens);

  /// After a bond has been taken out.
  /// @return nodes of a piece that nothing holds any more, in order; most often none
  std::vector<std::int64_t> after(std::int64_t index, int offset);
  /// Does a piece still reach from platen to platen?
  [[nodiscard]] bool holds() const noexcept { return bridges_ > 0; }
  [[nodiscard]] std::int64_t searches() const noexcept { return searches_; }
  [[nodiscard]] std::int64_t bytes() const noexcept { return marks_.size() + 2 * seen_.size(); }

private:
  struct Flood
  {
    std::vector<std::int64_t> nodes;
    std::size_t next = 0;
    std::uint16_t mark = 0;
    std::uint8_t platens = 0;
  };
  void begin(Flood& flood, std::int64_t node);
  /// Visits the neighbours of one more node.
  /// @return whether one of them belongs to the other flood
  bool grow(Flood& flood, std::uint16_t other);

  const BondLattice& bonds_;
  BondGraph graph_;
  AlignedArray<std::uint8_t> marks_; ///< PlatenForce::marks()
  AlignedArray<std::uint16_t> seen_; ///< by which flood
  std::uint16_t floods_ = 0;
  std::int64_t bridges_ = 0; ///< pieces from platen to platen
  std::int64_t searches_ = 0;
};

} // namespace lamella::peridynamics
