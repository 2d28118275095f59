#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamella
{

/// How many values have each grey, 65536 counts.
[[nodiscard]] std::vector<std::int64_t> greyHistogram(std::span<const std::uint16_t> grey);

/// Greys parted into classes, darkest first.
struct GreyLevels
{
  std::vector<int> last;    ///< last grey of every class but the brightest; where a gap lies between, its middle
  std::vector<double> mean; ///< mean grey of each class
  double separability = 0;  ///< between-class over total variance, 0 … 1
  /// How deep the histogram's valley at a level is: what is common there over the lower of the two peaks beside it,
  /// the worst of all levels. 0: nothing between two classes; near 1: no valley, so the level parts one heap.
  double valley = 0;

  /// Levels and means in one line, for people.
  [[nodiscard]] std::string text() const;
  /// What makes them doubtful, in one line; empty where nothing does.
  [[nodiscard]] std::string doubt() const;
};

/// Separability and depth of the valley beyond which a parting is doubted. One Gaussian heap has 0.64, equally common
/// greys have 0.75, and neither has a valley.
inline constexpr double leastSeparability = 0.7;
inline constexpr double shallowValley = 0.8;

/// Otsu's levels (N. Otsu, IEEE Trans. SMC 9, 1979, 62–66; equation 23 for three classes): those that leave the least
/// variance within classes. Exact for two classes; three classes are sought among at most 1024 bins.
/// @param histogram as of greyHistogram() @param classes 2 or 3
/// @throws InputError where there are fewer greys than classes
[[nodiscard]] GreyLevels otsuLevels(std::span<const std::int64_t> histogram, int classes);

/// Means, separability and valleys of classes whose last greys are known.
[[nodiscard]] GreyLevels describeLevels(std::span<const std::int64_t> histogram, std::vector<int> last);

} // namespace lamella
