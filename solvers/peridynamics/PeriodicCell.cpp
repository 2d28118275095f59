#include "peridynamics/PeriodicCell.h"

#include "lattice/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/multigrid/Level.h"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

constexpr double roundOff = 1e-12;

template <class F>
void forOwn(const NodeLayout& l, F&& f)
{
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        f(i);
}

int voigt(int dimension)
{
  return dimension == 3 ? 6 : 3;
}

// Components of nodalStress() (xx, yy, zz, xy, yz, xz) in Voigt order.
constexpr std::array<int, 6> fromStress3{ 0, 1, 2, 4, 5, 3 };

std::array<std::array<double, 3>, 3> strainTensor(int dimension, const std::vector<double>& e)
{
  if (dimension == 2)
    return { { { e[0], e[2] / 2, 0 }, { e[2] / 2, e[1], 0 }, { 0, 0, 0 } } };
  return { { { e[0], e[5] / 2, e[4] / 2 }, { e[5] / 2, e[1], e[3] / 2 }, { e[4] / 2, e[3] / 2, e[2] } } };
}

void engineeringConstants(EffectiveStiffness& s, int dimension)
{
  const int n = s.components;
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> c(
    s.stiffness.data(), n, n);
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(0.5 * (c + c.transpose()));
  if (!(std::abs(lu.maxPivot()) > 0) || lu.rcond() < 1e-10)
    throw NoPathError("the cell has no stiffness in some direction", "does its solid reach from side to side?");
  const Eigen::MatrixXd compliance = lu.inverse();
  for (int a = 0; a < dimension; ++a)
    s.youngsModulus.push_back(1 / compliance(a, a));
  for (int a = dimension; a < n; ++a)
    s.shearModulus.push_back(1 / compliance(a, a));
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b)
      if (a != b)
        s.poissonsRatio.push_back(-compliance(b, a) / compliance(a, a));
}

} // namespace

NodeField<double> affineField(const BondLattice& bonds, const std::vector<double>& strain)
{
  const NodeLayout& l = bonds.layout();
  NodeField<double> u(l);
  const auto e = strainTensor(l.dimension, strain);
  for (std::int64_t z = -l.ghostZ(); z < l.size[2] + l.ghostZ(); ++z)
    for (std::int64_t y = -l.ghost; y < l.size[1] + l.ghost; ++y)
      for (std::int64_t x = -l.ghost; x < l.size[0] + l.ghost; ++x)
      {
        const std::array<double, 3> at{ static_cast<double>(x + l.start[0]), static_cast<double>(y + l.start[1]),
          static_cast<double>(z + l.start[2]) };
        for (int c = 0; c < l.dimension; ++c)
        {
          const auto& row = e[static_cast<std::size_t>(c)];
          u.at(c, x, y, z) = bonds.spacing() * (row[0] * at[0] + row[1] * at[1] + row[2] * at[2]);
        }
      }
  return u;
}

std::vector<double> meanStress(const BondLattice& bonds, const NodeField<double>& u)
{
  const NodeLayout& l = bonds.layout();
  const int n = voigt(l.dimension);
  NodeField<double> stress(l, n);
  nodalStress(bonds, u, stress, false);
  std::vector<double> sums(static_cast<std::size_t>(n), 0.0);
  for (int e = 0; e < n; ++e)
    forOwn(l, [&](std::int64_t i) { sums[static_cast<std::size_t>(e)] += stress.component(e)[i]; });
  bonds.communicator().sum(sums);
  const double nodes = static_cast<double>(l.global[0] * l.global[1] * l.global[2]);
  std::vector<double> mean(sums.size());
  for (std::size_t v = 0; v < mean.size(); ++v)
    mean[v] = sums[n == 6 ? static_cast<std::size_t>(fromStress3[v]) : v] / nodes;
  return mean;
}

EffectiveStiffness effectiveStiffness(const BondLattice& bonds, const EquilibriumOptions& options)
{
  const NodeLayout& l = bonds.layout();
  for (int a = 0; a < l.dimension; ++a)
    if (!bonds.periodic()[static_cast<std::size_t>(a)])
      throw ParameterError(fmt::format("the cell is not periodic along {}", "xyz"[a]), "make every side periodic");
  EffectiveStiffness result;
  result.components = voigt(l.dimension);
  const auto n = static_cast<std::size_t>(result.components);
  result.stiffness.resize(n * n);
  Equilibrium equilibrium(bonds, FixedComponents(l.count()), options);
  double stiffest = 0; // force of a bond at a strain of one
  for (const BondKind& k : bonds.kinds())
    stiffest = std::max(stiffest, k.stiffness);
  for (std::size_t c = 0; c < n; ++c)
  {
    std::vector<double> strain(n, 0.0);
    strain[c] = 1;
    NodeField<double> total = affineField(bonds, strain);
    NodeField<double> load(l);
    linearForce(bonds, total, load);
    NodeField<double> fluctuation(l);
    // forces that cancel but for round-off: the cell is uniform
    double square = 0;
    for (int a = 0; a < l.dimension; ++a)
      forOwn(l, [&](std::int64_t i) { square += load.component(a)[i] * load.component(a)[i]; });
    const double norm = std::sqrt(bonds.communicator().sum(square));
    if (norm > roundOff * stiffest * std::sqrt(static_cast<double>(bonds.solidNodes())))
      result.solutions.push_back(equilibrium.solve(fluctuation, &load));
    else
      result.solutions.emplace_back();
    for (int a = 0; a < l.dimension; ++a)
      levelKernels().axpyDouble(l.count(), 1, fluctuation.component(a), total.component(a));
    const std::vector<double> stress = meanStress(bonds, total);
    for (std::size_t r = 0; r < n; ++r)
      result.stiffness[r * n + c] = stress[r];
  }
  engineeringConstants(result, l.dimension);
  return result;
}

} // namespace lamella::peridynamics
