// Derivatives of effective conductivities by what they are made of, against differences of solves, with every method,
// stencil and kind of side; Euler's sum K = Σ k ∂K/∂k; the same on ranks.
#include "lbm/DiffusionStudy.h"
#include "lbm/Shares.h"

#include "core/Communicator.h"
#include "core/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::lbm;

// Walls, lumps and what is between: phases 1, 2 and 0, which no plane is without.
PhaseImage cells(std::array<std::int64_t, 3> size)
{
  PhaseImage image;
  image.lattice = makeLattice(size[0], size[1], size[2], size[2] > 1 ? 3 : 2, 1e-6);
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x)
      {
        const bool wall = x % 7 < 2 || (y + x / 7) % 6 < 1 || (size[2] > 1 && z % 9 < 2);
        const bool lump = (x * x + 3 * y * y + 2 * z * z + x * y) % 29 < 7;
        image.phase.push_back(wall ? 1 : lump ? 2 : 0);
      }
  return image;
}

struct Case
{
  std::string name;
  std::array<std::int64_t, 3> size{ 26, 18, 1 };
  Sides sides = Sides::Insulated;
  Stencil stencil = Stencil::D2Q5;
  Method method = Method::Auto;
  std::vector<double> conductivity{ 0.03, 1, 0.3 };
  std::vector<double> across{}; ///< with axes; empty: none
  double exact = 1e-6;          ///< to which they are to agree, of K
};

void PrintTo(const Case& c, std::ostream* out)
{
  *out << c.name;
}

DiffusionAnswer solved(const Case& c, const std::vector<double>& k, const std::vector<double>& across, bool derivatives)
{
  const PhaseImage image = cells(c.size);
  StudyOptions o;
  o.axes = { 0 };
  o.estimateError = false;
  o.derivatives = derivatives;
  o.steady.sides = c.sides;
  o.steady.stencil = c.stencil;
  o.steady.method = c.method;
  const bool lean = c.method == Method::LeanMultigrid || c.method == Method::PieceMultigrid;
  o.steady.tolerance = lean ? 1e-8 : 1e-11;
  o.steady.fieldTolerance = lean ? 1e-5 : 1e-8;
  if (!across.empty())
  {
    auto directed = std::make_shared<DirectedDiffusivity>(DirectedDiffusivity{ k, across, {} });
    for (std::size_t i = 0; i < image.phase.size(); ++i)
      directed->axis.push_back({ static_cast<float>(std::cos(0.1 * static_cast<double>(i % 31))),
        static_cast<float>(std::sin(0.1 * static_cast<double>(i % 31))), c.size[2] > 1 ? 0.4F : 0.0F });
    o.directed = directed;
  }
  const std::vector<double> diffusivity = o.directed ? o.directed->larger() : k;
  // with a sink fields are as exact as is asked for
  return studyDiffusion(image, diffusivity, o, MPI_COMM_WORLD,
    [](const SteadyDiffusion&, const DiffusionAnswer&, const Lattice&, const Block&) {})
    .front();
}

// Fourth order, by one relative step.
double difference(const auto& valueAt, double k)
{
  const double step = 0.01 * k;
  return (8 * (valueAt(k + step) - valueAt(k - step)) - (valueAt(k + 2 * step) - valueAt(k - 2 * step))) / (12 * step);
}

class DiffusionDerivatives : public testing::TestWithParam<Case>
{
};

TEST_P(DiffusionDerivatives, AreThoseOfDifferences)
{
  const Case& c = GetParam();
  const DiffusionAnswer answer = solved(c, c.conductivity, c.across, true);
  const double value = answer.result.effective[0];
  const ConductivityDerivatives& d = answer.derivatives;
  ASSERT_EQ(d.along.size(), c.conductivity.size());
  EXPECT_EQ(d.across.size(), c.across.size());
  double sum = 0;
  for (std::size_t id = 0; id < c.conductivity.size(); ++id)
  {
    const double k = c.conductivity[id];
    const bool directed = !c.across.empty() && c.across[id] != k;
    if (k == 0)
    {
      EXPECT_TRUE(std::isnan(d.along[id]));
      continue;
    }
    const auto alongAt = [&](double changed)
    {
      std::vector<double> along = c.conductivity;
      std::vector<double> across = c.across;
      along[id] = changed;
      if (!across.empty() && !directed)
        across[id] = changed;
      return solved(c, along, across, false).result.effective[0];
    };
    EXPECT_NEAR(k * d.along[id], k * difference(alongAt, k), c.exact * value) << id;
    sum += k * d.along[id];
    if (!directed)
      continue;
    const auto acrossAt = [&](double changed)
    {
      std::vector<double> across = c.across;
      across[id] = changed;
      return solved(c, c.conductivity, across, false).result.effective[0];
    };
    const double other = c.across[id];
    EXPECT_NEAR(other * d.across[id], other * difference(acrossAt, other), c.exact * value) << id;
    sum += other * d.across[id];
  }
  EXPECT_NEAR(sum, value, 1e-12 * value);
}

