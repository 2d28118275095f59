#pragma once

#include "elasticity/ElasticOperator.h"
#include "elasticity/StoredModuli.h"

#include <Eigen/Dense>

#include <memory>
#include <span>
#include <vector>

namespace lamella::elasticity
{

template <int D, class Real>
struct ModuliBuffer;

struct ElasticMultigridOptions
{
  int smoothing = 2;        ///< sweeps before and after on the finest level
  int coarseSmoothing = 4;  ///< on the others
  double smoothedPart = 10; ///< eigenvalues down to the largest over this are the smoother's
  /// Bulk moduli of coarse elements are those of a composite whose parts all have their mean shear modulus (Hill, J.
  /// Mech. Phys. Solids 11 (1963) 357), not their means: what hardly can be compressed leaves by the voids beside it.
  bool hillBulk = false;
};

/// A V-cycle for bilinear or trilinear elements. Coarse elements have the mean stiffness of those that they hold, which
/// over uniform regions is the Galerkin product exactly (of nearly incompressible ones other bulk moduli: hillBulk);
/// smoothing is Chebyshev's, as a product of simple steps in place, over the mean diagonal, with the largest eigenvalue
/// of one element as its bound. Of an odd number of elements the last coarse one is narrower. Long axes of elements are
/// coarsened later than short ones.
///
/// Symmetric, so that conjugate gradients may be preconditioned by it. The finest level has no array of its own.
template <int D>
class ElasticMultigrid
{
public:
  /// @param largestEigenvalue  by element shapes: an upper bound of the eigenvalues of the finest elements' matrices
  /// over
  ///                        their mean diagonal, for the given edges over the shortest
  ElasticMultigrid(const ElasticOperator<D>& finest,
    std::function<double(std::array<double, D> widths)> largestEigenvalue, const ElasticMultigridOptions& options = {});

  /// z ≈ A⁻¹ b.
  void cycle(const float* b, float* z) const;
  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] std::size_t levels() const noexcept { return levels_.size(); }

private:
  struct Level
  {
    const ElasticOperator<D>* op = nullptr;
    std::unique_ptr<ElasticOperator<D>> own; ///< none on the finest level
    std::unique_ptr<StoredModuli<D>> moduli;
    std::array<bool, D> halved{}; ///< on the way to the next level
    PlaneParts below;             ///< of the next level's planes, those that a rank makes of its own ones
    std::vector<float> factors;   ///< of the smoothing steps
    mutable std::vector<float> b, x;
    mutable std::vector<float>
      spill; ///< of a restriction: two planes of the next level by thread, and one of another rank
  };

  bool coarsen();
  void setHillBulk(const Level& fine, const ElasticGrid<D>& to, std::int64_t plane, double factor,
    ModuliBuffer<D, float>& buffer, StoredModuli<D>& moduli) const;
  void setFactors(Level& level, int steps) const;
  void invertCoarsest();
  void cycle(std::size_t index, const float* b, float* z) const;
  void smooth(const Level& level, float factor, bool first, const float* b, float* z) const;
  void restrictResidual(const Level& fine, const float* b, const float* z, const Level& coarse) const;
  void addFrom(const Level& coarse, const Level& fine, float* z) const;

  ElasticMultigridOptions options_;
  std::function<double(std::array<double, D>)> largestEigenvalue_;
  std::vector<std::unique_ptr<Level>> levels_;
  Eigen::MatrixXd inverse_;         ///< of the coarsest level's matrix, by unknowns
  std::vector<std::int64_t> place_; ///< of each unknown in the coarsest level's arrays
};

} // namespace lamella::elasticity
