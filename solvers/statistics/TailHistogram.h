#pragma once

#include "core/Communicator.h"

#include <cstdint>
#include <vector>

namespace lamella::statistics
{

/// Positive values in very narrow bins of equal ratio: enough to fit a tail beyond any threshold without keeping or
/// sorting the values. Bin i holds what lies in (edge(i), edge(i + 1)], edge(i) = unit · exp(i δ); the unit is an edge,
/// exactly.
class TailHistogram
{
public:
  /// @param unit [Pa], > 0; bins reach from 10⁻⁴ of it, lower values being put into the first, to the largest value
  TailHistogram(double unit, double largest);

  void add(double value);
  void add(const TailHistogram& other);
  /// Collective: adds the other ranks' values. What follows is answered after it, and nothing can be added any more.
  void finish(const Communicator& comm);

  struct Beyond
  {
    std::int64_t count = 0; ///< values above the threshold
    double excess = 0;      ///< Σ (value - threshold)
  };
  /// @param threshold an edge
  [[nodiscard]] Beyond beyond(double threshold) const;

  /// The edge below the lowest of the largest values, as many as at most this share of all; above all values where that
  /// is none.
  [[nodiscard]] double edgeForShare(double share) const;

  /// Largest difference between the cumulative share of the values above the threshold and 1 − exp(−rate (v − t)),
  /// taken at the edges. Within a bin the difference is greater by at most the law's share of that bin: at most
  /// rate·t·δ, or δ/e where that is more.
  /// @param threshold an edge
  /// @param rate [1/Pa]; NaN gives NaN
  [[nodiscard]] double distance(double threshold, double rate) const;

private:
  /// A bin with values, and those in it and beyond.
  struct Full
  {
    std::int64_t bin;
    double count; ///< exact up to 2^53
    double countFrom;
    double sumFrom;
  };

  [[nodiscard]] double edge(std::int64_t bin) const noexcept; ///< counted from the first
  /// The full bins above an edge.
  [[nodiscard]] std::vector<Full>::const_iterator above(double threshold) const noexcept;

  double unit_;
  double step_;         ///< δ
  std::int64_t offset_; ///< number of the bin above the unit
  std::vector<double> count_;
  std::vector<double> sum_; ///< of the values
  std::vector<Full> full_;  ///< made by finish()
};

} // namespace lamella::statistics
