// Conductivities along and across an axis: exact tensors, layers and coated disks, and what the links refuse.
#include "Diffusion.h"

#include "core/Error.h"
#include "lbm/DirectedLinks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::lbm;
using namespace lamella::test;

using Axis = std::array<float, 3>;
using Tensor = std::array<double, 3>; // xx, xy, yy

Axis axisAt(double angle)
{
  return { static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.0F };
}

Tensor tensorAt(double angle, double along, double across)
{
  const Axis a = axisAt(angle);
  const double length = std::hypot(static_cast<double>(a[0]), static_cast<double>(a[1])); // of floats
  const double c = a[0] / length;
  const double s = a[1] / length;
  return { along * c * c + across * s * s, (along - across) * c * s, along * s * s + across * c * c };
}

struct Scene
{
  PhaseImage image;
  DirectedDiffusivity diffusivity;

  // phase(x, y) and angle(x, y) at the nodes' centres, in spacings
  template <class Phase, class Angle>
  Scene(std::int64_t nx, std::int64_t ny, std::vector<double> along, std::vector<double> across, Phase&& phase,
    Angle&& angle)
  {
    image = noise(nx, ny, 1, 0, 1);
    diffusivity.along = std::move(along);
    diffusivity.across = std::move(across);
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i)
      {
        const double x = static_cast<double>(i) + 0.5;
        const double y = static_cast<double>(j) + 0.5;
        image.phase[static_cast<std::size_t>(i + nx * j)] = static_cast<std::uint8_t>(phase(x, y));
        diffusivity.axis.push_back(axisAt(angle(x, y)));
      }
  }

  [[nodiscard]] SteadyOptions options(Sides sides, Method method = Method::Auto) const
  {
    SteadyOptions o;
    o.stencil = Stencil::D2Q9;
    o.sides = sides;
    o.method = method;
    o.tolerance = 1e-12;
    o.links = std::make_shared<LinkTable>(directedLinks(image.lattice, image.phase, diffusivity, sides));
    return o;
  }
  [[nodiscard]] SteadyDiffusion solver(Sides sides, Method method = Method::Auto, MPI_Comm comm = MPI_COMM_SELF) const
  {
    const Block block = decompose(image.lattice, comm);
    return { image.lattice, block, blockOf(image, block), diffusivity.larger(), options(sides, method), comm };
  }
};

const auto one = [](double, double) { return 0; };

// A uniform tensor is its own effective tensor, off the diagonal too, whichever way it points and by both methods.
TEST(DiffusionDirected, UniformTensor)
{
  for (const double ratio : { 1.5, 5.82 })
    for (int k = 0; k < 12; ++k)
    {
      const double angle = k * std::numbers::pi / 12 + std::numbers::pi / 8; // the worst one among them
      const Scene scene(16, 12, { ratio }, { 1 }, one, [&](double, double) { return angle; });
      const Tensor exact = tensorAt(angle, ratio, 1);
      for (const Method method : { Method::Auto, Method::AlgebraicMultigrid })
      {
        SteadyDiffusion solver = scene.solver(Sides::Periodic, method);
        const auto x = solver.solve(0).effective;
        const auto y = solver.solve(1).effective;
        EXPECT_NEAR(x[0], exact[0], 1e-9) << angle; // the solver's tolerance, on the field
        EXPECT_NEAR(x[1], exact[1], 1e-9) << angle;
        EXPECT_NEAR(y[0], exact[1], 1e-9) << angle;
        EXPECT_NEAR(y[1], exact[2], 1e-9) << angle;
      }
    }
}

// Along an insulated strip the gradient tilts until nothing flows across: it conducts D_xx − D_xy²/D_yy. What the two
// faces disturb dies away within some heights and is the same in two strips, so their difference is exact.
TEST(DiffusionDirected, InsulatedStrip)
{
  for (const double angle : { 0.3, -0.7, 1.2 })
    for (const int axis : { 0, 1 })
    {
      const Tensor d = tensorAt(angle, 2, 0.7);
      const auto resistance = [&](std::int64_t length)
      {
        const Scene scene(
          axis == 0 ? length : 6, axis == 0 ? 6 : length, { 2 }, { 0.7 }, one, [&](double, double) { return angle; });
        return static_cast<double>(length) /
          scene.solver(Sides::Insulated).solve(axis).effective[static_cast<std::size_t>(axis)];
      };
      const double exact = d[axis == 0 ? 0 : 2] - d[1] * d[1] / d[axis == 0 ? 2 : 0];
      EXPECT_NEAR(40 / (resistance(100) - resistance(60)), exact, 1e-9) << angle << ", axis " << axis;
    }
}

