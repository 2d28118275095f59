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
constexpr double letter = 7.2;         // width of one, at most, on average
constexpr double lineHeight = 19;      //
constexpr std::size_t colours = 8;     // of the style: --c0 ... --c7
constexpr std::size_t marked = 40;     // curves of no more points show them
constexpr std::size_t bins = 600;      // all curves of a chart are drawn with at most four points in each
constexpr std::size_t fewestBins = 60; // bins of a curve
constexpr std::size_t barred = 200;    // of all points of a chart no more get error bars
constexpr std::size_t longest = 70;    // letters of a name
constexpr std::size_t longestKind = 24;

std::size_t letters(const std::string& text)
{
  return static_cast<std::size_t>(std::count_if(
    text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// The end of a text that is too long: names that begin alike differ there.
std::string shortened(const std::string& text, std::size_t most)
{
  std::size_t begin = 0;
  for (std::size_t count = letters(text); count > most; --count)
    for (++begin; begin < text.size() && (static_cast<unsigned char>(text[begin]) & 0xc0) == 0x80; ++begin)
      ;
  return begin == 0 ? text : "…" + text.substr(begin);
}

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
  /// Room around the values; 0 is at the rim where all lie on one side of it and near it.
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

/// Where things are: both axes, with what is written beside them.
struct Place
{
  const Axis& x;
  const Axis& y;
  std::vector<double> ticksX;
  std::vector<double> ticksY;
  std::vector<std::string> textsX;
  std::vector<std::string> textsY;
  std::string labelX;
  std::string labelY;
  bool slanted = false; ///< what is written along x
  double left = 0;
  double right = 24;
  double top = 14;
  double bottom = 52;
  double tall = height;
  double labelAt = 16; ///< of y

  [[nodiscard]] double wide() const { return width - left - right; }
  [[nodiscard]] double floor() const { return tall - bottom; }
  [[nodiscard]] double atX(double value) const { return left + x.share(value) * wide(); }
  [[nodiscard]] double atY(double value) const { return floor() - y.share(value) * (floor() - top); }
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

std::string raised(int power)
{
  constexpr std::array<const char*, 10> digits{ "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹" };
  std::string text = power < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(power)))
    text += digits[static_cast<std::size_t>(digit - '0')];
  return text;
}

/// Begin and length of the unit in "stress [Pa]"; npos where there is none.
std::pair<std::size_t, std::size_t> unitIn(const std::string& label)
{
  const std::size_t open = label.ends_with("]") ? label.rfind(" [") : std::string::npos;
  return open == std::string::npos ? std::pair(open, open) : std::pair(open + 2, label.size() - open - 3);
}

/// Units that take mega, milli and the like.
bool takesPrefix(const std::string& label)
{
  constexpr std::array<const char*, 5> known{ "Pa", "m", "s", "J", "N" };
  const auto [begin, length] = unitIn(label);
  return begin != std::string::npos &&
    std::find(known.begin(), known.end(), label.substr(begin, length)) != known.end();
}

/// "stress [Pa]" of numbers that were divided by a power of ten: stress [MPa]; of others [10⁶ N/m].
std::string inPowers(const std::string& label, int power)
{
  if (power == 0)
    return label;
  const auto [begin, length] = unitIn(label);
  if (begin == std::string::npos)
    return fmt::format("{} [10{}]", label, raised(power));
  constexpr std::array<const char*, 7> prefixes{ "n", "µ", "m", "", "k", "M", "G" };
  const int prefix = power / 3 + 3;
  const bool named = takesPrefix(label) && std::abs(power) <= 9;
  std::string scaled = label;
  return scaled.insert(begin, named ? prefixes[static_cast<std::size_t>(prefix)] : "10" + raised(power) + " ");
}

/// What stands beside the ticks. @param label gets the power of ten that large and small numbers are divided by
std::vector<std::string> tickTexts(const Axis& axis, const std::vector<double>& ticks, std::string& label)
{
  std::vector<std::string> texts;
  const double largest = ticks.empty() ? 0 : std::max(std::abs(ticks.front()), std::abs(ticks.back()));
  if (axis.log || largest == 0 || ticks.size() < 2)
  {
    std::transform(ticks.begin(), ticks.end(), std::back_inserter(texts), numberText);
    return texts;
  }
  const bool plain = takesPrefix(label) ? largest < 1e3 && largest >= 0.1 : largest < 1e5 && largest >= 0.01;
  const int power = plain ? 0 : 3 * static_cast<int>(std::floor(std::log10(largest) / 3 + 1e-9));
  label = inPowers(label, power);
  const double unit = std::pow(10.0, power);
  const int decimals = -static_cast<int>(std::floor(std::log10((ticks[1] - ticks[0]) / unit) + 1e-6));
  std::transform(ticks.begin(), ticks.end(), std::back_inserter(texts),
    [&](double tick) { return withSign(fmt::format("{:.{}f}", tick / unit, std::clamp(decimals, 0, 12))); });
  return texts;
}

std::size_t mostLetters(const std::vector<std::string>& texts)
{
  std::size_t most = 0;
  for (const std::string& text : texts)
    most = std::max(most, letters(text));
  return most;
}

Place placeOf(const Chart& chart, const Axis& x, const Axis& y)
{
  Place place{ x, y, {}, y.ticks(6), {}, {}, chart.xLabel, chart.yLabel };
  place.textsY = tickTexts(y, place.ticksY, place.labelY);
  place.left = 36 + letter * static_cast<double>(mostLetters(place.textsY));
  if (!chart.kinds.empty())
  {
    // no more words than there is room for, side by side or aslant
    const std::size_t every = 1 + static_cast<std::size_t>(chart.kinds.size() * lineHeight / place.wide());
    for (std::size_t i = 0; i < chart.kinds.size(); i += every)
    {
      place.ticksX.push_back(static_cast<double>(i));
      place.textsX.push_back(shortened(chart.kinds[i], longestKind));
    }
    const double length = letter * static_cast<double>(mostLetters(place.textsX));
    place.slanted =
      length + letter > place.wide() / static_cast<double>(chart.kinds.size()) * static_cast<double>(every);
    if (place.slanted)
    {
      place.bottom += 0.6 * length;
      place.tall += 0.6 * length;
      const double more = std::max(0.0, 0.82 * length - place.left); // for the first word
      place.left += more;
      place.labelAt += more;
    }
    return place;
  }
  for (const int count : { 7, 4, 2 })
  {
    place.labelX = chart.xLabel;
    place.ticksX = x.ticks(count);
    place.textsX = tickTexts(x, place.ticksX, place.labelX);
    if (letter * static_cast<double>((mostLetters(place.textsX) + 2) * place.ticksX.size()) < place.wide())
      break;
  }
  return place;
}

void drawAxes(std::string& out, const Place& place)
{
  auto to = std::back_inserter(out);
  const double floor = place.floor();
  for (std::size_t i = 0; i < place.ticksX.size(); ++i)
  {
    const double x = place.atX(place.ticksX[i]);
    fmt::format_to(to, "<path d=\"M{0:.1f} {1}V{2:.1f}\" stroke=\"var(--line)\"/>", x, place.top, floor);
    if (place.slanted)
    {
      fmt::format_to(to, "<text transform=\"translate({:.1f} {:.1f}) rotate(-35)\" text-anchor=\"end\">{}</text>\n",
        x + 4, floor + 15, escaped(place.textsX[i]));
    }
    else
    {
      fmt::format_to(to, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x, floor + 17,
        escaped(place.textsX[i]));
    }
  }
  for (std::size_t i = 0; i < place.ticksY.size(); ++i)
  {
    const double y = place.atY(place.ticksY[i]);
    fmt::format_to(to,
      "<path d=\"M{0:.1f} {1:.1f}H{2}\" stroke=\"var(--line)\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
      "text-anchor=\"end\">{5}</text>\n",
      place.left, y, width - place.right, place.left - 7, y + 4, place.textsY[i]);
  }
  fmt::format_to(to, "<path d=\"M{:.1f} {}V{:.1f}H{}\" fill=\"none\" stroke=\"currentColor\"/>\n", place.left,
    place.top, floor, width - place.right);
  const auto fitting = [](double room) { return static_cast<std::size_t>(room / letter); };
  fmt::format_to(to, "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>\n",
    place.left + place.wide() / 2, place.tall - 12, escaped(shortened(place.labelX, fitting(place.wide()))));
  fmt::format_to(to, "<text transform=\"translate({:.0f} {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
    place.labelAt, (place.top + floor) / 2, escaped(shortened(place.labelY, fitting(floor))));
}

/// How a curve of several is drawn.
struct Pen
{
  std::size_t number = 0;
  double aside = 0; ///< marks that would hide each other stand side by side [pixels]
  bool line = true;
  bool points = false;
  std::size_t every = 1; ///< point with an error bar
};

void drawCurve(std::string& out, const Curve& curve, const Pen& pen, const Place& place)
{
  auto to = std::back_inserter(out);
  const std::string ink = colour(pen.number);
  const auto atX = [&](std::size_t i) { return place.atX(curve.x[i]) + pen.aside; };
  std::string line;
  bool down = false;
  for (std::size_t i = 0; pen.line && i < curve.x.size(); ++i)
  {
    const bool shown = place.shows(curve.x[i], curve.y[i]);
    if (shown)
      line += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", atX(i), place.atY(curve.y[i]));
    down = shown;
  }
  if (!line.empty())
  {
    fmt::format_to(to,
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-linejoin=\"round\"{}/>\n", line, ink,
      dashes(pen.number));
  }
  for (std::size_t i = 0; i < curve.error.size() && i < curve.x.size(); i += pen.every)
  {
    const double reach = std::abs(curve.error[i]);
    const double low = curve.y[i] - reach;
    if (!place.shows(curve.x[i], curve.y[i]) || !std::isfinite(reach))
      continue;
    const double x = atX(i);
    const double end = place.y.shows(low) ? place.atY(low) : place.floor();
    fmt::format_to(to,
      "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}M{3:.1f} {1:.1f}V{4:.1f}M{0:.1f} {4:.1f}H{2:.1f}\" stroke=\"{5}\"/>\n", x - 3,
      place.atY(curve.y[i] + reach), x + 3, x, end, ink);
  }
  if (pen.points)
  {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
    {
      if (place.shows(curve.x[i], curve.y[i]))
      {
        fmt::format_to(
          to, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.8\" fill=\"{}\"/>\n", atX(i), place.atY(curve.y[i]), ink);
      }
    }
  }
}

/// Names in rows and columns below the axes. @returns the height that they take
double drawNames(std::string& out, const std::vector<Curve>& curves, const Place& place, bool lines)
{
  std::vector<std::string> names;
  std::transform(curves.begin(), curves.end(), std::back_inserter(names),
    [](const Curve& curve) { return shortened(curve.name, longest); });
  const double wide = 44 + letter * static_cast<double>(mostLetters(names));
  const auto columns = static_cast<std::size_t>(std::max(1.0, (width - place.left + 16) / wide));
  auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const std::size_t row = i / columns;
    const double x = place.left + wide * static_cast<double>(i % columns);
    const double y = place.tall + 10 + lineHeight * static_cast<double>(row);
    if (lines)
    {
      fmt::format_to(
        to, "<path d=\"M{:.0f} {:.0f}h22\" stroke=\"{}\" stroke-width=\"2.4\"{}/>", x, y - 4, colour(i), dashes(i));
    }
    else
    {
      fmt::format_to(to, "<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"4\" fill=\"{}\"/>", x + 14, y - 4, colour(i));
    }
    fmt::format_to(to, "<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", x + 28, y, escaped(names[i]));
  }
  const std::size_t rows = (names.size() + columns - 1) / columns;
  return 1 + lineHeight * static_cast<double>(rows);
}

} // namespace

