#pragma once

#include "core/Communicator.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

/// How stresses are distributed, after Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906, section
/// V.
namespace lamella::statistics
{

struct DistributionOptions
{
  double binWidth = 0.05; ///< of the density, in mean tensile stresses; bins begin at multiples of it
  /// Where the density begins and ends, in mean tensile stresses, widened to whole bins; low ≥ high: wherever values
  /// are.
  double low = 0;
  double high = 0;
  double threshold = 0;   ///< where the tail begins, in mean tensile stresses; 0: by tailShare
  double tailShare = 0.1; ///< of the tensile values that are the tail, where there is no threshold
  double reference = 0;   ///< a stress to compare means with [Pa], such as that of the pure matrix; 0: none
  int slabs = 1;          ///< parts that are worked on at once
  /// Calls its second argument with 0 … count - 1, in any order or at once. Default: one after the other.
  std::function<void(int, const std::function<void(int)>&)> forEach{};
};

/// P(σ) ∝ exp(−θ σ/⟨σ⁺⟩) above a threshold, eq. 13. With x = σ/⟨σ⁺⟩ and t the threshold the likelihood of the n values
/// beyond t is largest at θ = n / Σ (x − t).
struct ExponentialTail
{
  double threshold = std::numeric_limits<double>::quiet_NaN(); ///< t
  std::int64_t count = 0;                                      ///< n: values > t
  double share = 0;                                            ///< n over the number of tensile values
  double theta = std::numeric_limits<double>::quiet_NaN();     ///< NaN below two values
  /// θ/√n, that of independent values. Stresses of neighbouring nodes are alike: the scatter between samples is larger.
  double standardError = std::numeric_limits<double>::quiet_NaN();
  /// Largest difference between the cumulative shares of the values and of the law (Kolmogorov, Smirnov). Only for all
  /// phases together; exact to better than 10⁻³.
  double distance = std::numeric_limits<double>::quiet_NaN();
};

/// One phase, or all.
struct StressGroup
{
  std::int64_t count = 0;       ///< values
  std::int64_t tensile = 0;     ///< > 0
  std::int64_t compressive = 0; ///< < 0
  double mean = 0;              ///< of all values [Pa]
  double deviation = 0;         ///< standard deviation of all values [Pa]
  double meanTensile = 0;       ///< of the values > 0 [Pa]; 0 where there is none
  double meanCompressive = 0;   ///< of the values < 0 [Pa], negative; 0 where there is none
  double smallest = 0;          ///< [Pa]
  double largest = 0;           ///< [Pa]
  ExponentialTail tail{};       ///< beyond the threshold of all phases
  /// By bin: share of this group's values there over the bin's width. With the shares outside the bins they sum to 1.
  std::vector<double> density{};
  std::vector<std::int64_t> bins{}; ///< values by bin
};

struct StressDistribution
{
  StressGroup all{};
  std::vector<StressGroup> groups{};    ///< by number; a group without values has empty bins
  double binWidth = 0;                  ///< in mean tensile stresses
  std::int64_t firstBin = 0;            ///< bin i is [firstBin + i, firstBin + i + 1) · binWidth
  double reference = 0;                 ///< as given
  std::vector<ExponentialTail> tails{}; ///< of all phases for thresholds that leave 50 % … 0.5 % of the tensile values
};

/// A value that is not counted.
constexpr std::uint8_t noGroup = 255;

/// Collective over `comm`. Sums are the same for any number of slabs and ranks but for round-off; counts are the same.
/// Two passes over the values; work arrays of about 1 MB a slab.
/// @param values of this rank [Pa]
/// @param group of each value, below `groups`, or noGroup; may be empty: all are of group 0
/// @throws ParameterError: bins, threshold, share or reference out of range; a threshold beyond the largest value; more
/// than a million bins
/// @throws InputError: no value to count; one that is not finite; no value above 0, hence no mean tensile stress
[[nodiscard]] StressDistribution stressDistribution(std::span<const double> values, std::span<const std::uint8_t> group,
  int groups, const DistributionOptions& options, const Communicator& comm);

} // namespace lamella::statistics
