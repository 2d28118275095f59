// Contracts of material points: what they are made of, shapes, walls on the grid, and what is refused.
#include "core/Error.h"
#include "mpm/GridWalls.h"
#include "mpm/MaterialPoints.h"
#include "mpm/NeoHookean.h"
#include "mpm/PointDynamics.h"
#include "mpm/ShapeFunctions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::mpm;

MaterialPoints<2> square(int nodes, int perNode)
{
  const Lattice lattice = makeLattice(nodes, nodes, 1, 2, 0.5);
  const std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()), 1);
  PointOptions options;
  options.perNode = perNode;
  options.density = { 2 };
  return pointsFromLattice<2>(lattice, phase, {}, options);
}

TEST(MaterialPoints, FillTheNodesThatAreNotEmpty)
{
  const Lattice lattice = makeLattice(2, 1, 1, 2, 0.5);
  const std::vector<std::uint8_t> phase{ 0, 2 };
  const std::vector<std::array<float, 2>> axis{ { 1, 0 }, { 0, -3 } };
  PointOptions options;
  options.perNode = 3;
  options.density = { 0, 0, 1200 };
  const auto points = pointsFromLattice<2>(lattice, phase, axis, options);
  ASSERT_EQ(points.count(), 9U);
  double mass = 0;
  for (std::size_t p = 0; p < 9; ++p)
  {
    EXPECT_NEAR(points.column(0)[p], 0.5 + (static_cast<double>(p % 3) + 0.5) / 6, 1e-15);
    EXPECT_NEAR(points.column(1)[p], (static_cast<double>(p / 3) + 0.5) / 6, 1e-15);
    EXPECT_EQ(points.phase()[p], 2);
    EXPECT_EQ(points.id()[p], p);
    EXPECT_EQ(points.column(MaterialPoints<2>::axes + 1)[p], -1);
    mass += points.column(MaterialPoints<2>::masses)[p];
  }
  EXPECT_NEAR(mass, 1200 * 0.25, 1e-10);
}

TEST(MaterialPoints, CanBeSortedAndKeepTheirNumbers)
{
  auto points = square(2, 1);
  const std::vector<std::uint32_t> order{ 3, 0, 2, 1 };
  points.reorder(order);
  for (std::size_t p = 0; p < 4; ++p)
  {
    EXPECT_EQ(points.id()[p], order[p]);
    EXPECT_EQ(points.column(0)[p], 0.25 + 0.5 * (order[p] % 2));
  }
}

// In a plane 101 bytes a point, in space 165, and 8 for each number of a law's history; no more than a cache line or
// two a column beside.
TEST(MaterialPoints, TakeTheBytesThatTheDocsTell)
{
  constexpr std::size_t count = 100000;
  const auto each = [](std::size_t bytes) { return static_cast<double>(bytes) / count; };
  EXPECT_NEAR(each(MaterialPoints<2>(count).bytes()), 101, 0.1);
  EXPECT_NEAR(each(MaterialPoints<3>(count).bytes()), 165, 0.1);
  EXPECT_NEAR(each(MaterialPoints<3>(count, 3).bytes()), 165 + 24, 0.1);
}

TEST(MaterialPoints, RefuseWhatTheyCannotBeMadeOf)
{
  const Lattice lattice = makeLattice(2, 1, 1, 2, 0.5);
  const std::vector<std::uint8_t> phase{ 1, 1 };
  const std::vector<std::uint8_t> empty{ 0, 0 };
  PointOptions options;
  EXPECT_THROW((void)pointsFromLattice<2>(lattice, empty, {}, options), InputError);
  EXPECT_THROW((void)pointsFromLattice<2>(lattice, std::span(phase).first(1), {}, options), InputError);
  options.density = { 1, -1 };
  EXPECT_THROW((void)pointsFromLattice<2>(lattice, phase, {}, options), ParameterError);
  options.perNode = 0;
  EXPECT_THROW((void)pointsFromLattice<2>(lattice, phase, {}, options), ParameterError);
}

