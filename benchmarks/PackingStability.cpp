// What packings and bridges stand: size ratios, friction, softness, tolerance, aspect, counts, fractions, grains of
// somebody else, lattices too coarse; each right, warned about, refused, or wrong without a word, by the definitions
// alone (tests/verification/PackingAtlas.h). study=
//   ratio     sizes spread in every way, ratios 1 to 10 (and beyond), 10 to 1000 grains
//   friction  0 to 2, softness 1e-7 to 1e-2
//   softness  1e-7 to 1e-2, tolerances 1e-8 to 1e-2
//   aspect    0.2 to 5, 10 to 300 grains, walls and periodic
//   loose     packing fractions 0.05 to 0.99
//   bridges   widths, reaches, saturations, nodes across, on packings and on grains made to be awkward
// none: all. Keys: quick (few grains), output=FOLDER for CSV files (default results/bench-packing-stability).
#include "Keys.h"
#include "Table.h"

#include "../tests/verification/PackingAtlas.h"

#include <cstdio>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::packing;
using namespace lamella::test;

const char* name(Sizes sizes)
{
  return sizes == Sizes::Volume ? "volume" : sizes == Sizes::VolumeShare ? "volume-share" : "diameter";
}

/// A table of verdicts, and how many of each.
class Atlas
{
public:
  Atlas(const Keys& keys, const char* study)
    : study_(study)
    , table_(keys, "packing-stability", study, "dimension,panel,row,column,verdict,error,seconds,what")
  {
  }
  ~Atlas()
  {
    fmt::print("{:<9}", study_);
    for (const auto& [verdict, count] : counts_)
      fmt::print(" {} {}", count, test::name(verdict));
    fmt::print("; {:.1f} s\n", cpu() - start_);
    std::fflush(stdout);
  }
  template <class F>
  void line(int dimension, const std::string& panel, const std::string& row, const std::string& column, F&& run)
  {
    const double start = cpu();
    Outcome o = judged(run);
    std::replace(o.what.begin(), o.what.end(), '"', '\'');
    const auto quoted = [](const std::string& text) { return "\"" + text + "\""; };
    table_.line(
      dimension, quoted(panel), quoted(row), column, test::name(o.verdict), o.error, cpu() - start, quoted(o.what));
    ++counts_[o.verdict];
    if (o.verdict == Verdict::Wrong)
      fmt::print("wrong: {}D {}, {}, {}: {}\n", dimension, panel, row, column, o.what);
  }
  void pack(const std::string& panel, const std::string& row, const std::string& column, const PackingOptions& o)
  {
    line(
      o.dimension, panel, row, column, [&] { return judge(packing::pack(o), o); });
  }

private:
  std::string study_;
  Table table_;
  std::map<Verdict, int> counts_;
  double start_ = cpu();
};

/// In the plane and in space.
template <class F>
void forBoth(F&& f)
{
  PackingOptions o;
  o.aspect = 1;
  o.softness = 1e-5;
  o.count = 60;
  f(o);
  o.dimension = 3;
  o.count = 80;
  f(o);
}

void ratio(const Keys& keys)
{
  Atlas atlas(keys, "ratio");
  forBoth(
    [&](PackingOptions o)
    {
      for (const Sizes sizes : { Sizes::Volume, Sizes::VolumeShare, Sizes::Diameter })
        for (const double ratio : { 1.0, 1.01, 2.0, 4.0, 7.0, 10.0, 20.0 })
          for (const std::int64_t count : { 10, 30, 60, 200, 1000 })
          {
            if (count > (keys.contains("quick") || o.dimension == 3 ? 200 : 1000))
              continue;
            o.sizes = sizes;
            o.diameterRatio = ratio;
            o.count = count;
            atlas.pack(name(sizes), fmt::format("{}", ratio), fmt::format("{}", count), o);
          }
    });
}

void friction(const Keys& keys)
{
  Atlas atlas(keys, "friction");
  forBoth(
    [&](PackingOptions o)
    {
      for (const double mu : { 0.0, 0.01, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0 })
        for (const double softness : { 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2 })
        {
          o.friction = mu;
          o.softness = softness;
          atlas.pack("friction", fmt::format("{}", mu), fmt::format("{:g}", softness), o);
        }
    });
}

void softness(const Keys& keys)
{
  Atlas atlas(keys, "softness");
  forBoth(
    [&](PackingOptions o)
    {
      for (const double tolerance : { 1e-8, 1e-6, 1e-4, 1e-2 })
        for (const double softness : { 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1 })
        {
          o.tolerance = tolerance;
          o.softness = softness;
          atlas.pack("softness", fmt::format("{:g}", tolerance), fmt::format("{:g}", softness), o);
        }
    });
}

