#include "lattice/Subsample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

using namespace lamella;

namespace
{

/// Every node has a phase of its own, as far as 256 of them go.
PhaseImage numbered(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  PhaseImage image;
  image.lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, 2e-6);
  for (std::int64_t i = 0; i < image.lattice.count(); ++i)
    image.phase.push_back(static_cast<std::uint8_t>(i));
  return image;
}

} // namespace

TEST(Subsample, TakesEverySecondNodeFromTheFirstOn)
{
  const PhaseImage image = numbered(5, 4, 1);
  const PhaseImage part = subsample(image, { 1, 0, 0 }, 2);
  EXPECT_EQ(part.lattice.size, (std::array<std::int64_t, 3>{ 2, 2, 1 }));
  EXPECT_EQ(part.phase, (std::vector<std::uint8_t>{ 1, 3, 11, 13 }));
  EXPECT_EQ(part.lattice.spacing, 4e-6);
  EXPECT_EQ(part.lattice.dimension, 2);
  // where the node lies in the picture it is from
  EXPECT_NEAR(part.lattice.origin[0], 3e-6, 1e-18);
  EXPECT_NEAR(part.lattice.origin[1], 1e-6, 1e-18);
}

TEST(Subsample, AllOfThemTogetherAreThePictureOnce)
{
  for (const int stride : { 2, 4 })
  {
    for (const auto& image : { numbered(7, 9, 1), numbered(5, 6, 7), numbered(1, 8, 1), numbered(3, 1, 1) })
    {
      std::multiset<std::uint8_t> seen;
      for (const auto& start : subsampleStarts(image.lattice, stride, 1000))
      {
        const PhaseImage part = subsample(image, start, stride);
        EXPECT_EQ(static_cast<std::int64_t>(part.phase.size()), part.lattice.count());
        seen.insert(part.phase.begin(), part.phase.end());
      }
      EXPECT_EQ(seen, std::multiset<std::uint8_t>(image.phase.begin(), image.phase.end()));
    }
  }
}

TEST(Subsample, OfManyStartsAFewThatCrossEveryAxis)
{
  for (const int dimension : { 2, 3 })
  {
    const Lattice lattice = makeLattice(40, 41, dimension == 3 ? 42 : 1, dimension, 1);
    const auto starts = subsampleStarts(lattice, 4);
    EXPECT_GE(starts.size(), 6U);
    EXPECT_LE(starts.size(), 12U);
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimension); ++axis)
    {
      std::set<std::int64_t> used;
      for (const auto& start : starts)
        used.insert(start[axis]);
      EXPECT_EQ(used.size(), 4U) << "axis " << axis << " in " << dimension << "D";
    }
  }
}

TEST(Subsample, ThinsWhatRepeatsToWhatRepeats)
{
  // sides that can be divided: every stride-th node, whatever the shape
  const PeriodicThinning even = periodicThinning(makeLattice(12, 18, 24, 3, 1), 3);
  EXPECT_EQ(even.size, (std::array<std::int64_t, 3>{ 4, 6, 8 }));
  EXPECT_EQ(even.stride, 3);
  for (std::int64_t first = 0; first < 3; ++first)
    for (std::int64_t i = 0; i < 4; ++i)
      EXPECT_EQ(even.node(0, i, first), 3 * i + first);
  // else pixels stay squares to half a pixel in a side, of 20 here, and the stride is near the one asked for
  for (const int stride : { 2, 3, 4 })
  {
    for (std::int64_t nx = 20 * stride; nx < 20 * stride + 9; ++nx)
    {
      for (const std::int64_t ny : { nx, nx + 1, nx + 17, 2 * nx + 1 })
      {
        const PeriodicThinning t = periodicThinning(makeLattice(nx, ny, 1, 2, 1), stride);
        const double x = static_cast<double>(nx) / static_cast<double>(t.size[0]);
        const double y = static_cast<double>(ny) / static_cast<double>(t.size[1]);
        EXPECT_NEAR(x / y, 1, 0.5 / 19) << nx << " x " << ny << ", " << stride;
        EXPECT_NEAR(t.stride / stride, 1, 0.06) << nx << " x " << ny << ", " << stride;
        EXPECT_NEAR(t.stride, std::sqrt(x * y), 1e-12);
        for (std::int64_t i = 0; i + 1 < t.size[0]; ++i)
        {
          const std::int64_t gap = t.node(0, i + 1, 0) - t.node(0, i, 0);
          EXPECT_GE(gap, static_cast<std::int64_t>(x));
          EXPECT_LE(gap, static_cast<std::int64_t>(x) + 1);
        }
        EXPECT_LT(t.node(0, t.size[0] - 1, nx - 1), nx); // counted around
      }
    }
  }
  // an axis along which nothing changes has no say
  const PeriodicThinning flat = periodicThinning(makeLattice(63, 4, 1, 2, 1), 3, { true, false, true });
  EXPECT_EQ(flat.size, (std::array<std::int64_t, 3>{ 21, 1, 1 }));
  EXPECT_EQ(flat.stride, 3);
}
