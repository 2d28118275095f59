// study=spheres, bars, labels, geometry, membranes, membrane-bars; all unless told.
//
// spheres: how near plain voxels come to the material, voxels that know their share of a phase, and labels that are
// smoothed: simple cubic array of spheres, by fraction, contrast (sphere over matrix; 1e6 for infinity) and voxels
// across; each also extrapolated from these and half as many; and whether the error bar of the shares holds. The truth:
// multipoles (sphere-arrays.csv, made by sphere-arrays.py). bars: how often the bar of studyShares() holds the
// material's value, on balls at random, cylinders and layers at random angles, drawn with 24 to 48 nodes across (count=
// of them; the value: extrapolated from 64 and 128 nodes). labels: the same of plain voxels and of smoothed labels, too
// (count=, seed=). geometry: where smoothed labels put the surfaces of balls, cylinders, planes, thin walls and near
// balls (tries= of each).
//   fraction=0.1,0.2,0.3,0.4,0.5  contrast=0,0.001,0.1,10,1000,1e6  size=16,32,64,128  truths=FILE
//
// membranes: the same spheres, of whole voxels, with a resistance on their surface (sphere-membranes.csv), by what
// faces carry: as much as the surface does, or as it is scaled; with bars of sizes up to bars=64. membrane-bars: how
// often the bar of studyDiffusion() holds where the truth is known: such spheres and square arrays of disks anywhere,
// periodic layers at an angle in the plane and in space; count= of them. Both with voxels of the proportions edges=, of
// which the size counts along an edge of 1.
//   resistance=0.1,1,10  membranes=FILE  edges=1,1,1
#include "Keys.h"
#include "Shapes.h"
#include "Table.h"

#include "../tests/SphereShares.h"
#include "../tests/verification/DiskArray.h"

#include "core/Error.h"
#include "lattice/LabelShares.h"
#include "lbm/Shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

constexpr int levels = shareLevels;

struct Truth
{
  double fraction = 0, contrast = 0, value = 0;
  double resistance = 0; ///< of the surface, times the matrix's conductivity over the radius
};

std::vector<Truth> truthsOf(const std::string& file)
{
  std::ifstream in(file);
  std::vector<Truth> truths;
  for (std::string line; std::getline(in, line);)
  {
    Truth t;
    const int found = std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t.fraction, &t.contrast, &t.value, &t.resistance);
    if (found == 4)
      std::swap(t.value, t.resistance);
    if (found >= 3)
      truths.push_back(t);
  }
  if (truths.empty())
    throw ParameterError("no truths in '" + file + "'", "write them with benchmarks/sphere-arrays.py");
  return truths;
}

/// A cell of the array; no phases yet.
PhaseImage cell(std::int64_t n)
{
  PhaseImage image;
  image.lattice = makeLattice(n, n, n, 3, 1.0 / static_cast<double>(n));
  return image;
}

lbm::StudyOptions alongX()
{
  lbm::StudyOptions study;
  study.axes = { 0 };
  study.steady.stencil = lbm::Stencil::D3Q7;
  study.steady.sides = lbm::Sides::Mixed;
  study.steady.tolerance = 1e-7;
  study.steady.fieldTolerance = std::numeric_limits<double>::infinity();
  return study;
}

/// Of plain voxels: the phase that at least half of each is.
double ofVoxels(std::int64_t n, double fraction, double contrast)
{
  PhaseImage image = cell(n);
  for (const double s : test::sphereShares(n, fraction))
    image.phase.push_back(s >= 0.5 ? 1 : 0);
  lbm::StudyOptions study = alongX();
  study.estimateError = false;
  return lbm::studyDiffusion(image, std::vector{ 1.0, contrast }, study, MPI_COMM_SELF).front().result.effective[0];
}

lbm::DiffusionAnswer ofShares(std::int64_t n, double fraction, double contrast)
{
  PhaseImage image = cell(n);
  for (const double s : test::sphereShares(n, fraction))
    image.phase.push_back(static_cast<std::uint8_t>(std::lround(s * (levels - 1))));
  return lbm::studyShares(image, evenShares(), 1, contrast, alongX(), MPI_COMM_SELF).front();
}

