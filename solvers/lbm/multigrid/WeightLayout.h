#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace lamella::lbm
{

/// Where the interpolation weights of a row of cells lie: an array for each pair (kind of fine node, corner of the
/// cell), kinds and corners by parity bits x + 2y + 4z, corner a subset of kind.
struct WeightLayout
{
  int arrays;
  std::int64_t length; // cells and one ghost at each end
  int index[8][8];

  WeightLayout(int dimension, std::int64_t cells)
    : arrays(0)
    , length(cells + 2)
  {
    const int kinds = dimension == 3 ? 8 : 4;
    for (auto& row : index)
      std::fill(std::begin(row), std::end(row), -1);
    for (int kind = 1; kind < kinds; ++kind)
      for (int corner = 0; corner < kinds; ++corner)
        if ((corner & ~kind) == 0)
          index[kind][corner] = arrays++;
  }
  [[nodiscard]] std::int64_t rowLength() const { return arrays * length; }
  template <class T>
  [[nodiscard]] T* at(T* base, std::int64_t row, int kind, int corner) const
  {
    return base + row * rowLength() + index[kind][corner] * length + 1;
  }
};

} // namespace lamella::lbm
