#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/multigrid/MultigridOptions.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace lamella::peridynamics
{

enum class EquilibriumSolver
{
  Multigrid,        ///< conjugate gradients, preconditioned by one multigrid cycle
  Jacobi,           ///< conjugate gradients, preconditioned by the nodes' blocks
  Direct,           ///< sparse Cholesky; one rank, small samples
  DynamicRelaxation ///< Kilic and Madenci, Theor. Appl. Fract. Mech. 53 (2010) 194; for comparison
};

enum class Strains
{
  Small, ///< one linear system
  Large  ///< Newton's method on the nonlinear forces
};

struct EquilibriumOptions
{
  EquilibriumSolver solver = EquilibriumSolver::Multigrid;
  Strains strains = Strains::Small;
  double tolerance = 1e-6; ///< of the residual force, over the forces on the free nodes were they held where they are
  std::int64_t maxIterations = 20000;
  MultigridOptions multigrid{};
  /// What the residual may leave of the value that is wanted, as a share of it. The residual counts over the forces of
  /// the stiffest nodes; where other nodes are far softer, a value of theirs may be off by far more. Given
  /// displacements and the forces on all nodes, loads included. Where it is above valueShare when the tolerance is met,
  /// conjugate gradients go on, at most as long again. Small strains only.
  std::function<double(const NodeField<double>& displacement, const NodeField<double>& force)> doubt{};
  static constexpr double valueShare = 1000; ///< tolerances; sound samples of one material have up to 400 of them
  /// Called now and then with the share that is done; true asks to stop, which throws Cancelled.
  std::function<bool(double)> progress{};
};

struct EquilibriumResult
{
  std::int64_t iterations = 0;
  int newtonSteps = 1;
  double residual = 0; ///< reached, as EquilibriumOptions::tolerance counts
  double doubt = 0;    ///< what EquilibriumOptions::doubt says of it
  double setupSeconds = 0;
  double solveSeconds = 0;
  std::int64_t products = 0; ///< with the finest level's matrix, the preconditioner's included
  std::int64_t bytes = 0;    ///< of all work arrays of this rank
  int levels = 1;
  /// Nodes that too few bonds hold to resist in every direction: they move along where they meet no resistance.
  std::int64_t hinges = 0;
};

/// What stands between a residual and the next direction of conjugate gradients.
class Preconditioner;

/// Displacements at which the forces on all free components vanish.
class Equilibrium
{
public:
  /// @param bonds must outlive this
  /// @param fixed components that keep the displacement that they are given; bits as FixedComponents. Nodes without
  /// bonds need not be in it.
  Equilibrium(const BondLattice& bonds, FixedComponents fixed, EquilibriumOptions options = {});
  ~Equilibrium();
  Equilibrium(const Equilibrium&) = delete;
  Equilibrium& operator=(const Equilibrium&) = delete;

  /// @param u in: displacements of fixed components, and a first guess of the others; out: equilibrium, rim filled [m]
  /// @param load forces on the nodes [N], or null
  /// @param reference force that the tolerance is a share of, instead of those on the free nodes were they held [N]
  /// @throws DivergenceError when it does not converge; Cancelled
  EquilibriumResult solve(
    NodeField<double>& u, const NodeField<double>* load = nullptr, std::optional<double> reference = std::nullopt);

  /// The same in single precision where a tolerance of 1e-4 or more lets it, by multigrid; of small strains, and
  /// without EquilibriumOptions::doubt. What u is wrong by at first counts in double precision.
  /// @param reference as above
  EquilibriumResult solveRoughly(NodeField<double>& u, const NodeField<double>* load, double reference);

  /// Takes the place of EquilibriumOptions::progress in what is solved from now on.
  void setProgress(std::function<bool(double)> progress) { options_.progress = std::move(progress); }
  /// Likewise of EquilibriumOptions::doubt.
  void setDoubt(std::function<double(const NodeField<double>&, const NodeField<double>&)> doubt)
  {
    options_.doubt = std::move(doubt);
  }
  [[nodiscard]] double tolerance() const noexcept { return options_.tolerance; }
  /// Likewise of EquilibriumOptions::tolerance.
  void setTolerance(double tolerance) noexcept { options_.tolerance = tolerance; }

  [[nodiscard]] const FixedComponents& fixed() const noexcept { return fixed_; }

private:
  template <class Real>
  void hold(NodeField<Real>& field) const
  {
    for (const std::int64_t i : fixedNodes_)
      for (int c = 0; c < field.components(); ++c)
        if ((fixed_[i] >> c & 1U) != 0)
          field.component(c)[i] = 0;
  }
  [[nodiscard]] double dot(const NodeField<double>& a, const NodeField<double>& b) const;
  [[nodiscard]] double norm(const NodeField<double>& a) const;
  /// r = load + force(u), zero where fixed; fills the rim of u
  void residual(NodeField<double>& u, const NodeField<double>* load, NodeField<double>& r, bool large);
  double forcing(const NodeField<double>& u, const NodeField<double>* load);
  void conjugateGradients(NodeField<double>& u, const NodeField<double>* load, double target, double reference,
    const NodeField<double>* tangentAt, EquilibriumResult& result);
  /// Goes on where the residual may leave too much of the value that is wanted.
  void refine(NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result);
  void newton(NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result);
  void relaxDynamically(
    NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result);
  void solveDirectly(NodeField<double>& u, const NodeField<double>* load, EquilibriumResult& result);
  void report(double share) const;

  const BondLattice& bonds_;
  FixedComponents fixed_;
  EquilibriumOptions options_;
  std::vector<std::int64_t> fixedNodes_;
  std::unique_ptr<Preconditioner> preconditioner_;
  double setupSeconds_ = 0;
  std::int64_t products_ = 0;
};

} // namespace lamella::peridynamics