/// Labels: the phase that at least half of a share is.
PhaseImage labelled(std::int64_t n, const std::vector<double>& share)
{
  PhaseImage image = cell(n);
  for (const double s : share)
    image.phase.push_back(s >= 0.5 ? 1 : 0);
  return image;
}

lbm::DiffusionAnswer ofLabels(
  std::int64_t n, const std::vector<double>& share, double contrast, const lbm::StudyOptions& study)
{
  return lbm::studyLabels(labelled(n, share), 1, { 1, contrast }, study, MPI_COMM_SELF).answers.front();
}

void spheres(const Keys& keys)
{
  const std::vector<double> sizes =
    keys.contains("size") ? list(keys, "size", 0) : std::vector{ 16.0, 32.0, 64.0, 128.0 };
  Table table(keys, "surface-shares", "spheres", "fraction,contrast,way,nodes,value,error,extrapolated_error,bar,held");
  int held = 0;
  int bars = 0;
  int smoothHeld = 0;
  for (const Truth& t : truthsOf(text(keys, "truths", SPHERE_TRUTHS)))
  {
    const auto wanted = [&](const char* key, double value)
    {
      const std::vector<double> all = list(keys, key, value);
      return std::ranges::find(all, value) != all.end();
    };
    if (!wanted("fraction", t.fraction) || !wanted("contrast", t.contrast))
      continue;
    fmt::print("fraction {:g}, spheres of {:g}: {:.6f}; errors [%]\n", t.fraction, t.contrast, t.value);
    const auto error = [&](double value) { return 100 * (value / t.value - 1); };
    for (const double size : sizes)
    {
      const auto n = static_cast<std::int64_t>(size);
      const double voxels = ofVoxels(n, t.fraction, t.contrast);
      const double voxels2 = 2 * voxels - ofVoxels(n / 2, t.fraction, t.contrast);
      const lbm::DiffusionAnswer shares = ofShares(n, t.fraction, t.contrast);
      const double value = shares.result.effective[0];
      const double bar = 100 * shares.error.relative;
      const bool holds = std::abs(error(value)) <= bar;
      ++bars;
      held += holds ? 1 : 0;
      const lbm::DiffusionAnswer labels = ofLabels(n, test::sphereShares(n, t.fraction), t.contrast, alongX());
      const double smooth = labels.result.effective[0];
      const double smoothBar = 100 * labels.error.relative;
      const bool smoothHolds = std::abs(error(smooth)) <= smoothBar;
      smoothHeld += smoothHolds ? 1 : 0;
      fmt::print("  {:>4}  voxels {:+8.3f} and extrapolated {:+8.3f}; shares {:+8.3f} and {:+8.3f}, bar {:.3f}{}\n", n,
        error(voxels), error(voxels2), error(value), error(shares.error.extrapolated), bar,
        holds ? "" : " does not hold");
      fmt::print("        labels {:+8.3f} and extrapolated {:+8.3f}, bar {:.3f}{}\n", error(smooth),
        error(labels.error.extrapolated), smoothBar, smoothHolds ? "" : " does not hold");
      table.line(t.fraction, t.contrast, "labels", n, smooth, error(smooth), error(labels.error.extrapolated),
        smoothBar, smoothHolds ? 1 : 0);
      table.line(t.fraction, t.contrast, "voxels", n, voxels, error(voxels), error(voxels2), "", "");
      table.line(
        t.fraction, t.contrast, "shares", n, value, error(value), error(shares.error.extrapolated), bar, holds ? 1 : 0);
      std::fflush(stdout);
    }
  }
  fmt::print("bars held {} of {}, of labels {}\n", held, bars, smoothHeld);
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

Spot randomDirection(Random& random)
{
  const Spot d{ uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1) };
  const double length = std::hypot(d.x, d.y, d.z);
  return { d.x / length, d.y / length, d.z / length };
}

