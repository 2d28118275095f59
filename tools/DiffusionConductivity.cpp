#include "DiffusionConductivity.h"

#include "GridFile.h"
#include "Text.h"
#include "Units.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>

#include <vtkDataArray.h>
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
    given.along = parseValue(text, numbers.substr(0, colon));
    given.across = colon == std::string::npos ? given.along : parseValue(text, numbers.substr(colon + 1));
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

std::vector<std::array<float, 2>> readAxes(const PictureOptions& options, const Sample& sample)
{
  const std::string hint = "make the lattice with lamella micrograph -o FILE.vti, or give each phase one value";
  if (!isVtkImage(options.file))
  {
    throw InputError("conductivities along and across the walls, and '" + options.file +
        "' does not say which way the walls run: only a .vti can, in its point array 'axis'",
      hint);
  }
  const auto grid = readAs<vtkImageData>(options.file, "picture", hint.c_str());
  vtkDataArray* const array = grid->GetPointData()->GetArray("axis");
  if (array == nullptr)
  {
    throw InputError("'" + options.file + "' has no point array 'axis': it does not say which way the walls run", hint);
  }
  const auto& whole = sample.fileSize;
  if (array->GetNumberOfComponents() < 2 || array->GetNumberOfTuples() != whole[0] * whole[1])
  {
    throw InputError(fmt::format("the array 'axis' of '{}' has {} values of {} components for {} nodes", options.file,
                       array->GetNumberOfTuples(), array->GetNumberOfComponents(), whole[0] * whole[1]),
      hint);
  }
  Lattice file = sample.image.lattice;
  file.size = whole;
  const auto first = sample.window ? firstNode(file, *sample.window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  std::vector<std::array<float, 2>> axes;
  axes.reserve(static_cast<std::size_t>(sample.image.lattice.count()));
  for (std::int64_t y = 0; y < sample.image.lattice.size[1]; ++y)
  {
    for (std::int64_t x = 0; x < sample.image.lattice.size[0]; ++x)
    {
      const vtkIdType node = file.index(first[0] + x, first[1] + y);
      axes.push_back(
        { static_cast<float>(array->GetComponent(node, 0)), static_cast<float>(array->GetComponent(node, 1)) });
    }
  }
  return axes;
}

} // namespace lamella::cli
