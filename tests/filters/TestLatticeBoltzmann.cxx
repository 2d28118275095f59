// Lattice Boltzmann as a VTK filter: times of the pipeline, a slab's heating, the directions' convention, ranks, bad
// input.
#include "../TemporaryFolder.h"
#include "VtkTesting.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkLatticeBoltzmann.h"
#include "vtkSampleAlgorithm.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::picture;

// A box of 20 µm: L²/D is 4e-3 s.
vtkNew<vtkLatticeBoltzmann> stepper(vtkImageData* image, int direction = vtkLatticeBoltzmann::X)
{
  vtkNew<vtkLatticeBoltzmann> filter;
  filter->SetInputData(image);
  filter->SetDiffusivity("a", 1e-7);
  filter->SetDiffusivity("b", 1e-8);
  filter->SetDirection(direction);
  filter->SetEndTime(1e-3);
  filter->SetNumberOfSteps(4);
  return filter;
}

double value(vtkDataObject* data, const char* name)
{
  return vtkDoubleArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name))->GetValue(0);
}

int uniform(int, int, int)
{
  return 0;
}

TEST(LatticeBoltzmann, HasTheTimesOfThePipeline)
{
  const auto filter = stepper(picture(20, 6, 1, uniform));
  ASSERT_EQ(errorOf(filter), "");
  vtkInformation* const told = filter->GetOutputInformation(0);
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  ASSERT_EQ(told->Length(Pipeline::TIME_STEPS()), 5);
  EXPECT_DOUBLE_EQ(told->Get(Pipeline::TIME_STEPS())[3], 7.5e-4);
  EXPECT_NEAR(value(filter->GetOutput(), "time"), 1e-3, 1e-15); // without a time the last one
  double before = -1;
  for (const double t : { 0.0, 2.5e-4, 5e-4, 7.5e-4, 1e-3 })
  {
    ASSERT_TRUE(filter->UpdateTimeStep(t));
    vtkImageData* const out = filter->GetOutput();
    EXPECT_NEAR(out->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), t, 1e-15);
    EXPECT_NEAR(value(out, "time"), t, 1e-15); // a pair of steps divides the interval
    // u = 1 at the left, 0 at the right: Σ over the sines of the slab; second order in 1/20
    const double x = (4 + 0.5) / 20;
    double exact = 1 - x;
    for (int k = 1; k < 200 && t > 0; ++k)
    {
      const double wave = k * std::numbers::pi;
      exact -= 2 / wave * std::sin(wave * x) * std::exp(-1e-7 * std::pow(wave / 20e-6, 2) * t);
    }
    const double u = out->GetPointData()->GetArray("temperature")->GetTuple1(4);
    EXPECT_NEAR(u, t > 0 ? exact : 0.0, 2e-3);
    EXPECT_GT(u, before);
    before = u;
  }
}

TEST(LatticeBoltzmann, ComesToRestAsSteadyDiffusion)
{
  const auto image = picture(18, 16, 1, [](int x, int y, int z) { return vtktest::blobs(x, y, z) > 0 ? 1 : 0; });
  for (const int direction : { vtkLatticeBoltzmann::X, vtkLatticeBoltzmann::Y })
  {
    const auto filter = stepper(image, direction);
    filter->SetQuantity(vtkLatticeBoltzmann::CONCENTRATION);
    filter->SetComputeFlux(true);
    filter->SetEndTime(0.2); // 50 L²/D of the better phase, and 5 of the other
    filter->SetNumberOfSteps(1);
    ASSERT_EQ(errorOf(filter), "");
    vtkNew<vtkSteadyDiffusion> steady;
    steady->SetInputData(image);
    steady->SetConductivity("a", 1e-7);
    steady->SetConductivity("b", 1e-8);
    steady->SetDirection(direction);
    steady->SetQuantity(vtkSteadyDiffusion::CONCENTRATION);
    ASSERT_EQ(errorOf(steady), "");
    vtkPointData* const a = filter->GetOutput()->GetPointData();
    vtkPointData* const b = steady->GetOutput()->GetPointData();
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      // the steady field is within 1e-6 in the energy norm
      EXPECT_NEAR(a->GetArray("concentration")->GetTuple1(i), b->GetArray("concentration")->GetTuple1(i), 1e-5);
    }
    const double k = steady->GetEffectiveConductivity()[4 * direction];
    const double length = (direction == vtkLatticeBoltzmann::X ? 18 : 16) * 1e-6;
    EXPECT_NEAR(value(filter->GetOutput(), "inlet_flux") * length / k, 1, 1e-5);
    EXPECT_NEAR(value(filter->GetOutput(), "outlet_flux") * length / k, 1, 1e-5);
    double mean = 0;
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
      mean += a->GetArray("flux")->GetComponent(i, direction) / static_cast<double>(image->GetNumberOfPoints());
    // y leads downwards in a picture, and vectors point in the data's axes
    EXPECT_NEAR(mean * length / k, direction == vtkLatticeBoltzmann::Y ? -1 : 1, 1e-5);
  }
}

