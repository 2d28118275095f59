#include "statistics/ErrorParts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::statistics
{
namespace
{

double sumOfSquares(std::span<const ErrorPart> parts) noexcept
{
  double sum = 0;
  for (const ErrorPart& part : parts)
    sum += part.relative * part.relative;
  return sum;
}

} // namespace

double totalError(std::span<const ErrorPart> parts) noexcept
{
  return parts.size() > 1 ? std::sqrt(sumOfSquares(parts)) : std::numeric_limits<double>::quiet_NaN();
}

std::optional<Halving> halving(std::span<const ErrorPart> parts) noexcept
{
  if (parts.size() < 2)
    return std::nullopt;
  const auto largest = std::ranges::max_element(parts, {}, &ErrorPart::relative);
  const double sum = sumOfSquares(parts);
  const double square = largest->relative * largest->relative;
  const double left = sum / 4 - (sum - square);
  if (!(left > 0))
    return std::nullopt;
  return Halving{ static_cast<std::size_t>(largest - parts.begin()), std::sqrt(left / square) };
}

} // namespace lamella::statistics
