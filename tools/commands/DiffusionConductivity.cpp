#include "commands/DiffusionConductivity.h"

#include "lattice/PhaseNames.h"
#include "session/Text.h"
#include "session/Units.h"

#include <fmt/format.h>

#include <vtkImageData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

double parseValue(const std::string& text, const std::string& number)
{
  const auto value = toNumber(number);
  if (!value)
  {
    throw ParameterError("--conductivity '" + text + "': '" + number + "' is not a number",
      fmt::format("write it as --conductivity NAME=VALUE, such as --conductivity {}=0.41, or NAME=ALONG:ACROSS",
        text.substr(0, text.find('='))));
  }
  if (!std::isfinite(*value) || *value < 0)
  {
    throw ParameterError(fmt::format("--conductivity {}: a conductivity must be a finite number of at least 0", text),
      "give a positive value, or 0 for a phase that does not conduct");
  }
  if (*value != 0 && !plausible(*value))
  {
    throw ParameterError(fmt::format("--conductivity {}: {} is not between 1e-30 and 1e30", text, *value),
      "no material has it; give 0 for a phase that does not conduct");
  }
  return *value;
}

double parseWithUncertainty(const std::string& text, const std::string& number, double& uncertainty)
{
  const auto [value, width] = splitUncertainty(number);
  if (value == number)
    return parseValue(text, number);
  const auto half = toNumber(width);
  if (!half || !std::isfinite(*half) || *half < 0)
    throw ParameterError(fmt::format("--conductivity '{}': '{}' is not how far a conductivity may be off", text, width),
      "write half of the interval that holds it, in its unit, such as wall=0.41±0.02");
  uncertainty = *half;
  return parseValue(text, value);
}

std::string valueText(const GivenConductivity& given)
{
  return given.along == given.across ? fmt::format("{:g}", given.along)
                                     : fmt::format("{:g}:{:g}", given.along, given.across);
}

} // namespace

std::vector<GivenConductivity> parseConductivities(const std::vector<std::string>& texts)
{
  std::vector<GivenConductivity> values;
  for (const std::string& text : listItems(texts))
  {
    const auto [name, numbers] = keyValue("--conductivity", text, "NAME=VALUE");
    GivenConductivity given{ name };
    const std::size_t colon = numbers.find(':');
    given.along = parseWithUncertainty(text, numbers.substr(0, colon), given.alongUncertainty);
    given.across = given.along;
    if (colon != std::string::npos)
      given.across = parseWithUncertainty(text, numbers.substr(colon + 1), given.acrossUncertainty);
    const auto same =
      std::find_if(values.begin(), values.end(), [&](const GivenConductivity& v) { return v.phase == given.phase; });
    if (same != values.end() && (same->along != given.along || same->across != given.across))
    {
      throw ParameterError(
        "--conductivity gives '" + name + "' two values, " + valueText(*same) + " and " + valueText(given),
        "give every phase one value");
    }
    values.push_back(given);
  }
  return values;
}

void requireNames(
  const std::string& option, const std::vector<GivenConductivity>& given, const std::vector<std::string>& phases)
{
  for (const GivenConductivity& one : given)
  {
    if (!phaseMeant(phases, one.phase))
    {
      throw ParameterError(option + " names '" + one.phase + "', which is no phase of this sample",
        suggestion(one.phase, phases, "its phases are " + quotedList(phases, "and")));
    }
  }
}

void requireAxes(const PictureOptions& options, vtkImageData* image)
{
  const std::string hint =
    "make the lattice with lamella micrograph -o FILE.vti, or give an image a point array 'axis' of "
    "vectors; or give each phase one value";
  if (!isVtkImage(options.file))
  {
    throw InputError("conductivities along and across the walls, and '" + options.file +
        "' does not say which way the walls run: only a .vti can, in its point array 'axis'",
      hint);
  }
  if (image->GetPointData()->HasArray("axis") == 0)
    throw InputError("'" + options.file + "' has no point array 'axis': it does not say which way the walls run", hint);
}

} // namespace lamella::cli
