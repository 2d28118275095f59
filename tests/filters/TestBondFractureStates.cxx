// States of a fracture on the way: they change nothing that breaks, and one is shown without a new run; ends,
// interruption, what is refused.
#include "../TemporaryFolder.h"
#include "FractureTesting.h"

#include "vtkCallbackCommand.h"
#include "vtkInformation.h"
#include "vtkMath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;

/// Of all that is not NaN, as damage is in voids.
double sum(vtkDataArray* array)
{
  double total = 0;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    const double value = array->GetTuple1(i);
    total += std::isnan(value) ? 0 : value;
  }
  return total;
}

/// What a run hands out on its way.
struct Seen
{
  std::vector<double> Broken;
  std::vector<double> MeanStress;
  std::vector<std::size_t> PlatenLayers;
};

TEST_F(BondFracture, StepsAreHandedOutOneAtATime)
{
  const auto image = band();
  vtkNew<vtkBondFracture> kept;
  vtkNew<vtkBondFracture> passing;
  Seen seen;
  vtkNew<vtkCallbackCommand> take;
  take->SetClientData(&seen);
  take->SetCallback(
    [](vtkObject*, unsigned long, void* to, void* state)
    {
      auto* const data = vtkImageData::SafeDownCast(static_cast<vtkDataObject*>(state));
      auto* const s = static_cast<Seen*>(to);
      s->Broken.push_back(number(data, "broken_bonds"));
      s->MeanStress.push_back(sum(points(data, "damage")) + points(data, "stress")->GetTuple(30 * 24 + 5)[1]);
      s->PlatenLayers.push_back(fieldNumbers(data, "platen_layers").size());
    });
  passing->AddObserver(vtkSampleAlgorithm::STEP_EVENT, take);
  passing->KeepStatesOff();
  for (vtkBondFracture* const filter : { kept.Get(), passing.Get() })
  {
    configure(filter);
    filter->SetInputData(image);
    filter->ComputeStressOn();
    filter->AddStateAtBroken(10);
    filter->AddStateAtBroken(30);
    ASSERT_EQ(errorOf(filter), "");
  }
  ASSERT_EQ(kept->GetNumberOfStates(), 3);
  EXPECT_EQ(passing->GetNumberOfStates(), 1);
  ASSERT_EQ(seen.Broken.size(), 3U);
  for (int i = 0; i < 3; ++i) // the same states to the bit, those of platens with them
  {
    vtkImageData* const state = kept->GetStateImage(i);
    EXPECT_EQ(seen.Broken[static_cast<std::size_t>(i)], number(state, "broken_bonds"));
    EXPECT_EQ(seen.MeanStress[static_cast<std::size_t>(i)],
      sum(points(state, "damage")) + points(state, "stress")->GetTuple(30 * 24 + 5)[1]);
    EXPECT_EQ(seen.PlatenLayers[static_cast<std::size_t>(i)], 4U);
  }
  EXPECT_EQ(number(passing->GetOutput(), "total_broken"), number(kept->GetOutput(), "total_broken"));
}

/// The largest difference of an array of two images over its largest value.
double difference(vtkImageData* a, vtkImageData* b, const char* name)
{
  vtkDataArray* const first = points(a, name);
  vtkDataArray* const second = points(b, name);
  double most = 0;
  double largest = 0;
  for (vtkIdType i = 0; i < first->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < first->GetNumberOfComponents(); ++c)
    {
      most = std::max(most, std::abs(first->GetComponent(i, c) - second->GetComponent(i, c)));
      largest = std::max(largest, std::abs(first->GetComponent(i, c)));
    }
  }
  return most / largest;
}

