// Do the error bars of `lamella bond-stiffness` hold? Cells of known materials, coarse and less coarse, odd and even,
// in the plane and in space: disks, polygons, honeycombs, laminates, spheres, boxes; contrasts 2 to 100 either way
// round, and voids. The truth is the material's own stiffness: exact for laminates (Backus 1962), else finite elements
// of another program on far finer pictures of the same geometry, extrapolated from two (stiffness-truths.csv, by seed
// and number; key pictures=FOLDER writes such pictures). Where there is none it is this program's own value of far
// finer pictures. Keys: seed=N of the random shapes (2026), horizon=H (3), micromodulus=0|1|2 (2, isotropic), corrected
// (surfaces), quick (a fifth of the materials), only=NUMBER of one material, sizes=N,N (pixels across), truths=FILE,
// cases=FILE for a line a case and constant; elements: by elements instead of bonds.
#include "Keys.h"
#include "Shapes.h"

#include "core/Error.h"
#include "elasticity/VoxelStiffness.h"
#include "peridynamics/StiffnessStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;
using namespace lamella::elasticity;

/// A geometry in a box 1 wide and `height` high, and Young's moduli of its phases 0 and 1; 0: void.
struct Material
{
  std::string kind;
  int dimension = 2;
  std::array<double, 2> young{ 1, 1 };
  double height = 1;
  Shape inside;
  std::vector<double> truth; ///< tensor; empty: not known here

  [[nodiscard]] PhaseImage draw(int n) const
  {
    std::array<std::int64_t, 3> size = cube(n, dimension);
    size[1] = std::lround(n * height);
    return sampled(dimension, size, inside, height);
  }
};

std::array<double, 2> contrast(Random& random)
{
  return pick<std::array<double, 2>>(
    random, { { 1, 2 }, { 1, 5 }, { 1, 20 }, { 1, 100 }, { 1, 0 }, { 1, 0 }, { 2, 1 }, { 10, 1 }, { 50, 1 } });
}

Material squareArray(Random& random)
{
  const double fraction = pick(random, { 0.15, 0.25, 0.4, 0.55 });
  const Spot c = random() % 2 == 0 ? Spot{ uniform(random, 0, 1), uniform(random, 0, 1), 0 } : Spot{ 0.5, 0.5, 0 };
  return { "disks, square array", 2, contrast(random), 1, balls({ c }, {}, std::sqrt(fraction / std::numbers::pi)),
    {} };
}

Material polygons(Random& random, int dimension)
{
  const Shape inside = randomPolygons(random, dimension);
  return { dimension == 2 ? "random polygons" : "random boxes", dimension, contrast(random), 1, inside, {} };
}

/// Regular, straight walls; two cells in a box of 1 : √3.
Material honeycomb(Random& random)
{
  const double side = std::sqrt(1 - uniform(random, 0.25, 0.6)); // of a lumen over that of a cell
  const Spot shift{ uniform(random, 0, 1), uniform(random, 0, 1), 0 };
  const double height = std::sqrt(3.0);
  const double lumen = pick(random, { 0.0, 0.0, 0.0, 0.02 });
  const auto wall = [=](Spot p)
  {
    const auto lumenAround = [&](double cx, double cy)
    {
      const double x = wrapped(p.x - shift.x - cx);
      const double y = height * wrapped(p.y / height - shift.y - cy);
      double most = 0;
      for (int k = 0; k < 3; ++k)
        most =
          std::max(most, std::abs(x * std::cos(k * std::numbers::pi / 3) + y * std::sin(k * std::numbers::pi / 3)));
      return most < 0.5 * side;
    };
    return !lumenAround(0, 0) && !lumenAround(0.5, 0.5);
  };
  return { "honeycomb", 2, { lumen, 1 }, height, wall, {} };
}

/// Of two isotropic phases with the model's Poisson's ratio, by Backus, J. Geophys. Res. 67 (1962) 4427.
std::vector<double> backus(int dimension, std::size_t across, double fraction, std::array<double, 2> young)
{
  const std::size_t n = dimension == 3 ? 6 : 3;
  const auto d = static_cast<std::size_t>(dimension);
  const double c11 = dimension == 3 ? 1.2 : 1.125;
  const double c12 = c11 / 3;
  const double mean = (1 - fraction) * young[0] + fraction * young[1];
  const double series = 1 / ((1 - fraction) / young[0] + fraction / young[1]);
  std::vector<double> c(n * n, 0.0);
  for (std::size_t a = 0; a < d; ++a)
    for (std::size_t b = 0; b < d; ++b)
      c[a * n + b] = a == across || b == across ? (a == b ? c11 : c12) * series
                                                : (a == b ? c11 : c12) * mean + c12 * c12 / c11 * (series - mean);
  for (std::size_t k = d; k < n; ++k)
    c[k * n + k] = c12 * (dimension == 3 && k - d == across ? mean : series);
  return c;
}

