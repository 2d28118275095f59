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
/// of column i; the first and the last lead to the faces. With periodic sides they are one and the same link.
///
/// On D2Q9 two diagonal links cross in every corner of pixels: rising[i + (nx + 1) j] joins the nodes (i − 1, j − 1)
/// and (i, j), falling[i + (nx + 1) j] the nodes (i − 1, j) and (i, j − 1). Their conductance is their conductivity
/// too, as that of a straight link. Those that leave through a side that is not periodic are 0.
///
/// All are finite and ≥ 0, in the unit of the diffusivities. Memory: 16 bytes a node, 32 with diagonals, the whole
/// lattice on every rank.
struct LinkTable
{
  std::array<std::int64_t, 2> size{ 0, 0 }; ///< nodes
  std::vector<double> x;                    ///< (nx + 1) ny
  std::vector<double> y;                    ///< nx (ny + 1)
  std::vector<double> rising;               ///< (nx + 1) (ny + 1), or empty: D2Q5
  std::vector<double> falling;              ///< the same

  LinkTable() = default;
  LinkTable(std::int64_t nx, std::int64_t ny, bool diagonals = false)
    : size{ nx, ny }
    , x(static_cast<std::size_t>((nx + 1) * ny), 0.0)
    , y(static_cast<std::size_t>(nx * (ny + 1)), 0.0)
    , rising(static_cast<std::size_t>(diagonals ? (nx + 1) * (ny + 1) : 0), 0.0)
    , falling(rising)
  {
  }

  /// The link of node (0, j) in a direction, that of node (i, j) i further.
  [[nodiscard]] const double* row(int stepX, int stepY, std::int64_t j) const noexcept
  {
    if (stepX != 0 && stepY != 0)
      return (stepX == stepY ? rising : falling).data() + (stepX > 0 ? 1 : 0) +
        (size[0] + 1) * (j + (stepY > 0 ? 1 : 0));
    return stepY == 0 ? x.data() + (stepX > 0 ? 1 : 0) + (size[0] + 1) * j
                      : y.data() + size[0] * (j + (stepY > 0 ? 1 : 0));
  }
};

} // namespace lamella::lbm
