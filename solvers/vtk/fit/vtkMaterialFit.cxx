#include "vtkMaterialFit.h"

#include "Attempt.h"
#include "FitModel.h"
#include "PhaseIds.h"
#include "SampleFit.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"

#include "vtkCommand.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"

#include <exception>

namespace
{

/// An observer, for a while.
class Watch
{
public:
  template <class Method>
  Watch(vtkObject* of, unsigned long event, vtkMaterialFit* self, Method method)
    : of_(of)
    , tag_(of->AddObserver(event, self, method))
  {
  }
  ~Watch() { of_->RemoveObserver(tag_); }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

private:
  vtkObject* of_;
  unsigned long tag_;
};

} // namespace

vtkStandardNewMacro(vtkMaterialFit);
vtkPrintSettingsMacro(vtkMaterialFit);
vtkAddToListMacro(vtkMaterialFit, Unknown, Unknowns, const std::string&, Unknowns);
vtkAddToListMacro(vtkMaterialFit, Measurement, Measurements, const std::string&, Measurements);

vtkMaterialFit::vtkMaterialFit()
  : Findings(std::make_unique<lamella::FoundFit>())
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(0);
}

vtkMaterialFit::~vtkMaterialFit() = default;

void vtkMaterialFit::SetSolver(vtkAlgorithm* solver)
{
  if (solver != this->Solver)
  {
    this->Solver = solver;
    this->Modified();
  }
}

vtkAlgorithm* vtkMaterialFit::GetSolver()
{
  return this->Solver;
}

void vtkMaterialFit::AddSample(vtkImageData* image)
{
  this->Samples.emplace_back(image);
  this->Modified();
}

vtkRemoveAllMacro(vtkMaterialFit, Samples, Samples);

vtkImageData* vtkMaterialFit::GetOutput()
{
  return this->Output;
}

const lamella::FoundFit& vtkMaterialFit::GetFindings() const
{
  return *this->Findings;
}

void vtkMaterialFit::GetSettingsLeftOut(const std::string& className, vtkStringArray* words)
{
  words->Reset();
  for (const std::string& word : lamella::settingsLeftOut(className))
    words->InsertNextValue(word);
}

void vtkMaterialFit::Update()
{
  this->SetErrorCode(vtkErrorCode::NoError);
  this->Output = nullptr;
  (void)lamella::takeFailure();
  if (lamella::attempt(this, [this] { this->Fit(); }) == lamella::Outcome::Failed)
    this->SetErrorCode(vtkErrorCode::UserError);
}

void vtkMaterialFit::Fit()
{
  if (this->Samples.empty())
    throw lamella::ParameterError("there is no sample to fit", "give one at least");
  const std::unique_ptr<lamella::FitModel> model = lamella::fitModelOf(this->Solver);
  std::vector<lamella::FitUnknown> unknowns = lamella::fitUnknowns(*model, this->Unknowns);
  std::vector<lamella::FitMeasured> measured = lamella::fitMeasured(this->Measurements, this->Samples.size());
  const lamella::PhaseIds phases = lamella::phaseIds(
    this->Samples.front(), this->Solver->GetInputArrayInformation(0), lamella::Team(nullptr, nullptr));
  *this->Findings = lamella::fitSamples(
    *model, std::move(unknowns), std::move(measured), this->Samples.size(), phases.known,
    [this](std::size_t sample) { this->Solve(this->Samples[sample]); }, this->ComputeFields);
  this->Output = model->output();
  lamella::describe(this->Output, *this->Findings);
  lamella::continueProvenance(this->Output, "fit",
    { { "unknown", this->Unknowns }, { "measured", this->Measurements }, { "fields", this->ComputeFields } });
}

/// @throws what the solver ended with; Cancelled
void vtkMaterialFit::Solve(vtkImageData* sample)
{
  this->Solver->SetInputDataObject(0, sample);
  {
    // what the solver ends with is thrown below; what it warns of is the same at each solve
    const Watch progress(this->Solver, vtkCommand::ProgressEvent, this, &vtkMaterialFit::TakeProgress);
    const Watch errors(this->Solver, vtkCommand::ErrorEvent, this, &vtkMaterialFit::Ignore);
    const Watch warnings(this->Solver, vtkCommand::WarningEvent, this, &vtkMaterialFit::Ignore);
    const Watch failures(this->Solver->GetExecutive(), vtkCommand::ErrorEvent, this, &vtkMaterialFit::Ignore);
    this->Solver->Update();
    this->Solver->SetAbortExecute(0);
  }
  if (const std::exception_ptr failure = lamella::takeFailure())
    std::rethrow_exception(failure);
  if (this->GetAbortExecute() != 0)
    throw lamella::Cancelled();
}

void vtkMaterialFit::TakeProgress()
{
  if (this->GetAbortExecute() != 0) // of a solver that is on its way out
    return;
  this->SetProgressText(this->Solver->GetProgressText());
  this->UpdateProgress(this->Solver->GetProgress());
  if (this->GetAbortExecute() != 0)
    this->Solver->SetAbortExecute(1);
}
