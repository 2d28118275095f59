// Do the error bars of `lamella diffusion` hold? Pictures of known materials, coarse and less coarse, odd and even, in
// the plane and in space; the truth is the material's own conductivity: a series where there is one, else far finer
// pictures of the same geometry, extrapolated. Two tables: the total error of every case by kind of material, and the
// same of the pictures in the plane that a target error was asked of. Keys: seed=N of the random shapes (2026),
// target=SHARE (0.02), quick (a fifth of the cases), cases=FILE for a line a case.
// The estimate's constants were found on other shapes and seeds, see docs/benchmarks/diffusion.md.
#include "Keys.h"
#include "Shapes.h"

#include "../tests/verification/DiskArray.h"

#include "generators/Generators.h"
#include "lbm/DiffusionStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

/// A geometry in a box 1 wide, and how it is drawn with n pixels across.
struct Material
{
  std::string kind;
  int dimension = 2;
  lbm::Sides sides = lbm::Sides::Insulated;
  std::vector<double> conductivity; ///< of phases 0 and 1
  int axis = 0;
  std::function<PhaseImage(int)> draw;
  double truth = 0; ///< 0: from finer pictures
};

/// Inclusions and what is around them, conducting either way round.
std::vector<double> contrast(Random& random)
{
  return pick<std::vector<double>>(random,
    { { 1, 0.05 }, { 1, 0.2 }, { 1, 0 }, { 1, 0.003 }, { 1, 4 }, { 1, 20 }, { 1, 100 }, { 0.04, 1 }, { 0.4, 1 } });
}

lbm::Sides someSides(Random& random)
{
  return random() % 2 == 0 ? lbm::Sides::Periodic : lbm::Sides::Insulated;
}

/// One disk of the square array, anywhere in a cell of which every side is periodic, or in its middle.
Material squareArray(Random& random)
{
  const double fraction = pick(random, { 0.15, 0.25, 0.4, 0.55, 0.65 });
  const bool periodic = random() % 2 == 0;
  const Spot c = periodic ? Spot{ uniform(random, 0, 1), uniform(random, 0, 1), 0 } : Spot{ 0.5, 0.5, 0 };
  const double r2 = fraction / std::numbers::pi;
  Material m{ "disks, square array", 2, periodic ? lbm::Sides::Periodic : lbm::Sides::Insulated, contrast(random), 0,
    [=](int n) { return sampled(2, cube(n, 2), [=](Spot p) { return near2(p, c) < r2; }); } };
  m.truth = m.conductivity[0] * test::squareArrayOfDisks(fraction, m.conductivity[1] / m.conductivity[0]);
  return m;
}

/// Spheres on a cubic lattice, by Sangani and Acrivos, Proc. R. Soc. A 386 (1983) 263, their equation 52: to the order
/// 25/3 in the volume fraction.
double cubicSpheres(int kind, double fraction, double s)
{
  constexpr double c[3][6] = { { 1.305, 0.231, 0.405, 0.0723, 0.153, 0.0105 },
    { 0.129, -0.413, 0.764, 0.257, 0.0113, 0.00562 }, { 0.0753, 0.697, -0.741, 0.0420, 0.0231, 9.14e-7 } };
  const auto l = [&](int i) { return (s - 1) / (s + 2.0 * i / (2 * i - 1)); };
  const auto power = [&](double e) { return std::pow(fraction, e / 3); };
  const double* const a = c[kind];
  const double d = -1 / l(1) + fraction +
    a[0] * l(2) * power(10) * (1 + a[1] * l(3) * power(11)) / (1 - a[2] * l(2) * power(7)) + a[3] * l(3) * power(14) +
    a[4] * l(4) * power(18) + a[5] * l(5) * power(22);
  return 1 - 3 * fraction / d;
}

Material sphereArray(Random& random)
{
  const int kind = static_cast<int>(random() % 3);
  const double fraction = pick(random, { 0.1, 0.2, 0.3 });
  const std::vector<Spot> base = cubicLattice(kind);
  const Spot shift{ uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1) };
  const double radius = std::cbrt(3 * fraction / (4 * std::numbers::pi * static_cast<double>(base.size())));
  Material m{ "spheres, cubic arrays", 3, lbm::Sides::Periodic, contrast(random), 0,
    [=](int n) { return sampled(3, cube(n, 3), balls(base, shift, radius)); } };
  m.truth = m.conductivity[0] * cubicSpheres(kind, fraction, m.conductivity[1] / m.conductivity[0]);
  return m;
}

