// The continuum: formulas and tables of others. Errors and orders are printed, and asserted.
#include "Diffusion.h"

#include "lbm/Bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace
{

using namespace lamella;
using namespace lamella::test;

TEST(Laminate, SeriesAndParallelAreExact)
{
  // Layers on the lattice: the harmonic mean on links is the exact answer, at any resolution and on every lattice.
  for (const int dimension : { 2, 3 })
    for (const bool diagonal : { false, true })
      for (int layered = 0; layered < dimension; ++layered)
        for (int axis = 0; axis < dimension; ++axis)
        {
          const auto image =
            generators::laminate(dimension, { 12, 12, dimension == 3 ? 12 : 1 }, 1.0, layered, 0.25, 1);
          const auto b = lbm::bounds(image.fractions(), std::vector<double>{ 1.0, 20.0 }, dimension);
          Case s;
          s.axis = axis;
          s.diagonal = diagonal;
          const auto r = solve(image, { 1.0, 20.0 }, s);
          if (axis == layered)
          {
            // Diagonal links cross a layer's face with the harmonic mean as well: exact in series too.
            EXPECT_NEAR(r.effective[axis], b.series, 1e-9 * b.series);
          }
          else if (!diagonal)
            EXPECT_NEAR(r.effective[axis], b.parallel, 1e-9 * b.parallel);
          else
            // Along the layers a diagonal link joins the two phases at each face: 9- and 19-point lattices lose
            // conductor there, of the order of one node in the thickness of a layer.
            EXPECT_LT(std::abs(r.effective[axis] / b.parallel - 1), 0.25);
        }
}

TEST(EmptyBox, ConductsAsItself)
{
  for (const int dimension : { 2, 3 })
    for (const bool diagonal : { false, true })
      for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic, lbm::Sides::Mixed })
        for (int axis = 0; axis < dimension; ++axis)
        {
          auto image = noise(8, 16, dimension == 3 ? 4 : 1, 2.0, 1); // all phase b
          Case s;
          s.axis = axis;
          s.sides = sides;
          s.diagonal = diagonal;
          const auto r = solve(image, { 1.0, 0.37 }, s);
          for (int i = 0; i < dimension; ++i)
            EXPECT_NEAR(r.effective[i], i == axis ? 0.37 : 0.0, 1e-12);
        }
}

// Effective conductivities of the square array of disks (matrix 1, disks s), multipole solution, all digits converged,
// after Perrins, McKenzie & McPhedran, Proc. R. Soc. A 369 (1979) 207.
struct DiskCase
{
  double fraction, s, exact;
};
const DiskCase diskTable[] = { { 0.10, 0.1, 0.84874 }, { 0.10, 10, 1.17822 }, { 0.10, 50, 1.21259 },
  { 0.30, 0.1, 0.60531 }, { 0.30, 10, 1.65204 }, { 0.30, 50, 1.81253 }, { 0.50, 0.1, 0.41400 }, { 0.50, 10, 2.41547 },
  { 0.50, 50, 2.91459 }, { 0.70, 0.1, 0.24620 }, { 0.70, 10, 4.06171 }, { 0.70, 50, 6.33592 }, { 0.10, 0, 0.81818 },
  { 0.30, 0, 0.53758 }, { 0.50, 0, 0.32465 }, { 0.70, 0, 0.13454 } };

