#pragma once

#include "core/Error.h"
#include "packing/Bridges.h"
#include "packing/Packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

/// Packings and bridges judged by the definitions alone: distances of all pairs, sums of forces, points in shapes. No
/// code of the solver's but its answer.
namespace lamella::test
{

enum class Verdict
{
  Right,   ///< what was asked for, to what is stated
  Warned,  ///< not so near, and it said so
  Refused, ///< by an exception of ours, which says why
  Wrong    ///< not so near, and nothing was said
};
inline const char* name(Verdict verdict)
{
  constexpr std::array<const char*, 4> names{ "right", "warned", "refused", "wrong" };
  return names.at(static_cast<std::size_t>(verdict));
}

struct Outcome
{
  Verdict verdict = Verdict::Wrong;
  double error = 0; ///< the worst of what is checked over what is allowed
  std::string what; ///< which that is; warning or message
};

/// The worst of several findings, each over what is allowed.
class Findings
{
public:
  void check(const char* what, double value, double allowed)
  {
    const double over = std::isfinite(value) ? value / allowed : INFINITY;
    if (over > worst_)
    {
      worst_ = over;
      what_ = fmt::format("{} {:.3g}, allowed {:.3g}", what, value, allowed);
    }
  }
  void must(const char* what, bool holds) { check(what, holds ? 0 : 2, 1); }
  [[nodiscard]] Outcome outcome(const std::vector<std::string>& warnings) const
  {
    const bool right = worst_ <= 1;
    return { right         ? Verdict::Right
        : warnings.empty() ? Verdict::Wrong
                           : Verdict::Warned,
      worst_, right ? what_ : what_ + (warnings.empty() ? "" : "; " + warnings.front()) };
  }

private:
  double worst_ = 0;
  std::string what_;
};

/// Runs `f`, which gives an outcome; what of ours it throws becomes the verdict, if it says what to do.
template <class F>
Outcome judged(F&& f)
{
  try
  {
    return f();
  }
  catch (const Error& e)
  {
    return { e.hint().empty() ? Verdict::Wrong : Verdict::Refused, 0, e.what() };
  }
}

using Vector = std::array<double, 3>;

inline double dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// From one grain to another, or to its nearest image.
inline Vector between(const packing::Packing& p, std::size_t i, std::size_t j)
{
  Vector r{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(p.dimension); ++a)
  {
    r[a] = p.centre[j][a] - p.centre[i][a];
    if (p.periodic[a])
      r[a] -= p.size[a] * std::round(r[a] / p.size[a]);
  }
  return r;
}

/// A packing between its grains and walls alone: overlaps found anew, and the forces that they make.
struct Mechanics
{
  double meanOverlap = 0; ///< over the contacts, of the mean diameter
  double mostOverlap = 0;
  std::int64_t told = 0;     ///< contacts that it tells
  std::int64_t contacts = 0; ///< with more than round-off of an overlap
  double unbalanced = 0;     ///< mean net force over mean contact force, by forces as reported
  double normal = 0;         ///< largest error of a reported normal force against the spring's, over the mean
  double sliding = 0;        ///< largest tangential force over friction times normal force
  double stress = 0;         ///< mean of its principal values [Pa]
  double turning = 0;        ///< mean net moment over mean contact force and mean radius
  Vector pressure{};         ///< on the walls along each axis, or of the stress where periodic, over that asked for
};

inline Mechanics mechanicsOf(const packing::Packing& p, const packing::PackingOptions& o)
{
  Mechanics m;
  const auto axes = static_cast<std::size_t>(p.dimension);
  const double least = 1e-4 * o.softness * o.meanDiameter;
  const auto measure = [&](double overlap)
  {
    m.mostOverlap = std::max(m.mostOverlap, overlap / o.meanDiameter);
    if (overlap <= least)
      return;
    ++m.contacts;
    m.meanOverlap += overlap / o.meanDiameter;
  };
  for (std::size_t i = 0; i < p.count(); ++i)
  {
    for (std::size_t j = i + 1; j < p.count(); ++j)
      measure(p.radius[i] + p.radius[j] - std::sqrt(dot(between(p, i, j), between(p, i, j))));
    for (std::size_t a = 0; a < axes && !p.periodic[0]; ++a)
    {
      measure(p.radius[i] - p.centre[i][a]);
      measure(p.radius[i] - (p.size[a] - p.centre[i][a]));
    }
  }
  m.meanOverlap /= std::max<double>(1, static_cast<double>(m.contacts));

  std::vector<Vector> net(p.count(), Vector{});
  std::vector<Vector> moment(p.count(), Vector{});
  double force = 0;
  double overlaps = 0;
  for (const packing::Contact& c : p.contacts)
  {
    force += dot(c.force, c.normal) / static_cast<double>(p.contacts.size());
    overlaps += c.overlap / static_cast<double>(p.contacts.size());
    m.told += c.overlap > least ? 1 : 0;
  }
  const double stiffness = overlaps > 0 ? force / overlaps : 0;
  for (const packing::Contact& c : p.contacts)
  {
    const auto first = static_cast<std::size_t>(c.first);
    const double along = dot(c.force, c.normal);
    Vector tangential{};
    for (std::size_t a = 0; a < 3; ++a)
      tangential[a] = c.force[a] - along * c.normal[a];
    if (o.friction > 0 && along > 0)
      m.sliding = std::max(m.sliding, std::sqrt(dot(tangential, tangential)) / (o.friction * along));
    else
      m.sliding = std::max(m.sliding, std::sqrt(dot(tangential, tangential)) > 1e-9 * force ? 1e99 : 0.0);
    m.normal = std::max(m.normal, std::fabs(along - stiffness * c.overlap) / force);
    m.stress += dot(c.force, c.branch) / p.volume() / static_cast<double>(axes);
    const auto act = [&](std::size_t grain, double sign, double lever) // at the surface, along the normal
    {
      for (std::size_t a = 0; a < 3; ++a)
        net[grain][a] += sign * c.force[a];
      const Vector& n = c.normal;
      const Vector& t = tangential;
      moment[grain][0] += lever * (n[1] * t[2] - n[2] * t[1]);
      moment[grain][1] += lever * (n[2] * t[0] - n[0] * t[2]);
      moment[grain][2] += lever * (n[0] * t[1] - n[1] * t[0]);
    };
    act(first, -1, -p.radius[first]);
    if (c.second >= 0)
      act(static_cast<std::size_t>(c.second), 1, -p.radius[static_cast<std::size_t>(c.second)]);
    if (!p.periodic[0] && c.second < 0)
    {
      const auto a = static_cast<std::size_t>((-1 - c.second) / 2);
      m.pressure[a] += 0.5 * std::fabs(c.force[a]) * p.size[a] / p.volume() / o.pressure;
    }
    else if (p.periodic[0])
      for (std::size_t a = 0; a < axes; ++a)
        m.pressure[a] += c.force[a] * c.branch[a] / p.volume() / o.pressure;
  }
  for (std::size_t i = 0; i < p.count() && force > 0; ++i)
  {
    m.unbalanced += std::sqrt(dot(net[i], net[i])) / force / static_cast<double>(p.count());
    m.turning += std::sqrt(dot(moment[i], moment[i])) / force / (0.5 * o.meanDiameter) / static_cast<double>(p.count());
  }
  return m;
}

/// What a packing must be. By the virial the mean contact force is the pressure times a section, times the moments
/// ⟨dⁿ⟩/⟨d⟩ⁿ of the sizes: overlaps are softness times that, and forces fall exponentially, so that the largest of a
/// thousand is about ten times the mean.
inline Outcome judge(const packing::Packing& p, const packing::PackingOptions& o)
{
  Findings f;
  const auto axes = static_cast<std::size_t>(p.dimension);
  double grains = 0;
  double moment = 0;
  for (std::size_t i = 0; i < p.count(); ++i)
  {
    grains += p.grainVolume(i);
    moment += std::pow(2 * p.radius[i] / o.meanDiameter, p.dimension) / static_cast<double>(p.count());
    for (std::size_t a = 0; a < axes; ++a)
      f.must("a centre outside the box", p.centre[i][a] >= 0 && p.centre[i][a] <= p.size[a]);
  }
  const packing::PackingStatistics s = packing::statistics(p, o.friction > 0);
  f.check("packing fraction off by", std::fabs(s.packingFraction - grains / p.volume()), 1e-12);
  const Mechanics m = mechanicsOf(p, o);
  if (o.packingFraction)
  {
    f.check("packing fraction asked for off by", std::fabs(s.packingFraction - *o.packingFraction), 1e-9);
    f.check("overlap [diameters]", m.mostOverlap, 1e-8);
    return f.outcome(p.warnings);
  }
  f.must("contacts missed or made up", m.contacts == m.told);
  f.check("unbalanced force", m.unbalanced, o.tolerance * (1 + 1e-6) + 1e-10);
  f.check("unbalanced force told wrongly by", std::fabs(m.unbalanced - p.unbalanced), 1e-3 * o.tolerance + 1e-10);
  f.check("normal force against its spring", m.normal, 1e-6);
  f.check("tangential over Coulomb's limit", m.sliding, 1 + 1e-6);
  f.check("unbalanced moment", m.turning, 10 * o.tolerance);
  // where few contacts carry it all
  moment *= std::max(1.0, p.dimension * static_cast<double>(p.count()) / static_cast<double>(m.contacts));
  f.check("share of grains that carry nothing", static_cast<double>(s.rattlers) / static_cast<double>(p.count()), 0.5);
  f.check("mean overlap over softness", m.meanOverlap, 3 * moment * o.softness);
  f.check("largest overlap over softness", m.mostOverlap, 30 * moment * o.softness);
  f.must("overlaps far below softness", m.meanOverlap > 0.1 * o.softness);
  double mean = 0;
  for (std::size_t a = 0; a < axes; ++a)
  {
    mean += m.pressure[a] / static_cast<double>(axes);
    if (o.friction == 0) // of walls, each pair by itself
      f.check("pressure on an axis off by", std::fabs(m.pressure[a] - 1), 2 * o.tolerance + 1e-6);
  }
  if (o.friction > 0) // tangential forces on the walls have a part in the mean stress
    mean = m.stress / o.pressure;
  f.check("mean stress off by", std::fabs(mean - 1), 2 * o.tolerance + 1e-6);
  const auto held = static_cast<std::int64_t>(p.count()) - s.rattlers;
  const auto freedom = p.dimension * held + (p.periodic[0] ? 0 : p.dimension);
  if (o.friction == 0) // one contact less, and it could not be at rest
    f.must("fewer contacts than degrees of freedom", s.grainContacts + s.wallContacts >= freedom);
  f.check("aspect off by", std::fabs(s.aspect / o.aspect - 1), o.friction > 0 ? 1e-9 : 0.02);
  f.check("contacts anisotropic by", o.friction > 0 ? 0 : s.fabricAnisotropy, 0.0301);
  f.check("stress anisotropic by", o.friction > 0 ? 0 : s.stressAnisotropy, 0.0301);
  return f.outcome(p.warnings);
}

inline Outcome attempt(const packing::PackingOptions& o)
{
  return judged([&] { return judge(packing::pack(o), o); });
}

/// Whether a place is in the grain; in the trapezoid, or truncated cone, between two places.
inline bool inGrain(const Vector& at, const Vector& centre, double radius)
{
  const Vector r{ at[0] - centre[0], at[1] - centre[1], at[2] - centre[2] };
  return dot(r, r) <= radius * radius;
}
inline bool inBridge(const Vector& at, const Vector& from, const Vector& to, double halfFrom, double halfTo)
{
  const Vector line{ to[0] - from[0], to[1] - from[1], to[2] - from[2] };
  const Vector r{ at[0] - from[0], at[1] - from[1], at[2] - from[2] };
  const double along = dot(r, line) / dot(line, line);
  const double beside = std::sqrt(std::max(0.0, dot(r, r) - along * along * dot(line, line)));
  return along >= 0 && along <= 1 && beside <= halfFrom + (halfTo - halfFrom) * along;
}

/// Shares of the box by places on a grid: each asks every grain and every pair of grains and images, by the definition.
inline packing::MatrixFractions sharesByPlaces(const packing::Packing& p, const packing::BridgeOptions& o, int across)
{
  struct Pair
  {
    Vector from, to;
    double halfFrom, halfTo;
  };
  std::vector<Pair> pairs;
  std::vector<std::pair<Vector, double>> grains;
  const auto axes = static_cast<std::size_t>(p.dimension);
  const auto shifted = [&](std::size_t i, int image)
  {
    Vector c = p.centre[i];
    for (std::size_t a = 0; a < axes; ++a, image /= 3)
      c[a] += (image % 3 - 1) * p.size[a];
    return c;
  };
  const int images = p.dimension == 2 ? 9 : 27;
  for (std::size_t i = 0; i < p.count(); ++i)
    for (int k = 0; k < images; ++k)
    {
      if (k != images / 2 && !p.periodic[0])
        continue;
      const Vector first = shifted(i, k);
      grains.emplace_back(first, p.radius[i]);
      for (std::size_t j = 0; j < p.count(); ++j)
        for (int l = 0; l < images; ++l)
        {
          if (l != images / 2 && !p.periodic[0])
            continue;
          const Vector second = shifted(j, l);
          const Vector r{ second[0] - first[0], second[1] - first[1], second[2] - first[2] };
          const double reach = o.reach * (p.radius[i] + p.radius[j]);
          if (std::pair(j, l) > std::pair(i, k) && dot(r, r) < reach * reach)
            pairs.push_back({ first, second, o.width * p.radius[i], o.width * p.radius[j] });
        }
    }
  const int deep = p.dimension == 3 ? across : 1;
  std::int64_t grain = 0;
  std::int64_t matrix = 0;
  for (int z = 0; z < deep; ++z)
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x)
      {
        const Vector at{ (x + 0.5) / across * p.size[0], (y + 0.5) / across * p.size[1],
          p.dimension == 3 ? (z + 0.5) / across * p.size[2] : 0.0 };
        if (std::any_of(grains.begin(), grains.end(), [&](const auto& g) { return inGrain(at, g.first, g.second); }))
          ++grain;
        else if (o.filled ||
          std::any_of(pairs.begin(), pairs.end(),
            [&](const Pair& b) { return inBridge(at, b.from, b.to, b.halfFrom, b.halfTo); }))
          ++matrix;
      }
  const double all = static_cast<double>(across) * across * deep;
  packing::MatrixFractions f{ static_cast<double>(grain) / all, static_cast<double>(matrix) / all, 0, 0 };
  f.voids = 1 - f.grains - f.matrix;
  f.saturation = f.matrix + f.voids > 0 ? f.matrix / (f.matrix + f.voids) : 0;
  return f;
}

