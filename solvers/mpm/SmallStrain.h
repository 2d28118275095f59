#pragma once

#include <array>
#include <cstddef>

/// Internal: small strains as vectors, shear strains as angles: xx, yy, xy or xx, yy, zz, yz, xz, xy.
namespace lamella::mpm
{

/// Which components of a symmetric matrix a value of Voigt's order is.
template <int Dim>
inline constexpr std::array<std::array<int, 2>, Dim == 3 ? 6 : 3> voigt = []
{
  if constexpr (Dim == 3)
    return std::array<std::array<int, 2>, 6>{ { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 1, 2 }, { 0, 2 }, { 0, 1 } } };
  else
    return std::array<std::array<int, 2>, 3>{ { { 0, 0 }, { 1, 1 }, { 0, 1 } } };
}();

/// Strain of a displacement gradient ∂u_i/∂x_j.
template <int Dim>
inline std::array<double, (Dim == 3 ? 6 : 3)> strainOf(const std::array<std::array<double, Dim>, Dim>& g)
{
  std::array<double, (Dim == 3 ? 6 : 3)> e;
  for (std::size_t v = 0; v < e.size(); ++v)
  {
    const auto i = static_cast<std::size_t>(voigt<Dim>[v][0]);
    const auto j = static_cast<std::size_t>(voigt<Dim>[v][1]);
    e[v] = i == j ? g[i][i] : g[i][j] + g[j][i];
  }
  return e;
}

/// Force of a stress on a node: its components are those of the stress along the gradient of the node's spline.
template <int Dim>
inline std::array<double, Dim> forceOf(
  const std::array<double, (Dim == 3 ? 6 : 3)>& t, const std::array<double, Dim>& g)
{
  if constexpr (Dim == 2)
    return { t[0] * g[0] + t[2] * g[1], t[2] * g[0] + t[1] * g[1] };
  else
    return { t[0] * g[0] + t[5] * g[1] + t[4] * g[2], t[5] * g[0] + t[1] * g[1] + t[3] * g[2],
      t[4] * g[0] + t[3] * g[1] + t[2] * g[2] };
}

} // namespace lamella::mpm
