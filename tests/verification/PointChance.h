#pragma once

#include "mpm/Stretch.h"
#include "mpm/WallMaterial.h"

#include <random>

namespace lamella::mpm::samples
{

inline constexpr IsotropicMaterial plain{ .youngsModulus = 3e9, .poissonsRatio = 0.3 };

template <int Dim>
class Chance
{
public:
  Matrix<Dim> turn()
  {
    Matrix<Dim> m;
    for (double& v : m.m)
      v = normal_(engine_);
    if (determinant(m) < 0)
      for (int j = 0; j < Dim; ++j)
        m(0, j) = -m(0, j);
    return rotation(m);
  }
  Vector<Dim> direction()
  {
    const Matrix<Dim> r = turn();
    Vector<Dim> v;
    for (int i = 0; i < Dim; ++i)
      v[i] = r(i, 0);
    return v;
  }
  /// Stretches between `least` and `most` along any directions, turned at will.
  Matrix<Dim> deformation(double least, double most)
  {
    Matrix<Dim> d{};
    for (int i = 0; i < Dim; ++i)
      d(i, i) = std::uniform_real_distribution<double>(least, most)(engine_);
    return product(product(turn(), d), turn());
  }

private:
  std::mt19937_64 engine_{ 7 };
  std::normal_distribution<double> normal_;
};

} // namespace lamella::mpm::samples