// Fields of a state that are asked for after the run are those of the run, to the last bit (tests/plugin/live.py:
// pieces that came loose included); and neither they nor an image that is new but holds the same arrays, as ParaView's
// are, run it again.
TEST_F(BondFracture, FieldsRunNothing)
{
  // two platens, a column from one to the other, and a block between weak necks
  const auto image = picture(
    40, 44, 1,
    [](int x, int y, int)
    {
      const bool block = x >= 8 && x < 19;
      return y < 12 || y >= 32 || x >= 26 ? 1 : !block ? 0 : y < 17 || y >= 27 ? 2 : 1;
    },
    bandSpacing);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "wall", "lamella" });
  const auto prepare = [&](vtkBondFracture* filter)
  {
    configure(filter);
    filter->SetMaximumStrain(6e-3);
    filter->AddStateAtBroken(20);
    filter->SetInputData(image);
  };
  vtkNew<vtkBondFracture> before;
  prepare(before);
  before->ComputeStressOn();
  before->ComputeStrainEnergyOn();
  ASSERT_EQ(errorOf(before), "");
  vtkNew<vtkBondFracture> after;
  prepare(after);
  ASSERT_EQ(errorOf(after), "");
  const auto time = [&] { return number(after->GetOutput(), "seconds", 5); }; // of the whole run
  const double ran = time();
  for (const int state : { 0, 1 })
  {
    before->SetState(state);
    after->SetState(state);
    after->ComputeStressOn();
    after->ComputeStrainEnergyOn();
    ASSERT_EQ(errorOf(before), "");
    ASSERT_EQ(errorOf(after), "");
    EXPECT_EQ(time(), ran);
    EXPECT_EQ(difference(before->GetOutput(), after->GetOutput(), "stress"), 0) << state;
    EXPECT_EQ(difference(before->GetOutput(), after->GetOutput(), "strain_energy"), 0) << state;
    after->ComputeStressOff();
    after->ComputeDisplacementOff();
    after->ComputeStrainEnergyOff();
    ASSERT_EQ(errorOf(after), "");
    EXPECT_EQ(points(after->GetOutput(), "stress"), nullptr);
    EXPECT_EQ(points(after->GetOutput(), "displacement"), nullptr);
    after->ComputeDisplacementOn();
  }
  vtkNew<vtkImageData> same;
  same->ShallowCopy(image);
  after->SetInputData(same);
  after->Modified(); // as a new input does, too
  ASSERT_EQ(errorOf(after), "");
  EXPECT_NE(time(), ran) << "a setting may have changed";
  const double again = time();
  same->Modified();
  ASSERT_EQ(errorOf(after), "");
  EXPECT_EQ(time(), again);
  points(same, "phase")->SetComponent(0, 0, 2);
  points(same, "phase")->Modified();
  same->Modified();
  ASSERT_EQ(errorOf(after), "");
  EXPECT_NE(time(), again);
  EXPECT_EQ(after->GetStateRange()[0], -1);
  EXPECT_EQ(after->GetStateRange()[1], after->GetNumberOfStates() - 1);
}

TEST_F(BondFracture, StatesChangeNothing)
{
  const auto image = band();
  vtkNew<vtkBondFracture> plain;
  configure(plain);
  plain->SetInputData(image);
  plain->ComputeDisplacementOff();
  ASSERT_EQ(errorOf(plain), "");
  EXPECT_EQ(points(plain->GetOutput(), "displacement"), nullptr);
  EXPECT_EQ(plain->GetNumberOfStates(), 1);

  vtkNew<vtkBondFracture> filter;
  configure(filter);
  filter->SetInputData(image);
  filter->ComputeStressOn();
  filter->ComputeStrainEnergyOn();
  const double first = number(plain->GetOutput(), "first_break_strain");
  filter->AddStateAtStrain(0.5 * first);
  filter->AddStateAtBroken(30);
  filter->AddStateAtBroken(10);
  filter->AddStateAtStrain(1); // beyond the end
  ASSERT_EQ(errorOf(filter), "");
  ASSERT_EQ(filter->GetNumberOfStates(), 4);
  EXPECT_EQ(fieldTexts(filter->GetOutput(), "warnings").back().find("1 of the states asked for"), 0U);
  vtkPolyData* const broken = filter->GetBrokenBonds();
  ASSERT_EQ(broken->GetNumberOfPoints(), plain->GetBrokenBonds()->GetNumberOfPoints());
  for (vtkIdType i = 0; i < broken->GetNumberOfPoints(); ++i)
    ASSERT_EQ(vtkMath::Distance2BetweenPoints(broken->GetPoint(i), plain->GetBrokenBonds()->GetPoint(i)), 0);

  ASSERT_EQ(filter->GetCurve()->GetNumberOfRows(), plain->GetCurve()->GetNumberOfRows());
  for (vtkIdType row = 0; row < plain->GetCurve()->GetNumberOfRows(); ++row)
    ASSERT_EQ(cell(filter->GetCurve(), row, "stress"), cell(plain->GetCurve(), row, "stress"));

  const ProgressCount runs(filter);
  const std::array<double, 4> expected{ 0, 10, 30, number(filter->GetOutput(), "total_broken") };
  for (int state = 0; state < 4; ++state)
  {
    filter->SetState(state);
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetOutput();
    EXPECT_EQ(number(output, "broken_bonds"), expected[static_cast<std::size_t>(state)]);
    EXPECT_EQ(sum(points(output, "broken")), 2 * number(output, "broken_bonds"));
    // the fields are those of an equilibrium at this strain: the mean over the section of the middle layers is the
    // stress on the platens; that of the events' method errs by 5e-3 between its corrections
    vtkDataArray* const stress = points(output, "stress");
    double mean = 0;
    for (int x = 0; x < 24; ++x)
      for (int y = 26; y < 30; ++y)
        mean += stress->GetComponent(24 * y + x, 1) / 96;
    if (state < 3)
      EXPECT_NEAR(mean / number(output, "stress"), 1, 1e-2) << state;
  }
  EXPECT_EQ(
    filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), number(filter->GetOutput(), "strain"));
  EXPECT_LE(runs.get(), 2 * 4); // the pipeline's own 0 and 1
  filter->SetState(0);
  filter->Update();
  EXPECT_EQ(number(filter->GetOutput(), "strain"), 0.5 * first);
  EXPECT_NEAR(
    number(filter->GetOutput(), "stress") / number(filter->GetOutput(), "effective_modulus") / first, 0.5, 1e-9);
  filter->SetStopShare(0.5);
  filter->Update();
  EXPECT_LT(number(filter->GetOutput(), "total_broken"), expected[3]);
}

