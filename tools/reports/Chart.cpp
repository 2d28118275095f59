#include "reports/Chart.h"

#include "reports/Html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace lamella::reports
{

namespace
{

constexpr double width = 640;
constexpr double height = 400;
constexpr double left = 76;
constexpr double right = 16;
constexpr double top = 14;
constexpr double bottom = 52;
constexpr std::size_t colours = 8; // of the style: --c0 ... --c7
constexpr std::size_t marked = 40; // curves of no more points show them
constexpr std::size_t bins = 600;  // a curve is drawn with at most four points in each

/// One axis: values to places, and its ticks.
struct Axis
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool log = false;

  [[nodiscard]] bool shows(double value) const { return std::isfinite(value) && (!log || value > 0); }
  void take(double value)
  {
    if (shows(value))
    {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] double share(double value) const
  {
    return log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  }
  /// Room around the values; 0 is at the rim at the rim where all lie on one side of it and near it.
  void widen(double part)
  {
    if (log)
    {
      const double factor = high > low ? std::pow(high / low, part) : 2;
      low /= factor;
      high *= factor;
      return;
    }
    if (low == high)
    {
      const double reach = low == 0 ? 1 : 0.5 * std::abs(low);
      low -= reach;
      high += reach;
      return;
    }
    const double reach = high - low;
    const bool fromNothing = low >= 0 && low <= 0.3 * high;
    const bool toNothing = high <= 0 && high >= 0.3 * low;
    low = fromNothing ? 0 : low - part * reach;
    high = toNothing ? 0 : high + part * reach;
  }
  [[nodiscard]] std::vector<double> ticks(int count) const
  {
    return log ? logTicks(low, high) : linearTicks(low, high, count);
  }
};

struct Place
{
  const Axis& x;
  const Axis& y;
  [[nodiscard]] double atX(double value) const { return left + x.share(value) * (width - left - right); }
  [[nodiscard]] double atY(double value) const { return height - bottom - y.share(value) * (height - top - bottom); }
  [[nodiscard]] bool shows(double valueX, double valueY) const { return x.shows(valueX) && y.shows(valueY); }
};

std::string colour(std::size_t number)
{
  return fmt::format("var(--c{})", number % colours);
}

/// Dashes tell curves of the same colour apart.
std::string dashes(std::size_t number)
{
  constexpr std::array<const char*, 4> of{ "", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 3\"",
    " stroke-dasharray=\"9 3 2 3\"" };
  return of[number / colours % of.size()];
}

/// The number beside a tick: 0.25, 8 × 10⁷.
std::string tickText(double value)
{
  if (value == 0 || (std::abs(value) < 1e5 && std::abs(value) >= 1e-3))
    return fmt::format("{:.6g}", value);
  constexpr std::array<const char*, 10> raised{ "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹" };
  const std::string text = fmt::format("{:.5e}", value);
  const std::size_t e = text.find('e');
  const std::string factor = fmt::format("{:.6g}", std::stod(text.substr(0, e)));
  const int power = std::stoi(text.substr(e + 1));
  std::string exponent = power < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(power)))
    exponent += raised[static_cast<std::size_t>(digit - '0')];
  return (factor == "1" ? "" : factor + " × ") + "10" + exponent;
}

void drawAxes(std::string& out, const Chart& chart, const Place& place)
{
  auto to = std::back_inserter(out);
  const double floor = height - bottom;
  for (const double tick : place.x.ticks(7))
  {
    const double x = place.atX(tick);
    fmt::format_to(to,
      "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"var(--line)\"/><text x=\"{0:.1f}\" y=\"{3}\" "
      "text-anchor=\"middle\">{4}</text>\n",
      x, top, floor, floor + 17, tickText(tick));
  }
  for (const double tick : place.y.ticks(6))
  {
    const double y = place.atY(tick);
    fmt::format_to(to,
      "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"var(--line)\"/><text x=\"{3}\" y=\"{4:.1f}\" "
      "text-anchor=\"end\">{5}</text>\n",
      left, y, width - right, left - 7, y + 4, tickText(tick));
  }
  fmt::format_to(
    to, "<path d=\"M{} {}V{}H{}\" fill=\"none\" stroke=\"currentColor\"/>\n", left, top, floor, width - right);
  fmt::format_to(to, "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>\n", (left + width - right) / 2,
    height - 12, escaped(chart.xLabel));
  fmt::format_to(to, "<text transform=\"translate(16 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
    (top + floor) / 2, escaped(chart.yLabel));
}