TEST(LatticeBoltzmann, RunsOnceForAllTimes)
{
  const auto filter = stepper(picture(20, 6, 1, uniform));
  ASSERT_EQ(errorOf(filter), "");
  vtkDataArray* const first = filter->GetOutput()->GetPointData()->GetArray("temperature");
  ASSERT_TRUE(filter->UpdateTimeStep(0));
  EXPECT_EQ(filter->GetOutput()->GetPointData()->GetArray("temperature")->GetTuple1(0), 0);
  ASSERT_TRUE(filter->UpdateTimeStep(1e-3));
  EXPECT_EQ(filter->GetOutput()->GetPointData()->GetArray("temperature"), first); // the array that was kept
}

TEST(LatticeBoltzmann, KeepsStatesAtTimesAndSteps)
{
  const auto filter = stepper(picture(20, 6, 1, uniform));
  filter->AddStateAtStep(40);
  filter->AddStateAtStep(0);
  ASSERT_EQ(errorOf(filter), "");
  ASSERT_EQ(filter->GetNumberOfStates(), 2);
  EXPECT_EQ(value(filter->GetStateImage(0), "steps"), 0);
  EXPECT_EQ(value(filter->GetStateImage(1), "steps"), 40);
  const double step = value(filter->GetOutput(), "time_step");
  EXPECT_NEAR(step / (1e-12 / 6e-7), 1, 1e-12); // a relaxation of ½
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  EXPECT_FALSE(filter->GetOutputInformation(0)->Has(Pipeline::TIME_STEPS())); // without a time step nobody knows

  filter->SetTimeStep(1e-6);
  filter->AddStateAtTime(1e-4);
  filter->UpdateInformation();
  ASSERT_EQ(filter->GetOutputInformation(0)->Length(Pipeline::TIME_STEPS()), 3);
  EXPECT_DOUBLE_EQ(filter->GetOutputInformation(0)->Get(Pipeline::TIME_STEPS())[1], 4e-5);
  ASSERT_TRUE(filter->UpdateTimeStep(4.1e-5)); // the nearest
  EXPECT_EQ(value(filter->GetOutput(), "steps"), 40);
  vtkTable* const curve = filter->GetCurve();
  ASSERT_EQ(curve->GetNumberOfRows(), 3);
  for (vtkIdType row = 0; row < 3; ++row)
    for (const char* name : { "time", "inlet_flux", "outlet_flux", "mean_value", "steps" })
      EXPECT_EQ(curve->GetValueByName(row, name).ToDouble(), value(filter->GetStateImage(static_cast<int>(row)), name));
  filter->AddStateAtStep(41);
  EXPECT_NE(errorOf(filter).find("a state after 41 steps cannot be kept"), std::string::npos);
}