TEST_F(BondFracture, EndsWhereItIsTold)
{
  vtkNew<vtkBondFracture> filter;
  configure(filter);
  filter->SetInputData(band());
  filter->SetMaximumStrain(1e-4);
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* output = filter->GetOutput();
  EXPECT_EQ(fieldText(output, "end"), "maximum-strain");
  EXPECT_EQ(number(output, "strain"), 1e-4);
  EXPECT_NEAR(number(output, "peak_stress"), 1e-4 * number(output, "effective_modulus"), 1e-6);
  EXPECT_TRUE(std::isnan(number(output, "first_break_strain")));
  EXPECT_EQ(filter->GetBrokenBonds()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetCurve()->GetNumberOfRows(), 2);
  filter->SetMaximumStrain(0);
  filter->SetMaximumBroken(12);
  filter->CompressionOn();
  filter->Update();
  output = filter->GetOutput();
  EXPECT_EQ(fieldText(output, "end"), "maximum-broken");
  EXPECT_GT(number(output, "peak_stress"), 0);
  EXPECT_LT(points(output, "displacement")->GetComponent(24 * 35 + 3, 1), 0);
}

// In the first equilibrium and between breaks; a run after it is as good as any.
TEST_F(BondFracture, Cancelled)
{
  vtkNew<vtkBondFracture> filter;
  configure(filter);
  filter->SetInputData(band());
  struct Client
  {
    std::string word; // stops when the text holds it
    std::string last;
  } client;
  vtkNew<vtkCallbackCommand> stop;
  stop->SetClientData(&client);
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void* data, void*)
    {
      auto* const algorithm = static_cast<vtkAlgorithm*>(caller);
      auto* const told = static_cast<Client*>(data);
      told->last = algorithm->GetProgressText() != nullptr ? algorithm->GetProgressText() : "";
      if (told->last.find(told->word) != std::string::npos)
        algorithm->SetAbortExecute(1);
    });
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, stop);
  for (const char* word : { "first equilibrium", "bonds broken" })
  {
    client.word = word;
    filter->SetAbortExecute(0); // VTK keeps it
    filter->Modified();
    EXPECT_EQ(errorOf(filter), "");
    EXPECT_NE(client.last.find(word), std::string::npos) << client.last;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    EXPECT_EQ(filter->GetBrokenBonds()->GetNumberOfPoints(), 0);
    EXPECT_EQ(filter->GetNumberOfStates(), 0);
  }
  filter->RemoveObserver(tag);
  filter->SetAbortExecute(0);
  filter->Modified();
  ASSERT_EQ(errorOf(filter), "");
  vtkNew<vtkBondFracture> plain;
  configure(plain);
  plain->SetInputData(band());
  ASSERT_EQ(errorOf(plain), "");
  EXPECT_EQ(number(filter->GetOutput(), "peak_stress"), number(plain->GetOutput(), "peak_stress"));
  EXPECT_EQ(filter->GetBrokenBonds()->GetNumberOfPoints(), plain->GetBrokenBonds()->GetNumberOfPoints());
}