Material polygons(Random& random, int dimension)
{
  const Shape inside = randomPolygons(random, dimension);
  return { dimension == 2 ? "random polygons" : "random boxes", dimension, someSides(random), contrast(random),
    static_cast<int>(random() % static_cast<unsigned>(dimension)),
    [=](int n) { return sampled(dimension, cube(n, dimension), inside); } };
}

/// Heat or vapour through wood: phase 0 lumen, 1 wall.
std::vector<double> woodContrast(Random& random)
{
  return pick<std::vector<double>>(random, { { 0.023, 1 }, { 0, 1 }, { 0.3, 1 }, { 1, 0.004 }, { 1, 0.05 } });
}

Material tissue(Random& random, int kind)
{
  const auto seed = static_cast<std::uint64_t>(random() % 100000);
  const double ring = uniform(random, 0, 1);
  const auto axis = static_cast<int>(random() % 2);
  if (kind == 0)
    return { "softwood", 2, lbm::Sides::Insulated, woodContrast(random), axis,
      [=](int n)
      {
        generators::SoftwoodOptions o;
        o.size = { n, n, 1 };
        o.spacing = 180e-6 / n;
        o.ringPosition0 = o.ringPosition1 = ring;
        o.solidFraction = 0.25 + 0.5 * ring;
        o.seed = seed;
        return generators::softwood(o);
      } };
  if (kind == 1)
    return { "hardwood", 2, lbm::Sides::Insulated, woodContrast(random), axis,
      [=](int n)
      {
        generators::HardwoodOptions o;
        o.size = { n, n, 1 };
        o.spacing = 200e-6 / n;
        o.ringPosition0 = 0.5 * ring;
        o.ringPosition1 = 0.5 + 0.5 * ring;
        o.solidFraction = 0.35 + 0.2 * ring;
        o.seed = seed;
        return generators::hardwood(o);
      } };
  return { "softwood in space", 3, lbm::Sides::Insulated, woodContrast(random), static_cast<int>(random() % 3),
    [=](int n)
    {
      generators::SoftwoodOptions o;
      o.dimension = 3;
      o.size = { n, n, n };
      o.spacing = 110e-6 / n;
      o.solidFraction = 0.45 + 0.2 * ring;
      o.rayEvery = 0;
      o.tracheidLength = 120e-6;
      o.seed = seed;
      return generators::softwood(o);
    } };
}

Material honeycomb(Random& random)
{
  const double solid = uniform(random, 0.25, 0.6);
  return { "honeycomb", 2, lbm::Sides::Periodic, woodContrast(random), static_cast<int>(random() % 2),
    [=](int n)
    {
      generators::HoneycombOptions o;
      o.size = { n, static_cast<std::int64_t>(std::lround(n * std::sqrt(3.0) / 2)), 1 };
      o.solidFraction = solid;
      o.cellsAcross = 2;
      return generators::honeycomb(o);
    } };
}

lbm::DiffusionAnswer answerOf(const Material& m, const PhaseImage& image, lbm::StudyOptions options)
{
  options.steady.stencil = m.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
  options.steady.sides = m.sides;
  options.axes = { m.axis };
  return lbm::studyDiffusion(image, m.conductivity, options, MPI_COMM_SELF).front();
}