TEST(SquareArrayOfDisks, ConvergesToTheMultipoleValues)
{
  std::printf(
    "square array of disks, relative error of plain pixels\n  f     s     16       64       256      order\n");
  double sum16 = 0;
  double sum256 = 0;
  for (const auto& c : diskTable)
  {
    double error[3];
    int i = 0;
    for (const std::int64_t n : { 16, 64, 256 })
    {
      if (c.s == 0 && c.fraction == 0.70 && n == 16)
      {
        error[i++] = -1; // pixels of neighbouring disks touch: nothing gets through
        continue;
      }
      const auto image = generators::inclusionArray(2, { n, n, 1 }, 1.0, c.fraction, 1);
      const auto r = solve(image, { 1.0, c.s }, { .sides = lbm::Sides::Periodic });
      error[i++] = r.effective[0] / c.exact - 1;
      EXPECT_NEAR(r.effective[1], 0.0, 1e-8); // symmetry
    }
    const double order = std::log2(std::abs(error[0] / error[2])) / 4;
    std::printf("  %.2f %5.1f  %+.5f %+.5f %+.5f  %.2f\n", c.fraction, c.s, error[0], error[1], error[2], order);
    sum16 += std::abs(error[0]);
    sum256 += std::abs(error[2]);
    // A staircase errs irregularly, and most where disks nearly touch: at area fraction 0.7 the gap is 14 nodes of 256,
    // and a boundary misplaced by a tenth of a node on either side changes it by 1.4 %; through insulating disks all
    // flux passes there (measured: 0.7 % for s > 0, 2.0 % for s = 0).
    EXPECT_LT(std::abs(error[2]), c.s == 0 && c.fraction == 0.70 ? 0.025 : 0.010) << "f " << c.fraction << " s " << c.s;
  }
  // On average over the table the order is about one: 16 times finer, at least 8 times better.
  EXPECT_LT(sum256, sum16 / 8);
}

TEST(CubicArrayOfSpheres, ConvergesToTheMultipoleValues)
{
  struct
  {
    double fraction, exact;
  } const table[] = { { 0.1, 1.2433 }, { 0.3, 1.8877 }, { 0.4, 2.3644 } };
  std::printf("simple cubic array of spheres, s = 10, relative error\n  f     16       32       64\n");
  for (const auto& c : table)
  {
    double error[3];
    int i = 0;
    for (const std::int64_t n : { 16, 32, 64 })
    {
      const auto image = generators::inclusionArray(3, { n, n, n }, 1.0, c.fraction, 1);
      error[i++] =
        solve(image, { 1.0, 10.0 }, { .sides = lbm::Sides::Periodic, .tolerance = 1e-8 }).effective[0] / c.exact - 1;
    }
    std::printf("  %.2f  %+.5f %+.5f %+.5f\n", c.fraction, error[0], error[1], error[2]);
    EXPECT_LT(std::abs(error[2]), 0.01); // measured: 0.6 %
    EXPECT_LT(std::abs(error[2]), std::abs(error[0]));
  }
}

TEST(Checkerboard, ApproachesTheGeometricMean)
{
  // √(k₁k₂), Dykhne; the corners make convergence slow, of an order that falls with the contrast.
  double previous = 1;
  for (const std::int64_t n : { 16, 32, 64, 128 })
  {
    const auto image = generators::checkerboard(2, { n, n, 1 }, 1.0, 2);
    const double error = solve(image, { 1.0, 4.0 }, { .sides = lbm::Sides::Periodic }).effective[0] / 2.0 - 1;
    std::printf(
      "checkerboard 1:4, n %lld, error %+.5f, ratio %.2f\n", static_cast<long long>(n), error, previous / error);
    EXPECT_LT(std::abs(error), std::abs(previous) / 1.8); // corner exponent ≈ 0.59 → order ≈ 1.2 at contrast 4
    previous = error;
  }
  EXPECT_LT(std::abs(previous), 0.006);
}

TEST(Keller, ProductOfConjugatePicturesIsTheProductOfPhases)
{
  // k_x(k₁,k₂) · k_y(k₂,k₁) = k₁k₂ for any picture, with faces as well as periodic: holds in the limit of fine
  // lattices.
  const auto image = refine(noise(24, 16, 1, 0.4, 7), 1);
  double previous = 1;
  for (const int n : { 1, 2, 4, 8 })
  {
    const auto fine = refine(image, n);
    const double kx = solve(fine, { 1.0, 5.0 }, { .axis = 0 }).effective[0];
    const double ky = solve(fine, { 5.0, 1.0 }, { .axis = 1 }).effective[1];
    const double error = kx * ky / 5.0 - 1;
    std::printf("Keller, refinement %d: %+.5f\n", n, error);
    EXPECT_LT(std::abs(error), std::abs(previous) / 1.7);
    previous = error;
  }
  EXPECT_LT(std::abs(previous), 0.03);
}

