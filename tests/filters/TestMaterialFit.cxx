// The fit as a filter: layers, whose effective values are formulas, say what it has to find and how well; a slope by
// moisture; intervals that hold; what is not told and what is refused; when it runs again; what ranks have.
#include "OnRanks.h"
#include "VtkTesting.h"

#include "vtkMaterialFit.h"
#include "vtkMicrostructureSource.h"
#include "vtkSteadyDiffusion.h"
#include "vtkVoxelStiffness.h"

#include "vtkCallbackCommand.h"
#include "vtkExecutive.h"
#include "vtkOutputWindow.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using vtktest::cell;
using vtktest::errorOf;
using vtktest::picture;

// A search ends where its last step is a twentieth of a standard deviation at most, and takes that step as the linear
// model has it: of deviations of 1 % what is left is below (0.05 · 0.01)². The solver's 1e-8 are less.
constexpr double found = 1e-6;

class MaterialFit : public vtktest::OnRanks
{
protected:
  static void SetUpTestSuite()
  {
    OnRanks::SetUpTestSuite();
    vtkOutputWindow::GetInstance()->SetDisplayModeToNever();
  }
};

/// Layers along y of "a" and "b", 4 nodes thick; b is 0.4 of it, of the thinner ones 0.2.
vtkSmartPointer<vtkImageData> layers(bool thin = false)
{
  return picture(
    20, 6, 1, [thin](int x, int, int) { return thin ? (x % 5 == 2 ? 1 : 0) : x / 4 % 2; });
}

constexpr double share = 0.4;
double along(double a, double b)
{
  return (1 - share) * a + share * b;
}
double across(double a, double b)
{
  return 1 / ((1 - share) / a + share / b);
}

struct Heat
{
  vtkNew<vtkSteadyDiffusion> solver;
  vtkNew<vtkMaterialFit> fit;
  explicit Heat(double a, const std::vector<std::string>& measured, const std::vector<std::string>& unknowns = { "b" })
  {
    if (a > 0)
      solver->SetConductivity("a", a);
    solver->EstimateErrorOff();
    fit->SetSolver(solver);
    fit->AddInputDataObject(layers());
    for (const std::string& one : unknowns)
      fit->AddUnknown(one);
    measure(measured);
  }
  void measure(const std::vector<std::string>& measured)
  {
    fit->RemoveAllMeasurements();
    for (const std::string& one : measured)
      fit->AddMeasurement(one);
  }
  [[nodiscard]] double value(const char* name, std::size_t i = 0) const
  {
    return fieldNumbers(fit->GetImage(), name).at(i);
  }
};

std::string told(const char* quantity, double value, double half)
{
  return fmt::format("{}={}±{}", quantity, value, half);
}

TEST_F(MaterialFit, FindsWhatLayersAreMadeOf)
{
  const double a = 0.026;
  const double b = 0.41;
  for (const bool parallel : { true, false })
  {
    SCOPED_TRACE(parallel);
    // across the layers b hardly matters where it conducts well: take one that conducts less than a
    const double truth = parallel ? b : 0.002;
    const double value = parallel ? along(a, truth) : across(a, truth);
    const double half = 0.01 * value;
    Heat heat(a, { told(parallel ? "y" : "x", value, half) });
    ASSERT_EQ(errorOf(heat.fit), "");
    EXPECT_NEAR(heat.value("fit_value") / truth, 1, found);
    // by the measurement, in the logarithm: half its width over K's derivative by it
    const double slope = parallel ? share : share * std::pow(value / truth, 2);
    const double factor = std::exp(half / (slope * truth));
    EXPECT_NEAR(heat.value("fit_low_by_measurement") / (truth / factor), 1, 2 * found);
    EXPECT_NEAR(heat.value("fit_high_by_measurement") / (truth * factor), 1, 2 * found);
    EXPECT_EQ(heat.value("fit_low"), heat.value("fit_low_by_measurement")); // no error of the lattice was asked for
    EXPECT_EQ(fieldText(heat.fit->GetImage(), "fit_interval"), "19 of 20, by the measurements alone");
    EXPECT_TRUE(std::isnan(heat.value("fit_chance")));
    EXPECT_LE(heat.value("fit_solves"), 12);
  }
}

