#include "generators/HardwoodBand.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::generators
{
HardwoodLayout::HardwoodLayout(const HardwoodOptions& options)
  : random_(options.seed)
  , width_(static_cast<double>(options.size[0]) * options.spacing / options.fibreDiameter)
  , height_(static_cast<double>(options.size[1]) * options.spacing / options.fibreDiameter)
  , vesselEarly_(options.vesselDiameterEarly / options.fibreDiameter / 2)
  , vesselLate_(options.vesselDiameterLate / options.fibreDiameter / 2)
  , shareEarly_(options.vesselShareEarly)
  , shareLate_(options.vesselShareLate)
  , earlyEnd_(options.earlyEnd)
  , multiples_(options.multiples)
  , ring0_(options.ringPosition0)
  , ring1_(options.ringPosition1)
  , rayEvery_(options.rayEvery / options.fibreDiameter)
  , rayHalf_(rayWidth / 2)
  , scatter_(options.scatter)
  , disorder_(options.scatter / defaultScatter)
  , margin_(4 + 4 * std::max(vesselEarly_, vesselLate_))
{
  layRayLines();
  // The vessels that chance put into the box swell or shrink a little towards the share asked for.
  double swelling = 1;
  lay(swelling);
  for (int round = 0; round < 4; ++round)
  {
    const double has = vesselShare();
    const double wanted = shareWanted();
    if (!(has > 0) || std::abs(has - wanted) < 0.002)
      break;
    const double better = std::clamp(swelling * std::sqrt(wanted / has), 0.9, 1.1);
    if (better == swelling)
      break;
    swelling = better;
    lay(swelling);
  }
}

double HardwoodLayout::lateness(double x) const noexcept
{
  const double position = std::clamp(mix(ring0_, ring1_, x / width_), 0.0, 1.0);
  return smoothStep((position - earlyEnd_) / 0.3 + 0.5);
}

double HardwoodLayout::shareWanted() const noexcept
{
  double sum = 0;
  constexpr int parts = 64;
  for (int i = 0; i < parts; ++i)
    sum += mix(shareEarly_, shareLate_, lateness(width_ * (i + 0.5) / parts));
  return sum / parts;
}

double HardwoodLayout::vesselShare() const
{
  double area = 0;
  std::vector<Corner> polygon;
  std::vector<Corner> spare;
  for (const ConvexCell& cell : cells_)
  {
    if (cell.kind == CellKind::Vessel)
    {
      const auto all = corners(cell);
      polygon.assign(all.begin(), all.end());
      clip(polygon, spare, 1, 0, 0, 0);
      clip(polygon, spare, -1, 0, width_, 0);
      clip(polygon, spare, 0, 1, 0, 0);
      clip(polygon, spare, 0, -1, height_, 0);
      area += areaOf(polygon);
    }
  }
  return area / (width_ * height_);
}

void HardwoodLayout::layRayLines()
{
  // Without rays the lines still stand, nowhere seen: they divide the work.
  const double every = rayEvery_ > 0 ? rayEvery_ : 4 * std::max(vesselEarly_, vesselLate_) + 6;
  const auto gap = [&](std::int64_t n)
  {
    return every *
      (1 + std::min(disorder_, 1.0) * 0.16 * std::clamp(random_.normal(RandomUse::RayPlace, n), -1.6, 1.6));
  };
  double y = every * mix(0.25, 0.75, random_.uniform(RandomUse::RayPlace, -1));
  rayLines_ = { y - gap(-2) - gap(0), y - gap(0), y };
  for (std::int64_t n = 1; y < height_ + 3; ++n)
  {
    y += gap(n);
    rayLines_.push_back(y);
  }
}

std::array<double, 2> HardwoodLayout::warped(double x, double y) const noexcept
{
  // Slow bending, the same for all that shares a corner: cells stay closed.
  constexpr double length = 26;
  const double row = y / length;
  const double whole = std::floor(row);
  const double blend = smoothStep(row - whole);
  const auto line = static_cast<std::int64_t>(whole);
  const auto noise = [&](std::int64_t field)
  {
    return mix(random_.smooth(RandomUse::Warp, 2 * line + field, x / length),
      random_.smooth(RandomUse::Warp, 2 * (line + 1) + field, x / length), blend);
  };
  const double amplitude = std::min(disorder_, 1.5) * 0.7;
  return { x + amplitude * noise(0), y + amplitude * noise(1) };
}

void HardwoodLayout::lay(double swelling)
{
  cells_.clear();
  corners_.clear();
  sides_.clear();
  for (std::size_t b = 0; b + 1 < rayLines_.size(); ++b)
  {
    Band band;
    band.number = static_cast<std::int64_t>(b);
    const double half = rayEvery_ > 0 ? rayHalf_ : 0.0;
    band.low = rayLines_[b] + half;
    band.high = rayLines_[b + 1] - half;
    band.from = -margin_ - 2;
    band.bins.resize(static_cast<std::size_t>(width_ + 2 * margin_ + 6));
    layVessels(band, swelling);
    layFibres(band);
    relax(band);
    addBand(band);
  }
  for (std::size_t r = 0; rayEvery_ > 0 && r < rayLines_.size(); ++r)
    addRay(r);
}

void HardwoodLayout::addBand(Band& band)
{
  std::vector<Corner> polygon;
  std::vector<Corner> spare;
  for (std::size_t i = 0; i < band.sites.size(); ++i)
  {
    const Site& site = band.sites[i];
    polygonOf(band, i, polygon, spare);
    if (polygon.size() >= 3 && areaOf(polygon) > 0.01)
    {
      const double thickness = mix(1.0, lateThickness, lateness(site.x)) * (site.radius > 0 ? vesselThickness : 1.0);
      addCell(site.radius > 0 ? CellKind::Vessel : CellKind::Fibre, polygon, thickness);
    }
  }
}

void HardwoodLayout::addRay(std::size_t number)
{
  const double y = rayLines_[number];
  const auto id = static_cast<std::int64_t>(number);
  double from = -margin_ - rayCellLength * random_.uniform(RandomUse::RayCell, id, -1);
  for (std::int64_t j = 0; from < width_ + margin_; ++j)
  {
    const double length = rayCellLength * std::max(0.45, 1 + 2 * scatter_ * random_.normal(RandomUse::RayCell, id, j));
    const double to = from + length;
    const std::array<Corner, 4> box{ Corner{ from, y - rayHalf_ }, Corner{ to, y - rayHalf_ },
      Corner{ to, y + rayHalf_ }, Corner{ from, y + rayHalf_ } };
    addCell(CellKind::Ray, box, rayThickness * mix(1.0, lateThickness, lateness(from)));
    from = to;
  }
}

void HardwoodLayout::addCell(CellKind kind, std::span<const Corner> polygon, double thickness)
{
  std::vector<Corner> corners;
  for (const Corner& corner : polygon)
  {
    const auto [x, y] = warped(corner.x, corner.y);
    corners.push_back({ x, y, corner.side });
  }
  dropShortSides(corners, 0.03);

  ConvexCell cell;
  cell.kind = kind;
  cell.first = static_cast<std::uint32_t>(sides_.size());
  cell.count = static_cast<std::uint32_t>(corners.size());
  static_cast<PolygonPlace&>(cell) = placeOf(corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Corner& from = corners[i];
    const Corner& to = corners[(i + 1) % corners.size()];
    sides_.push_back(sideBetween(from, to));
  }
  std::vector<double> distances;
  for (const CellSide& side : sides(cell))
    distances.push_back(side.distance(cell.centreX, cell.centreY));
  const double inner = *std::min_element(distances.begin(), distances.end());
  if (!(inner > 0) || cell.xMax < 0 || cell.yMax < 0 || cell.xMin > width_ || cell.yMin > height_)
  {
    sides_.resize(cell.first);
    corners_.resize(cell.first);
    return;
  }
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  cell.fillet = kind == CellKind::Vessel ? 0.35 : 0.4 * inner;
  cell.depth = wallDepth(distances, cell.fillet);
  // A cell much smaller than its neighbours has a somewhat thinner wall too, or the tips of fibres had no lumen.
  cell.thickness = thickness * std::sqrt(std::clamp(cell.depth / (kind == CellKind::Ray ? rayHalf_ : 0.42), 0.25, 1.0));
  cells_.push_back(cell);
}

} // namespace lamella::generators
