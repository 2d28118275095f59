#include "lbm/LanczosSpectrum.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace lamella::lbm
{

void LanczosSpectrum::restart()
{
  diagonal_.clear();
  below_.clear();
}

void LanczosSpectrum::add(double alpha, double beta)
{
  ++seen_;
  if (diagonal_.empty())
    diagonal_.push_back(1.0 / alpha);
  else
  {
    diagonal_.push_back(1.0 / alpha + beta / previousAlpha_);
    below_.push_back(std::sqrt(beta) / previousAlpha_);
  }
  previousAlpha_ = alpha;
  const auto n = static_cast<Eigen::Index>(diagonal_.size());
  const Eigen::VectorXd d = Eigen::VectorXd::Map(diagonal_.data(), n);
  const Eigen::VectorXd e = Eigen::VectorXd::Map(below_.data(), n - 1);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(d, e, Eigen::EigenvaluesOnly);
  // rounding may leave the last digits of a small one without a sign
  if (solver.info() == Eigen::Success && solver.eigenvalues()[0] > 0)
    smallest_ = std::min(smallest_, solver.eigenvalues()[0]);
}

} // namespace lamella::lbm
