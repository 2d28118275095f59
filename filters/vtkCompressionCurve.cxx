#include "vtkCompressionCurve.h"

#include "Attempt.h"
#include "Columns.h"
#include "FieldNumbers.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "compression/CompressionCurve.h"
#include "core/Error.h"

#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace compression = lamella::compression;

namespace
{

constexpr const char* curveCreator = "vtkCompressionCurve";
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A column of numbers. @throws InputError
std::vector<double> columnOf(vtkTable* table, vtkInformation* choice, const char* what)
{
  const std::string name = choice->Get(vtkDataObject::FIELD_NAME());
  vtkAbstractArray* const column = table->GetColumnByName(name.c_str());
  auto* const numbers = vtkDataArray::SafeDownCast(column);
  if (numbers == nullptr || numbers->GetNumberOfComponents() != 1)
  {
    std::string there;
    for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
    {
      const char* const known = table->GetColumnName(i);
      there += (i > 0 ? ", " : "") + std::string(known != nullptr ? known : "(no name)");
    }
    throw lamella::InputError(column == nullptr
        ? "the table has no column '" + name + "'; there are: " + (there.empty() ? "none" : there)
        : "the column '" + name + "' does not hold one number a row",
      std::string("choose the column of ") + what);
  }
  std::vector<double> values(static_cast<std::size_t>(numbers->GetNumberOfTuples()));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = numbers->GetTuple1(static_cast<vtkIdType>(i));
  return values;
}

void addNumbers(vtkTable* table, const compression::CompressionCurve& curve)
{
  const auto set = [&](const char* name, double value, const char* unit, const char* text)
  { lamella::setFieldNumber(table, name, value, unit, text, curveCreator); };
  const auto pair = [&](const char* name, double low, double high, const char* text) {
    lamella::setFieldNumbers(table, name, std::array{ low, high }, "1", text, curveCreator);
  };
  const bool linear = curve.linear.has_value();
  const compression::LinearPart line = curve.linear.value_or(compression::LinearPart{});
  set("curve_stiffness", linear ? line.slope : none, "Pa", "slope of the fitted line");
  set("curve_stiffness_error", linear ? line.standardError : none, "Pa", "standard error of the slope");
  set("curve_intercept", linear ? line.intercept : none, "Pa", "stress of the fitted line at no strain");
  set("curve_r2", linear ? line.r2 : none, "1", "share of the variance that the line explains");
  set("curve_toe", linear ? line.toe() : none, "1", "strain at which the fitted line begins");
  pair(
    "curve_fit_range", linear ? line.low : none, linear ? line.high : none, "strains of the first and last row fitted");
  set("curve_fit_rows", static_cast<double>(line.rows), "1", "rows fitted");
  const auto point = [&](const std::string& name, const std::optional<compression::CurvePoint>& at, const char* text)
  {
    set(("curve_" + name + "_strain").c_str(), at ? at->strain : none, "1", text);
    set(("curve_" + name + "_stress").c_str(), at ? at->stress : none, "Pa", text);
  };
  point("yield", curve.yield, "where the curve meets the fitted line moved by the offset");
  point("peak", curve.peak, "first maximum");
  const bool flat = curve.plateau.has_value();
  set("curve_plateau_stress", flat ? curve.plateau->stress : none, "Pa", "mean over the plateau's strains");
  pair("curve_plateau_range", flat ? curve.plateau->low : none, flat ? curve.plateau->high : none,
    "the plateau's strains");
  set("curve_plateau_end_strain", curve.plateauEnd ? curve.plateauEnd->strain : none, "1",
    "where the stress is 1.3 times the plateau's");
  const bool dense = curve.densification.has_value();
  const compression::Densification at = curve.densification.value_or(compression::Densification{});
  const char* const onset = "where the efficiency is largest";
  set("curve_densification_strain", dense ? at.strain : none, "1", onset);
  set("curve_densification_stress", dense ? at.stress : none, "Pa", onset);
  set("curve_densification_energy", dense ? at.energy : none, "J/m^3", onset);
  set("curve_densification_efficiency", dense ? at.efficiency : none, "1", onset);
  set("curve_energy", curve.energy.back(), "J/m^3", "absorbed by all of the curve");
  lamella::setFieldTexts(table, "curve_missing", curve.missing);
}

} // namespace

vtkStandardNewMacro(vtkCompressionCurve);
vtkPrintSettingsMacro(vtkCompressionCurve);

vtkCompressionCurve::vtkCompressionCurve()
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_ROWS, "strain");
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_ROWS, "stress");
}

vtkAllInFirstPieceMacro(vtkCompressionCurve);

int vtkCompressionCurve::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // ranks that press a specimen together must all be asked for their pieces: the first has the curve
  if (!lamella::Team::together(vtkMultiProcessController::GetGlobalController(), outputVector->GetInformationObject(0)))
    lamella::requestWhole(inputVector[0]->GetInformationObject(0));
  return 1;
}

void vtkCompressionCurve::Run(vtkTable* input, vtkTable* output)
{
  compression::CurveOptions options;
  options.stiffnessRange = { this->StiffnessRange[0], this->StiffnessRange[1] };
  options.window = this->Window;
  options.offset = this->Offset;
  options.smoothing = this->Smoothing;
  options.prominence = this->Prominence;
  if (this->PlateauRange[0] != 0 || this->PlateauRange[1] != 0)
    options.plateauRange = { this->PlateauRange[0], this->PlateauRange[1] };
  const std::vector<double> strain = columnOf(input, this->GetInputArrayInformation(0), "strains");
  const std::vector<double> stress = columnOf(input, this->GetInputArrayInformation(1), "stresses [Pa]");
  const compression::CompressionCurve curve = compression::compressionCurve(strain, stress, options);
  output->ShallowCopy(input);
  const lamella::Columns columns{ output->GetRowData(), strain, curveCreator };
  const auto add = [&](const char* name, const char* unit, const char* text, const std::vector<double>& values)
  { columns.numbers(name, unit, text, [&](std::size_t row) { return values[row]; }); };
  add("absorbed_energy", "J/m^3", "integral of the stress over the strain", curve.energy);
  add("efficiency", "1", "absorbed energy over the smoothed stress", curve.efficiency);
  add("smooth_stress", "Pa", "stress, smoothed", curve.smooth);
  addNumbers(output, curve);
  lamella::setProvenance(output, lamella::provenance(input));
  lamella::continueProvenance(output, "compression_curve",
    { { "stiffness_range", options.stiffnessRange }, { "window", options.window }, { "offset", options.offset },
      { "plateau_range", std::array{ this->PlateauRange[0], this->PlateauRange[1] } },
      { "smoothing", options.smoothing }, { "prominence", options.prominence } });
}

int vtkCompressionCurve::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkTable* const output = vtkTable::GetData(outputVector);
  output->Initialize();
  if (!lamella::isFirstPiece(outputVector))
    return 1;
  if (lamella::attempt(this, [&] { this->Run(vtkTable::GetData(inputVector[0]), output); }) != lamella::Outcome::Done)
  {
    output->Initialize();
    return 0;
  }
  return 1;
}
