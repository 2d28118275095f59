// States of a motion on the way, checkpoints, interruption; what is refused, the stable step before all.
#include "../TemporaryFolder.h"
#include "MotionTesting.h"

#include "vtkDoubleArray.h"
#include "vtkInformation.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;

TEST_F(BondDynamics, AStepAboveTheStableOneIsRefused)
{
  vtkNew<vtkBondDynamics> filter;
  configure(filter);
  filter->SetInputData(band());
  filter->SetMaximumBroken(1);
  ASSERT_EQ(errorOf(filter), "");
  const double stable = number(filter->GetOutput(), "stable_step");
  EXPECT_NEAR(number(filter->GetOutput(), "time_step") / stable, 0.8, 1e-12);
  filter->SetTimeStep(1.01 * stable);
  std::array<char, 64> bound{};
  std::snprintf(bound.data(), bound.size(), "is above the stable one, %.4g s", stable);
  const std::string error = errorOf(filter);
  EXPECT_NE(error.find(bound.data()), std::string::npos) << error;
  EXPECT_EQ(filter->GetFailure(), vtkBondAlgorithm::PARAMETER_FAILURE);
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  filter->SetTimeStep(0.5 * stable);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "time_step"), 0.5 * stable);
}

TEST_F(BondDynamics, StatesAtTimesChangeNothing)
{
  vtkNew<vtkBondDynamics> filter;
  configure(filter);
  filter->SetInputData(band());
  filter->PullOff();
  filter->SetSideVelocity("y+", "y", 20);
  filter->SetSideVelocity("y-", "y", -20);
  filter->SetEndTime(2e-7);
  ASSERT_EQ(errorOf(filter), "");
  const double energy = number(filter->GetOutput(), "supplied_energy");
  const double total = number(filter->GetOutput(), "total_broken");
  ASSERT_GT(total, 0);
  const double step = number(filter->GetOutput(), "time_step");
  for (const double time : { 0.0, 0.7e-7, 1.5e-7, 1.0 })
    filter->AddStateAtTime(time);
  filter->ComputeStressOn();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "supplied_energy"), energy);
  EXPECT_EQ(number(filter->GetOutput(), "total_broken"), total);
  ASSERT_EQ(filter->GetNumberOfStates(), 4);
  EXPECT_EQ(fieldTexts(filter->GetOutput(), "warnings").back().find("1 of the states asked for"), 0U);
  const std::array<double, 4> times{ 0, 0.7e-7, 1.5e-7, number(filter->GetOutput(), "end_time") };
  const ProgressCount runs(filter);
  for (int state = 0; state < 4; ++state)
  {
    filter->SetState(state);
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetOutput();
    EXPECT_NEAR(number(output, "time"), times[static_cast<std::size_t>(state)], 0.51 * step);
    EXPECT_EQ(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), number(output, "time"));
    // platens of three layers move as told
    EXPECT_NEAR(points(output, "displacement")->GetComponent(24 * 35 + 3, 1), 20 * number(output, "time"), 1e-18);
    EXPECT_EQ(points(output, "velocity")->GetComponent(24 * 35 + 3, 1), 20);
    EXPECT_EQ(points(output, "stress")->GetNumberOfComponents(), 6);
  }
  EXPECT_LE(runs.get(), 2 * 4); // the pipeline's own 0 and 1
  filter->ComputeVelocityOff();
  filter->ComputeDisplacementOff();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(points(filter->GetOutput(), "velocity"), nullptr);
  EXPECT_EQ(points(filter->GetOutput(), "displacement"), nullptr);
}

// Velocities of the input are those to begin with: nodes that fly apart fly on.
TEST_F(BondDynamics, TakesVelocitiesOfTheInput)
{
  const auto image = band();
  vtkNew<vtkDoubleArray> velocity;
  velocity->SetName("velocity");
  velocity->SetNumberOfComponents(3);
  velocity->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    velocity->SetTuple3(i, 0, 1e-3 * static_cast<double>(i / 24), 0);
  vtkNew<vtkBondDynamics> filter;
  configure(filter);
  filter->SetInputData(image);
  filter->PullOff();
  filter->UseInputVelocityOn();
  filter->SetEndTime(1e-12); // one step
  EXPECT_NE(errorOf(filter).find("the image has no point array 'velocity'"), std::string::npos);
  image->GetPointData()->AddArray(velocity);
  image->Modified();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "steps"), 1);
  EXPECT_NEAR(points(filter->GetOutput(), "velocity")->GetComponent(24 * 30 + 2, 1), 30e-3, 1e-4);
}

TEST_F(BondDynamics, Cancelled)
{
  vtkNew<vtkBondDynamics> filter;
  configure(filter);
  filter->SetInputData(band());
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetBrokenBonds()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetNumberOfStates(), 0);
}

