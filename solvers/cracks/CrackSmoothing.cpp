#include "cracks/CrackSmoothing.h"

#include <algorithm>
#include <cmath>

namespace lamella::cracks
{
namespace
{

constexpr double tolerance = 0.05;   ///< by which a curve may miss a pair
constexpr double farthest = 100;     ///< over which a curve is smoothed, in spacings
constexpr double anchorWeight = 100; ///< of a point that is known
constexpr int overlap = 60;          ///< pairs of a closed chain that are met again beyond its ends

/// A symmetric positive definite matrix with two diagonals beside the main one, as L D Lᵀ.
class Band
{
public:
  explicit Band(std::size_t n)
    : rows_(n, { 0, 0, 0 })
  {
  }
  void add(std::size_t i, std::size_t j, double value) ///< i ≥ j
  {
    rows_[i][i - j] += value;
  }
  void factor()
  {
    for (std::size_t i = 0; i < rows_.size(); ++i)
    {
      auto& r = rows_[i];
      if (i >= 2)
      {
        r[2] /= rows_[i - 2][0];
        r[1] -= r[2] * rows_[i - 2][0] * rows_[i - 1][1];
        r[0] -= r[2] * r[2] * rows_[i - 2][0];
      }
      if (i >= 1)
      {
        r[1] /= rows_[i - 1][0];
        r[0] -= r[1] * r[1] * rows_[i - 1][0];
      }
    }
  }
  void solve(std::vector<Place>& x) const
  {
    const std::size_t n = x.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 1; k <= std::min<std::size_t>(i, 2); ++k)
        for (std::size_t a = 0; a < 2; ++a)
          x[i][a] -= rows_[i][k] * x[i - k][a];
    for (std::size_t i = 0; i < n; ++i)
      for (double& value : x[i])
        value /= rows_[i][0];
    for (std::size_t i = n; i-- > 0;)
      for (std::size_t k = 1; k <= 2 && i + k < n; ++k)
        for (std::size_t a = 0; a < 2; ++a)
          x[i][a] -= rows_[i + k][k] * x[i + k][a];
  }

private:
  std::vector<std::array<double, 3>> rows_; ///< D, then L one and two to the left
};

/// Chain with its anchors, or with what comes before and after it when it is closed.
class Smoother
{
public:
  explicit Smoother(const StairCase& stairs)
  {
    const auto n = static_cast<int>(stairs.middles.size());
    const int more = stairs.closed ? std::min(overlap, n) : 0;
    if (stairs.anchors[0])
      add(*stairs.anchors[0], -1);
    skip_ = stairs.anchors[0] ? 1 : static_cast<std::size_t>(more);
    for (int k = -more; k < n + more; ++k)
    {
      const auto at = static_cast<std::size_t>((k + n) % n);
      add(stairs.middles[at], stairs.axes[at]);
    }
    if (stairs.anchors[1])
      add(*stairs.anchors[1], -1);
    count_ = static_cast<std::size_t>(n);
  }

  std::vector<Place> run()
  {
    const std::size_t n = data_.size();
    weight_.assign(n, 1);
    steps_.assign(n, 1);
    bending_.assign(n, 16); // a first look at where it goes
    solve();
    arrange();
    const double all = std::min(farthest, place_.back());
    bending_.assign(n, std::pow(std::max(all, 1.0), 4));
    for (int round = 0; round < 24; ++round)
    {
      solve();
      arrange();
      if (!lower())
        break;
    }
    return { points_.begin() + static_cast<std::ptrdiff_t>(skip_),
      points_.begin() + static_cast<std::ptrdiff_t>(skip_ + count_) };
  }

private:
  void add(const Place& place, int axis)
  {
    data_.push_back(place);
    axes_.push_back(axis);
  }

  void solve()
  {
    const std::size_t n = data_.size();
    Band band(n);
    for (std::size_t i = 0; i < n; ++i)
      band.add(i, i, weight_[i]);
    for (std::size_t i = 1; i + 1 < n; ++i)
    {
      const double before = 1 / steps_[i - 1];
      const double after = 1 / steps_[i];
      const double scale = bending_[i] * 2 / (steps_[i - 1] + steps_[i]);
      const std::array<double, 3> c{ before, -before - after, after };
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b <= a; ++b)
          band.add(i - 1 + a, i - 1 + b, scale * c[a] * c[b]);
    }
    band.factor();
    points_.assign(n, { 0, 0 });
    std::vector<Place> part(n);
    for (int twice = 0; twice < 2; ++twice)
    {
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t a = 0; a < 2; ++a)
          part[i][a] = weight_[i] * (data_[i][a] - points_[i][a]);
      band.solve(part);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t a = 0; a < 2; ++a)
          points_[i][a] += part[i][a];
    }
  }

  /// Lengths along the curve, and across it how uncertain every crossing is.
  void arrange()
  {
    const std::size_t n = points_.size();
    place_.assign(n, 0);
    miss_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
    {
      if (i + 1 < n)
      {
        steps_[i] = std::max(0.2, distance(points_[i], points_[i + 1]));
        place_[i + 1] = place_[i] + steps_[i];
      }
      const Place& a = points_[i == 0 ? 0 : i - 1];
      const Place& b = points_[std::min(i + 1, n - 1)];
      const double length = std::max(1e-12, distance(a, b));
      const Place normal{ (a[1] - b[1]) / length, (b[0] - a[0]) / length };
      if (axes_[i] < 0)
      {
        weight_[i] = anchorWeight;
        continue;
      }
      const double width = std::abs(normal[static_cast<std::size_t>(axes_[i])]);
      weight_[i] = 1 / (width * width + tolerance);
      miss_[i] = std::abs(normal[0] * (points_[i][0] - data_[i][0]) + normal[1] * (points_[i][1] - data_[i][1])) -
        width / 2 - tolerance;
    }
  }

  /// @return whether the curve missed a pair
  bool lower()
  {
    const std::size_t n = points_.size();
    // distance to the nearest pair that was missed
    constexpr double none = 1e300;
    std::vector<double> near(n, none);
    double last = -none;
    for (std::size_t i = 0; i < n; ++i)
    {
      last = miss_[i] > 0 ? place_[i] : last;
      near[i] = place_[i] - last;
    }
    last = none;
    for (std::size_t i = n; i-- > 0;)
    {
      last = miss_[i] > 0 ? place_[i] : last;
      near[i] = std::min(near[i], last - place_[i]);
    }
    bool any = false;
    for (std::size_t i = 0; i < n; ++i)
    {
      any = any || miss_[i] > 0;
      if (near[i] <= std::pow(bending_[i], 0.25) && bending_[i] > 1)
        bending_[i] /= 3;
    }
    return any;
  }

  std::vector<Place> data_;
  std::vector<int> axes_; ///< -1: an anchor
  std::size_t skip_ = 0;
  std::size_t count_ = 0;
  std::vector<Place> points_;
  std::vector<double> weight_;
  std::vector<double> steps_;   ///< to the next point
  std::vector<double> bending_; ///< λ
  std::vector<double> place_;   ///< along the curve
  std::vector<double> miss_;    ///< positive where a pair is missed
};

} // namespace

std::vector<Place> smooth(const StairCase& stairs)
{
  return stairs.middles.size() + (stairs.anchors[0] ? 1U : 0U) + (stairs.anchors[1] ? 1U : 0U) < 3
    ? stairs.middles
    : Smoother(stairs).run();
}

} // namespace lamella::cracks
