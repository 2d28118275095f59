#pragma once

#include "mpm/BlockRows.h"
#include "mpm/PointMultigrid.h"
#include "mpm/PointSystem.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// Internal: how PointStiffness.h solves large systems.
namespace lamella::mpm
{

/// Conjugate gradients on K by rows, preconditioned by multigrid, for all right-hand sides side by side: what takes
/// time is to go through the matrices, and that is done once for all of them. As in PointStiffness.cpp every value is
/// scaled by the root of its diagonal, and what costs nothing is not loaded.
template <int Dim>
class PointIterations
{
public:
  using Field = typename PointSystem<Dim>::Field;

  /// @param told asked now and then; throws to stop
  PointIterations(const PointSystem<Dim>& system, const std::function<void()>& told);

  struct Outcome
  {
    std::vector<std::int64_t> iterations; ///< by right-hand side
    double residual = 0;                  ///< the worst, as PointStiffness::residual
    double lost = 0;                      ///< as PointStiffness::lost
  };
  /// @param energies by which each f can change that of the box at most
  /// @param progress told the share done of the worst; throws to stop
  /// @throws DivergenceError
  Outcome solve(const std::vector<Field>& f, std::vector<Field>& w, const std::vector<double>& energies,
    double tolerance, std::int64_t most, const std::function<void(double)>& progress) const;

  [[nodiscard]] std::size_t bytes() const noexcept { return matrix_.bytes() + multigrid_->bytes(); }

private:
  template <int Many>
  Outcome solveTogether(const std::vector<Field>& f, std::vector<Field>& w, const std::vector<double>& energies,
    double tolerance, std::int64_t most, const std::function<void(double)>& progress) const;

  const PointSystem<Dim>& system_;
  BlockRows<Dim> matrix_;
  std::vector<double> scale_; // Dim a node; 0 where a wall holds it
  std::optional<PointMultigrid<Dim>> multigrid_;
};

extern template class PointIterations<2>;
extern template class PointIterations<3>;

} // namespace lamella::mpm
