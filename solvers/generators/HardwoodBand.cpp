#include "generators/HardwoodBand.h"

#include <cmath>
#include <limits>

namespace lamella::generators
{

void HardwoodLayout::layVessels(Band& band, double swelling) const
{
  const double room = band.high - band.low;
  const double pitch = rayEvery_ > 0 ? room + 2 * rayHalf_ : room;
  const std::int64_t b = band.number;
  double x = -margin_ * (1 + random_.uniform(RandomUse::VesselPlace, b, -1));
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
    if (random_.uniform(RandomUse::VesselGroup, b, group) < multiples_)
    {
      const double u = random_.uniform(RandomUse::VesselGroup, b, group, 1);
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
      double radius = usual * (count > 1 ? 0.94 : 1.04) *
        std::max(0.5, 1 + scatter * random_.normal(RandomUse::VesselSize, b, group, k));
      // Between a vessel and a ray there is a whole fibre or nothing: one that all but fills the band touches both
      // rays.
      radius = std::min(radius, 0.5 * room);
      radius = room - 2 * radius < 0.6 ? 0.54 * room : std::min(radius, 0.5 * room - 0.47);
      const double slack = room - 2 * radius;
      if (k == 0)
      {
        const double u = random_.uniform(RandomUse::VesselPlace, b, group);
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
        atY += 0.16 * radius * random_.normal(RandomUse::VesselPlace, b, group, k);
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
    const double u = random_.uniform(RandomUse::VesselGap, b, group);
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
    const bool narrow = random_.uniform(RandomUse::FibreSize, b, number) < narrowFibres * std::min(disorder_, 1.0);
    const double radius = narrow
      ? mix(0.1, 0.3, random_.uniform(RandomUse::FibreSize, b, number, 1))
      : 0.5 * std::max(0.5, 1 + 1.6 * scatter_ * random_.normal(RandomUse::FibreSize, b, number, 2));
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
    const double turn = random_.uniform(RandomUse::FibreRing, b, id);
    for (std::int64_t i = 0; i < count; ++i)
    {
      const double shake = 0.22 * disorder_ * random_.normal(RandomUse::FibreRing, b, id, i);
      const auto [c, s] =
        onCircle(turn + (static_cast<double>(i) + std::clamp(shake, -0.3, 0.3)) / static_cast<double>(count));
      const double x = vessel.x + elongation * distance * c;
      const double y = vessel.y + distance * s;
      if (y > band.low + 0.42 && y < band.high - 0.42 && isFree(x, y, 0.4, 0.7))
        add(x, y);
    }
  }
  // Files of fibres along x where there is room.
  const double room = band.high - band.low;
  const auto files = std::max<std::int64_t>(1, std::llround(room / 0.98));
  const double file = room / static_cast<double>(files);
  for (std::int64_t f = 0; f < files; ++f)
  {
    double x = -margin_ + random_.uniform(RandomUse::FileOffset, b, f);
    for (std::int64_t j = 0; x < width_ + margin_; ++j)
    {
      const double y = band.low +
        file * (static_cast<double>(f) + 0.5 + 0.12 * disorder_ * random_.normal(RandomUse::FibrePlace, b, f, j));
      if (isFree(x, y, 0.55, 0.74))
        add(x, y);
      const double position = mix(ring0_, ring1_, x / width_);
      const double flat = mix(1, 0.68, smoothStep((position - 0.85) / 0.15)); // the last cells of a ring are flat
      x += flat * std::max(0.6, 1 + 1.2 * scatter_ * random_.normal(RandomUse::FibrePlace, b, f, 100000 + j));
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
        add(x, y);
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
        return;
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

} // namespace lamella::generators