// Two equal values need no axis and give the five-point lattice, node by node.
TEST(DiffusionDirected, SameInEveryDirection)
{
  PhaseImage image = noise(21, 17, 1, 0.5, 3);
  const std::vector<double> k{ 0.05, 1 };
  for (const Sides sides : { Sides::Insulated, Sides::Periodic })
    for (const int axis : { 0, 1 })
    {
      Case plain;
      plain.axis = axis;
      plain.sides = sides;
      SteadyOptions options = optionsOf(image, plain);
      options.stencil = Stencil::D2Q9;
      DirectedDiffusivity d{ k, k, std::vector<Axis>(image.phase.size(), Axis{ 0, 0 }) };
      options.links = std::make_shared<LinkTable>(directedLinks(image.lattice, image.phase, d, sides));
      SteadyDiffusion solver(image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, k, options);
      const auto expected = solve(image, k, plain).effective;
      EXPECT_NEAR(
        solver.solve(axis).effective[static_cast<std::size_t>(axis)], expected[static_cast<std::size_t>(axis)], 1e-9);
    }
}

// Layers on the lattice whose axes lie along or across it: no diagonals, any ratio, exact at any resolution.
TEST(DiffusionDirected, LayersOnTheLattice)
{
  const Scene scene(
    12, 8, { 3, 0.02 }, { 0.06, 0.9 }, [](double x, double) { return x < 4 ? 0 : 1; },
    [](double x, double) { return x < 4 ? 0.0 : std::numbers::pi / 2; });
  // axis of the first along x: 3 along the flux; of the second along y: 0.9 along the flux
  EXPECT_NEAR(scene.solver(Sides::Insulated).solve(0).effective[0], 1 / (1.0 / 9 + 2.0 / 2.7), 1e-10);
  EXPECT_NEAR(scene.solver(Sides::Insulated).solve(1).effective[1], (0.06 + 2 * 0.02) / 3, 1e-7); // cos of a float π/2
}

// What a mirror and a turn by 90° do to the picture, they do to the answer.
TEST(DiffusionDirected, MirrorAndTurn)
{
  const auto phase = [](double x, double y) { return std::hypot(x - 9, y - 5.2) < 4.1 ? 1 : 0; };
  const auto angle = [](double x, double y) { return 0.1 * x - 0.2 * y; };
  const std::vector<double> along{ 1, 0.2 };
  const std::vector<double> across{ 0.25, 0.1 };
  const auto k = [](const Scene& s, int axis)
  { return s.solver(Sides::Insulated).solve(axis).effective[static_cast<std::size_t>(axis)]; };
  const Scene scene(20, 14, along, across, phase, angle);
  const Scene mirrored(
    20, 14, along, across, [&](double x, double y) { return phase(20 - x, y); },
    [&](double x, double y) { return -angle(20 - x, y); });
  const Scene turned(
    14, 20, along, across, [&](double x, double y) { return phase(y, 14 - x); },
    [&](double x, double y) { return angle(y, 14 - x) + std::numbers::pi / 2; });
  EXPECT_NEAR(k(mirrored, 0), k(scene, 0), 1e-6); // axes are floats
  EXPECT_NEAR(k(mirrored, 1), k(scene, 1), 1e-6);
  EXPECT_NEAR(k(turned, 1), k(scene, 0), 1e-6);
  EXPECT_NEAR(k(turned, 0), k(scene, 1), 1e-6);
}

// A disk in a coat whose axis runs round it, in a matrix that conducts as much as both together: the field outside
// stays uniform, so the cell conducts as its matrix. In the coat u = (A r^s + B r^−s) cos θ with s² = along/across.
double coatedDisk(double inner, double outer, double core, double along, double across)
{
  const double s = std::sqrt(along / across);
  const double beta = core / (across * s);
  const double q = std::pow(inner / outer, 2 * s) * (1 - beta) / (1 + beta);
  return across * s * (1 - q) / (1 + q);
}

double coatedDiskError(std::int64_t n, double core, double along, double across)
{
  const double exact = coatedDisk(0.3, 0.45, core, along, across);
  const double middle = 0.5 * static_cast<double>(n);
  const auto phase = [&](double x, double y)
  {
    const double r = std::hypot(x - middle, y - middle) / static_cast<double>(n);
    return r < 0.3 ? 0 : r < 0.45 ? 1 : 2;
  };
  const Scene scene(n, n, { core, along, exact }, { core, across, exact }, phase,
    [&](double x, double y) { return std::atan2(y - middle, x - middle) + std::numbers::pi / 2; });
  return scene.solver(Sides::Periodic).solve(0).effective[0] / exact - 1;
}

