#include "mpm/Hill.h"

#include "mpm/Orthotropic.h"
#include "mpm/SymmetricEigen.h"
#include "mpm/VolumeBarrier.h"

#include <algorithm>
#include <cmath>

namespace lamella::mpm
{
namespace
{

using Tensor = Eigen::Matrix3d;

template <int Dim>
Tensor wholeOf(const Matrix<Dim>& F)
{
  Tensor m = Tensor::Identity();
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      m(i, j) = F(i, j);
  return m;
}

template <int Dim>
Vector<3> wholeOf(const Vector<Dim>& axis)
{
  Vector<3> a{};
  for (int i = 0; i < Dim; ++i)
    a[i] = axis[i];
  return a;
}

Tensor plasticOf(const double* history)
{
  const double* const p = history + Hill::plasticTensor;
  Tensor e;
  e << p[0], p[4], p[3], p[4], p[1], p[2], p[3], p[2], -p[0] - p[1];
  return e;
}

// Squares of the stretches and their directions before they moved.
struct Stretches
{
  Eigen::Vector3d square;
  Tensor direction; // columns

  template <int Dim>
  explicit Stretches(const Matrix<Dim>& F)
  {
    const Tensor f = wholeOf(F);
    const SymmetricEigen<Dim> eigen(f.transpose() * f);
    square = eigen.values;
    direction = eigen.directions;
  }
  [[nodiscard]] Tensor strain() const
  {
    // one by one: three are too few for the vectors' logarithm
    const Eigen::Vector3d logarithm = square.unaryExpr([](double s) { return 0.5 * std::log(s); });
    return direction * logarithm.asDiagonal() * direction.transpose();
  }
};

Tensor hooke(const double* c, const Tensor& e, const Vector<3>& axis)
{
  Matrix<3> strain;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      strain(i, j) = e(i, j);
  const Matrix<3> t = Orthotropic::hooke<3>(c, strain, axis);
  Tensor stress;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      stress(i, j) = t(i, j);
  return stress;
}

// S = T : 2 ∂E/∂(FᵀF): on the stretches' directions each component times a divided difference of the logarithm.
Tensor secondPiola(const Stretches& u, const Tensor& T)
{
  Tensor s = u.direction.transpose() * T * u.direction;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
    {
      const double apart = u.square[i] / u.square[j] - 1;
      s(i, j) *= (apart == 0 ? 1 : std::log1p(apart) / apart) / u.square[j];
    }
  return u.direction * s * u.direction.transpose();
}

template <int Dim>
Tensor kirchhoffInSpace(const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history)
{
  const Stretches u(F);
  const Tensor T = hooke(c, u.strain() - plasticOf(history), wholeOf(axis));
  const Tensor f = wholeOf(F);
  Tensor tau = f * secondPiola(u, T) * f.transpose();
  tau.diagonal().array() += VolumeBarrier::kirchhoff(c[Hill::barrier], determinant(F));
  return tau;
}

// What of T makes it yield falls into three parts that flow on their own: T₁₁ less the mean across; what differs across
// the axis; shear along it.
struct Modes
{
  double axial = 0; // T₁₁ − ½ (T₂₂ + T₃₃)
  Tensor across;    // without mean
  Tensor shear;

