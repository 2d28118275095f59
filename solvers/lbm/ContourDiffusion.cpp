#include "lbm/ContourDiffusion.h"

#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "lbm/Links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::lbm
{
namespace
{

// The conductor of a cut link that is not lumen: the phases of its ends, or any wall where both ends lie in lumens.
double wallOf(std::uint8_t a, std::uint8_t b, std::span<const double> k)
{
  if (a != 0 && b != 0)
    return harmonicMean(k[a], k[b]);
  if (a != 0 || b != 0)
    return k[a != 0 ? a : b];
  return k[1];
}

double inSeries(double share, double lumen, double wall)
{
  if (share >= 1)
    return lumen;
  return wall > 0 && (lumen > 0 || share <= 0) ? 1 / (share / lumen + (1 - share) / wall) : 0.0;
}

void requireCuts(const micrograph::ContourLattice& lattice, std::span<const double> conductivity)
{
  for (const micrograph::LinkCuts& cuts : lattice.links)
    if (cuts.place.size() != 1 || cuts.across.size() != cuts.link.size() || cuts.share.size() != cuts.link.size())
      throw ParameterError(fmt::format("the lattice has {} lines a link", cuts.place.size()),
        "make it with one line along each link and one across");
  if (conductivity.size() < std::max<std::size_t>(2, lattice.image.phases.size()))
    throw ParameterError(
      fmt::format("{} conductivities for {} phases", conductivity.size(), lattice.image.phases.size()),
      "give one for the lumen, one for the wall and one for every phase more");
  for (const double k : conductivity)
    if (!std::isfinite(k) || k < 0)
      throw ParameterError(fmt::format("a conductivity of {}", k), "give finite values of at least 0");
}

} // namespace

LinkTable linksOf(const micrograph::ContourLattice& lattice, std::span<const double> conductivity)
{
  requireCuts(lattice, conductivity);
  const std::int64_t nx = lattice.image.lattice.size[0];
  const std::int64_t ny = lattice.image.lattice.size[1];
  const std::uint8_t* phase = lattice.image.phase.data();
  LinkTable table(nx, ny);
  // the ends of a link; at a face, the only one twice
  const auto ends = [&](int axis, std::int64_t link)
  {
    const std::int64_t across = axis == 0 ? link / (nx + 1) : link % nx;
    const std::int64_t along = axis == 0 ? link % (nx + 1) : link / nx;
    const std::int64_t n = axis == 0 ? nx : ny;
    const std::int64_t low = std::max<std::int64_t>(along - 1, 0);
    const std::int64_t high = std::min(along, n - 1);
    return axis == 0 ? std::array{ phase[low + nx * across], phase[high + nx * across] }
                     : std::array{ phase[across + nx * low], phase[across + nx * high] };
  };
  for (const int axis : { 0, 1 })
  {
    std::vector<double>& g = axis == 0 ? table.x : table.y;
    for (std::size_t i = 0; i < g.size(); ++i)
    {
      const auto [a, b] = ends(axis, static_cast<std::int64_t>(i));
      g[i] = harmonicMean(conductivity[a], conductivity[b]);
    }
    const micrograph::LinkCuts& cuts = lattice.links[static_cast<std::size_t>(axis)];
    for (std::size_t c = 0; c < cuts.link.size(); ++c)
    {
      const auto [a, b] = ends(axis, cuts.link[c]);
      const double wall = wallOf(a, b, conductivity);
      const double lumen = conductivity[0];
      const double across = cuts.across[c];
      g[static_cast<std::size_t>(cuts.link[c])] =
        lumen > wall ? inSeries(cuts.share[c], lumen, wall) : across * lumen + (1 - across) * wall;
    }
  }
  return table;
}

std::vector<ContourAnswer> studyContours(
  const micrograph::ContourSet& contours, const ContourStudyOptions& options, MPI_Comm comm, const ContourSink& sink)
{
  std::vector<ContourAnswer> answers;
  for (const int axis : options.axes)
    answers.emplace_back().axis = axis;
  if (!(options.targetError >= 0) || !std::isfinite(options.targetError))
  {
    throw ParameterError(
      fmt::format("a target of {} for the error", options.targetError), "give a share such as 0.001");
  }
  const Lattice first = micrograph::latticeOf(contours.size, options.spacing, 2);
  // Each lattice lies in the next: half the spacing, the same part of the picture.
  for (int level = 0;; ++level)
  {
    const auto start = Clock::now();
    const bool fine = level > 0;
    micrograph::ContourLatticeOptions make;
    make.spacing = std::ldexp(first.spacing, 1 - level);
    make.multiple = 1 << level;
    make.lines = 1;
    make.across = true;
    make.grain = false;
    micrograph::ContourLattice lattice = micrograph::contourLattice(contours, make);
    if (options.phases)
      options.phases(lattice);
    SteadyOptions steady = options.steady;
    steady.stencil = Stencil::D2Q5;
    steady.sides = Sides::Insulated;
    steady.links = std::make_shared<LinkTable>(linksOf(lattice, options.conductivity));
    if (!fine || !sink)
      steady.fieldTolerance = std::max(steady.fieldTolerance, std::sqrt(steady.tolerance));
    const Block block = decompose(lattice.image.lattice, comm);
    SteadyDiffusion solver(
      lattice.image.lattice, block, blockOf(lattice.image, block), options.conductivity, steady, comm);
    const double made = secondsSince(start) / static_cast<double>(answers.size());
    double worst = 0;
    for (ContourAnswer& answer : answers)
    {
      const auto begin = Clock::now();
      const SteadyResult result = solver.solve(answer.axis);
      answer.coarse = answer.fine;
      answer.fine = { lattice.image.lattice.spacing, result.effective[static_cast<std::size_t>(answer.axis)],
        lattice.image.lattice.count(), result.iterations, made + secondsSince(begin) };
      answer.steps.push_back(answer.fine);
      if (!fine)
        continue;
      answer.result = result;
      answer.value = 2 * answer.fine.value - answer.coarse.value;
      answer.error = std::abs(answer.fine.value - answer.coarse.value) / answer.value;
      worst = std::max(worst, answer.error);
      if (sink)
        sink(solver, answer, lattice, block);
    }
    const bool tooMany = options.mostNodes > 0 && 4 * lattice.image.lattice.count() > options.mostNodes;
    if (fine && (options.targetError == 0 || worst <= options.targetError || tooMany))
    {
      break;
    }
  }
  return answers;
}

} // namespace lamella::lbm
