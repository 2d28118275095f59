#include "mpm/Hencky.h"

#include "mpm/SymmetricEigen.h"
#include "mpm/VolumeBarrier.h"

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

template <int Dim>
Eigen::Matrix3d inSpace(const Matrix<Dim>& F, const double* history)
{
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  m(2, 2) = Hencky::thirdStretch(history);
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      m(i, j) = F(i, j);
  return m;
}

template <int Dim>
Matrix<Dim> part(const Eigen::Matrix3d& m)
{
  Matrix<Dim> r;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      r(i, j) = m(i, j);
  return r;
}

template <int Dim>
Principal principal(const Eigen::Matrix3d& m)
{
  const SymmetricEigen<Dim> eigen(m * m.transpose());
  // one by one: three are too few for the vectors' logarithm
  return { eigen.values.unaryExpr([](double square) { return 0.5 * std::log(square); }), eigen.directions };
}

Eigen::Matrix3d spectral(const Eigen::Vector3d& values, const Eigen::Matrix3d& direction)
{
  return direction * values.asDiagonal() * direction.transpose();
}

template <int Dim>
Eigen::Matrix3d kirchhoffInSpace(const double* c, const Matrix<Dim>& F, const double* history)
{
  const Principal p = principal<Dim>(inSpace(F, history));
  const double all = c[0] * p.strain.sum() + VolumeBarrier::kirchhoff(c[2], p.volume());
  return spectral((2 * c[1] * p.strain.array() + all).matrix(), p.direction);
}

} // namespace

template <int Dim>
void Hencky::flow(const double* c, Matrix<Dim>& F, const Vector<Dim>& /*axis*/, double* history)
{
  const Eigen::Matrix3d trial = inSpace(F, history);
  const Principal p = principal<Dim>(trial);
  const Eigen::Vector3d deviator = p.strain.array() - p.strain.mean();
  const double q = std::sqrt(1.5) * 2 * c[1] * deviator.norm();
  const double limit = c[3] + c[4] * history[plasticStrain];
  if (!(q > limit))
    return;
  const double amount = (q - limit) / (3 * c[1] + c[4]);
  // what the flow takes from each logarithmic strain is taken from the stretch as a factor
  const Eigen::Vector3d less = -(3 * c[1] * amount / q) * deviator;
  const Eigen::Matrix3d elastic = spectral(less.array().exp().matrix(), p.direction) * trial;
  F = part<Dim>(elastic);
  if constexpr (Dim == 2)
    history[thirdStrain] = std::log(elastic(2, 2));
  history[plasticStrain] += amount;
  history[plasticWork] += (limit + 0.5 * c[4] * amount) * amount;
}

template <int Dim>
Matrix<Dim> Hencky::kirchhoff(const double* c, const Matrix<Dim>& F, const Vector<Dim>& /*axis*/, const double* history)
{
  return part<Dim>(kirchhoffInSpace(c, F, history));
}

double Hencky::thirdStress(const double* c, const Matrix<2>& F, const Vector<2>& /*axis*/, const double* history)
{
  return kirchhoffInSpace(c, F, history)(2, 2);
}

double Hencky::thirdStretch(const double* history)
{
  return std::exp(history[thirdStrain]);
}

template <int Dim>
double Hencky::energy(const double* c, const Matrix<Dim>& F, const Vector<Dim>& /*axis*/, const double* history)
{
  const Principal p = principal<Dim>(inSpace(F, history));
  const double sum = p.strain.sum();
  return c[1] * p.strain.squaredNorm() + 0.5 * c[0] * sum * sum + VolumeBarrier::energy(c[2], p.volume());
}

template <int Dim>
double Hencky::stiffness(const double* c, const Matrix<Dim>& F, const Vector<Dim>& /*axis*/, const double* history)
{
  // a wave along a principal direction: λ + 2μ − τᵢ, since the stretch itself changes what a strain is
  const Principal p = principal<Dim>(inSpace(F, history));
  const double sum = c[0] * p.strain.sum();
  const double most = (2 * c[1] * p.strain.array() + sum).abs().maxCoeff();
  return c[0] + 2 * c[1] + 2 * most + VolumeBarrier::stiffness(c[2], p.volume());
}

template void Hencky::flow(const double*, Matrix<2>&, const Vector<2>&, double*);
template void Hencky::flow(const double*, Matrix<3>&, const Vector<3>&, double*);
template Matrix<2> Hencky::kirchhoff(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template Matrix<3> Hencky::kirchhoff(const double*, const Matrix<3>&, const Vector<3>&, const double*);
template double Hencky::energy(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template double Hencky::energy(const double*, const Matrix<3>&, const Vector<3>&, const double*);
template double Hencky::stiffness(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template double Hencky::stiffness(const double*, const Matrix<3>&, const Vector<3>&, const double*);

} // namespace lamella::mpm