TEST(DiffusionDirected, CoatedDisks)
{
  struct Coat
  {
    double core, along, across;
  };
  std::printf("coated disks, relative error of plain pixels\n  core   along  across   64       128      256\n");
  double sum64 = 0;
  double sum256 = 0;
  for (const Coat& c : { Coat{ 0.023, 1, 1 }, Coat{ 0.023, 1.2, 0.8 }, Coat{ 0.023, 2, 0.5 }, Coat{ 0.023, 0.5, 2 },
         Coat{ 1, 0.0048, 0.0032 }, Coat{ 1, 0.008, 0.002 }, Coat{ 0.3, 1.2, 0.8 } })
  {
    std::array<double, 3> error{};
    for (int level = 0; level < 3; ++level)
      error[static_cast<std::size_t>(level)] = coatedDiskError(std::int64_t{ 64 } << level, c.core, c.along, c.across);
    std::printf("  %-6g %-6g %-8g %+.3f %% %+.3f %% %+.3f %%\n", c.core, c.along, c.across, 100 * error[0],
      100 * error[1], 100 * error[2]);
    // the isotropic coat, which is the five-point lattice's own, errs by 2.0 % at 64
    EXPECT_LT(std::abs(error[0]), 0.022);
    EXPECT_LT(std::abs(error[2]), 0.006);
    sum64 += std::abs(error[0]);
    sum256 += std::abs(error[2]);
  }
  // Pixels make the error jump about, so an order is one of the sum: at least 0.8 over two halvings.
  const double order = std::log2(sum64 / sum256) / 2;
  std::printf("  order of the sum %.2f\n", order);
  EXPECT_GT(order, 0.8);
}

// Two kinds of layers with axes of their own, tilted to the lattice by 1 : 3.
TEST(DiffusionDirected, TiltedLayers)
{
  const double normal = std::atan2(3.0, 1.0);
  const std::array<double, 2> angle{ 0.5, -0.4 };
  const std::vector<double> along{ 1.2, 0.8 };
  const std::vector<double> across{ 0.5, 0.3 };
  // in the layers' own axes: across them the flux, along them the gradient is the same in all
  std::array<Tensor, 2> d;
  for (std::size_t i = 0; i < 2; ++i)
    d[i] = tensorAt(angle[i] - normal, along[i], across[i]);
  const double nn = 2 / (1 / d[0][0] + 1 / d[1][0]);
  const double nt = nn / 2 * (d[0][1] / d[0][0] + d[1][1] / d[1][0]);
  const double tt = (d[0][2] - d[0][1] * d[0][1] / d[0][0] + d[1][2] - d[1][1] * d[1][1] / d[1][0]) / 2 + nt * nt / nn;
  const double c = std::cos(normal);
  const double s = std::sin(normal);
  const double exact = nn * c * c - 2 * nt * c * s + tt * s * s;
  double last = 0;
  for (const std::int64_t n : { 32, 64, 128 })
  {
    const auto layer = [&](double x, double y)
    { return std::fmod((x + 3 * y) / static_cast<double>(n) + 0.013, 1.0) < 0.5 ? 0 : 1; };
    const Scene scene(
      n, n, along, across, layer, [&](double x, double y) { return angle[static_cast<std::size_t>(layer(x, y))]; });
    const double error = std::abs(scene.solver(Sides::Periodic).solve(0).effective[0] / exact - 1);
    std::printf("tilted layers, %lld nodes: %.3f %%\n", static_cast<long long>(n), 100 * error);
    EXPECT_LT(error, 0.05 * 32 / static_cast<double>(n));
    if (last > 0)
      EXPECT_NEAR(std::log2(last / error), 1, 0.15); // of first order: layers keep their place on every lattice
    last = error;
  }
}

// No link is negative, so no value lies beyond those of the faces, at the largest ratio and for axes and phases that
// have nothing to do with each other; both faces agree with the energy.
TEST(DiffusionDirected, StaysBetweenTheFaces)
{
  std::mt19937_64 random(7);
  const auto any = [&](double, double) { return static_cast<double>(random() % 1000) * 0.00314; };
  const PhaseImage spots = noise(40, 30, 1, 0.4, 5);
  for (const double low : { 0.0, 1e-3 })
  {
    const Scene scene(
      40, 30, { low, 1 }, { low, mostDirected },
      [&](double x, double y)
      { return spots.phase[static_cast<std::size_t>(x) + 40 * static_cast<std::size_t>(y)] == 0 ? 1 : 0; },
      any);
    SteadyDiffusion solver = scene.solver(Sides::Insulated);
    EXPECT_LT(solver.solve(0).balance, 1e-9);
    std::vector<double> u(scene.image.phase.size());
    solver.value(u);
    for (const double value : u)
      EXPECT_TRUE(std::isnan(value) || (value > -1e-9 && value < 1 + 1e-9)) << value;
  }
}

