#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamella::lbm
{

/// Conductivities of the links of a 2D lattice, one by one, where geometry knows more than the phases at their ends.
/// A link conducts its conductivity over its length: one spacing between neighbours, half of one to the box's faces.
///
/// x[i + (nx + 1) j] is the link between the nodes i − 1 and i of row j, y[i + nx j] that between the nodes j − 1 and j
/// of column i; the first and the last lead to the faces. All are finite and ≥ 0, in the unit of the diffusivities.
/// Memory: 16 bytes a node, the whole lattice on every rank.
struct LinkTable
{
  std::array<std::int64_t, 2> size{ 0, 0 }; ///< nodes
  std::vector<double> x;                    ///< (nx + 1) ny
  std::vector<double> y;                    ///< nx (ny + 1)

  LinkTable() = default;
  LinkTable(std::int64_t nx, std::int64_t ny)
    : size{ nx, ny }
    , x(static_cast<std::size_t>((nx + 1) * ny), 0.0)
    , y(static_cast<std::size_t>(nx * (ny + 1)), 0.0)
  {
  }

  /// The link of node (0, j) in a direction along one axis, that of node (i, j) i further.
  [[nodiscard]] const double* row(int stepX, int stepY, std::int64_t j) const noexcept
  {
    return stepY == 0 ? x.data() + (stepX > 0 ? 1 : 0) + (size[0] + 1) * j
                      : y.data() + size[0] * (j + (stepY > 0 ? 1 : 0));
  }
};

} // namespace lamella::lbm