void aspect(const Keys& keys)
{
  Atlas atlas(keys, "aspect");
  forBoth(
    [&](PackingOptions o)
    {
      for (const bool periodic : { false, true })
        for (const double aspect : { 0.1, 0.2, 0.5, 1.0, 2.0, 5.0 })
          for (const std::int64_t count : { 10, 20, 40, 100, 300 })
          {
            o.periodic = periodic;
            o.aspect = aspect;
            o.count = count;
            atlas.pack(periodic ? "periodic" : "walls", fmt::format("{}", aspect), fmt::format("{}", count), o);
          }
    });
}

void loose(const Keys& keys)
{
  Atlas atlas(keys, "loose");
  forBoth(
    [&](PackingOptions o)
    {
      for (const double ratio : { 1.0, 10.0 })
        for (const double mu : { 0.0, 0.5, 2.0 })
          for (const double fraction : { 0.01, 0.05, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99 })
          {
            o.diameterRatio = ratio;
            o.friction = mu;
            o.packingFraction = fraction;
            atlas.pack("loose", fmt::format("ratio {}, friction {}", ratio, mu), fmt::format("{}", fraction), o);
          }
    });
}

struct Given
{
  std::string name;
  Packing packing;
};

/// Grains that awkward users have; `own` periodic boxes.
std::vector<Given> awkward(int dimension)
{
  std::vector<Given> all;
  const double z = dimension == 3 ? 1 : 0;
  const auto add =
    [&](const char* name, std::vector<Vector> centre, std::vector<double> radius, Vector size, bool periodic = false)
  {
    Packing p;
    p.dimension = dimension;
    p.size = size;
    p.periodic = { periodic, periodic, periodic && dimension == 3 };
    p.centre = std::move(centre);
    p.radius = std::move(radius);
    all.push_back({ name, std::move(p) });
  };
  const Vector box{ 2, 2, 2 * z };
  add("one grain", { { 1, 1, z } }, { 0.8 }, box);
  add("one, periodic", { { 1, 1, z } }, { 0.95 }, box, true);
  add("one, periodic and fat", { { 1, 1, z } }, { 1.2 }, box, true);
  add("two alike", { { 0.5, 1, z }, { 1.5, 1, z } }, { 0.5, 0.5 }, box);
  add("ratio 100", { { 0.9, 1, z }, { 1.818, 1, z } }, { 0.9, 0.009 }, box);
  add("two that overlap", { { 0.8, 1, z }, { 1.2, 1, z } }, { 0.5, 0.5 }, box);
  add("one in another", { { 1, 1, z }, { 1.1, 1, z } }, { 0.9, 0.1 }, box);
  add("one place for two", { { 1, 1, z }, { 1, 1, z } }, { 0.5, 0.3 }, box);
  add("two apart", { { 0.4, 1, z }, { 1.6, 1, z } }, { 0.2, 0.2 }, box);
  add("centres on walls", { { 0, 1, z }, { 1, 0, z } }, { 0.6, 0.6 }, box);
  return all;
}

void bridges(const Keys& keys)
{
  Atlas atlas(keys, "bridges");
  forBoth(
    [&](PackingOptions o)
    {
      std::vector<Given> all = awkward(o.dimension);
      o.count = o.dimension == 2 ? 40 : 30;
      all.push_back({ "packed, ratio 2", packing::pack(o) });
      o.sizes = Sizes::Diameter;
      o.diameterRatio = 10;
      all.push_back({ "packed, ratio 10", packing::pack(o) });
      o.count = 60;
      o.diameterRatio = 2;
      o.periodic = true;
      all.push_back({ "packed, periodic", packing::pack(o) });
      const int across = o.dimension == 2 ? 160 : 28;
      for (const Given& given : all)
      {
        const auto cemented =
          [&](const std::string& row, const std::string& column, const BridgeOptions& b, const RasterOptions& raster)
        { atlas.line(o.dimension, given.name, row, column, [&] { return judge(given.packing, b, raster, across); }); };
        const std::int64_t fine = o.dimension == 2 ? 300 : 48;
        for (const double width : { 0.0, 0.05, 0.5, 1.0, 2.0, 2.5 })
          cemented("width", fmt::format("{}", width), { .width = width }, { .nodesAcross = fine });
        for (const double reach : { 0.9, 1.0, 1.5, 2.0 })
          cemented("reach", fmt::format("{}", reach), { .reach = reach }, { .nodesAcross = fine });
        for (const double saturation : { 0.0, 0.01, 0.34, 0.9, 1.0, 1.5 })
          cemented("saturation", fmt::format("{}", saturation), { .saturation = saturation }, { .nodesAcross = fine });
        for (const std::int64_t nodes : { 1, 2, 5, 20 })
          cemented("nodes", fmt::format("{}", nodes), {}, { .nodesAcross = nodes });
      }
    });
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "ratio", ratio }, { "friction", friction }, { "softness", softness }, { "aspect", aspect }, { "loose", loose },
      { "bridges", bridges } });
}
