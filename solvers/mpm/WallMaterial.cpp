#include "mpm/WallMaterial.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include <Eigen/LU>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::mpm
{
namespace
{

void requirePositive(double value, const char* what, const std::string& name)
{
  if (!(std::isfinite(value) && value > 0))
    throw ParameterError(fmt::format("{}: {} is {} Pa", name, what, value), "a modulus is positive and finite");
  if (!plausible(value))
    throw ParameterError(fmt::format("{}: {} is {:g} Pa", name, what, value), "it lies between 1e-30 and 1e30 Pa");
}

// `least` < value < `most`
void requireBetween(double value, double least, double most, const char* what, const std::string& name)
{
  if (!(std::isfinite(value) && value > least && value < most))
    throw ParameterError(fmt::format("{}: {} is {}: the stiffness would not be positive definite", name, what, value),
      fmt::format("with its other constants it lies between {:.6g} and {:.6g}", least, most));
}

void requireBarrier(double value, const std::string& name)
{
  if (!(std::isfinite(value) && value >= 0))
    throw ParameterError(
      fmt::format("{}: a barrier of {}", name, value), "times the greatest stiffness: 1, or 0 for none");
}

void checkYield(double stress, double hardening, const std::string& name)
{
  if (!(stress > 0))
    throw ParameterError(fmt::format("{}: a yield stress of {} Pa", name, stress),
      "it is positive; infinite for a wall that never yields");
  if (!(std::isfinite(hardening) && hardening >= 0))
    throw ParameterError(fmt::format("{}: a hardening of {} Pa", name, hardening), "it is finite and not negative");
}

void check(const OrthotropicMaterial& m, bool third, const std::string& name)
{
  requirePositive(m.along, "Young's modulus along the axis", name);
  requirePositive(m.across, "Young's modulus across the axis", name);
  if (m.shearModulus)
    requirePositive(*m.shearModulus, "the shear modulus", name);
  const double ratio = m.along / m.across;
  if (third)
    requireBetween(m.acrossRatio, -1, 1, "Poisson's ratio among the directions across the axis", name);
  const double bound = third ? std::sqrt(ratio * (1 - m.acrossRatio) / 2) : std::sqrt(ratio);
  requireBetween(m.poissonsRatio, -bound, bound, "Poisson's ratio along the axis", name);
  if (!m.shearModulus && !(shearModulus(m) > 0 && std::isfinite(shearModulus(m))))
    throw ParameterError(fmt::format("{}: no shear modulus follows from Poisson's ratio {}", name, m.poissonsRatio),
      "give the shear modulus");
  requireBarrier(m.barrier, name);
}

// Greatest ρ₀ c² of waves in the plane of the axis and a direction across it, to about 1e-6: the greater eigenvalue of
// n·C·n over all n.
double greatestWave(double along, double across, double cross, double shear)
{
  constexpr int directions = 2000;
  double most = 0;
  for (int i = 0; i <= directions; ++i)
  {
    const double angle = 0.5 * std::numbers::pi * i / directions;
    const double cc = std::cos(angle) * std::cos(angle);
    const double ss = 1 - cc;
    const double a = along * cc + shear * ss;
    const double b = shear * cc + across * ss;
    const double ab = (cross + shear) * (cross + shear) * cc * ss;
    most = std::max(most, 0.5 * (a + b + std::sqrt((a - b) * (a - b) + 4 * ab)));
  }
  return most;
}

} // namespace

double shearModulus(const OrthotropicMaterial& m)
{
  return m.shearModulus ? *m.shearModulus : 1 / (1 / m.along + 1 / m.across + 2 * m.poissonsRatio / m.along);
}

template <int Dim>
std::array<double, Isotropic::constants> isotropicConstants(
  const IsotropicMaterial& m, PlaneState state, const std::string& name)
{
  const bool planeStress = Dim == 2 && state == PlaneState::Stress;
  requirePositive(m.youngsModulus, "Young's modulus", name);
  requireBetween(m.poissonsRatio, -1, planeStress ? 1 : 0.5, "Poisson's ratio", name);
  requireBarrier(m.barrier, name);
  const double nu = m.poissonsRatio;
  const double mu = m.youngsModulus / (2 * (1 + nu));
  const double lambda = m.youngsModulus * nu / (planeStress ? 1 - nu * nu : (1 + nu) * (1 - 2 * nu));
  return { lambda, mu, m.barrier * (lambda + 2 * mu) };
}

template <int Dim>
std::array<double, Orthotropic::constants> orthotropicConstants(
  const OrthotropicMaterial& m, PlaneState state, const std::string& name)
{
  const bool planeStress = Dim == 2 && state == PlaneState::Stress;
  check(m, !planeStress, name);
  const double shear = shearModulus(m);
  // normal stresses along the axis, across it, and across it in the third direction
  Eigen::Matrix3d compliance;
  const double cross = -m.poissonsRatio / m.along;
  const double third = -m.acrossRatio / m.across;
  compliance << 1 / m.along, cross, cross, cross, 1 / m.across, third, cross, third, 1 / m.across;
  // with no stress along the third direction its row and column of the compliance go, with no strain those of the
  // stiffness
  Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
  if (planeStress)
    c.topLeftCorner<2, 2>() = compliance.topLeftCorner<2, 2>().inverse();
  else
    c = compliance.inverse();
  const double barrier = m.barrier * std::max(c(0, 0), c(1, 1));
  const double wave = greatestWave(c(0, 0), c(1, 1), c(0, 1), shear);
  if constexpr (Dim == 2)
    return { c(0, 0), c(1, 1), c(0, 1), shear, c(1, 2), wave, barrier };
  else
  {
    const double lambda = c(1, 2);
    const double mu = 0.5 * (c(1, 1) - c(1, 2));
    const double alpha = c(0, 1) - c(1, 2);
    const double delta = shear - mu;
    const double beta = c(0, 0) - lambda - 2 * mu - 2 * alpha - 4 * delta;
    return { lambda, mu, alpha, delta, beta, std::max(wave, mu), barrier };
  }
}

std::array<double, Hencky::constants> henckyConstants(const PlasticMaterial& m, const std::string& name)
{
  const auto elastic = isotropicConstants<3>(m.elastic, PlaneState::Strain, name);
  checkYield(m.yieldStress, m.hardening, name);
  return { elastic[0], elastic[1], elastic[2], m.yieldStress, m.hardening };
}

std::array<double, Hill::constants> hillConstants(const OrthotropicPlasticMaterial& m, const std::string& name)
{
  const auto elastic = orthotropicConstants<3>(m.elastic, PlaneState::Strain, name);
  const double along = m.yieldStress;
  checkYield(along, m.hardening, name);
  const double across = m.yieldAcross.value_or(along);
  const bool never = std::isinf(along);
  if (never && ((m.yieldAcross && !std::isinf(across)) || (m.yieldShear && !std::isinf(*m.yieldShear))))
    throw ParameterError(fmt::format("{}: yields across the axis or in shear, but never along it", name),
      "give a yield stress along the axis that is finite, or none of the others");
  if (!never && !(across > 0 && across < 2 * along))
    throw ParameterError(
      fmt::format("{}: a yield stress of {} Pa across the axis, and of {} Pa along it", name, across, along),
      fmt::format("with the one along it Hill's criterion takes one between 0 and {:g} Pa", 2 * along));
  if (!never && m.yieldShear && !(*m.yieldShear > 0 && std::isfinite(*m.yieldShear)))
    throw ParameterError(
      fmt::format("{}: a yield stress of {} Pa in shear", name, *m.yieldShear), "it is positive and finite");
  const double r = never ? 1 : (along / across) * (along / across);
  const double s = never || !m.yieldShear ? 2 + r : (along / *m.yieldShear) * (along / *m.yieldShear);
  std::array<double, Hill::constants> c{};
  std::copy(elastic.begin(), elastic.end(), c.begin());
  c[Hill::yield] = along;
  c[Hill::across] = r;
  c[Hill::shear] = s;
  c[Hill::hardening] = m.hardening;
  return c;
}

template std::array<double, Isotropic::constants> isotropicConstants<2>(
  const IsotropicMaterial&, PlaneState, const std::string&);
template std::array<double, Isotropic::constants> isotropicConstants<3>(
  const IsotropicMaterial&, PlaneState, const std::string&);
template std::array<double, Orthotropic::constants> orthotropicConstants<2>(
  const OrthotropicMaterial&, PlaneState, const std::string&);
template std::array<double, Orthotropic::constants> orthotropicConstants<3>(
  const OrthotropicMaterial&, PlaneState, const std::string&);

} // namespace lamella::mpm