TEST_F(MaterialFit, TellsInTablesAndFields)
{
  Heat heat(0.026, { told("y", along(0.026, 0.41), 0.002), told("x", across(0.026, 0.41), 0.002) });
  heat.solver->EstimateErrorOn();
  ASSERT_EQ(errorOf(heat.fit), "");
  vtkTable* const sought = heat.fit->GetFound();
  ASSERT_EQ(sought->GetNumberOfRows(), 1);
  EXPECT_EQ(sought->GetValueByName(0, "unknown").ToString(), "conductivity:b");
  for (const char* const column : { "value", "low", "high", "low_by_measurement", "high_by_measurement" })
    EXPECT_EQ(cell(sought, 0, column), heat.value(("fit_" + std::string(column)).c_str())) << column;
  vtkTable* const measured = heat.fit->GetMeasured();
  ASSERT_EQ(measured->GetNumberOfRows(), 2);
  EXPECT_EQ(measured->GetValueByName(1, "measured").ToString(), "x");
  EXPECT_EQ(cell(measured, 1, "half_width"), 0.002);
  EXPECT_EQ(cell(measured, 1, "fitted"), heat.value("fit_fitted", 1));
  EXPECT_EQ(cell(measured, 1, "lattice_and_picture"), heat.value("fit_lattice_and_picture", 1));
  EXPECT_GE(cell(sought, 0, "high"), cell(sought, 0, "high_by_measurement"));
  EXPECT_NE(heat.fit->GetImage()->GetPointData()->GetArray("temperature_y"), nullptr);
  EXPECT_NE(provenance(heat.fit->GetImage()).find("\"fit\""), std::string::npos);
  heat.fit->ComputeFieldsOff();
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_EQ(heat.fit->GetImage()->GetPointData()->GetArray("temperature_y"), nullptr);
  EXPECT_EQ(heat.fit->GetImage()->GetPointData()->GetArray("flux_y"), nullptr);
}

// One direction of each of two samples: two unknowns.
TEST_F(MaterialFit, TwoSamplesTellTwoPhases)
{
  const double a = 0.05;
  const double b = 0.5;
  const double thin = 0.8 * a + 0.2 * b;
  Heat heat(0, { told("y", along(a, b), 1e-3 * along(a, b)), told("2/y", thin, 1e-3 * thin) }, { "a", "b=0.3" });
  heat.fit->AddInputDataObject(layers(true));
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_NEAR(heat.value("fit_value", 0) / a, 1, 10 * found); // of which a deviation is 3 %
  EXPECT_NEAR(heat.value("fit_value", 1) / b, 1, 10 * found);
  // what is left over of one is of the other
  EXPECT_LT(heat.value("fit_correlation", 1), -0.8);
  // K = 0.6 a + 0.4 b and 0.8 a + 0.2 b: a = 2 K₂ − K₁, b = 4 K₁ − 3 K₂
  const double half = std::hypot(2e-3 * thin, 1e-3 * along(a, b)) / a;
  EXPECT_NEAR(std::log(heat.value("fit_high", 0) / a) / half, 1, 1e-4);
}

// What is measured at two moistures tells value and slope: of layers along exactly, with a symmetric interval.
TEST_F(MaterialFit, SlopeByMoisture)
{
  const double a = 0.026;
  const double b = 0.4;
  const double slope = 0.6;
  for (const double least : { 0.0, 0.05 })
  {
    SCOPED_TRACE(least);
    const double most = 0.12;
    const double low = along(a, b + slope * least);
    const double high = along(a, b + slope * most);
    Heat heat(
      a, { told(fmt::format("y@{}", least).c_str(), low, 0.001), told("y@0.12", high, 0.002) }, { "slope:b", "b" });
    ASSERT_EQ(errorOf(heat.fit), "");
    EXPECT_EQ(fieldTexts(heat.fit->GetImage(), "fit_unknown"),
      (std::vector<std::string>{ "slope:conductivity:b", "conductivity:b" })); // in the order in which they were given
    const double range = most - least;
    EXPECT_NEAR(heat.value("fit_value", 0) / slope, 1, 100 * found); // a difference of a ninth of what it is of
    EXPECT_NEAR(heat.value("fit_value", 1) / b, 1, 10 * found);
    const double half = std::hypot(0.001, 0.002) / (share * range);
    EXPECT_NEAR((heat.value("fit_high", 0) - heat.value("fit_value", 0)) / half, 1, 1e-4);
    EXPECT_NEAR((heat.value("fit_value", 0) - heat.value("fit_low", 0)) / half, 1, 1e-4);
    if (least == 0)
      EXPECT_NEAR(std::log(heat.value("fit_high", 1) / b) / (0.001 / share / b), 1, 1e-4); // measured there
    else
      EXPECT_NEAR(
        (heat.value("fit_high", 1) - b) / (std::hypot(0.001 * most, 0.002 * least) / (share * range)), 1, 1e-4);
    EXPECT_LT(heat.value("fit_correlation", 1), -0.4); // more at 0 is less of a slope
    // the image is the first sample at the moisture of its first measurement
    EXPECT_NEAR(fieldNumbers(heat.fit->GetImage(), "effective_conductivity")[4] / low, 1, found);
  }
}