double valueOf(const lbm::DiffusionAnswer& answer)
{
  return answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

/// Of the material: 0 where it has none.
double truthOf(const Material& m)
{
  if (m.truth > 0)
    return m.truth;
  const int fine = m.dimension == 3 ? 128 : 1536;
  lbm::StudyOptions options;
  options.estimateError = false;
  try
  {
    const double half = valueOf(answerOf(m, m.draw(fine / 2), options));
    const double whole = valueOf(answerOf(m, m.draw(fine), options));
    return 2 * whole - half;
  }
  catch (const NoPathError&)
  {
    return 0;
  }
}

struct Tally
{
  int cases = 0;
  int held = 0;
  int lattice = 0;          ///< held by the lattice's part alone
  std::vector<double> bars; ///< bar over error
  double worst = 0;         ///< error over bar
  int given = 0;            ///< with an extrapolated value
  int nearer = 0;           ///< of these nearer than the value

  void add(const lbm::DiffusionAnswer& answer, double truth)
  {
    const double value = valueOf(answer);
    const double error = std::abs(truth / value - 1); // relative to the value, as the bar is
    ++cases;
    held += error <= answer.error.relative ? 1 : 0;
    lattice += error <= answer.error.lattice ? 1 : 0;
    bars.push_back(answer.error.relative / std::max(error, 1e-9));
    worst = std::max(worst, error / answer.error.relative);
    if (std::isfinite(answer.error.extrapolated))
    {
      ++given;
      nearer += std::abs(answer.error.extrapolated - truth) < std::abs(value - truth) ? 1 : 0;
    }
  }
  void add(const Tally& other)
  {
    cases += other.cases;
    held += other.held;
    lattice += other.lattice;
    bars.insert(bars.end(), other.bars.begin(), other.bars.end());
    worst = std::max(worst, other.worst);
    given += other.given;
    nearer += other.nearer;
  }
};

void print(const std::map<std::string, Tally>& tallies)
{
  fmt::print("| material | cases | total holds | median bar over error | worst error over bar | lattice's part alone "
             "would hold | extrapolated nearer |\n|---|---|---|---|---|---|---|\n");
  Tally all;
  const auto line = [](const std::string& kind, const Tally& t)
  {
    fmt::print("| {} | {} | {} | {:.1f} | {:.2f} | {} | {} of {} |\n", kind, t.cases, t.held, median(t.bars), t.worst,
      t.lattice, t.nearer, t.given);
  };
  for (const auto& [kind, tally] : tallies)
  {
    line(kind, tally);
    all.add(tally);
  }
  line("all", all);
}

std::vector<Material> materials(Random& random, const Keys& keys)
{
  const int times = keys.contains("quick") ? 2 : 10;
  std::vector<Material> all;
  for (int i = 0; i < times; ++i)
  {
    all.push_back(squareArray(random));
    all.push_back(squareArray(random));
    all.push_back(polygons(random, 2));
    all.push_back(polygons(random, 2));
    all.push_back(honeycomb(random));
    all.push_back(tissue(random, 0));
    all.push_back(tissue(random, 1));
    all.push_back(sphereArray(random));
    if (i % 2 == 0)
      all.push_back(polygons(random, 3));
    if (i % 3 == 0)
      all.push_back(tissue(random, 2));
  }
  return all;
}

/// Pixels across, two or three sizes a material, odd and even.
std::vector<int> sizesOf(const Material& m, Random& random)
{
  const auto about = [&](int n) { return n + static_cast<int>(random() % static_cast<unsigned>(n / 4)); };
  if (m.kind == "softwood" || m.kind == "hardwood")
    return { about(110), about(220), about(400) };
  if (m.kind == "softwood in space")
    return { about(46), about(64) };
  return m.dimension == 3 ? std::vector<int>{ about(18), about(32) }
                          : std::vector<int>{ about(26), about(60), about(130) };
}

void run(const Keys& keys)
{
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 2026));
  std::ofstream lines;
  if (keys.contains("cases"))
    lines.open(text(keys, "cases", ""));
  const double target = number(keys, "target", 0.02);
  Random random(seed);
  std::map<std::string, Tally> bars;
  std::map<std::string, Tally> targets;
  int tooCoarse = 0;
  for (const Material& m : materials(random, keys))
  {
    const std::vector<int> sizes = sizesOf(m, random);
    const double truth = truthOf(m);
    for (const int n : sizes)
      try
      {
        const PhaseImage picture = m.draw(n);
        const lbm::DiffusionAnswer plain = answerOf(m, picture, {});
        bars[m.kind].add(plain, truth);
        if (lines)
          lines << fmt::format("{},{},{},{},{},{},{},{},{},{}\n", m.kind, n, m.conductivity[0], m.conductivity[1],
                     m.sides == lbm::Sides::Periodic ? "periodic" : "insulated", valueOf(plain), truth,
                     plain.error.relative, plain.error.lattice, plain.error.picture)
                << std::flush;
        if (m.dimension == 3)
          continue;
        lbm::StudyOptions aimed;
        aimed.targetError = target;
        const lbm::DiffusionAnswer answer = answerOf(m, picture, aimed);
        if (answer.target == lbm::Target::Reached)
          targets[m.kind].add(answer, truth);
        else
          ++tooCoarse;
      }
      catch (const Error& e) // a picture too coarse for closed walls, or for a path
      {
        fmt::print(stderr, "left out: {} with {} pixels across: {}\n", m.kind, n, e.what());
      }
  }
  fmt::print("\nerror bars\n\n");
  print(bars);
  fmt::print("\ntarget error {:g} %, where it was reached\n\n", 100 * target);
  print(targets);
  fmt::print("\nand {} that said a finer picture is needed\n", tooCoarse);
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
