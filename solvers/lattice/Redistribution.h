#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lamella
{

/// Moves arrays of rows between two decompositions of one lattice. Arrays are laid out as Halo has them, padded by one
/// ghost row; ghost rows beyond the lattice go along with the outermost rows, those between ranks do not.
class Redistribution
{
public:
  /// @param before  blocks of every rank
  /// @param after   the same
  Redistribution(int dimension, std::array<std::int64_t, 3> size, std::vector<Block> before, std::vector<Block> after,
    const Communicator& comm);

  /// Each row has `rowLength` values. Collective.
  void forward(const float* before, float* after, std::size_t rowLength) const;
  void backward(const float* after, float* before, std::size_t rowLength) const;

private:
  struct Range
  {
    std::array<std::int64_t, 2> y; ///< [first, last)
    std::array<std::int64_t, 2> z;
  };
  [[nodiscard]] Range padded(const Block& block) const;
  void move(const std::vector<Block>& from, const std::vector<Block>& to, const float* source, float* target,
    std::size_t rowLength) const;

  int ghostZ_;
  std::array<std::int64_t, 3> size_;
  std::vector<Block> before_;
  std::vector<Block> after_;
  const Communicator* comm_;
};

} // namespace lamella
