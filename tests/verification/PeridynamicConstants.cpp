// Bond constants and what a lattice makes of them, against sums computed independently.
#include "peridynamics/Material.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::peridynamics;

constexpr double pi = std::numbers::pi;

TEST(PeridynamicStencil, BondsOfANode)
{
  // the second paper's counts
  const std::array<std::int64_t, 6> bonds{ 4, 12, 28, 48, 80, 112 };
  for (int h = 1; h <= 6; ++h)
  {
    const Stencil s(2, h);
    EXPECT_EQ(s.bondsPerNode(), bonds[static_cast<std::size_t>(h - 1)]);
    EXPECT_EQ(s.layers(), h);
  }
  EXPECT_EQ(Stencil(2, 3.015).bondsPerNode(), 28);
  EXPECT_EQ(Stencil(3, 1).bondsPerNode(), 6);
  EXPECT_EQ(Stencil(3, 2).bondsPerNode(), 32);
  EXPECT_EQ(Stencil(3, 3).bondsPerNode(), 122); // points of Z³ within 3, less the origin
  const Stencil space(3, 3);
  for (const Offset& o : space.half())
    EXPECT_TRUE(o.step[2] > 0 || (o.step[2] == 0 && (o.step[1] > 0 || (o.step[1] == 0 && o.step[0] > 0))));
}

struct Known
{
  double horizon;
  double young, poisson, fracture, diagonal, toughness; // diagonal: E at 45° over E along the axes
};

// Sums over the square lattice, plane stress, by independent code; given to 3 or 4 digits.
TEST(PeridynamicConstants, OfTheSquareLattice)
{
  constexpr double none = 0;
  for (const Known& k : { Known{ 2, none, none, none, 0.60, 1.119 }, Known{ 3, 1.0644, 0.3182, 1.0261, 0.955, 1.045 },
         Known{ 4, 0.9860, 0.3170, 0.9290, 0.952, 0.957 }, Known{ 5, 1.0038, 0.3623, 1.0696, 1.089, 1.036 },
         Known{ 6, 0.9820, 0.3446, 0.9960, 1.034, 0.989 }, Known{ 8, 0.9595, 0.3406, 0.9590, 1.022, 0.959 } })
  {
    const LatticeModuli m = latticeModuli(Stencil(2, k.horizon), Continuum::PlaneStress);
    if (k.young > 0)
    {
      EXPECT_NEAR(m.youngsModulus, k.young, 5.1e-5) << k.horizon;
      EXPECT_NEAR(m.poissonsRatio, k.poisson, 5.1e-5) << k.horizon;
      EXPECT_NEAR(m.fractureEnergy, k.fracture, 5.1e-5) << k.horizon;
    }
    EXPECT_NEAR(m.youngsModulusDiagonal / m.youngsModulus, k.diagonal, k.horizon == 2 ? 5.1e-3 : 5.1e-4) << k.horizon;
    EXPECT_NEAR(m.toughness, k.toughness, 5.1e-4) << k.horizon;
  }
}

// Weights by direction make C₁₁ = 3 C₁₂ with the continuum's C₁₁; with C₄₄ = C₁₂, as of all central forces, that is an
// isotropic material with Poisson's ratio 1/3 in plane stress and 1/4 else. Sums of up to a thousand terms: round-off.
TEST(PeridynamicConstants, WeightsMakeTheLatticeIsotropic)
{
  for (const Continuum continuum : { Continuum::PlaneStress, Continuum::PlaneStrain, Continuum::Space })
    for (const double horizon : { 1.42, 1.5, 1.8, 2., 2.3, 2.5, 3., 3.015, 3.5, 4., 4.5, 5., 6., 7., 8. })
    {
      SCOPED_TRACE(horizon);
      const Stencil plain(continuum == Continuum::Space ? 3 : 2, horizon);
      const auto stencil = isotropicStencil(plain);
      ASSERT_TRUE(stencil);
      const LatticeModuli m = latticeModuli(*stencil, continuum);
      EXPECT_NEAR(m.youngsModulus, 1, 1e-13);
      EXPECT_NEAR(m.youngsModulusDiagonal, 1, 1e-13);
      EXPECT_NEAR(m.poissonsRatio, poissonsRatio(continuum), 1e-13);
      EXPECT_LT(m.worst, 1e-13);
      EXPECT_GT(latticeModuli(plain, continuum).worst, 0.01);
      for (const Offset& o : stencil->half())
      {
        EXPECT_GT(o.weight, 0.4);
        EXPECT_LT(o.weight, 1.6);
        // bonds that the cube's symmetry takes to each other are alike
        for (const Offset& p : stencil->half())
          if (std::abs(o.step[0]) == std::abs(p.step[1]) && std::abs(o.step[1]) == std::abs(p.step[2]) &&
            std::abs(o.step[2]) == std::abs(p.step[0]))
            EXPECT_NEAR(o.weight, p.weight, 1e-14);
      }
      // and fracture takes what it should, to 5 % from a horizon of 2 on (1.5 of nominal without, at worst)
      if (horizon >= 2)
        EXPECT_NEAR(m.fractureEnergy, 1, horizon < 2.5 ? 0.1 : 0.05);
    }
  // along the axes alone nothing resists shear
  EXPECT_FALSE(isotropicStencil(Stencil(2, 1)));
  EXPECT_FALSE(isotropicStencil(Stencil(3, 1.4)));
}

