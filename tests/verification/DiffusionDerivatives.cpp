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
  if (c.stencil == Stencil::Q1 && Communicator(MPI_COMM_WORLD).parallel())
    GTEST_SKIP() << "elements work on one rank";
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

} // namespace
