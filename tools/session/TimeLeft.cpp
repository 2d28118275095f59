#include "session/TimeLeft.h"

#include <algorithm>

namespace lamella::cli
{

void TimeLeft::tell(double elapsed, double share)
{
  constexpr double further = 1.05;
  if (points_.empty())
    points_.push_back({ 0, 0 });
  if (elapsed > 0.1 + further * points_.back().elapsed)
    points_.push_back({ elapsed, share });
  now_ = { elapsed, share };
}

std::optional<double> TimeLeft::seconds() const
{
  constexpr double soonest = 2; // s
  constexpr double most = 1.5;  // between both estimates
  if (now_.elapsed < soonest || !(now_.share > 0))
    return std::nullopt;
  const auto half = std::partition_point(
    points_.begin(), points_.end(), [this](const Point& p) { return p.elapsed <= now_.elapsed / 2; });
  const Point& before = *(half - 1);
  const double lately = (now_.share - before.share) / (now_.elapsed - before.elapsed);
  const double inAll = now_.share / now_.elapsed;
  if (lately > most * inAll || inAll > most * lately)
    return std::nullopt;
  return (1 - now_.share) / lately;
}

} // namespace lamella::cli
