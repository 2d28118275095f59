#include "FitModel.h"

#include "FieldNumbers.h"
#include "SteadyFindings.h"
#include "vtkSteadyDiffusion.h"
#include "vtkVoxelStiffness.h"

#include "core/Error.h"
#include "lattice/AxisNames.h"
#include "lattice/PhaseNames.h"

#include "vtkImageData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace lamella
{

namespace
{

class DiffusionModel final : public FitModel
{
public:
  explicit DiffusionModel(vtkSteadyDiffusion* solver)
    : solver_(solver)
    , estimate_(solver->GetEstimateError())
    , field_(solver->GetComputeField())
    , flux_(solver->GetComputeFlux())
  {
    solver_->SetEstimateError(false);
    solver_->SetComputeField(false);
    solver_->SetComputeFlux(false);
    solver_->SetComputeSensitivity(true);
  }
  ~DiffusionModel() override
  {
    if (!finished_)
    {
      solver_->SetEstimateError(estimate_);
      solver_->SetComputeField(field_);
      solver_->SetComputeFlux(flux_);
    }
  }
  DiffusionModel(const DiffusionModel&) = delete;
  DiffusionModel& operator=(const DiffusionModel&) = delete;

  std::vector<std::string> properties() const override { return { "conductivity", "conductivity-across" }; }
  std::string form() const override { return "PHASE, or conductivity-across:PHASE"; }
  void set(const FitUnknown& unknown, double value) override
  {
    unknown.property == "conductivity" ? solver_->SetConductivity(unknown.phase.c_str(), value)
                                       : solver_->SetConductivityAcross(unknown.phase.c_str(), value);
  }
  double startOf(const FitUnknown&, double measured) const override { return measured; }
  std::vector<std::string> quantities() const override
  {
    std::vector<std::string> names;
    for (const auto& answer : solver_->GetFindings().answers)
      names.emplace_back(axisNames[static_cast<std::size_t>(answer.axis)]);
    return names;
  }
  double value(const std::string& quantity) const override
  {
    const auto& answer = answerOf(quantity);
    return answer.result.effective[static_cast<std::size_t>(answer.axis)];
  }
  double derivative(const std::string& quantity, const FitUnknown& by) const override
  {
    const auto& answer = answerOf(quantity);
    const auto id = phaseMeant(solver_->GetFindings().phases, by.phase);
    const auto& list = by.property == "conductivity" ? answer.derivatives.along : answer.derivatives.across;
    if (!id || *id >= list.size())
      return 0.0;
    return list[*id];
  }
  void finish(bool fields) override
  {
    solver_->SetEstimateError(estimate_);
    solver_->SetComputeField(fields);
    solver_->SetComputeFlux(fields);
    finished_ = true;
  }
  double error(const std::string& quantity) const override
  {
    return estimate_ ? answerOf(quantity).error.relative * value(quantity) : unknown;
  }
  vtkImageData* output() const override { return solver_->GetOutput(); }

private:
  [[nodiscard]] const lbm::DiffusionAnswer& answerOf(const std::string& quantity) const
  {
    const auto& answers = solver_->GetFindings().answers;
    return *std::find_if(answers.begin(), answers.end(),
      [&](const auto& a) { return quantity == axisNames[static_cast<std::size_t>(a.axis)]; });
  }

  vtkSmartPointer<vtkSteadyDiffusion> solver_;
  bool estimate_, field_, flux_;
  bool finished_ = false;
};

class StiffnessModel final : public FitModel
{
public:
  explicit StiffnessModel(vtkVoxelStiffness* solver)
    : solver_(solver)
    , estimate_(solver->GetEstimateError())
  {
    solver_->SetEstimateError(false);
    solver_->SetComputeSensitivity(true);
  }
  ~StiffnessModel() override { solver_->SetEstimateError(estimate_); }
  StiffnessModel(const StiffnessModel&) = delete;
  StiffnessModel& operator=(const StiffnessModel&) = delete;

  std::vector<std::string> properties() const override
  {
    return { "young", "young-across", "shear", "poisson", "poisson-across" };
  }
  std::string form() const override { return "PROPERTY:PHASE, such as young:wall"; }
  void set(const FitUnknown& unknown, double value) override
  {
    const char* const phase = unknown.phase.c_str();
    if (unknown.property == "young")
      solver_->SetYoungsModulus(phase, value);
    else if (unknown.property == "young-across")
      solver_->SetYoungsModulusAcross(phase, value);
    else if (unknown.property == "shear")
      solver_->SetShearModulus(phase, value);
    else if (unknown.property == "poisson")
      solver_->SetPoissonsRatio(phase, value);
    else
      solver_->SetPoissonsRatioAcross(phase, value);
  }
  double startOf(const FitUnknown& unknown, double measured) const override
  {
    return unknown.property.starts_with("poisson") ? 0.3 : (unknown.property == "shear" ? 1 : 3) * measured;
  }
  bool scales(const FitUnknown& unknown) const override { return !unknown.property.starts_with("poisson"); }
  std::vector<std::string> quantities() const override { return fieldTexts(output(), "constant_names"); }
  double value(const std::string& quantity) const override { return number("constants", quantity); }
  double derivative(const std::string& quantity, const FitUnknown& by) const override
  {
    const std::vector<std::string> phases = fieldTexts(output(), "phase_names");
    const auto id = phaseMeant(phases, by.phase);
    const std::vector<std::string> numbers = fieldTexts(output(), "material_numbers");
    const auto place = std::find(numbers.begin(), numbers.end(), by.property + ":" + (id ? phases[*id] : ""));
    if (place == numbers.end())
      return 0; // none of its voxels is there
    return number("constants_sensitivity", quantity, static_cast<std::size_t>(place - numbers.begin()));
  }
  void finish(bool) override { solver_->SetEstimateError(estimate_); }
  double error(const std::string& quantity) const override { return number("constants_error", quantity); }
  vtkImageData* output() const override { return solver_->GetImage(); }

private:
  /// @param row of several numbers of each quantity
  [[nodiscard]] double number(const char* name, const std::string& quantity, std::size_t row = 0) const
  {
    const std::vector<std::string> names = quantities();
    const std::vector<double> values = fieldNumbers(output(), name);
    const auto at =
      row * names.size() + static_cast<std::size_t>(std::find(names.begin(), names.end(), quantity) - names.begin());
    return at < values.size() ? values[at] : unknown;
  }

  vtkSmartPointer<vtkVoxelStiffness> solver_;
  bool estimate_;
};

} // namespace

std::unique_ptr<FitModel> fitModelOf(vtkAlgorithm* solver)
{
  if (auto* const diffusion = vtkSteadyDiffusion::SafeDownCast(solver))
    return std::make_unique<DiffusionModel>(diffusion);
  if (auto* const stiffness = vtkVoxelStiffness::SafeDownCast(solver))
    return std::make_unique<StiffnessModel>(stiffness);
  throw ParameterError(solver == nullptr ? std::string("there is no solver to fit with")
                                         : std::string("a ") + solver->GetClassName() + " cannot be fitted",
    "give a vtkSteadyDiffusion or a vtkVoxelStiffness, with what is known set");
}

const std::vector<std::string>& settingsLeftOut(const std::string& className)
{
  static const std::vector<std::string> none;
  static const std::map<std::string, std::vector<std::string>> all{
    { "vtkSteadyDiffusion",
      { "conductivity-uncertainty", "conductivity-across-uncertainty", "sensitivity", "target-error", "window-error",
        "segmentation-error", "surface-doubt", "membrane", "permeance", "shares", "interpolate", "field", "flux" } },
    { "vtkVoxelStiffness",
      { "young-uncertainty", "poisson-uncertainty", "young-across-uncertainty", "poisson-across-uncertainty",
        "shear-uncertainty", "sensitivity", "window-error", "segmentation-error", "surface-doubt", "shares",
        "mean-strain", "mean-stress", "change", "change-array", "tensor", "displacement", "strain", "stress",
        "expansion", "expansion-across" } },
  };
  const auto found = all.find(className);
  return found == all.end() ? none : found->second;
}

} // namespace lamella
