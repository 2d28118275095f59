#pragma once

#include "elasticity/ElasticMultigrid.h"
#include "elasticity/Materials.h"
#include "elasticity/RigidPieces.h"
#include "elasticity/StiffPieces.h"
#include "elasticity/StoredModuli.h"
#include "elasticity/SurfaceChanges.h"

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
  bool rigid = false;                   ///< each of its pieces moves as a body; `stiffness` is 0
  std::vector<ModulusChange> changes{}; ///< of one that is isotropic or turns

  [[nodiscard]] bool turns() const
  {
    return std::ranges::any_of(
      axial, [](double c) { return c != 0; });
  }
  [[nodiscard]] bool isVoid() const
  {
    return !rigid &&
      std::ranges::all_of(
        stiffness, [](double c) { return c == 0; });
  }
  /// λ and μ where it is isotropic to round-off.
  [[nodiscard]] bool isotropic(double& lambda, double& mu) const;
  [[nodiscard]] static ElasticLaw ofLame(double lambda, double mu);
  /// Of a law that turns: its stiffness with that axis.
  [[nodiscard]] std::array<double, stiffnessSize(D)> turnedTo(const std::array<float, 3>& axis) const;
  /// Of a law that turns: moduli of its compliance as a tensor, in `axial`.
  [[nodiscard]] ElasticLaw inverse() const;
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
  Communicator ranks{ MPI_COMM_SELF }; ///< have the same problem, and share out its planes of nodes
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

/// Strain that a phase takes when nothing holds it, of a unit of temperature or moisture.
template <int D>
struct FreeStrain
{
  std::array<double, voigtSize(D)> strain{}; ///< Voigt's order, shears as angles
  /// Of a phase that turns: along its axis and across it.
  double along = 0, across = 0;
};

template <int D>
struct ElasticResult
{
  std::array<double, voigtSize(D)> stress{}; ///< mean over the box [Pa]
  std::array<double, voigtSize(D)> strain{}; ///< mean over the voxels: the load's where sides repeat or are held
  double energy = 0;                         ///< mean of σ : ε [Pa]
  double solverError = 0;                    ///< of the energy, relative, estimated
  double residual = 0;                       ///< relative to that of no displacements
  int iterations = 0;
};

/// Mean stiffness of the voxels, by rows [Pa]: all of them follow the mean strain. Infinite where some are rigid.
template <int D>
[[nodiscard]] std::array<double, voigtSize(D) * voigtSize(D)> voigtBound(const ElasticProblem<D>& problem);

/// Displacements in a box of voxels, one bilinear or trilinear element each, under a mean strain: conjugate gradients
/// in single precision, sums in double, preconditioned by ElasticMultigrid. Solving is collective; the same bits for
/// any number of ranks and threads.
///
/// Memory: four numbers of 4 bytes for each component at each node, phases, and an eighth of 44 bytes a voxel in space
/// (a quarter of 28 in the plane) for coarse levels.
template <int D>
class ElasticSystem
{
public:
  ElasticSystem(const ElasticProblem<D>& problem, const ElasticOptions& options);
  ~ElasticSystem();
  ElasticSystem(const ElasticSystem&) = delete;
  ElasticSystem& operator=(const ElasticSystem&) = delete;

  /// @throws DivergenceError; Cancelled
  [[nodiscard]] ElasticResult<D> solve(const ElasticLoad<D>& load);
  /// Stresses −C : ε of strains that phases would take if nothing held them (swelling, expansion), one a phase id, for
  /// ElasticLoad::initial.
  /// @param times by voxel, of what they are multiplied by; empty: 1. Read while a solve goes on.
  [[nodiscard]] std::function<void(std::int64_t, std::int64_t, double* const*)> eigenstress(
    std::span<const FreeStrain<D>> strains, std::span<const float> times = {}) const;
  /// −stress everywhere, for ElasticLoad::initial: where no side is held or repeats, faces are pulled by that stress.
  [[nodiscard]] std::function<void(std::int64_t, std::int64_t, double* const*)> traction(
    const std::array<double, voigtSize(D)>& stress) const;
  /// Of a row of voxels, by its thread: displacement of centres, what the mean strain does left out [edges of a voxel
  /// along x], mean strains of voxels and mean stresses [Pa] by Voigt's order; 0 in rigid voxels.
  using FieldRow = std::function<void(std::int64_t row, std::int64_t plane, const double* const* displacement,
    const double* const* strain, const double* const* stress)>;
  /// Of the last solve, whose load this was, for the rank's own planes of voxels. With `fields` only. Collective.
  void forFields(const ElasticLoad<D>& load, const FieldRow& f) const;
  /// Displacements, in the precision that there is, and the mean strain that they are the rest of.
  struct Field
  {
    std::vector<float> single;
    std::vector<double> exact;
    std::array<double, 6> strain{};

