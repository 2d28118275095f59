#include "elasticity/Materials.h"

#include "core/Error.h"
#include "elasticity/ElasticKernels.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::elasticity
{
namespace
{

using Tensor = Eigen::Matrix<double, 6, 6>;

PhaseStiffness triangleOf(const Eigen::MatrixXd& c)
{
  PhaseStiffness values;
  for (Eigen::Index i = 0; i < c.rows(); ++i)
    for (Eigen::Index j = i; j < c.cols(); ++j)
      values.push_back(0.5 * (c(i, j) + c(j, i)));
  return values;
}

Eigen::MatrixXd matrixOf(const PhaseStiffness& values, int n)
{
  Eigen::MatrixXd c(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      c(i, j) = values[static_cast<std::size_t>(triangle(n, i, j))];
  return c;
}

// Compliance with the axis along x.
Tensor alongX(const TransverseMaterial& m)
{
  Tensor s = Tensor::Zero();
  s(0, 0) = 1 / m.youngAlong;
  s(1, 1) = s(2, 2) = 1 / m.youngAcross;
  s(0, 1) = s(1, 0) = s(0, 2) = s(2, 0) = -m.poissonAlong / m.youngAlong;
  s(1, 2) = s(2, 1) = -m.poissonAcross / m.youngAcross;
  s(3, 3) = 2 * (1 + m.poissonAcross) / m.youngAcross;
  s(4, 4) = s(5, 5) = 1 / m.shearAlong;
  return s;
}

} // namespace

PhaseStiffness voidStiffness(Continuum continuum)
{
  return PhaseStiffness(static_cast<std::size_t>(stiffnessSize(dimensionOf(continuum))), 0.0);
}

PhaseStiffness inPlane(Continuum continuum, const PhaseStiffness& space)
{
  if (continuum == Continuum::Space)
    return space;
  const Eigen::MatrixXd c = matrixOf(space, 6);
  const std::array<Eigen::Index, 3> in{ 0, 1, 5 };
  const std::array<Eigen::Index, 3> out{ 2, 3, 4 };
  Eigen::MatrixXd plane = c(in, in);
  if (continuum == Continuum::PlaneStress) // strains out of the plane are such that stresses there vanish
    plane -= c(in, out) * c(out, out).inverse() * c(out, in);
  return triangleOf(plane);
}

void requireStable(Continuum continuum, const PhaseStiffness& stiffness, const char* whose)
{
  const int d = dimensionOf(continuum);
  if (stiffness.size() != static_cast<std::size_t>(stiffnessSize(d)))
    throw ParameterError(fmt::format("{} numbers for the stiffness of {}", stiffness.size(), whose),
      fmt::format("give the {} of the upper triangle", stiffnessSize(d)));
  if (!std::ranges::all_of(stiffness, [](double c) { return std::isfinite(c); }))
    throw ParameterError(fmt::format("the stiffness of {} is not finite", whose), "give finite moduli");
  if (std::ranges::all_of(stiffness, [](double c) { return c == 0; }))
    return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(matrixOf(stiffness, voigtSize(d)), Eigen::EigenvaluesOnly);
  const double least = modes.eigenvalues().minCoeff();
  if (!(least > 1e-12 * modes.eigenvalues().maxCoeff()))
    throw ParameterError(
      fmt::format("the stiffness of {} is not positive definite: some strain has the stiffness {:g} Pa", whose, least),
      "take smaller Poisson's ratios, or larger moduli in the directions that are soft");
}

PhaseStiffness isotropicStiffness(Continuum continuum, double young, double poisson)
{
  const double most = continuum == Continuum::PlaneStress ? 1 : 0.5;
  if (!(young > 0) || !std::isfinite(young))
    throw ParameterError(
      fmt::format("a Young's modulus of {} Pa", young), "give one above 0, or make the phase a void");
  if (!(poisson > -1 && poisson < most))
    throw ParameterError(fmt::format("a Poisson's ratio of {}", poisson),
      fmt::format("it lies above -1 and below {}: 0.49 is nearly incompressible", most));
  const double shear = young / (2 * (1 + poisson));
  const double lambda =
    young * poisson / ((1 + poisson) * (continuum == Continuum::PlaneStress ? 1 - poisson : 1 - 2 * poisson));
  const int d = dimensionOf(continuum);
  const int n = voigtSize(d);
  PhaseStiffness values;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j)
      values.push_back((i < d && j < d ? lambda : 0.0) + (i == j ? (i < d ? 2 * shear : shear) : 0.0));
  return values;
}

std::array<std::array<double, 5>, 2> isotropicChanges(Continuum continuum, double young, double poisson)
{
  const bool stress = continuum == Continuum::PlaneStress;
  const double across = stress ? 1 - poisson : 1 - 2 * poisson;
  const double lambda = poisson / ((1 + poisson) * across);
  const double mu = 1 / (2 * (1 + poisson));
  const double square = (1 + poisson) * across * (1 + poisson) * across;
  return { { { lambda, mu, 0, 0, 0 },
    { young * (1 + (stress ? 1 : 2) * poisson * poisson) / square, -2 * young * mu * mu, 0, 0, 0 } } };
}

PhaseStiffness transverseStiffness(
  Continuum continuum, const TransverseMaterial& m, const std::array<double, 3>& direction)
{
  Eigen::Vector3d axis(direction[0], direction[1], direction[2]);
  if (!(axis.norm() > 0) || !axis.allFinite())
    throw ParameterError("an axis without direction", "give each voxel of such a phase an axis");
  if (!(m.youngAlong > 0 && m.youngAcross > 0 && m.shearAlong > 0))
    throw ParameterError(
      fmt::format("moduli of {} Pa along, {} Pa across and {} Pa in shear", m.youngAlong, m.youngAcross, m.shearAlong),
      "give all of them, above 0");
  const Tensor s = alongX(m);
  const PhaseStiffness straight = triangleOf(s.inverse());
  requireStable(Continuum::Space, straight, "a phase with an axis");
  // turned by Bond's matrix
  axis.normalize();
  const Eigen::Matrix3d q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), axis).toRotationMatrix();
  Tensor bond;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int l = k; l < 3; ++l)
          bond(voigt(3, i, j), voigt(3, k, l)) = k == l ? q(i, k) * q(j, k) : q(i, k) * q(j, l) + q(i, l) * q(j, k);
  return inPlane(continuum, triangleOf(bond * matrixOf(straight, 6) * bond.transpose()));
}

