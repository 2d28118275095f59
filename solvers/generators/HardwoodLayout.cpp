#include "generators/HardwoodLayout.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::generators
{
namespace
{

// Proportions of poplar.
constexpr double elongation = 1.2;     // of a vessel: radial over tangential diameter
constexpr double overlap = 0.8;        // distance of two vessels that share a wall, over the sum of their radii
constexpr double vesselScatter = 0.16; // of the vessels' diameters
constexpr double rayWidth = 0.62;      // in fibre diameters, as all that follows
constexpr double rayCellLength = 3.6;
constexpr double rayThickness = 0.8;
constexpr double lateThickness = 1.3;
constexpr double vesselThickness = 0.85;
constexpr double narrowFibres = 0.14; // share of the fibres that are cut near their tips
constexpr double defaultScatter = 0.12;
constexpr int relaxations = 3;

double mix(double a, double b, double t)
{
  return a + (b - a) * t;
}

double smoothStep(double t)
{
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double areaOf(std::span<const Corner> polygon)
{
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Corner& from = polygon[i];
    const Corner& to = polygon[(i + 1) % polygon.size()];
    area += from.x * to.y - to.x * from.y;
  }
  return area / 2;
}

} // namespace

/// A generating point of the power diagram. Distances are measured with x shortened by `elongation`.
struct HardwoodLayout::Site
{
  double x = 0;
  double y = 0;
  double weight = 0; ///< squared radius
  double radius = 0; ///< of a vessel; 0: a fibre
};

/// The tissue between two rays.
struct HardwoodLayout::Band
{
  std::int64_t number = 0;
  double low = 0, high = 0;
  std::vector<Site> sites;                      ///< vessels first, by rising x
  std::size_t vessels = 0;                      ///< how many
  std::vector<std::vector<std::uint32_t>> bins; ///< fibres by x, one unit a bin
  double from = 0;                              ///< x of the first bin

  void bin()
  {
    for (auto& list : bins)
    {
      list.clear();
    }
    for (std::size_t i = vessels; i < sites.size(); ++i)
    {
      bins[binOf(sites[i].x)].push_back(static_cast<std::uint32_t>(i));
    }
  }
  [[nodiscard]] std::size_t binOf(double x) const
  {
    return static_cast<std::size_t>(std::clamp(x - from, 0.0, static_cast<double>(bins.size()) - 1));
  }
  /// Calls f(site) for the vessels within `toVessels` along x and the fibres within `toFibres`.
  template <class F>
  void near(double x, double toVessels, double toFibres, F&& f) const
  {
    const auto end = sites.begin() + static_cast<std::ptrdiff_t>(vessels);
    auto v = std::lower_bound(sites.begin(), end, x - toVessels, [](const Site& s, double at) { return s.x < at; });
    for (; v != end && v->x <= x + toVessels; ++v)
    {
      f(static_cast<std::size_t>(v - sites.begin()));
    }
    for (std::size_t b = binOf(x - toFibres); b <= binOf(x + toFibres); ++b)
    {
      for (const std::uint32_t i : bins[b])
      {
        f(static_cast<std::size_t>(i));
      }
    }
  }
  void add(const Site& site)
  {
    bins[binOf(site.x)].push_back(static_cast<std::uint32_t>(sites.size()));
    sites.push_back(site);
  }
};

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
    {
      break;
    }
    const double better = std::clamp(swelling * std::sqrt(wanted / has), 0.9, 1.1);
    if (better == swelling)
    {
      break;
    }
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
  {
    sum += mix(shareEarly_, shareLate_, lateness(width_ * (i + 0.5) / parts));
  }
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
  { return every * (1 + std::min(disorder_, 1.0) * 0.16 * std::clamp(random_.normal(Use::RayPlace, n), -1.6, 1.6)); };
  double y = every * mix(0.25, 0.75, random_.uniform(Use::RayPlace, -1));
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
    return mix(random_.smooth(Use::Warp, 2 * line + field, x / length),
      random_.smooth(Use::Warp, 2 * (line + 1) + field, x / length), blend);
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
  {
    addRay(r);
  }
}

