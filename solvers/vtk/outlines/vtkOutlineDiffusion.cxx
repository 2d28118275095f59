#include "vtkOutlineDiffusion.h"

#include "Attempt.h"
#include "ContourData.h"
#include "ContourField.h"
#include "OutlineFindings.h"
#include "PhaseIds.h"
#include "ThreadCount.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "core/Suggestion.h"
#include "lattice/PhaseNames.h"
#include "outlines/LabelledLamella.h"
#include "outlines/MiddleLamella.h"
#include "outlines/WallDirection.h"
#include "outlines/WallThickness.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace lbm = lamella::lbm;
namespace micrograph = lamella::micrograph;

namespace
{

const std::array<std::string, 3> kPhases{ "lumen", "wall", "middle lamella" };

/// Of lumen, wall and middle lamella; the last only where it was given. @throws ParameterError, NoPathError
std::vector<double> conductivities(const std::map<std::string, double>& table)
{
  std::array<std::optional<double>, 3> values;
  for (const auto& [name, value] : table)
  {
    const auto phase = lamella::phaseMeant(kPhases, name);
    if (!phase)
    {
      throw lamella::ParameterError(fmt::format("'{}', which is given a conductivity, is no phase of outlines", name),
        lamella::suggestion(name, std::vector<std::string>{ "lumen", "wall", "lamella" },
          "their phases are " + lamella::quotedList(kPhases, "and")));
    }
    if (!std::isfinite(value) || value < 0)
    {
      throw lamella::ParameterError(
        fmt::format("a conductivity of {} for '{}' is no finite number of at least 0", value, name),
        "give a positive value, or 0 for a phase that does not conduct");
    }
    if (value != 0 && !lamella::plausible(value))
    {
      throw lamella::ParameterError(
        fmt::format("a conductivity of {} for '{}' is not between 1e-30 and 1e30", value, name),
        "no material has it; give 0 for a phase that does not conduct");
    }
    std::optional<double>& place = values[*phase];
    if (place && *place != value)
    {
      throw lamella::ParameterError(
        fmt::format("'{}' is given two conductivities, {:g} and {:g}", kPhases[*phase], *place, value),
        "give every phase one value");
    }
    place = value;
  }
  for (std::size_t i = 0; i < 2; ++i)
  {
    if (!values[i])
    {
      throw lamella::ParameterError(fmt::format("no conductivity was given for '{}'", kPhases[i]),
        fmt::format("give it one: {}=VALUE", kPhases[i]));
    }
  }
  std::vector<double> all{ *values[0], *values[1] };
  if (values[2])
    all.push_back(*values[2]);
  if (std::ranges::all_of(all, [](double value) { return value == 0; }))
  {
    throw lamella::NoPathError(
      "no phase conducts: all conductivities are 0", "give at least one phase a value above 0");
  }
  return all;
}

/// The picture as outlines were found in it.
lamella::ContourField fieldOf(
  vtkImageData* picture, const std::optional<lamella::OutlineRecipe>& recipe, const micrograph::ContourSet& contours)
{
  if (!recipe)
  {
    throw lamella::InputError("these outlines do not say how they were found in a picture",
      "give outlines of MicrographContours, or leave the picture out");
  }
  lamella::requireUpright(picture);
  lamella::ContourField field = lamella::contourField(picture, *recipe);
  const lamella::Lattice& lattice = field.image.lattice;
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    const double length = static_cast<double>(lattice.size[axis]) * lattice.spacing;
    if (lattice.dimension != 2 || std::abs(contours.size[axis] - length) > 1e-6 * length)
    {
      throw lamella::InputError(
        fmt::format("outlines of a picture of {:g} × {:g} m, and one of {:g} × {:g} m", contours.size[0],
          contours.size[1], static_cast<double>(lattice.size[0]) * lattice.spacing,
          static_cast<double>(lattice.size[1]) * lattice.spacing),
        "give the picture that the outlines were found in");
    }
  }
  return field;
}

} // namespace

struct vtkOutlineDiffusion::Internals
{
  std::map<std::string, double> Conductivity;
  lamella::OutlineFindings Found;
};

vtkStandardNewMacro(vtkOutlineDiffusion);

vtkOutlineDiffusion::vtkOutlineDiffusion()
  : Internal(std::make_unique<Internals>())
{
  this->Lamella = GROWTH;
}

vtkOutlineDiffusion::~vtkOutlineDiffusion() = default;

vtkSetNamedMacro(vtkOutlineDiffusion, Conductivity, Conductivities, Internal->Conductivity);

double vtkOutlineDiffusion::GetConductivity(const char* phase)
{
  return lamella::named(this->Internal->Conductivity, phase);
}

const lamella::OutlineFindings& vtkOutlineDiffusion::GetFindings() const
{
  return this->Internal->Found;
}

void vtkOutlineDiffusion::RequireConductivities() const
{
  if (conductivities(this->Internal->Conductivity).size() > 2 && this->Lamella == NONE)
  {
    throw lamella::ParameterError("a conductivity of the middle lamella, and there is none",
      "leave it out, or choose how the lamella is found, such as growth");
  }
}

vtkGetOutputMacro(vtkOutlineDiffusion, Output, vtkPolyData, 0);
vtkOutputTypesMacro(vtkOutlineDiffusion, "vtkPolyData");
vtkAllInFirstPieceMacro(vtkOutlineDiffusion);

