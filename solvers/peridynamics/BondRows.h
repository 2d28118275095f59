#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/BondNumbers.h"
#include "peridynamics/RowSweep.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

/// Sums that are asked for now and then: one bond of the stencil and one row of nodes at a time, with the springs of
/// the row written out first. For BondMeasures.cpp.
namespace lamella::peridynamics
{

/// One bond of the stencil along a row: x runs from x0 to x1, pointers are at x = 0.
template <class Real>
struct BondRow
{
  std::int64_t x0;
  std::int64_t x1;
  int offset;
  std::int64_t i;      ///< position of the first node at x = 0
  std::int64_t j;      ///< of the second
  const Real* spring;  ///< k/|ξ|, 0 where there is none
  const Real* inverse; ///< 1/s₀, 0 where there is none
};

/// Springs of the bonds from a row.
template <class Real>
class SpringRow
{
public:
  SpringRow(const BondLattice& bonds, const BondNumbers<Real>& numbers)
    : bonds_(bonds)
    , numbers_(numbers)
    , spring_(bonds.layout().bufferLength())
    , inverse_(bonds.layout().bufferLength())
  {
  }

  BondRow<Real> read(std::int64_t y, std::int64_t z, int offset, std::int64_t x0, std::int64_t x1)
  {
    const std::int64_t i = bonds_.layout().index(0, y, z);
    const std::int64_t j = i + bonds_.jump(offset);
    const Offset& o = bonds_.stencil().half()[static_cast<std::size_t>(offset)];
    const auto length = static_cast<Real>(o.length * bonds_.spacing());
    const auto weight = static_cast<Real>(o.weight);
    for (std::int64_t x = x0; x < x1; ++x)
    {
      const auto kind = static_cast<std::size_t>(bonds_.kind(i + x, offset));
      Real k = weight * numbers_.stiffness[kind] / length;
      if (bonds_.corrected() && kind != 0)
      {
        Real square = 0;
        for (int c = 0; c < bonds_.dimension(); ++c)
          square += numbers_.of(0)[offset].halfSquare[c] *
            (static_cast<Real>(bonds_.shares(c)[i + x]) + static_cast<Real>(bonds_.shares(c)[j + x]));
        k /= std::sqrt(square);
      }
      spring_[NodeLayout::margin + x] = k;
      inverse_[NodeLayout::margin + x] = numbers_.inverse[kind];
    }
    return { x0, x1, offset, i, j, spring_.data() + NodeLayout::margin, inverse_.data() + NodeLayout::margin };
  }

private:
  const BondLattice& bonds_;
  const BondNumbers<Real>& numbers_;
  AlignedArray<Real> spring_;
  AlignedArray<Real> inverse_;
};

/// The state of a bond: its vector now, its elongation s, and the direction of its force.
template <class Real, int Dim, bool Nonlinear>
class BondState
{
public:
  BondState(const BondLattice& bonds, const NodeField<Real>& u, const BondRow<Real>& row)
  {
    const Offset& o = bonds.stencil().half()[static_cast<std::size_t>(row.offset)];
    length = static_cast<Real>(o.length * bonds.spacing());
    for (int c = 0; c < Dim; ++c)
    {
      xi_[c] = static_cast<Real>(o.step[static_cast<std::size_t>(c)] * bonds.spacing());
      ui_[c] = u.component(c) + row.i;
      uj_[c] = u.component(c) + row.j;
    }
  }
  void at(std::int64_t x)
  {
    Real q = 0;
    for (int c = 0; c < Dim; ++c)
    {
      const Real eta = uj_[c][x] - ui_[c][x];
      zeta[c] = xi_[c] + (Nonlinear ? eta : Real(0));
      q += Nonlinear ? (xi_[c] + zeta[c]) * eta : xi_[c] * eta;
    }
    q /= length * length;
    if constexpr (Nonlinear)
    {
      const Real ratio = std::sqrt(std::max(1 + q, Real(1e-30))); // |ζ|/|ξ|
      stretch = q / (1 + ratio);
      perZeta = stretch / ratio;
      shortening = perZeta; // 1 − |ξ|/|ζ|
      norm = length * ratio;
    }
    else
    {
      stretch = q;
      perZeta = q;
      norm = length;
    }
  }

