#include "peridynamics/Material.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace lamella::peridynamics
{
namespace
{

constexpr double pi = std::numbers::pi;

void checkDimension(const Stencil& stencil, Continuum continuum)
{
  const int needed = continuum == Continuum::Space ? 3 : 2;
  if (stencil.dimension() != needed)
    throw ParameterError(fmt::format("a stencil of {} dimensions for {}", stencil.dimension(),
                           continuum == Continuum::Space           ? "space"
                             : continuum == Continuum::PlaneStress ? "plane stress"
                                                                   : "plane strain"),
      fmt::format("it takes one of {}", needed));
}

// c h^(d+1) / E of the continuum
double continuumFactor(Continuum continuum)
{
  switch (continuum)
  {
    case Continuum::PlaneStress:
      return 9 / pi;
    case Continuum::PlaneStrain:
      return 48 / (5 * pi);
    case Continuum::Space:
      break;
  }
  return 12 / pi;
}

// s₀² E h / Gc of the continuum
double stretchFactor(Continuum continuum)
{
  switch (continuum)
  {
    case Continuum::PlaneStress:
      return 4 * pi / 9;
    case Continuum::PlaneStrain:
      return 5 * pi / 12;
    case Continuum::Space:
      break;
  }
  return 5.0 / 6.0; // 5 Gc/(9 K h) with the bulk modulus K = 2E/3
}

/// C₁₁/E of the continuum.
double stiffnessOverYoung(int dimension)
{
  return dimension == 3 ? 1.2 : 1.125; // in plane strain it is 1.2 too, with c as much greater
}

} // namespace

double poissonsRatio(Continuum continuum) noexcept
{
  return continuum == Continuum::PlaneStress ? 1.0 / 3.0 : 0.25;
}

std::optional<Stencil> isotropicStencil(const Stencil& stencil)
{
  const int d = stencil.dimension();
  const double c = continuumFactor(d == 3 ? Continuum::Space : Continuum::PlaneStress) /
    std::pow(stencil.horizon(), d + 1) / stiffnessOverYoung(d);
  // Σ c |ξ| w n₁⁴ = 1 and Σ c |ξ| w n₁² n₂² = 1/3, means over the axes; two equations for α and β
  std::array<std::array<double, 2>, 2> m{};
  const auto fourth = [](const Offset& o)
  {
    double sum = 0;
    for (const int s : o.step)
      sum += std::pow(s / o.length, 4);
    return sum;
  };
  for (const Offset& o : stencil.half())
  {
    const double q = fourth(o);
    const std::array<double, 2> moment{ q / d, (1 - q) / (d * (d - 1)) };
    for (std::size_t row = 0; row < 2; ++row)
    {
      m[row][0] += c * o.length * moment[row];
      m[row][1] += c * o.length * moment[row] * q;
    }
  }
  const double determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  if (!(std::abs(determinant) > 1e-9 * m[0][0] * m[0][0]))
    return std::nullopt;
  const double alpha = (m[1][1] - m[0][1] / 3) / determinant;
  const double beta = (m[0][0] / 3 - m[1][0]) / determinant;
  std::vector<double> weights;
  for (const Offset& o : stencil.half())
    weights.push_back(alpha + beta * fourth(o));
  if (std::ranges::any_of(weights, [](double w) { return !(w > 0); }))
    return std::nullopt;
  return stencil.weighted(weights);
}

LatticeModuli latticeModuli(const Stencil& stencil, Continuum continuum)
{
  checkDimension(stencil, continuum);
  const int dimension = stencil.dimension();
  const double h = stencil.horizon();
  // of a continuum with E = 1, Gc = 1 on a lattice of spacing 1
  const double c = continuumFactor(continuum) / std::pow(h, dimension + 1);
  const double s0 = std::sqrt(stretchFactor(continuum) / h);
  double c11 = 0;
  double c12 = 0;
  double fracture = 0;
  for (const Offset& o : stencil.half())
  {
    const double nx = o.step[0] / o.length;
    const double ny = o.step[1] / o.length;
    c11 += c * o.weight * o.length * nx * nx * nx * nx; // ½ c over both halves
    c12 += c * o.weight * o.length * nx * nx * ny * ny;
    fracture += std::abs(o.step[1]) * 0.5 * c * o.weight * o.length * s0 * s0;
  }
  const auto young = [&](double a, double b) // of stiffnesses along and between two directions
  {
    if (continuum == Continuum::PlaneStress)
      return a - b * b / a;
    const double nu = b / (a + b);
    return a * (1 + nu) * (1 - 2 * nu) / (1 - nu);
  };
  LatticeModuli m;
  m.youngsModulus = young(c11, c12);
  m.poissonsRatio = continuum == Continuum::PlaneStress ? c12 / c11 : c12 / (c11 + c12);
  m.fractureEnergy = fracture;
  m.toughness = std::sqrt(m.youngsModulus * m.fractureEnergy);
  // strains in which nothing else is stressed: in all directions alike, along the axes, and between them; over what
  // the continuum resists them with
  const double axial = continuum == Continuum::PlaneStrain ? 1.2 : stiffnessOverYoung(dimension);
  for (const double share :
    { (c11 + (dimension - 1) * c12) / (axial * (dimension + 2) / 3), (c11 - c12) / (axial * 2 / 3), c12 / (axial / 3) })
    m.worst = std::max(m.worst, std::abs(share - 1));
  // Bonds along lines: the shear stiffness equals c12 (Cauchy's relation). Turned by 45° in the plane:
  const double along = 0.5 * (c11 + c12) + c12;
  const double between = 0.5 * (c11 + c12) - c12;
  if (continuum == Continuum::Space)
  {
    // a cubic material: 1/E = S₁₁ − (S₁₁ − S₁₂ − S₄₄/2)/2 along [110]
    const double s11 = (c11 + c12) / ((c11 - c12) * (c11 + 2 * c12));
    const double s12 = -c12 / ((c11 - c12) * (c11 + 2 * c12));
    m.youngsModulusDiagonal = 1 / (s11 - 0.5 * (s11 - s12 - 0.5 / c12));
  }
  else if (continuum == Continuum::PlaneStress)
    m.youngsModulusDiagonal = young(along, between);
  else
  {
    // with no strain across the plane E is that of the isotropic material which has this stiffness in the plane
    const double nu = between / (along + between);
    m.youngsModulusDiagonal = along * (1 + nu) * (1 - 2 * nu) / (1 - nu);
  }
  return m;
}

BondConstants bondConstants(const BondMaterial& material, const Stencil& stencil, double spacing, Continuum continuum,
  Micromodulus micromodulus, const std::string& name)
{
  checkDimension(stencil, continuum);
  const auto positive = [&](double value, const char* what)
  {
    if (!(value > 0) || !std::isfinite(value))
      throw ParameterError(
        fmt::format("{} of {} is {}", what, name, value), "it must be a positive number, in SI units");
    if (!plausible(value))
      throw ParameterError(fmt::format("{} of {} is {:g}, which is not between 1e-30 and 1e30", what, name, value),
        "it is in SI units; no material has this");
  };
  positive(spacing, "the spacing");
  positive(material.youngsModulus, "Young's modulus");
  const int known =
    (material.fractureEnergy ? 1 : 0) + (material.toughness ? 1 : 0) + (material.criticalStretch ? 1 : 0);
  if (known > 1)
    throw ParameterError(fmt::format("{} has more than one of fracture energy, toughness and critical stretch", name),
      "give one: the others follow from it");

  const double h = stencil.horizon() * spacing;
  BondConstants constants;
  constants.micromodulus = continuumFactor(continuum) * material.youngsModulus / std::pow(h, stencil.dimension() + 1);
  if (micromodulus == Micromodulus::Lattice)
    constants.micromodulus /= latticeModuli(stencil, continuum).youngsModulus;

  constants.criticalStretch = std::numeric_limits<double>::infinity();
  std::optional<double> energy = material.fractureEnergy;
  if (energy)
    positive(*energy, "the fracture energy");
  if (material.toughness)
  {
    positive(*material.toughness, "the toughness");
    const double nu = poissonsRatio(continuum);
    const double constraint = continuum == Continuum::PlaneStress ? 1 : 1 - nu * nu;
    energy = *material.toughness * *material.toughness * constraint / material.youngsModulus;
  }
  if (energy)
    constants.criticalStretch = std::sqrt(stretchFactor(continuum) * *energy / (material.youngsModulus * h));
  if (material.criticalStretch)
  {
    positive(*material.criticalStretch, "the critical stretch");
    constants.criticalStretch = *material.criticalStretch;
  }
  return constants;
}

} // namespace lamella::peridynamics