// Moduli fall with moisture: a slope below 0, of two samples, each at its own moisture. Of layers of one Poisson's
// ratio the modulus along them is the mean.
TEST_F(MaterialFit, ModulusThatFallsWithMoisture)
{
  const double a = 1e9;
  const double b = 8e9;
  const double slope = -2e10;
  vtkNew<vtkVoxelStiffness> solver;
  solver->SetYoungsModulus("a", a);
  solver->SetTolerance(1e-10);
  solver->EstimateErrorOff();
  vtkNew<vtkMaterialFit> fit;
  fit->SetSolver(solver);
  fit->AddInputDataObject(layers());
  fit->AddInputDataObject(layers(true));
  fit->AddUnknown("young:b");
  fit->AddUnknown("slope:young:b");
  fit->AddMeasurement(told("E_y@0.06", along(a, b + 0.06 * slope), 4e7));
  fit->AddMeasurement(told("2/E_y@0.14", 0.8 * a + 0.2 * (b + 0.14 * slope), 2e7));
  ASSERT_EQ(errorOf(fit), "");
  // deviations of some per cent, so 25 times as much, and differences of a few tenths of what they are of
  EXPECT_NEAR(cell(fit->GetFound(), 0, "value") / b, 1, 100 * found);
  EXPECT_NEAR(cell(fit->GetFound(), 1, "value") / slope, 1, 100 * found);
}

// Of 300 measurements with normal errors 285 intervals should hold, with a standard deviation of 4.
TEST_F(MaterialFit, IntervalsOfASlopeHold)
{
  if (ranks() > 1)
    GTEST_SKIP() << "each rank does the same";
  const double a = 0.026;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  int value = 0;
  int slope = 0;
  const int times = 300;
  for (int i = 0; i < times; ++i)
  {
    const double b = 0.2 + uniform(random);
    const double by = (uniform(random) - 0.3) * 2;
    std::vector<std::string> measured;
    for (const double moisture : { 0.02, 0.08, 0.12, 0.18 })
    {
      const double truth = along(a, b + by * moisture);
      const double sigma = 0.01 * truth;
      measured.push_back(
        told(fmt::format("y@{}", moisture).c_str(), truth + sigma * normal(random), 1.959963984540054 * sigma));
    }
    Heat heat(a, measured, { "b", "slope:b" });
    heat.fit->ComputeFieldsOff();
    heat.solver->SetDirection(vtkSteadyDiffusion::Y);
    ASSERT_EQ(errorOf(heat.fit), "");
    value += heat.value("fit_low", 0) <= b && b <= heat.value("fit_high", 0) ? 1 : 0;
    slope += heat.value("fit_low", 1) <= by && by <= heat.value("fit_high", 1) ? 1 : 0;
  }
  for (const int held : { value, slope })
  {
    EXPECT_GE(held, 0.95 * times - 12);
    EXPECT_LE(held, 0.95 * times + 12);
  }
}

TEST_F(MaterialFit, SaysWhatIsNotTold)
{
  const double a = 1e-5; // beside b nothing goes along it
  Heat heat(0, { told("y", along(a, 0.41), 0.003) }, { "a=1e-5" });
  heat.solver->SetConductivity("b", 0.41);
  const std::string error = errorOf(heat.fit);
  EXPECT_NE(error.find("the measurements do not tell conductivity of a"), std::string::npos) << error;
  EXPECT_NE(error.find("\nhint: give it a value"), std::string::npos) << error;
  EXPECT_EQ(heat.fit->GetImage()->GetNumberOfPoints(), 0);
  EXPECT_EQ(heat.fit->GetFound()->GetNumberOfRows(), 0);
}