TEST(Bounds, HoldEveryResult)
{
  const auto image = noise(40, 40, 1, 0.3, 3);
  const std::vector<double> d{ 1.0, 12.0 };
  const auto b = lbm::bounds(image.fractions(), d, 2);
  EXPECT_LT(b.series, b.hashinShtrikmanLower);
  EXPECT_LT(b.hashinShtrikmanLower, b.hashinShtrikmanUpper);
  EXPECT_LT(b.hashinShtrikmanUpper, b.parallel);
  for (int axis : { 0, 1 })
  {
    const double k = solve(image, d, { .axis = axis }).effective[axis];
    EXPECT_GT(k, b.series);
    EXPECT_LT(k, b.parallel);
  }
  // two phases in 2D, by the textbook form k₁ + f₂ / (1/(k₂−k₁) + f₁/(2k₁))
  const double f = image.fractions()[1];
  EXPECT_NEAR(b.hashinShtrikmanLower, 1 + f / (1 / 11.0 + (1 - f) / 2), 1e-12);
  EXPECT_NEAR(b.hashinShtrikmanUpper, 12 + (1 - f) / (-1 / 11.0 + f / 24), 1e-12);
  EXPECT_EQ(lbm::bounds(std::vector<double>{ 0.5, 0.5 }, std::vector<double>{ 0.0, 1.0 }, 2).series, 0.0);
}

TEST(ErrorEstimate, TheLatticesPartHoldsTheLimitOfThesePixels)
{
  generators::SoftwoodOptions o;
  o.size = { 120, 120, 1 };
  o.seed = 5;
  const auto image = generators::softwood(o);
  lbm::StudyOptions s;
  s.steady.tolerance = 1e-9;
  const std::vector<double> d{ 0.023, 1.0 };
  const auto answers = lbm::studyDiffusion(image, d, s, MPI_COMM_SELF);
  for (const auto& a : answers)
  {
    // the limit, from refinements 8 and 16 (their change is below 0.1 %)
    const double k8 = solve(refine(image, 8), d, { .axis = a.axis, .tolerance = 1e-8 }).effective[a.axis];
    const double k = a.result.effective[static_cast<std::size_t>(a.axis)];
    const double k4 = solve(refine(image, 4), d, { .axis = a.axis, .tolerance = 1e-8 }).effective[a.axis];
    const double limit = k8 + (k8 - k4) / (std::exp2(1.3) - 1);
    const double error = std::abs(k / limit - 1);
    std::printf("axis %d: k %.6f, limit %.6f, error %.4f, estimated %.4f\n", a.axis, k, limit, error, a.error.lattice);
    EXPECT_GE(a.error.lattice, error * 0.95); // cautious: order 1 assumed, the true one is above
    EXPECT_LE(a.error.lattice, error * 2.5);  // and not by much
  }
}

TEST(ErrorEstimate, FieldsComeAtTheRefinementOfTheTarget)
{
  generators::SoftwoodOptions o;
  o.size = { 100, 80, 1 };
  const auto image = generators::softwood(o);
  lbm::StudyOptions s;
  s.targetError = 0.5; // met at once
  int fields = 0;
  const auto answers = lbm::studyDiffusion(image, std::vector<double>{ 0.023, 1.0 }, s, MPI_COMM_SELF,
    [&](const lbm::SteadyDiffusion&, const lbm::DiffusionAnswer& a, const Lattice& lattice, const Block&)
    {
      ++fields;
      EXPECT_EQ(lattice.size[0], 100 * a.refinement);
    });
  EXPECT_EQ(fields, 2);
  for (const auto& a : answers)
  {
    EXPECT_EQ(a.target, lbm::Target::Reached);
    EXPECT_LE(a.error.relative, 0.5);
    EXPECT_GE(a.steps.size(), 4U); // the picture, its halves, its quarters, its pixels split
  }
}

} // namespace