INSTANTIATE_TEST_SUITE_P(Cases, DiffusionDerivatives,
  testing::Values(Case{ "d2q5" }, Case{ "odd", { 27, 17, 1 } },
    Case{ "d2q9", { 26, 18, 1 }, Sides::Insulated, Stencil::D2Q9 }, Case{ "periodic", { 28, 18, 1 }, Sides::Periodic },
    Case{ "mixed", { 26, 18, 1 }, Sides::Mixed },
    Case{ "voids", { 26, 18, 1 }, Sides::Insulated, Stencil::D2Q5, Method::Auto, { 0, 1, 0.3 } },
    Case{ "space", { 18, 16, 18 }, Sides::Insulated, Stencil::D3Q7, Method::Multigrid },
    Case{ "space19", { 18, 16, 18 }, Sides::Periodic, Stencil::D3Q19, Method::Multigrid },
    Case{ "lean", { 18, 34, 36 }, Sides::Insulated, Stencil::D3Q7, Method::LeanMultigrid, { 0.1, 1, 0.3 }, {}, 3e-5 },
    Case{ "elements", { 20, 12, 1 }, Sides::Insulated, Stencil::Q1 },
    Case{ "elements_space", { 12, 9, 10 }, Sides::Periodic, Stencil::Q1 },
    Case{ "axes", { 20, 12, 1 }, Sides::Insulated, Stencil::Q1, Method::Auto, { 0.03, 1, 0.3 }, { 0.03, 0.2, 0.1 } },
    Case{ "axes_space", { 12, 9, 10 }, Sides::Mixed, Stencil::Q1, Method::Auto, { 0.03, 1, 0.3 }, { 0.03, 0.1, 0.1 },
      5e-6 }),
  [](const auto& test) { return test.param.name; });

TEST(DiffusionDerivativesAlone, OfPieces)
{
  if (Communicator(MPI_COMM_WORLD).parallel())
    GTEST_SKIP() << "pieces work on one rank";
  for (const Sides sides : { Sides::Insulated, Sides::Periodic })
  {
    const Case c{ "pieces", { 28, 18, 18 }, sides, Stencil::D3Q7, Method::PieceMultigrid, { 0, 1, 0.3 }, {}, 3e-5 };
    const DiffusionAnswer answer = solved(c, c.conductivity, {}, true);
    const double value = answer.result.effective[0];
    const auto at = [&](double k) { return solved(c, { 0, 1, k }, {}, false).result.effective[0]; };
    EXPECT_NEAR(0.3 * answer.derivatives.along[2], 0.3 * difference(at, 0.3), c.exact * value);
    EXPECT_NEAR(answer.derivatives.along[1] + 0.3 * answer.derivatives.along[2], value, 1e-12 * value);
  }
}