TEST(LatticeBoltzmann, GoesOnFromACheckpoint)
{
  const lamella::testing::TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto image = picture(20, 16, 1, [](int x, int y, int z) { return vtktest::blobs(x, y, z) > 0 ? 1 : 0; });
  const auto whole = stepper(image, vtkLatticeBoltzmann::Y);
  ASSERT_EQ(errorOf(whole), "");
  const auto first = stepper(image, vtkLatticeBoltzmann::Y);
  first->SetEndTime(5e-4);
  first->SetNumberOfSteps(2);
  first->SetCheckpointFile(file);
  ASSERT_EQ(errorOf(first), "");
  EXPECT_EQ(first->GetLastCheckpoint(), static_cast<vtkIdType>(value(first->GetOutput(), "steps")));
  const auto second = stepper(image, vtkLatticeBoltzmann::Y);
  second->SetContinueFile(file);
  vtkObject::GlobalWarningDisplayOff(); // of the states before
  ASSERT_EQ(errorOf(second), "");
  vtkObject::GlobalWarningDisplayOn();
  EXPECT_EQ(value(second->GetOutput(), "continued_at"), static_cast<double>(first->GetLastCheckpoint()));
  EXPECT_EQ(value(second->GetOutput(), "states_before"), 2);
  EXPECT_EQ(second->GetNumberOfStates(), 3);
  EXPECT_EQ(second->GetCurve()->GetNumberOfRows(), 5);
  for (const char* name : { "inlet_flux", "outlet_flux", "mean_value", "time" })
  {
    EXPECT_EQ(value(second->GetOutput(), name), value(whole->GetOutput(), name));
    EXPECT_EQ(second->GetCurve()->GetValueByName(0, name), whole->GetCurve()->GetValueByName(0, name));
  }
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    EXPECT_EQ(second->GetOutput()->GetPointData()->GetArray("temperature")->GetTuple1(i),
      whole->GetOutput()->GetPointData()->GetArray("temperature")->GetTuple1(i));
  }
  second->SetInitialValue(1);
  EXPECT_NE(errorOf(second).find("initial value: 0 there, 1 here"), std::string::npos);
  // Pictures of which two nodes differ, so that products of node and phase would add up to the same
  const auto other = stepper(picture(20, 16, 1,
                               [](int x, int y, int z)
                               {
                                 const int was = vtktest::blobs(x, y, z) > 0 ? 1 : 0;
                                 return y == 0 && x < 2 ? 1 - was : was;
                               }),
    vtkLatticeBoltzmann::Y);
  other->SetContinueFile(file);
  EXPECT_NE(errorOf(other).find("there, "), std::string::npos);
  EXPECT_EQ(second->GetFailure(), vtkSampleAlgorithm::INPUT_FAILURE);
}

TEST(LatticeBoltzmann, WarnsOfOneRelaxationTime)
{
  const auto filter = stepper(picture(20, 6, 1, uniform));
  filter->SetCollision(vtkLatticeBoltzmann::BGK);
  filter->SetTimeStep(1e-5); // τ = ½ + 3 D δt/δx² = 3.5
  vtkObject::GlobalWarningDisplayOff();
  ASSERT_EQ(errorOf(filter), "");
  vtkObject::GlobalWarningDisplayOn();
  auto* const text = vtkStringArray::SafeDownCast(filter->GetOutput()->GetFieldData()->GetAbstractArray("warning"));
  ASSERT_NE(text, nullptr);
  EXPECT_NE(text->GetValue(0).find("3.5"), std::string::npos) << text->GetValue(0);
}

TEST(LatticeBoltzmann, SaysWhatIsWrong)
{
  const auto image = picture(20, 6, 1, [](int x, int, int) { return x % 2; });
  auto refused = [&](auto&& change)
  {
    const auto filter = stepper(image);
    change(filter.Get());
    return errorOf(filter);
  };
  using Filter = vtkLatticeBoltzmann*;
  EXPECT_NE(refused([](Filter f) { f->SetEndTime(0); }).find("no end time was given"), std::string::npos);
  EXPECT_NE(refused([](Filter f) { f->SetDirection(2); }).find("direction z"), std::string::npos);
  EXPECT_NE(refused([](Filter f) { f->SetDiffusivity("b", -1); }).find("the diffusivity of phase 'b' is -1"),
    std::string::npos);
  EXPECT_NE(refused([](Filter f) { f->SetTimeStep(-1); }).find("time step -1 is below 0"), std::string::npos);
  EXPECT_NE(
    refused([](Filter f) { f->SetLattice(vtkLatticeBoltzmann::D3Q7); }).find("d3q7 does not fit"), std::string::npos);
  const auto turned = stepper(image);
  ASSERT_EQ(errorOf(turned), ""); // and its states are kept
  image->SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1);
  EXPECT_NE(errorOf(turned).find("the image is turned in space"), std::string::npos);
  image->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1);
  EXPECT_NE(refused(
              [](Filter f)
              {
                f->RemoveAllDiffusivities();
                f->SetDiffusivity("a", 1);
              })
              .find("phase 'b' has no diffusivity (60 nodes)"),
    std::string::npos);
}

} // namespace