std::array<double, 5> axialParts(int dimension, const PhaseStiffness& c)
{
  const int n = voigtSize(dimension);
  const auto at = [&](int i, int j) { return c[static_cast<std::size_t>(triangle(n, i, j))]; };
  if (dimension == 2)
  {
    const double mu = at(2, 2);
    const double lambda = at(1, 1) - 2 * mu;
    const double alpha = at(0, 1) - lambda;
    return { lambda, mu, alpha, at(0, 0) - lambda - 2 * mu - 2 * alpha, 0 };
  }
  const double mu = at(3, 3);
  const double lambda = at(1, 2);
  const double alpha = at(0, 1) - lambda;
  const double gamma = at(5, 5) - mu;
  return { lambda, mu, alpha, at(0, 0) - lambda - 2 * mu - 2 * alpha - 4 * gamma, gamma };
}

std::array<double, 5> axialModuli(Continuum continuum, const TransverseMaterial& material)
{
  return axialParts(dimensionOf(continuum), transverseStiffness(continuum, material, { 1, 0, 0 }));
}

std::array<std::array<double, 5>, 5> transverseChanges(Continuum continuum, const TransverseMaterial& m)
{
  // how the compliance along the axis changes with each; then dC = −C dS C
  std::array<Tensor, 5> by;
  by.fill(Tensor::Zero());
  const double along = 1 / m.youngAlong;
  const double across = 1 / m.youngAcross;
  const auto set = [](Tensor& s, int i, int j, double value) { s(i, j) = s(j, i) = value; };
  by[0](0, 0) = -along * along;
  set(by[0], 0, 1, m.poissonAlong * along * along);
  set(by[0], 0, 2, m.poissonAlong * along * along);
  by[1](1, 1) = by[1](2, 2) = -across * across;
  set(by[1], 1, 2, m.poissonAcross * across * across);
  by[1](3, 3) = -2 * (1 + m.poissonAcross) * across * across;
  set(by[2], 0, 1, -along);
  set(by[2], 0, 2, -along);
  set(by[3], 1, 2, -across);
  by[3](3, 3) = 2 * across;
  by[4](4, 4) = by[4](5, 5) = -1 / (m.shearAlong * m.shearAlong);
  const Tensor s = alongX(m);
  const std::array<Eigen::Index, 3> in{ 0, 1, 5 };
  std::array<std::array<double, 5>, 5> changes{};
  for (std::size_t k = 0; k < by.size(); ++k)
  {
    Eigen::MatrixXd change;
    if (continuum == Continuum::PlaneStress) // the compliance's part in the plane is the plane's
    {
      const Eigen::Matrix3d c = s(in, in).inverse();
      change = -c * by[k](in, in) * c;
    }
    else
    {
      const Tensor c = s.inverse();
      change = -c * by[k] * c;
      if (continuum == Continuum::PlaneStrain)
        change = Eigen::MatrixXd(change(in, in));
    }
    changes[k] = axialParts(dimensionOf(continuum), triangleOf(change));
  }
  return changes;
}