void drawCurve(std::string& out, const Curve& curve, std::size_t number, bool points, const Place& place)
{
  auto to = std::back_inserter(out);
  std::string line;
  bool pen = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i)
  {
    const bool shown = place.shows(curve.x[i], curve.y[i]);
    if (shown)
      line += fmt::format("{}{:.1f} {:.1f}", pen ? "L" : "M", place.atX(curve.x[i]), place.atY(curve.y[i]));
    pen = shown;
  }
  fmt::format_to(to, "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-linejoin=\"round\"{}/>\n",
    line, colour(number), dashes(number));
  for (std::size_t i = 0; i < curve.error.size() && i < curve.x.size(); ++i)
  {
    const double reach = std::abs(curve.error[i]);
    const double low = curve.y[i] - reach;
    if (!place.shows(curve.x[i], curve.y[i]) || !std::isfinite(reach))
      continue;
    const double x = place.atX(curve.x[i]);
    const double end = place.y.shows(low) ? place.atY(low) : height - bottom;
    fmt::format_to(to,
      "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}M{3:.1f} {1:.1f}V{4:.1f}M{0:.1f} {4:.1f}H{2:.1f}\" stroke=\"{5}\"/>\n", x - 3,
      place.atY(curve.y[i] + reach), x + 3, x, end, colour(number));
  }
  if (points)
  {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
    {
      if (place.shows(curve.x[i], curve.y[i]))
      {
        fmt::format_to(to, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.8\" fill=\"{}\"/>\n", place.atX(curve.x[i]),
          place.atY(curve.y[i]), colour(number));
      }
    }
  }
}

/// Names in rows below the axes. @returns the height that they take
double drawNames(std::string& out, const std::vector<Curve>& curves)
{
  auto to = std::back_inserter(out);
  double x = left;
  double y = height + 10;
  for (std::size_t i = 0; i < curves.size(); ++i)
  {
    const auto letters = std::count_if(curves[i].name.begin(), curves[i].name.end(),
      [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
    const double length = 44 + 7.2 * static_cast<double>(letters);
    if (x > left && x + length > width)
    {
      x = left;
      y += 19;
    }
    fmt::format_to(to,
      "<path d=\"M{:.0f} {:.0f}h22\" stroke=\"{}\" stroke-width=\"2.4\"{}/><text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n",
      x, y - 4, colour(i), dashes(i), x + 28, y, escaped(curves[i].name));
    x += length;
  }
  return y + 10 - height;
}

} // namespace

std::vector<double> linearTicks(double low, double high, int count)
{
  const double raw = (high - low) / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double part = raw / power;
  const double step = power * (part <= 1.0000001 ? 1 : part <= 2.0000001 ? 2 : part <= 5.0000001 ? 5 : 10);
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i <= high / step + 1e-9 && ticks.size() < 100; ++i)
    ticks.push_back(i == 0 ? 0 : i * step);
  return ticks;
}

std::vector<double> logTicks(double low, double high)
{
  const double decades = std::log10(high / low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 8)));
  std::vector<double> ticks;
  for (int power = static_cast<int>(std::floor(std::log10(low))); power <= std::ceil(std::log10(high)); ++power)
  {
    for (const double factor : { 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0 })
    {
      const double value = factor * std::pow(10.0, power);
      const bool wanted = factor == 1 ? power % every == 0 : factor == 2 || factor == 5 ? decades < 2.5 : decades < 1;
      if (wanted && value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9))
        ticks.push_back(value);
    }
  }
  return ticks;
}

Curve thinned(const Curve& curve, std::size_t count)
{
  const std::size_t size = curve.x.size();
  if (size <= 4 * count || !curve.error.empty())
    return curve;
  Curve thin{ curve.name, {}, {}, {} };
  for (std::size_t bin = 0; bin < count; ++bin)
  {
    const std::size_t first = bin * size / count;
    const std::size_t last = (bin + 1) * size / count - 1;
    std::size_t low = first;
    std::size_t high = first;
    for (std::size_t i = first; i <= last; ++i)
    {
      low = curve.y[i] < curve.y[low] || std::isnan(curve.y[low]) ? i : low;
      high = curve.y[i] > curve.y[high] || std::isnan(curve.y[high]) ? i : high;
    }
    std::array<std::size_t, 4> kept{ first, low, high, last };
    std::sort(kept.begin(), kept.end());
    for (std::size_t k = 0; k < kept.size(); ++k)
    {
      if (k == 0 || kept[k] != kept[k - 1])
      {
        thin.x.push_back(curve.x[kept[k]]);
        thin.y.push_back(curve.y[kept[k]]);
      }
    }
  }
  return thin;
}

std::string svg(const Chart& chart)
{
  Axis x;
  Axis y;
  x.log = chart.logX;
  y.log = chart.logY;
  for (const Curve& curve : chart.curves)
  {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
    {
      if (x.shows(curve.x[i]) && y.shows(curve.y[i]))
      {
        x.take(curve.x[i]);
        y.take(curve.y[i]);
        if (i < curve.error.size())
        {
          y.take(curve.y[i] - std::abs(curve.error[i]));
          y.take(curve.y[i] + std::abs(curve.error[i]));
        }
      }
    }
  }
  if (x.empty() || y.empty())
    return "";
  x.widen(0.03);
  y.widen(0.05);
  const Place place{ x, y };
  std::string inside;
  drawAxes(inside, chart, place);
  for (std::size_t i = 0; i < chart.curves.size(); ++i)
  {
    const Curve curve = thinned(chart.curves[i], bins);
    drawCurve(inside, curve, i, chart.points || curve.x.size() <= marked, place);
  }
  const bool named = chart.curves.size() > 1 || !chart.curves.front().name.empty();
  const double names = named ? drawNames(inside, chart.curves) : 0;
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" font-size=\"13\" "
                     "fill=\"currentColor\">\n{}</svg>\n",
    width, height + names, escaped(chart.words), inside);
}

} // namespace lamella::reports