TEST_F(MaterialFit, Refuses)
{
  const auto refusal = [](const std::vector<std::string>& unknowns, const std::vector<std::string>& measured)
  {
    const Heat heat(0.026, measured, unknowns);
    return errorOf(heat.fit);
  };
  const auto expect = [](const std::string& error, const std::string& message, const std::string& hint)
  {
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_NE(error.find(hint, error.find("\nhint: ")), std::string::npos) << error;
  };
  expect(refusal({ "bark" }, { "y=0.1±0.01" }), "unknown names 'bark', which is no phase", "its phases are 'a', 'b'");
  expect(refusal({ "b" }, { "y=0.1" }), "does not say how far it may be off", "y=0.1±…");
  expect(refusal({ "b" }, { "2/y=0.1±0.01" }), "there is 1 sample", "also");
  expect(refusal({ "b" }, { "z=0.1±0.01" }), "'z' is not found of this sample", "'x' and 'y'");
  expect(refusal({ "b" }, {}), "0 measurements for 1 unknowns", "at least as many");
  expect(refusal({ "" }, { "y=0.1±0.01" }), "1 measurements for 0 unknowns", "name what is looked for");
  expect(refusal({ "young:b" }, { "y=0.1±0.01" }), "'young' is nothing that can be looked for", "conductivity");
  // moistures
  const std::vector<std::string> sloped{ "b", "slope:b" };
  expect(refusal(sloped, { "x@0.12=0.04±0.001", "y@0.12=0.2±0.01" }),
    "all was measured at 0.12, and one moisture does not tell the slope", "another moisture");
  expect(
    refusal(sloped, { "x=0.04±0.001", "y@0.12=0.2±0.01" }), "measured x does not say at which moisture", "x@0.12=");
  expect(refusal({ "b" }, { "y@0.12=0.2±0.01" }), "nothing that is looked for changes with it", "slope:conductivity:b");
  expect(refusal({ "slope:b" }, { "y@0.12=0.2±0.01" }), "together with the value", "look for conductivity:b");
  expect(
    refusal(sloped, { "y@wet=0.2±0.01", "y@0=0.2±0.01" }), "'wet' is not a number", "QUANTITY@MOISTURE=VALUE±HALF");
  expect(refusal(sloped, { "y@0.10=0.2±0.01", "y@0.1=0.2±0.01" }), "measured has y@0.1 twice", "the mean of both");
  expect(refusal({ "b", "slope:b=steep" }, { "y@0=0.2±0.01", "y@0.1=0.2±0.01" }), "'steep' is not a number", "a slope");
  expect(refusal({ "b=0.4", "slope:b=-9" }, { "y@0=0.2±0.01", "y@0.1=0.2±0.01" }),
    "conductivity of b at 0.1 is looked for", "a positive number");
  // no solver, or none that tells derivatives
  vtkNew<vtkMaterialFit> none;
  none->AddInputDataObject(layers());
  expect(errorOf(none), "there is no solver to fit with", "vtkSteadyDiffusion or a vtkVoxelStiffness");
  vtkNew<vtkMicrostructureSource> source;
  none->SetSolver(source);
  expect(errorOf(none), "a vtkMicrostructureSource cannot be fitted", "vtkSteadyDiffusion or a vtkVoxelStiffness");
  // what the solver refuses is said once, in its words
  const Heat heat(-1, { "y=0.1±0.01" });
  expect(errorOf(heat.fit), "phase 'a' has no conductivity", "give one to each phase");
}

TEST_F(MaterialFit, RunsAgainWhereSomethingChanged)
{
  Heat heat(0.026, { told("y", along(0.026, 0.41), 0.002) });
  int runs = 0;
  vtkNew<vtkCallbackCommand> count;
  count->SetClientData(&runs);
  count->SetCallback([](vtkObject*, unsigned long, void* client, void*) { ++*static_cast<int*>(client); });
  heat.fit->AddObserver(vtkCommand::StartEvent, count);
  ASSERT_EQ(errorOf(heat.fit), "");
  const std::vector<double> first = fieldNumbers(heat.fit->GetImage(), "fit_value");
  heat.fit->Update(); // the solver was changed by the fit alone
  EXPECT_EQ(runs, 1);
  heat.fit->Modified(); // the same again, to the last digit
  heat.fit->Update();
  EXPECT_EQ(runs, 2);
  EXPECT_EQ(fieldNumbers(heat.fit->GetImage(), "fit_value"), first);
  EXPECT_EQ(fieldNumbers(heat.fit->GetImage(), "fit_solves").size(), 1U);
  heat.solver->SetConductivity("a", 0.05); // what is known of the phases changes what is found
  const vtkMTimeType then = heat.fit->GetMTime();
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_EQ(runs, 3);
  EXPECT_GE(heat.fit->GetMTime(), then); // or what comes after another output would miss it
  EXPECT_NEAR(heat.value("fit_value"), (along(0.026, 0.41) - 0.6 * 0.05) / 0.4, 1e-6);

  // b is not known because it was found; and once it is given it counts
  heat.fit->RemoveAllUnknowns();
  heat.fit->AddUnknown("a");
  EXPECT_NE(errorOf(heat.fit).find("the conductivity of b was looked for before, and the solver has no value"),
    std::string::npos);
  heat.solver->SetConductivity("b", 0.3);
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_NEAR(heat.value("fit_value"), (along(0.026, 0.41) - 0.4 * 0.3) / 0.6, 1e-6);
}