// A run of two parts breaks what one run breaks; states before the checkpoint are not made.
TEST_F(BondFracture, GoesOnFromACheckpoint)
{
  const lamella::testing::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  const auto run = [&](vtkBondFracture* filter, vtkIdType most)
  {
    configure(filter);
    filter->SetInputData(band());
    filter->SetCheckpointEvery(15);
    filter->SetMaximumBroken(most);
    return errorOf(filter);
  };
  vtkNew<vtkBondFracture> whole;
  ASSERT_EQ(run(whole, 60), "");
  EXPECT_EQ(whole->GetLastCheckpoint(), 0);

  vtkNew<vtkBondFracture> first;
  first->SetCheckpointFile(file);
  first->SetContinueFile(file); // not there yet
  ASSERT_EQ(run(first, 40), "");
  EXPECT_EQ(first->GetLastCheckpoint(), 30);
  EXPECT_EQ(fieldTexts(first->GetOutput(), "warnings").front().find("there was no checkpoint"), 0U);

  vtkNew<vtkBondFracture> second;
  second->SetContinueFile(file);
  second->AddStateAtBroken(20);
  second->AddStateAtBroken(50);
  ASSERT_EQ(run(second, 60), "");
  EXPECT_EQ(number(second->GetOutput(), "continued_at"), 30);
  EXPECT_EQ(number(second->GetOutput(), "states_before"), 1);
  ASSERT_EQ(second->GetNumberOfStates(), 2);
  EXPECT_EQ(number(second->GetStateImage(0), "broken_bonds"), 50);
  ASSERT_EQ(second->GetBrokenBonds()->GetNumberOfPoints(), 60);
  for (const char* name : { "event", "strain", "critical_strain", "stress" })
  {
    for (vtkIdType i = 0; i < 60; ++i)
    {
      ASSERT_EQ(second->GetBrokenBonds()->GetPointData()->GetArray(name)->GetTuple1(i),
        whole->GetBrokenBonds()->GetPointData()->GetArray(name)->GetTuple1(i))
        << name << " of bond " << i;
    }
  }
  EXPECT_EQ(second->GetCurve()->GetNumberOfRows(), whole->GetCurve()->GetNumberOfRows());

  vtkNew<vtkBondFracture> other;
  other->SetContinueFile(file);
  other->CompressionOn();
  EXPECT_NE(run(other, 60).find("is a checkpoint of another scene: unit strain"), std::string::npos);
}

TEST_F(BondFracture, WhatIsRefused)
{
  const auto fails = [](const std::function<void(vtkBondFracture*)>& change, const char* message,
                       int failure = vtkBondAlgorithm::PARAMETER_FAILURE)
  { expectBandRefused<vtkBondFracture>(change, message, failure); };
  fails([](auto* f) { f->SetCriticalStretch("lamella", 0); }, "the critical stretch of lamella is 0");
  fails([](auto* f) { f->SetCriticalStretch("lamella", -1e-3); }, "the critical stretch of lamella is -0.001");
  fails([](auto* f) { f->RemoveAllCriticalStretches(); }, "nothing can break");
  fails([](auto* f) { f->LargeStrainsOn(); }, "fracture in large strains");
  fails([](auto* f) { f->SetStopShare(1); }, "stop 1 is not below 1");
  fails([](auto* f) { f->SetMaximumStrain(-1); }, "max strain -1 is below 0");
  fails([](auto* f) { f->SetMaximumStrain(std::nan("")); }, "max strain nan is not a number");
  fails([](auto* f) { f->SetMaximumBroken(-1); }, "max broken -1 is below 0");
  fails([](auto* f) { f->AddStateAtStrain(-1e-3); }, "a state is asked for at the strain -0.001");
  fails([](auto* f) { f->AddStateAtBroken(0); }, "a state is asked for at 0 broken bonds");
  fails(
    [](auto* f)
    {
      f->ComputeDisplacementOff();
      f->ComputeStressOn();
    },
    "the stress of nodes without their displacements");
  fails(
    [](auto* f)
    {
      f->SetMethod(vtkBondFracture::EVENTS);
      f->SetBreaking(vtkBondFracture::BATCHED);
    },
    "batches of bonds cannot be broken with local corrections");
  fails(
    [](auto* f)
    {
      f->SetMethod(vtkBondFracture::EVENTS);
      f->SetPeriodic(1, 0, 0);
    },
    "fracture with local corrections of a periodic sample");
  fails([](auto* f) { f->SetTolerance(1e-2); }, "a tolerance of 0.01 for fracture");
  fails(
    [](auto* f)
    {
      // a zigzag of single nodes joins the halves: it unfolds and resists nothing
      const auto image = band();
      f->SetHorizon(1.5);
      for (int i = 0; i < 24 * 5; ++i)
        points(image, "phase")->SetTuple1(24 * 20 + i, i % 24 == 2 + i / 24 % 2 ? 1 : 0);
      f->SetInputData(image);
    },
    "the sample carries too little for a strength at a tolerance of 1e-06", vtkBondAlgorithm::INPUT_FAILURE);
  fails(
    [](auto* f)
    {
      const auto image = band();
      for (int i = 0; i < 24 * 5; ++i)
      {
        points(image, "phase")->SetTuple1(24 * 20 + i, 0);
      }
      f->SetInputData(image);
    },
    "no piece of the sample reaches from one platen to the other along y", vtkBondAlgorithm::NO_PATH_FAILURE);
}

} // namespace
