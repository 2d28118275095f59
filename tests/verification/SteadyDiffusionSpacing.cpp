// Voxels that are not cubes: the values of a system assembled from areas and lengths, of layers, and of spheres.
#include "Diffusion.h"

#include "core/Error.h"

#include <Eigen/Dense>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

PhaseImage stretched(PhaseImage image, std::array<double, 3> edges)
{
  image.lattice = makeLattice(image.lattice.size[0], image.lattice.size[1], image.lattice.size[2],
    image.lattice.dimension, edges[0], { 1, edges[1] / edges[0], edges[2] / edges[0] });
  return image;
}

struct Known
{
  std::array<double, 3> column{ 0, 0, 0 }; // of the effective tensor
  Eigen::VectorXd value;
  std::vector<std::array<double, 3>> flux; // by node, in conductivity per metre
};

/// Finite volumes in physical units, every conductance as conductivity times area over length, solved densely.
Known assembled(const PhaseImage& image, const std::vector<double>& d, int axis, lbm::Sides sides)
{
  const Lattice& l = image.lattice;
  const auto n = static_cast<Eigen::Index>(l.count());
  const double volume = l.spacingAlong(0) * l.spacingAlong(1) * l.spacingAlong(2);
  const auto wraps = [&](int a) { return sides == lbm::Sides::Periodic || (sides == lbm::Sides::Mixed && a != axis); };
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  // f(here, there or −1, axis, ±1, conductance, length, added to the value there)
  const auto forLinks = [&](auto&& f)
  {
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          for (int a = 0; a < l.dimension; ++a)
            for (const int step : { -1, 1 })
            {
              std::array<std::int64_t, 3> q{ x, y, z };
              const std::int64_t size = l.size[static_cast<std::size_t>(a)];
              std::int64_t& p = q[static_cast<std::size_t>(a)];
              const auto here = l.index(x, y, z);
              const double k = d[image.phase[static_cast<std::size_t>(here)]];
              const double h = l.spacingAlong(a);
              p += step;
              const bool out = p < 0 || p >= size;
              if (out && !wraps(a))
              {
                if (a == axis)
                  f(here, std::int64_t{ -1 }, a, step, 2 * k * volume / h / h, h / 2, step < 0 ? 1.0 : 0.0);
                continue;
              }
              p = (p + size) % size;
              const double other = d[image.phase[static_cast<std::size_t>(l.index(q[0], q[1], q[2]))]];
              const double jump = out && a == axis ? -step : 0.0; // one over the box
              f(here, l.index(q[0], q[1], q[2]), a, step, 2 / (1 / k + 1 / other) * volume / h / h, h, jump);
            }
  };
  forLinks(
    [&](std::int64_t here, std::int64_t there, int, int, double g, double, double plus)
    {
      matrix(here, here) += g;
      if (there >= 0)
        matrix(here, there) -= g;
      right(here) += g * plus;
    });
  if (sides == lbm::Sides::Periodic)
    matrix(0, 0) += 1; // any value will do
  Known known;
  known.value = matrix.ldlt().solve(right);
  known.flux.resize(static_cast<std::size_t>(n), { 0, 0, 0 });
  forLinks(
    [&](std::int64_t here, std::int64_t there, int a, int step, double g, double, double plus)
    {
      const double drop = known.value(here) - (there >= 0 ? known.value(there) : 0.0) - plus;
      known.flux[static_cast<std::size_t>(here)][static_cast<std::size_t>(a)] +=
        0.5 * step * g * drop * l.spacingAlong(a) / volume;
    });
  for (const auto& q : known.flux)
    for (std::size_t a = 0; a < 3; ++a)
      known.column[a] += q[a] * l.length(axis) / static_cast<double>(n);
  return known;
}

TEST(Spacing, ValuesAndFluxesAreThoseOfAreasAndLengths)
{
  const std::vector<double> d{ 0.2, 1.0 };
  for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Mixed, lbm::Sides::Periodic })
    for (const bool volume : { true, false })
    {
      const PhaseImage image = stretched(noise(6, 8, volume ? 4 : 1, 0.5, 7), { 2e-6, 1e-6, 5e-6 });
      for (int axis = 0; axis < image.lattice.dimension; ++axis)
        for (const auto method : { lbm::Method::Multigrid, lbm::Method::AlgebraicMultigrid })
        {
          const Known known = assembled(image, d, axis, sides);
          const Case s{ .axis = axis, .sides = sides, .method = method };
          const Block block = decompose(image.lattice, MPI_COMM_SELF);
          lbm::SteadyDiffusion solver(image.lattice, block, image.phase, d, optionsOf(image, s));
          const auto r = solver.solve(axis);
          for (std::size_t a = 0; a < 3; ++a)
            EXPECT_NEAR(r.effective[a], known.column[a], static_cast<int>(a) == axis ? 1e-9 : 1e-7)
              << axis << " " << a << " " << static_cast<int>(sides);
          EXPECT_LT(r.balance, 1e-9);
          std::vector<double> flux(3 * image.phase.size());
          solver.flux(flux);
          for (std::size_t i = 0; i < flux.size(); ++i) // fields are asked for to 1e-6 of the energy
            EXPECT_NEAR(
              flux[i] * image.lattice.length(axis), known.flux[i / 3][i % 3] * image.lattice.length(axis), 1e-5);
          if (sides == lbm::Sides::Periodic)
            continue;
          std::vector<double> value(image.phase.size());
          solver.value(value);
          for (std::size_t i = 0; i < value.size(); ++i)
            EXPECT_NEAR(value[i], known.value(static_cast<Eigen::Index>(i)), 1e-5);
        }
    }
}

