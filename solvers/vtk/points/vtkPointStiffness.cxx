#include "vtkPointStiffness.h"

#include "FieldNumbers.h"
#include "NewArray.h"
#include "PointScene.h"
#include "vtkClassMacros.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "elasticity/ElasticConstants.h"
#include "mpm/PointStiffness.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace mpm = lamella::mpm;
namespace el = lamella::elasticity;
namespace pd = lamella::peridynamics;

namespace
{

constexpr std::array<const char*, 5> sideChoices{ "straight", "open", "fixed", "periodic", "sticky" };

vtkSmartPointer<vtkStringArray> textColumn(const char* name, const std::vector<std::string>& texts)
{
  const auto column = vtkSmartPointer<vtkStringArray>::New();
  column->SetName(name);
  for (const std::string& text : texts)
    column->InsertNextValue(text);
  return column;
}

vtkSmartPointer<vtkDoubleArray> numberColumn(const std::string& name, const std::vector<double>& values)
{
  const auto column = lamella::newArray<vtkDoubleArray>(name.c_str(), 1, values.size());
  std::copy(values.begin(), values.end(), column->GetPointer(0));
  return column;
}

} // namespace

struct vtkPointStiffness::Answer
{
  std::vector<std::string> Names; ///< of constants
  std::vector<double> Values;
  std::vector<std::string> Components;
  std::vector<double> Tensor; ///< by rows
  double Points = 0;
  double Nodes = 0;
  double Iterations = 0;
  double Residual = 0;
  double Lost = 0;
  double SetupSeconds = 0;
  double SolveSeconds = 0;

  template <int Dim>
  void Add(const mpm::PointStiffness<Dim>& s)
  {
    this->Points = static_cast<double>(s.points);
    this->Nodes = static_cast<double>(s.nodes);
    for (const std::int64_t n : s.iterations)
      this->Iterations += static_cast<double>(n);
    this->Residual = std::max(this->Residual, s.residual);
    this->Lost = std::max(this->Lost, s.lost);
    this->SetupSeconds += s.setupSeconds;
    this->SolveSeconds += s.solveSeconds;
  }
  template <int Dim>
  void SetTensor(const mpm::PointStiffness<Dim>& s)
  {
    const std::vector<std::string> names = el::voigtNames(Dim);
    for (const int strain : s.strains)
      this->Components.push_back(names.at(static_cast<std::size_t>(strain)));
    this->Tensor = s.stiffness;
  }
  template <int Dim>
  void AddUniaxial(const mpm::UniaxialStiffness<Dim>& u, int axis, bool lateral)
  {
    const std::string letters = "xyz";
    const char along = letters[static_cast<std::size_t>(axis)];
    this->Names.push_back(std::string("E_") + along);
    this->Values.push_back(u.modulus);
    for (int a = 0; a < Dim && lateral; ++a)
    {
      if (a != axis)
      {
        this->Names.push_back(std::string("nu_") + along + letters[static_cast<std::size_t>(a)]);
        this->Values.push_back(-u.strain[static_cast<std::size_t>(a)]);
      }
    }
  }
};

vtkStandardNewMacro(vtkPointStiffness);

vtkPointStiffness::vtkPointStiffness()
{
  this->SetNumberOfOutputPorts(2);
}

vtkOutputTypesMacro(vtkPointStiffness, "vtkTable", "vtkTable");
vtkGetOutputMacro(vtkPointStiffness, Constants, vtkTable, 0);
vtkGetOutputMacro(vtkPointStiffness, Tensor, vtkTable, 1);

