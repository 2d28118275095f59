#pragma once

#include "elasticity/ElasticOperator.h"

#include <cstdint>
#include <vector>

namespace lamella::elasticity
{

/// Moduli of every element of a box: of one that is split over ranks those of the rank's own planes, and before them
/// the plane below. Zeros at first.
template <int D>
class StoredModuli
{
public:
  StoredModuli(const ElasticGrid<D>& grid, int kinds)
    : kinds_(kinds)
    , length_(grid.elements[0] + spareValues)
    , rows_(grid.elementRows())
    , first_(grid.first())
    , last_(grid.lastElements())
    , split_(grid.parts.split())
    , values_(static_cast<std::size_t>(planeSize() * (last_ - first_ + (split_ ? 1 : 0))), 0.0F)
  {
  }

  [[nodiscard]] float* row(int kind, std::int64_t row, std::int64_t plane)
  {
    return values_.data() + placeOf(kind, row, plane);
  }
  /// To read them by, while this lives.
  [[nodiscard]] ModuliRows<float> rows() const
  {
    return [this](std::int64_t row, std::int64_t plane, float* const*, const float** out)
    {
      for (int m = 0; m < kinds_; ++m)
        out[m] = values_.data() + placeOf(m, row, plane);
    };
  }
  /// Collective: the plane below, from the rank that has it.
  void takeBelow(const PlaneParts& parts)
  {
    if (split_)
      parts.up(row(0, 0, last_ - 1), values_.data(), static_cast<std::size_t>(planeSize()));
  }
  /// Collective, of a box that is not split: all planes, where each rank knows those that parts tell.
  void gather(const PlaneParts& parts) { parts.gather(values_, last_); }
  [[nodiscard]] std::size_t size() const noexcept { return values_.size(); }

private:
  [[nodiscard]] std::int64_t planeSize() const noexcept { return kinds_ * length_ * rows_; }
  [[nodiscard]] std::int64_t placeOf(int kind, std::int64_t row, std::int64_t plane) const noexcept
  {
    const std::int64_t local = !split_ ? plane : plane >= first_ && plane < last_ ? plane - first_ + 1 : 0;
    return length_ * (kind + kinds_ * (row + rows_ * local));
  }

  int kinds_;
  std::int64_t length_;
  std::int64_t rows_;
  std::int64_t first_, last_;
  bool split_;
  std::vector<float> values_;
};

} // namespace lamella::elasticity