Shape randomShape(Random& random, int kind)
{
  const Spot d = randomDirection(random);
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

double median(std::vector<double> v)
{
  std::ranges::sort(v);
  return v[v.size() / 2];
}

void bars(const Keys& keys)
{
  const int count = static_cast<int>(number(keys, "count", 90));
  Random random(static_cast<std::uint64_t>(number(keys, "seed", 1)));
  Table table(keys, "surface-shares", "bars", "kind,nodes,contrast,value,bar,extrapolated,truth,error,held");
  const std::vector<double> even = evenShares();
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
  fmt::print("held {} of {}; bar over error {:.2g}, error {:.2g} %, of the extrapolated value {:.2g} % (medians)\n",
    held, count, median(ratios), 100 * median(errors), 100 * median(better));
}

/// Labels of shapes that nothing was tuned on, sampled at the middles of voxels: whole, smoothed, and exact shares.
void labels(const Keys& keys)
{
  const int count = static_cast<int>(number(keys, "count", 60));
  Random random(static_cast<std::uint64_t>(number(keys, "seed", 1)));
  Table table(keys, "surface-shares", "labels",
    "kind,nodes,contrast,truth,voxels,voxels_extrapolated,shares,shares_extrapolated,labels,labels_extrapolated,"
    "lattice_bar,label_bar,held");
  int held = 0;
  std::array<std::vector<double>, 6> errors;
  std::vector<double> ratios;
  for (int i = 0; i < count; ++i)
  {
    const int kind = i % 3;
    const Shape shape = randomShape(random, kind);
    const double contrast = pick(random, { 1000.0, 30.0, 3.0, 0.3, 0.03, 0.001 });
    const auto n = static_cast<std::int64_t>(24 + random() % 25);
    lbm::StudyOptions study = alongX();
    study.steady.sides = lbm::Sides::Insulated;
    const auto exact = [&](std::int64_t across, bool estimate)
    {
      PhaseImage image = cell(across);
      for (const double s : shares(across, shape))
        image.phase.push_back(static_cast<std::uint8_t>(std::lround(s * (levels - 1))));
      study.estimateError = estimate;
      return lbm::studyShares(image, evenShares(), 1, contrast, study, MPI_COMM_SELF).front();
    };
    const double truth = 2 * exact(128, false).result.effective[0] - exact(64, false).result.effective[0];
    const auto known = exact(n, true);
    study.estimateError = true;
    const PhaseImage image = sampled(3, { n, n, n }, shape);
    const auto plain = lbm::studyDiffusion(image, std::vector{ 1.0, contrast }, study, MPI_COMM_SELF).front();
    const auto found = lbm::studyLabels(image, 1, { 1, contrast }, study, MPI_COMM_SELF).answers.front();
    const double voxels = plain.result.effective[0];
    const double expected = std::isfinite(plain.error.extrapolated) ? plain.error.extrapolated : voxels;
    const double value = found.result.effective[0];
    const std::array<double, 6> values{ voxels, expected, known.result.effective[0], known.error.extrapolated, value,
      found.error.extrapolated };
    for (std::size_t k = 0; k < 6; ++k)
      errors[k].push_back(std::abs(values[k] / truth - 1));
    const bool holds = errors[4].back() <= found.error.relative;
    held += holds ? 1 : 0;
    ratios.push_back(found.error.relative / errors[4].back());
    table.line(kind, n, contrast, truth, values[0], values[1], values[2], values[3], values[4], values[5],
      found.error.lattice, found.error.picture, holds ? 1 : 0);
    const auto percent = [&](std::size_t k) { return 100 * (values[k] / truth - 1); };
    fmt::print(
      "  kind {} of {} nodes, contrast {:g}: {:.5f}; errors [%]: voxels {:+.2f} and {:+.2f}, shares {:+.2f} and "
      "{:+.2f}, labels {:+.2f} and {:+.2f}, bar {:.2f} + {:.2f}{}\n",
      kind, n, contrast, truth, percent(0), percent(1), percent(2), percent(3), percent(4), percent(5),
      100 * found.error.lattice, 100 * found.error.picture, holds ? "" : ", does not hold");
    std::fflush(stdout);
  }
  fmt::print("held {} of {}; bar over error {:.2g} (median). Medians of errors: voxels {:.3f} %, extrapolated {:.3f}; "
             "shares {:.3f}, extrapolated {:.3f}; labels {:.3f}, extrapolated {:.3f}\n",
    held, count, median(ratios), 100 * median(errors[0]), 100 * median(errors[1]), 100 * median(errors[2]),
    100 * median(errors[3]), 100 * median(errors[4]), 100 * median(errors[5]));
}

/// How far smoothed labels put the surfaces of known shapes from where these are, as their middles and as every voxel
/// sees it. Lengths in voxels.
void geometry(const Keys& keys)
{
  const int tries = static_cast<int>(number(keys, "tries", 8));
  Random random(static_cast<std::uint64_t>(number(keys, "seed", 1)));
  Table table(keys, "surface-shares", "geometry",
    "shape,size,moved_labels,scatter_labels,share_error_labels,moved,"
    "scatter,share_error");
  fmt::print(
    "moved: mean and root mean square of {} places [voxels]; share: root mean square error of cut voxels\n", tries);
  struct Kind
  {
    const char* name;
    double size;
    std::int64_t across, margin;
  };
  std::vector<Kind> kinds;
  for (const double radius : { 2., 3., 5., 10., 20., 40. })
    kinds.push_back({ "ball", radius, static_cast<std::int64_t>(2 * radius + 16), 0 });
  for (const double radius : { 2., 3., 5., 10. })
    kinds.push_back({ "cylinder", radius, 56, 12 });
  kinds.push_back({ "plane", 0, 56, 12 });
  for (const double thick : { 1., 1.5, 2., 3., 5. })
    kinds.push_back({ "wall", thick, 56, 12 });
  for (const double gap : { 0.5, 1., 2., 4. })
    kinds.push_back({ "gap", gap, 56, 0 });
  for (const Kind& kind : kinds)
  {
    std::array<double, 2> sum{};
    std::array<double, 2> squares{};
    std::array<double, 2> shareSquares{};
    double cut = 0;
    for (int i = 0; i < tries; ++i)
    {
      const auto n = static_cast<double>(kind.across);
      const Spot d = randomDirection(random);
      const Spot c{ n / 2 + uniform(random, 0, 1), n / 2 + uniform(random, 0, 1), n / 2 + uniform(random, 0, 1) };
      const std::string name = kind.name;
      const Shape shape = [=, size = kind.size](Spot p)
      {
        const Spot q{ n * p.x - c.x, n * p.y - c.y, n * p.z - c.z };
        const double along = q.x * d.x + q.y * d.y + q.z * d.z;
        const double square = q.x * q.x + q.y * q.y + q.z * q.z;
        if (name == "ball")
          return square < size * size;
        if (name == "cylinder")
          return square - along * along < size * size;
        if (name == "plane")
          return along < 0;
        if (name == "wall")
          return std::abs(along) < size / 2;
        constexpr double radius = 9; // two balls, `size` apart
        const double from = std::abs(along) - radius - size / 2;
        return from * from + square - along * along < radius * radius;
      };
      const std::vector<double> exact = shares(kind.across, shape);
      const PhaseImage image = sampled(3, { kind.across, kind.across, kind.across }, shape);
      const std::vector<std::uint8_t> smooth = labelShares(image.lattice, image.phase, 1, { false, false, false }, 1);
      std::array<double, 2> more{};
      double area = 0;
      const auto inner = [&](std::int64_t x) { return x >= kind.margin + 1 && x < kind.across - kind.margin - 1; };
      for (std::int64_t z = 0; z < kind.across; ++z)
        for (std::int64_t y = 0; y < kind.across; ++y)
          for (std::int64_t x = 0; x < kind.across; ++x)
            if (inner(x) && inner(y) && inner(z))
            {
              const auto at = [&](std::int64_t a, std::int64_t b, std::int64_t e)
              { return static_cast<std::size_t>(image.lattice.index(a, b, e)); };
              const std::size_t own = at(x, y, z);
              area += 0.5 *
                std::hypot(exact[at(x + 1, y, z)] - exact[at(x - 1, y, z)],
                  exact[at(x, y + 1, z)] - exact[at(x, y - 1, z)], exact[at(x, y, z + 1)] - exact[at(x, y, z - 1)]);
              cut += exact[own] > 0 && exact[own] < 1 ? 1 : 0;
              for (const std::size_t k : { 0U, 1U })
              {
                const double error = (k == 0 ? image.phase[own] : smooth[own] / double{ levels - 1 }) - exact[own];
                more[k] += error;
                shareSquares[k] += error * error;
              }
            }
      for (const std::size_t k : { 0U, 1U })
      {
        sum[k] += more[k] / area / tries;
        squares[k] += more[k] * more[k] / (area * area) / tries;
      }
    }
    const auto scatter = [&](std::size_t k) { return std::sqrt(squares[k]); };
    const auto ofShares = [&](std::size_t k) { return std::sqrt(shareSquares[k] / cut); };
    fmt::print("  {:<8} {:>4g}  labels: moved {:+.3f}, {:.3f}, share {:.3f}; smoothed: moved {:+.3f}, {:.3f}, share "
               "{:.3f}\n",
      kind.name, kind.size, sum[0], scatter(0), ofShares(0), sum[1], scatter(1), ofShares(1));
    table.line(kind.name, kind.size, sum[0], scatter(0), ofShares(0), sum[1], scatter(1), ofShares(1));
    std::fflush(stdout);
  }
}

/// Whether a table's line was asked for.
bool wanted(const Keys& keys, const char* key, double value)
{
  const std::vector<double> all = list(keys, key, value);
  return std::ranges::find(all, value) != all.end();
}

/// Each face carries what the surface does.
/// Voxels of the proportions edges=.
std::array<double, 3> edgesOf(const Keys& keys)
{
  const std::vector<double> given = list(keys, "edges", 1);
  if (given.size() != 1 && given.size() != 3)
    throw ParameterError(fmt::format("{} edges", given.size()), "give those along x, y and z");
  return { given.front(), given.size() > 1 ? given[1] : given.front(), given.back() };
}

/// A unit cell, sampled at the middles of voxels, n of them along an edge of 1.
PhaseImage sampledBy(int dimension, int n, const std::array<double, 3>& edges, const Shape& inside)
{
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::array<double, 3> spacing{ 1, 1, 1 };
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
  {
    size[a] = std::lround(n / edges[a]);
    spacing[a] = 1.0 / static_cast<double>(size[a]);
  }
  const auto stretched = [&](Spot p) {
    return inside({ p.x, p.y * spacing[1] / spacing[0], dimension == 3 ? p.z * spacing[2] / spacing[0] : 0.0 });
  };
  PhaseImage image = sampled(dimension, size, stretched);
  if (const std::array<double, 3> aspect{ 1, spacing[1] / spacing[0], dimension == 3 ? spacing[2] / spacing[0] : 1.0 };
      aspect != image.lattice.aspect)
    image.lattice = makeLattice(size[0], size[1], size[2], dimension, spacing[0], aspect);
  return image;
}

double literally(const PhaseImage& image, double contrast, const lbm::Membrane& membrane)
{
  const lbm::MembraneIds ids{ image.phase, { 0, 1 }, { 1, 1 }, {}, {} };
  const std::vector<double> k{ 1, contrast };
  lbm::SteadyOptions o = alongX().steady;
  o.pairs = std::make_shared<lbm::PairTable>(lbm::membraneLinks(ids, k, std::vector{ membrane }, image.lattice));
  lbm::SteadyDiffusion solver(image.lattice, decompose(image.lattice, MPI_COMM_SELF), ids.id, k, o);
  return solver.solve(0).effective[0];
}

void membranes(const Keys& keys)
{
  const std::vector<double> sizes = keys.contains("size") ? list(keys, "size", 0) : std::vector{ 32.0, 64.0, 128.0 };
  const double largest = number(keys, "bars", 64);
  const std::array<double, 3> edges = edgesOf(keys);
  Table table(
    keys, "surface-shares", "membranes", "fraction,contrast,resistance,nodes,value,literal_error,error,bar,held");
  int held = 0;
  int bars = 0;
  for (const Truth& t : truthsOf(text(keys, "membranes", MEMBRANE_TRUTHS)))
  {
    if (!wanted(keys, "fraction", t.fraction) || !wanted(keys, "contrast", t.contrast) ||
      !wanted(keys, "resistance", t.resistance))
      continue;
    fmt::print("fraction {:g}, spheres of {:g}, resistance {:g}: {:.6f}; errors [%]\n", t.fraction, t.contrast,
      t.resistance, t.value);
    for (const double size : sizes)
    {
      const auto n = static_cast<std::int64_t>(size);
      const double radius = std::cbrt(3 * t.fraction / (4 * std::numbers::pi));
      PhaseImage image = cell(n);
      if (edges == std::array<double, 3>{ 1, 1, 1 })
        for (const double s : test::sphereShares(n, t.fraction))
          image.phase.push_back(s >= 0.5 ? 1 : 0);
      else
        image = sampledBy(3, static_cast<int>(n), edges,
          [&](Spot p) {
            return near2(p, { 0.5, 0.513, 0.479 }) < radius * radius;
          });
      const lbm::Membrane membrane{ 0, 1, t.resistance * radius };
      lbm::StudyOptions study = alongX();
      study.membranes = { membrane };
      study.estimateError = size <= largest;
      const auto found = lbm::studyDiffusion(image, std::vector{ 1.0, t.contrast }, study, MPI_COMM_SELF).front();
      const double value = found.result.effective[0];
      const auto error = [&](double v) { return 100 * (v / t.value - 1); };
      const double plain = literally(image, t.contrast, membrane);
      const double bar = 100 * found.error.relative;
      const bool holds = std::abs(error(value)) <= bar;
      bars += study.estimateError ? 1 : 0;
      held += study.estimateError && holds ? 1 : 0;
      fmt::print("  {:>4}  literally {:+8.3f}, scaled {:+8.3f}", n, error(plain), error(value));
      if (study.estimateError)
        fmt::print(", bar {:.3f}{}", bar, holds ? "" : " does not hold");
      fmt::print("\n");
      table.line(t.fraction, t.contrast, t.resistance, n, value, error(plain), error(value), bar, holds ? 1 : 0);
      std::fflush(stdout);
    }
  }
  fmt::print("bars held {} of {}\n", held, bars);
}

/// A periodic cell with membranes whose conductivity along x is known, over that of phase 0.
struct MembraneCase
{
  const char* kind = "";
  PhaseImage image;
  double contrast = 1;
  double resistance = 0; ///< the cell's side is 1
  double truth = 1;
};

double logUniform(Random& random, double low, double high)
{
  return low * std::pow(high / low, uniform(random, 0, 1));
}

MembraneCase randomMembranes(
  Random& random, int kind, const std::vector<Truth>& spheres, const std::array<double, 3>& edges)
{
  MembraneCase c;
  const Spot centre{ uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1) };
  const int n = static_cast<int>(kind % 2 == 0 ? 20 + 2 * (random() % 15) : 24 + 2 * (random() % 40));
  c.contrast = logUniform(random, 1e-3, 1e3);
  const double relative = logUniform(random, 0.03, 30);
  if (kind == 0)
  {
    const Truth& t = spheres[random() % spheres.size()];
    const double radius = std::cbrt(3 * t.fraction / (4 * std::numbers::pi));
    c = { "sphere", sampledBy(3, n, edges, [&](Spot p) { return near2(p, centre) < radius * radius; }), t.contrast,
      t.resistance * radius, t.value };
  }
  else if (kind == 1)
  {
    const double fraction = uniform(random, 0.05, 0.5);
    const double radius = std::sqrt(fraction / std::numbers::pi);
    c.kind = "disk";
    c.image = sampledBy(2, n, edges, [&](Spot p) { return near2(p, { centre.x, centre.y, 0 }) < radius * radius; });
    c.resistance = relative * radius;
    c.truth = test::squareArrayOfDisks(fraction, c.contrast, 40, relative);
  }
  else
  {
    const bool space = kind == 2;
    const auto waves = [&] { return static_cast<double>(random() % 4); };
    const std::array<double, 3> wave{ 1 + static_cast<double>(random() % 3), waves(), space ? waves() : 0.0 };
    const double square = wave[0] * wave[0] + wave[1] * wave[1] + wave[2] * wave[2];
    const double part = uniform(random, 0.3, 0.7);
    c.kind = space ? "layers" : "layers in the plane";
    c.image = sampledBy(space ? 3 : 2, n, edges,
      [&](Spot p)
      {
        const double s = wave[0] * p.x + wave[1] * p.y + wave[2] * p.z + centre.x;
        return s - std::floor(s) < part;
      });
    c.resistance = relative / std::sqrt(square);
    const double across = 1 / (part / c.contrast + 1 - part + 2 * relative); // the period is 1/√square
    const double along = part * c.contrast + 1 - part;
    c.truth = along + (across - along) * wave[0] * wave[0] / square;
  }
  return c;
}

