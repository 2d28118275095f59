#include "peridynamics/PeriodicCell.h"

#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/CellPieces.h"
#include "peridynamics/multigrid/FreeBlocks.h"
#include "peridynamics/multigrid/Level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::peridynamics
{
namespace
{

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

/// Eigenvalues below this share of the largest are what an unfinished solution leaves of none.
double zeroShare(const EquilibriumOptions& options)
{
  return std::max(1e-10, 10 * options.tolerance);
}

/// Makes the tensor symmetric. @returns the largest difference that there was, over the largest component
double symmetrise(std::vector<double>& c, std::size_t n)
{
  double most = 0;
  double size = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b)
    {
      const double mean = 0.5 * (c[a * n + b] + c[b * n + a]);
      most = std::max(most, std::abs(c[a * n + b] - c[b * n + a]));
      c[a * n + b] = mean;
      c[b * n + a] = mean;
      size = std::max(size, std::abs(mean));
    }
  return size > 0 ? most / size : 0;
}

/// Loose pieces as what cannot move.
FixedComponents hold(const NodeLayout& l, const CellPieces& pieces)
{
  FixedComponents fixed(l.count());
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (pieces.loose[i] != 0)
      fixed[i] = allComponents(l.dimension);
  return fixed;
}

/// Forces of less than this share of a bond's are round-off of the displacements, which grow with the cell.
double roundOff(const NodeLayout& l)
{
  return std::max(1e-12, 4e-15 * static_cast<double>(*std::max_element(l.global.begin(), l.global.end())));
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
  if (options.strains != Strains::Small)
    throw ParameterError("a stiffness is asked of large strains", "it is that of small ones: leave large strains out");
  CellPieces pieces = findCellPieces(bonds);
  if (pieces.pieces == pieces.loosePieces)
    throw NoPathError(fmt::format("no piece of the cell goes on into the next one along any axis: it is in {} pieces "
                                  "that carry nothing",
                        pieces.pieces),
      "look at its phases; a longer horizon or more matrix would join them");
  EffectiveStiffness result;
  result.components = voigt(l.dimension);
  result.crosses = pieces.crosses;
  result.pieces = pieces.pieces;
  result.loosePieces = pieces.loosePieces;
  result.looseNodes = pieces.looseNodes;
  result.bounds = cellBounds(bonds);
  const auto n = static_cast<std::size_t>(result.components);
  result.stiffness.resize(n * n);
  double done = 0; // unit strains
  EquilibriumOptions each = options;
  if (options.progress)
    each.progress = [&](double share) { return options.progress((done + share) / static_cast<double>(n)); };
  std::optional<Equilibrium> equilibrium; // not made for a uniform cell
  double stiffest = 0;                    // force of a bond at a strain of one
  for (const BondKind& k : bonds.kinds())
    stiffest = std::max(stiffest, k.stiffness);
  const double least = roundOff(l) * stiffest * std::sqrt(static_cast<double>(bonds.solidNodes()));
  for (std::size_t c = 0; c < n; ++c, done += 1)
  {
    std::vector<double> strain(n, 0.0);
    strain[c] = 1;
    NodeField<double> total = affineField(bonds, strain);
    if (pieces.loosePieces > 0)
      for (int a = 0; a < l.dimension; ++a)
        for (std::int64_t i = 0; i < l.count(); ++i)
          if (pieces.loose[i] != 0)
            total.component(a)[i] = 0;
    NodeField<double> load(l);
    linearForce(bonds, total, load);
    NodeField<double> fluctuation(l);
    // forces that cancel but for round-off: the cell is uniform
    double square = 0;
    for (int a = 0; a < l.dimension; ++a)
      forOwn(l, [&](std::int64_t i) { square += load.component(a)[i] * load.component(a)[i]; });
    if (std::sqrt(bonds.communicator().sum(square)) > least)
    {
      if (!equilibrium)
        equilibrium.emplace(bonds, hold(l, pieces), each);
      result.solutions.push_back(equilibrium->solve(fluctuation, &load));
    }
    else
      result.solutions.emplace_back();
    for (int a = 0; a < l.dimension; ++a)
      levelKernels().axpyDouble(l.count(), 1, fluctuation.component(a), total.component(a));
    const std::vector<double> stress = meanStress(bonds, total);
    for (std::size_t r = 0; r < n; ++r)
      result.stiffness[r * n + c] = stress[r];
  }
  result.asymmetry = symmetrise(result.stiffness, n);
  result.constants = elasticity::elasticConstants(result.stiffness, l.dimension, zeroShare(options));
  return result;
}

} // namespace lamella::peridynamics