  Real length;
  Real zeta[Dim];    ///< ξ + η, or ξ where linearised
  Real stretch{};    ///< s
  Real perZeta{};    ///< force over (k/|ξ|) ζ
  Real shortening{}; ///< 1 − |ξ|/|ζ|
  Real norm{};       ///< |ζ|

private:
  Real xi_[Dim];
  const Real* ui_[Dim];
  const Real* uj_[Dim];
};

/// Adds fill(row, t) to the first ends of all bonds, and `sign` times it to the second ones; t[c] at x = 0.
template <class Real, class Fill>
void addToEnds(const BondLattice& bonds, NodeField<Real>& out, int components, Real sign, Fill&& fill)
{
  const BondNumbers<Real> numbers(bonds);
  const std::vector<Chunk> list = chunks(bonds.stencil(), 1);
  const NodeLayout& l = bonds.layout();
  const std::vector<Band> shares = bands(bonds, omp_get_max_threads());
#pragma omp parallel for schedule(static, 1)
  for (std::size_t b = 0; b < shares.size(); ++b)
  {
    const Band& band = shares[b];
    SpringRow<Real> springs(bonds, numbers);
    AlignedArray<Real> buffers(l.bufferLength() * components);
    std::array<Real*, 6> t{};
    for (int c = 0; c < components; ++c)
      t[static_cast<std::size_t>(c)] = buffers.data() + c * l.bufferLength() + NodeLayout::margin;
    RowRuns runs;
    const auto zero = [&](std::int64_t row)
    {
      for (int c = 0; c < components; ++c)
        std::fill_n(out.component(c) + l.begin(row), l.pitch, Real(0));
    };
    const auto visit = [&](std::int64_t y, std::int64_t z, std::int64_t row, bool own)
    {
      if (!runs.find(bonds, row, 16))
        return;
      for (const Chunk& chunk : list)
      {
        const bool target = inBand(l, band, y + chunk.step[1], z + chunk.step[2]);
        if (!own && !target)
          continue;
        for (const Run& run : runs.push)
        {
          const std::int64_t x0 = std::max<std::int64_t>(run.begin, -l.ghost);
          const std::int64_t x1 = std::min<std::int64_t>(run.end, l.size[0] + l.ghost);
          const BondRow<Real> r = springs.read(y, z, chunk.first, x0, x1);
          fill(r, t);
          for (int c = 0; c < components; ++c)
          {
            const Real* from = t[static_cast<std::size_t>(c)];
            Real* to = out.component(c);
            if (own)
              for (std::int64_t x = std::max<std::int64_t>(x0, 0); x < std::min(x1, l.size[0]); ++x)
                to[r.i + x] += from[x];
            const std::int64_t dx = chunk.step[0];
            if (target)
              for (std::int64_t x = std::max(x0, -dx); x < std::min(x1, l.size[0] - dx); ++x)
                to[r.j + x] += sign * from[x];
          }
        }
      }
    };
    sweep(l, bonds.stencil().layers(), band, zero, visit);
  }
}

/// Calls f(row, ordinal) for all bonds whose first node this rank owns, by rows; rows are shared out among threads.
template <class Real, class F>
void eachOwned(const BondLattice& bonds, F&& f)
{
  const BondNumbers<Real> numbers(bonds);
  const NodeLayout& l = bonds.layout();
  const int offsets = static_cast<int>(bonds.stencil().half().size());
#pragma omp parallel
  {
    SpringRow<Real> springs(bonds, numbers);
    RowRuns runs;
#pragma omp for schedule(dynamic, 8)
    for (std::int64_t r = 0; r < l.size[1] * l.size[2]; ++r)
    {
      const std::int64_t y = r % l.size[1];
      const std::int64_t z = r / l.size[1];
      if (!runs.find(bonds, l.row(y, z), 16))
        continue;
      for (int o = 0; o < offsets; ++o)
        for (const Run& run : runs.push)
        {
          const std::int64_t x0 = std::max<std::int64_t>(run.begin, 0);
          const std::int64_t x1 = std::min(run.end, l.size[0]);
          if (x0 < x1)
            f(springs.read(y, z, o, x0, x1), r);
        }
    }
  }
}

/// Calls f with the dimension and linearity as types: f.template operator()<Dim, Nonlinear>().
template <class F>
void choose(const BondLattice& bonds, bool nonlinear, F&& f)
{
  if (bonds.dimension() == 2)
    nonlinear ? f.template operator()<2, true>() : f.template operator()<2, false>();
  else
    nonlinear ? f.template operator()<3, true>() : f.template operator()<3, false>();
}

} // namespace lamella::peridynamics