template <class Shape>
void reproducesLinearFields(double width)
{
  for (double x = 0.013; x < 3; x += 0.107)
  {
    const auto s = Shape::at(x, width);
    double one = 0;
    double place = 0;
    double slope = 0;
    double none = 0;
    double moment = 0;
    for (int a = 0; a < Shape::nodes; ++a)
    {
      one += s.value[a];
      place += s.value[a] * (s.base + a);
      none += s.gradient[a];
      slope += s.gradient[a] * (s.base + a);
      moment += s.value[a] * std::pow(s.base + a - x, 2);
      // gradient: by central differences, exact for what is quadratic unless a knot lies between
      const double d = 1e-7;
      const auto value = [&](double at)
      {
        const auto t = Shape::at(at, width);
        const int i = s.base + a - t.base;
        return i >= 0 && i < Shape::nodes ? t.value[i] : 0;
      };
      EXPECT_NEAR(s.gradient[a], (value(x + d) - value(x - d)) / (2 * d), 1e-6);
    }
    EXPECT_NEAR(one, 1, 1e-14);
    EXPECT_NEAR(place, x, 1e-13);
    EXPECT_NEAR(none, 0, 1e-14);
    EXPECT_NEAR(slope, 1, 1e-13);
    EXPECT_NEAR(Shape::moment(s, x), moment, 1e-13);
  }
}

TEST(ShapeFunctions, ReproduceLinearFields)
{
  reproducesLinearFields<Linear>(0);
  reproducesLinearFields<Gimp>(0.5);
  reproducesLinearFields<QuadraticSpline>(0);
}

TEST(GridWalls, SplinesHaveTheWallsVelocityThere)
{
  GridAxis x{ 0, 0.5, 6, { Edge::Wall, Edge::Wall } };
  GridAxis y{ 0, 0.5, 5, { Edge::Wall, Edge::Wall } };
  const BackgroundGrid<2> grid({ x, y });
  Walls<2> walls;
  walls(0, 0).velocity = 0.3;
  walls(0, 1).straight = true;
  walls(1, 1).velocity = -2;
  walls(1, 1).sticks = true;
  std::vector<double> nodes(static_cast<std::size_t>(grid.count()) * nodeValues);
  double momentum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) // any masses and momenta
    nodes[i] = i % nodeValues == 0 ? 1.5 + std::sin(static_cast<double>(i)) : std::cos(3.1 * static_cast<double>(i));
  for (std::size_t i = 0; i < nodes.size(); i += nodeValues)
    momentum += nodes[i + 1];
  const std::vector<double> given = nodes;
  const double kick = 0.1;
  constrain(grid, walls, std::span<double>(nodes), kick, true);
  const auto velocity = [&](double px, double py, int c)
  {
    const auto sx = QuadraticSpline::at(px, 0);
    const auto sy = QuadraticSpline::at(py, 0);
    double v = 0;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        v += sx.value[a] * sy.value[b] *
          nodes[static_cast<std::size_t>(grid.index({ sx.base + a, sy.base + b })) * nodeValues + 1 +
            static_cast<std::size_t>(c)];
    return v;
  };
  for (double t = 0; t < 5; t += 0.37)
  {
    if (t < 3.5) // a corner cannot both move with its side and stick
    {
      EXPECT_NEAR(velocity(0, t, 0), 0.3, 1e-14);
      EXPECT_NEAR(velocity(6 - 1e-13, t, 0), walls(0, 1).velocity, 1e-11);
    }
    EXPECT_NEAR(velocity(t, 5 - 1e-13, 1), -2, 1e-11);
    EXPECT_NEAR(velocity(t, 0, 1), 0, 1e-14);
    if (t > 1.5 && t < 4.5) // corners slide with the walls across
      EXPECT_NEAR(velocity(t, 5 - 1e-13, 0), 0, 1e-11);
  }
  EXPECT_NEAR(walls(0, 1).force, 0, 1e-12);

  // without what sticks, the walls' forces are all the momentum that is added
  walls(1, 1).sticks = false;
  nodes = given;
  constrain(grid, walls, std::span<double>(nodes), kick, true);
  double after = 0;
  for (std::size_t i = 0; i < nodes.size(); i += nodeValues)
    after += given[i] * nodes[i + 1]; // with the masses as they were spread
  EXPECT_NEAR(after - momentum, -kick * (walls(0, 0).force + walls(0, 1).force), 1e-11);
}

