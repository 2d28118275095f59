#include "ContourField.h"

#include "PhaseIds.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "core/Suggestion.h"
#include "lattice/PhaseNames.h"
#include "outlines/ShareLevel.h"
#include "segmentation/SegmentTypes.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace lamella
{
namespace
{

constexpr const char* kDefault = "lumen_share";
constexpr double kRoundOff = 1e-6;

vtkDataArray* arrayOf(vtkImageData* image, const std::string& name)
{
  vtkDataArray* const array = image->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
  {
    throw InputError("there is no point array '" + name + "' of numbers",
      image->GetCellData()->GetArray(name.c_str()) != nullptr ? "it lies at the cells: move it to the points"
                                                              : "choose another array for the level or the shares");
  }
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("the array '" + name + "' has " + std::to_string(array->GetNumberOfComponents()) + " components",
      "take one of them");
  }
  return array;
}

std::string textOf(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

} // namespace

ContourField contourField(vtkImageData* image, const std::string& name, bool shares, double level, bool below)
{
  if (!std::isfinite(level))
    throw ParameterError("the level is " + textOf(level), "give a number between the lumens' values and the walls'");
  ContourField field;
  field.array = name.empty() ? kDefault : name;
  vtkDataArray* const array = arrayOf(image, field.array);
  const int type = array->GetDataType();
  const double full = type == VTK_UNSIGNED_CHAR ? 255 : type == VTK_UNSIGNED_SHORT ? 65535 : 1;

  const auto values = vtk::DataArrayValueRange<1>(array);
  field.level.reserve(static_cast<std::size_t>(values.size()));
  for (const auto each : values)
  {
    const double value = static_cast<double>(each) / full;
    if (!std::isfinite(value))
      throw InputError("the array '" + field.array + "' has values that are no finite numbers", "give every node one");
    if (shares && !(value >= -kRoundOff && value <= 1 + kRoundOff))
    {
      throw InputError("the array '" + field.array + "' has the value " + textOf(value) + ", and shares go from 0 to 1",
        "scale it, or take outlines at a level");
    }
    const double above = shares ? value : value - level;
    field.level.push_back(static_cast<float>(!below ? above : shares ? 1 - above : -above));
  }
  const Lattice lattice = latticeOf(image);
  if (shares)
    field.level = micrograph::levelOfShares(lattice, field.level);
  field.image = { lattice, {}, PhaseTable({ "lumen", "wall" }) };
  field.image.phase.resize(field.level.size());
  std::transform(field.level.begin(), field.level.end(), field.image.phase.begin(),
    [](float value) { return static_cast<std::uint8_t>(value > 0 ? 0 : 1); });
  return field;
}

ContourField contourField(const Lattice& lattice, const PhaseIds& phases, std::size_t lumen)
{
  ContourField field{ { lattice, {}, PhaseTable({ "lumen", "wall" }) }, {}, phases.array };
  field.image.phase.resize(phases.ids.size());
  std::transform(phases.ids.begin(), phases.ids.end(), field.image.phase.begin(),
    [lumen](std::uint8_t id) { return static_cast<std::uint8_t>(id == lumen ? 0 : 1); });
  return field;
}

PhaseIds phasesCalled(vtkImageData* image, const std::string& array)
{
  const auto find = [&]
  {
    vtkDataArray* const found = image->GetPointData()->GetArray(array.c_str());
    if (found == nullptr)
      throw InputError("there is no point array '" + array + "', in which the outlines were found",
        "give the picture that the outlines are from");
    return found;
  };
  return phaseIds(image, find, Team(nullptr, nullptr));
}

ContourField contourField(vtkImageData* image, const OutlineRecipe& recipe)
{
  if (recipe.basis != OutlineRecipe::Phases)
    return contourField(image, recipe.array, recipe.basis == OutlineRecipe::Shares, recipe.level, recipe.below);
  const PhaseIds phases = phasesCalled(image, recipe.array);
  return contourField(latticeOf(image), phases, findVoid(phases, recipe.lumen, "lumens"));
}

LamellaLabels lamellaLabels(
  vtkImageData* picture, const std::optional<OutlineRecipe>& recipe, const std::string& wanted)
{
  if (picture == nullptr || !recipe || recipe->basis != OutlineRecipe::Phases)
  {
    throw ParameterError(
      "a middle lamella from labels needs a picture of labels, and there is none", "choose growth, or give it");
  }
  const PhaseIds phases = phasesCalled(picture, recipe->array);
  const std::string known = "its phases are " + quotedList(phases.names, "and");
  const auto found = phaseMeant(phases.names, wanted.empty() ? "middle lamella" : wanted);
  if (!found && !wanted.empty())
  {
    throw ParameterError(
      "'" + wanted + "', the middle lamella, is no phase of the picture", suggestion(wanted, phases.names, known));
  }
  if (!found)
  {
    throw InputError("which phase is the middle lamella? The picture has " + quotedList(phases.names, "and"),
      "say which is the lamella's phase, or choose growth");
  }
  return { { latticeOf(picture), { phases.ids.begin(), phases.ids.end() }, {} }, static_cast<std::uint8_t>(*found) };
}

double spacingOf(double asked, const std::optional<OutlineRecipe>& recipe, double median)
{
  const double spacing = asked > 0 ? asked : recipe ? recipe->pixel : median / 4;
  if (!(spacing > 0))
  {
    throw ParameterError("there is one lumen only, whose walls have no thickness to choose a spacing by",
      "give the spacing of the lattice, such as 5e-7 m");
  }
  return spacing;
}

void setRecipe(vtkDataObject* outlines, const OutlineRecipe& recipe)
{
  const micrograph::ExtractOptions& o = recipe.options;
  const nlohmann::json json{ { "basis", recipe.basis }, { "array", recipe.array }, { "lumen", recipe.lumen },
    { "level", recipe.level }, { "below", recipe.below }, { "pixel", recipe.pixel }, { "doubt", recipe.doubt },
    { "smooth", o.smooth }, { "wavelength", o.wavelength }, { "tolerance", o.tolerance },
    { "smallest_area", o.smallestArea }, { "least_solidity", o.leastSolidity } };
  setFieldText(outlines, "extraction", json.dump());
}

std::optional<OutlineRecipe> recipeOf(vtkDataObject* outlines)
{
  const auto text = fieldText(outlines, "extraction");
  if (!text)
    return {};
  try
  {
    const nlohmann::json json = nlohmann::json::parse(*text);
    OutlineRecipe recipe;
    const auto read = [&json](const char* name, auto& value) { json.at(name).get_to(value); };
    read("basis", recipe.basis);
    read("array", recipe.array);
    read("lumen", recipe.lumen);
    read("level", recipe.level);
    read("below", recipe.below);
    read("pixel", recipe.pixel);
    if (json.contains("doubt"))
      read("doubt", recipe.doubt);
    else if (json.at("segmented").get<bool>()) // as earlier versions wrote it
      recipe.doubt = micrograph::surfaceDoubt(0, std::numeric_limits<double>::infinity());
    read("smooth", recipe.options.smooth);
    read("wavelength", recipe.options.wavelength);
    read("tolerance", recipe.options.tolerance);
    read("smallest_area", recipe.options.smallestArea);
    read("least_solidity", recipe.options.leastSolidity);
    return recipe;
  }
  catch (const nlohmann::json::exception&)
  {
    throw InputError("what the outlines say of how they were found cannot be read: " + *text,
      "find them again, or remove the field data 'extraction'");
  }
}

} // namespace lamella
