#include "commands/WindowReport.h"

#include "lattice/AxisNames.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

namespace lamella::cli
{
namespace
{

constexpr std::array shares{ 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001 };

/// What would at least halve the error.
std::string remedy(const statistics::WindowError& window)
{
  for (const double share : shares)
  {
    if (share > 0.5 * window.relative())
      continue;
    const std::optional<double> count = window.picturesFor(share);
    if (count && *count < 1000)
      return fmt::format("{} such samples for {:g} %", *count, 100 * share);
    break;
  }
  return "larger samples, not more of them, would tell better";
}

} // namespace

std::string windowText(
  const std::string& name, const statistics::WindowError& window, const std::string& unit, double factor)
{
  const double relative = window.relative();
  std::string text = fmt::format("    {:<6}{:.4g} to {:.4g}{}   within {}; {}\n", name, factor * window.low,
    factor * window.high, unit, std::isfinite(relative) ? fmt::format("{:.2g} %", 100 * relative) : "unknown",
    std::isfinite(relative) ? remedy(window) : "no share of 0");
  if (window.gradient)
  {
    const statistics::WindowGradient& gradient = *window.gradient;
    std::string slabs;
    for (const double slab : gradient.slabs)
      slabs += fmt::format("{}{:.3g}", slabs.empty() ? ", slabs " : ", ", factor * slab);
    text += fmt::format("        it changes along {}{}{}; as such layers {:.4g}{}, {:.4g} to {:.4g}\n",
      axisNames[gradient.axis], slabs, slabs.empty() ? "" : unit, factor * gradient.layered, unit,
      factor * gradient.low, factor * gradient.high);
  }
  return text;
}

Json windowsJson(std::span<const statistics::WindowError> windows)
{
  Json json = nullptr;
  for (const statistics::WindowError& window : windows)
    json[window.name] = windowJson(window);
  return json;
}

Json windowJson(const statistics::WindowError& window)
{
  Json json{ { "low", jsonNumber(window.low) }, { "high", jsonNumber(window.high) },
    { "error", jsonNumber(window.relative()) }, { "deviation", jsonNumber(window.deviation) },
    { "freedom", window.freedom }, { "bias", jsonNumber(window.bias) }, { "decay", jsonNumber(window.decay) },
    { "gradient", nullptr } };
  for (const double share : { 0.1, 0.05, 0.02, 0.01 })
  {
    const std::optional<double> count = window.picturesFor(share);
    json["pictures_for"][fmt::format("{:g}%", 100 * share)] = count ? jsonNumber(*count) : Json(nullptr);
  }
  if (window.gradient)
    json["gradient"] = { { "axis", axisNames[window.gradient->axis] },
      { "change", jsonNumber(window.gradient->change) }, { "chance", jsonNumber(window.gradient->chance) },
      { "slabs", window.gradient->slabs }, { "layered", jsonNumber(window.gradient->layered) },
      { "low", jsonNumber(window.gradient->low) }, { "high", jsonNumber(window.gradient->high) } };
  return json;
}

} // namespace lamella::cli
