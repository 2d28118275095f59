#pragma once

#include "elasticity/ElasticMultigrid.h"
#include "elasticity/StiffPieces.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace lamella::elasticity
{

/// A phase's stiffness: the upper triangle of C in Voigt's order, row by row [Pa]; all 0 for a void.
template <int D>
struct ElasticLaw
{
  std::array<double, stiffnessSize(D)> stiffness{};
  /// Moduli as axialSize tells [Pa], of a material whose axis is each voxel's own; all 0: `stiffness` holds as it is.
  std::array<double, axialSize> axial{};

  [[nodiscard]] bool turns() const
  {
    return std::ranges::any_of(
      axial, [](double c) { return c != 0; });
  }
  [[nodiscard]] bool isVoid() const
  {
    return std::ranges::all_of(
      stiffness, [](double c) { return c == 0; });
  }
  /// λ and μ where it is isotropic to round-off.
  [[nodiscard]] bool isotropic(double& lambda, double& mu) const;
  [[nodiscard]] static ElasticLaw ofLame(double lambda, double mu);
};

template <int D>
struct ElasticProblem
{
  std::array<std::int64_t, D> elements{};
  std::array<double, D> aspect{}; ///< edges of a voxel over that along x; 0: 1
  std::array<bool, D> periodic{};
  std::array<std::array<bool, D>, D> held{};  ///< as ElasticGrid's
  std::span<const std::uint8_t> phase;        ///< of each voxel, x fastest
  std::vector<ElasticLaw<D>> laws;            ///< by phase
  std::span<const std::array<float, 3>> axis; ///< of each voxel, of any length; where some law turns
  int threads = 1;
};

struct ElasticOptions
{
  /// Of the energy, relative. Fields err by its root; mean stresses across the mean strain by something between.
  double tolerance = 1e-6;
  int maxIterations = 500;
  bool fields = false; ///< displacements in double, for stresses: D more values of 4 bytes a node
  ElasticMultigridOptions multigrid;
  /// Told the share that is left of the energy's error, estimated; false cancels.
  std::function<bool(int iteration, double error)> progress;
};

template <int D>
struct ElasticResult
{
  std::array<double, voigtSize(D)> stress{}; ///< mean over the box [Pa]
  double energy = 0;                         ///< mean of σ : ε [Pa]
  double solverError = 0;                    ///< of the energy, relative, estimated
  double residual = 0;                       ///< relative to that of no displacements
  int iterations = 0;
};

/// Displacements in a box of voxels, one bilinear or trilinear element each, under a mean strain: conjugate gradients
/// in single precision, sums in double, preconditioned by ElasticMultigrid.
///
/// Memory: four numbers of 4 bytes for each component at each node, phases, and an eighth of 44 bytes a voxel in space
/// (a quarter of 28 in the plane) for coarse levels.
template <int D>
class ElasticSystem
{
public:
  ElasticSystem(const ElasticProblem<D>& problem, const ElasticOptions& options);
  ElasticSystem(const ElasticSystem&) = delete;
  ElasticSystem& operator=(const ElasticSystem&) = delete;

  /// @throws DivergenceError; Cancelled
  [[nodiscard]] ElasticResult<D> solve(const ElasticLoad<D>& load);
  /// Stresses −C : ε of strains that phases would take if nothing held them (swelling, expansion), one a phase id, for
  /// ElasticLoad::initial.
  [[nodiscard]] std::function<void(std::int64_t, std::int64_t, double* const*)> eigenstress(
    std::span<const std::array<double, voigtSize(D)>> strains) const;
  /// Displacements, what the mean strain does left out, of the last solve [edges of a voxel along x]: one component of
  /// one row of nodes after the other, as ElasticGrid has them. With `fields` only.
  [[nodiscard]] std::span<const double> displacements() const noexcept { return exact_; }
  /// Mean stiffness of the voxels, by rows [Pa]: all of them follow the mean strain.
  [[nodiscard]] std::array<double, voigtSize(D) * voigtSize(D)> voigtBound() const;
  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] std::size_t levels() const noexcept { return multigrid_->levels(); }
  [[nodiscard]] const ElasticOperator<D>& op() const noexcept { return *op_; }

private:
  [[nodiscard]] double largestEigenvalue(std::array<double, D> widths) const;
  using ElementMatrix = typename StiffPieces<D>::ElementMatrix;
  /// Of an element of these moduli, in the kernels' unit.
  [[nodiscard]] ElementMatrix elementMatrix(
    const std::array<double, stiffnessSize(D)>& values, const std::array<double, D>& widths) const;
  void setLaws();
  void findPieces();

  ElasticProblem<D> problem_;
  ElasticOptions options_;
  double scale_ = 1; ///< the largest modulus [Pa]
  bool isotropic_ = true;
  bool turns_ = false;
  std::array<std::vector<float>, axialSize> axial_; ///< by phase id, where some law turns
  std::array<std::vector<double>, axialSize> exactAxial_;
  std::vector<bool> full_;                                 ///< by phase id: a tensor of its own among laws that turn
  std::array<std::vector<float>, stiffnessSize(D)> table_; ///< by phase id
  std::array<std::vector<double>, stiffnessSize(D)> exactTable_;
  std::unique_ptr<ElasticOperator<D>> op_;
  std::unique_ptr<ElasticMultigrid<D>> multigrid_;
  std::unique_ptr<StiffPieces<D>> pieces_; ///< where there are some
  std::vector<float> x_, r_, p_, z_;       ///< z: preconditioned residual, then the product with the direction
  std::vector<double> exact_;              ///< in place of x_
};

} // namespace lamella::elasticity
