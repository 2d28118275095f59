#include "packing/Packing.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

namespace lamella::packing
{
namespace
{

// (largest − smallest) / sum of the principal values of a symmetric tensor's first dimension × dimension entries
double anisotropy(const std::array<double, 9>& tensor, int dimension)
{
  Eigen::MatrixXd m(dimension, dimension);
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      m(a, b) = 0.5 * (tensor[static_cast<std::size_t>(3 * a + b)] + tensor[static_cast<std::size_t>(3 * b + a)]);
  const Eigen::VectorXd values =
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues();
  const double sum = values.sum();
  return sum == 0 ? 0 : (values[dimension - 1] - values[0]) / sum;
}

} // namespace

double Packing::volume() const noexcept
{
  return size[0] * size[1] * (dimension == 3 ? size[2] : 1.0);
}

double Packing::grainVolume(std::size_t grain) const noexcept
{
  const double r = radius[grain];
  return dimension == 2 ? std::numbers::pi * r * r : 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

PackingStatistics statistics(const Packing& packing, bool friction)
{
  PackingStatistics s;
  const auto last = static_cast<std::size_t>(packing.dimension - 1);
  double grains = 0;
  for (std::size_t i = 0; i < packing.count(); ++i)
    grains += packing.grainVolume(i);
  s.packingFraction = grains / packing.volume();
  s.aspect = packing.size[last] / packing.size[0];

  s.rattler.assign(packing.count(), 0);
  const int needed = friction ? 2 : packing.dimension + 1;
  const auto held = [&](const Contact& c)
  {
    return s.rattler[static_cast<std::size_t>(c.first)] == 0 &&
      (c.second < 0 || s.rattler[static_cast<std::size_t>(c.second)] == 0);
  };
  for (bool changed = true; changed;)
  {
    changed = false;
    std::vector<int> number(packing.count(), 0);
    for (const Contact& c : packing.contacts)
      if (held(c))
      {
        ++number[static_cast<std::size_t>(c.first)];
        if (c.second >= 0)
          ++number[static_cast<std::size_t>(c.second)];
      }
    for (std::size_t i = 0; i < number.size(); ++i)
      if (s.rattler[i] == 0 && number[i] < needed)
      {
        s.rattler[i] = 1;
        ++s.rattlers;
        changed = true;
      }
  }

  for (const Contact& c : packing.contacts)
  {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        s.stress[3 * a + b] += c.force[a] * c.branch[b] / packing.volume();
    if (!held(c))
      continue;
    if (c.second < 0)
    {
      ++s.wallContacts;
      continue;
    }
    ++s.grainContacts;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        s.fabric[3 * a + b] += c.normal[a] * c.normal[b];
  }
  if (s.grainContacts > 0)
    for (double& value : s.fabric)
      value /= static_cast<double>(s.grainContacts);
  const auto holding = static_cast<double>(packing.count() - static_cast<std::size_t>(s.rattlers));
  if (holding > 0)
    s.coordination = static_cast<double>(2 * s.grainContacts + s.wallContacts) / holding;
  s.fabricAnisotropy = anisotropy(s.fabric, packing.dimension);
  s.stressAnisotropy = anisotropy(s.stress, packing.dimension);
  return s;
}

} // namespace lamella::packing