void HardwoodLayout::layVessels(Band& band, double swelling) const
{
  const double room = band.high - band.low;
  const double pitch = rayEvery_ > 0 ? room + 2 * rayHalf_ : room;
  const std::int64_t b = band.number;
  double x = -margin_ * (1 + random_.uniform(Use::VesselPlace, b, -1));
  for (std::int64_t group = 0; x < width_ + margin_; ++group)
  {
    const double late = lateness(x);
    const double wanted = mix(shareEarly_, shareLate_, late);
    if (!(wanted > 0))
    {
      x += 1;
      continue;
    }
    int count = 1;
    if (random_.uniform(Use::VesselGroup, b, group) < multiples_)
    {
      const double u = random_.uniform(Use::VesselGroup, b, group, 1);
      count = u < 0.6 ? 2 : u < 0.88 ? 3 : 4;
    }
    const double usual = mix(vesselEarly_, vesselLate_, late);
    double area = 0;
    double length = 0;
    double before = 0;
    double atY = 0;
    std::vector<Site> vessels;
    for (int k = 0; k < count; ++k)
    {
      const double scatter = vesselScatter * std::min(disorder_, 1.5);
      // The vessels of a file are somewhat narrower than one alone, and its ends the narrowest.
      double radius =
        usual * (count > 1 ? 0.94 : 1.04) * std::max(0.5, 1 + scatter * random_.normal(Use::VesselSize, b, group, k));
      // Between a vessel and a ray there is a whole fibre or nothing: one that all but fills the band touches both
      // rays.
      radius = std::min(radius, 0.5 * room);
      radius = room - 2 * radius < 0.6 ? 0.54 * room : std::min(radius, 0.5 * room - 0.47);
      const double slack = room - 2 * radius;
      if (k == 0)
      {
        const double u = random_.uniform(Use::VesselPlace, b, group);
        const double free = slack < 0 ? 0.5 * slack
          : slack < 2.2               ? (u < 0.5 ? 0.0 : slack)
          : u < 0.3                   ? 0.0
          : u > 0.7                   ? slack
                                      : mix(1, slack - 1, (u - 0.3) / 0.4);
        atY = band.low + radius + free;
        // What touches a ray is pressed flat against it.
        atY += slack < 0 ? 0.0 : free <= 0 ? -0.1 * radius : free >= slack ? 0.1 * radius : 0.0;
      }
      else
      {
        atY += 0.16 * radius * random_.normal(Use::VesselPlace, b, group, k);
        atY = std::clamp(atY, band.low + 0.9 * radius, band.high - 0.9 * radius);
      }
      const double step = k == 0 ? elongation * radius : overlap * elongation * (before + radius);
      length += step;
      vessels.push_back({ x + length, atY, radius * radius, radius });
      area += 3.14159265358979 * elongation * radius * radius * (k == 0 ? 1.0 : 0.93);
      before = radius;
    }
    length += elongation * before;
    if (x + length > -margin_)
    {
      for (Site& vessel : vessels)
      {
        vessel.radius *= swelling;
        vessel.weight = vessel.radius * vessel.radius;
        band.sites.push_back(vessel);
      }
    }
    // A gap that brings the share to what is wanted: one fibre at least, and the rest by chance, its mean kept.
    const double mean = area / (wanted * pitch) - length;
    const double u = random_.uniform(Use::VesselGap, b, group);
    x += length + (mean > 1.3 ? 1.3 + (mean - 1.3) * (0.3 + 2.1 * u * u) : std::max(1.3, mean));
  }
  band.vessels = band.sites.size();
  band.bin();
}

