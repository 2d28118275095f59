// A few of each kind of what the benchmark packing-stability runs: right, warned about or refused, never wrong in
// silence. What is right is judged by the definitions alone.
#include "PackingAtlas.h"

#include <gtest/gtest.h>

#include <functional>

namespace
{

using namespace lamella;
using namespace lamella::packing;
using namespace lamella::test;

struct Case
{
  std::string name;
  Verdict verdict;
  std::function<void(PackingOptions&)> change;
};

class PackingStands : public testing::TestWithParam<Case>
{
};

TEST_P(PackingStands, OrSaysSo)
{
  PackingOptions o;
  o.count = 60;
  o.aspect = 1;
  o.softness = 1e-5;
  GetParam().change(o);
  const Outcome found = attempt(o);
  EXPECT_NE(found.verdict, Verdict::Wrong) << found.what;
  if (GetParam().verdict != Verdict::Warned) // whether a few grains find a good shape is chance
    EXPECT_EQ(found.verdict, GetParam().verdict) << found.what;
}

INSTANTIATE_TEST_SUITE_P(All, PackingStands,
  testing::Values(Case{ "equal_grains", Verdict::Warned, [](auto& o) { o.diameterRatio = 1; } },
    Case{ "ratio_10", Verdict::Warned,
      [](auto& o)
      {
        o.diameterRatio = 10;
        o.sizes = Sizes::VolumeShare;
      } },
    // the largest spheres are six mean diameters wide: the list of neighbours has to know
    Case{ "spheres_ratio_7", Verdict::Warned,
      [](auto& o)
      {
        o.dimension = 3;
        o.count = 150;
        o.diameterRatio = 7;
        o.sizes = Sizes::VolumeShare;
      } },
    Case{ "ratio_20", Verdict::Refused, [](auto& o) { o.diameterRatio = 20; } },
    Case{ "one_grain", Verdict::Refused, [](auto& o) { o.count = 1; } },
    Case{ "ten_disks", Verdict::Warned, [](auto& o) { o.count = 10; } },
    // smooth walls: so few disks have no shape near 2
    Case{ "twenty_disks_aspect_2", Verdict::Warned,
      [](auto& o)
      {
        o.count = 20;
        o.aspect = 2;
      } },
    // random overlaps were locked by so much friction, and ended in a box a third as full
    Case{ "friction_2", Verdict::Right,
      [](auto& o)
      {
        o.friction = 2;
        o.softness = 1e-6;
      } },
    Case{ "friction_1_hard", Verdict::Right,
      [](auto& o)
      {
        o.friction = 1;
        o.softness = 1e-7;
      } },
    // walls carried up to 2 % more or less than the pressure
    Case{ "soft", Verdict::Right, [](auto& o) { o.softness = 1e-2; } },
    // below round-off of the places
    Case{ "hard_and_tight", Verdict::Warned,
      [](auto& o)
      {
        o.softness = 1e-7;
        o.tolerance = 1e-8;
      } },
    Case{ "loose", Verdict::Right, [](auto& o) { o.packingFraction = 0.6; } },
    Case{ "loose_with_friction", Verdict::Right,
      [](auto& o)
      {
        o.packingFraction = 0.6;
        o.friction = 2;
      } },
    Case{ "too_dense", Verdict::Refused, [](auto& o) { o.packingFraction = 0.95; } }),
  [](const auto& one) { return one.param.name; });

struct Grains
{
  std::string name;
  Verdict verdict;
  bool periodic;
  std::vector<Vector> centre;
  std::vector<double> radius;
  BridgeOptions bridges;
  std::int64_t nodes = 300;
};

class BridgesStand : public testing::TestWithParam<Grains>
{
};

TEST_P(BridgesStand, OrSaySo)
{
  Packing p;
  p.dimension = 2;
  p.size = { 2, 2, 0 };
  p.periodic = { GetParam().periodic, GetParam().periodic, false };
  p.centre = GetParam().centre;
  p.radius = GetParam().radius;
  const Outcome found = judged([&] { return judge(p, GetParam().bridges, { .nodesAcross = GetParam().nodes }, 200); });
  EXPECT_EQ(name(found.verdict), std::string(name(GetParam().verdict))) << found.what;
}

INSTANTIATE_TEST_SUITE_P(All, BridgesStand,
  testing::Values(Grains{ "one_grain", Verdict::Right, false, { { 1, 1, 0 } }, { 0.8 }, {} },
    // it would be bridged to its own images
    Grains{ "one_periodic", Verdict::Refused, true, { { 1, 1, 0 } }, { 0.95 }, {} },
    Grains{ "periodic_too_narrow", Verdict::Refused, true, { { 1, 1, 0 } }, { 0.95 }, { .reach = 1.5 } },
    Grains{
      "wider_than_grains", Verdict::Right, false, { { 0.5, 1, 0 }, { 1.5, 1, 0 } }, { 0.5, 0.5 }, { .width = 2 } },
    Grains{ "no_width", Verdict::Right, false, { { 0.5, 1, 0 }, { 1.5, 1, 0 } }, { 0.5, 0.5 }, { .width = 0 } },
    Grains{ "one_place_for_two", Verdict::Right, false, { { 1, 1, 0 }, { 1, 1, 0 } }, { 0.5, 0.3 }, {} },
    Grains{
      "unreachable", Verdict::Refused, false, { { 0.4, 1, 0 }, { 1.6, 1, 0 } }, { 0.2, 0.2 }, { .saturation = 0.5 } },
    Grains{ "two_nodes", Verdict::Warned, false, { { 0.5, 1, 0 }, { 1.5, 1, 0 } }, { 0.5, 0.5 }, {}, 2 }),
  [](const auto& one) { return one.param.name; });

// Grains that overlap by more than a packing's may are not taken in silence.
TEST(BridgesStand, OverlapIsTold)
{
  Packing p;
  p.size = { 2, 2, 0 };
  p.centre = { { 0.8, 1, 0 }, { 1.2, 1, 0 } };
  p.radius = { 0.5, 0.5 };
  const CementedSample s = cement(p, {}, { .nodesAcross = 200 });
  ASSERT_FALSE(s.warnings.empty());
  EXPECT_NE(s.warnings.front().find("overlap by up to 60.0 %"), std::string::npos) << s.warnings.front();
}

} // namespace