Material laminate(Random& random, int dimension)
{
  const double fraction = uniform(random, 0.2, 0.8);
  const double shift = uniform(random, 0, 1);
  const auto across = static_cast<std::size_t>(random() % static_cast<unsigned>(dimension));
  const std::array<double, 2> young{ 1, pick(random, { 2.0, 10.0, 100.0 }) };
  return { "laminate", dimension, young, 1,
    [=](Spot p)
    {
      const double at = (across == 0 ? p.x : across == 1 ? p.y : p.z) - shift;
      return at - std::floor(at) < fraction;
    },
    backus(dimension, across, fraction, young) };
}

Material sphereArray(Random& random)
{
  const std::vector<Spot> base = cubicLattice(static_cast<int>(random() % 3));
  const double fraction = pick(random, { 0.1, 0.2, 0.35 });
  const Spot shift{ uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1) };
  const double radius = std::cbrt(3 * fraction / (4 * std::numbers::pi * static_cast<double>(base.size())));
  return { "spheres, cubic arrays", 3, contrast(random), 1, balls(base, shift, radius), {} };
}

std::vector<Material> materials(Random& random, const Keys& keys)
{
  const int times = keys.contains("quick") ? 1 : 5;
  std::vector<Material> all;
  for (int i = 0; i < times; ++i)
  {
    for (int k = 0; k < 2; ++k)
    {
      all.push_back(squareArray(random));
      all.push_back(polygons(random, 2));
      all.push_back(honeycomb(random));
    }
    all.push_back(laminate(random, 2));
    all.push_back(sphereArray(random));
    all.push_back(polygons(random, 3));
    if (i % 2 == 0)
      all.push_back(laminate(random, 3));
  }
  return all;
}

std::vector<int> sizesOf(const Material& m, Random& random, const Keys& keys)
{
  if (keys.contains("sizes"))
  {
    std::vector<int> sizes;
    for (const double n : list(keys, "sizes", 0))
      sizes.push_back(static_cast<int>(n));
    return sizes;
  }
  const auto about = [&](int n) { return n + static_cast<int>(random() % static_cast<unsigned>(n / 4)); };
  return m.dimension == 3 ? std::vector<int>{ about(16), about(28) }
                          : std::vector<int>{ about(26), about(60), about(120) };
}

struct Setting
{
  double horizon = 3;
  Micromodulus micromodulus = Micromodulus::Isotropic;
  bool corrected = false;
  bool elements = false;
};

BondModel modelOf(const Material& m, const Setting& setting)
{
  BondModel model;
  model.continuum = m.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  model.horizon = setting.horizon;
  model.micromodulus = setting.micromodulus;
  model.surfaceCorrection = setting.corrected;
  model.voids.clear();
  model.phaseNames = { "matrix", "inclusion" };
  const auto [a, b] = m.young;
  for (std::uint8_t id = 0; id < 2; ++id)
    if (m.young[id] > 0)
      model.pairs[{ id, id }].material.youngsModulus = m.young[id];
    else
      model.voids.push_back(id);
  if (a > 0 && b > 0)
    model.pairs[{ 0, 1 }].material.youngsModulus = 2 * a * b / (a + b); // in series
  return model;
}

struct Answer
{
  std::vector<double> stiffness;
  ElasticConstants constants;
  StiffnessError error;
  double seconds = 0;         ///< of the value
  double estimateSeconds = 0; ///< of its error
};

Answer byElements(const Material& m, int n, bool error)
{
  const PhaseImage picture = m.draw(n);
  const Continuum continuum = m.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  std::vector<PhaseStiffness> phases;
  for (const double young : m.young)
    phases.push_back(
      young > 0 ? isotropicStiffness(continuum, young, poissonsRatio(continuum)) : voidStiffness(continuum));
  VoxelStiffnessOptions options;
  options.estimateError = error;
  std::vector<VoxelMaterial> materials;
  for (const PhaseStiffness& values : phases)
    materials.push_back({ values, {}, false, {} });
  const VoxelStiffness r = studyVoxelStiffness(picture.lattice, picture.phase, materials, {}, options);
  if (error && r.error.components.empty())
    for (const std::string& words : r.warnings)
      fmt::print(stderr, "{} with {} pixels across: {}\n", m.kind, n, words);
  return { r.stiffness, r.constants, r.error, r.steps.front().seconds, r.estimateSeconds };
}