// From the lean field itself, in single precision and by halves of rows, as from one in double.
TEST(DiffusionDerivativesAlone, OfLeanFieldsAreThoseOfFieldsInDouble)
{
  for (const std::array<std::int64_t, 3> size : { std::array<std::int64_t, 3>{ 18, 34, 36 }, { 33, 19, 27 } })
    for (const Sides sides : { Sides::Insulated, Sides::Mixed, Sides::Periodic })
      for (const int axis : { 0, 1, 2 })
        for (const auto& k : { std::vector<double>{ 0.03, 1, 0.03 }, { 0.1, 1, 0.3 } })
        {
          if (sides != Sides::Insulated && size[0] % 2 == 1)
            continue; // what repeats has an even number of nodes
          PhaseImage image = cells(size);
          if (k[0] == k[2]) // two phases, of which one has an id that is not the next
            for (std::uint8_t& id : image.phase)
              id = id == 1 ? 1 : 2;
          const auto of = [&](Method method)
          {
            StudyOptions o;
            o.axes = { axis };
            o.estimateError = false;
            o.derivatives = true;
            o.surfaces = true;
            o.steady.sides = sides;
            o.steady.stencil = Stencil::D3Q7;
            o.steady.method = method;
            o.steady.tolerance = 1e-8; // more would be solved in double
            o.steady.fieldTolerance = 1e-5;
            return studyDiffusion(image, k, o, MPI_COMM_WORLD).front();
          };
          const DiffusionAnswer lean = of(Method::LeanMultigrid);
          const DiffusionAnswer full = of(Method::Multigrid);
          const double value = full.result.effective[static_cast<std::size_t>(axis)];
          for (std::size_t id = 0; id < k.size(); ++id)
            EXPECT_NEAR(k[id] * lean.derivatives.along[id], k[id] * full.derivatives.along[id], 3e-5 * value)
              << id << " of " << k[2] << " along " << axis << " of " << size[0];
          const std::vector<double>& shift = full.surfaces.shift;
          ASSERT_EQ(lean.surfaces.shift.size(), shift.size());
          const double most = std::abs(*std::ranges::max_element(shift, {}, [](double s) { return std::abs(s); }));
          for (std::size_t i = 0; i < shift.size(); ++i)
          {
            EXPECT_NEAR(lean.surfaces.shift[i], shift[i], 1e-4 * most) << i << " along " << axis << " of " << size[0];
            EXPECT_NEAR(lean.surfaces.area[i], full.surfaces.area[i], 1e-12);
          }
        }
}

// Greys as shares: by the low and by the high phase's conductivity, with either rule.
TEST(DiffusionDerivativesAlone, OfShares)
{
  PhaseImage image;
  image.lattice = makeLattice(30, 24, 1, 2, 1e-6);
  std::vector<double> share;
  for (int id = 0; id < 256; ++id)
    share.push_back(id / 255.0);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 30; ++x)
    {
      const double r = std::hypot((x % 15) - 7.2, (y % 12) - 5.7);
      image.phase.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(r - 4.0, 0.0, 1.0))));
    }
  StudyOptions o;
  o.axes = { 0 };
  o.estimateError = false;
  o.derivatives = true;
  o.steady.tolerance = 1e-11;
  o.steady.fieldTolerance = 1e-8;
  const auto answerOf = [&](double low, double high)
  {
    return studyShares(image, share, low, high, o, MPI_COMM_SELF,
      [](const SteadyDiffusion&, const DiffusionAnswer&, const Lattice&, const Block&) {})
      .front();
  };
  for (const auto& [low, high] : { std::pair{ 0.05, 1.0 }, std::pair{ 2.0, 0.1 }, std::pair{ 0.0, 1.0 } })
  {
    const DiffusionAnswer answer = answerOf(low, high);
    const double value = answer.result.effective[0];
    ASSERT_EQ(answer.derivatives.along.size(), 2U);
    const auto highAt = [&](double k) { return answerOf(low, k).result.effective[0]; };
    EXPECT_NEAR(high * answer.derivatives.along[1], high * difference(highAt, high), 1e-6 * value);
    if (low == 0)
    {
      EXPECT_TRUE(std::isnan(answer.derivatives.along[0]));
      continue;
    }
    const auto lowAt = [&](double k) { return answerOf(k, high).result.effective[0]; };
    EXPECT_NEAR(low * answer.derivatives.along[0], low * difference(lowAt, low), 1e-6 * value);
  }
}

TEST(DiffusionDerivativesAlone, WhereTheyCannotBeTold)
{
  const Case c{ "links", { 26, 18, 1 }, Sides::Insulated, Stencil::D2Q5, Method::Auto, { 0.3, 1, 0.3 },
    { 0.2, 0.5, 0.2 } };
  EXPECT_THROW((void)solved(c, c.conductivity, c.across, true), ParameterError);
  const PhaseImage image = cells({ 20, 20, 1 });
  const SteadyDiffusion unsolved(image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase,
    std::vector<double>{ 1, 1, 1 }, {}, MPI_COMM_SELF);
  EXPECT_THROW((void)unsolved.derivatives(), ParameterError);
}

// By where surfaces lie.

SurfaceDerivatives surfacesOf(
  const PhaseImage& image, std::vector<double> k, int axis, Sides sides, double* value = nullptr, int threads = 1)
{
  StudyOptions o;
  o.axes = { axis };
  o.estimateError = false;
  o.surfaces = true;
  o.steady.sides = sides;
  o.steady.stencil = image.lattice.dimension == 3 ? Stencil::D3Q7 : Stencil::D2Q5;
  o.steady.tolerance = 1e-11;
  o.steady.threads = threads;
  const DiffusionAnswer a = studyDiffusion(image, k, o, MPI_COMM_WORLD,
    [](const SteadyDiffusion&, const DiffusionAnswer&, const Lattice&, const Block&) {
    }).front();
  if (value != nullptr)
    *value = a.result.effective[static_cast<std::size_t>(axis)];
  return a.surfaces;
}