TEST_F(MaterialFit, ProgressIsToldAndAbortLeavesNothing)
{
  Heat heat(0.026, { told("y", along(0.026, 0.41), 0.002) });
  int seen = 0;
  vtkNew<vtkCallbackCommand> watch;
  watch->SetClientData(&seen);
  watch->SetCallback(
    [](vtkObject* caller, unsigned long, void* client, void*)
    {
      ++*static_cast<int*>(client);
      const double done = vtkAlgorithm::SafeDownCast(caller)->GetProgress();
      EXPECT_TRUE(done >= 0 && done <= 1) << done;
    });
  heat.fit->AddObserver(vtkCommand::ProgressEvent, watch);
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_GE(seen, heat.value("fit_solves"));

  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  const unsigned long tag = heat.fit->AddObserver(vtkCommand::ProgressEvent, stop);
  heat.fit->Modified();
  seen = 0;
  EXPECT_EQ(errorOf(heat.fit), ""); // cancelling is no error
  EXPECT_LE(seen, 2);               // VTK itself says "done" at the end
  EXPECT_EQ(heat.fit->GetImage()->GetNumberOfPoints(), 0);
  EXPECT_EQ(heat.fit->GetFound()->GetNumberOfRows(), 0);
  // and it goes when it is asked again
  heat.fit->RemoveObserver(tag);
  heat.fit->SetAbortExecute(0);
  heat.fit->Modified();
  ASSERT_EQ(errorOf(heat.fit), "");
  EXPECT_NEAR(heat.value("fit_value") / 0.41, 1, found);
}

// Each rank fits all of it; it has its piece of the image, the first one the tables.
TEST_F(MaterialFit, OnRanks)
{
  vtkNew<vtkMicrostructureSource> tissue;
  tissue->SetSize(60, 50, 1);
  const auto fit = [&](vtkMaterialFit* filter, vtkSteadyDiffusion* solver)
  {
    solver->SetConductivity("lumen", 0.026);
    filter->SetSolver(solver);
    filter->AddInputConnection(tissue->GetOutputPort());
    filter->AddUnknown("wall");
    filter->AddMeasurement("y=0.12±0.003");
  };
  vtkNew<vtkMaterialFit> alone;
  vtkNew<vtkSteadyDiffusion> solverAlone;
  fit(alone, solverAlone);
  ASSERT_EQ(errorOf(alone), "");
  vtkNew<vtkMaterialFit> together;
  vtkNew<vtkSteadyDiffusion> solver;
  fit(together, solver);
  ASSERT_EQ(errorOf(together, [&] { together->UpdatePiece(rank(), ranks(), 0); }), "");
  for (const char* const name : { "fit_value", "fit_low", "fit_high", "fit_fitted" })
    EXPECT_EQ(fieldNumbers(together->GetImage(), name), fieldNumbers(alone->GetImage(), name)) << name;
  EXPECT_EQ(together->GetFound()->GetNumberOfRows(), rank() == 0 ? 1 : 0);
  int cells = together->GetImage()->GetNumberOfCells();
  int all = 0;
  controller_->AllReduce(&cells, &all, 1, vtkCommunicator::SUM_OP);
  EXPECT_EQ(all, 59 * 49); // pieces share the points between them
  if (ranks() == 1)
    return;
  // what has only its piece is refused
  vtkNew<vtkMaterialFit> pieces;
  pieces->SetSolver(solver);
  pieces->AddInputConnection(pieceOf(alone->GetImage(), true)->GetOutputPort());
  pieces->AddUnknown("wall");
  pieces->AddMeasurement("y=0.12±0.003");
  EXPECT_NE(
    errorOf(pieces, [&] { pieces->UpdatePiece(rank(), ranks(), 0); }).find("a piece of a sample"), std::string::npos);
}

} // namespace
