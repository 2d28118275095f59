#include "commands/SensitivityReport.h"

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

std::string totalText(
  const std::string& name, int width, double value, const std::string& unit, double factor, const ErrorParts& parts)
{
  const double total = parts.total();
  if (!std::isfinite(total))
    return "";
  std::string list;
  std::pair<std::string, double> most;
  for (const auto& part : parts)
  {
    list += fmt::format("{}{} {:.2g}", list.empty() ? "" : ", ", part.first, factor * part.second);
    most = part.second > most.second ? part : most;
  }
  return fmt::format("    {:<{}}  {:.5g} ± {:.2g}{} ({}); most of it: {}\n", name, width, factor * value,
    factor * total, unit, list, most.first);
}

} // namespace lamella::cli
