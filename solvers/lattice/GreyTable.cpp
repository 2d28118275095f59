#include "lattice/GreyTable.h"

#include "core/Error.h"
#include "core/Parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace lamella
{
namespace
{

constexpr double leastPart = 1e-6;    // of the largest value that is not 0
constexpr std::size_t mostBins = 250; // and one more for each change between 0 and what is not

} // namespace

GreyTable::GreyTable(const std::map<std::string, double>& given, const std::string& quantity)
{
  std::map<double, double> sorted;
  for (const auto& [text, value] : given)
  {
    const std::optional<double> grey = toNumber(text);
    if (!grey || !std::isfinite(*grey))
      throw ParameterError(fmt::format("the {} of '{}', which is no grey", quantity, text),
        fmt::format("between greys it is interpolated: give the {} of some greys, as 40=0.1 and 220=1", quantity));
    if (!std::isfinite(value) || value < 0)
      throw ParameterError(fmt::format("the {} of grey {} is {}", quantity, text, value),
        "give a positive value, or 0 for what does not conduct");
    if (!sorted.emplace(*grey, value).second)
      throw ParameterError(fmt::format("the {} of grey {:g} is given twice", quantity, *grey), "give it once");
  }
  if (sorted.size() < 2)
    throw ParameterError(
      fmt::format("the {} of {} to be interpolated between", quantity, sorted.empty() ? "no grey" : "one grey alone"),
      "give that of two greys at least, as 40=0.1 and 220=1");
  for (const auto& [grey, value] : sorted)
  {
    grey_.push_back(grey);
    value_.push_back(value);
    least_ = std::max(least_, leastPart * value);
  }
  if (!(least_ > 0))
    throw ParameterError(fmt::format("the {} is 0 whatever the grey", quantity), "give a positive one to some grey");
}

double GreyTable::value(double grey) const noexcept
{
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(grey_, grey) - grey_.begin());
  double found = value_[std::min(above, value_.size() - 1)];
  if (above > 0 && above < grey_.size())
  {
    const double t = (grey - grey_[above - 1]) / (grey_[above] - grey_[above - 1]);
    found = value_[above - 1] + t * (value_[above] - value_[above - 1]);
  }
  return found < least_ ? 0.0 : found;
}

// From grey to grey, in stretches on which the value is 0, or is not.
std::vector<GreyTable::Piece> GreyTable::pieces() const
{
  std::vector<Piece> found;
  for (std::size_t i = 1; i < grey_.size(); ++i)
  {
    const double from = grey_[i - 1];
    const double to = grey_[i];
    const double a = value_[i - 1];
    const double b = value_[i];
    const auto change = [&](double p, double q) { return std::abs(std::log(q / p)); };
    const auto where = [&](double v) { return from + (to - from) * (v - a) / (b - a); };
    if (std::max(a, b) < least_)
      found.push_back({ from, to, 0, true });
    else if (std::min(a, b) >= least_)
      found.push_back({ from, to, change(a, b), false });
    else if (a < b)
    {
      found.push_back({ from, where(least_), 0, true });
      found.push_back({ where(least_), to, change(least_, b), false });
    }
    else
    {
      found.push_back({ from, where(least_), change(a, least_), false });
      found.push_back({ where(least_), to, 0, true });
    }
  }
  return found;
}

double GreyTable::step() const
{
  double total = 0;
  std::size_t fixed = 0; // bins that are there whatever the step: one a piece at least
  for (const Piece& piece : pieces())
  {
    total += piece.change;
    ++fixed;
  }
  if (fixed >= mostBins)
    throw ParameterError(fmt::format("values of {} greys", grey_.size()), fmt::format("give {} at most", mostBins / 2));
  return total / static_cast<double>(mostBins - fixed);
}

GreyBins GreyTable::bins() const
{
  const double most = step();
  // beyond the outermost greys their values stay
  std::vector<double> border;
  std::vector<double> grey{ grey_.front() };
  for (const Piece& piece : pieces())
  {
    const double a = piece.none ? 1.0 : std::max(value(piece.from), least_);
    const double b = piece.none ? 1.0 : std::max(value(piece.to), least_);
    const auto parts =
      std::max<std::int64_t>(1, most > 0 ? static_cast<std::int64_t>(std::ceil(piece.change / most)) : 1);
    // values in equal ratios; linear in between, so their greys follow
    const auto at = [&](double i)
    {
      const double t = i / static_cast<double>(parts);
      return a == b ? piece.from + t * (piece.to - piece.from)
                    : piece.from + (piece.to - piece.from) * (a * std::pow(b / a, t) - a) / (b - a);
    };
    for (std::int64_t i = 0; i < parts; ++i)
    {
      border.push_back(border.empty() ? std::nextafter(grey_.front(), grey_.back()) : at(static_cast<double>(i)));
      grey.push_back(at(static_cast<double>(i) + 0.5));
    }
  }
  border.push_back(grey_.back());
  grey.push_back(grey_.back());
  return { std::move(border), std::move(grey) };
}

double GreyTable::rounding() const
{
  return std::expm1(0.5 * step());
}

} // namespace lamella
