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
#include "vtkExecutive.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <exception>
#include <limits>

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

/// Does something when a block ends, however it ends.
template <class Action>
class AtEnd
{
public:
  explicit AtEnd(const Action& action)
    : action_(action)
  {
  }
  ~AtEnd() { action_(); }
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;

private:
  Action action_;
};

using Pipeline = vtkStreamingDemandDrivenPipeline;

/// @throws InputError where this rank has a piece of it only
vtkImageData* wholeInput(vtkInformation* input)
{
  auto* const image = vtkImageData::SafeDownCast(input->Get(vtkDataObject::DATA_OBJECT()));
  const int* const extent = image->GetExtent();
  const int* const whole = input->Has(Pipeline::WHOLE_EXTENT()) ? input->Get(Pipeline::WHOLE_EXTENT()) : extent;
  for (int axis = 0; axis < 3; ++axis)
    if (extent[2 * axis] > whole[2 * axis] || extent[2 * axis + 1] < whole[2 * axis + 1])
      throw lamella::InputError("this rank has a piece of a sample, and a fit takes all of it",
        "fit on one rank, or read the sample from a file");
  return image;
}

/// Leaves what a rank was asked for, of an image that is there whole.
void cropToPiece(vtkImageData* image, vtkInformation* request)
{
  const int pieces = request->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  if (pieces <= 1)
    return;
  vtkNew<vtkExtentTranslator> translator;
  translator->SetWholeExtent(image->GetExtent());
  translator->SetNumberOfPieces(pieces);
  translator->SetPiece(request->Get(Pipeline::UPDATE_PIECE_NUMBER()));
  if (translator->PieceToExtent() != 0)
    image->Crop(translator->GetExtent());
  else
    image->Initialize();
}

} // namespace

vtkStandardNewMacro(vtkMaterialFit);
vtkPrintSettingsMacro(vtkMaterialFit);
vtkAddToListMacro(vtkMaterialFit, Unknown, Unknowns, const std::string&, Unknowns);
vtkAddToListMacro(vtkMaterialFit, Measurement, Measurements, const std::string&, Measurements);

vtkOutputTypesMacro(vtkMaterialFit, "vtkImageData", "vtkTable", "vtkTable");
vtkGetOutputMacro(vtkMaterialFit, Image, vtkImageData, 0);
vtkGetOutputMacro(vtkMaterialFit, Found, vtkTable, 1);
vtkGetOutputMacro(vtkMaterialFit, Measured, vtkTable, 2);

vtkMaterialFit::vtkMaterialFit()
  : Findings(std::make_unique<lamella::FoundFit>())
{
  this->SetNumberOfOutputPorts(3);
}

vtkMaterialFit::~vtkMaterialFit() = default;

void vtkMaterialFit::SetSolver(vtkAlgorithm* solver)
{
  if (solver != this->Solver)
  {
    this->Solver = solver;
    this->SolverTime = 0;
    this->Modified();
  }
}

vtkAlgorithm* vtkMaterialFit::GetSolver()
{
  return this->Solver;
}

vtkMTimeType vtkMaterialFit::GetMTime()
{
  const vtkMTimeType solver = this->Solver != nullptr ? this->Solver->GetMTime() : 0;
  if (solver != this->SolverTime)
    this->SolverChanged = solver; // stays after the update: what shows another output asks later
  return std::max(this->Superclass::GetMTime(), this->SolverChanged);
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

int vtkMaterialFit::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return 1;
}

int vtkMaterialFit::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  for (int i = 0; i < inputVector[0]->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* const input = inputVector[0]->GetInformationObject(i);
    lamella::requestWhole(input);
    if (input->Has(Pipeline::WHOLE_EXTENT()))
      input->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  return 1;
}

int vtkMaterialFit::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  (void)lamella::takeFailure(); // what others ended with before
  return lamella::concluded(this,
    lamella::attempt(this,
      [&]
      {
        std::vector<vtkSmartPointer<vtkImageData>> samples;
        for (int i = 0; i < inputVector[0]->GetNumberOfInformationObjects(); ++i)
        {
          samples.push_back(vtkSmartPointer<vtkImageData>::New()); // the solver's, whose pipeline ends at it
          samples.back()->ShallowCopy(wholeInput(inputVector[0]->GetInformationObject(i)));
        }
        const AtEnd leave([this] { this->SolverTime = this->Solver != nullptr ? this->Solver->GetMTime() : 0; });
        this->Fit(samples, this->GetImage());
        if (lamella::isFirstPiece(outputVector))
          lamella::fillTables(this->GetFound(), this->GetMeasured(), *this->Findings);
        cropToPiece(this->GetImage(), lamella::requestedOutput(request, outputVector));
      }),
    outputVector);
}

void vtkMaterialFit::Fit(const std::vector<vtkSmartPointer<vtkImageData>>& samples, vtkImageData* output)
{
  if (samples.empty())
    throw lamella::ParameterError("there is no sample to fit", "give one at least");
  const bool touched = this->Solver != nullptr && this->Solver->GetMTime() != this->SolverTime;
  const std::unique_ptr<lamella::FitModel> model = lamella::fitModelOf(this->Solver);
  const std::vector<lamella::FitUnknown> unknowns = lamella::fitUnknowns(*model, this->Unknowns);
  std::vector<lamella::FitMeasured> measured = lamella::fitMeasured(this->Measurements, samples.size());
  if (!touched)
    this->RequireKnown(unknowns);
  vtkInformationVector* const arrays = this->GetInformation()->Get(INPUT_ARRAYS_TO_PROCESS());
  for (int i = 0; arrays != nullptr && i < arrays->GetNumberOfInformationObjects(); ++i)
    this->Solver->SetInputArrayToProcess(i, arrays->GetInformationObject(i));
  const lamella::PhaseIds phases =
    lamella::phaseIds(samples.front(), this->Solver->GetInputArrayInformation(0), lamella::Team(nullptr, nullptr));
  const AtEnd forget(
    [&]
    {
      for (const lamella::FitUnknown& u : unknowns)
        if (!u.slope)
          model->set(u, std::numeric_limits<double>::quiet_NaN());
    });
  *this->Findings = lamella::fitSamples(
    *model, unknowns, std::move(measured), samples.size(), phases.known,
    [&](std::size_t sample) { this->Solve(samples[sample]); }, this->ComputeFields);
  lamella::describe(model->output(), *this->Findings);
  lamella::continueProvenance(model->output(), "fit",
    { { "unknown", this->Unknowns }, { "measured", this->Measurements }, { "fields", this->ComputeFields } });
  output->ShallowCopy(model->output());
}

/// Of a solver that is as the last fit left it. @throws ParameterError for what it lacks since it was looked for
void vtkMaterialFit::RequireKnown(const std::vector<lamella::FitUnknown>& unknowns) const
{
  for (const lamella::FitUnknown& before : this->Findings->unknowns)
    if (!before.slope &&
      std::none_of(unknowns.begin(), unknowns.end(), [&](const auto& now) { return now.key() == before.key(); }))
      throw lamella::ParameterError(
        "the " + before.name() + " was looked for before, and the solver has no value of it any more",
        "give the solver one, or look for it again");
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