Answer answerOf(const Material& m, int n, const Setting& setting, bool error)
{
  if (setting.elements)
    return byElements(m, n, error);
  const PhaseImage picture = m.draw(n);
  StiffnessOptions options;
  options.estimateError = error;
  options.threads = 1;
  const StiffnessResult r =
    studyStiffness(modelOf(m, setting), picture.lattice, picture.phase, {}, options, Communicator(MPI_COMM_SELF));
  return { r.cell.stiffness, r.cell.constants, r.error, r.steps.front().seconds, r.estimateSeconds };
}

/// Tensors by seed and number of the material, upper triangle by rows; and how far the two pictures that each is from
/// are apart, over the largest component.
std::map<std::pair<std::uint64_t, std::size_t>, std::vector<double>> readTruths(const std::string& path)
{
  std::map<std::pair<std::uint64_t, std::size_t>, std::vector<double>> truths;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line))
  {
    if (line.empty() || !std::isdigit(static_cast<unsigned char>(line.front())))
      continue;
    std::vector<double> v;
    std::istringstream in(line);
    for (std::string part; std::getline(in, part, ',');)
      v.push_back(std::atof(part.c_str()));
    const std::size_t n = v.size() == 2 + 21 ? 6 : 3;
    std::vector<double> c(n * n, 0.0);
    std::size_t at = 2;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a; b < n; ++b)
        c[a * n + b] = c[b * n + a] = v.at(at++);
    truths[{ static_cast<std::uint64_t>(v[0]), static_cast<std::size_t>(v[1]) }] = std::move(c);
  }
  return truths;
}

std::vector<double> finer(const Material& m, const Setting& setting)
{
  const int fine = m.dimension == 3 ? 96 : 768;
  std::vector<double> half = answerOf(m, fine / 2, setting, false).stiffness;
  const std::vector<double> whole = answerOf(m, fine, setting, false).stiffness;
  for (std::size_t i = 0; i < half.size(); ++i)
    half[i] = 2 * whole[i] - half[i];
  return half;
}

/// Of one kind of numbers: moduli, Poisson's ratios, components.
struct Tally
{
  int cases = 0;
  int held = 0;
  std::vector<double> bars;  ///< bar over error
  std::vector<double> sizes; ///< bar, relative
  double worst = 0;          ///< error over bar
  int nearer = 0;            ///< extrapolated nearer than the value

  void add(double value, double bar, double extrapolated, double truth, double unit)
  {
    const double error = std::abs(truth - value);
    const double least = 1e-6 * unit;
    ++cases;
    held += error <= bar + least ? 1 : 0;
    bars.push_back(bar / std::max(error, least));
    sizes.push_back(bar / unit);
    worst = std::max(worst, error / std::max(bar, least));
    nearer += std::abs(extrapolated - truth) < error ? 1 : 0;
  }
  void add(const Tally& other)
  {
    cases += other.cases;
    held += other.held;
    bars.insert(bars.end(), other.bars.begin(), other.bars.end());
    sizes.insert(sizes.end(), other.sizes.begin(), other.sizes.end());
    worst = std::max(worst, other.worst);
    nearer += other.nearer;
  }
};

using Tallies = std::map<std::string, Tally>;

void print(const Tallies& tallies)
{
  fmt::print("| material | numbers | held | median bar over error | worst error over bar | median bar | extrapolated "
             "nearer |\n|---|---|---|---|---|---|---|\n");
  Tally all;
  const auto line = [](const std::string& kind, const Tally& t)
  {
    fmt::print("| {} | {} | {} ({:.0f} %) | {:.1f} | {:.2f} | {:.2g} % | {} |\n", kind, t.cases, t.held,
      100.0 * t.held / t.cases, median(t.bars), t.worst, 100 * median(t.sizes), t.nearer);
  };
  for (const auto& [kind, tally] : tallies)
  {
    line(kind, tally);
    all.add(tally);
  }
  line("all", all);
}