void HardwoodLayout::layFibres(Band& band) const
{
  const std::int64_t b = band.number;
  const double widest = 1.1 * 1.6 * std::max(vesselEarly_, vesselLate_) * elongation;
  // Free of vessels by `toVessel` beyond their rim and of fibres by `toFibre`.
  const auto isFree = [&](double x, double y, double toVessel, double toFibre)
  {
    bool free = true;
    band.near(x, widest + 2, 1,
      [&](std::size_t i)
      {
        const Site& other = band.sites[i];
        const double dy = other.y - y;
        if (other.radius > 0)
        {
          const double dx = (other.x - x) / elongation;
          const double limit = other.radius + toVessel;
          free = free && dx * dx + dy * dy >= limit * limit;
        }
        else
        {
          const double dx = other.x - x;
          free = free && dx * dx + dy * dy >= toFibre * toFibre;
        }
      });
    return free;
  };
  std::int64_t number = 0;
  const auto add = [&](double x, double y)
  {
    const bool narrow = random_.uniform(Use::FibreSize, b, number) < narrowFibres * std::min(disorder_, 1.0);
    const double radius = narrow
      ? mix(0.1, 0.3, random_.uniform(Use::FibreSize, b, number, 1))
      : 0.5 * std::max(0.5, 1 + 1.6 * scatter_ * random_.normal(Use::FibreSize, b, number, 2));
    ++number;
    band.add({ x, y, radius * radius, 0 });
  };

  // A ring of fibres around every vessel.
  for (std::size_t v = 0; v < band.vessels; ++v)
  {
    const Site vessel = band.sites[v];
    const double distance = vessel.radius + 0.47;
    const double around = 3.14159265358979 * distance * (1 + elongation);
    const auto count = static_cast<std::int64_t>(around / 1.0);
    const auto id = static_cast<std::int64_t>(v);
    const double turn = random_.uniform(Use::FibreRing, b, id);
    for (std::int64_t i = 0; i < count; ++i)
    {
      const double shake = 0.22 * disorder_ * random_.normal(Use::FibreRing, b, id, i);
      const auto [c, s] =
        onCircle(turn + (static_cast<double>(i) + std::clamp(shake, -0.3, 0.3)) / static_cast<double>(count));
      const double x = vessel.x + elongation * distance * c;
      const double y = vessel.y + distance * s;
      if (y > band.low + 0.42 && y < band.high - 0.42 && isFree(x, y, 0.4, 0.7))
      {
        add(x, y);
      }
    }
  }
  // Files of fibres along x where there is room.
  const double room = band.high - band.low;
  const auto files = std::max<std::int64_t>(1, std::llround(room / 0.98));
  const double file = room / static_cast<double>(files);
  for (std::int64_t f = 0; f < files; ++f)
  {
    double x = -margin_ + random_.uniform(Use::FileOffset, b, f);
    for (std::int64_t j = 0; x < width_ + margin_; ++j)
    {
      const double y =
        band.low + file * (static_cast<double>(f) + 0.5 + 0.12 * disorder_ * random_.normal(Use::FibrePlace, b, f, j));
      if (isFree(x, y, 0.55, 0.74))
      {
        add(x, y);
      }
      const double position = mix(ring0_, ring1_, x / width_);
      const double flat = mix(1, 0.68, smoothStep((position - 0.85) / 0.15)); // the last cells of a ring are flat
      x += flat * std::max(0.6, 1 + 1.2 * scatter_ * random_.normal(Use::FibrePlace, b, f, 100000 + j));
    }
  }
  // What is left open, on a fine grid.
  const auto rows = static_cast<std::int64_t>(4 * room);
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(4 * (width_ + 2 * margin_)); ++i)
  {
    for (std::int64_t k = 0; k < rows; ++k)
    {
      const double x = -margin_ + 0.25 * static_cast<double>(i);
      const double y = band.low + (static_cast<double>(k) + 0.5) * room / static_cast<double>(rows);
      if (y > band.low + 0.42 && y < band.high - 0.42 && isFree(x, y, 0.42, 0.86))
      {
        add(x, y);
      }
    }
  }
}

