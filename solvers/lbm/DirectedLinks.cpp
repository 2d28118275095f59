#include "lbm/DirectedLinks.h"

#include "core/Error.h"
#include "lbm/Links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::lbm
{
namespace
{

// A node's tensor as shares of its links.
struct Shares
{
  double x = 0; // straight links
  double y = 0;
  double rising = 0;
  double falling = 0;

  [[nodiscard]] double xx() const { return x + rising + falling; }
  [[nodiscard]] double yy() const { return y + rising + falling; }
  [[nodiscard]] double xy() const { return rising - falling; }
  [[nodiscard]] bool conducts() const { return xx() > 0 || yy() > 0; }
  // What a side across x or y, insulated, adds to the link along it.
  [[nodiscard]] double along(int normal) const
  {
    const double across = normal == 0 ? xx() : yy();
    const double mixed = std::abs(xy());
    return across > 0 ? 0.5 * mixed * (1 - mixed / across) : 0.0;
  }
};

void requireFit(const Lattice& lattice, std::span<const std::uint8_t> phase, const DirectedDiffusivity& d)
{
  if (lattice.dimension != 2)
    throw ParameterError(
      "conductivities along and across an axis on the links of a volume", "take elements, q1, which carry them");
  if (d.hasTensors())
    throw ParameterError("tensors of phases or voxels on the links of d2q9", "take elements, q1, which carry them");
  const auto nodes = static_cast<std::size_t>(lattice.count());
  if (phase.size() != nodes || d.axis.size() != nodes)
    throw ParameterError(
      fmt::format("{} phase ids and {} axes were given for {} nodes", phase.size(), d.axis.size(), nodes),
      "give one of each for every node of the whole picture");
  if (d.along.size() != d.across.size())
    throw ParameterError(
      fmt::format("{} conductivities along and {} across were given", d.along.size(), d.across.size()),
      "give two for each phase");
  for (std::size_t id = 0; id < d.along.size(); ++id)
    for (const double value : { d.along[id], d.across[id] })
      if (!std::isfinite(value) || value < 0)
        throw ParameterError(
          fmt::format("a conductivity of phase {} is {}", id, value), "give finite values of at least 0");
  const auto largest = phase.empty() ? std::size_t{ 0 } : std::size_t{ *std::max_element(phase.begin(), phase.end()) };
  if (largest >= d.along.size())
    throw ParameterError(fmt::format("phase {} has no conductivity", largest), "give two values for each phase");
}

class Tensors
{
public:
  Tensors(const Lattice& lattice, std::span<const std::uint8_t> phase, const DirectedDiffusivity& d)
    : nx_(lattice.size[0])
    , ny_(lattice.size[1])
    , shares_(phase.size())
  {
    std::int64_t lost = 0;
    for (std::size_t i = 0; i < phase.size(); ++i)
    {
      const double along = d.along[phase[i]];
      const double across = d.across[phase[i]];
      shares_[i] = { along, along, 0, 0 };
      if (along == across)
        continue;
      const double ax = d.axis[i][0];
      const double ay = d.axis[i][1];
      const double length = std::hypot(ax, ay);
      if (!(length > 0) || !std::isfinite(length))
      {
        ++lost;
        continue;
      }
      const double c = ax / length;
      const double s = ay / length;
      const double mixed = (along - across) * c * s;
      const double least = std::min(along * c * c + across * s * s, along * s * s + across * c * c);
      // axes are floats: 1e-6 beyond the bound is on it
      if (std::abs(mixed) > least + 1e-6 * (along + across))
        refuse(along, across, std::atan2(std::abs(s), std::abs(c)), static_cast<std::int64_t>(i));
      const double diagonal = std::abs(mixed);
      shares_[i] = { std::max(0.0, along * c * c + across * s * s - diagonal),
        std::max(0.0, along * s * s + across * c * c - diagonal), std::max(mixed, 0.0), std::max(-mixed, 0.0) };
    }
    if (lost > 0)
      throw ParameterError(
        fmt::format("{} nodes of phases that conduct differently along and across have no axis to go by", lost),
        "give these nodes an axis, or the phase one value");
  }

  [[nodiscard]] const Shares& at(std::int64_t i, std::int64_t j) const
  {
    return shares_[static_cast<std::size_t>(i + nx_ * j)];
  }

private:
  [[noreturn]] void refuse(double along, double across, double angle, std::int64_t node) const
  {
    throw ParameterError(
      fmt::format("{:g} along and {:g} across, a ratio of {:.3g}, are more than the links of d2q9 can carry at {:.1f}° "
                  "to the lattice (node {}, {})",
        along, across, std::max(along, across) / std::min(along, across), angle * 180 / std::numbers::pi, node % nx_,
        node / nx_),
      fmt::format(
        "keep to a ratio of {:.3g}, which they carry in every direction, or take elements, q1", mostDirected - 0.005));
  }

  std::int64_t nx_;
  std::int64_t ny_;
  std::vector<Shares> shares_;
};

double arithmetic(const Shares& a, const Shares& b, double ofA, double ofB)
{
  return a.conducts() && b.conducts() ? 0.5 * (ofA + ofB) : 0.0;
}

} // namespace

bool linksCarry(std::span<const double> along, std::span<const double> across) noexcept
{
  for (std::size_t id = 0; id < along.size(); ++id)
    if (std::max(along[id], across[id]) > mostDirected * std::min(along[id], across[id]))
      return false;
  return true;
}

LinkTable directedLinks(
  const Lattice& lattice, std::span<const std::uint8_t> phase, const DirectedDiffusivity& diffusivity, Sides sides)
{
  requireFit(lattice, phase, diffusivity);
  const Tensors tensors(lattice, phase, diffusivity);
  const std::int64_t nx = lattice.size[0];
  const std::int64_t ny = lattice.size[1];
  const bool periodic = sides == Sides::Periodic;
  LinkTable table(nx, ny, true);
  // the nodes on both sides of a link or a corner; at a face that is not periodic, the only one twice
  const auto before = [&](std::int64_t i, std::int64_t n) { return i > 0 ? i - 1 : periodic ? n - 1 : 0; };
  const auto after = [&](std::int64_t i, std::int64_t n) { return i < n ? i : periodic ? 0 : n - 1; };
  const auto outside = [&](std::int64_t i, std::int64_t n) { return !periodic && (i == 0 || i == n); };

  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i <= nx; ++i)
    {
      const Shares& a = tensors.at(before(i, nx), j);
      const Shares& b = tensors.at(after(i, nx), j);
      double g = outside(i, nx) ? a.xx() : harmonicMean(a.x, b.x);
      if (!periodic && !outside(i, nx))
        g += ((j == 0) + (j == ny - 1)) * arithmetic(a, b, a.along(1), b.along(1));
      table.x[static_cast<std::size_t>(i + (nx + 1) * j)] = g;
    }
  for (std::int64_t j = 0; j <= ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i)
    {
      const Shares& a = tensors.at(i, before(j, ny));
      const Shares& b = tensors.at(i, after(j, ny));
      double g = outside(j, ny) ? a.yy() : harmonicMean(a.y, b.y);
      if (!periodic && !outside(j, ny))
        g += ((i == 0) + (i == nx - 1)) * arithmetic(a, b, a.along(0), b.along(0));
      table.y[static_cast<std::size_t>(i + nx * j)] = g;
    }
  for (std::int64_t j = 0; j <= ny; ++j)
    for (std::int64_t i = 0; i <= nx; ++i)
    {
      if (outside(i, nx) || outside(j, ny))
        continue;
      const std::int64_t west = before(i, nx);
      const std::int64_t east = after(i, nx);
      const std::int64_t south = before(j, ny);
      const std::int64_t north = after(j, ny);
      const std::size_t corner = static_cast<std::size_t>(i + (nx + 1) * j);
      const Shares& sw = tensors.at(west, south);
      const Shares& ne = tensors.at(east, north);
      table.rising[corner] = arithmetic(sw, ne, sw.rising, ne.rising);
      const Shares& nw = tensors.at(west, north);
      const Shares& se = tensors.at(east, south);
      table.falling[corner] = arithmetic(nw, se, nw.falling, se.falling);
    }
  return table;
}

} // namespace lamella::lbm