std::array<double, 2> planeExpansion(
  Continuum continuum, const TransverseMaterial& m, const std::array<double, 2>& expansion)
{
  const auto [along, across] = expansion;
  if (continuum != Continuum::PlaneStrain)
    return expansion;
  // the third direction, across the axis, would expand as well, and is not let
  return { along + m.poissonAlong * m.youngAcross / m.youngAlong * across, (1 + m.poissonAcross) * across };
}

AcrossPlane acrossPlane(Continuum continuum, const TransverseMaterial& m, const std::array<double, 2>& expansion)
{
  const double along = m.poissonAlong / m.youngAlong;
  const double across = m.poissonAcross / m.youngAcross;
  if (continuum == Continuum::PlaneStress)
    return { { -along, -across, 0 }, expansion[1] };
  // strain zz = 0 = −ν σ_along/E_along − ν' σ_across/E_across + σ_zz/E_across + expansion
  return { { along * m.youngAcross, across * m.youngAcross, 0 }, -m.youngAcross * expansion[1] };
}

AcrossPlane acrossPlane(Continuum continuum, const PhaseStiffness& space, double expansion)
{
  const Eigen::MatrixXd c = matrixOf(space, 6);
  const std::array<Eigen::Index, 3> in{ 0, 1, 5 };
  const Eigen::Index zz = 2;
  if (continuum == Continuum::PlaneStress)
  {
    const Eigen::MatrixXd s = c.inverse();
    return { { s(zz, 0), s(zz, 1), s(zz, 5) }, expansion };
  }
  const Eigen::RowVector3d by = c(zz, in) * c(in, in).inverse();
  return { { by(0), by(1), by(2) }, (by.dot(c(in, zz).col(0)) - c(zz, zz)) * expansion };
}

std::array<double, 3> planeExpansion(Continuum continuum, const PhaseStiffness& space, double expansion)
{
  std::array<double, 3> free{ expansion, expansion, 0 };
  if (continuum != Continuum::PlaneStrain)
    return free;
  const Eigen::MatrixXd c = matrixOf(space, 6);
  const std::array<Eigen::Index, 3> in{ 0, 1, 5 };
  const Eigen::Vector3d more = c(in, in).inverse() * c(in, Eigen::Index{ 2 });
  for (std::size_t k = 0; k < 3; ++k)
    free[k] += expansion * more(static_cast<Eigen::Index>(k));
  return free;
}

} // namespace lamella::elasticity
