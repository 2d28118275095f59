// Elastic constants by direction, and the least and the most of them, against closed forms: isotropic tensors, cubic
// crystals, a wood that is the same in all directions across its axis, and what is a mechanism.
#include "elasticity/DirectionalConstants.h"
#include "elasticity/ElasticKernels.h"
#include "elasticity/Materials.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace
{

using namespace lamella::elasticity;
using Vector = std::array<double, 3>;

std::vector<double> rowsOf(int d, const PhaseStiffness& triangleOf)
{
  const int n = voigtSize(d);
  std::vector<double> rows;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      rows.push_back(triangleOf[static_cast<std::size_t>(triangle(n, i, j))]);
  return rows;
}

double dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Angles of a direction with the box's axes, cosines without their signs, rising: the same of all that a cubic crystal
/// takes for the same.
Vector family(Vector v)
{
  for (double& c : v)
    c = std::abs(c);
  std::sort(v.begin(), v.end());
  return v;
}

void expectNear(const Vector& found, const Vector& expected, double tolerance)
{
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(found[a], expected[a], tolerance) << a;
}

// Inverses of tensors with moduli of 1 to 10 are exact to 1e-14; 1e-12 leaves room for sums.
constexpr double rounding = 1e-12;

TEST(DirectionalConstants, AreTheSameOfAnIsotropicTensor)
{
  const double young = 3;
  const double poisson = 0.3;
  for (const int d : { 2, 3 })
  {
    SCOPED_TRACE(d);
    const std::vector<double> c =
      rowsOf(d, isotropicStiffness(d == 3 ? Continuum::Space : Continuum::PlaneStress, young, poisson));
    const DirectionalConstants constants(c, d);
    const ConstantsAlong here = constants({ 0.3, -2, 0.7 });
    const ConstantExtremes all = constants.extremes();
    EXPECT_NEAR(here.young, young, rounding);
    for (std::size_t most = 0; most < 2; ++most)
    {
      EXPECT_NEAR(here.shear[most], young / 2.6, rounding);
      EXPECT_NEAR(here.poisson[most], poisson, rounding);
      EXPECT_NEAR(all.young[most].value, young, rounding);
      EXPECT_NEAR(all.shear[most].value, young / 2.6, rounding);
      EXPECT_NEAR(all.poisson[most].value, poisson, rounding);
      EXPECT_EQ(all.young[most].along, (Vector{ 1, 0, 0 })); // of all that are alike, one with a name
      EXPECT_NEAR(dot(all.shear[most].along, all.shear[most].across), 0, rounding);
    }
  }
}

// Copper (168.4, 121.4, 75.4 GPa: Simmons & Wang, Single Crystal Elastic Constants, 1971). With J = S11 − S12 − S44/2:
// 1/E = S11 − 2 J Σ n_i² n_j², −ν/E = S12 + J Σ n_i² m_i², 1/G = S44 + 4 J Σ n_i² m_i². J is above 0, so E is least
// along 100 and most along 111, G most where Σ n_i² m_i² is 0 (n = 100) and least where it is 1/2 (110 and 1−10).
// Extremes are looked for to 1e-7 in direction, that is 1e-14 in value; directions along named ones are exact.
TEST(DirectionalConstants, AreACubicCrystals)
{
  const Eigen::Matrix2d sums{ { 168.4, 2 * 121.4 }, { 121.4, 168.4 + 121.4 } };
  const Eigen::Vector2d s = sums.inverse() * Eigen::Vector2d(1, 0); // S11, S12
  const double s11 = s(0);
  const double s12 = s(1);
  const double s44 = 1 / 75.4;
  const double j = s11 - s12 - s44 / 2;
  const PhaseStiffness crystal{ 168.4, 121.4, 121.4, 0, 0, 0, 168.4, 121.4, 0, 0, 0, 168.4, 0, 0, 0, 75.4, 0, 0, 75.4,
    0, 75.4 };
  const std::vector<double> c = rowsOf(3, crystal);
  const DirectionalConstants constants(c, 3);
  const double e110 = 1 / (s11 - j / 2);
  constexpr double close = 1e-9; // GPa: moduli of 60 to 200 to twelve digits
  EXPECT_NEAR(constants.young({ 2, 0, 0 }), 1 / s11, close);
  EXPECT_NEAR(constants.young({ 1, 0, -1 }), e110, close);
  EXPECT_NEAR(constants.young({ 1, -1, 1 }), 1 / (s11 - 2 * j / 3), close);
  const ConstantsAlong diagonal = constants({ 1, 1, 0 });
  EXPECT_NEAR(diagonal.poisson[0], -e110 * (s12 + j / 2), rounding); // across 1−10
  EXPECT_NEAR(diagonal.poisson[1], -e110 * s12, rounding);           // across 001
  EXPECT_NEAR(diagonal.shear[0], 1 / (s44 + 2 * j), close);
  EXPECT_NEAR(diagonal.shear[1], 75.4, close);
  const ConstantsAlong cube = constants({ 0, 1, 0 });
  EXPECT_NEAR(cube.poisson[0], -s12 / s11, rounding);
  EXPECT_NEAR(cube.poisson[1], -s12 / s11, rounding);

  const ConstantExtremes all = constants.extremes();
  EXPECT_NEAR(all.young[0].value, 1 / s11, close);
  EXPECT_EQ(all.young[0].along, (Vector{ 1, 0, 0 }));
  EXPECT_NEAR(all.young[1].value, 1 / (s11 - 2 * j / 3), close);
  const double third = 1 / std::sqrt(3.0);
  const double half = 1 / std::sqrt(2.0);
  expectNear(family(all.young[1].along), { third, third, third }, rounding);
  EXPECT_NEAR(all.shear[0].value, 1 / (s44 + 2 * j), close);
  expectNear(family(all.shear[0].along), { 0, half, half }, rounding);
  expectNear(family(all.shear[0].across), { 0, half, half }, rounding);
  EXPECT_NEAR(all.shear[1].value, 75.4, close);
  EXPECT_NEAR(all.poisson[0].value, -e110 * (s12 + j / 2), rounding);
  expectNear(family(all.poisson[0].along), { 0, half, half }, rounding);
  expectNear(family(all.poisson[0].across), { 0, half, half }, rounding);
  EXPECT_NEAR(all.poisson[1].value, -e110 * s12, rounding);
  expectNear(family(all.poisson[1].along), { 0, half, half }, rounding);
  expectNear(family(all.poisson[1].across), { 0, 0, 1 }, rounding);
  EXPECT_LT(all.poisson[0].value, 0); // as is known of copper
  EXPECT_GT(all.poisson[1].value, 0.8);
}

// A material that is the same across its axis has by the angle t between them, with c = cos t and s = sin t:
// 1/E = c⁴/E_L + s⁴/E_T + (1/G − 2 ν/E_L) s² c²; across to the plane of axis and direction −ν/E = −ν c²/E_L − ν_T
// s²/E_T, in it (1/E_L + 1/E_T − 1/G) s² c² − ν/E_L (s⁴ + c⁴); 1/G across to that plane c²/G + s² 2 (1 + ν_T)/E_T, in
// it 1/G + 4 (1/E_L + 1/E_T + 2 ν/E_L − 1/G) s² c². Turned anyhow.
TEST(DirectionalConstants, AreThoseOfAWood)
{
  const TransverseMaterial wood{ 12, 0.8, 0.4, 0.5, 0.7 };
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  const std::vector<double> c = rowsOf(3, transverseStiffness(Continuum::Space, wood, { axis(0), axis(1), axis(2) }));
  const DirectionalConstants constants(c, 3);
  std::array<double, 6> extremes{ 1e9, 0, 1e9, 0, 1e9, -1e9 };
  for (int k = 0; k <= 9000; ++k)
  {
    const double t = k * 1e-2 * M_PI / 180;
    const double cc = std::pow(std::cos(t), 2);
    const double ss = std::pow(std::sin(t), 2);
    const double along = 1 / wood.youngAlong;
    const double across = 1 / wood.youngAcross;
    const double slide = 1 / wood.shearAlong;
    const double young = 1 / (cc * cc * along + ss * ss * across + (slide - 2 * wood.poissonAlong * along) * ss * cc);
    std::array<double, 2> ratio{ young * (wood.poissonAlong * along * cc + wood.poissonAcross * across * ss),
      -young * ((along + across - slide) * ss * cc - wood.poissonAlong * along * (ss * ss + cc * cc)) };
    std::array<double, 2> shear{ 1 / (cc * slide + ss * 2 * (1 + wood.poissonAcross) * across),
      1 / (slide + 4 * (along + across + 2 * wood.poissonAlong * along - slide) * ss * cc) };
    std::sort(ratio.begin(), ratio.end());
    std::sort(shear.begin(), shear.end());
    extremes = { std::min(extremes[0], young), std::max(extremes[1], young), std::min(extremes[2], shear[0]),
      std::max(extremes[3], shear[1]), std::min(extremes[4], ratio[0]), std::max(extremes[5], ratio[1]) };
    if (k % 500 != 0)
      continue;
    const Eigen::Vector3d n = std::cos(t) * axis + std::sin(t) * axis.unitOrthogonal();
    const ConstantsAlong here = constants({ n(0), n(1), n(2) });
    // the softest stiffness is 50 times below the largest: rounding counts as often
    EXPECT_NEAR(here.young, young, 1e-11 * young) << k;
    for (std::size_t most = 0; most < 2; ++most)
    {
      EXPECT_NEAR(here.poisson[most], ratio[most], 1e-11) << k;
      EXPECT_NEAR(here.shear[most], shear[most], 1e-11) << k;
    }
  }
  // steps of 0.01° miss an extreme by less than 1e-6 of it
  const ConstantExtremes all = constants.extremes();
  EXPECT_NEAR(all.young[0].value, extremes[0], 1e-6 * extremes[0]);
  EXPECT_NEAR(all.young[1].value, 12, 1e-9);
  EXPECT_NEAR(std::abs(dot(all.young[1].along, { axis(0), axis(1), axis(2) })), 1, rounding);
  EXPECT_NEAR(all.shear[0].value, extremes[2], 1e-6);
  EXPECT_NEAR(all.shear[1].value, extremes[3], 1e-6);
  EXPECT_NEAR(all.poisson[0].value, extremes[4], 1e-6);
  EXPECT_NEAR(all.poisson[1].value, extremes[5], 1e-6);
}

// Tensors without any symmetry: no direction of many has more or less than what is found, and where it is told to be,
// it is.
TEST(DirectionalConstants, ExtremesAreThoseOfAnyTensor)
{
  std::mt19937 random(7);
  std::normal_distribution<double> number;
  for (int k = 0; k < 20; ++k)
  {
    SCOPED_TRACE(k);
    Eigen::Matrix<double, 6, 6> root;
    for (double& v : root.reshaped())
      v = number(random);
    const Eigen::Matrix<double, 6, 6> c = root * root.transpose() + 0.05 * Eigen::Matrix<double, 6, 6>::Identity();
    const DirectionalConstants constants({ c.data(), 36 }, 3);
    const ConstantExtremes all = constants.extremes();
    for (int i = 0; i < 4000; ++i)
    {
      const ConstantsAlong here = constants({ number(random), number(random), number(random) });
      // what has a name may be told for what is better by 1e-6 of the largest
      const auto within = [&](double least, double most, const std::array<DirectedValue, 2>& found)
      {
        const double slack = 1e-6 * std::max(std::abs(found[0].value), std::abs(found[1].value));
        EXPECT_GE(least, found[0].value - slack);
        EXPECT_LE(most, found[1].value + slack);
      };
      within(here.young, here.young, all.young);
      within(here.shear[0], here.shear[1], all.shear);
      within(here.poisson[0], here.poisson[1], all.poisson);
    }
    const Eigen::Matrix<double, 6, 6> compliance = c.inverse();
    for (std::size_t most = 0; most < 2; ++most)
    {
      const Vector n = all.poisson[most].along;
      const Vector m = all.poisson[most].across;
      Eigen::Matrix<double, 6, 1> stress;
      Eigen::Matrix<double, 6, 1> side;
      stress << n[0] * n[0], n[1] * n[1], n[2] * n[2], n[1] * n[2], n[0] * n[2], n[0] * n[1];
      side << m[0] * m[0], m[1] * m[1], m[2] * m[2], m[1] * m[2], m[0] * m[2], m[0] * m[1];
      EXPECT_NEAR(dot(n, m), 0, rounding);
      EXPECT_NEAR(all.poisson[most].value, -side.dot(compliance * stress) / stress.dot(compliance * stress),
        1e-9 * std::max(1.0, std::abs(all.poisson[most].value))); // conditions up to 1e4
    }
  }
}

// Sheets across y with next to nothing between them: the least modulus lies at the tip of a needle, 3e-4 rad wide.
TEST(DirectionalConstants, OfWhatHardlyResists)
{
  constexpr double soft = 1e-7;
  Eigen::Matrix<double, 6, 6> c = soft * Eigen::Matrix<double, 6, 6>::Identity();
  c(0, 0) = c(2, 2) = 1.0989;
  c(0, 2) = c(2, 0) = 0.32967;
  c(4, 4) = 0.38462;
  const ConstantExtremes all = DirectionalConstants({ c.data(), 36 }, 3).extremes();
  EXPECT_NEAR(all.young[0].value, soft, 1e-6 * soft);
  expectNear(all.young[0].along, { 0, 1, 0 }, rounding);
  EXPECT_NEAR(all.young[1].value, 1, 1e-5); // the numbers above have five digits
  EXPECT_NEAR(all.young[1].along[1], 0, 1e-6);
}

// What nothing resists has no modulus, and ratios say nothing then.
TEST(DirectionalConstants, OfMechanisms)
{
  std::vector<double> bar(9, 0.0); // along x
  bar[0] = 5;
  const DirectionalConstants along(bar, 2);
  EXPECT_NEAR(along.young({ 1, 0, 0 }), 5, rounding);
  EXPECT_EQ(along.young({ 1, 1, 0 }), 0);
  EXPECT_EQ(along({ 1, 0, 0 }).shear[0], 0);
  EXPECT_TRUE(std::isnan(along({ 1, 0, 0 }).poisson[1]));
  const ConstantExtremes all = along.extremes();
  EXPECT_EQ(all.young[0].value, 0);
  EXPECT_NEAR(all.young[1].value, 5, rounding);
  EXPECT_EQ(all.young[1].along, (Vector{ 1, 0, 0 }));
  EXPECT_TRUE(std::isnan(all.poisson[0].value));

  // loose plates across z: they resist shear within them alone
  PhaseStiffness plates = isotropicStiffness(Continuum::PlaneStress, 3, 0.3);
  std::vector<double> c(36, 0.0);
  c[0] = c[7] = plates[0];
  c[1] = c[6] = plates[1];
  c[35] = plates[5];
  const ConstantsAlong here = DirectionalConstants(c, 3)({ 1, 1, 0 });
  EXPECT_NEAR(here.young, 3, rounding);
  EXPECT_EQ(here.shear[0], 0);
  EXPECT_NEAR(here.shear[1], plates[5], rounding);
}

} // namespace
