#include "statistics/Distributions.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cmath>

namespace lamella::statistics
{
namespace
{

/// The continued fraction by Lentz's method; converges quickly for x below the mean a/(a + b).
double betaFraction(double a, double b, double x)
{
  constexpr double tiny = 1e-300;
  const auto kept = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1;
  double d = 1 / kept(1 - (a + b) * x / (a + 1));
  double h = d;
  for (int m = 1; m < 1000; ++m)
  {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / kept(1 + even * d);
    c = kept(1 + even / c);
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / kept(1 + odd * d);
    c = kept(1 + odd / c);
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15)
      break;
  }
  return h;
}

} // namespace

double incompleteBeta(double a, double b, double x)
{
  if (x <= 0)
    return 0;
  if (x >= 1)
    return 1;
  const double front = std::exp(a * std::log(x) + b * std::log1p(-x)) / std::beta(a, b);
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a : 1 - front * betaFraction(b, a, 1 - x) / b;
}

double studentQuantile(double probability, double freedom)
{
  if (!(probability >= 0 && probability < 1) || !(freedom > 0))
    throw ParameterError(fmt::format("Student's t for probability {} and freedom {}", probability, freedom),
      "give a probability from 0 to below 1 and a freedom above 0");
  // |t| > x with probability I_y(ν/2, 1/2), y = ν/(ν + x²): rises with y, which is bisected.
  double low = 0;
  double high = 1;
  while (high - low > 1e-15 * high)
  {
    const double y = 0.5 * (low + high);
    if (y == low || y == high)
      break;
    (incompleteBeta(freedom / 2, 0.5, y) < 1 - probability ? low : high) = y;
  }
  return std::sqrt(freedom * (1 - high) / high);
}

double fisherTail(double f, double freedom, double freedomBelow)
{
  if (!(freedom > 0) || !(freedomBelow > 0))
    throw ParameterError(
      fmt::format("Fisher's F with freedoms {} and {}", freedom, freedomBelow), "give freedoms above 0");
  return f > 0 ? incompleteBeta(freedomBelow / 2, freedom / 2, freedomBelow / (freedomBelow + freedom * f)) : 1;
}

} // namespace lamella::statistics
