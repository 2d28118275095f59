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

namespace
{

// The inverse of a tensor where it resists, in Kelvin's form.
struct Inverse
{
  int dimension;
  Eigen::MatrixXd compliance;
  Eigen::VectorXd eigenvalues, lost; // of each unit stress, the part along strains that nothing resists
  int resisting = 0;

  Inverse(std::span<const double> stiffness, int d, double zero)
    : dimension(d)
  {
    const int n = d == 3 ? 6 : 3;
    if ((d != 2 && d != 3) || stiffness.size() != static_cast<std::size_t>(n * n))
      throw ParameterError(fmt::format("a stiffness of {} values in {} dimensions", stiffness.size(), d),
        "9 values in two dimensions, 36 in three");
    if (!std::all_of(stiffness.begin(), stiffness.end(), [](double v) { return std::isfinite(v); }))
      throw ParameterError("a stiffness that is not finite has no elastic constants", "look at how it was made");
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(kelvin(stiffness));
    eigenvalues = solver.eigenvalues();
    const Eigen::MatrixXd& v = solver.eigenvectors();
    const double least = zero * std::max(eigenvalues(n - 1), 0.0);
    compliance = Eigen::MatrixXd::Zero(n, n);
    lost = Eigen::VectorXd::Zero(n);
    for (int k = 0; k < n; ++k)
      if (eigenvalues(k) > least)
      {
        compliance += v.col(k) * v.col(k).transpose() / eigenvalues(k);
        ++resisting;
      }
      else
        lost += v.col(k).cwiseAbs2();
  }
  [[nodiscard]] double weight(int a) const { return a < dimension ? 1.0 : std::sqrt(2.0); }
  // In Kelvin's form, shear strains times √2, eigenvalues do not depend on the axes.
  [[nodiscard]] Eigen::MatrixXd kelvin(std::span<const double> tensor) const
  {
    const int n = dimension == 3 ? 6 : 3;
    Eigen::MatrixXd c(n, n);
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        c(a, b) = 0.5 * weight(a) * weight(b) *
          (tensor[static_cast<std::size_t>(a * n + b)] + tensor[static_cast<std::size_t>(b * n + a)]);
    return c;
  }
  [[nodiscard]] bool resists(int a) const { return lost(a) < unresisted; }
};

} // namespace

ElasticConstants elasticConstants(std::span<const double> stiffness, int dimension, double zero)
{
  const Inverse inverse(stiffness, dimension, zero);
  const Eigen::MatrixXd& compliance = inverse.compliance;
  ElasticConstants result;
  result.eigenvalues.assign(inverse.eigenvalues.begin(), inverse.eigenvalues.end());
  result.resisting = inverse.resisting;
  for (int a = 0; a < compliance.rows(); ++a)
  {
    const double weight = inverse.weight(a);
    const double modulus = inverse.resists(a) ? 1 / (weight * weight * compliance(a, a)) : 0;
    (a < dimension ? result.youngsModulus : result.shearModulus).push_back(modulus);
  }
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      if (a != b)
        result.poissonsRatio.push_back(inverse.resists(a) && inverse.resists(b)
            ? -compliance(b, a) / compliance(a, a)
            : std::numeric_limits<double>::quiet_NaN());
  return result;
}

std::vector<double> constantChanges(
  std::span<const double> stiffness, std::span<const double> change, int dimension, double zero)
{
  const Inverse inverse(stiffness, dimension, zero);
  const Eigen::MatrixXd& s = inverse.compliance;
  const Eigen::MatrixXd by = -s * inverse.kelvin(change) * s; // of the compliance
  ElasticConstants changes;
  for (int a = 0; a < s.rows(); ++a)
  {
    const double weight = inverse.weight(a);
    const double own = inverse.resists(a) ? -by(a, a) / (weight * weight * s(a, a) * s(a, a)) : 0;
    (a < dimension ? changes.youngsModulus : changes.shearModulus).push_back(own);
  }
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      if (a != b)
        changes.poissonsRatio.push_back(inverse.resists(a) && inverse.resists(b)
            ? (s(b, a) / s(a, a) * by(a, a) - by(b, a)) / s(a, a)
            : std::numeric_limits<double>::quiet_NaN());
  return constantValues(changes);
}

} // namespace lamella::elasticity