    [[nodiscard]] std::size_t bytes() const noexcept { return single.size() * 4 + exact.size() * 8; }
  };
  /// Of the last solve, whose load this was.
  [[nodiscard]] Field field(const ElasticLoad<D>& load) const;
  /// Mean over the box of ε_i : ∂C/∂p : ε_j by the numbers p of the laws' `changes`, as the elements are integrated:
  /// [p * pairs + triangle(fields, i, j)] [Pa over the number's unit]. Collective.
  /// @param fields  one, or voigtSize(D) of them; of this box, whatever its sides held
  [[nodiscard]] std::vector<double> changes(std::span<const Field> fields, std::size_t numbers) const;
  /// The same by where the surface between each two phases that meet lies. A node at a surface moves by its normal V
  /// (from 4 × 4 (× 4) voxels) where one phase grows into the other, and takes the elements with it, whose energies
  /// change by ∫ σ_i : ε_j div V − σ_i : ∇u_j ∇V − σ_j : ∇u_i ∇V (Eshelby, Phil. Trans. R. Soc. A 244 (1951) 87: the
  /// force on the surface, as an integral over what is beside it); the fields' own change counts to second order. Of
  /// means over elements. Flat surfaces along the axes are exact.
  [[nodiscard]] std::vector<SurfaceChange> surfaces(std::span<const Field> fields) const;
  [[nodiscard]] double scale() const noexcept { return scale_; } ///< the largest modulus [Pa]
  [[nodiscard]] std::size_t bytes() const noexcept;              ///< of this rank, the picture's included
  [[nodiscard]] std::size_t levels() const noexcept { return multigrid_->levels(); }
  [[nodiscard]] const ElasticOperator<D>& op() const noexcept { return *op_; }

private:
  [[nodiscard]] double largestEigenvalue(std::array<double, D> widths) const;
  using ElementMatrix = typename StiffPieces<D>::ElementMatrix;
  /// Of an element of these moduli, in the kernels' unit.
  [[nodiscard]] ElementMatrix elementMatrix(
    const std::array<double, stiffnessSize(D)>& values, const std::array<double, D>& widths) const;
  template <class Real>
  struct Tables
  {
    std::array<std::vector<Real>, stiffnessSize(D)> stiffness; ///< by phase id
    std::array<std::vector<Real>, axialSize> axial;            ///< by phase id, where some law turns

    template <class From>
    void take(const Tables<From>& from)
    {
      for (std::size_t k = 0; k < stiffness.size(); ++k)
        stiffness[k].assign(from.stiffness[k].begin(), from.stiffness[k].end());
      for (std::size_t k = 0; k < axialSize; ++k)
        axial[k].assign(from.axial[k].begin(), from.axial[k].end());
    }
  };
  void setLaws();
  [[nodiscard]] Tables<double> tablesOf(const std::vector<ElasticLaw<D>>& laws) const;
  void requireAxes() const;
  template <class Real>
  [[nodiscard]] ModuliRows<Real> rowsOf(const Tables<Real>& tables) const;
  /// The same, made once: rows of a plane.
  [[nodiscard]] ModuliRows<float> keptRows(const ElasticGrid<D>& grid, const ModuliRows<float>& made);
  [[nodiscard]] ElasticMultigridOptions smoothing() const; ///< as the materials want it
  void findPieces();
  void correctPieces();
  /// Sums of values by plane, of which each rank knows those of its own: of each of `count` values.
  [[nodiscard]] std::vector<double> totals(std::vector<double>& byPlane, std::size_t count) const;
  /// Energy of the mean strain and the displacements there are, in units of the kernels, summed over voxels.
  [[nodiscard]] double startEnergy(const ElasticLoad<D>& load) const;

  ElasticProblem<D> problem_;
  ElasticOptions options_;
  double scale_ = 1; ///< the largest modulus [Pa]
  double doubt_ = 1; ///< what estimated errors are multiplied by
  bool isotropic_ = true;
  bool turns_ = false;
  std::vector<bool> rigid_; ///< by phase id
  std::vector<bool> full_;  ///< by phase id: a tensor of its own among laws that turn
  Tables<float> single_;
  Tables<double> exact64_;
  std::unique_ptr<StoredModuli<D>> kept_; ///< of a picture that is not isotropic
  Tables<float> standIn_;                 ///< rigid phases stiff instead, for what multigrid works with
  std::unique_ptr<ElasticOperator<D>> op_;
  std::unique_ptr<ElasticOperator<D>> stiffOp_; ///< where phases are rigid
  std::unique_ptr<RigidPieces<D>> bodies_;      ///< likewise
  std::unique_ptr<ElasticMultigrid<D>> multigrid_;
  std::unique_ptr<StiffPieces<D>> pieces_; ///< where there are some
  std::vector<float> x_, r_, p_, z_;       ///< z: preconditioned residual, then the product with the direction
  std::vector<double> exact_;              ///< in place of x_
};

} // namespace lamella::elasticity
