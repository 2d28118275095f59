#include "generators/SoftwoodLayout.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::generators
{

// A Corner's side: −1 a tracheid beyond, 2 b the ray line b seen from above, 2 b + 1 seen from below.

/// A generating point of the power diagram, in stretched coordinates.
struct SoftwoodLayout::Site
{
  double x = 0;
  double y = 0;      ///< times stretch_
  double weight = 0; ///< squared radius
  std::int64_t file = 0;
  std::int64_t number = 0;
};

namespace
{

// Proportions of Norway spruce, from the pictures that the tests look at: walls of latewood against earlywood, rays,
// tips.
constexpr double lateThickness = 2.3;
constexpr double rayWidth = 0.36;    // of a tangential diameter
constexpr double narrowFiles = 0.12; // share of the files that are cut near the tips of their tracheids
constexpr double tipShare = 0.035;   // tips of tracheids from other planes, per cell
constexpr double earlyFillet = 0.28; // corner radius over half the smaller diameter
constexpr double lateFillet = 0.5;
constexpr double defaultScatter = 0.12;
// A cell reaches half-way to the sites before and after it, whose places are correlated by 0.6 from one to the next:
// the standard deviation of its length is √(2 (1 − 0.6²))/2 of theirs.
constexpr double siteScatter = 1.77;

} // namespace

SoftwoodLayout::SoftwoodLayout(const SoftwoodOptions& options)
  : random_(options.seed)
  , width_(static_cast<double>(options.size[0]))
  , height_(static_cast<double>(options.size[1]))
  , tangential_(options.tangentialDiameter / options.spacing)
  , early_(options.radialDiameterEarly / options.spacing)
  , late_(options.radialDiameterLate / options.spacing)
  , ring0_(options.ringPosition0)
  , ring1_(options.ringPosition1)
  , rayEvery_(options.rayEvery / options.spacing)
  , rayHalfWidth_(rayWidth * tangential_ / 2)
  , scatter_(options.scatter)
  , disorder_(options.scatter / defaultScatter)
{
  // Flat ends where cells are long radially, pointed ones where they are flattened: as in the pictures.
  const double mean = (lateness(0) + lateness(width_ / 2) + lateness(width_)) / 3;
  stretch_ = std::sqrt(mix(1.3, 0.5, mean));
  layColumns();
  layRays();
  layFiles();
}

double SoftwoodLayout::lateness(double x) const noexcept
{
  const double position = std::clamp(mix(ring0_, ring1_, x / width_), 0.0, 1.0);
  const double t = std::clamp((position - 0.25) / 0.7, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double SoftwoodLayout::thickness(double x) const noexcept
{
  return mix(1.0, lateThickness, lateness(x));
}

double SoftwoodLayout::radialDiameter(double x) const noexcept
{
  return mix(early_, late_, lateness(x));
}

void SoftwoodLayout::layColumns()
{
  const double margin = 3 * std::max(early_, late_);
  for (double x = -margin; x < width_ + margin;)
  {
    columns_.push_back(x);
    x += radialDiameter(x + radialDiameter(x) / 2);
  }
}

double SoftwoodLayout::columnAt(double number) const noexcept
{
  const double last = static_cast<double>(columns_.size() - 2);
  const double whole = std::floor(std::clamp(number, 0.0, last));
  const auto index = static_cast<std::size_t>(whole);
  return mix(columns_[index], columns_[index + 1], number - whole);
}

std::vector<double> SoftwoodLayout::crossWalls(double step, std::int64_t salt) const
{
  std::vector<double> walls;
  double number = -step * random_.uniform(RandomUse::RayCell, salt, -1);
  for (std::int64_t j = 0; number < static_cast<double>(columns_.size()); ++j)
  {
    walls.push_back(columnAt(number));
    number += step * std::max(0.4, 1 + 2 * scatter_ * random_.normal(RandomUse::RayCell, salt, j));
  }
  return walls;
}

void SoftwoodLayout::layRays()
{
  const double margin = 3 * tangential_;
  if (rayEvery_ <= 0)
  {
    rayLines_ = { -margin, height_ + margin };
    return;
  }
  const auto gap = [&](std::int64_t n)
  {
    return rayEvery_ *
      (1 + std::min(disorder_, 1.0) * 0.2 * std::clamp(random_.normal(RandomUse::RayPlace, n), -2.0, 2.0));
  };
  // The first ray inside always falls within three quarters of the mean distance, so that small pictures have one.
  double y = rayEvery_ * mix(0.25, 0.75, random_.uniform(RandomUse::RayPlace, -1));
  rayLines_ = { y - gap(0), y };
  // One that reaches into the box has tracheids below it too; there is the next one.
  if (rayLines_.front() > -(rayHalfWidth_ + tangential_ / 2))
    rayLines_.insert(rayLines_.begin(), rayLines_.front() - gap(-2));
  for (std::int64_t n = 1; y < height_ + margin; ++n)
  {
    y += gap(n);
    rayLines_.push_back(y);
  }
}

std::array<double, 2> SoftwoodLayout::warped(double x, double y) const noexcept
{
  // Slow bending of files and growth layers, the same for all that shares a corner: cells stay closed.
  const double length = 12 * tangential_;
  const double row = y / length;
  const double whole = std::floor(row);
  const double part = row - whole;
  const double blend = part * part * (3 - 2 * part);
  const auto line = static_cast<std::int64_t>(whole);
  const auto noise = [&](std::int64_t field)
  {
    return mix(random_.smooth(RandomUse::Warp, 2 * line + field, x / length),
      random_.smooth(RandomUse::Warp, 2 * (line + 1) + field, x / length), blend);
  };
  const double amplitude = std::min(disorder_, 1.5) * 0.22;
  return { x + amplitude * radialDiameter(x) * noise(0), y + amplitude * tangential_ * noise(1) };
}

void SoftwoodLayout::layFiles()
{
  const double narrowShare = narrowFiles * std::min(disorder_, 1.0);
  std::vector<Site> sites;
  for (std::size_t band = 0; band + 1 < rayLines_.size(); ++band)
  {
    const auto b = static_cast<std::int64_t>(band);
    const double room = rayLines_[band + 1] - rayLines_[band] - 2 * rayHalfWidth_;
    const auto files = std::max<std::int64_t>(1, std::llround(room / (tangential_ * (1 - 0.4 * narrowShare))));
    std::vector<double> widths(static_cast<std::size_t>(files));
    double sum = 0;
    for (std::int64_t f = 0; f < files; ++f)
    {
      double share = std::max(0.5, 1 + 1.2 * scatter_ * random_.normal(RandomUse::FileWidth, b, f));
      if (random_.uniform(RandomUse::FileWidth, b, f, 1) < narrowShare)
        share *= mix(0.5, 0.7, random_.uniform(RandomUse::FileWidth, b, f, 2));
      widths[static_cast<std::size_t>(f)] = share;
      sum += share;
    }

    sites.clear();
    double low = rayLines_[band] + rayHalfWidth_;
    for (std::int64_t f = 0; f < files; ++f)
    {
      const double w = widths[static_cast<std::size_t>(f)] * room / sum;
      const std::int64_t file = 4096 * b + f;
      // Neighbouring files are offset by half a cell, loosely: the offset drifts along the file.
      const double offset =
        0.5 * static_cast<double>(f % 2) + 0.1 * disorder_ * random_.normal(RandomUse::FileOffset, b, f);
      double error = siteScatter * scatter_ * random_.normal(RandomUse::CellPlace, file, -1);
      double previous = -1;
      for (std::int64_t j = 0; j + 1 < static_cast<std::int64_t>(columns_.size()); ++j)
      {
        // A first-order autoregression: lengths scatter as asked for, yet the file keeps in step with its neighbours.
        error = 0.6 * error + 0.8 * siteScatter * scatter_ * random_.normal(RandomUse::CellPlace, file, j);
        const double drift =
          0.22 * std::min(disorder_, 1.5) * random_.smooth(RandomUse::FileDrift, file, static_cast<double>(j) / 7);
        const double number = std::max(previous + 0.45, static_cast<double>(j) + offset + error + drift);
        previous = number;
        const double shift = 0.045 * std::min(disorder_, 1.5) * random_.normal(RandomUse::CellShift, file, j) *
          std::min(1.0, radialDiameter(columnAt(number)) / (tangential_ * stretch_));
        // Equal weights along a file put its walls half-way; across files they put the wall on the files' border.
        sites.push_back(
          { columnAt(number), stretch_ * (low + w * (0.5 + shift)), stretch_ * stretch_ * w * w / 4, file, j });
      }
      low += w;
    }
    layTips(sites, b);
    cutPolygons(sites, band);
  }
}

void SoftwoodLayout::layTips(std::vector<Site>& sites, std::int64_t band)
{
  const std::size_t perFile = columns_.size() - 1;
  const std::size_t whole = sites.size();
  for (std::size_t i = 0; i + perFile < whole; ++i) // the last file has a ray beyond it
  {
    const Site& site = sites[i];
    const Site& next = sites[i + 1];
    if (next.file != site.file ||
      random_.uniform(RandomUse::TipPlace, site.file, site.number) >= tipShare * std::min(disorder_, 1.0))
      continue;
    // At the corner where this file's cross wall meets the next file.
    const double x = (site.x + next.x) / 2;
    const double y = site.y + std::sqrt(site.weight);
    double power = std::numeric_limits<double>::max();
    const std::size_t fileStart = i / perFile * perFile;
    for (std::size_t k = fileStart; k < fileStart + 2 * perFile; ++k)
    {
      const double dx = sites[k].x - x;
      const double dy = sites[k].y - y;
      power = std::min(power, dx * dx + dy * dy - sites[k].weight);
    }
    const double size = mix(0.4, 0.7, random_.uniform(RandomUse::TipSize, site.file, site.number)) *
      std::sqrt(radialDiameter(x) * tangential_) / 2;
    const std::int64_t file = 4096 * band + 2048 + site.file % 2048;
    const std::int64_t number = site.number;
    sites.push_back({ x, y, size * size - power, file, number });
  }
}

void SoftwoodLayout::cutPolygons(std::span<const Site> sites, std::size_t band)
{
  const bool rays = rayEvery_ > 0;
  const double low = rayLines_[band] * stretch_;
  const double high = rayLines_[band + 1] * stretch_;
  const double reach = 2.6 * std::max({ early_, late_, tangential_ * stretch_ });
  std::vector<std::size_t> byX(sites.size());
  for (std::size_t i = 0; i < byX.size(); ++i)
    byX[i] = i;
  std::sort(byX.begin(), byX.end(),
    [&](std::size_t a, std::size_t b) { return sites[a].x != sites[b].x ? sites[a].x < sites[b].x : a < b; });

  std::vector<Corner> polygon;
  std::vector<Corner> spare;
  std::size_t first = 0;
  for (const std::size_t i : byX)
  {
    const Site& site = sites[i];
    const int sideLow = rays ? static_cast<int>(2 * band) : -1;
    const int sideHigh = rays ? static_cast<int>(2 * (band + 1) + 1) : -1;
    polygon = { { site.x - reach, low, sideLow }, { site.x + reach, low, -1 }, { site.x + reach, high, sideHigh },
      { site.x - reach, high, -1 } };
    while (sites[byX[first]].x < site.x - reach)
      ++first;
    for (std::size_t k = first; k < byX.size() && sites[byX[k]].x <= site.x + reach && !polygon.empty(); ++k)
    {
      const Site& other = sites[byX[k]];
      if (byX[k] == i || std::abs(other.y - site.y) > 2 * reach)
        continue;
      // Nearer to this site in power: |p − s|² − w ≤ |p − o|² − v.
      const double c =
        (other.x * other.x + other.y * other.y - other.weight) - (site.x * site.x + site.y * site.y - site.weight);
      clip(polygon, spare, 2 * (site.x - other.x), 2 * (site.y - other.y), c, -1);
    }
    if (polygon.size() >= 3)
      addCell(site, polygon);
  }
}

void SoftwoodLayout::addCell(const Site& site, std::span<const Corner> polygon)
{
  const double smallest = 0.02 * tangential_;
  std::vector<Corner> corners;
  for (const Corner& corner : polygon)
  {
    const auto [x, y] = warped(corner.x, corner.y / stretch_);
    corners.push_back({ x, y, corner.side });
  }
  dropShortSides(corners, smallest);

  CellShape cell;
  cell.file = site.file;
  cell.number = site.number;
  cell.firstSide = static_cast<std::uint32_t>(sides_.size());
  cell.sides = static_cast<std::uint32_t>(corners.size());
  static_cast<PolygonPlace&>(cell) = placeOf(corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Corner& from = corners[i];
    const Corner& to = corners[(i + 1) % corners.size()];
    CellSide side = sideBetween(from, to); // corners run counter-clockwise
    if (from.side >= 0)
    {
      side.ray = from.side / 2;
      side.rayBelow = from.side % 2 == 0;
    }
    sides_.push_back(side);
  }

  const double late = lateness(cell.centreX);
  std::vector<double> distances;
  for (const CellSide& side : sides(cell))
    distances.push_back(side.distance(cell.centreX, cell.centreY) - (side.ray >= 0 ? rayHalfWidth_ : 0.0));
  const double inner = *std::min_element(distances.begin(), distances.end());
  if (!(inner > 0) || cell.xMax < -1 || cell.yMax < -1 || cell.xMin > width_ + 1 || cell.yMin > height_ + 1)
  {
    sides_.resize(cell.firstSide);
    return;
  }
  cell.fillet = mix(earlyFillet, lateFillet, late) * inner;
  cell.depth = wallDepth(distances, cell.fillet);
  // A cell much smaller than its neighbours has a somewhat thinner wall too, or the tips of tracheids had no lumen.
  const double usual = 0.42 * std::min(radialDiameter(cell.centreX), tangential_);
  cell.thickness = mix(1.0, lateThickness, late) * std::sqrt(std::clamp(cell.depth / usual, 0.25, 1.0));
  cells_.push_back(cell);
}

} // namespace lamella::generators