void HardwoodLayout::polygonOf(
  const Band& band, std::size_t i, std::vector<Corner>& polygon, std::vector<Corner>& spare) const
{
  const Site& site = band.sites[i];
  const double widest = 1.8 * std::max(vesselEarly_, vesselLate_);
  const double toFibres = site.radius > 0 ? site.radius + 2.5 : 2.5;
  const double own = site.radius > 0 ? 1.5 * site.radius + 2 : 2.5;
  polygon = { { site.x - elongation * own, band.low, -1 }, { site.x + elongation * own, band.low, -1 },
    { site.x + elongation * own, band.high, -1 }, { site.x - elongation * own, band.high, -1 } };
  constexpr double metric = 1 / (elongation * elongation);
  band.near(site.x, elongation * (widest + toFibres), elongation * toFibres,
    [&](std::size_t k)
    {
      if (k == i || polygon.empty())
      {
        return;
      }
      // Nearer to this site in power: |p − s|² − w ≤ |p − o|² − v.
      const Site& other = band.sites[k];
      const double c = (metric * other.x * other.x + other.y * other.y - other.weight) -
        (metric * site.x * site.x + site.y * site.y - site.weight);
      clip(polygon, spare, 2 * metric * (site.x - other.x), 2 * (site.y - other.y), c, -1);
    });
}

void HardwoodLayout::relax(Band& band) const
{
  std::vector<Corner> polygon;
  std::vector<Corner> spare;
  std::vector<Site> moved;
  for (int round = 0; round < relaxations; ++round)
  {
    moved = band.sites;
    for (std::size_t i = band.vessels; i < band.sites.size(); ++i)
    {
      polygonOf(band, i, polygon, spare);
      const double area = polygon.size() < 3 ? 0 : areaOf(polygon);
      if (area > 0.02)
      {
        double x = 0;
        double y = 0;
        for (std::size_t k = 0; k < polygon.size(); ++k)
        {
          const Corner& from = polygon[k];
          const Corner& to = polygon[(k + 1) % polygon.size()];
          const double cross = from.x * to.y - to.x * from.y;
          x += (from.x + to.x) * cross;
          y += (from.y + to.y) * cross;
        }
        moved[i].x = mix(moved[i].x, x / (6 * area), 0.6);
        moved[i].y = mix(moved[i].y, y / (6 * area), 0.6);
      }
    }
    band.sites.swap(moved);
    band.bin();
  }
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
  double from = -margin_ - rayCellLength * random_.uniform(Use::RayCell, id, -1);
  for (std::int64_t j = 0; from < width_ + margin_; ++j)
  {
    const double length = rayCellLength * std::max(0.45, 1 + 2 * scatter_ * random_.normal(Use::RayCell, id, j));
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
  cell.xMin = cell.xMax = corners[0].x;
  cell.yMin = cell.yMax = corners[0].y;
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Corner& from = corners[i];
    const Corner& to = corners[(i + 1) % corners.size()];
    sides_.push_back(sideBetween(from, to));
    cell.xMin = std::min(cell.xMin, from.x);
    cell.xMax = std::max(cell.xMax, from.x);
    cell.yMin = std::min(cell.yMin, from.y);
    cell.yMax = std::max(cell.yMax, from.y);
    const double cross = from.x * to.y - to.x * from.y;
    area += cross;
    cell.centreX += (from.x + to.x) * cross;
    cell.centreY += (from.y + to.y) * cross;
  }
  cell.centreX /= 3 * area;
  cell.centreY /= 3 * area;
  std::vector<double> distances;
  for (const CellSide& side : sides(cell))
  {
    distances.push_back(side.distance(cell.centreX, cell.centreY));
  }
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
