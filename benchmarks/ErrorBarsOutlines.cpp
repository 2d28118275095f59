// Do the error bars of conductivities on outlines hold? `lamella micrograph --conductivity` on geometries whose truth
// is known: by Rayleigh's multipoles for arrays of disks, by a much finer lattice of the same vectors for the others.
// Never a finer lattice of the same pixels. study=
//   outlines  polygons of disks in square and hexagonal arrays at odd and even sizes, random polygons, generated
//   tissues masks     pictures of them: pixels by their centres and by half of their area, and by the areas themselves
//   scans     generated scans of tissues, segmented
// none: all in turn. set=unseen (usual) or tuned: the geometries, sizes and seeds that the bars were chosen on. Writes
// the cases and the table to the folder output=.
#include "../tests/verification/DiskArray.h"
#include "Table.h"

#include "core/Error.h"
#include "generators/MicrographLook.h"
#include "generators/TissueTruth.h"
#include "lbm/ContourDiffusion.h"
#include "outlines/CoarserOutlines.h"
#include "outlines/ContourMeasures.h"
#include "outlines/ShareLevel.h"
#include "segmentation/Segmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using lbm::ContourAnswer;
using lbm::ContourStudyOptions;
using micrograph::Contour;
using micrograph::ContourSet;
using micrograph::Point;

/// Which geometries.
struct Choice
{
  bool unseen = true;
  std::vector<double> fractions; ///< of arrays of disks
  std::vector<double> contrasts;
  std::vector<int> sizes;    ///< nodes across outlines
  std::vector<int> pixels;   ///< across masks; multiples of five, which the boxes of 1 by 0.8 hold whole
  std::uint64_t seed = 1;    ///< the first of everything random
  int plates = 20;           ///< of each array and fraction
  std::uint64_t tissues = 2; ///< seeds of each kind
  double doubt = 0;          ///< of where a scan's walls begin [pixels]; 0: the segmentation's own
};

Choice choiceOf(const Keys& keys)
{
  const std::string set = text(keys, "set", "unseen");
  if (set == "tuned")
    return { false, { 0.25, 0.55 }, { 0, 0.05, 0.1, 10, 50 }, { 40, 44, 64, 68, 128, 132 }, { 40, 60, 90, 140 }, 1 };
  if (set != "unseen")
    throw ParameterError("no set '" + set + "'", "unseen or tuned");
  return { true, { 0.33, 0.62 }, { 0, 0.05, 0.1, 10, 50 }, { 42, 43, 64, 65, 128, 129, 256, 257 }, { 50, 70, 95, 145 },
    777 };
}

/// Cases by group: how often the bar holds, and how long it is over the error.
class Judge
{
public:
  explicit Judge(const Keys& keys)
    : cases_(keys, "error-bars-outlines", "cases",
        "group,case,lumen,axis,size,truth,value,error,bar,lattice,picture,sealed,width")
  {
  }

  /// @param width of lumens or walls in a picture's pixels; 0 without a picture
  void take(const std::string& group, const std::string& name, double lumen, int size, double truth,
    const ContourAnswer& a, double width = 0)
  {
    const double error = std::abs(a.value / truth - 1);
    cases_.line(group, name, lumen, a.axis, size, truth, a.value, error, a.error, a.latticeError, a.pictureError,
      a.sealed, width);
    if (groups_.find(group) == groups_.end())
      order_.push_back(group);
    groups_[group].push_back({ error, a.error, error <= a.latticeError });
  }
  void refused(const std::string& group) { ++refused_[group]; }

  void print(const Keys& keys)
  {
    Table table(keys, "error-bars-outlines", "table",
      "group,cases,held,share,lattice_alone,median_bar_over_error,median_bar,worst_error_over_bar,no_bar");
    fmt::print("| group | cases | held | | the lattice's alone | median bar/error | median bar | worst error/bar |\n"
               "|---|---|---|---|---|---|---|---|\n");
    std::vector<Case> all;
    for (const std::string& group : order_)
    {
      line(table, group, groups_[group]);
      all.insert(all.end(), groups_[group].begin(), groups_[group].end());
    }
    line(table, "all", all);
  }

private:
  struct Case
  {
    double error = 0;
    double bar = 0;
    bool byLattice = false;
  };

  static double median(std::vector<double> values)
  {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
  }

