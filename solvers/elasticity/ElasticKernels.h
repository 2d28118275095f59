#pragma once

#include <cstdint>

/// The loops over a row of elements, compiled once for every instruction set and chosen at run time: as Kernels.h of
/// the diffusion multigrid, whose rules hold here too.
///
/// Displacements are bilinear or trilinear in an element, u_c = Σ m_c,p P_p with P_p the products of some of ξ, η, ζ in
/// [−1, 1]. A strain is a sum over those of these polynomials that are not the product of all; they are orthogonal over
/// the element, with mean squares 1, 1/3 and 1/9, so an element's energy is ½ V Σ_p w_p ε_p : C : ε_p.
///
/// In the strains that vary λ counts as no more than 2 μ (a Poisson's ratio of 1/3 in space), so that elements do not
/// lock where the ratio is near 1/2: selective reduced integration (Malkus & Hughes, Comput. Methods Appl. Mech. Eng.
/// 15 (1978) 63) that sets in with the ratio.
namespace lamella::elasticity
{

constexpr int voigtSize(int dimension)
{
  return dimension == 3 ? 6 : 3;
}
/// Place of a strain's or stress's component in Voigt's order: xx, yy, zz, yz, xz, xy; in the plane xx, yy, xy.
constexpr int voigt(int dimension, int a, int b)
{
  return a == b ? a : dimension == 3 ? 6 - a - b : 2;
}
/// Place of an entry in the upper triangle of a symmetric matrix of n rows, row by row.
constexpr int triangle(int n, int i, int j)
{
  return i > j ? triangle(n, j, i) : i * n - i * (i - 1) / 2 + j - i;
}
constexpr int stiffnessSize(int dimension)
{
  return voigtSize(dimension) * (voigtSize(dimension) + 1) / 2;
}

/// Moduli of a material that is the same in all directions across an axis n,
/// C = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk) + α (δ_ij n_k n_l + n_i n_j δ_kl) + β n_i n_j n_k n_l
///   + γ (δ_ik n_j n_l + δ_il n_j n_k + δ_jk n_i n_l + δ_jl n_i n_k),
/// in the order λ, μ, α, β, γ; an isotropic one has the first two alone.
inline constexpr int axialSize = 5;

/// Arrays of these kernels are read to this many values beyond their ends; sums go as far, too.
inline constexpr std::int64_t spareValues = 34;

/// A row of elements along x and the 2^(D − 1) rows of nodes around it: of them y and z low, y high, z high, both high.
template <int D, class Real>
struct ElasticRow
{
  std::int64_t count;             ///< elements
  const Real* u[D][1 << (D - 1)]; ///< displacement's components on count + 1 nodes each
  bool isotropic; ///< moduli[0] is λ and moduli[1] is μ; else the upper triangle of C by Voigt's order
  const Real* moduli[stiffnessSize(D)]; ///< by element, over its volume and its edge's square; 0 beyond the last
  const float* stretchX;                ///< 1 / edge along x by element, 0 beyond the last; null: all edges are 1
  double stretch[3];                    ///< 1 / edge along y and z, where stretchX is not null
  double strain[6];                     ///< mean strain that u is the rest of (shears: γ), Voigt's order
  const Real* const* initial;           ///< stress to add, by Voigt's order, of each element and as the moduli; or null
};

/// out: forces −∂E/∂u are subtracted, that is A u added, to D rows of nodes for each row of nodes of u.
struct ElasticKernels
{
  /// diagonal: null, or to its rows is added what a node's components get on the mean of A's diagonal.
  void (*plane)(const ElasticRow<2, float>& row, float* const (*out)[2], float* const* diagonal);
  void (*space)(const ElasticRow<3, float>& row, float* const (*out)[4], float* const* diagonal);
  void (*planeDouble)(const ElasticRow<2, double>& row, double* const (*out)[2]);
  void (*spaceDouble)(const ElasticRow<3, double>& row, double* const (*out)[4]);
  /// Mean stress and mean strain of each element, the former as the moduli; and the energy 2 E of the row.
  void (*planeStress)(const ElasticRow<2, double>& row, double* const* stress, double* const* strain, double* energy);
  void (*spaceStress)(const ElasticRow<3, double>& row, double* const* stress, double* const* strain, double* energy);

  /// z[i] += factor (b[i] − a[i]) / d[i] where d[i] > 0, else 0.
  void (*relax)(std::int64_t n, float factor, const float* b, const float* a, const float* d, float* z);
  /// z[i] = factor b[i] / d[i] where d[i] > 0, else 0.
  void (*relaxFirst)(std::int64_t n, float factor, const float* b, const float* d, float* z);
  /// out[i] = b[i] − a[i], or −a[i].
  void (*difference)(std::int64_t n, const float* b, const float* a, float* out);
  /// Σ a b.
  double (*dot)(std::int64_t n, const float* a, const float* b);
  /// Adds Σ a b, Σ a and Σ b to the sums.
  void (*dotAndSums)(std::int64_t n, const float* a, const float* b, double* sums);
  /// a = b − shift + factor a.
  void (*direct)(std::int64_t n, float factor, float shift, const float* b, float* a);
  /// x += factor p; r −= factor q; returns Σ r².
  double (*step)(std::int64_t n, double factor, const float* p, const float* q, float* x, float* r);
  double (*stepDouble)(std::int64_t n, double factor, const float* p, const float* q, double* x, float* r);
  /// out[i] += w a[i].
  void (*add)(std::int64_t n, float w, const float* a, float* out);
  /// λ and μ of each element by its phase.
  void (*lookUp)(
    std::int64_t n, const std::uint8_t* phase, const float* tableA, const float* tableB, float* a, float* b);
  /// Upper triangle of C of each element: of axial moduli by its phase, table[modulus][id], and its axis, three numbers
  /// of any length (no length: none).
  void (*turnPlane)(
    std::int64_t n, const std::uint8_t* phase, const float* const* table, const float* axis, float* const* out);
  void (*turnSpace)(
    std::int64_t n, const std::uint8_t* phase, const float* const* table, const float* axis, float* const* out);
  void (*turnPlaneDouble)(
    std::int64_t n, const std::uint8_t* phase, const double* const* table, const float* axis, double* const* out);
  void (*turnSpaceDouble)(
    std::int64_t n, const std::uint8_t* phase, const double* const* table, const float* axis, double* const* out);
};

/// The fastest set that this processor can run.
[[nodiscard]] const ElasticKernels& elasticKernels();

} // namespace lamella::elasticity