TEST(DiffusionDirected, RanksAgree)
{
  std::mt19937_64 random(3);
  const Scene scene(
    26, 22, { 0.02, 1 }, { 0.02, 0.4 }, [&](double, double) { return random() % 2; },
    [](double x, double y) { return 0.3 * x + 0.1 * y * y; });
  for (const Sides sides : { Sides::Insulated, Sides::Periodic })
    for (const int axis : { 0, 1 })
    {
      const auto alone = scene.solver(sides).solve(axis).effective;
      const auto shared = scene.solver(sides, Method::Auto, MPI_COMM_WORLD).solve(axis).effective;
      for (std::size_t a = 0; a < (sides == Sides::Periodic ? 2U : 1U); ++a)
      {
        const std::size_t row = sides == Sides::Periodic ? a : static_cast<std::size_t>(axis);
        EXPECT_NEAR(shared[row], alone[row], 1e-9);
      }
    }
}

std::string refused(const Scene& scene)
{
  try
  {
    (void)directedLinks(scene.image.lattice, scene.image.phase, scene.diffusivity, Sides::Insulated);
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "";
}

// The bound is 3 + 2√2 at 22.5° to an axis or a diagonal; along these any ratio goes.
TEST(DiffusionDirected, WhatLinksCannotCarry)
{
  const auto scene = [](double along, double across, double angle)
  { return Scene(4, 3, { along }, { across }, one, [=](double, double) { return angle; }); };
  const double worst = std::numbers::pi / 8;
  EXPECT_NEAR(mostDirected, 3 + 2 * std::numbers::sqrt2, 1e-13);
  for (const double angle : { worst, 3 * worst, -worst })
  {
    EXPECT_EQ(refused(scene(5.828, 1, angle)), "");
    EXPECT_EQ(refused(scene(1, 5.828, angle)), "");
    EXPECT_NE(refused(scene(5.83, 1, angle)), "");
    EXPECT_NE(refused(scene(1, 5.83, angle)), "");
  }
  for (const double angle : { 0.0, 2 * worst, 4 * worst })
    EXPECT_EQ(refused(scene(1000, 1, angle)), "");
  EXPECT_EQ(refused(scene(10, 1, worst)),
    "10 along and 1 across, a ratio of 10, are more than the links of d2q9 can carry at 22.5° to the lattice (node 0, "
    "0)");

  Scene bad = scene(2, 1, 0);
  bad.diffusivity.axis[5] = { 0, 0 };
  bad.diffusivity.axis[7] = { NAN, 1 };
  EXPECT_EQ(refused(bad), "2 nodes of phases that conduct differently along and across have no axis to go by");
  bad = scene(2, 1, 0);
  bad.diffusivity.axis.pop_back();
  EXPECT_NE(refused(bad), "");
  bad = scene(2, 1, 0);
  bad.diffusivity.across.push_back(1);
  EXPECT_NE(refused(bad), "");
  bad = scene(2, -1, 0);
  EXPECT_EQ(refused(bad), "a conductivity of phase 0 is -1");
  bad = scene(2, 1, 0);
  bad.image.phase[3] = 1;
  EXPECT_EQ(refused(bad), "phase 1 has no conductivity");
  bad = scene(2, 1, 0);
  bad.image.lattice.dimension = 3;
  EXPECT_NE(refused(bad), "");

  // a table must fit its lattice, its stencil and its sides
  const Scene good = scene(2, 1, 0.3);
  const auto solver = [&](SteadyOptions options)
  {
    SteadyDiffusion(good.image.lattice, decompose(good.image.lattice, MPI_COMM_SELF), good.image.phase,
      good.diffusivity.larger(), options);
  };
  SteadyOptions options = good.options(Sides::Insulated);
  EXPECT_NO_THROW(solver(options));
  options.stencil = Stencil::D2Q5;
  EXPECT_THROW(solver(options), ParameterError);
  options.stencil = Stencil::D2Q9;
  options.sides = Sides::Periodic; // its diagonals end at the sides
  EXPECT_NO_THROW(solver(good.options(Sides::Periodic)));
  auto torn = std::make_shared<LinkTable>(*good.options(Sides::Periodic).links);
  torn->rising[0] += 1;
  options.links = torn;
  EXPECT_THROW(solver(options), ParameterError);
}

} // namespace
