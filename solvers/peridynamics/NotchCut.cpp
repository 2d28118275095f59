#include "peridynamics/NotchCut.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

using Vector = std::array<double, 3>;

Vector cross(const Vector& a, const Vector& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

double dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

} // namespace

NotchCut::NotchCut(const Notch& notch, std::size_t number, const Lattice& lattice, const std::array<bool, 3>& periodic)
  : dimension_(lattice.dimension)
{
  const auto d = static_cast<std::size_t>(dimension_);
  Vector corner{};
  for (std::size_t a = 0; a < d; ++a)
  {
    corner[a] = (notch.corner[a] - lattice.origin[a]) / lattice.spacing;
    along_[a] = notch.along[a] / lattice.spacing;
    across_[a] = notch.across[a] / lattice.spacing;
  }
  if (dimension_ == 2)
    across_ = { 0, 0, 1 };
  normal_ = cross(along_, across_);
  const double size = std::sqrt(dot(normal_, normal_));
  if (!(size > 1e-9) || !std::isfinite(size) || !std::isfinite(dot(corner, corner)))
    throw ParameterError(fmt::format("notch {} has no {}", number, dimension_ == 2 ? "length" : "area"),
      dimension_ == 2 ? "give two different points, in metres" : "give two edges that are not parallel, in metres");
  for (double& n : normal_)
    n /= size;

  // in node numbers the sample reaches from −½ to n − ½
  bool outside = false;
  for (std::size_t a = 0; a < d; ++a)
  {
    const double other = dimension_ == 3 ? across_[a] : 0;
    low_[a] = corner[a] + std::min(0.0, along_[a]) + std::min(0.0, other);
    high_[a] = corner[a] + std::max(0.0, along_[a]) + std::max(0.0, other);
    outside = outside || high_[a] < -0.5 || low_[a] > static_cast<double>(lattice.size[a]) - 0.5;
  }
  if (outside)
    throw ParameterError(fmt::format("notch {} from ({:g}, {:g}, {:g}) m lies outside the sample", number,
                           notch.corner[0], notch.corner[1], notch.corner[2]),
      fmt::format("the sample reaches from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m",
        lattice.origin[0] - lattice.spacing / 2, lattice.origin[1] - lattice.spacing / 2,
        dimension_ == 3 ? lattice.origin[2] - lattice.spacing / 2 : 0.0,
        lattice.origin[0] - lattice.spacing / 2 + lattice.length(0),
        lattice.origin[1] - lattice.spacing / 2 + lattice.length(1),
        dimension_ == 3 ? lattice.origin[2] - lattice.spacing / 2 + lattice.length(2) : 0.0));

  const auto images = [&](std::size_t a) { return a < d && periodic[a] ? 1 : 0; };
  for (int z = -images(2); z <= images(2); ++z)
    for (int y = -images(1); y <= images(1); ++y)
      for (int x = -images(0); x <= images(0); ++x)
        corners_.push_back({ corner[0] + x * static_cast<double>(lattice.size[0]),
          corner[1] + y * static_cast<double>(lattice.size[1]), corner[2] + z * static_cast<double>(lattice.size[2]) });
  for (std::size_t a = 0; a < d; ++a)
  {
    low_[a] -= images(a) * static_cast<double>(lattice.size[a]) + 1e-5;
    high_[a] += images(a) * static_cast<double>(lattice.size[a]) + 1e-5;
  }
}

bool NotchCut::near(const std::array<std::int64_t, 3>& node, int reach) const noexcept
{
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a)
  {
    const auto at = static_cast<double>(node[a]);
    if (at < low_[a] - reach || at > high_[a] + reach)
      return false;
  }
  return true;
}

bool NotchCut::crosses(const std::array<std::int64_t, 3>& node, const std::array<int, 3>& step) const noexcept
{
  const Vector s{ static_cast<double>(step[0]), static_cast<double>(step[1]), static_cast<double>(step[2]) };
  const double rise = dot(normal_, s);
  if (rise == 0)
    return false;
  // the edges' dual basis within the plane
  const Vector toAlong = cross(across_, normal_);
  const Vector toAcross = cross(normal_, along_);
  const double area = dot(along_, toAlong);
  for (const Vector& corner : corners_)
  {
    Vector from{ static_cast<double>(node[0]) - corner[0], static_cast<double>(node[1]) - corner[1],
      static_cast<double>(node[2]) - corner[2] };
    if (dimension_ == 2)
      from[2] = 0;
    // Nodes in the plane count as below it. Where a bond meets the plane is not moved for their sake: at a tip, of two
    // bonds that are images of each other, both are cut.
    constexpr double inPlane = 1e-6;
    const double begin = dot(normal_, from);
    if ((begin > inPlane) == (begin + rise > inPlane))
      continue;
    const double part = std::clamp(-begin / rise, 0.0, 1.0); // where along the bond it meets the plane
    const Vector at{ from[0] + part * s[0], from[1] + part * s[1], from[2] + part * s[2] };
    const double p = dot(at, toAlong) / area;
    const double q = dimension_ == 2 ? 0.0 : dot(at, toAcross) / area;
    constexpr double slack = 1e-9;
    if (p >= -slack && p <= 1 + slack && q >= -slack && q <= 1 + slack)
      return true;
  }
  return false;
}

} // namespace lamella::peridynamics