  void line(Table& table, const std::string& group, const std::vector<Case>& cases)
  {
    std::int64_t held = 0;
    std::int64_t byLattice = 0;
    std::int64_t unknown = refused_[group];
    std::vector<double> ratio;
    std::vector<double> bars;
    double worst = 0;
    for (const Case& c : cases)
    {
      byLattice += c.byLattice ? 1 : 0;
      if (!std::isfinite(c.bar))
      {
        ++unknown;
        continue;
      }
      held += c.error <= c.bar ? 1 : 0;
      ratio.push_back(c.bar / std::max(c.error, 1e-8));
      bars.push_back(c.bar);
      worst = std::max(worst, c.error / c.bar);
    }
    const auto count = static_cast<double>(ratio.size());
    const double share = static_cast<double>(held) / count;
    table.line(group, ratio.size(), held, share, static_cast<double>(byLattice) / count, median(ratio), median(bars),
      worst, unknown);
    fmt::print("| {} | {} | {} | {:.1f} % | {:.1f} % | {:.2f} | {:.2g} % | {:.2f} |{}\n", group, ratio.size(), held,
      100 * share, 100 * static_cast<double>(byLattice) / count, median(ratio), 100 * median(bars), worst,
      unknown > 0 ? fmt::format(" {} without a bar", unknown) : "");
  }

  Table cases_;
  std::vector<std::string> order_;
  std::map<std::string, std::vector<Case>> groups_;
  std::map<std::string, std::int64_t> refused_;
};

std::vector<ContourAnswer> solve(const ContourSet& set, double spacing, double lumen, const std::vector<int>& axes,
  const std::vector<micrograph::CoarserOutlines>& coarser = {}, const ContourSet& moved = {},
  const ContourSet& sealed = {}, double pixel = 0, bool shares = false)
{
  ContourStudyOptions options;
  options.spacing = spacing;
  options.axes = axes;
  options.conductivity = { lumen, 1 };
  options.coarser = coarser;
  options.moved = moved;
  options.sealed = sealed;
  options.pixel = pixel;
  options.shares = shares;
  return lbm::studyContours(set, options, MPI_COMM_SELF);
}

/// Both axes of a set of outlines, from a lattice of so many nodes across.
std::array<double, 2> truthOf(const ContourSet& set, double lumen, int nodes = 400)
{
  const auto answers = solve(set, set.size[0] / nodes, lumen, { 0, 1 });
  return { answers[0].value, answers[1].value };
}

/// Polygons of some corners that stay apart, in a box of some height; some reach out of it.
ContourSet randomPolygons(std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  ContourSet set{ { 1, 0.7 + 0.6 * u(random) }, {} };
  const int corners = 3 + static_cast<int>(9 * u(random));
  std::vector<std::array<double, 3>> disks;
  for (int tries = 0; tries < 4000 && disks.size() < 14; ++tries)
  {
    const std::array<double, 3> disk{ u(random), u(random) * set.size[1], 0.06 + 0.1 * u(random) };
    if (std::any_of(disks.begin(), disks.end(),
          [&](const auto& d) { return std::hypot(d[0] - disk[0], d[1] - disk[1]) < d[2] + disk[2] + 0.02; }))
      continue;
    disks.push_back(disk);
    Contour contour{ {}, true, static_cast<std::int32_t>(disks.size()) };
    const double turn = u(random);
    for (int k = 0; k < corners; ++k)
    {
      const double angle = 2 * std::numbers::pi * (k + 0.8 * u(random) + turn) / corners;
      const double radius = disk[2] * (1 - 0.4 * u(random));
      contour.points.push_back({ disk[0] + radius * std::cos(angle), disk[1] + radius * std::sin(angle) });
    }
    set.contours.push_back(contour);
  }
  return set;
}

struct Plate
{
  ContourSet set;
  double strip = 1; ///< least distance of a disk's edge from the border beside it, within the plate or beyond
};

/// A part of an array of disks, two and a half to four of them across, at some place.
Plate plate(double fraction, bool hexagonal, std::mt19937_64& random)
{
  std::uniform_real_distribution<double> u(0, 1);
  const double distance = 1 / (2.6 + 1.5 * u(random));
  const double row = distance * (hexagonal ? std::sqrt(3.0) / 2 : 1);
  const double radius = std::sqrt(fraction * distance * row / std::numbers::pi);
  const double x0 = u(random);
  const double y0 = u(random);
  Plate made{ { { 1, 0.8 }, {} } };
  ContourSet& set = made.set;
  for (int j = -2; j < 8; ++j)
    for (int i = -2; i < 8; ++i)
    {
      const Point centre{ (i + x0 + (hexagonal && j % 2 != 0 ? 0.5 : 0)) * distance, (j + y0) * row };
      if (std::abs(centre[0] - 0.5) >= 0.5 + radius || std::abs(centre[1] - 0.4) >= 0.4 + radius)
        continue;
      for (const std::size_t axis : { 0U, 1U })
        made.strip =
          std::min({ made.strip, std::abs(centre[axis] - radius), std::abs(set.size[axis] - centre[axis] - radius) });
      Contour disk{ {}, true, static_cast<std::int32_t>(set.contours.size()) + 1 };
      for (int k = 0; k < 400; ++k)
        disk.points.push_back({ centre[0] + radius * std::cos(k * std::numbers::pi / 200),
          centre[1] + radius * std::sin(k * std::numbers::pi / 200) });
      set.contours.push_back(disk);
    }
  return made;
}