void membraneBars(const Keys& keys)
{
  const int count = static_cast<int>(number(keys, "count", 100));
  Random random(static_cast<std::uint64_t>(number(keys, "seed", 1)));
  const std::vector<Truth> spheres = truthsOf(text(keys, "membranes", MEMBRANE_TRUTHS));
  Table table(keys, "surface-shares", "membrane-bars", "kind,nodes,contrast,resistance,value,bar,truth,error,held");
  int held = 0;
  std::vector<double> ratios;
  std::vector<double> errors;
  for (int i = 0; i < count; ++i)
  {
    const MembraneCase c = randomMembranes(random, i % 4, spheres, edgesOf(keys));
    lbm::StudyOptions study;
    study.axes = { 0 };
    study.steady.stencil = c.image.lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
    study.steady.sides = lbm::Sides::Periodic;
    study.steady.tolerance = 1e-5;
    study.membranes = { { 0, 1, c.resistance } };
    const auto found = lbm::studyDiffusion(c.image, std::vector{ 1.0, c.contrast }, study, MPI_COMM_SELF).front();
    const double value = found.result.effective[0];
    const double error = std::abs(value / c.truth - 1);
    // the bar is of the value, and so is the error that it is held against
    const bool holds = std::abs(value - c.truth) <= found.error.relative * value;
    held += holds ? 1 : 0;
    ratios.push_back(found.error.relative / error);
    errors.push_back(error);
    const auto n = c.image.lattice.size[0];
    table.line(c.kind, n, c.contrast, c.resistance, value, found.error.relative, c.truth, error, holds ? 1 : 0);
    if (!holds)
      fmt::print("  {} {} nodes, contrast {:g}, resistance {:g}: {:.5f}, bar {:.2f} %, truth {:.5f}, error {:.2f} %\n",
        c.kind, n, c.contrast, c.resistance, value, 100 * found.error.relative, c.truth, 100 * error);
  }
  const auto median = [](std::vector<double> v)
  {
    std::ranges::sort(v);
    return v[v.size() / 2];
  };
  fmt::print("held {} of {}; bar over error {:.2g}, error {:.2g} % (medians)\n", held, count, median(ratios),
    100 * median(errors));
}

void run(const Keys& keys)
{
  runStudies(keys,
    { { "spheres", [&] { spheres(keys); } }, { "bars", [&] { bars(keys); } }, { "labels", [&] { labels(keys); } },
      { "geometry", [&] { geometry(keys); } }, { "membranes", [&] { membranes(keys); } },
      { "membrane-bars", [&] { membraneBars(keys); } } });
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