// A run of two parts is one run, its history included, to the last bit.
TEST_F(BondDynamics, GoesOnFromACheckpoint)
{
  const lamella::testing::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  const auto run = [&](vtkBondDynamics* filter, vtkIdType most)
  {
    configure(filter);
    filter->SetInputData(band());
    filter->SetPhaseDensity("lamella", 900);
    filter->SetDamping(0.05);
    filter->SetRelaxation(1e-7);
    filter->SetCheckpointEvery(35);
    filter->SetMaximumBroken(most);
    return errorOf(filter);
  };
  vtkNew<vtkBondDynamics> whole;
  ASSERT_EQ(run(whole, 60), "");
  EXPECT_EQ(whole->GetLastCheckpoint(), 0);

  vtkNew<vtkBondDynamics> first;
  first->SetCheckpointFile(file);
  first->SetContinueFile(file); // not there yet
  ASSERT_EQ(run(first, 20), "");
  const double steps = number(first->GetOutput(), "steps");
  EXPECT_EQ(static_cast<double>(first->GetLastCheckpoint()), 35 * std::floor(steps / 35));
  EXPECT_EQ(fieldTexts(first->GetOutput(), "warnings").front().find("there was no checkpoint"), 0U);

  vtkNew<vtkBondDynamics> second;
  second->SetContinueFile(file);
  second->AddStateAtTime(0);
  ASSERT_EQ(run(second, 60), "");
  EXPECT_EQ(number(second->GetOutput(), "continued_at"), static_cast<double>(first->GetLastCheckpoint()));
  EXPECT_EQ(number(second->GetOutput(), "states_before"), 1);
  vtkPolyData* const bonds = whole->GetBrokenBonds();
  ASSERT_EQ(second->GetBrokenBonds()->GetNumberOfPoints(), bonds->GetNumberOfPoints());
  for (const char* name : { "event", "step", "time", "energy" })
  {
    for (vtkIdType i = 0; i < bonds->GetNumberOfPoints(); ++i)
    {
      ASSERT_EQ(second->GetBrokenBonds()->GetPointData()->GetArray(name)->GetTuple1(i),
        bonds->GetPointData()->GetArray(name)->GetTuple1(i))
        << name << " of bond " << i;
    }
  }
  ASSERT_EQ(second->GetCurve()->GetNumberOfRows(), whole->GetCurve()->GetNumberOfRows());
  for (vtkIdType row = 0; row < whole->GetCurve()->GetNumberOfRows(); ++row)
    for (const char* name : { "time", "strain", "stress", "rate", "kinetic_energy", "supplied_energy", "broken" })
      ASSERT_EQ(cell(second->GetCurve(), row, name), cell(whole->GetCurve(), row, name)) << name << " in row " << row;

  vtkNew<vtkBondDynamics> other;
  other->SetContinueFile(file);
  other->SetStepShare(0.5);
  EXPECT_NE(run(other, 60).find("is a checkpoint of another scene: step"), std::string::npos);
}

TEST_F(BondDynamics, WhatIsRefused)
{
  const auto fails = [](const std::function<void(vtkBondDynamics*)>& change, const char* message,
                       int failure = vtkBondAlgorithm::PARAMETER_FAILURE)
  { expectBandRefused<vtkBondDynamics>(change, message, failure); };
  const auto free = [](auto&& change)
  {
    return [change](vtkBondDynamics* f)
    {
      f->PullOff();
      f->SetEndTime(1e-8);
      change(f);
    };
  };
  fails([](auto* f) { f->SetDensity(0); }, "density 0 is not above 0");
  fails([](auto* f) { f->SetPhaseDensity("wall", -1); }, "the density of wall is -1");
  fails([](auto* f) { f->SetDamping(2); }, "damping 2 is above 1");
  fails([](auto* f) { f->SetStepShare(0); }, "step share 0 is below 1e-05");
  fails([](auto* f) { f->SetTimeStep(-1); }, "time step -1 is below 0");
  fails([](auto* f) { f->SetStrainRate(-1); }, "strain rate -1 is below 0");
  fails([](auto* f) { f->SetTravelTimes(0); }, "travel times 0 is not above 0");
  fails([](auto* f) { f->SetStartShare(2); }, "start 2 is above 1");
  fails([](auto* f) { f->SetStopShare(1); }, "stop 1 is not below 1");
  fails([](auto* f) { f->SetEndTime(-1); }, "end time -1 is below 0");
  fails([](auto* f) { f->SetMaximumStrain(std::nan("")); }, "max strain nan is not a number");
  fails([](auto* f) { f->AddStateAtTime(-1); }, "a state is asked for at the time -1 s");
  fails([](auto* f) { f->AddStateAtBroken(0); }, "a state is asked for at 0 broken bonds");
  fails([](auto* f) { f->SetRelaxation(-1); }, "tau -1 is below 0");
  fails([](auto* f) { f->SetSideVelocity("y+", "y", 1); }, "a pull by platens, and speeds or tractions of sides");
  fails([](auto* f) { f->RemoveAllCriticalStretches(); }, "no strain rate, and nothing can break");
  fails(
    [](auto* f)
    {
      f->RemoveAllCriticalStretches();
      f->SetStrainRate(1);
      f->SetRelaxation(1e-6);
    },
    "gives way to what breaks, and nothing can break");
  fails(free([](auto*) {}), "nothing moves the sample");
  fails(free([](auto* f) { f->SetSideVelocity("top", "y", 1); }), "there is no side 'top' in 2 dimensions");
  fails(free([](auto* f) { f->SetSideVelocity("z+", "y", 1); }), "there is no side 'z+' in 2 dimensions");
  fails(free([](auto* f) { f->SetSideVelocity("y+", "z", 1); }), "there is no component 'z' in 2 dimensions");
  fails(free([](auto* f) { f->SetSideVelocity("y+", "y", std::nan("")); }), "a velocity of nan m/s along y");
  fails(free([](auto* f) { f->SetSideTraction("x-", "y", INFINITY); }), "a traction of inf Pa along y");
  fails(free([](auto* f) { f->SetInitialVelocity(std::nan(""), 0, 0); }), "initial velocity (x) nan is not a number");
  fails(free([](auto* f) { f->AddBoxVelocity(1, 1, 0, 2, 2, 0, "x", 1); }), "there is no solid node in box 1");
  fails(free(
          [](auto* f)
          {
            f->SetInitialVelocity(1, 0, 0);
            f->SetEndTime(0);
          }),
    "the motion has no end");
  fails(free(
          [](auto* f)
          {
            f->SetSideVelocity("x-", "x", 1);
            f->SetPeriodic(1, 0, 0);
          }),
    "side 'x-' of a sample that is periodic along x");
}

} // namespace