generators::SoftwoodOptions earlywood(std::uint64_t seed)
{
  generators::SoftwoodOptions o;
  o.size = { 150, 120, 1 };
  o.seed = seed;
  return o;
}

generators::SoftwoodOptions latewood(std::uint64_t seed)
{
  generators::SoftwoodOptions o = earlywood(seed);
  o.size = { 110, 88, 1 };
  o.ringPosition0 = 0.8;
  o.ringPosition1 = 1;
  o.solidFraction = 0.7;
  return o;
}

generators::HardwoodOptions hardwood(std::uint64_t seed)
{
  generators::HardwoodOptions o;
  o.size = { 150, 120, 1 };
  o.seed = seed;
  return o;
}

struct Named
{
  std::string name;
  ContourSet set;
};

std::vector<Named> tissues(std::uint64_t seed)
{
  return { { "earlywood", generators::softwoodTruth(earlywood(seed)).lumens },
    { "latewood", generators::softwoodTruth(latewood(seed)).lumens },
    { "hardwood", generators::hardwoodTruth(hardwood(seed)).lumens } };
}

void outlines(Judge& judge, const Choice& choice)
{
  for (const bool hexagonal : { false, true })
    for (const double fraction : choice.fractions)
      for (const double lumen : choice.contrasts)
        for (const int size : choice.sizes)
        {
          const ContourSet set = hexagonal ? test::hexagonsOfDisks(fraction, 1) : test::squareOfDisk(fraction, 1);
          const double truth = hexagonal ? test::hexagonalArrayOfDisks(fraction, lumen, 60)
                                         : test::squareArrayOfDisks(fraction, lumen, 60);
          for (const ContourAnswer& a :
            solve(set, 1.0 / size, lumen, hexagonal ? std::vector<int>{ 0, 1 } : std::vector<int>{ 0 }))
            judge.take(hexagonal ? "outlines: hexagonal disks" : "outlines: square disks",
              fmt::format("fraction {}", fraction), lumen, size, truth, a);
        }
  std::vector<Named> sets = tissues(choice.seed);
  for (int k = 0; k < 5; ++k)
    sets.push_back({ "polygons", randomPolygons(choice.seed + static_cast<std::uint64_t>(k)) });
  for (std::size_t i = 0; i < sets.size(); ++i)
    for (const double lumen : { 0.05, 10.0 })
    {
      const auto truth = truthOf(sets[i].set, lumen, 480);
      for (const int size : { choice.unseen ? 49 : 40, choice.unseen ? 70 : 64, choice.unseen ? 125 : 128 })
        for (const ContourAnswer& a : solve(sets[i].set, sets[i].set.size[0] / size, lumen, { 0, 1 }))
          judge.take(i < 3 ? "outlines: tissues" : "outlines: random polygons", sets[i].name, lumen, size,
            truth[static_cast<std::size_t>(a.axis)], a);
    }
}

/// What a picture of it is judged by.
void picture(Judge& judge, const std::string& group, const std::string& name, const PhaseImage& mask,
  std::span<const float> level, const std::map<double, std::array<double, 2>>& truths, double doubt = 0)
{
  try
  {
    const ContourSet set = micrograph::extractContours(mask, 0, level).contours;
    const auto coarser = micrograph::coarserOutlines(mask, 0, level);
    const ContourSet moved = doubt > 0 ? micrograph::movedOutlines(set, doubt * mask.lattice.spacing) : ContourSet{};
    const ContourSet sealed = micrograph::sealedOutlines(set, mask.lattice.spacing);
    for (const auto& [lumen, truth] : truths)
      for (const ContourAnswer& a :
        solve(set, mask.lattice.spacing, lumen, { 0, 1 }, coarser, moved, sealed, mask.lattice.spacing, !level.empty()))
        judge.take(group, name, lumen, static_cast<int>(mask.lattice.size[0]), truth[static_cast<std::size_t>(a.axis)],
          a, micrograph::leastWidth(set) / mask.lattice.spacing);
  }
  catch (const Error& error)
  {
    fmt::print(stderr, "{}, {}: {}\n", group, name, error.what());
    judge.refused(group);
  }
}