/// Cement, by places: the geometry to what so many places tell, the lattice to 2 % of the box or warned.
inline Outcome judge(
  const packing::Packing& p, packing::BridgeOptions o, const packing::RasterOptions& raster, int across)
{
  const packing::CementedSample s = packing::cement(p, o, raster);
  if (o.saturation)
    o.width = s.width;
  o.filled = o.filled || (o.saturation && *o.saturation == 1);
  const packing::MatrixFractions expected = sharesByPlaces(p, o, across);
  Findings f;
  const auto share = [&](const char* what, double value) { f.must(what, value >= 0 && value <= 1); };
  for (const packing::MatrixFractions* of : { &s.fractions, &s.onLattice })
  {
    share("share of grains outside 0 to 1", of->grains);
    share("share of matrix outside 0 to 1", of->matrix);
    share("share of void outside 0 to 1", of->voids);
    share("saturation outside 0 to 1", of->saturation);
    f.check("shares sum to 1 but for", std::fabs(of->grains + of->matrix + of->voids - 1), 1e-9);
  }
  // A place is right but near an edge: of n across about n edges, half a place each, signs at random.
  const double places = (p.dimension == 2 ? 3.0 : 2.0) / across * std::pow(across, -0.5) + 2e-3;
  const bool overlaps = std::any_of(
    s.warnings.begin(), s.warnings.end(), [](const std::string& w) { return w.find("overlap") != std::string::npos; });
  f.check("grains off by", std::fabs(s.fractions.grains - expected.grains), places);
  f.check("matrix off by", std::fabs(s.fractions.matrix - expected.matrix), places);
  if (o.saturation)
    f.check("saturation asked for off by", std::fabs(s.fractions.saturation - *o.saturation), 1.01e-4 * *o.saturation);
  double grains = 0;
  bool inside = true; // the box cuts what sticks out of it
  for (std::size_t i = 0; i < p.count(); ++i)
  {
    grains += p.grainVolume(i) / p.volume();
    for (std::size_t a = 0; a < static_cast<std::size_t>(p.dimension); ++a)
      inside =
        inside && (p.periodic[a] || (p.centre[i][a] >= p.radius[i] && p.centre[i][a] <= p.size[a] - p.radius[i]));
  }
  if (!overlaps && inside)
  {
    f.check("grains against their radii off by", std::fabs(s.fractions.grains - grains),
      p.dimension == 2 ? 2e-4 + 2 * grains * 1e-2 : 2e-2);
  }
  f.check("grains of the lattice off by", std::fabs(s.onLattice.grains - s.fractions.grains), 0.02);
  f.check("matrix of the lattice off by", std::fabs(s.onLattice.matrix - s.fractions.matrix), 0.02);
  std::int64_t bad = 0;
  for (std::size_t i = 0; i < s.image.phase.size(); ++i)
    bad += (s.image.phase[i] == 2) != (s.grain[i] != 0) || s.image.phase[i] > 2 ? 1 : 0;
  f.must("phases and grains of the lattice contradict each other", bad == 0);
  return f.outcome(s.warnings);
}

} // namespace lamella::test
