#include "compression/CompressionCurve.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::compression
{
namespace
{

/// Rows [first, last).
struct Rows
{
  std::size_t first;
  std::size_t last;
  [[nodiscard]] std::size_t count() const { return last - first; }
};

struct Curve
{
  std::span<const double> strain;
  std::span<const double> stress;

  [[nodiscard]] std::size_t rows() const { return strain.size(); }
  [[nodiscard]] double end() const { return strain.back(); }
  [[nodiscard]] Rows between(double low, double high) const
  {
    const auto at = [&](auto place) { return static_cast<std::size_t>(place - strain.begin()); };
    return { at(std::ranges::lower_bound(strain, low)), at(std::ranges::upper_bound(strain, high)) };
  }
};

void check(const Curve& curve)
{
  if (curve.strain.size() != curve.stress.size())
    throw InputError(
      fmt::format("{} strains and {} stresses", curve.strain.size(), curve.stress.size()), "give one stress a strain");
  if (curve.rows() < 3)
    throw InputError(fmt::format("a curve of {} rows", curve.rows()), "give at least 3");
  double work = 0;
  for (std::size_t i = 0; i < curve.rows(); ++i)
  {
    const double strain = curve.strain[i];
    const double stress = curve.stress[i];
    if (!std::isfinite(strain) || !std::isfinite(stress))
      throw InputError(
        fmt::format("strain {} and stress {} in row {} are not both finite", strain, stress, i), "leave such rows out");
    if (i > 0 && !(strain > curve.strain[i - 1]))
      throw InputError(fmt::format("the strain does not rise from {} in row {} to {} in row {}", curve.strain[i - 1],
                         i - 1, strain, i),
        "give loading alone, compression as positive strain, each strain once");
    if (strain >= 1)
      throw InputError(
        fmt::format("a strain of {} in row {} is no compression", strain, i), "give it as a fraction: 0.48 for 48 %");
    if (i > 0)
      work += (stress + curve.stress[i - 1]) / 2 * (strain - curve.strain[i - 1]);
  }
  if (!(work > 0))
    throw InputError(
      fmt::format("the stresses do a work of {:.4g} J/m³", work), "give compressive stress as positive numbers [Pa]");
}

bool isRange(const std::array<double, 2>& range)
{
  return std::isfinite(range[0]) && std::isfinite(range[1]) && range[0] < range[1];
}

void check(const CurveOptions& o)
{
  if (!isRange(o.stiffnessRange))
    throw ParameterError(fmt::format("the stiffness is to be fitted from a strain of {} to one of {}",
                           o.stiffnessRange[0], o.stiffnessRange[1]),
      "give the lower one first, such as 0 and 0.03");
  if (o.plateauRange && !isRange(*o.plateauRange))
    throw ParameterError(
      fmt::format("the plateau is to lie from a strain of {} to one of {}", (*o.plateauRange)[0], (*o.plateauRange)[1]),
      "give the lower one first, such as 0.2 and 0.4");
  if (!(o.window >= 0) || o.window > o.stiffnessRange[1] - o.stiffnessRange[0])
    throw ParameterError(fmt::format("a window of {} does not fit the strains {} to {}", o.window, o.stiffnessRange[0],
                           o.stiffnessRange[1]),
      "give a width up to that of the range, or 0 for all of it");
  if (!(o.offset >= 0 && o.offset < 1))
    throw ParameterError(fmt::format("a yield offset of {}", o.offset), "give a plastic strain such as 0.002");
  if (!(o.smoothing >= 0 && o.smoothing < 1))
    throw ParameterError(
      fmt::format("stresses smoothed over a strain of {}", o.smoothing), "give 0 to 1, such as 0.01");
  if (!(o.prominence >= 0 && o.prominence < 1))
    throw ParameterError(fmt::format("a prominence of {}", o.prominence), "give a share from 0 to 1, such as 0.05");
}

/// The straight line of least squares through some rows, at least 2.
LinearPart fitted(const Curve& curve, Rows rows)
{
  const auto n = static_cast<double>(rows.count());
  double meanStrain = 0;
  double meanStress = 0;
  for (std::size_t i = rows.first; i < rows.last; ++i)
  {
    meanStrain += curve.strain[i] / n;
    meanStress += curve.stress[i] / n;
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = rows.first; i < rows.last; ++i)
  {
    const double x = curve.strain[i] - meanStrain;
    const double y = curve.stress[i] - meanStress;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  LinearPart line;
  line.slope = xy / xx;
  line.intercept = meanStress - line.slope * meanStrain;
  const double residual = std::max(0.0, yy - line.slope * xy);
  line.r2 = yy > 0 ? 1 - residual / yy : 1;
  line.standardError = rows.count() > 2 ? std::sqrt(residual / (n - 2) / xx) : 0;
  line.low = curve.strain[rows.first];
  line.high = curve.strain[rows.last - 1];
  line.rows = rows.count();
  return line;
}

std::vector<double> smoothed(const Curve& curve, double width)
{
  std::vector<double> smooth(curve.stress.begin(), curve.stress.end());
  for (std::size_t i = 0; i < curve.rows() && width > 0; ++i)
  {
    const double at = curve.strain[i];
    const Rows near = curve.between(at - width / 2, at + width / 2);
    if (near.count() > 2)
    {
      const LinearPart line = fitted(curve, near);
      smooth[i] = line.slope * at + line.intercept;
    }
  }
  return smooth;
}

/// Stress at a strain within the curve, or W there, linear between rows.
double valueAt(const Curve& curve, std::span<const double> values, double strain)
{
  const auto above = static_cast<std::size_t>(std::ranges::lower_bound(curve.strain, strain) - curve.strain.begin());
  if (above == 0)
    return values.front();
  const double before = curve.strain[above - 1];
  const double t = (strain - before) / (curve.strain[above] - before);
  return values[above - 1] + t * (values[above] - values[above - 1]);
}

/// W at a strain within the curve: exact for stresses that are linear between rows.
double energyAt(const Curve& curve, std::span<const double> energy, double strain)
{
  const auto above = static_cast<std::size_t>(std::ranges::lower_bound(curve.strain, strain) - curve.strain.begin());
  if (above == 0)
    return 0;
  const double step = strain - curve.strain[above - 1];
  return energy[above - 1] + step * (curve.stress[above - 1] + valueAt(curve, curve.stress, strain)) / 2;
}

/// From a row of the curve on: the first maximum that the values fall below by `share` before they are higher again;
/// none: the number of rows.
std::size_t firstMaximum(std::span<const double> values, std::size_t from, double share)
{
  std::size_t best = from;
  for (std::size_t i = from; i < values.size(); ++i)
    if (values[i] > values[best])
      best = i;
    else if (values[best] > 0 && values[i] < (1 - share) * values[best])
      return best;
  return values.size();
}

/// Fills what is found of the curve, and says what is not.
class Finder
{
public:
  Finder(const Curve& curve, const CurveOptions& options, CompressionCurve& found)
    : curve_(curve)
    , options_(options)
    , found_(found)
  {
  }

  void linear()
  {
    const auto [low, high] = options_.stiffnessRange;
    const Rows all = curve_.between(low, high);
    const double width = options_.window > 0 ? options_.window : high - low;
    for (std::size_t i = all.first; i < all.last; ++i)
    {
      Rows rows = options_.window > 0 ? curve_.between(curve_.strain[i], curve_.strain[i] + width) : all;
      rows.last = std::min(rows.last, all.last);
      // a window that the range or the curve cuts off is none
      const bool whole = options_.window == 0 || curve_.strain[i] + width <= std::min(high, curve_.end()) * (1 + 1e-12);
      if (rows.count() < 3 || !whole)
        continue;
      const LinearPart line = fitted(curve_, rows);
      if (!found_.linear || line.slope > found_.linear->slope)
        found_.linear = line;
      if (options_.window == 0)
        break;
    }
    if (!found_.linear)
      miss(fmt::format("stiffness: fewer than 3 rows between strains of {} and {}", low, low + width));
    else if (!(found_.linear->slope > 0))
    {
      miss(fmt::format("stiffness: the stress does not rise between strains of {} and {}", low, high));
      found_.linear.reset();
    }
  }

  void yield()
  {
    if (!found_.linear)
      return miss("yield: no stiffness to measure it from");
    const double start = found_.linear->toe() + options_.offset;
    double before = -1;
    for (std::size_t i = 0; i < curve_.rows(); ++i)
    {
      const double strain = curve_.strain[i];
      if (strain < start)
        continue;
      const double above = found_.smooth[i] - found_.linear->slope * (strain - start);
      if (above < 0 && before >= 0 && i > 0)
      {
        const double t = before / (before - above);
        const double at = curve_.strain[i - 1] + t * (strain - curve_.strain[i - 1]);
        found_.yield = CurvePoint{ at, valueAt(curve_, found_.smooth, at) };
        return;
      }
      before = above;
    }
    miss(fmt::format("yield: the curve does not fall below the line at an offset of {}", options_.offset));
  }

  void peak()
  {
    // what scatters near zero is no maximum
    const double least = found_.yield ? found_.yield->stress / 2 : 0;
    const auto begin = std::ranges::find_if(found_.smooth, [&](double stress) { return stress > least; });
    const std::size_t row =
      firstMaximum(found_.smooth, static_cast<std::size_t>(begin - found_.smooth.begin()), options_.prominence);
    if (row < curve_.rows())
      found_.peak = CurvePoint{ curve_.strain[row], found_.smooth[row] };
    else
      miss(fmt::format("peak: the stress never falls by {} of itself", options_.prominence));
  }

  void densification()
  {
    const auto from = found_.collapse();
    if (!from)
      return miss("densification: no collapse before it");
    const std::size_t first = curve_.between(from->strain, curve_.end()).first;
    const std::vector<double>& efficiency = found_.efficiency;
    const double kept = 1 - options_.prominence;
    double largest = 0;
    for (std::size_t row = first; row < efficiency.size(); ++row)
      largest = std::fmax(largest, efficiency[row]); // which passes NaN over
    // Of two plateaus that absorb as well as each other the first ends where walls begin to meet.
    std::size_t best = first;
    std::optional<std::size_t> found;
    for (std::size_t row = first; row < efficiency.size() && !found; ++row)
      if (std::isnan(efficiency[best]) || efficiency[row] > efficiency[best])
        best = row;
      else if (efficiency[row] < kept * efficiency[best])
      {
        if (efficiency[best] >= kept * largest)
          found = best;
        best = row;
      }
    if (!found)
      return miss("densification: the efficiency does not fall before the curve ends");
    best = *found;
    found_.densification =
      Densification{ curve_.strain[best], found_.smooth[best], found_.energy[best], efficiency[best] };
  }

  void plateau()
  {
    std::array<double, 2> range{};
    if (options_.plateauRange)
    {
      range = *options_.plateauRange;
      if (range[0] < curve_.strain.front() || range[1] > curve_.end())
        return miss(fmt::format("plateau: the curve, from {} to {}, does not hold the strains {} to {}",
          curve_.strain.front(), curve_.end(), range[0], range[1]));
    }
    else
    {
      const auto from = found_.collapse();
      if (!from || !found_.densification)
        return miss("plateau: no densification ends it; give it a range");
      range = { from->strain, found_.densification->strain };
      if (!(range[0] < range[1]))
        return miss("plateau: it densifies where it collapses");
    }
    const double work = energyAt(curve_, found_.energy, range[1]) - energyAt(curve_, found_.energy, range[0]);
    found_.plateau = Plateau{ work / (range[1] - range[0]), range[0], range[1] };
    const double end = 1.3 * found_.plateau->stress; // ISO 13314
    for (std::size_t i = curve_.between(range[0], curve_.end()).first; i < curve_.rows(); ++i)
      if (found_.smooth[i] >= end)
      {
        const double before = i > 0 ? found_.smooth[i - 1] : end;
        const double t = before < end ? (end - before) / (found_.smooth[i] - before) : 1;
        const double at =
          i > 0 ? curve_.strain[i - 1] + t * (curve_.strain[i] - curve_.strain[i - 1]) : curve_.strain[i];
        found_.plateauEnd = CurvePoint{ at, end };
        return;
      }
    miss("plateau end: the stress does not reach 1.3 times the plateau's");
  }

private:
  void miss(std::string why) { found_.missing.push_back(std::move(why)); }

  const Curve& curve_;
  const CurveOptions& options_;
  CompressionCurve& found_;
};

} // namespace

CompressionCurve compressionCurve(
  std::span<const double> strain, std::span<const double> stress, const CurveOptions& options)
{
  const Curve curve{ strain, stress };
  check(options);
  check(curve);
  CompressionCurve found;
  found.smooth = smoothed(curve, options.smoothing);
  found.energy.resize(curve.rows());
  found.efficiency.resize(curve.rows());
  for (std::size_t i = 0; i < curve.rows(); ++i)
  {
    if (i > 0)
      found.energy[i] = found.energy[i - 1] + (stress[i] + stress[i - 1]) / 2 * (strain[i] - strain[i - 1]);
    found.efficiency[i] =
      found.smooth[i] > 0 ? found.energy[i] / found.smooth[i] : std::numeric_limits<double>::quiet_NaN();
  }
  Finder finder(curve, options, found);
  finder.linear();
  finder.yield();
  finder.peak();
  finder.densification();
  finder.plateau();
  return found;
}

} // namespace lamella::compression