/// What the pictures of one geometry are to tell: by centres, by half areas, and by the areas themselves.
void masksOf(Judge& judge, const std::string& kind, const Named& sample,
  const std::map<double, std::array<double, 2>>& truths, int pixels, bool greys)
{
  micrograph::ContourLatticeOptions make;
  make.spacing = sample.set.size[0] / pixels;
  make.lines = 0;
  make.grain = false;
  const micrograph::ContourLattice drawn = micrograph::contourLattice(sample.set, make);
  PhaseImage mask = drawn.image;
  picture(judge, "masks by centres: " + kind, sample.name, mask, {}, truths);
  for (std::size_t i = 0; i < mask.phase.size(); ++i)
    mask.phase[i] = drawn.lumenShare[i] >= 0.5F ? 0 : 1;
  picture(judge, "masks by half areas: " + kind, sample.name, mask, {}, truths);
  if (!greys)
    return;
  const std::vector<float> level = micrograph::levelOfShares(mask.lattice, drawn.lumenShare);
  for (std::size_t i = 0; i < mask.phase.size(); ++i)
    mask.phase[i] = level[i] > 0 ? 0 : 1;
  picture(judge, "areas as greys: " + kind, sample.name, mask, level, truths);
}

void masks(Judge& judge, const Choice& choice)
{
  std::mt19937_64 random(choice.seed);
  // Values of one plate are not independent: many plates, each with one contrast.
  for (int k = 0; k < choice.plates; ++k)
    for (const bool hexagonal : { false, true })
      for (const double fraction : choice.fractions)
      {
        const Plate made = plate(fraction, hexagonal, random);
        const auto turn = static_cast<std::size_t>(k);
        const double lumen = choice.contrasts[turn % choice.contrasts.size()];
        const std::map<double, std::array<double, 2>> truths{ { lumen, truthOf(made.set, lumen) } };
        for (const std::size_t i : { turn % choice.pixels.size(), (turn + 2) % choice.pixels.size() })
        {
          const int pixels = choice.pixels[i];
          const bool strip = made.strip < 0.5 / pixels;
          const std::string kind = strip ? "disks that end within half a pixel of the border"
                                         : (hexagonal ? "hexagonal disks" : "square disks");
          masksOf(judge, kind, { fmt::format("fraction {} plate {}", fraction, k), made.set }, truths, pixels, true);
        }
      }
  for (std::uint64_t seed = choice.seed + 20; seed < choice.seed + 20 + choice.tissues; ++seed)
    for (const Named& sample : tissues(seed))
    {
      std::map<double, std::array<double, 2>> truths;
      for (const double lumen : choice.contrasts)
        truths[lumen] = truthOf(sample.set, lumen);
      for (std::size_t i = 0; i < choice.pixels.size(); ++i)
        masksOf(judge, "tissues", { fmt::format("{} seed {}", sample.name, seed), sample.set }, truths,
          choice.pixels[i], i % 2 == 1);
    }
}

void scans(Judge& judge, const Choice& choice)
{
  constexpr int n = 4; // nodes of the truth along a pixel
  for (std::uint64_t seed = choice.seed + 40; seed < choice.seed + 42; ++seed)
    for (const bool hard : { false, true })
      for (const double pixel : { 0.5e-6, 1e-6 })
      {
        generators::SoftwoodOptions soft = earlywood(seed);
        generators::HardwoodOptions other = hardwood(seed);
        soft.spacing = other.spacing = pixel / n;
        const auto along = [&](double metres) { return static_cast<std::int64_t>(std::lround(metres / pixel)) * n; };
        soft.size = other.size = { along(160e-6), along(120e-6), 1 };
        const PhaseImage image = hard ? generators::hardwood(other) : generators::softwood(soft);
        const ContourSet set = hard ? generators::hardwoodTruth(other).lumens : generators::softwoodTruth(soft).lumens;
        std::map<double, std::array<double, 2>> truths;
        for (const double lumen : { 0.05, 10.0 })
          truths[lumen] = truthOf(set, lumen);
        for (const generators::Stain stain :
          { generators::Stain::Magenta, generators::Stain::Blue, generators::Stain::Grey })
        {
          generators::LookOptions look;
          look.stain = stain;
          look.seed = seed;
          const auto parts = micrograph::segment(generators::makeLook(image, n, look));
          picture(judge, fmt::format("scans: pixels of {:g} µm", 1e6 * pixel), hard ? "hardwood" : "softwood",
            parts.image, {}, truths, choice.doubt > 0 ? choice.doubt : parts.report.surfaceDoubt);
        }
      }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      Choice choice = choiceOf(keys);
      choice.doubt = number(keys, "doubt", choice.doubt);
      choice.seed = static_cast<std::uint64_t>(number(keys, "seed", static_cast<double>(choice.seed)));
      choice.plates = static_cast<int>(number(keys, "plates", choice.plates));
      Judge judge(keys);
      const double start = cpu();
      runStudies(keys,
        { { "outlines", [&] { outlines(judge, choice); } }, { "masks", [&] { masks(judge, choice); } },
          { "scans", [&] { scans(judge, choice); } } });
      judge.print(keys);
      fmt::print("\n{:.0f} s of processor time\n", cpu() - start);
    });
}
