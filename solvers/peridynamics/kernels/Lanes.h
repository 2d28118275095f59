#pragma once

#include <cstdint>

/// Vectors of so many single-precision numbers, for kernels that are compiled for several instruction sets: all is in a
/// namespace of the file that includes it.
namespace lamella::peridynamics
{
namespace
{

template <int Lanes>
struct Vector
{
  using V __attribute__((vector_size(4 * Lanes))) = float;
  using Any __attribute__((vector_size(4 * Lanes), aligned(4), may_alias)) = float; // at any address

  static V load(const float* p) { return *reinterpret_cast<const Any*>(p); }
  static void store(float* p, V v) { *reinterpret_cast<Any*>(p) = v; }
};

/// Sums of rows, added up in double precision.
class InDouble
{
public:
  void add(Vector<8>::V v) { sum_ += __builtin_convertvector(v, Eight); }
  void add(Vector<16>::V v)
  {
    add(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7));
    add(__builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
  }
  [[nodiscard]] double total() const
  {
    double sum = 0;
    for (int i = 0; i < 8; ++i)
      sum += sum_[i];
    return sum;
  }

private:
  using Eight __attribute__((vector_size(64))) = double;
  Eight sum_{};
};

} // namespace
} // namespace lamella::peridynamics
