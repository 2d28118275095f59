// The Galerkin correction over planes, and what the solver makes of it: faces as exact as the energy.
#include "Diffusion.h"

#include "lbm/multigrid/Kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::test;

lbm::SteadyResult loosely(const PhaseImage& image, const std::vector<double>& d, const Case& s, double tolerance)
{
  auto o = optionsOf(image, s);
  o.tolerance = tolerance;
  o.fieldTolerance = std::numeric_limits<double>::infinity();
  const Block block = decompose(image.lattice, MPI_COMM_SELF);
  lbm::SteadyDiffusion solver(image.lattice, block, image.phase, d, o);
  return solver.solve(s.axis);
}

TEST(PlaneBalance, FacesAreAsGoodAsTheEnergyHoweverEarlyTheIterationEnds)
{
  for (const bool cube : { false, true })
    for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic })
      for (const bool diagonal : { false, true })
        for (const double weak : { 0.004, 0.3 })
          for (int axis = 0; axis < (cube ? 3 : 2); ++axis)
          {
            const auto image = cube ? noise(32, 16, 32, 0.4, 3) : noise(64, 32, 1, 0.4, 3);
            const Case s{ .axis = axis, .sides = sides, .diagonal = diagonal, .method = lbm::Method::Multigrid };
            const double exact = solve(image, { 1.0, weak }, s).effective[static_cast<std::size_t>(axis)];
            for (const double tolerance : { 1e-2, 1e-4, 1e-8 })
            {
              const auto r = loosely(image, { 1.0, weak }, s, tolerance);
              const double k = r.effective[static_cast<std::size_t>(axis)];
              // round-off of sums over 16 384 links of a field of 1
              EXPECT_NEAR(r.inletFlux / k, 1.0, 1e-10);
              EXPECT_NEAR(r.outletFlux / k, 1.0, 1e-10);
              // a Galerkin solution lies above the exact energy; 1e-11 is what `exact` itself was solved to
              EXPECT_GE(k / exact - 1, -2e-11);
              EXPECT_LE(k / exact - 1, tolerance) << axis << " " << diagonal << " " << weak;
              EXPECT_LE(r.solverError, tolerance);
            }
          }
}

TEST(PlaneBalance, LayersAcrossTheDirectionNeedNoIteration)
{
  auto image = noise(40, 30, 1, 1.1, 1);
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 40; ++x)
      image.phase[static_cast<std::size_t>(image.lattice.index(x, y))] = x % 5 < 2 ? 1 : 0;
  const auto r = loosely(image, { 1.0, 0.01 }, {}, 1e-3);
  EXPECT_NEAR(r.effective[0], 1 / (0.6 / 1.0 + 0.4 / 0.01), 1e-13); // in series, whatever the tolerance
}

TEST(FieldTolerance, IsKeptInTheEnergyNorm)
{
  generators::SoftwoodOptions o;
  o.size = { 160, 120, 1 };
  const auto image = generators::softwood(o);
  const Block block = decompose(image.lattice, MPI_COMM_SELF);
  const auto fluxOf = [&](double tolerance)
  {
    auto options = optionsOf(image, {});
    options.tolerance = 1e-2;
    options.fieldTolerance = tolerance;
    lbm::SteadyDiffusion solver(image.lattice, block, image.phase, std::vector<double>{ 1.0, 0.004 }, options);
    solver.solve(0);
    std::vector<double> q(3 * image.phase.size());
    solver.flux(q);
    return q;
  };
  const auto exact = fluxOf(1e-11);
  for (const double tolerance : { 1e-2, 1e-4, 1e-6 })
  {
    const auto q = fluxOf(tolerance);
    double apart = 0;
    double all = 0;
    for (std::size_t i = 0; i < q.size(); ++i)
    {
      const double d = image.phase[i / 3] == 0 ? 1.0 : 0.004;
      apart += (q[i] - exact[i]) * (q[i] - exact[i]) / d;
      all += exact[i] * exact[i] / d;
    }
    // the nodes' flux, a mean of two links, weighs them a little otherwise than the energy does
    EXPECT_LE(std::sqrt(apart / all), 1.5 * tolerance);
  }
}

#if defined(__x86_64__)
TEST(Kernels, AreTheFastestThatThisProcessorRuns)
{
  __builtin_cpu_init();
  const std::string expected = __builtin_cpu_supports("x86-64-v4") ? "x86-64-v4"
    : __builtin_cpu_supports("x86-64-v3")                          ? "x86-64-v3"
                                                                   : "x86-64";
  EXPECT_EQ(lbm::kernels().name, expected);
}
#endif

} // namespace
