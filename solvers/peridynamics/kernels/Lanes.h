#pragma once

#include <cstdint>
#include <type_traits>

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

/// Most nodes at a time, where a row has as many.
#ifdef __AVX512F__
constexpr int wide = 16;
#else
constexpr int wide = 8;
#endif

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

/// Adds up f(row, x, lanes, vectors) over rows of n nodes, a multiple of eight: two wide vectors, one, or one of eight.
template <class F>
double sumOfParts(std::int64_t rows, std::int64_t n, F&& f)
{
  constexpr std::integral_constant<int, 1> one;
  constexpr std::integral_constant<int, 2> two;
  InDouble sum;
  for (std::int64_t row = 0; row < rows; ++row)
  {
    Vector<wide>::V many{};
    Vector<8>::V few{};
    std::int64_t x = 0;
    for (; x + 2 * wide <= n; x += 2 * wide)
      many += f(row, x, std::integral_constant<int, wide>{}, two);
    for (; x + wide <= n; x += wide)
      many += f(row, x, std::integral_constant<int, wide>{}, one);
    for (; x < n; x += 8)
      few += f(row, x, std::integral_constant<int, 8>{}, one);
    sum.add(many);
    sum.add(few);
  }
  return sum.total();
}

} // namespace
} // namespace lamella::peridynamics