template <int Dim>
vtkPointStiffness::Answer vtkPointStiffness::Solve(const lamella::PointScene& scene)
{
  const auto law = scene.law<Dim>();
  const mpm::MaterialPoints<Dim> points = scene.points<Dim>();
  mpm::PointStiffnessOptions<Dim> options;
  options.spacing = scene.gridSpacing();
  options.tolerance = this->Tolerance;
  options.maximumIterations = this->MaximumIterations;
  options.sides.fill(this->Sides == PERIODIC ? mpm::BoxSides::Periodic
      : this->Sides == STICKY                ? mpm::BoxSides::StickyWalls
                                             : mpm::BoxSides::Walls);
  const bool tensor = this->Sides == PERIODIC || this->Sides == STICKY;
  const bool fit = this->FitPlatens && !tensor;
  const auto box = scene.box({ fit, fit, fit });
  std::copy_n(box[0].begin(), Dim, options.lower.begin());
  std::copy_n(box[1].begin(), Dim, options.upper.begin());
  Answer answer;
  int done = 0;
  const int solves = this->Sides == OPEN ? Dim : 1;
  options.progress = [&](double share)
  {
    this->UpdateProgress((done + share) / solves);
    return static_cast<bool>(this->CheckAbort());
  };
  options.planned = [&](const mpm::PointStiffnessPlan& plan)
  {
    std::array<double, 4> told{ static_cast<double>(plan.nodes), plan.bytes, solves * plan.seconds[0],
      solves * plan.seconds[1] };
    if (done == 0)
    {
      this->InvokeEvent(PLAN_EVENT, told.data());
    }
  };
  if (tensor)
  {
    const mpm::PointStiffness<Dim> s = mpm::pointStiffness(points, *law, options);
    answer.Add(s);
    answer.SetTensor(s);
    answer.Names = el::constantNames(Dim);
    answer.Values = el::constantValues(el::elasticConstants(s.stiffness, Dim));
    return answer;
  }
  if (this->Sides != OPEN)
  {
    const mpm::PointStiffness<Dim> s = mpm::pointStiffness(points, *law, options);
    answer.Add(s);
    answer.SetTensor(s);
    for (int axis = 0; axis < Dim; ++axis)
      answer.AddUniaxial(s.along(axis, this->Sides == FIXED), axis, this->Sides == STRAIGHT);
    return answer;
  }
  for (int axis = 0; axis < Dim; ++axis, ++done)
  {
    options.sides.fill(mpm::BoxSides::Open);
    options.sides[static_cast<std::size_t>(axis)] = mpm::BoxSides::Walls;
    const mpm::PointStiffness<Dim> s = mpm::pointStiffness(points, *law, options);
    answer.Add(s);
    answer.AddUniaxial(s.along(axis), axis, false);
  }
  return answer;
}

void vtkPointStiffness::Run(vtkImageData* input, vtkInformationVector* outputs, const lamella::Team& alone)
{
  this->SetProgressText("stiffness");
  this->LetStop(alone);
  const lamella::PointScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), this->Settings(), alone);
  this->LetStop(alone);
  const Answer answer = scene.lattice().dimension == 3 ? this->Solve<3>(scene) : this->Solve<2>(scene);

  vtkTable* const constants = vtkTable::GetData(outputs, 0);
  vtkTable* const tensor = vtkTable::GetData(outputs, 1);
  constants->Initialize();
  tensor->Initialize();
  std::vector<std::string> units;
  for (const std::string& name : answer.Names)
    units.emplace_back(name.starts_with("nu") ? "1" : "Pa");
  const auto values = numberColumn("value", answer.Values);
  lamella::describe(values, "", "moduli in Pa, Poisson's ratios", this->GetClassName());
  constants->AddColumn(textColumn("constant", answer.Names));
  constants->AddColumn(values);
  constants->AddColumn(textColumn("unit", units));
  const std::size_t n = answer.Components.size();
  tensor->AddColumn(textColumn("stress", answer.Components));
  for (std::size_t strain = 0; strain < n; ++strain)
  {
    std::vector<double> column;
    for (std::size_t stress = 0; stress < n; ++stress)
      column.push_back(answer.Tensor[stress * n + strain]);
    const auto array = numberColumn(answer.Components[strain], column);
    lamella::describe(array, "Pa", "stress over this mean strain", this->GetClassName());
    tensor->AddColumn(array);
  }
  std::vector<std::string> warnings = scene.warnings();
  if (answer.Lost > 0)
  {
    warnings.push_back(fmt::format(
      "the residual is {:.1g}, above {:.1g}: parts that hang together by a point or two still move, at next "
      "to no energy; the last hundred iterations changed the stiffness by {:.1g} of itself",
      answer.Residual, this->Tolerance, answer.Lost));
  }
  for (const std::string& warning : warnings)
    vtkWarningMacro(<< warning);
  for (vtkTable* const table : { constants, tensor })
  {
    const auto number = [table](const char* name, double value) { lamella::setFieldNumber(table, name, value); };
    lamella::setFieldTexts(table, "constant_names", answer.Names);
    lamella::setFieldNumbers(table, "constants", answer.Values);
    lamella::setFieldTexts(table, "stiffness_components", answer.Components);
    lamella::setFieldNumbers(table, "stiffness", answer.Tensor);
    number("points", answer.Points);
    number("nodes", answer.Nodes);
    number("iterations", answer.Iterations);
    number("residual", answer.Residual);
    lamella::setFieldNumbers(table, "seconds", std::array{ answer.SetupSeconds, answer.SolveSeconds });
    const char* const sides = sideChoices.at(static_cast<std::size_t>(this->Sides));
    lamella::setFieldText(table, "sides", sides);
    lamella::setFieldTexts(table, "warnings", warnings);
    const nlohmann::json model = scene.describe(table);
    lamella::setProvenance(table, lamella::provenance(input));
    lamella::continueProvenance(table, "point stiffness",
      { { "model", model }, { "sides", sides }, { "fit_platens", this->FitPlatens },
        { "tolerance", this->Tolerance } });
  }
}
