// Packings: forces are the gradient of the energy; at rest every degree of freedom is balanced by exactly one contact.
#include "packing/Packing.h"

#include "core/Error.h"
#include "packing/GrainSystem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace
{

using namespace lamella;
using namespace lamella::packing;

template <int Dim>
GrainSystem<Dim> overlappingGrains(bool periodic)
{
  GrainSystem<Dim> g;
  g.resize(40);
  g.periodic.fill(periodic);
  g.box.setConstant(Dim == 2 ? 5.0 : 2.9);
  g.box[Dim - 1] *= 1.2;
  std::uint64_t state = 7;
  const auto number = [&]
  {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (std::size_t i = 0; i < g.count(); ++i)
  {
    g.radius[i] = 0.4 + 0.2 * number();
    for (int a = 0; a < Dim; ++a)
      g.position[i][a] = number() * g.box[a];
  }
  return g;
}

template <int Dim>
void checkGradient(bool periodic)
{
  auto g = overlappingGrains<Dim>(periodic);
  g.computeForces(0);
  ASSERT_GT(g.contacts, 30);
  const auto energyOf = [](GrainSystem<Dim> copy)
  {
    copy.computeForces(0);
    return copy.energy;
  };
  // central differences of a function whose second derivative jumps: error up to h times the stiffness
  const double h = 1e-6;
  for (const std::size_t i : { std::size_t{ 0 }, std::size_t{ 17 }, std::size_t{ 39 } })
    for (int a = 0; a < Dim; ++a)
    {
      auto up = g;
      auto down = g;
      up.position[i][a] += h;
      down.position[i][a] -= h;
      EXPECT_NEAR(-(energyOf(up) - energyOf(down)) / (2 * h), g.force[i][a], 1e-5);
    }
  for (int a = 0; a < Dim; ++a)
  {
    typename GrainSystem<Dim>::Vec factor = GrainSystem<Dim>::Vec::Ones();
    auto up = g;
    auto down = g;
    factor[a] = std::exp(h);
    up.strain(factor);
    factor[a] = std::exp(-h);
    down.strain(factor);
    EXPECT_NEAR(-(energyOf(up) - energyOf(down)) / (2 * h), g.virial[a], 1e-4);
  }
}

TEST(Packing, ForcesAndVirialAreTheEnergysGradient)
{
  checkGradient<2>(false);
  checkGradient<2>(true);
  checkGradient<3>(false);
  checkGradient<3>(true);
}

// The paper's samples. Smooth disks between two pairs of walls that move apart and together by themselves: as many
// contacts as degrees of freedom, 2 a grain and 2 of the box; at an overlap of 1e-6 diameters perhaps one or two more.
TEST(Packing, FourHundredDisksBetweenWalls)
{
  std::vector<std::uint64_t> seeds(10);
  std::iota(seeds.begin(), seeds.end(), std::uint64_t{ 1 });
  const auto samples = packMany({}, seeds, 2);
  std::array<double, 9> fabric{};
  std::array<double, 9> stress{};
  double fraction = 0;
  for (const Packing& p : samples)
  {
    const PackingStatistics s = statistics(p);
    const auto holding = static_cast<std::int64_t>(p.count()) - s.rattlers;
    EXPECT_LE(p.unbalanced, 1e-4);
    EXPECT_GE(s.grainContacts + s.wallContacts, 2 * holding + 2);
    EXPECT_LE(s.grainContacts + s.wallContacts, 2 * holding + 5);
    EXPECT_NEAR(s.aspect, 2.0, 0.02);
    EXPECT_GT(s.rattlers, 0.02 * 400);
    EXPECT_LT(s.rattlers, 0.12 * 400);
    // both pairs of walls carry the pressure asked for
    EXPECT_NEAR(s.stress[0], 1e3, 0.1);
    EXPECT_NEAR(s.stress[4], 1e3, 0.1);
    EXPECT_NEAR(s.stress[1], s.stress[3], 0.1); // moments balance
    // Contacts of random directions would have 0.04, one in three samples more than that.
    EXPECT_LE(s.fabricAnisotropy, 0.03);
    EXPECT_LE(s.stressAnisotropy, 0.03);
    fraction += s.packingFraction / static_cast<double>(samples.size());
    for (std::size_t i = 0; i < 9; ++i)
    {
      fabric[i] += s.fabric[i] / static_cast<double>(samples.size());
      stress[i] += s.stress[i] / static_cast<double>(samples.size());
    }
  }
  // An independent code found 0.824 for one such sample; samples scatter by 0.002.
  EXPECT_NEAR(fraction, 0.825, 0.004);
  EXPECT_LE(std::hypot(fabric[0] - fabric[4], 2 * fabric[1]), 0.03);
  EXPECT_LE(std::hypot(stress[0] - stress[4], 2 * stress[1]) / (stress[0] + stress[4]), 0.03);
}

TEST(Packing, PeriodicDisks)
{
  PackingOptions o;
  o.periodic = true;
  o.count = 150;
  o.aspect = 1;
  const Packing p = pack(o);
  const PackingStatistics s = statistics(p);
  const auto holding = static_cast<std::int64_t>(p.count()) - s.rattlers;
  // two translations of the whole cost nothing, two edges of the box count
  EXPECT_GE(s.grainContacts, 2 * holding);
  EXPECT_LE(s.grainContacts, 2 * holding + 3);
  EXPECT_EQ(s.wallContacts, 0);
  EXPECT_GT(s.packingFraction, 0.83);
  EXPECT_LT(s.packingFraction, 0.86);
}

TEST(Packing, Spheres)
{
  PackingOptions o;
  o.dimension = 3;
  o.count = 150;
  o.aspect = 1.5;
  o.softness = 1e-5;
  const Packing p = pack(o);
  const PackingStatistics s = statistics(p);
  const auto holding = static_cast<std::int64_t>(p.count()) - s.rattlers;
  EXPECT_LE(p.unbalanced, 1e-4);
  EXPECT_GE(s.grainContacts + s.wallContacts, 3 * holding + 3);
  EXPECT_LE(s.grainContacts + s.wallContacts, 3 * holding + 20); // ~ sqrt(softness) more
  EXPECT_NEAR(s.aspect, 1.5, 0.03); // so few spheres rearrange in steps of a per cent or two
  for (const int i : { 0, 4, 8 })
    EXPECT_NEAR(s.stress[static_cast<std::size_t>(i)], 1e3, 1);
}

TEST(Packing, FrictionHoldsWithFewerContacts)
{
  PackingOptions o;
  o.count = 120;
  o.aspect = 1;
  o.friction = 0.4;
  o.softness = 1e-5;
  const Packing p = pack(o);
  const PackingStatistics s = statistics(p, true);
  EXPECT_LE(p.unbalanced, 1e-4);
  EXPECT_LT(s.coordination, 3.7); // between 3 (infinite friction) and 4 (none)
  EXPECT_GT(s.coordination, 2.8);
  bool some = false;
  for (const Contact& c : p.contacts)
  {
    double normal = 0;
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a)
    {
      normal += c.force[a] * c.normal[a];
      square += c.force[a] * c.force[a];
    }
    const double tangential = std::sqrt(std::max(0.0, square - normal * normal));
    EXPECT_GT(normal, 0);
    EXPECT_LE(tangential, 0.4 * normal * (1 + 1e-9));
    some = some || tangential > 0.01 * normal;
  }
  EXPECT_TRUE(some);
}

// Few spheres with friction keep the stresses of their way: 15 to 46 % of anisotropy with seeds 1 to 6.
TEST(Packing, FrictionLeavesStressesThatAreWarnedOf)
{
  PackingOptions o;
  o.dimension = 3;
  o.count = 60;
  o.friction = 0.3;
  o.softness = 1e-4;
  const Packing p = pack(o);
  const PackingStatistics s = statistics(p, true);
  const auto warned = [&](const char* what)
  {
    return std::any_of(
      p.warnings.begin(), p.warnings.end(), [&](const std::string& w) { return w.find(what) != std::string::npos; });
  };
  EXPECT_EQ(warned("the stress is"), s.stressAnisotropy > 0.1) << s.stressAnisotropy;
  EXPECT_EQ(warned("the directions of contacts are"), s.fabricAnisotropy > 0.1) << s.fabricAnisotropy;
  EXPECT_TRUE(warned("anisotropic: grains with friction")); // this seed has much
}

// With this seed the sample slides on for 1e6 steps at the last pressure where it is not squeezed. Steps, and not
// seconds: they are the same on every machine, but for the odd rounding.
TEST(Packing, FrictionComesToRestSoon)
{
  PackingOptions o;
  o.friction = 0.3;
  o.seed = 3;
  const Packing p = pack(o);
  EXPECT_LE(p.unbalanced, 1e-4);
  EXPECT_LT(p.steps, 400'000);
  const PackingStatistics s = statistics(p, true);
  EXPECT_GT(s.coordination, 2.9); // between 3 (infinite friction) and 4 (none), and a little scatter
  EXPECT_LT(s.coordination, 3.4);
  EXPECT_NEAR(s.packingFraction, 0.78, 0.012); // seeds 1 to 24 have 0.771 to 0.792
}

TEST(Packing, LooserSamplesDoNotTouch)
{
  PackingOptions o;
  o.packingFraction = 0.7;
  const Packing p = pack(o);
  EXPECT_NEAR(statistics(p).packingFraction, 0.7, 1e-9);
  for (std::size_t i = 0; i < p.count(); ++i)
    for (std::size_t j = i + 1; j < p.count(); ++j)
      ASSERT_GT(std::hypot(p.centre[i][0] - p.centre[j][0], p.centre[i][1] - p.centre[j][1]),
        (p.radius[i] + p.radius[j]) * (1 - 1e-9));
}

TEST(Packing, SameSeedSameBytes)
{
  PackingOptions o;
  o.count = 60;
  o.aspect = 1;
  o.seed = 5;
  const Packing a = pack(o);
  const std::array<std::uint64_t, 2> seeds{ 4, 5 };
  const Packing b = packMany(o, seeds, 2)[1];
  ASSERT_EQ(a.count(), b.count());
  EXPECT_EQ(std::memcmp(a.centre.data(), b.centre.data(), a.count() * sizeof(a.centre[0])), 0);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.size, b.size);
}

TEST(Packing, SizesAreSpreadAsAskedFor)
{
  for (const Sizes sizes : { Sizes::Volume, Sizes::VolumeShare, Sizes::Diameter })
  {
    PackingOptions o;
    o.sizes = sizes;
    o.packingFraction = 0.3;
    o.count = 2000;
    const Packing p = pack(o);
    const auto [low, high] = std::minmax_element(p.radius.begin(), p.radius.end());
    EXPECT_NEAR(*high / *low, 2, 0.005);
    EXPECT_NEAR(2 * std::accumulate(p.radius.begin(), p.radius.end(), 0.0) / 2000, o.meanDiameter, 1e-12);
    // share of the grains below the middle diameter, from the integrals of the three densities
    const auto below =
      std::count_if(p.radius.begin(), p.radius.end(), [&](double r) { return r < 0.5 * (*low + *high); });
    const double expected = sizes == Sizes::Volume ? (1.5 * 1.5 - 1) / 3 : sizes == Sizes::Diameter ? 0.5 : 2.0 / 3.0;
    EXPECT_NEAR(static_cast<double>(below) / 2000, expected, 0.002);
  }
}

std::string messageOf(const PackingOptions& o)
{
  try
  {
    (void)pack(o);
  }
  catch (const Error& e)
  {
    return std::string(e.what()) + " | " + e.hint();
  }
  return "";
}

TEST(PackingErrors, SayTheValueAndTheRemedy)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto change)
  {
    PackingOptions o;
    change(o);
    return messageOf(o);
  };
  EXPECT_NE(with([&](auto& o) { o.meanDiameter = nan; }).find("the mean diameter is nan"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.meanDiameter = 0; }).find("the mean diameter is 0"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.meanDiameter = -1; }).find("the mean diameter is -1"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.diameterRatio = 0.5; }).find("ratio of the diameters is 0.5"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.count = 3; }).find("3 grains"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.aspect = 9; }).find("the aspect is 9"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.friction = -0.1; }).find("friction coefficient is -0.1"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.pressure = 0; }).find("the pressure is 0"), std::string::npos);
  // radii that cannot fit: three grains fill the width
  EXPECT_NE(with(
              [](auto& o)
              {
                o.count = 12;
                o.diameterRatio = 10;
                o.aspect = 5;
              })
              .find("of the box across"),
    std::string::npos);
  // jams before: says where
  EXPECT_NE(with([](auto& o) { o.packingFraction = 0.9; }).find("before 0.900"), std::string::npos);
}

