#pragma once

#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/BondMultigrid.h"

#include <cstdint>

namespace lamella::peridynamics
{

/// A symmetric positive operator in single precision.
class Preconditioner
{
public:
  virtual ~Preconditioner() = default;
  /// M (scale · r) on own nodes; zero where components are fixed.
  virtual const NodeField<float>& apply(const NodeField<double>& r, double scale) = 0;
  /// The same of a field of single precision.
  virtual const NodeField<float>& apply(const NodeField<float>& r) = 0;
  [[nodiscard]] virtual std::int64_t bytes() const = 0;
  [[nodiscard]] virtual std::int64_t products() const = 0;
  [[nodiscard]] virtual int levels() const = 0;
  [[nodiscard]] virtual std::int64_t hinges() const = 0;
};

class MultigridPreconditioner final : public Preconditioner
{
public:
  MultigridPreconditioner(const BondLattice& bonds, const FixedComponents& fixed, const MultigridOptions& options)
    : multigrid_(bonds, fixed, options)
  {
  }
  const NodeField<float>& apply(const NodeField<double>& r, double scale) override
  {
    return multigrid_.apply(r, scale);
  }
  const NodeField<float>& apply(const NodeField<float>& r) override { return multigrid_.apply(r); }
  [[nodiscard]] std::int64_t bytes() const override { return multigrid_.bytes(); }
  [[nodiscard]] std::int64_t products() const override { return multigrid_.products(); }
  [[nodiscard]] int levels() const override { return static_cast<int>(multigrid_.levelCount()); }
  [[nodiscard]] std::int64_t hinges() const override { return multigrid_.hinges(); }

private:
  BondMultigrid multigrid_;
};

class JacobiPreconditioner final : public Preconditioner
{
public:
  JacobiPreconditioner(const BondLattice& bonds, const FixedComponents& fixed);
  const NodeField<float>& apply(const NodeField<double>& r, double scale) override;
  const NodeField<float>& apply(const NodeField<float>& r) override;
  [[nodiscard]] std::int64_t bytes() const override;
  [[nodiscard]] std::int64_t products() const override { return 0; }
  [[nodiscard]] int levels() const override { return 1; }
  [[nodiscard]] std::int64_t hinges() const override { return hinges_; }

private:
  std::int64_t hinges_ = 0;
  NodeField<float> inverse_;
  NodeField<float> r_;
  NodeField<float> z_;
};

} // namespace lamella::peridynamics
