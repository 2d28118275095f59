// Shares of two phases from their labels: surfaces without steps that neither grow nor shrink.
#include "lattice/LabelShares.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

using namespace lamella;

namespace
{

using Labels = std::vector<std::uint8_t>;

constexpr int most = shareLevels - 1;
constexpr std::array around{ true, true, true };

Lattice box(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  return makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, 1.0);
}

/// @param inside of the middle of each node, in nodes
Labels labelled(const Lattice& lattice, const std::function<bool(double, double, double)>& inside)
{
  Labels label;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
        label.push_back(
          inside(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5) ? 1 : 0);
  return label;
}

double volume(const Labels& share)
{
  return std::accumulate(share.begin(), share.end(), 0.0) / most;
}

/// Balls, a wall one node thick, a node alone: all that there may be.
Labels mixture(const Lattice& lattice, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  std::array<std::array<double, 4>, 5> ball{};
  for (auto& b : ball)
    for (std::size_t i = 0; i < 4; ++i)
      b[i] = static_cast<double>(random() % 1000) / 1000 * (i < 3 ? static_cast<double>(lattice.size[i]) : 7.0);
  return labelled(lattice,
    [&](double x, double y, double z)
    {
      for (const auto& b : ball)
        if (std::hypot(x - b[0], y - b[1], z - b[2]) < b[3])
          return true;
      return std::abs(x + 0.4 * y - 18) < 0.5 || (x == 2.5 && y == 3.5);
    });
}

TEST(LabelShares, APlaneCutsACubeExactly)
{
  EXPECT_EQ(cubeShare(0.2, { 0, 0, 0 }), 1);
  EXPECT_EQ(cubeShare(-0.2, { 0, 0, 0 }), 0);
  EXPECT_DOUBLE_EQ(cubeShare(0, { 0.3, -2, 1 }), 0.5);
  EXPECT_DOUBLE_EQ(cubeShare(0.2, { 0, -1, 0 }), 0.7);
  EXPECT_DOUBLE_EQ(cubeShare(-0.4, { 0, 2, 0 }), 0.3);
  for (const double cut : { 0.1, 0.5, 0.9 })
  {
    // a corner of edge `cut`; an edge of that width
    EXPECT_NEAR(cubeShare(cut - 1.5, { 1, -1, 1 }), cut * cut * cut / 6, 1e-15);
    EXPECT_NEAR(cubeShare(1.5 - cut, { 1, -1, 1 }), 1 - cut * cut * cut / 6, 1e-15);
    EXPECT_NEAR(cubeShare(cut - 1, { 0, 1, 1 }), cut * cut / 2, 1e-15);
    EXPECT_NEAR(cubeShare(cut - 1 - 1e-9, { 1e-9, 1, 1 }), cut * cut / 2, 1e-8);
  }
  // slopes of 1, 2 and 3 along the edges, 2 and 2.5 from the corner: (2³ − 1³)/36, and (2.5³ − 1.5³ − 0.5³)/36
  EXPECT_NEAR(cubeShare(-1, { 1, 2, 3 }), 7.0 / 36, 1e-15);
  EXPECT_NEAR(cubeShare(-0.5, { 3, 1, -2 }), 12.125 / 36, 1e-15);
}

// Between two layers of nodes a surface lies half-way, by symmetry.
TEST(LabelShares, FlatLayersAreExact)
{
  for (const std::int64_t thick : { 2, 3, 4, 7 })
  {
    const Lattice lattice = box(24, 6, 5);
    const Labels label =
      labelled(lattice, [&](double x, double, double) { return x > 5 && x < 5 + static_cast<double>(thick); });
    const Labels share = labelShares(lattice, label, 1, around, 1);
    for (std::size_t i = 0; i < share.size(); ++i)
      EXPECT_EQ(share[i], most * label[i]) << thick << " " << i;
  }
}

// Of a plane at an angle to the lattice labels are off by noise, that falls with the nodes that a surface is smoothed
// over: measured 7 and 11 times less, root mean square, 6 and 8 times with the faces; close to an axis, where steps are
// ten nodes long, 4.1 and 3.4 times.
TEST(LabelShares, PlanesAtAnglesComeNearer)
{
  const Lattice lattice = box(40, 40, 40);
  for (const auto& n : { std::array{ 1.0, 0.37, 0.61 }, std::array{ 0.27, 0.83, -0.48 }, std::array{ 0.1, 0.2, 0.95 } })
  {
    const double length = std::hypot(n[0], n[1], n[2]);
    const std::array<double, 3> normal{ n[0] / length, n[1] / length, n[2] / length };
    const auto level = [&](double x, double y, double z)
    { return normal[0] * (x - 20.2) + normal[1] * (y - 19.7) + normal[2] * (z - 20.4); };
    const Labels label = labelled(lattice, [&](double x, double y, double z) { return level(x, y, z) > 0; });
    const Labels share = labelShares(lattice, label, 1, { false, false, false }, 2);
    for (const std::int64_t margin : { 12, 0 })
    {
      double squares = 0;
      double plain = 0;
      double sum = 0;
      int cut = 0;
      for (std::int64_t z = margin; z < 40 - margin; ++z)
        for (std::int64_t y = margin; y < 40 - margin; ++y)
          for (std::int64_t x = margin; x < 40 - margin; ++x)
          {
            const auto i = static_cast<std::size_t>(lattice.index(x, y, z));
            const double exact = cubeShare(
              level(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5), normal);
            const double error = share[i] / static_cast<double>(most) - exact;
            squares += error * error;
            plain += (label[i] - exact) * (label[i] - exact);
            sum += error;
            cut += exact > 0 && exact < 1 ? 1 : 0;
          }
      EXPECT_LT((n[0] > 0.2 ? 25 : 9) * squares, plain) << n[0] << " " << margin;
      EXPECT_LT(std::abs(sum / cut), 0.02) << n[0]; // nodes: 0.29/√cut is 0.014 and less
    }
  }
}