// The energy of a strained neighbourhood, summed bond by bond, is that of the moduli.
TEST(PeridynamicConstants, EnergyOfUniformStrain)
{
  for (const Continuum continuum : { Continuum::PlaneStress, Continuum::PlaneStrain, Continuum::Space })
  {
    const int dimension = continuum == Continuum::Space ? 3 : 2;
    const Stencil stencil(dimension, 3);
    const LatticeModuli m = latticeModuli(stencil, continuum);
    const double spacing = 0.25;
    const BondConstants b =
      bondConstants({ .youngsModulus = 70e9 }, stencil, spacing, continuum, Micromodulus::Continuum, "all");
    // uniaxial stress along an axis, then along the diagonal of x and y
    for (const bool diagonal : { false, true })
    {
      const double r = std::sqrt(0.5);
      const std::array<std::array<double, 3>, 3> axes = diagonal
        ? std::array<std::array<double, 3>, 3>{ { { r, r, 0 }, { -r, r, 0 }, { 0, 0, 1 } } }
        : std::array<std::array<double, 3>, 3>{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
      const auto energy = [&](std::array<double, 3> strain) // principal strains along `axes`
      {
        double sum = 0;
        for (const Offset& o : stencil.half())
        {
          double stretch = 0;
          for (std::size_t a = 0; a < 3; ++a)
          {
            double along = 0;
            for (std::size_t i = 0; i < 3; ++i)
              along += axes[a][i] * o.step[i] / o.length;
            stretch += strain[a] * along * along;
          }
          sum += 0.5 * b.micromodulus * stretch * stretch * o.length * spacing * std::pow(spacing, dimension);
        }
        return sum;
      };
      // the least energy over the free lateral strains is ½ E ε²; quadratic, so Newton's step from 0 is exact
      const double h = 1e-3;
      std::array<double, 3> strain{ 1e-3, 0, 0 };
      const int free = continuum == Continuum::Space ? 2 : continuum == Continuum::PlaneStress ? 1 : 0;
      for (int sweep = 0; sweep < 200; ++sweep)
        for (int a = 1; a <= free; ++a)
        {
          auto up = strain;
          auto down = strain;
          up[static_cast<std::size_t>(a)] += h;
          down[static_cast<std::size_t>(a)] -= h;
          const double slope = (energy(up) - energy(down)) / (2 * h);
          const double curve = (energy(up) - 2 * energy(strain) + energy(down)) / (h * h);
          strain[static_cast<std::size_t>(a)] -= slope / curve;
        }
      double expected = 0.5 * 70e9 * 1e-6 * (diagonal ? m.youngsModulusDiagonal : m.youngsModulus);
      if (continuum == Continuum::PlaneStrain)
      {
        // no lateral strain at all: C₁₁ of the isotropic material that has this E and the in-plane ν
        if (diagonal)
          continue;
        const double nu = m.poissonsRatio;
        expected *= (1 - nu) / ((1 + nu) * (1 - 2 * nu));
      }
      EXPECT_NEAR(energy(strain), expected, 1e-9 * expected);
    }
  }
}

TEST(PeridynamicConstants, ConvergeToTheContinuum)
{
  for (const Continuum continuum : { Continuum::PlaneStress, Continuum::PlaneStrain, Continuum::Space })
  {
    const LatticeModuli m = latticeModuli(Stencil(continuum == Continuum::Space ? 3 : 2, 8), continuum);
    EXPECT_NEAR(m.youngsModulus, 1, 0.06);
    EXPECT_NEAR(m.poissonsRatio, poissonsRatio(continuum), 0.02);
    EXPECT_NEAR(m.fractureEnergy, 1, 0.06);
  }
}

TEST(PeridynamicConstants, OfTheContinuum)
{
  const Stencil stencil(2, 3);
  const double E = 3e9;
  const double Gc = 120;
  const double h = 3e-6;
  const BondConstants stress = bondConstants({ .youngsModulus = E, .fractureEnergy = Gc }, stencil, 1e-6,
    Continuum::PlaneStress, Micromodulus::Continuum, "wall");
  EXPECT_NEAR(stress.micromodulus, 9 * E / (pi * h * h * h), 1e-12 * stress.micromodulus);
  EXPECT_NEAR(stress.criticalStretch, std::sqrt(4 * pi * Gc / (9 * E * h)), 1e-12);
  const BondConstants strain = bondConstants({ .youngsModulus = E, .fractureEnergy = Gc }, stencil, 1e-6,
    Continuum::PlaneStrain, Micromodulus::Continuum, "wall");
  EXPECT_NEAR(strain.micromodulus, 48 * E / (5 * pi * h * h * h), 1e-12 * strain.micromodulus);
  EXPECT_NEAR(strain.criticalStretch, std::sqrt(5 * pi * Gc / (12 * E * h)), 1e-12);
  const BondConstants space = bondConstants({ .youngsModulus = E, .fractureEnergy = Gc }, Stencil(3, 3), 1e-6,
    Continuum::Space, Micromodulus::Continuum, "wall");
  EXPECT_NEAR(space.micromodulus, 12 * E / (pi * h * h * h * h), 1e-12 * space.micromodulus);
  EXPECT_NEAR(space.criticalStretch, std::sqrt(5 * Gc / (9 * (2 * E / 3) * h)), 1e-12);

  // toughness and fracture energy say the same
  const BondConstants tough = bondConstants({ .youngsModulus = E, .toughness = std::sqrt(E * Gc) }, stencil, 1e-6,
    Continuum::PlaneStress, Micromodulus::Continuum, "wall");
  EXPECT_NEAR(tough.criticalStretch, stress.criticalStretch, 1e-12);
  const BondConstants toughStrain =
    bondConstants({ .youngsModulus = E, .toughness = std::sqrt(E * Gc / (1 - 1.0 / 16)) }, stencil, 1e-6,
      Continuum::PlaneStrain, Micromodulus::Continuum, "wall");
  EXPECT_NEAR(toughStrain.criticalStretch, strain.criticalStretch, 1e-12);
  EXPECT_EQ(
    bondConstants({ .youngsModulus = E }, stencil, 1e-6, Continuum::PlaneStress, Micromodulus::Continuum, "wall")
      .criticalStretch,
    std::numeric_limits<double>::infinity());
  // exact on the lattice
  const BondConstants exact =
    bondConstants({ .youngsModulus = E }, stencil, 1e-6, Continuum::PlaneStress, Micromodulus::Lattice, "wall");
  EXPECT_NEAR(exact.micromodulus * latticeModuli(stencil, Continuum::PlaneStress).youngsModulus, stress.micromodulus,
    1e-12 * stress.micromodulus);
}

TEST(PeridynamicErrors, SayTheValue)
{
  const auto message = [](const BondMaterial& m, double horizon, int dimension = 2)
  {
    try
    {
      (void)bondConstants(
        m, Stencil(dimension, horizon), 1e-6, Continuum::PlaneStress, Micromodulus::Continuum, "matrix and grain");
    }
    catch (const Error& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({ .youngsModulus = -1 }, 3), "Young's modulus of matrix and grain is -1");
  EXPECT_EQ(message({ .youngsModulus = std::nan("") }, 3), "Young's modulus of matrix and grain is nan");
  EXPECT_EQ(message({ .criticalStretch = 0 }, 3), "the critical stretch of matrix and grain is 0");
  EXPECT_EQ(message({ .fractureEnergy = -2 }, 3), "the fracture energy of matrix and grain is -2");
  EXPECT_EQ(message({ .fractureEnergy = 1, .toughness = 1 }, 3),
    "matrix and grain has more than one of fracture energy, toughness and critical stretch");
  EXPECT_EQ(message({}, 0.5), "the horizon is 0.5 spacings");
  EXPECT_EQ(message({}, 3, 3), "a stencil of 3 dimensions for plane stress");
}

} // namespace
