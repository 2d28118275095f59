// study=spheres, bars; all unless told.
//
// spheres: how near plain voxels come to the material, and voxels that know their share of a phase: simple cubic array
// of spheres, by contrast, fraction and nodes across; and 2 × fine − coarse of the last two. bars: how often the error
// bar of studyShares() holds the material's value, on balls at random, cylinders and layers at random angles, drawn
// with 24 to 48 nodes across (count= of them; the value: extrapolated from 64 and 128 nodes).
//   fraction=0.1,0.3,0.4  contrast=1000,10,0.1,0.001 (sphere over matrix)  size=16,32,64
#include "Keys.h"
#include "Shapes.h"
#include "Table.h"

#include "../tests/SphereShares.h"

#include "lbm/Shares.h"
#include "lbm/SteadyDiffusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

/// Values of McPhedran & McKenzie (1978), as far as digits are printed.
std::optional<double> published(double fraction, double contrast)
{
  struct Value
  {
    double fraction, contrast, value;
  };
  for (const Value& v : { Value{ 0.1, 10, 1.2433 }, Value{ 0.3, 10, 1.8877 }, Value{ 0.4, 10, 2.3644 } })
    if (v.fraction == fraction && v.contrast == contrast)
      return v.value;
  return {};
}

double value(std::int64_t n, const std::vector<double>& share, double contrast, std::optional<lbm::AcrossSurface> rule)
{
  constexpr int levels = 255;
  const Lattice lattice = makeLattice(n, n, n, 3, 1.0 / static_cast<double>(n));
  lbm::SteadyOptions options;
  options.stencil = lbm::Stencil::D3Q7;
  options.sides = lbm::Sides::Mixed;
  options.tolerance = 1e-7;
  options.fieldTolerance = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> id(share.size());
  std::vector<double> conductivity{ 1, contrast };
  for (std::size_t i = 0; i < id.size(); ++i)
    id[i] = static_cast<std::uint8_t>(rule ? std::lround(share[i] * (levels - 1)) : (share[i] >= 0.5 ? 1 : 0));
  if (rule)
  {
    std::vector<double> of(levels);
    for (int i = 0; i < levels; ++i)
      of[static_cast<std::size_t>(i)] = i / static_cast<double>(levels - 1);
    auto pairs = std::make_shared<lbm::PairTable>(lbm::shareLinks(of, 1, contrast, *rule));
    conductivity.clear();
    for (std::size_t i = 0; i < levels; ++i)
      conductivity.push_back(pairs->link[i * levels + i]);
    options.pairs = std::move(pairs);
  }
  lbm::SteadyDiffusion solver(lattice, decompose(lattice, MPI_COMM_SELF), id, conductivity, options);
  return solver.solve(0).effective[0];
}

void spheres(const Keys& keys)
{
  const std::vector<double> sizes =
    list(keys, "size", 0).front() > 0 ? list(keys, "size", 0) : std::vector{ 16.0, 32.0, 64.0 };
  const std::vector<double> fractions =
    keys.contains("fraction") ? list(keys, "fraction", 0) : std::vector{ 0.1, 0.3, 0.4 };
  const std::vector<double> contrasts =
    keys.contains("contrast") ? list(keys, "contrast", 0) : std::vector{ 1000.0, 10.0, 0.1, 0.001 };
  Table table(keys, "surface-shares", "spheres", "fraction,contrast,way,nodes,value,published");
  for (const double fraction : fractions)
    for (const double contrast : contrasts)
    {
      const auto exact = published(fraction, contrast);
      fmt::print("spheres of {:g}, {:g} times the matrix{}\n", fraction, contrast,
        exact ? fmt::format(", published {:.4f}", *exact) : "");
      // the matrix leads across: flux runs in it where it conducts better
      const lbm::AcrossSurface rule = lbm::ruleFor(contrast < 1);
      for (const bool shares : { false, true })
      {
        std::vector<double> values;
        fmt::print("  {:<8}", shares ? "shares" : "voxels");
        for (const double size : sizes)
        {
          const auto n = static_cast<std::int64_t>(size);
          values.push_back(
            value(n, test::sphereShares(n, fraction), contrast, shares ? std::optional(rule) : std::nullopt));
          fmt::print(" {:>9.5f}", values.back());
          table.line(fraction, contrast, shares ? "shares" : "voxels", n, values.back(), exact.value_or(std::nan("")));
        }
        const double last = values.size() > 1 ? 2 * values.back() - values[values.size() - 2] : values.back();
        fmt::print("  extrapolated {:>9.5f}", last);
        if (exact)
          fmt::print("  errors {:+.3f} % and {:+.3f} %", 100 * (values.back() / *exact - 1), 100 * (last / *exact - 1));
        fmt::print("\n");
        std::fflush(stdout);
      }
    }
}