// Labels of a ball anywhere have its volume but for noise, 0.29 √area nodes; smoothed they keep it: on the mean of
// many, neither more nor less. A blur would shrink balls by its variance over the radius, 0.2 of a node at 10.
TEST(LabelShares, BallsNeitherGrowNorShrink)
{
  std::mt19937_64 random(3);
  for (const double radius : { 2.0, 3.0, 4.5, 8.0, 12.0 })
  {
    const auto n = static_cast<std::int64_t>(2 * radius + 10);
    const Lattice lattice = box(n, n, n);
    const double area = 4 * std::numbers::pi * radius * radius;
    constexpr int tries = 12;
    double moved = 0;
    for (int i = 0; i < tries; ++i)
    {
      std::array<double, 3> c{};
      for (double& each : c)
        each = 0.5 * static_cast<double>(n) + static_cast<double>(random() % 1000) / 1000;
      const Labels label = labelled(
        lattice, [&](double x, double y, double z) { return std::hypot(x - c[0], y - c[1], z - c[2]) < radius; });
      const double labels = std::accumulate(label.begin(), label.end(), 0.0);
      const double found = volume(labelShares(lattice, label, 1, around, 1));
      EXPECT_NEAR(found, labels, 0.03 * area) << radius;
      moved += (found - radius / 3 * area) / area / tries;
    }
    EXPECT_LT(std::abs(moved), 0.02 + 2 * 0.29 / std::sqrt(area * tries)) << radius;
  }
}

TEST(LabelShares, NothingVanishesAndWhatIsFarStays)
{
  const Lattice lattice = box(30, 22, 20);
  Labels label = mixture(lattice, 5);
  const Labels share = labelShares(lattice, label, 1, around, 1);
  for (std::size_t i = 0; i < label.size(); ++i)
    EXPECT_EQ(2 * share[i] > most, label[i] == 1);
  // a node alone
  label.assign(label.size(), 0);
  label[static_cast<std::size_t>(lattice.index(14, 11, 10))] = 1;
  const Labels one = labelShares(lattice, label, 1, around, 1);
  EXPECT_NEAR(volume(one), 1, 0.5);
  for (std::int64_t i = 0; i < lattice.count(); ++i)
    if (std::abs(i % 30 - 14) > 1)
      EXPECT_EQ(one[static_cast<std::size_t>(i)], 0);
  // no surface
  label.assign(label.size(), 7);
  EXPECT_EQ(labelShares(lattice, label, 7, around, 1), Labels(label.size(), most));
}

TEST(LabelShares, SwappingMirroringShiftingAndThreadsChangeNothing)
{
  for (const Lattice& lattice : { box(31, 70, 67), box(75, 41, 1) })
  {
    const std::int64_t nx = lattice.size[0];
    const std::int64_t ny = lattice.size[1];
    const std::int64_t nz = lattice.size[2];
    const Labels label = mixture(lattice, 11);
    const Labels share = labelShares(lattice, label, 1, around, 1);
    EXPECT_EQ(labelShares(lattice, label, 1, around, 3), share);
    Labels other = labelShares(lattice, label, 0, around, 2);
    for (std::uint8_t& each : other)
      each = static_cast<std::uint8_t>(most - each);
    EXPECT_EQ(other, share);
    for (const auto& wraps : { around, std::array{ false, true, false } })
    {
      const Labels straight = labelShares(lattice, label, 1, wraps, 1);
      const auto turned = [&](const Labels& from)
      {
        Labels to(from.size());
        for (std::int64_t z = 0; z < nz; ++z)
          for (std::int64_t y = 0; y < ny; ++y)
            for (std::int64_t x = 0; x < nx; ++x)
              to[static_cast<std::size_t>(lattice.index(nx - 1 - x, ny - 1 - y, z))] =
                from[static_cast<std::size_t>(lattice.index(x, y, z))];
        return to;
      };
      EXPECT_EQ(labelShares(lattice, turned(label), 1, wraps, 2), turned(straight));
    }
    const auto shifted = [&](const Labels& from)
    {
      Labels to(from.size());
      for (std::int64_t z = 0; z < nz; ++z)
        for (std::int64_t y = 0; y < ny; ++y)
          for (std::int64_t x = 0; x < nx; ++x)
            to[static_cast<std::size_t>(lattice.index((x + 5) % nx, (y + 33) % ny, (z + 50) % nz))] =
              from[static_cast<std::size_t>(lattice.index(x, y, z))];
      return to;
    };
    EXPECT_EQ(labelShares(lattice, shifted(label), 1, around, 2), shifted(share));
  }
}

TEST(LabelShares, OneLabelANode)
{
  EXPECT_THROW((void)labelShares(box(4, 4, 4), Labels(63), 1, around, 1), ParameterError);
}

} // namespace
