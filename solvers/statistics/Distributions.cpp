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

double chiSquareTail(double x, double freedom)
{
  if (!(freedom > 0 && freedom <= 300))
    throw ParameterError(fmt::format("chi square with a freedom of {}", freedom), "give one above 0, up to 300");
  if (!(x > 0))
    return 1;
  const double a = 0.5 * freedom;
  const double z = 0.5 * x;
  const double scale = std::exp(a * std::log(z) - z) / std::tgamma(a); // lgamma is no function for threads
  constexpr int most = 10000;
  if (z < a + 1)
  {
    double term = 1 / a;
    double sum = term;
    for (int k = 1; k < most && term > 1e-17 * sum; ++k)
    {
      term *= z / (a + k);
      sum += term;
    }
    return 1 - scale * sum;
  }
  double b = z + 1 - a;
  double c = 1e300;
  double d = 1 / b;
  double fraction = d;
  for (int k = 1; k < most; ++k)
  {
    const double an = -k * (k - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= d * c;
    if (std::abs(d * c - 1) < 1e-15)
      break;
  }
  return scale * fraction;
}

} // namespace lamella::statistics
