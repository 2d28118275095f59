#pragma once

#include "generators/Generators.h"
#include "lattice/Phases.h"
#include "lbm/DiffusionStudy.h"
#include "lbm/SteadyDiffusion.h"

#include <cstdint>
#include <random>
#include <vector>

namespace lamella::test
{

inline lbm::Stencil stencilOf(int dimension, bool diagonal = false)
{
  if (dimension == 2)
    return diagonal ? lbm::Stencil::D2Q9 : lbm::Stencil::D2Q5;
  return diagonal ? lbm::Stencil::D3Q19 : lbm::Stencil::D3Q7;
}

struct Case
{
  int axis = 0;
  lbm::Sides sides = lbm::Sides::Insulated;
  bool diagonal = false;
  lbm::Method method = lbm::Method::Auto;
  double tolerance = 1e-11;
  int threads = 1;
};

inline lbm::SteadyOptions optionsOf(const PhaseImage& image, const Case& s)
{
  lbm::SteadyOptions o;
  o.stencil = stencilOf(image.lattice.dimension, s.diagonal);
  o.sides = s.sides;
  o.method = s.method;
  o.tolerance = s.tolerance;
  o.threads = s.threads;
  return o;
}

inline lbm::SteadyResult solve(
  const PhaseImage& image, const std::vector<double>& d, const Case& s, MPI_Comm comm = MPI_COMM_SELF)
{
  const Block block = decompose(image.lattice, comm);
  lbm::SteadyDiffusion solver(image.lattice, block, lbm::blockOf(image, block), d, optionsOf(image, s), comm);
  return solver.solve(s.axis);
}

/// Seeded noise: the hardest geometry there is, no two neighbours related.
inline PhaseImage noise(std::int64_t nx, std::int64_t ny, std::int64_t nz, double share, unsigned seed)
{
  PhaseImage image;
  image.lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, 1.0);
  image.phases = PhaseTable({ "a", "b" });
  image.phase.resize(static_cast<std::size_t>(image.lattice.count()));
  std::mt19937_64 random(seed);
  for (auto& p : image.phase)
    p = static_cast<double>(random() >> 11) * 0x1p-53 < share ? 1 : 0;
  return image;
}

} // namespace lamella::test
