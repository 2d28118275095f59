#include "vtkMicrographContours.h"

#include "Attempt.h"
#include "ContourData.h"
#include "ContourField.h"
#include "FieldNumbers.h"
#include "PhaseIds.h"
#include "SurfaceDoubt.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "outlines/ContourEdit.h"
#include "outlines/ContourExtraction.h"

#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <string>

vtkStandardNewMacro(vtkMicrographContours);
vtkPrintSettingsMacro(vtkMicrographContours);

vtkMicrographContours::vtkMicrographContours() = default;

vtkInputTypeMacro(vtkMicrographContours, "vtkImageData");
vtkAllInFirstPieceMacro(vtkMicrographContours);

int vtkMicrographContours::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* const input = inputVector[0]->GetInformationObject(0);
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    std::array<int, 6> whole{};
    input->Get(Pipeline::WHOLE_EXTENT(), whole.data());
    input->Set(Pipeline::UPDATE_EXTENT(), whole.data(), 6);
  }
  return 1;
}

void vtkMicrographContours::Extract(vtkImageData* image, vtkPolyData* output)
{
  lamella::requireUpright(image);
  lamella::ContourField field;
  lamella::OutlineRecipe recipe;
  nlohmann::json parameters;
  if (this->Basis == PHASES)
  {
    const lamella::PhaseIds phases =
      lamella::phaseIds(image, this->GetInputArrayInformation(0), lamella::Team(nullptr, nullptr));
    const std::size_t lumen = lamella::findVoid(phases, this->LumenPhase, "lumens");
    field = lamella::contourField(lamella::latticeOf(image), phases, lumen);
    recipe.lumen = phases.names[lumen];
    recipe.doubt = lamella::surfaceDoubtOf(image);
    parameters = { { "lumen", recipe.lumen }, { "smooth", this->Smooth } };
    if (this->Smooth)
      parameters["wavelength"] = this->Wavelength;
  }
  else
  {
    const char* const array = this->GetInputArrayInformation(1)->Get(vtkDataObject::FIELD_NAME());
    field =
      lamella::contourField(image, array != nullptr ? array : "", this->Basis == SHARES, this->Level, this->LumenBelow);
    recipe.basis = this->Basis == SHARES ? lamella::OutlineRecipe::Shares : lamella::OutlineRecipe::Level;
    recipe.level = this->Level;
    recipe.below = this->LumenBelow;
    parameters = { { "array", field.array }, { "lumen_below", this->LumenBelow } };
    this->Basis == SHARES ? parameters["shares"] = true : parameters["level"] = this->Level;
  }
  const lamella::Lattice& lattice = field.image.lattice;

  recipe.array = field.array;
  recipe.pixel = lattice.spacing;
  recipe.options = { this->Smooth, this->Wavelength, this->Tolerance,
    std::max(this->SmallestArea, lamella::micrograph::areaOfCircle(this->LeastDiameter)), this->LeastSolidity };
  const lamella::micrograph::Extraction found =
    lamella::micrograph::extractContours(field.image, 0, field.level, recipe.options);
  for (const std::string& warning : found.warnings)
    vtkWarningMacro(<< warning);
  const double half = lattice.spacing / 2;
  const std::string creator = this->GetClassName();
  output->ShallowCopy(lamella::toPolyData(
    found.contours, creator, { lattice.origin[0] - half, lattice.origin[1] - half, lattice.origin[2] }));

  const lamella::micrograph::ExtractReport& report = found.report;
  const auto number = [&](const char* name, auto value, const char* unit, const char* text)
  { lamella::setFieldNumber(output, name, static_cast<double>(value), unit, text, creator); };
  number("lumens", report.lumens, "1", "lumens that are left");
  number("open_lumens", report.openLumens, "1", "of these, cut by the picture's border");
  number("islands", report.islands, "1", "pieces of wall inside lumens, taken out");
  number("nested_lumens", report.nestedLumens, "1", "lumens in such pieces, taken out");
  number("small_lumens", report.small, "1", "lumens below the smallest area, taken for wall");
  number("ragged_lumens", report.ragged, "1", "lumens below the least solidity, taken for wall");
  number("area_missing", report.areaMissing, "pixels^2", "largest difference of a chain's area from its pixels'");
  lamella::setFieldTexts(output, "report", report.lines());
  lamella::setRecipe(output, recipe);
  if (const auto source = lamella::fieldText(image, "pixel_size_source"))
    lamella::setFieldText(output, "pixel_size_source", *source);
  parameters["tolerance"] = this->Tolerance;
  parameters["smallest_area"] = recipe.options.smallestArea;
  parameters["least_solidity"] = this->LeastSolidity;
  lamella::setProvenance(output, lamella::provenance(image));
  lamella::continueProvenance(output, "contours", parameters);
}

int vtkMicrographContours::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* const output = vtkPolyData::GetData(outputVector);
  output->Initialize();
  if (!lamella::isFirstPiece(outputVector))
    return 1;
  if (lamella::attempt(this, [&] { this->Extract(vtkImageData::GetData(inputVector[0]), output); }) !=
    lamella::Outcome::Done)
  {
    output->Initialize();
    return 0;
  }
  return 1;
}