int vtkOutlineDiffusion::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* const output = vtkPolyData::GetData(outputVector);
  output->Initialize();
  this->Internal->Found = {};
  if (!lamella::isFirstPiece(outputVector))
    return 1;
  const lamella::Outcome outcome = lamella::attempt(
    this, [&] { this->Solve(vtkPolyData::GetData(inputVector[0]), vtkImageData::GetData(inputVector[1]), output); });
  return lamella::concluded(this, outcome, outputVector);
}

void vtkOutlineDiffusion::Solve(vtkPolyData* outlines, vtkImageData* picture, vtkPolyData* output)
{
  const micrograph::ContourSet contours = lamella::contoursFrom(outlines);
  const std::optional<lamella::OutlineRecipe> recipe = lamella::recipeOf(outlines);
  lamella::OutlineFindings& found = this->Internal->Found;
  found.picture = picture != nullptr;
  found.targetError = this->TargetError;
  found.direction = this->Direction == ALL ? "all" : this->Direction == X ? "x" : "y";
  const micrograph::WallThickness thickness = micrograph::wallThickness(contours);
  found.spacing = lamella::spacingOf(this->Spacing, recipe, thickness.median);

  lbm::ContourStudyOptions study;
  this->RequireConductivities();
  study.conductivity = conductivities(this->Internal->Conductivity);
  for (std::size_t i = 0; i < study.conductivity.size(); ++i)
    found.conductivity.emplace_back(kPhases[i], study.conductivity[i]);
  if (study.conductivity.size() > 2 && study.conductivity[2] == study.conductivity[1])
    study.conductivity.pop_back();
  study.spacing = found.spacing;
  study.axes = this->Direction == ALL ? std::vector<int>{ X, Y } : std::vector<int>{ this->Direction };
  study.targetError = this->TargetError;
  study.steady.threads = lamella::threadCount(this->Threads);

  const bool ownLamella = study.conductivity.size() > 2;
  const lbm::ContourBudget budget = lbm::contourBudget(contours, found.spacing, ownLamella);
  study.mostNodes = budget.mostNodes;
  if (picture != nullptr)
  {
    const lamella::ContourField field = fieldOf(picture, recipe, contours);
    study.pixel = field.image.lattice.spacing;
    study.shares = recipe->basis == lamella::OutlineRecipe::Shares;
    study.coarser = micrograph::coarserOutlines(field.image, 0, field.level, recipe->options);
    study.sealed = micrograph::sealedOutlines(contours, study.pixel);
    if (recipe->doubt > 0)
      study.moved = micrograph::movedOutlines(contours, recipe->doubt * study.pixel);
  }
  lamella::LamellaLabels labels;
  micrograph::LamellaOptions how;
  if (ownLamella && this->Lamella == LABELS)
    labels = lamella::lamellaLabels(picture, recipe, this->LamellaPhase);
  how.method = this->Lamella == CONSTANT ? micrograph::LamellaMethod::Constant : micrograph::LamellaMethod::Growth;
  // The same on every lattice, whose outlines are a little longer or shorter.
  how.thickness = this->LamellaThickness > 0 ? this->LamellaThickness : micrograph::usualLamella(thickness.median);
  how.radius = this->LamellaRadius >= 0 ? this->LamellaRadius : thickness.median / 4;
  if (ownLamella)
  {
    study.phases = [this, &labels, &how](const micrograph::FittedContours& fitted, micrograph::ContourLattice& lattice)
    {
      micrograph::ContourLatticeOptions make;
      make.spacing = fitted.lattice.spacing;
      make.lines = 0;
      const micrograph::ContourLattice own = micrograph::contourLattice(fitted.contours, make);
      lattice.image = this->Lamella == LABELS
        ? micrograph::labelledLamella(own, labels.image, labels.lamella, fitted.stretch)
        : micrograph::middleLamella(own, micrograph::wallDirections(fitted.contours, own), how).image;
      if (this->CheckAbort())
        throw lamella::Cancelled();
    };
  }
  study.plan = [this, &budget](const lbm::ContourPlan& plan)
  {
    std::string words = lbm::text(plan, budget);
    this->InvokeEvent(PLAN_EVENT, words.data());
  };
  study.steady.progress = [this, progress = lbm::ContourProgress(study)](double share, const char* what) mutable
  {
    this->SetProgressText(what);
    this->UpdateProgress(progress(share));
    return !this->CheckAbort();
  };
  found.answers = lbm::studyContours(contours, study, MPI_COMM_SELF);

  for (const lbm::ContourAnswer& answer : found.answers)
  {
    if (!std::isfinite(answer.pictureError))
    {
      found.warnings.push_back(fmt::format("the error along {} that the picture's pixels leave is not known: pictures "
                                           "of every second pixel have no lumens or no walls",
        answer.axis == X ? 'x' : 'y'));
      vtkWarningMacro(<< found.warnings.back());
    }
  }
  if (this->TargetError > 0)
  {
    found.shortfall = lbm::shortfall(found.answers, this->TargetError);
    if (!found.shortfall.message.empty())
      vtkWarningMacro(<< found.shortfall.message << "\nhint: " << found.shortfall.hint);
  }
  output->ShallowCopy(outlines);
  lamella::describe(output, found);
  nlohmann::json parameters = lamella::settingsAsJson(this);
  parameters["spacing"] = found.spacing;
  for (const auto& [name, value] : found.conductivity)
    parameters["conductivity"][name] = value;
  lamella::continueProvenance(output, "outline_diffusion", parameters);
}
