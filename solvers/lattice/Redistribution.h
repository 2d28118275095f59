#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamella
{

/// Moves arrays of rows between two decompositions of one lattice. Arrays are laid out as Halo has them, padded by one
/// ghost row, or as blocks without any; ghost rows beyond the lattice go along with the outermost rows, those between
/// ranks do not. Blocks that are moved to may overlap.
class Redistribution
{
public:
  /// @param before  blocks of every rank
  /// @param after   the same
  /// @param ghosts  rows that arrays are padded by: 1, along z of volumes alone, or 0
  Redistribution(int dimension, std::array<std::int64_t, 3> size, std::vector<Block> before, std::vector<Block> after,
    const Communicator& comm, int ghosts = 1);

  /// Each row has `rowLength` values. Collective.
  template <class T>
  void forward(const T* before, T* after, std::size_t rowLength) const
  {
    move(before_, after_, reinterpret_cast<const std::byte*>(before), reinterpret_cast<std::byte*>(after),
      rowLength * sizeof(T));
  }
  template <class T>
  void backward(const T* after, T* before, std::size_t rowLength) const
  {
    move(after_, before_, reinterpret_cast<const std::byte*>(after), reinterpret_cast<std::byte*>(before),
      rowLength * sizeof(T));
  }

private:
  struct Range
  {
    std::array<std::int64_t, 2> y; ///< [first, last)
    std::array<std::int64_t, 2> z;
  };
  [[nodiscard]] Range padded(const Block& block) const;
  void move(const std::vector<Block>& from, const std::vector<Block>& to, const std::byte* source, std::byte* target,
    std::size_t rowBytes) const;

  int ghostY_;
  int ghostZ_;
  std::array<std::int64_t, 3> size_;
  std::vector<Block> before_;
  std::vector<Block> after_;
  const Communicator* comm_;
};

} // namespace lamella
