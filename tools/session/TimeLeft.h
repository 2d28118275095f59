#pragma once

#include <optional>
#include <vector>

namespace lamella::cli
{

/// How long a run still takes, from the shares done that it tells: only where the pace of its second half so far and
/// that of all of it agree, for shares may be guesses, and work may come in lumps.
class TimeLeft
{
public:
  /// @param elapsed [s] @param share done, 0 … 1
  void tell(double elapsed, double share);
  /// [s]; nothing where it cannot be said.
  [[nodiscard]] std::optional<double> seconds() const;

private:
  struct Point
  {
    double elapsed;
    double share;
  };
  std::vector<Point> points_; ///< ever further apart; the first at 0
  Point now_{ 0, 0 };
};

} // namespace lamella::cli
