#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Jacobi>

namespace lamella::mpm
{

/// Eigenvalues of a symmetric matrix, in no order, and their directions as columns. Of a plane (Dim = 2) the third
/// direction must be one: then a single rotation finds the others, exactly.
template <int Dim>
struct SymmetricEigen
{
  Eigen::Vector3d values;
  Eigen::Matrix3d directions;

  explicit SymmetricEigen(const Eigen::Matrix3d& m)
  {
    if constexpr (Dim == 2)
    {
      Eigen::JacobiRotation<double> rotation;
      rotation.makeJacobi(m, 0, 1);
      const double c = rotation.c();
      const double s = rotation.s();
      values << m(0, 0) - s / c * m(0, 1), m(1, 1) + s / c * m(0, 1), m(2, 2);
      directions << c, s, 0, -s, c, 0, 0, 0, 1;
    }
    else
    {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
      values = solver.eigenvalues();
      directions = solver.eigenvectors();
    }
  }
};

} // namespace lamella::mpm