PhaseImage drawn(const Lattice& lattice, const auto& phaseAt)
{
  PhaseImage image;
  image.lattice = lattice;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
        image.phase.push_back(static_cast<std::uint8_t>(phaseAt(x, y, z)));
  return image;
}

// Layers of three phases along y, 6 thick each and 2 of the third: exact where surfaces are flat. 0 grows into 1 at one
// surface, 1 into 2 at another, 0 into 2 where the sample does not end there.
TEST(SurfaceDerivatives, AreExactAtLayers)
{
  const std::vector<double> k{ 0.2, 3.0, 0.7 };
  for (const double tall : { 1.0, 1.7 })
    for (const bool volume : { false, true })
    {
      Lattice lattice = makeLattice(8, 14, volume ? 6 : 1, volume ? 3 : 2, 1e-6, { 1, tall, 1 });
      const PhaseImage image =
        drawn(lattice, [](std::int64_t, std::int64_t y, std::int64_t) { return y < 6 ? 0
                                                                          : y < 12   ? 1
                                                                                     : 2; });
      const double n = 14 * tall;
      double value = 0;
      const SurfaceDerivatives along = surfacesOf(image, k, 0, Sides::Insulated, &value);
      EXPECT_NEAR(along.shift[1], (k[0] - k[1]) / n, 1e-9 * value);
      EXPECT_NEAR(along.shift[5], (k[1] - k[2]) / n, 1e-9 * value);
      EXPECT_NEAR(along.area[1], 1 / n, 1e-12);
      EXPECT_EQ(along.shift[2], 0);
      const SurfaceDerivatives across = surfacesOf(image, k, 1, Sides::Insulated, &value);
      EXPECT_NEAR(across.shift[1], value * value * (1 / k[1] - 1 / k[0]) / n, 1e-7 * value);
      EXPECT_NEAR(across.shift[5], value * value * (1 / k[2] - 1 / k[1]) / n, 1e-7 * value);
      const SurfaceDerivatives around = surfacesOf(image, k, 0, Sides::Periodic, &value);
      EXPECT_NEAR(around.shift[2], (k[0] - k[2]) / n, 1e-9 * value);
    }
}

// Perrins' two-term formula for square arrays (Proc. R. Soc. A 369 (1979) 207), by its own difference: steps of pixels
// leave 0.72 to 1.02 of the exact derivative at any contrast (docs/solvers/steady-diffusion.md).
double perrins(double fraction, double k)
{
  const auto exact = [k](double f)
  {
    const double t = (k - 1) / (k + 1);
    const double f4 = f * f * f * f;
    const double more = 0.305827 * t * f4 / (1 - 1.402958 * t * t * f4 * f4) + 0.013362 * t * f4 * f4;
    return 1 + 2 * f / (1 / t - f - more);
  };
  return -(exact(fraction + 1e-5) - exact(fraction - 1e-5)) / 2e-5;
}

PhaseImage disk(std::int64_t n, double radius)
{
  return drawn(
    makeLattice(n, n, 1, 2, 1e-6),
    [&](std::int64_t x, std::int64_t y, std::int64_t)
    { return std::hypot(static_cast<double>(x) - 31.3, static_cast<double>(y) - 31.6) < radius ? 1 : 0; });
}

TEST(SurfaceDerivatives, AreNearlyExactAroundDisks)
{
  constexpr std::int64_t n = 64;
  for (const double f : { 0.2, 0.5 })
  {
    const double radius = n * std::sqrt(f / M_PI);
    const PhaseImage image = disk(n, radius);
    for (const double k : { 0.0, 0.01, 0.3, 3.0, 100.0, 1e4 })
    {
      const double truth = perrins(f, k) * 2 * M_PI * radius / (n * n);
      const SurfaceDerivatives d = surfacesOf(image, { 1, k }, 0, Sides::Periodic);
      EXPECT_GT(d.shift[1] / truth, 0.72) << f << ' ' << k;
      EXPECT_LT(d.shift[1] / truth, 1.02) << f << ' ' << k;
      EXPECT_NEAR(d.area[1], 2 * M_PI * radius / (n * n), 0.04 * d.area[1]);
    }
  }
}