TEST(Spacing, LeanOnesHaveTheFullSolversValue)
{
  for (const auto method : { lbm::Method::LeanMultigrid, lbm::Method::PieceMultigrid })
    for (const std::array<double, 3> edges :
      { std::array<double, 3>{ 1, 1, 2 }, { 1, 1, 0.5 }, { 3, 1, 1 }, { 1, 4, 2 }, { 1, 1, 8 } })
    {
      if (method == lbm::Method::LeanMultigrid && std::ranges::max(edges) > 2)
        continue;
      for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Mixed })
        for (const int axis : { 0, 1, 2 })
        {
          const PhaseImage image = stretched(noise(32, 30, 28, 0.5, 2), edges);
          Case s{ .axis = axis, .sides = sides, .method = lbm::Method::Multigrid };
          const double value = solve(image, { 0.3, 1.0 }, s).effective[static_cast<std::size_t>(axis)];
          s.method = method;
          s.tolerance = 1e-6;
          lbm::SteadyOptions o = optionsOf(image, s);
          o.fieldTolerance = std::numeric_limits<double>::infinity();
          const Block block = decompose(image.lattice, MPI_COMM_SELF);
          const auto r =
            lbm::SteadyDiffusion(image.lattice, block, image.phase, std::vector{ 0.3, 1.0 }, o).solve(axis);
          EXPECT_EQ(r.method, method);
          EXPECT_LE(std::abs(r.effective[static_cast<std::size_t>(axis)] / value - 1), r.solverError);
          EXPECT_LE(r.solverError, 1e-6);
          EXPECT_LE(r.balance, 1e-6);
          EXPECT_LE(r.iterations, 9);
        }
    }
}

/// Layers across an axis conduct in series across and in parallel along, whatever the voxels' edges.
TEST(Spacing, LayersAreExact)
{
  for (int across = 0; across < 3; ++across)
  {
    PhaseImage image = stretched(noise(9, 9, 9, 0.5, 1), { 1, 0.25, 3 });
    for (std::int64_t i = 0; i < image.lattice.count(); ++i)
    {
      const std::array<std::int64_t, 3> p{ i % 9, i / 9 % 9, i / 81 };
      image.phase[static_cast<std::size_t>(i)] = p[static_cast<std::size_t>(across)] % 3 == 0 ? 1 : 0;
    }
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(solve(image, { 0.1, 1.0 }, { .axis = axis }).effective[static_cast<std::size_t>(axis)],
        axis == across ? 1 / (2 / 0.1 / 3 + 1.0 / 3) : 0.2 / 3 + 1.0 / 3, 1e-9);
  }
}

/// A cubic array of spheres, sampled twice as finely along two axes as along the third: the published value, the same
/// along and across the long edges, nearer on the finer lattice.
TEST(Spacing, SpheresHaveTheirPublishedValue)
{
  constexpr double published = 1.8877; // fraction 0.3, contrast 10: McPhedran and McKenzie (1978)
  std::array<double, 2> worst{ 0, 0 };
  for (const int level : { 0, 1 })
  {
    const std::int64_t n = 32 << level;
    PhaseImage image = stretched(noise(n, n, n / 2, 0.5, 1), { 1, 1, 2 });
    const double radius = std::cbrt(0.3 * 3 / (4 * std::numbers::pi)) * static_cast<double>(n);
    const auto from = [&](double place, double centre)
    {
      const double d = place - centre * static_cast<double>(n);
      return d - static_cast<double>(n) * std::round(d / static_cast<double>(n));
    };
    for (std::int64_t i = 0; i < image.lattice.count(); ++i)
    {
      const std::array<double, 3> p{ static_cast<double>(i % n) + 0.5, static_cast<double>(i / n % n) + 0.5,
        2 * static_cast<double>(i / n / n) + 1 };
      image.phase[static_cast<std::size_t>(i)] =
        std::hypot(from(p[0], 0.5), from(p[1], 0.513), from(p[2], 0.479)) < radius ? 1 : 0;
    }
    for (const int axis : { 0, 1, 2 })
    {
      const double value = solve(image, { 1.0, 10.0 }, { .axis = axis, .sides = lbm::Sides::Periodic })
                             .effective[static_cast<std::size_t>(axis)];
      worst[static_cast<std::size_t>(level)] =
        std::max(worst[static_cast<std::size_t>(level)], std::abs(value / published - 1));
    }
  }
  EXPECT_LT(worst[0], 0.01);
  EXPECT_LT(worst[1], worst[0]);
}

TEST(Spacing, DiagonalLinksAreRefused)
{
  const PhaseImage image = stretched(noise(4, 4, 4, 0.5, 1), { 1, 1, 2 });
  EXPECT_THROW((void)solve(image, { 0.1, 1.0 }, { .diagonal = true }), ParameterError);
}

} // namespace