/// The part of each voxel inside a shape: of those whose corners or middle differ, by samples.
std::vector<double> shares(std::int64_t n, const Shape& inside)
{
  constexpr int samples = 8;
  std::vector<double> share;
  const double h = 1.0 / static_cast<double>(n);
  for (std::int64_t z = 0; z < n; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x)
      {
        const auto count = [&](int each, bool ends)
        {
          int in = 0;
          const auto at = [&](std::int64_t i, int k)
          { return h * (static_cast<double>(i) + (ends ? k / static_cast<double>(each - 1) : (k + 0.5) / each)); };
          for (int c = 0; c < each; ++c)
            for (int b = 0; b < each; ++b)
              for (int a = 0; a < each; ++a)
                in += inside({ at(x, a), at(y, b), at(z, c) }) ? 1 : 0;
          return in;
        };
        const int corners = count(3, true);
        share.push_back(corners == 0 ? 0.0
            : corners == 27          ? 1.0
                                     : count(samples, false) / double{ samples * samples * samples });
      }
  return share;
}

Shape randomShape(Random& random, int kind)
{
  const auto direction = [&]
  {
    Spot d{ uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1) };
    const double length = std::hypot(d.x, d.y, d.z);
    return Spot{ d.x / length, d.y / length, d.z / length };
  };
  const Spot d = direction();
  const Spot c{ uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1) };
  if (kind == 0)
  {
    std::vector<Spot> centres;
    const int count = static_cast<int>(2 + random() % 8);
    for (int i = 0; i < count; ++i)
      centres.push_back({ uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1) });
    return balls(centres, {}, uniform(random, 0.3, 0.5) / std::cbrt(count));
  }
  if (kind == 1) // one cylinder through the box
    return [=, radius = uniform(random, 0.12, 0.3)](Spot p)
    {
      const Spot q{ p.x - 0.3 - 0.4 * c.x, p.y - 0.3 - 0.4 * c.y, p.z - 0.3 - 0.4 * c.z };
      const double along = q.x * d.x + q.y * d.y + q.z * d.z;
      return q.x * q.x + q.y * q.y + q.z * q.z - along * along < radius * radius;
    };
  return [=, period = uniform(random, 0.3, 0.6), part = uniform(random, 0.3, 0.7)](Spot p)
  {
    const double s = (p.x * d.x + p.y * d.y + p.z * d.z) / period + c.x;
    return s - std::floor(s) < part;
  };
}

void bars(const Keys& keys)
{
  constexpr std::size_t levels = 255;
  const int count = static_cast<int>(number(keys, "count", 90));
  Random random(static_cast<std::uint64_t>(number(keys, "seed", 1)));
  Table table(keys, "surface-shares", "bars", "kind,nodes,contrast,value,bar,extrapolated,truth,error,held");
  std::vector<double> even;
  for (std::size_t i = 0; i < levels; ++i)
    even.push_back(static_cast<double>(i) / (levels - 1));
  int held = 0;
  std::vector<double> ratios;
  std::vector<double> errors;
  std::vector<double> better;
  for (int i = 0; i < count; ++i)
  {
    const int kind = i % 3;
    const Shape shape = randomShape(random, kind);
    const double contrast = pick(random, { 1000.0, 30.0, 3.0, 0.3, 0.03, 0.001 });
    const auto n = static_cast<std::int64_t>(24 + random() % 25);
    lbm::StudyOptions study;
    study.axes = { 0 };
    study.steady.stencil = lbm::Stencil::D3Q7;
    study.steady.tolerance = 1e-7;
    const auto answer = [&](std::int64_t across, bool estimate)
    {
      PhaseImage image;
      image.lattice = makeLattice(across, across, across, 3, 1.0 / static_cast<double>(across));
      for (const double s : shares(across, shape))
        image.phase.push_back(static_cast<std::uint8_t>(std::lround(s * (levels - 1))));
      study.estimateError = estimate;
      return lbm::studyShares(image, even, 1, contrast, study, MPI_COMM_SELF).front();
    };
    const auto found = answer(n, true);
    const double value = found.result.effective[0];
    const double truth = 2 * answer(128, false).result.effective[0] - answer(64, false).result.effective[0];
    const double error = std::abs(value / truth - 1);
    const bool holds = error <= found.error.relative;
    held += holds ? 1 : 0;
    ratios.push_back(found.error.relative / error);
    errors.push_back(error);
    better.push_back(std::abs(found.error.extrapolated / truth - 1));
    table.line(kind, n, contrast, value, found.error.relative, found.error.extrapolated, truth, error, holds ? 1 : 0);
    if (!holds)
      fmt::print("  kind {} of {} nodes, contrast {:g}: {:.5f}, bar {:.2f} %, truth {:.5f}, error {:.2f} %\n", kind, n,
        contrast, value, 100 * found.error.relative, truth, 100 * error);
  }
  const auto median = [](std::vector<double> v)
  {
    std::ranges::sort(v);
    return v[v.size() / 2];
  };
  fmt::print("held {} of {}; bar over error {:.2g}, error {:.2g} %, of the extrapolated value {:.2g} % (medians)\n",
    held, count, median(ratios), 100 * median(errors), 100 * median(better));
}

void run(const Keys& keys)
{
  runStudies(keys, { { "spheres", [&] { spheres(keys); } }, { "bars", [&] { bars(keys); } } });
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
