#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

/// Internal: sparse matrices of small blocks, row by row, and their products with a few vectors at once.
namespace lamella::mpm
{

/// Blocks of Rows × Columns. Of `Many` vectors the values of an index lie next to each other: [index][value][vector].
template <int Rows, int Columns = Rows>
struct BlockRows
{
  using Block = Eigen::Matrix<double, Rows, Columns, (Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor)>;
  template <int Many>
  using Values = Eigen::Matrix<double, Rows, Many, (Many == 1 ? Eigen::ColMajor : Eigen::RowMajor)>;

  std::vector<std::int64_t> begin{ 0 }; ///< by row, and the end
  std::vector<std::int32_t> column;
  std::vector<Block> value;

  [[nodiscard]] std::int64_t rows() const noexcept { return static_cast<std::int64_t>(begin.size()) - 1; }
  [[nodiscard]] std::size_t bytes() const noexcept
  {
    return begin.size() * sizeof(begin[0]) + column.size() * (sizeof(column[0]) + sizeof(Block));
  }

  /// The row's part of this × x.
  template <int Many>
  [[nodiscard]] Values<Many> rowTimes(std::int64_t row, const double* x) const
  {
    using Other = typename BlockRows<Columns, Columns>::template Values<Many>;
    Values<Many> sum = Values<Many>::Zero();
    const auto end = static_cast<std::size_t>(begin[static_cast<std::size_t>(row) + 1]);
    for (auto e = static_cast<std::size_t>(begin[static_cast<std::size_t>(row)]); e < end; ++e)
      sum.noalias() += value[e] * Eigen::Map<const Other>(x + std::int64_t{ column[e] } * Columns * Many);
    return sum;
  }

  /// y = this × x, or y + this × x.
  template <int Many>
  void multiply(const double* x, double* y, bool add = false) const
  {
#pragma omp parallel for schedule(static)
    for (std::int64_t row = 0; row < rows(); ++row)
    {
      Eigen::Map<Values<Many>> to(y + row * Rows * Many);
      if (add)
        to += rowTimes<Many>(row, x);
      else
        to = rowTimes<Many>(row, x);
    }
  }

  /// @param columns of this
  [[nodiscard]] BlockRows<Columns, Rows> transposed(std::int64_t columns) const
  {
    BlockRows<Columns, Rows> t;
    t.begin.assign(static_cast<std::size_t>(columns) + 1, 0);
    for (const std::int32_t c : column)
      ++t.begin[static_cast<std::size_t>(c) + 1];
    for (std::size_t c = 1; c < t.begin.size(); ++c)
      t.begin[c] += t.begin[c - 1];
    t.column.resize(column.size());
    t.value.resize(column.size());
    std::vector<std::int64_t> next(t.begin.begin(), t.begin.end() - 1);
    for (std::int64_t row = 0; row < rows(); ++row)
      for (std::int64_t e = begin[static_cast<std::size_t>(row)]; e < begin[static_cast<std::size_t>(row) + 1]; ++e)
      {
        const auto from = static_cast<std::size_t>(e);
        const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(column[from])]++);
        t.column[to] = static_cast<std::int32_t>(row);
        t.value[to] = value[from].transpose();
      }
    return t;
  }
};

} // namespace lamella::mpm