// Rayleigh's formula for simple cubic arrays (Phil. Mag. 34 (1892) 481), right to 1e-4 at this fraction.
TEST(SurfaceDerivatives, AreNearlyExactAroundSpheres)
{
  const auto exact = [](double f, double k)
  { return 1 - 3 * f / ((2 + k) / (1 - k) + f - 0.523 * (1 - k) / (4.0 / 3 + k) * std::pow(f, 10.0 / 3)); };
  constexpr std::int64_t n = 40;
  constexpr double f = 0.15;
  const double radius = n * std::cbrt(3 * f / (4 * M_PI));
  const PhaseImage image = drawn(makeLattice(n, n, n, 3, 1e-6),
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    {
      return std::hypot(static_cast<double>(x) - 19.3, static_cast<double>(y) - 19.6, static_cast<double>(z) - 19.4) <
          radius
        ? 1
        : 0;
    });
  for (const double k : { 0.0, 0.1, 10.0, 1000.0 })
  {
    const double truth = -(exact(f + 1e-5, k) - exact(f - 1e-5, k)) / 2e-5 * 4 * M_PI * radius * radius / (n * n * n);
    const SurfaceDerivatives d = surfacesOf(image, { 1, k }, 2, Sides::Periodic);
    EXPECT_GT(d.shift[1] / truth, 0.72) << k;
    EXPECT_LT(d.shift[1] / truth, 1.05) << k;
    EXPECT_NEAR(d.area[1], 4 * M_PI * radius * radius / (n * n * n), 0.06 * d.area[1]);
  }
}

TEST(SurfaceDerivatives, AreTheSameOnThreadsAndOfPixelsThatAreSplit)
{
  const PhaseImage image = cells({ 26, 18, 12 });
  const SurfaceDerivatives one = surfacesOf(image, { 0.03, 1, 0.3 }, 1, Sides::Mixed);
  const SurfaceDerivatives three = surfacesOf(image, { 0.03, 1, 0.3 }, 1, Sides::Mixed, nullptr, 3);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(one.shift[i], three.shift[i], 1e-6 * std::abs(one.shift[i]));
  StudyOptions o;
  o.axes = { 0 };
  o.estimateError = false;
  o.surfaces = true;
  o.steady.tolerance = 1e-10;
  std::array<double, 2> shift{};
  for (const int refinement : { 1, 3 })
  {
    o.refinement = refinement;
    const PhaseImage flat =
      drawn(makeLattice(10, 10, 1, 2, 1e-6), [](std::int64_t, std::int64_t y, std::int64_t) { return y < 4 ? 0 : 1; });
    shift[refinement == 3 ? 1 : 0] =
      studyDiffusion(flat, std::vector<double>{ 0.2, 1 }, o, MPI_COMM_WORLD).front().surfaces.shift[1];
  }
  EXPECT_NEAR(shift[0], shift[1], 1e-8);
}

// A sheet within a plane of voxels, whose shares tell where its faces lie.
TEST(SurfaceDerivatives, AreThoseOfSharesToo)
{
  const PhaseImage image = drawn(makeLattice(8, 20, 1, 2, 1e-6),
    [](std::int64_t, std::int64_t y, std::int64_t) { return y < 6 ? 0
                                                       : y == 6   ? 1
                                                                  : 2; });
  const std::vector<double> share{ 0, 0.3, 1 };
  StudyOptions o;
  o.axes = { 0, 1 };
  o.estimateError = false;
  o.surfaces = true;
  o.steady.tolerance = 1e-11;
  const std::vector<DiffusionAnswer> answers = studyShares(image, share, 1.0, 4.0, o, MPI_COMM_WORLD,
    [](const SteadyDiffusion&, const DiffusionAnswer&, const Lattice&, const Block&) {});
  EXPECT_NEAR(answers[0].surfaces.shift[1], (1.0 - 4.0) / 20, 1e-7);
  EXPECT_NEAR(answers[0].surfaces.area[1], 1.0 / 20, 1e-12);
}

// Of phases with an axis, on elements.