std::string message(const std::function<void()>& f)
{
  try
  {
    f();
  }
  catch (const Error& e)
  {
    EXPECT_FALSE(e.hint().empty());
    return e.what();
  }
  return "nothing was thrown";
}

TEST(PointDynamics, SaysWhatItCannotDo)
{
  const auto law = makeLaw<2, NeoHookean>({ { 1, 1 } });
  PointDynamicsOptions<2> options;
  options.spacing = 0.5;
  const auto attempt = [&](MaterialPoints<2> points)
  { return PointDynamics<2>(std::move(points), law, options).stableStep(); };
  const double stable = attempt(square(4, 2));

  options.step = 1.01 * stable;
  EXPECT_NE(
    message([&] { (void)attempt(square(4, 2)); }).find("is unstable: the largest stable one is"), std::string::npos);
  options.step.reset();
  options.sides[0] = { Side{ Edge::Wall, 0.3 }, Side{ Edge::Wall, 2 } };
  EXPECT_NE(message([&] { (void)attempt(square(4, 2)); }).find("is not between 0.3 and 2 m"), std::string::npos);
  options.sides[0] = { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, 1 } };
  EXPECT_NE(message([&] { (void)attempt(square(2, 2)); }).find("ends 1 m apart"), std::string::npos);
  options.sides[0] = { Side{ Edge::Periodic, 0 }, Side{} };
  EXPECT_NE(message([&] { (void)attempt(square(4, 2)); }).find("periodic at one end only"), std::string::npos);
  options.sides[0] = {};
  auto points = square(4, 2);
  points.column(3)[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message([&] { (void)attempt(points); }).find("column 3 of point 5 is nan"), std::string::npos);
  points = square(4, 2);
  points.column(MaterialPoints<2>::masses)[7] = 0;
  EXPECT_NE(message([&] { (void)attempt(points); }).find("point 7 has mass 0"), std::string::npos);
  EXPECT_NE(message([&] { (void)attempt(MaterialPoints<2>(0)); }).find("no material points"), std::string::npos);
  options.spacing = 0;
  EXPECT_NE(message([&] { (void)attempt(square(4, 2)); }).find("a grid spacing of 0 m"), std::string::npos);
}

// At step 2000 the wave factor is measured anew. What is asked to stop in the midst of that goes on as if it had not.
TEST(PointDynamics, StopsWhileItMeasuresAndGoesOn)
{
  PointDynamicsOptions<2> options;
  options.spacing = 0.5;
  options.sides = { { { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, 2 } },
    { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, 2, -1e-4 } } } };
  const auto law = makeLaw<2, NeoHookean>({ { 1, 1 } });
  PointDynamics<2> whole(square(4, 2), law, options);
  ASSERT_TRUE(whole.advance(2100));
  bool asked = false;
  options.progress = [&](std::int64_t step, double) { return step == 2000 && !std::exchange(asked, true); };
  PointDynamics<2> stopped(square(4, 2), law, options);
  ASSERT_FALSE(stopped.advance(2100));
  EXPECT_EQ(stopped.steps(), 2000);
  ASSERT_TRUE(stopped.advance(2100 - stopped.steps()));
  EXPECT_EQ(stopped.time(), whole.time());
  for (int c = 0; c < whole.points().columns(); ++c)
    for (std::size_t p = 0; p < whole.points().count(); ++p)
      ASSERT_EQ(stopped.points().column(c)[p], whole.points().column(c)[p]) << c << ", " << p;
  options.progress = [](std::int64_t, double) { return true; };
  EXPECT_EQ(message([&] { PointDynamics<2>(square(4, 2), law, options); }), "interrupted");
}

TEST(PointDynamics, StopsWhenPlatensMeet)
{
  PointDynamicsOptions<2> options;
  options.spacing = 0.5;
  options.sides = { { { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, 2 } },
    { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, 2, -0.1 } } } };
  PointDynamics<2> body(square(4, 2), makeLaw<2, NeoHookean>({ { 1, 1 } }), options);
  EXPECT_NE(message([&] { body.advanceTo(20); }).find("three cells are"), std::string::npos);
}

} // namespace
