#include "statistics/StressMeasure.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace lamella::statistics
{

namespace
{

double principal(const SymmetricTensor& s, int index)
{
  Eigen::Matrix3d matrix;
  matrix << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[index];
}

double vonMises(const SymmetricTensor& s)
{
  const double xy = s[0] - s[1];
  const double yz = s[1] - s[2];
  const double zx = s[2] - s[0];
  return std::sqrt((xy * xy + yz * yz + zx * zx) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

} // namespace

double measure(const SymmetricTensor& stress, StressMeasure what)
{
  switch (what)
  {
    case StressMeasure::Mean:
      return (stress[0] + stress[1] + stress[2]) / 3;
    case StressMeasure::VonMises:
      return vonMises(stress);
    case StressMeasure::Principal1:
      return principal(stress, 2); // Eigen has the smallest first
    case StressMeasure::Principal2:
      return principal(stress, 1);
    case StressMeasure::Principal3:
      return principal(stress, 0);
    default:
      return stress[static_cast<std::size_t>(what)];
  }
}

const std::vector<std::string>& stressMeasureNames()
{
  static const std::vector<std::string> names{ "xx", "yy", "zz", "xy", "yz", "xz", "mean", "von-mises", "principal-1",
    "principal-2", "principal-3" };
  return names;
}

} // namespace lamella::statistics
