#include "statistics/WindowError.h"

#include "core/Error.h"
#include "statistics/Distributions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace lamella::statistics
{
namespace
{

double mean(std::span<const double> values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Sums of squares of one tiling.
class Variance
{
public:
  explicit Variance(const WindowTiling& tiling)
    : tiling_(tiling)
    , count_(static_cast<double>(tiling.values.size()))
    , mean_(mean(tiling.values))
  {
    for (const double v : tiling.values)
      total_ += (v - mean_) * (v - mean_);
    for (std::size_t a = 0; a < 3; ++a)
    {
      if (tiling.counts[a] < 2)
        continue;
      axes_.push_back(a);
      slabs_[a].assign(tiling.counts[a], 0.0);
      for (std::size_t i = 0; i < tiling.values.size(); ++i)
        slabs_[a][place(i)[a]] += tiling.values[i] * static_cast<double>(tiling.counts[a]) / count_;
      for (const double m : slabs_[a])
        between_[a] += (m - mean_) * (m - mean_) * count_ / static_cast<double>(tiling.counts[a]);
    }
  }

  [[nodiscard]] double count() const { return count_; }
  [[nodiscard]] double middle() const { return mean_; }
  [[nodiscard]] double least() const { return *std::ranges::min_element(tiling_.values); }
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  [[nodiscard]] const std::vector<double>& slabs(std::size_t axis) const { return slabs_[axis]; }
  /// Mean square between the windows.
  [[nodiscard]] double square() const { return total_ / (count_ - 1); }
  /// Windows along an axis; over several the geometric mean.
  [[nodiscard]] double along() const { return std::pow(count_, 1 / static_cast<double>(axes_.size())); }

  [[nodiscard]] double freedom(std::optional<std::size_t> without) const
  {
    const double axes = static_cast<double>(axes_.size());
    const double free = without ? count_ - static_cast<double>(tiling_.counts[*without]) - (axes - 1)
                                : count_ - 1 - (axes > 1 ? axes : 0);
    return std::max(1.0, free);
  }

  /// Of the whole picture's value.
  /// @param without an axis whose slabs do not count
  [[nodiscard]] double ofPicture(std::optional<std::size_t> without) const
  {
    double sum = total_;
    double freedom = count_ - 1;
    double left = total_;
    double leftFreedom = count_ - 1;
    double slabs = 0;
    double counted = 0;
    for (const std::size_t a : axes_)
    {
      const double free = static_cast<double>(tiling_.counts[a]) - 1;
      left -= between_[a];
      leftFreedom -= free;
      if (without == a)
      {
        sum -= between_[a];
        freedom -= free;
        continue;
      }
      slabs += between_[a] / free;
      counted += 1;
    }
    if (freedom < 1)
      return 0;
    const double independent = std::max(0.0, sum) / freedom / count_;
    if (leftFreedom < 1)
      return independent;
    slabs = (slabs - (counted - 1) * std::max(0.0, left) / leftFreedom) / count_;
    return independent + 0.5 * std::max(0.0, slabs - independent);
  }

  /// Slabs as layers.
  [[nodiscard]] double layered(std::size_t axis, std::optional<std::size_t> seriesAxis) const
  {
    if (axis != seriesAxis || slabs_[axis].empty())
      return mean_;
    double resistance = 0;
    for (const double k : slabs_[axis])
      resistance += k > 0 ? 1 / k : std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(slabs_[axis].size()) / resistance;
  }

  /// The steadiest change along an axis, or along this one.
  [[nodiscard]] std::optional<WindowGradient> gradient(std::optional<std::size_t> along) const
  {
    double left = total_;
    double freedom = count_ - 1;
    double best = 0;
    std::optional<WindowGradient> found;
    for (const std::size_t a : axes_)
    {
      const double n = static_cast<double>(slabs_[a].size());
      double moment = 0;
      double square = 0;
      for (std::size_t i = 0; i < slabs_[a].size(); ++i)
      {
        const double x = static_cast<double>(i) - 0.5 * (n - 1);
        moment += x * slabs_[a][i];
        square += x * x;
      }
      const double explained = moment * moment / square * count_ / n;
      left -= explained;
      freedom -= 1;
      if (along ? along == a : explained > best)
      {
        best = explained;
        found = WindowGradient{ a, moment / square * n, 1, slabs_[a], 0, 0, 0 };
      }
    }
    if (!found || freedom < 1)
      return std::nullopt;
    left = std::max(left, 0.0);
    const double chance = left > 0 ? fisherTail(best / (left / freedom), 1, freedom) : 0;
    found->chance = std::min(1.0, chance * static_cast<double>(axes_.size()));
    return found;
  }

private:
  [[nodiscard]] std::array<std::size_t, 3> place(std::size_t i) const
  {
    const auto& n = tiling_.counts;
    return { i % n[0], i / n[0] % n[1], i / (n[0] * n[1]) };
  }

  const WindowTiling& tiling_;
  double count_;
  double mean_;
  double total_ = 0; ///< sums of squares from here on
  std::array<double, 3> between_{ 0, 0, 0 };
  std::array<std::vector<double>, 3> slabs_; ///< means
  std::vector<std::size_t> axes_;
};

void check(double value, std::span<const WindowTiling> tilings)
{
  if (tilings.empty())
    throw ParameterError("no windows", "give the values of the windows of at least one size");
  for (const WindowTiling& t : tilings)
  {
    const std::size_t count = t.counts[0] * t.counts[1] * t.counts[2];
    if (count < 2 || t.values.size() != count)
      throw ParameterError(
        fmt::format("{} values of {} × {} × {} windows", t.values.size(), t.counts[0], t.counts[1], t.counts[2]),
        "give a value of each, of at least two windows");
    for (const double v : t.values)
      if (!std::isfinite(v) || !std::isfinite(value))
        throw ParameterError("a value of a window is not finite", "leave out the windows' sizes that have such values");
  }
}

/// Of the picture's value, from how the means of windows change with their size.
/// @param middle of windows of a size
double biasOf(double value, const std::vector<Variance>& sizes, bool sameSides,
  const std::function<double(const Variance&)>& middle)
{
  double sum = 0;
  if (sameSides)
  {
    for (const Variance& s : sizes)
      sum += (middle(s) - value) / (s.along() - 1);
    return sum / static_cast<double>(sizes.size());
  }
  if (sizes.size() < 2)
    return 0;
  const Variance& large = sizes.front();
  const Variance& small = sizes.back();
  // m_n = material + n bias of windows
  const double material =
    (small.along() * middle(large) - large.along() * middle(small)) / (small.along() - large.along());
  return value - material;
}

/// Slope of the logarithm of the variance over that of the number of windows, through all sizes.
double decayOf(const std::vector<Variance>& sizes)
{
  double x1 = 0;
  double y1 = 0;
  double xx = 0;
  double xy = 0;
  for (const Variance& s : sizes)
  {
    const double x = std::log(s.count());
    const double y = std::log(s.square());
    x1 += x;
    y1 += y;
    xx += x * x;
    xy += x * y;
  }
  const double n = static_cast<double>(sizes.size());
  const double decay = (xy - x1 * y1 / n) / (xx - x1 * x1 / n);
  return std::isfinite(decay) ? decay : std::numeric_limits<double>::quiet_NaN();
}

/// The interval, with an axis whose slabs are layers or without.
void takeInterval(WindowError& error, const std::vector<Variance>& sizes, const WindowOptions& options,
  std::optional<std::size_t> layers)
{
  error.bias = biasOf(error.value, sizes, options.sameSides,
    [&](const Variance& s)
    {
      const double layered = layers ? s.layered(*layers, options.seriesAxis) : s.middle();
      return std::isfinite(layered) ? layered : s.middle();
    });
  double sum = 0;
  double weights = 0;
  for (const Variance& s : sizes)
  {
    sum += (s.count() - 1) * s.ofPicture(layers);
    weights += s.count() - 1;
  }
  error.deviation = std::sqrt(sum / weights);
  error.freedom = sizes.back().freedom(layers);
  error.expected = error.value - options.biasTaken * error.bias;
  error.doubt = options.biasDoubt * std::abs(error.bias);
  error.quantile = studentQuantile(options.probability, error.freedom);
  const double half = error.quantile * std::hypot(error.deviation, error.doubt);
  const bool positive =
    error.value >= 0 && std::ranges::all_of(sizes, [](const Variance& s) { return s.least() >= 0; });
  error.low = positive ? std::max(0.0, error.expected - half) : error.expected - half;
  error.high = error.expected + half;
}

} // namespace

double WindowError::relative() const noexcept
{
  const double far = std::max(high - value, value - low) / std::abs(value);
  return std::isfinite(far) ? far : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> WindowError::picturesFor(double share) const
{
  const double allowed = share * std::abs(expected) / quantile;
  const double left = allowed * allowed - doubt * doubt;
  if (!(left > 0))
    return std::nullopt;
  return std::max(1.0, std::ceil(deviation * deviation / left));
}

WindowError WindowError::scaled(double factor) const
{
  WindowError other = *this;
  for (double* const number :
    { &other.value, &other.low, &other.high, &other.expected, &other.deviation, &other.bias, &other.doubt })
    *number *= factor;
  other.deviation = std::abs(other.deviation);
  other.doubt = std::abs(other.doubt);
  if (factor < 0)
    std::swap(other.low, other.high);
  if (other.gradient)
  {
    WindowGradient& g = *other.gradient;
    for (double* const number : { &g.change, &g.layered, &g.low, &g.high })
      *number *= factor;
    if (factor < 0)
      std::swap(g.low, g.high);
    for (double& slab : g.slabs)
      slab *= factor;
  }
  return other;
}

WindowError windowError(double value, std::span<const WindowTiling> tilings, const WindowOptions& options)
{
  check(value, tilings);
  const std::vector<Variance> sizes(tilings.begin(), tilings.end());
  WindowError error;
  error.value = value;
  error.decay = decayOf(sizes);
  takeInterval(error, sizes, options, std::nullopt);
  const Variance& smallest = sizes.back();
  if (auto gradient = smallest.gradient(options.changesAlong);
      gradient && (options.changesAlong || gradient->chance < options.gradientChance))
  {
    gradient->layered = smallest.layered(gradient->axis, options.seriesAxis);
    WindowError layers = error;
    takeInterval(layers, sizes, options, gradient->axis);
    gradient->low = layers.low;
    gradient->high = layers.high;
    error.gradient = std::move(gradient);
  }
  return error;
}

std::vector<WindowError> windowErrors(std::span<const WindowProperty> properties, const WindowOptions& options)
{
  std::vector<WindowError> errors;
  const WindowGradient* plainest = nullptr;
  WindowOptions own = options;
  for (const WindowProperty& property : properties)
  {
    own.seriesAxis = property.seriesAxis;
    own.biasDoubt = property.biasDoubt.value_or(options.biasDoubt);
    errors.push_back(windowError(property.value, property.tilings, own));
    errors.back().name = property.name;
  }
  for (const WindowError& error : errors)
    if (error.gradient && (plainest == nullptr || error.gradient->chance < plainest->chance))
      plainest = &*error.gradient;
  if (plainest == nullptr)
    return errors;
  own.changesAlong = plainest->axis;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (!errors[i].gradient || errors[i].gradient->axis != *own.changesAlong)
    {
      own.seriesAxis = properties[i].seriesAxis;
      own.biasDoubt = properties[i].biasDoubt.value_or(options.biasDoubt);
      errors[i] = windowError(properties[i].value, properties[i].tilings, own);
      errors[i].name = properties[i].name;
    }
  return errors;
}

StrengthError strengthError(double value, std::span<const WindowTiling> tilings, double probability)
{
  check(value, tilings);
  constexpr double falls = 1.0 / 3;
  StrengthError found;
  double squares = 0; // of the sample's relative deviation, by their freedom
  double scatter = 0; // the same of the windows themselves
  double freedom = 0;
  // ln mean over ln volume, weighted by how many there are
  std::array<double, 5> sums{ 1, 0, value > 0 ? std::log(value) : 0, 0, 0 };
  bool all = value > 0;
  for (const WindowTiling& tiling : tilings)
  {
    const Variance windows(tiling);
    const double n = windows.count();
    all = all && windows.middle() > 0;
    if (!(windows.middle() > 0))
      continue;
    const double relative = windows.square() / (windows.middle() * windows.middle());
    squares += (n - 1) * relative * std::pow(n, -2 * falls);
    scatter += (n - 1) * relative;
    freedom += n - 1;
    const double x = -std::log(n);
    const double y = std::log(windows.middle());
    for (std::size_t i = 0; const double term : { 1.0, x, y, x * x, x * y })
      sums[i++] += n * term;
  }
  const Variance smallest(tilings.back());
  WindowError& error = found.error;
  error.value = error.expected = value;
  error.freedom = smallest.freedom(std::nullopt);
  error.quantile = studentQuantile(probability, error.freedom);
  error.deviation = freedom > 0 ? value * std::sqrt(squares / freedom) : 0;
  error.low = std::max(0.0, value - error.quantile * error.deviation);
  error.high = value + error.quantile * error.deviation;
  error.decay = 2 * falls;
  if (all)
    found.exponent = (sums[0] * sums[4] - sums[1] * sums[2]) / (sums[0] * sums[3] - sums[1] * sums[1]);
  if (scatter > 0)
    found.modulus = std::pow(scatter / freedom, -1.086 / 2);
  return found;
}

WindowError sampleError(std::span<const double> values, double probability)
{
  if (values.size() < 2)
    throw ParameterError(fmt::format("{} samples tell no spread", values.size()), "give at least two");
  WindowError error;
  const double count = static_cast<double>(values.size());
  error.value = error.expected = mean(values);
  double sum = 0;
  for (const double v : values)
    sum += (v - error.value) * (v - error.value);
  error.freedom = count - 1;
  error.deviation = std::sqrt(sum / error.freedom / count);
  error.quantile = studentQuantile(probability, error.freedom);
  error.low = error.value - error.quantile * error.deviation;
  error.high = error.value + error.quantile * error.deviation;
  return error;
}

} // namespace lamella::statistics