std::string numberText(double value)
{
  if (value == 0 || (std::abs(value) < 1e5 && std::abs(value) >= 1e-3))
    return withSign(fmt::format("{:.6g}", value));
  const std::string text = fmt::format("{:.5e}", value);
  const std::size_t e = text.find('e');
  const std::string factor = fmt::format("{:.6g}", std::stod(text.substr(0, e)));
  return (factor == "1" ? "" : withSign(factor) + " × ") + "10" + raised(std::stoi(text.substr(e + 1)));
}

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
  if (size <= 4 * count)
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
        if (kept[k] < curve.error.size())
          thin.error.push_back(curve.error[kept[k]]);
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
  if (chart.kinds.empty())
    x.widen(0.03);
  else
    x = { -0.5, static_cast<double>(chart.kinds.size()) - 0.5, false };
  y.widen(0.05);
  const Place place = placeOf(chart, x, y);
  std::string inside;
  drawAxes(inside, place);
  std::vector<Curve> curves;
  for (const Curve& curve : chart.curves)
    curves.push_back(thinned(curve, std::max(fewestBins, bins / chart.curves.size())));
  std::size_t bars = 0;
  for (const Curve& curve : curves)
    bars += curve.error.size();
  const double apart = !chart.kinds.empty()
    ? std::min(14.0, 0.7 * place.wide() / static_cast<double>(chart.kinds.size() * curves.size()))
    : chart.apart ? 3.0
                  : 0.0;
  for (std::size_t i = 0; i < curves.size(); ++i)
  {
    const Pen pen{ i, apart * (static_cast<double>(i) - 0.5 * static_cast<double>(curves.size() - 1)),
      chart.kinds.empty(), chart.points || curves[i].x.size() <= marked || !chart.kinds.empty(), 1 + bars / barred };
    drawCurve(inside, curves[i], pen, place);
  }
  const bool named = curves.size() > 1 || !curves.front().name.empty();
  const double names = named ? drawNames(inside, curves, place, chart.kinds.empty()) : 0;
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" font-size=\"13\" "
                     "fill=\"currentColor\">\n{}</svg>\n",
    width, place.tall + names, escaped(chart.words), inside);
}

} // namespace lamella::reports