  Modes(const Tensor& T, const Eigen::Vector3d& a)
  {
    const Tensor along = a * a.transpose();
    const Tensor rest = Tensor::Identity() - along;
    const double own = a.dot(T * a);
    const double mean = 0.5 * (T.trace() - own);
    axial = own - mean;
    across = rest * T * rest - mean * rest;
    shear = along * T * rest;
    shear += shear.transpose().eval();
  }
};

} // namespace

template <int Dim>
void Hill::flow(const double* c, Matrix<Dim>& F, const Vector<Dim>& axis, double* history)
{
  const Vector<3> direction = wholeOf(axis);
  const Eigen::Vector3d a(direction[0], direction[1], direction[2]);
  const Tensor trial = Stretches(F).strain() - plasticOf(history);
  const Modes modes(hooke(c, trial, direction), a);
  // q² = Σ part / (1 + rate x)², x = Δε̄/q, as stress over q is what flows: each part is divided by 1 + rate x
  const double uniaxial = c[0] + 2 * c[1] + 2 * c[2] + 4 * c[3] + c[4]; // C₁₁ − 2 C₁₂ + ½ (C₂₂ + C₂₃)
  const double weights[3] = { 1, 0.5 * (4 * c[Hill::across] - 1), 0.5 * c[Hill::shear] };
  const double parts[3] = { modes.axial * modes.axial, weights[1] * modes.across.squaredNorm(),
    weights[2] * modes.shear.squaredNorm() };
  const double rates[3] = { uniaxial - 2 * (c[0] + c[2]) + c[0] + c[1], 2 * c[1] * weights[1],
    2 * (c[1] + c[3]) * weights[2] };
  const double limit = c[yield] + c[hardening] * history[plasticStrain];
  const auto stress = [&](double x)
  {
    double sum = 0;
    for (int m = 0; m < 3; ++m)
      sum += parts[m] / ((1 + rates[m] * x) * (1 + rates[m] * x));
    return std::sqrt(sum);
  };
  const double first = stress(0);
  if (!(first > limit))
    return;
  // (1 − H x) q(x) = limit: falling, between where all parts would flow as the fastest and as the slowest
  const auto among = [&](double rate) { return (first - limit) / (limit * rate + c[hardening] * first); };
  double low = among(*std::max_element(rates, rates + 3));
  double high = among(*std::min_element(rates, rates + 3));
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i)
  {
    // of the middle and the chord's zero, by turns: the one always halves, the other is soon exact
    const auto excess = [&](double x) { return (1 - c[hardening] * x) * stress(x) - limit; };
    const double above = excess(low);
    const double below = excess(high);
    const double chord = above > below ? low + (high - low) * above / (above - below) : low;
    const double x = i % 2 == 0 ? std::clamp(chord, low, high) : 0.5 * (low + high);
    (excess(x) > 0 ? low : high) = x;
  }
  const double x = 0.5 * (low + high);
  const double amount = x * stress(x);
  const Tensor along = a * a.transpose();
  const Tensor uniform = 1.5 * along - 0.5 * Tensor::Identity(); // 1 along, −½ across
  const Tensor flowed = x *
    (modes.axial / (1 + rates[0] * x) * uniform + weights[1] / (1 + rates[1] * x) * modes.across +
      weights[2] / (1 + rates[2] * x) * modes.shear);
  const int places[5][2] = { { 0, 0 }, { 1, 1 }, { 1, 2 }, { 0, 2 }, { 0, 1 } };
  for (int i = 0; i < 5; ++i)
    history[plasticTensor + i] += flowed(places[i][0], places[i][1]);
  history[plasticStrain] += amount;
  history[plasticWork] += (limit + 0.5 * c[hardening] * amount) * amount;
}

template <int Dim>
Matrix<Dim> Hill::kirchhoff(const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history)
{
  const Tensor tau = kirchhoffInSpace(c, F, axis, history);
  Matrix<Dim> part;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      part(i, j) = tau(i, j);
  return part;
}

double Hill::thirdStress(const double* c, const Matrix<2>& F, const Vector<2>& axis, const double* history)
{
  return kirchhoffInSpace(c, F, axis, history)(2, 2);
}

double Hill::thirdStretch(const double* /*history*/)
{
  return 1;
}

template <int Dim>
double Hill::energy(const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history)
{
  const Tensor e = Stretches(F).strain() - plasticOf(history);
  return 0.5 * e.cwiseProduct(hooke(c, e, wholeOf(axis))).sum() + VolumeBarrier::energy(c[barrier], determinant(F));
}

template <int Dim>
double Hill::stiffness(const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history)
{
  // as Hencky's: a logarithmic strain changes by no more than the velocity gradient, and stress turns and stretches
  const Stretches u(F);
  const Tensor T = hooke(c, u.strain() - plasticOf(history), wholeOf(axis));
  return c[wave] + 2 * T.norm() + VolumeBarrier::stiffness(c[barrier], determinant(F));
}

template void Hill::flow(const double*, Matrix<2>&, const Vector<2>&, double*);
template void Hill::flow(const double*, Matrix<3>&, const Vector<3>&, double*);
template Matrix<2> Hill::kirchhoff(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template Matrix<3> Hill::kirchhoff(const double*, const Matrix<3>&, const Vector<3>&, const double*);
template double Hill::energy(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template double Hill::energy(const double*, const Matrix<3>&, const Vector<3>&, const double*);
template double Hill::stiffness(const double*, const Matrix<2>&, const Vector<2>&, const double*);
template double Hill::stiffness(const double*, const Matrix<3>&, const Vector<3>&, const double*);

} // namespace lamella::mpm
