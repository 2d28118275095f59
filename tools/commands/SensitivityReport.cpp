#include "commands/SensitivityReport.h"

#include "vtkLatticeConversion.h"

#include <vtkDataObject.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace lamella::cli
{

std::string percent(double share)
{
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100 * share) : "unknown";
}

std::string sensitivityText(const Sensitivity& one, int width, const char* of)
{
  std::string line;
  for (const auto& [name, change] : one.changes)
    line += fmt::format("{}{} {:.3g} %", line.empty() ? "" : ", ", name, change);
  if (line.empty())
    return "";
  std::string text = fmt::format("    {:<{}}  {}\n", one.name, width, line);
  std::vector<std::pair<double, std::string>> parts;
  double sum = 0; // they are independent
  for (const auto& [name, error] : one.inputs)
    if (error > 0)
    {
      parts.emplace_back(error, name);
      sum += error * error;
    }
  if (parts.empty())
    return text;
  std::ranges::sort(parts, std::greater());
  std::string shares;
  for (const auto& [error, name] : parts)
    shares += fmt::format("{}{} {}", shares.empty() ? "" : ", ", name, percent(error));
  return text +
    fmt::format("    {:<{}}  {} uncertainty leaves {}{}\n", "", width, of, percent(std::sqrt(sum)),
      parts.size() > 1 ? " (" + shares + ")" : "");
}

MaterialNumbers::MaterialNumbers(vtkDataObject* data)
  : names(fieldTexts(data, "material_numbers"))
  , values(fieldNumbers(data, "material_values"))
  , uncertainty(fieldNumbers(data, "material_uncertainty"))
{
}

void MaterialNumbers::add(
  Json& sensitivity, Json& relative, const std::string& name, double value, const std::vector<double>& by) const
{
  for (std::size_t p = 0; p < by.size(); ++p)
  {
    sensitivity[name][names[p]] = jsonNumber(by[p]);
    relative[name][names[p]] = jsonNumber(by[p] * values[p] / value);
  }
}

Sensitivity MaterialNumbers::of(const std::string& name, double value, const std::vector<double>& by) const
{
  Sensitivity one{ name, {}, {} };
  for (std::size_t p = 0; p < by.size(); ++p)
  {
    one.changes.emplace_back(names[p], by[p] * values[p] / value);
    one.inputs.emplace_back(names[p], std::abs(by[p] * uncertainty[p] / value));
  }
  return one;
}

namespace
{

/// How the total of a value's error comes down to half.
std::string halvingText(std::span<const statistics::ErrorPart> parts, double surfaceDoubt)
{
  const auto half = statistics::halving(parts);
  if (!half)
  {
    std::vector<statistics::ErrorPart> largest(parts.begin(), parts.end());
    std::ranges::sort(largest, std::greater(), &statistics::ErrorPart::relative);
    return fmt::format("half of it takes less of {} and of {}", largest[0].name, largest[1].name);
  }
  const std::string& name = parts[half->part].name;
  if (name == "window")
    return fmt::format("{:.0f} such samples halve it", std::ceil(1 / (half->factor * half->factor)));
  if (name == "segmentation")
    return fmt::format("surfaces within {:.2g} pixels halve it", half->factor * surfaceDoubt);
  if (name == "lattice and picture")
    return fmt::format("pixels that err {:.1f} times less halve it", 1 / half->factor);
  return fmt::format("{} {:.1f} times as well known halve it", name, 1 / half->factor);
}

} // namespace

std::string totalText(const TableValue& value, std::span<const statistics::ErrorPart> parts, double surfaceDoubt)
{
  const double total = statistics::totalError(parts);
  if (!std::isfinite(total))
    return "";
  std::string list;
  for (const statistics::ErrorPart& part : parts)
    list += fmt::format("{}{} {:.2g}", list.empty() ? "" : ", ", part.name, part.relative * value.value);
  return fmt::format("    {:<{}}  {:.5g} ± {:.2g}{} ({}); {}\n", value.name, value.width, value.value,
    total * value.value, value.unit, list, halvingText(parts, surfaceDoubt));
}

} // namespace lamella::cli
