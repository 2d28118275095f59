#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// How far one picture speaks for its material: the representative volume, from the picture itself.
namespace lamella::statistics
{

/// A property of the windows that a picture (volume) is cut into evenly.
struct WindowTiling
{
  std::array<std::size_t, 3> counts{ 1, 1, 1 }; ///< windows along x, y, z
  std::vector<double> values;                   ///< of each, x fastest, then y; as many as the product of the counts
};

struct WindowOptions
{
  double probability = 0.95; ///< that the interval is to hold the material's value with
  /// A gradient is told where chance alone would make one with less than this probability.
  double gradientChance = 0.001;
  /// Axis along which a picture that changes conducts (or is pulled, ...) layer after layer: its slabs' values combine
  /// as 1/mean(1/k). Along all others they lie side by side: their mean. None: their mean along every axis.
  std::optional<std::size_t> seriesAxis{};
  /// Axis that the picture is known to change along, as another of its properties shows.
  std::optional<std::size_t> changesAlong{};
  /// Share of the bias that is taken off, and that counts as a standard deviation.
  double biasTaken = 0.5;
  double biasDoubt = 0.5;
  /// Whether the picture's own value was made as those of its windows, with the same sides. If not, a picture with
  /// periodic sides say, its bias is told from the windows alone.
  bool sameSides = true;
};

/// The picture changes steadily along an axis: no scatter, but layers.
struct WindowGradient
{
  std::size_t axis = 0;
  double change = 0;         ///< from one edge of the picture to the other, of the straight line through the slabs
  double chance = 0;         ///< probability of as much by chance, times the number of axes
  std::vector<double> slabs; ///< mean of the windows of each slab across the axis
  /// Of the slabs as layers, in series or side by side; NaN where one in series is not above 0.
  double layered = std::numeric_limits<double>::quiet_NaN();
  double low = 0;  ///< the interval of a material of such layers: what slabs differ by is no scatter
  double high = 0; ///< its other end
};

/// All in the unit of the value.
struct WindowError
{
  std::string name;     ///< of the property, where it has one
  double value = 0;     ///< of the picture, as it was given
  double low = 0;       ///< the interval that holds the material's; of what is nowhere below 0 not below 0
  double high = 0;      ///< its other end
  double expected = 0;  ///< its middle: the picture's value less what is taken off of its bias
  double deviation = 0; ///< standard deviation between the values of pictures of this size
  double freedom = 0;   ///< degrees of freedom that it counts for
  double quantile = 0;  ///< of Student's t: half the interval over its standard deviation
  double bias = 0;      ///< of the value against the material's because the picture ends, as far as its windows tell
  double doubt = 0;     ///< of the bias, a standard deviation
  /// Var ∝ volume^−decay between the windows' sizes; 1 where windows are independent. Of two sizes it is rough.
  double decay = std::numeric_limits<double>::quiet_NaN();
  std::optional<WindowGradient> gradient;

  /// The farthest that the material's value may be from the picture's, over the picture's; NaN where that is 0.
  [[nodiscard]] double relative() const noexcept;
  /// How many such pictures, each from another place, give the mean to within this share of it; none where their
  /// number does not help, since the bias of pictures of this size is more than that.
  /// @param share above 0
  [[nodiscard]] std::optional<double> picturesFor(double share) const;
  /// The same of a value that is `factor` times this one, as of a finer lattice.
  [[nodiscard]] WindowError scaled(double factor) const;
};

/// The material is the process that made the picture, without end.
///
/// **Scatter.** Of N windows of a picture that fills it, with a mean square between them of S, the picture's own value
/// varies by S/N where windows are independent (Kanit et al., Int. J. Solids Struct. 40 (2003) 3647: variance falls as
/// the volume, integral range over volume). What the windows have in common does not show between them; what whole rows
/// of windows have in common (rays, files of cells) does, as main effects of the slabs across each axis: by the
/// analysis of variance of random effects the picture then varies by (Σ S_a − (A − 1) S_e)/N, S_a between the slabs
/// along axis a of A, S_e what is left. Of the two the second is noisy, and too large where slabs repel each other;
/// half of what it is above the first is added. Sizes count by their N − 1. Freedom: of the smallest windows, one less
/// for each axis and the mean.
///
/// **Bias.** Windows' sides cut what leads through them, so that means of windows change as 1/L. Windows of a half
/// (third) of the picture differ from it by m₂ − v (m₃ − v = 2 (m₂ − v)), and so would the picture from the material.
/// Half of it is taken off and as much counts as a standard deviation.
///
/// **Gradient.** The values of the smallest windows are regressed on their place along each axis; F-test against what
/// is left, times the number of axes. Where one is found the slabs across that axis are told as layers, with the
/// interval of a material of such layers: without what the slabs differ by, and with layers instead of means in the
/// bias. Three slabs that differ by chance look like a gradient, too, so the first interval still counts them as
/// scatter.
///
/// The weights were found on generated tissues and held on others: docs/benchmarks/window.md.
///
/// @param value   of the whole picture
/// @param tilings the windows of one size each, the largest first
/// @throws ParameterError for no tilings, a tiling of one window or with a wrong number of values, values that are not
/// finite
[[nodiscard]] WindowError windowError(
  double value, std::span<const WindowTiling> tilings, const WindowOptions& options = {});

/// Several properties of the same picture.
struct WindowProperty
{
  std::string name;
  double value = 0;
  std::vector<WindowTiling> tilings;
  std::optional<std::size_t> seriesAxis;
  std::optional<double> biasDoubt{}; ///< where it is not that of the options
};

/// The same of each of them. A picture that one of them shows to change along an axis changes for all of them.
/// @throws ParameterError as windowError()
[[nodiscard]] std::vector<WindowError> windowErrors(
  std::span<const WindowProperty> properties, const WindowOptions& options = {});

/// How strength depends on the sample's size; rough.
struct StrengthError
{
  /// The interval is of the mean strength of samples of this size, which falls with it: of no material.
  WindowError error;
  /// Strength ∝ volume (area)^exponent, by the means of the windows and the sample; NaN where a mean is not above 0.
  double exponent = std::numeric_limits<double>::quiet_NaN();
  /// Weibull's m by the scatter between windows, (standard deviation over mean)^−1.086; in a chain of links it would
  /// be −1/exponent. NaN where there is none.
  double modulus = std::numeric_limits<double>::quiet_NaN();
};

/// Of windows that are pulled between platens of their own, as the sample is. The relative standard deviation between
/// samples falls as volume^(−1/3): between that of a chain of links, where it does not fall, and that of means
/// (−1/2). Found on generated tissues, and held on others: docs/benchmarks/window.md.
/// @throws ParameterError as windowError()
[[nodiscard]] StrengthError strengthError(
  double value, std::span<const WindowTiling> tilings, double probability = 0.95);

/// What several pictures of one material say together: mean, and its interval by Student's t. No bias is known.
/// @param values at least two
/// @throws ParameterError
[[nodiscard]] WindowError sampleError(std::span<const double> values, double probability = 0.95);

} // namespace lamella::statistics