void writePicture(const std::string& folder, std::uint64_t seed, std::size_t number, const Material& m)
{
  // finite elements want sides that can be halved often
  for (const int n : m.dimension == 3 ? std::vector<int>{ 72, 144 } : std::vector<int>{ 512, 1024 })
  {
    Material even = m;
    std::array<std::int64_t, 3> size = cube(n, m.dimension);
    size[1] = 8 * std::lround(n * m.height / 8);
    const PhaseImage picture = sampled(m.dimension, size, m.inside, m.height);
    const std::string path = fmt::format(
      "{}/{}-{}-{}x{}x{}-{}-{}.raw", folder, seed, number, size[0], size[1], size[2], m.young[0], m.young[1]);
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(picture.phase.data()), static_cast<std::streamsize>(picture.phase.size()));
  }
}

void run(const Keys& keys)
{
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 2026));
  const Setting setting{ number(keys, "horizon", 3),
    static_cast<Micromodulus>(std::lround(number(keys, "micromodulus", 2))), keys.contains("corrected"),
    keys.contains("elements") };
  const auto truths = readTruths(text(keys, "truths", STIFFNESS_TRUTHS));
  std::ofstream lines;
  if (keys.contains("cases"))
    lines.open(text(keys, "cases", ""));
  Random random(seed);
  const std::vector<Material> all = materials(random, keys);
  Tallies moduli;
  Tallies ratios;
  Tallies components;
  double seconds = 0;
  std::vector<double> prices; ///< time of the error over that of the value
  int unknown = 0;
  int cases = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const Material& m = all[i];
    const std::vector<int> sizes = sizesOf(m, random, keys);
    if (keys.contains("only") && number(keys, "only", 0) != static_cast<double>(i))
      continue;
    if (keys.contains("pictures"))
    {
      if (m.truth.empty())
        writePicture(text(keys, "pictures", "."), seed, i, m);
      continue;
    }
    const auto found = truths.find({ seed, i });
    const std::vector<double> truth = !m.truth.empty() ? m.truth
      : found != truths.end()                          ? found->second
                                                       : finer(m, setting);
    const std::vector<double> exact = constantValues(elasticConstants(truth, m.dimension));
    const std::vector<std::string> names = constantNames(m.dimension);
    for (const int n : sizes)
      try
      {
        const double start = cpu();
        const Answer r = answerOf(m, n, setting, true);
        seconds += cpu() - start;
        ++cases;
        prices.push_back(r.estimateSeconds / r.seconds);
        if (r.error.components.empty())
        {
          ++unknown;
          continue;
        }
        const std::vector<double> values = constantValues(r.constants);
        const std::vector<double> limits = constantValues(r.error.constants);
        for (std::size_t c = 0; c < names.size(); ++c)
        {
          const double limit = limits.empty() ? std::nan("") : limits[c];
          const bool ratio = names[c].starts_with("nu");
          if (!std::isfinite(r.error.ofConstants[c]))
            continue;
          (ratio ? ratios : moduli)[m.kind].add(
            values[c], r.error.ofConstants[c], limit, exact[c], ratio ? 1 : exact[c]);
          if (lines)
            lines << fmt::format("{},{},{},{},{},{},{},{},{},{}\n", i, m.kind, n, m.young[0], m.young[1], names[c],
              values[c], exact[c], r.error.ofConstants[c], limit);
        }
        const std::size_t k = m.dimension == 3 ? 6 : 3;
        for (std::size_t a = 0; a < k; ++a)
          components[m.kind].add(r.stiffness[a * k + a], r.error.components[a * k + a], r.error.extrapolated[a * k + a],
            truth[a * k + a], truth[a * k + a]);
      }
      catch (const Error& e) // a picture too coarse for walls that go on
      {
        fmt::print(stderr, "left out: {} with {} pixels across: {}\n", m.kind, n, e.what());
      }
    std::fflush(stdout);
  }
  if (keys.contains("pictures"))
    return;
  fmt::print("\nYoung's and shear moduli\n\n");
  print(moduli);
  fmt::print("\nPoisson's ratios\n\n");
  print(ratios);
  fmt::print("\ndiagonal of the tensor\n\n");
  print(components);
  fmt::print("\n{} cells; {} whose error was not known; {:.0f} s of processor time; the errors took {:.1f} times as "
             "long as the values in "
             "the median, {:.1f} at most\n",
    cases, unknown, seconds, median(prices), *std::ranges::max_element(prices));
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
