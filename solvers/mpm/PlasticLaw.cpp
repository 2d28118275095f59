#include "mpm/PlasticLaw.h"

#include "lattice/Error.h"

#include <Eigen/Eigenvalues>

#include <fmt/format.h>

#include <cmath>

namespace lamella::mpm
{
namespace
{

// Logarithmic principal strains in space and their directions: of Fe Feᵀ.
struct Principal
{
  Eigen::Vector3d strain;
  Eigen::Matrix3d direction; // columns

  [[nodiscard]] double volume() const { return std::exp(strain.sum()); }
};

Eigen::Matrix3d inSpace(const Matrix<2, double>& f, double third)
{
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m.topLeftCorner<2, 2>() << f.a[0][0], f.a[0][1], f.a[1][0], f.a[1][1];
  m(2, 2) = third;
  return m;
}

Eigen::Matrix3d inSpace(const Matrix<3, double>& f, double)
{
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&f.a[0][0]);
}

template <int Dim>
Matrix<Dim, double> part(const Eigen::Matrix3d& m)
{
  Matrix<Dim, double> r;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      r.a[i][j] = m(i, j);
  return r;
}

Principal principal(const Eigen::Matrix3d& f)
{
  // singular values rather than eigenvalues of Fe Feᵀ: small strains keep all their digits
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU);
  return { svd.singularValues().array().log().matrix(), svd.matrixU() };
}

Eigen::Matrix3d spectral(const Eigen::Vector3d& values, const Eigen::Matrix3d& direction)
{
  return direction * values.asDiagonal() * direction.transpose();
}

} // namespace

template <int Dim>
PlasticLaw<Dim>::PlasticLaw(
  const IsotropicMaterial& material, double yieldStress, double hardening, const std::string& name)
  : elastic_(isotropicLaw<3>(material, PlaneState::Strain, name))
  , yieldStress_(yieldStress)
  , hardening_(hardening)
{
  if (!(yieldStress > 0))
    throw ParameterError(fmt::format("{}: a yield stress of {} Pa", name, yieldStress),
      "it is positive; infinite for a wall that never yields");
  if (!(std::isfinite(hardening) && hardening >= 0))
    throw ParameterError(fmt::format("{}: a hardening of {} Pa", name, hardening), "it is finite and not negative");
}

template <int Dim>
double PlasticLaw<Dim>::yield(Matrix<Dim, double>& f, PlasticState& state) const
{
  const Eigen::Matrix3d trial = inSpace(f, state.acrossPlane);
  const Principal p = principal(trial);
  const double mean = p.strain.mean();
  const Eigen::Vector3d deviator = p.strain.array() - mean;
  const double q = std::sqrt(1.5) * 2 * elastic_.mu * deviator.norm();
  const double stress = yieldStress_ + hardening_ * state.strain;
  if (!(q > stress))
    return 0;
  const double flow = (q - stress) / (3 * elastic_.mu + hardening_);
  // what the flow takes from each logarithmic strain is taken from the stretch as a factor
  const Eigen::Vector3d less = -(3 * elastic_.mu * flow / q) * deviator;
  const Eigen::Matrix3d elastic = spectral(less.array().exp().matrix(), p.direction) * trial;
  f = part<Dim>(elastic);
  if constexpr (Dim == 2)
    state.acrossPlane = elastic(2, 2);
  state.strain += flow;
  return (stress + 0.5 * hardening_ * flow) * flow;
}

template <int Dim>
Matrix<Dim, double> PlasticLaw<Dim>::kirchhoff(const Matrix<Dim, double>& f, const PlasticState& state) const
{
  const Principal p = principal(inSpace(f, state.acrossPlane));
  const double all = elastic_.lambda * p.strain.sum() + elastic_.barrier.kirchhoff(p.volume());
  return part<Dim>(spectral((2 * elastic_.mu * p.strain.array() + all).matrix(), p.direction));
}

template <int Dim>
double PlasticLaw<Dim>::energy(const Matrix<Dim, double>& f, const PlasticState& state) const
{
  const Principal p = principal(inSpace(f, state.acrossPlane));
  const double sum = p.strain.sum();
  return elastic_.mu * p.strain.squaredNorm() + 0.5 * elastic_.lambda * sum * sum + elastic_.barrier.energy(p.volume());
}

template <int Dim>
double PlasticLaw<Dim>::waveModulus(const Matrix<Dim, double>& f, const PlasticState& state) const
{
  // a wave along a principal direction: λ + 2μ − τᵢ, since the stretch itself changes what a strain is
  const Principal p = principal(inSpace(f, state.acrossPlane));
  const double sum = elastic_.lambda * p.strain.sum();
  const double most = (2 * elastic_.mu * p.strain.array() + sum).abs().maxCoeff();
  return elastic_.lambda + 2 * elastic_.mu + 2 * most + elastic_.barrier.waveModulus(p.volume());
}

template class PlasticLaw<2>;
template class PlasticLaw<3>;

} // namespace lamella::mpm
