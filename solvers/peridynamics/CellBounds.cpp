#include "peridynamics/CellBounds.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

/// Elongation of a bond along n under each unit strain in Voigt order.
Eigen::VectorXd elongations(const Offset& o, int dimension)
{
  const auto n = [&](std::size_t a) { return o.step[a] / o.length; };
  if (dimension == 2)
    return Eigen::Vector3d(n(0) * n(0), n(1) * n(1), n(0) * n(1));
  Eigen::VectorXd a(6);
  a << n(0) * n(0), n(1) * n(1), n(2) * n(2), n(1) * n(2), n(0) * n(2), n(0) * n(1);
  return a;
}

std::vector<double> byRows(const Eigen::MatrixXd& m)
{
  std::vector<double> values;
  for (Eigen::Index a = 0; a < m.rows(); ++a)
    for (Eigen::Index b = 0; b < m.cols(); ++b)
      values.push_back(m(a, b));
  return values;
}

/// Of the bonds of one offset whose first node this rank owns.
struct Sums
{
  double count = 0;
  double stiffness = 0; ///< Σ K
  double softness = 0;  ///< Σ 1/K
};

std::vector<Sums> sumsByOffset(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const std::size_t offsets = bonds.stencil().half().size();
  const std::int64_t rows = l.size[1] * l.size[2];
  std::vector<Sums> ofRows(static_cast<std::size_t>(rows) * offsets);
#pragma omp parallel for schedule(static)
  for (std::int64_t r = 0; r < rows; ++r)
  {
    const std::int64_t begin = l.index(0, r % l.size[1], r / l.size[1]);
    for (std::size_t o = 0; o < offsets; ++o)
    {
      Sums& sum = ofRows[static_cast<std::size_t>(r) * offsets + o];
      for (std::int64_t i = begin; i < begin + l.size[0]; ++i)
        if (bonds.kind(i, static_cast<int>(o)) != 0)
        {
          const double k = bonds.springConstant(i, static_cast<int>(o));
          sum.count += 1;
          sum.stiffness += k;
          sum.softness += 1 / k;
        }
    }
  }
  std::vector<double> flat(3 * offsets, 0.0);
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows); ++r) // in order: the same on any number of threads
    for (std::size_t o = 0; o < offsets; ++o)
    {
      const Sums& sum = ofRows[r * offsets + o];
      flat[3 * o] += sum.count;
      flat[3 * o + 1] += sum.stiffness;
      flat[3 * o + 2] += sum.softness;
    }
  bonds.communicator().sum(flat);
  std::vector<Sums> sums;
  for (std::size_t o = 0; o < offsets; ++o)
    sums.push_back({ flat[3 * o], flat[3 * o + 1], flat[3 * o + 2] });
  return sums;
}

} // namespace

CellBounds cellBounds(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const int n = l.dimension == 3 ? 6 : 3;
  const double nodes = static_cast<double>(l.global[0] * l.global[1] * l.global[2]);
  const double volume = nodes * std::pow(bonds.spacing(), l.dimension);
  const std::vector<Sums> sums = sumsByOffset(bonds);
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd uniform = Eigen::MatrixXd::Zero(n, n); // of a lattice with K₀ = w/|ξ|
  Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(n, n);
  bool complete = true;
  for (std::size_t o = 0; o < sums.size(); ++o)
  {
    const Offset& offset = bonds.stencil().half()[o];
    const double length = offset.length * bonds.spacing();
    const Eigen::VectorXd a = elongations(offset, l.dimension);
    const Eigen::MatrixXd outer = a * a.transpose() / volume;
    upper += sums[o].stiffness * length * length * outer;
    uniform += nodes * offset.weight * length * outer;
    energy += sums[o].softness * offset.weight * offset.weight * outer; // K₀² |ξ|² = w²
    complete = complete && sums[o].count == nodes;
  }
  // a lattice of bonds along the axes alone resists no shear, and its bound is zero there as where bonds are missing
  complete = complete && Eigen::FullPivLU<Eigen::MatrixXd>(energy).isInvertible();
  CellBounds result;
  result.voigt = byRows(upper);
  result.reuss = byRows(complete ? Eigen::MatrixXd(uniform * energy.inverse() * uniform) : Eigen::MatrixXd::Zero(n, n));
  return result;
}

} // namespace lamella::peridynamics
