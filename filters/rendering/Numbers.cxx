// Numbers as people write them on axes and scale bars.

#include "Furniture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lamella::rendering
{
namespace
{

std::string Decimals(double value, int digits)
{
  std::array<char, 64> text{};
  // A rounded zero has no sign; a minus sign is longer than a hyphen.
  const double rounded = std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value;
  std::snprintf(text.data(), text.size(), "%.*f", digits, std::abs(rounded));
  return (rounded < 0 ? "−" : "") + std::string(text.data());
}

} // namespace

std::string RaisedText(int number)
{
  static const char* const digits[] = { "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹" };
  std::string text = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number)))
    text += digits[c - '0'];
  return text;
}

std::vector<double> NiceTicks(double low, double high)
{
  const double span = high - low;
  const double power = std::pow(10.0, std::floor(std::log10(span)));
  double step = power;
  for (const double factor : { 0.1, 0.2, 0.25, 0.5, 1.0, 2.0 })
  {
    step = factor * power;
    if (span / step < 6.5)
      break;
  }
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-6);
  const double last = std::floor(high / step + 1e-6);
  for (double k = first; k <= last; k += 1)
    ticks.push_back(k * step);
  return ticks;
}

std::vector<double> LogarithmicTicks(double low, double high)
{
  std::vector<double> ticks;
  const bool few = high - low < 2.5;
  const int step = std::max(1, static_cast<int>(std::ceil((high - low) / 8)));
  for (int power = static_cast<int>(std::floor(low)); power <= high + 1e-6; power += step)
  {
    for (const double part : { 1.0, 2.0, 5.0 })
    {
      const double tick = power + std::log10(part);
      if ((part == 1 || few) && tick >= low - 1e-6 && tick <= high + 1e-6)
        ticks.push_back(tick);
    }
  }
  return ticks.size() > 1 ? ticks : std::vector<double>{ low, high };
}

std::vector<std::string> TickLabels(const std::vector<double>& ticks, int& exponent)
{
  exponent = 0;
  double largest = 0;
  for (const double tick : ticks)
    largest = std::max(largest, std::abs(tick));
  if (largest >= 1e4 || (largest > 0 && largest < 1e-2))
    exponent = 3 * static_cast<int>(std::floor(std::log10(largest) / 3 + 1e-9));
  const double factor = std::pow(10.0, -exponent);
  // as many decimals as tell the marks apart and show each exactly
  int digits = 0;
  const auto isExact = [&](double tick)
  {
    const double scaled = tick * factor * std::pow(10.0, digits);
    return std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(1.0, std::abs(scaled));
  };
  while (digits < 9 && !std::all_of(ticks.begin(), ticks.end(), isExact))
    ++digits;
  std::vector<std::string> labels;
  std::transform(ticks.begin(), ticks.end(), std::back_inserter(labels),
    [&](double tick) { return Decimals(tick * factor, digits); });
  return labels;
}

double NiceLength(double largest, bool metres, std::string& text)
{
  if (!(largest > 0))
  {
    text.clear();
    return 0;
  }
  const double power = std::pow(10.0, std::floor(std::log10(largest) + 1e-9));
  const double length = largest >= 5 * power ? 5 * power : largest >= 2 * power ? 2 * power : power;
  struct Unit
  {
    double metres;
    const char* name;
  };
  // Micrometres as far as they are readable.
  static constexpr Unit units[] = { { 1e-9, "nm" }, { 1e-6, "µm" }, { 1e-3, "mm" }, { 1, "m" }, { 1e3, "km" } };
  const Unit* unit = &units[0];
  for (const Unit& candidate : units)
    if (length >= (candidate.metres == 1e-6 ? 0.1 : 1) * candidate.metres * (1 - 1e-9))
      unit = &candidate;
  const double number = metres ? length / unit->metres : length;
  const int digits = number < 0.95 ? static_cast<int>(std::ceil(-std::log10(number) - 1e-9)) : 0;
  text = Decimals(number, digits) + " " + (metres ? unit->name : number == 1 ? "pixel" : "pixels");
  return length;
}

} // namespace lamella::rendering