TEST(PackingOf, FindsContactsAndRefusesWhatCannotBe)
{
  using Centre = std::array<double, 3>;
  const std::vector<Centre> centre{ { 1, 1, 0 }, { 3, 1, 0 }, { 2, 1 + std::sqrt(3.0), 0 } };
  const std::vector<double> radius{ 1, 1, 1 };
  const Packing p = packingOf(2, centre, radius);
  EXPECT_NEAR(p.size[0], 4, 1e-12);
  EXPECT_NEAR(p.size[1], 2 + std::sqrt(3.0), 1e-12);
  EXPECT_EQ(std::count_if(
              p.contacts.begin(), p.contacts.end(), [](const Contact& c) { return c.second >= 0; }),
    3);
  EXPECT_EQ(std::count_if(
              p.contacts.begin(), p.contacts.end(), [](const Contact& c) { return c.second < 0; }),
    5);

  const auto message = [&](std::vector<Centre> c, std::vector<double> r, std::optional<Centre> size = {})
  {
    try
    {
      (void)packingOf(2, c, r, size);
    }
    catch (const Error& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(
    message({ { 0, 0, 0 }, { 1, 0, 0 } }, { 1, 1 }), "grains 1 and 2 overlap by 1, 50 % of the smaller one's diameter");
  EXPECT_EQ(message({ { 0, 0, 0 } }, { -1 }), "the radius of grain 1 is -1");
  EXPECT_EQ(message({ { 0, 0, 0 } }, { 0 }), "the radius of grain 1 is 0");
  EXPECT_EQ(message({ { 0, 0, 0 } }, { 1e300 }), "the radius of grain 1 is 1e+300");
  EXPECT_EQ(message({ { 0, 0, 0 } }, { 1e-300 }), "the radius of grain 1 is 1e-300");
  EXPECT_EQ(message({ { 1e200, 0, 0 } }, { 1 }), "the centre of grain 1 has the coordinate 1e+200");
  EXPECT_EQ(message({ { std::nan(""), 0, 0 } }, { 1 }), "the centre of grain 1 has the coordinate nan");
  EXPECT_EQ(message({}, {}), "there are no grains");
  EXPECT_EQ(message({ { 5, 1, 0 } }, { 1 }, Centre{ 4, 4, 0 }),
    "the centre of grain 1 lies outside the box: 5 of 0 to 4 along x");
}

} // namespace
