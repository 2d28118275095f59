#include "elasticity/ElasticConstants.h"

#include "core/Error.h"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::elasticity
{
namespace
{

constexpr const char* axes = "xyz";

} // namespace

std::vector<std::string> voigtNames(int dimension)
{
  if (dimension == 3)
    return { "xx", "yy", "zz", "yz", "xz", "xy" };
  return { "xx", "yy", "xy" };
}

std::vector<std::string> constantNames(int dimension)
{
  std::vector<std::string> names;
  for (int a = 0; a < dimension; ++a)
    names.push_back(fmt::format("E_{}", axes[a]));
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      if (a != b)
        names.push_back(fmt::format("nu_{}{}", axes[a], axes[b]));
  const std::vector<std::string> components = voigtNames(dimension);
  for (auto name = components.begin() + dimension; name != components.end(); ++name)
    names.push_back("G_" + *name);
  return names;
}

std::vector<double> constantValues(const ElasticConstants& c)
{
  std::vector<double> values = c.youngsModulus;
  values.insert(values.end(), c.poissonsRatio.begin(), c.poissonsRatio.end());
  values.insert(values.end(), c.shearModulus.begin(), c.shearModulus.end());
  return values;
}

ElasticConstants elasticConstants(std::span<const double> stiffness, int dimension, double zero)
{
  const int n = dimension == 3 ? 6 : 3;
  if ((dimension != 2 && dimension != 3) || stiffness.size() != static_cast<std::size_t>(n * n))
    throw ParameterError(fmt::format("a stiffness of {} values in {} dimensions", stiffness.size(), dimension),
      "9 values in two dimensions, 36 in three");
  if (!std::all_of(stiffness.begin(), stiffness.end(), [](double v) { return std::isfinite(v); }))
    throw ParameterError("a stiffness that is not finite has no elastic constants", "look at how it was made");
  // In Kelvin's form, shear strains times √2, eigenvalues do not depend on the axes.
  Eigen::MatrixXd c(n, n);
  const auto weight = [&](int a) { return a < dimension ? 1.0 : std::sqrt(2.0); };
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      c(a, b) = 0.5 * weight(a) * weight(b) *
        (stiffness[static_cast<std::size_t>(a * n + b)] + stiffness[static_cast<std::size_t>(b * n + a)]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(c);
  const Eigen::VectorXd& lambda = solver.eigenvalues();
  const Eigen::MatrixXd& v = solver.eigenvectors();
  const double least = zero * std::max(lambda(n - 1), 0.0);

  ElasticConstants result;
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(n); // of each unit stress
  for (int k = 0; k < n; ++k)
  {
    result.eigenvalues.push_back(lambda(k));
    if (lambda(k) > least)
    {
      compliance += v.col(k) * v.col(k).transpose() / lambda(k);
      ++result.resisting;
    }
    else
      lost += v.col(k).cwiseAbs2();
  }
  const auto resists = [&](int a) { return lost(a) < unresisted; };
  for (int a = 0; a < n; ++a)
  {
    const double modulus = resists(a) ? 1 / (weight(a) * weight(a) * compliance(a, a)) : 0;
    (a < dimension ? result.youngsModulus : result.shearModulus).push_back(modulus);
  }
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      if (a != b)
        result.poissonsRatio.push_back(
          resists(a) && resists(b) ? -compliance(b, a) / compliance(a, a) : std::numeric_limits<double>::quiet_NaN());
  return result;
}

} // namespace lamella::elasticity