DiffusionAnswer turnedSurfaces(const PhaseImage& image, const DirectedDiffusivity& phases, int axis,
  Sides sides = Sides::Periodic, MPI_Comm comm = MPI_COMM_SELF)
{
  StudyOptions o;
  o.axes = { axis };
  o.estimateError = false;
  o.surfaces = true;
  o.steady.sides = sides;
  o.steady.stencil = Stencil::Q1;
  o.steady.tolerance = 1e-11;
  o.steady.fieldTolerance = 1e-8;
  o.directed = std::make_shared<DirectedDiffusivity>(phases);
  return studyDiffusion(image, phases.larger(), o, comm,
    [](const SteadyDiffusion&, const DiffusionAnswer&, const Lattice&, const Block&) {})
    .front();
}

using Tensor = std::array<std::array<double, 3>, 3>;

Tensor tensorOf(double along, double across, std::array<double, 3> axis)
{
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  Tensor d{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      d[a][b] = (a == b ? across : 0.0) + (along - across) * axis[a] * axis[b] / (length * length);
  return d;
}

/// g·D g of layers, the mean gradient g along an axis: flux through the layers and gradient along them are the same in
/// all (of the normal n, with D_n the flux through a layer: Σ s D − (D n)(n D) / D_nn and what carries flux through).
double layered(
  const std::vector<Tensor>& phases, const std::vector<double>& shares, std::array<double, 3> n, std::size_t axis)
{
  double yield = 0;   // Σ s / D_nn
  double coupled = 0; // Σ s (D n)_axis / D_nn
  double rest = 0;    // Σ s (D − (D n)(n D) / D_nn) at axis, axis
  for (std::size_t p = 0; p < phases.size(); ++p)
  {
    std::array<double, 3> dn{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        dn[a] += phases[p][a][b] * n[b];
    const double nn = dn[0] * n[0] + dn[1] * n[1] + dn[2] * n[2];
    yield += shares[p] / nn;
    coupled += shares[p] * dn[axis] / nn;
    rest += shares[p] * (phases[p][axis][axis] - dn[axis] * dn[axis] / nn);
  }
  return rest + coupled * coupled / yield;
}

/// By difference: how that changes where the first of two phases takes from the second, by share.
double byShare(const std::vector<Tensor>& phases, std::vector<double> shares, std::array<double, 3> n, std::size_t axis,
  std::array<std::size_t, 2> pair)
{
  const double h = 1e-5;
  shares[pair[0]] += h;
  shares[pair[1]] -= h;
  const double more = layered(phases, shares, n, axis);
  shares[pair[0]] -= 2 * h;
  shares[pair[1]] += 2 * h;
  return (more - layered(phases, shares, n, axis)) / (2 * h);
}

// Layers of 6, 6 and 4 voxels, which meet in pairs once each, across every axis, two phases with axes at odd angles:
// exact where surfaces are flat. Tensors are in single precision, 6e-8 of each, and differ to 50 times the value.
TEST(SurfaceDerivatives, AreExactAtLayersOfTensors)
{
  for (const int dimension : { 2, 3 })
    for (int across = 0; across < dimension; ++across)
    {
      std::array<std::int64_t, 3> size{ 3, 3, dimension == 3 ? 3 : 1 };
      size[static_cast<std::size_t>(across)] = 16;
      const Lattice lattice =
        makeLattice(size[0], size[1], size[2], dimension, 1e-6, { 1, 1.5, dimension == 3 ? 0.8 : 1 });
      const PhaseImage image = drawn(lattice,
        [&](std::int64_t x, std::int64_t y, std::int64_t z)
        {
          const std::int64_t at = across == 0 ? x : across == 1 ? y : z;
          return at < 6 ? 0 : at < 12 ? 1 : 2;
        });
      DirectedDiffusivity phases{ { 0.2, 3.0, 1.0 }, { 0.2, 0.5, 2.0 }, {} };
      const std::array<float, 3> turned{ 0.6F, 0.7F, dimension == 3 ? 0.4F : 0.0F };
      phases.axis.assign(image.phase.size(), turned);
      std::vector<Tensor> tensors;
      for (std::size_t p = 0; p < 3; ++p)
        tensors.push_back(tensorOf(phases.along[p], phases.across[p], { turned[0], turned[1], turned[2] }));
      std::array<double, 3> n{ 0, 0, 0 };
      n[static_cast<std::size_t>(across)] = 1;
      const std::vector<double> shares{ 6.0 / 16, 6.0 / 16, 4.0 / 16 };
      for (int axis = 0; axis < dimension; ++axis)
      {
        const DiffusionAnswer a = turnedSurfaces(image, phases, axis);
        const double value = a.result.effective[static_cast<std::size_t>(axis)];
        EXPECT_NEAR(value, layered(tensors, shares, n, static_cast<std::size_t>(axis)), 1e-6 * value);
        const double edge = 1 / (16 * lattice.aspect[static_cast<std::size_t>(across)]); // along x, over the box
        for (const std::array<std::size_t, 2> pair : { std::array<std::size_t, 2>{ 0, 1 }, { 0, 2 }, { 1, 2 } })
        {
          EXPECT_NEAR(a.surfaces.shift[3 * pair[0] + pair[1]],
            edge * byShare(tensors, shares, n, static_cast<std::size_t>(axis), pair), 3e-6 * value)
            << dimension << across << axis << pair[0] << pair[1];
          EXPECT_NEAR(a.surfaces.area[3 * pair[0] + pair[1]], edge, 1e-12);
        }
      }
    }
}

// Layers across (a, b), walls along themselves three times as conductive as across, and at an odd angle to them: steps
// of pixels leave 0.88 to 1.05 of the exact derivative (docs/solvers/steady-diffusion.md).
TEST(SurfaceDerivatives, AreNearlyExactAtTiltedLayersOfTensors)
{
  constexpr std::int64_t n = 96;
  for (const std::array<int, 2> tilt : { std::array<int, 2>{ 1, 1 }, { 1, 2 }, { 3, 1 }, { 2, 3 } })
    for (const double lumen : { 0.03, 10.0 })
      for (const bool odd : { false, true })
      {
        const double length = std::hypot(tilt[0], tilt[1]);
        const std::array<double, 3> normal{ tilt[0] / length, tilt[1] / length, 0 };
        const std::array<double, 3> axis = odd ? std::array{ 0.6, 0.8, 0.0 } : std::array{ -normal[1], normal[0], 0.0 };
        DirectedDiffusivity phases{ { lumen, 3 }, { lumen, 1 }, {} };
        const PhaseImage image = drawn(makeLattice(n, n, 1, 2, 1e-6),
          [&](std::int64_t x, std::int64_t y, std::int64_t)
          { return (static_cast<double>((tilt[0] * x + tilt[1] * y) % n) + 0.3) / n < 0.6 ? 0 : 1; });
        phases.axis.assign(image.phase.size(), { static_cast<float>(axis[0]), static_cast<float>(axis[1]), 0.0F });
        const std::vector<Tensor> tensors{ tensorOf(lumen, lumen, axis), tensorOf(3, 1, axis) };
        for (const std::size_t along : { 0U, 1U })
        {
          const DiffusionAnswer a = turnedSurfaces(image, phases, static_cast<int>(along));
          // both surfaces of a layer, whose layers are n over the tilt's length wide
          const double truth = 2 * length / n * byShare(tensors, { 0.6, 0.4 }, normal, along, { 0, 1 });
          EXPECT_GT(a.surfaces.shift[1] / truth, 0.87) << tilt[0] << tilt[1] << ' ' << lumen << odd << along;
          EXPECT_LT(a.surfaces.shift[1] / truth, 1.06) << tilt[0] << tilt[1] << ' ' << lumen << odd << along;
          EXPECT_NEAR(a.surfaces.area[1], 2 * length / n, 0.05 * a.surfaces.area[1]);
        }
      }
}

// A lumen in a round wall that conducts along itself, in a medium that conducts as both do together (Hashin's coated
// cylinder), so that the field around is uniform and all is known: u = C r cos φ in the lumen, (A r^λ + B r^-λ) cos φ
// in the wall, λ² = along / across. How the value changes is made of what runs along the surface and of what crosses
// it, of unlike signs where both phases conduct: steps of pixels leave at most a fifth of the sum of their sizes, where
// a lumen that conducts less meets its wall at most 0.06 (docs/solvers/steady-diffusion.md).
TEST(SurfaceDerivatives, AreNearlyExactAroundRoundWalls)
{
  constexpr std::int64_t n = 64;
  constexpr double inner = 0.3 * n;
  constexpr double outer = 0.42 * n;
  constexpr double middle = 31.4;
  for (const double along : { 1.0, 3.0, 10.0 })
    for (const double lumen : { 0.0, 0.05, 5.0 })
    {
      const double power = std::sqrt(along);
      const double t = (power - lumen) / (power + lumen);
      const double rho = std::pow(inner / outer, 2 * power);
      const double medium = power * (1 - t * rho) / (1 + t * rho);
      DirectedDiffusivity phases{ { lumen, along, medium }, { lumen, 1, medium }, {} };
      const PhaseImage image = drawn(makeLattice(n, n, 1, 2, 1e-6),
        [&](std::int64_t x, std::int64_t y, std::int64_t)
        {
          const double across = static_cast<double>(x) - middle;
          const double up = static_cast<double>(y) - middle;
          const double r = std::hypot(across, up);
          phases.axis.push_back({ static_cast<float>(-up / r), static_cast<float>(across / r), 0.0F });
          return r < inner ? 0 : r < outer ? 1 : 2;
        });
      const SurfaceDerivatives d = turnedSurfaces(image, phases, 0).surfaces;
      const double field = (1 + t) / (1 + t * rho) * std::pow(inner / outer, power - 1); // in the lumen
      const auto held = [&](double shift, double radius, double one, double other, double share)
      {
        const double unit = M_PI * radius / (n * n);
        EXPECT_NEAR(shift, unit * (one + other), share * unit * (std::abs(one) + std::abs(other)))
          << along << ' ' << lumen << " at " << radius;
      };
      const double square = field * field;
      held(d.shift[1], inner, square * (lumen - along), square * (lumen * lumen - lumen), lumen < 1 ? 0.07 : 0.2);
      held(d.shift[5], outer, along - medium, medium - medium * medium, 0.2);
    }
}

// Of one conductivity each elements tell more than links: 0.91 to 1.02 of Perrins' at any contrast.
TEST(SurfaceDerivatives, AreNearerOnElements)
{
  constexpr std::int64_t n = 64;
  for (const double f : { 0.2, 0.5 })
  {
    const double radius = n * std::sqrt(f / M_PI);
    const PhaseImage image = disk(n, radius);
    for (const double k : { 0.0, 0.01, 0.3, 3.0, 100.0, 1e4 })
    {
      const double truth = perrins(f, k) * 2 * M_PI * radius / (n * n);
      DirectedDiffusivity phases{ { 1, k }, { 1, k }, {} };
      phases.axis.assign(image.phase.size(), { 0.0F, 0.0F, 0.0F });
      const SurfaceDerivatives d = turnedSurfaces(image, phases, 0).surfaces;
      EXPECT_GT(d.shift[1] / truth, 0.91) << f << ' ' << k;
      EXPECT_LT(d.shift[1] / truth, 1.02) << f << ' ' << k;
    }
  }
}

// On ranks, which have a block each: those of one, to the sums' round-off.
TEST(SurfaceDerivatives, OfTensorsAreTheSameOnRanks)
{
  for (const std::array<std::int64_t, 3> size : { std::array<std::int64_t, 3>{ 26, 18, 12 }, { 40, 30, 1 } })
    for (const Sides sides : { Sides::Insulated, Sides::Mixed, Sides::Periodic })
    {
      const PhaseImage image = cells(size);
      DirectedDiffusivity phases{ { 0.03, 1, 0.3 }, { 0.03, 0.4, 0.9 }, {} };
      for (std::size_t i = 0; i < image.phase.size(); ++i)
        phases.axis.push_back({ static_cast<float>(std::cos(0.1 * static_cast<double>(i % 31))),
          static_cast<float>(std::sin(0.1 * static_cast<double>(i % 31))), size[2] > 1 ? 0.4F : 0.0F });
      const SurfaceDerivatives one = turnedSurfaces(image, phases, 1, sides).surfaces;
      const SurfaceDerivatives all = turnedSurfaces(image, phases, 1, sides, MPI_COMM_WORLD).surfaces;
      for (std::size_t i = 0; i < one.shift.size(); ++i)
      {
        EXPECT_NEAR(all.shift[i], one.shift[i], 1e-6 * std::abs(one.shift[i])) << i;
        EXPECT_NEAR(all.area[i], one.area[i], 1e-12);
      }
    }
}

TEST(SurfaceDerivatives, AreRefusedWhereTheyAreNotKnown)
{
  StudyOptions o;
  o.axes = { 0 };
  o.estimateError = false;
  o.surfaces = true;
  const PhaseImage image = cells({ 26, 18, 1 });
  auto directed = std::make_shared<DirectedDiffusivity>(DirectedDiffusivity{ { 0.1, 1, 1 }, { 0.1, 0.5, 1 }, {} });
  directed->axis.assign(image.phase.size(), { 1.0F, 0.0F, 0.0F });
  o.directed = directed;
  EXPECT_THROW((void)studyDiffusion(image, directed->larger(), o, MPI_COMM_SELF), ParameterError);
}

} // namespace
