#pragma once

#include "Diffusion.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace lamella::test
{

using lbm::Boundary;
using lbm::Collision;
using lbm::LatticeBoltzmann;
using lbm::SteppingOptions;

inline constexpr std::array<lbm::Stencil, 4> everyLattice{ lbm::Stencil::D2Q5, lbm::Stencil::D2Q9, lbm::Stencil::D3Q7,
  lbm::Stencil::D3Q19 };

inline int dimensionOf(lbm::Stencil stencil)
{
  return stencil == lbm::Stencil::D2Q5 || stencil == lbm::Stencil::D2Q9 ? 2 : 3;
}

/// All sides alike but those of the axis.
inline std::array<Boundary, 3> sidesOf(int axis, Boundary along, Boundary others)
{
  std::array<Boundary, 3> sides{ others, others, others };
  sides[static_cast<std::size_t>(axis)] = along;
  return sides;
}

inline LatticeBoltzmann stepper(
  const PhaseImage& image, const std::vector<double>& d, const SteppingOptions& options, MPI_Comm comm = MPI_COMM_SELF)
{
  const Block block = decompose(image.lattice, comm);
  return { image.lattice, block, lbm::blockOf(image, block), d, options, comm };
}

inline std::vector<double> valueOf(const LatticeBoltzmann& solver, std::int64_t count)
{
  std::vector<double> u(static_cast<std::size_t>(count));
  solver.value(u);
  return u;
}

/// f at the nodes of a block, spacings from the middle of the first node of the box.
inline std::vector<double> fieldOf(const Block& b, const std::function<double(double, double, double)>& f)
{
  std::vector<double> u;
  for (std::int64_t z = 0; z < b.size[2]; ++z)
    for (std::int64_t y = 0; y < b.size[1]; ++y)
      for (std::int64_t x = 0; x < b.size[0]; ++x)
        u.push_back(f(static_cast<double>(x + b.start[0]), static_cast<double>(y + b.start[1]),
          static_cast<double>(z + b.start[2])));
  return u;
}

} // namespace lamella::test
