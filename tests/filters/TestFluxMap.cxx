// Flux map: numbers on laminates, fluxes computed from fields, streamlines that respect what does not conduct.
#include "VtkTesting.h"

#include "flux/FluxLines.h"

#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkFluxMap.h"
#include "vtkIdTypeArray.h"
#include "vtkLatticeBoltzmann.h"
#include "vtkPolyData.h"
#include "vtkSteadyDiffusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::picture;
using vtktest::points;

struct Chain
{
  vtkNew<vtkSteadyDiffusion> solver;
  vtkNew<vtkFluxMap> map;

  Chain(vtkImageData* image, int direction, double a = 1, double b = 10)
  {
    solver->SetInputData(image);
    solver->SetConductivity("a", a);
    solver->SetConductivity("b", b);
    solver->SetDirection(direction);
    solver->SetTolerance(1e-10);
    map->SetInputConnection(solver->GetOutputPort());
  }
  [[nodiscard]] std::vector<double> numbers(const char* name) { return fieldNumbers(map->GetOutput(), name); }
};

int layersAcrossX(int x, int, int)
{
  return x / 3 % 2;
}

TEST(FluxMap, LaminateNumbers)
{
  Chain chain(picture(24, 18, 1, layersAcrossX), vtkSteadyDiffusion::ALL);
  ASSERT_EQ(errorOf(chain.map), "");
  const double series = 2.0 / 1.1;
  const double parallel = 5.5;
  const auto effective = chain.numbers("effective_from_flux");
  ASSERT_EQ(effective.size(), 9U);
  EXPECT_NEAR(effective[0], series, 1e-8); // the solver's tolerance
  EXPECT_NEAR(effective[4], parallel, 1e-8);
  EXPECT_NEAR(effective[1], 0, 1e-8);
  EXPECT_TRUE(std::isnan(effective[8]));
  const auto flux = chain.numbers("mean_flux");
  EXPECT_NEAR(flux[0], series / 24e-6, 1e-2);    // of about 1e5: the same relative tolerance
  EXPECT_NEAR(flux[4], -parallel / 18e-6, 1e-2); // downwards
  for (const int axis : { 0, 1 })                // all flows straight
    EXPECT_NEAR(chain.numbers("tortuosity").at(static_cast<std::size_t>(axis)), 1, 1e-8);
  EXPECT_NEAR(chain.numbers("tortuosity_factor").at(0), parallel / series, 1e-7);
  EXPECT_NEAR(chain.numbers("tortuosity_factor").at(1), 1, 1e-7);
  EXPECT_NEAR(chain.numbers("streamline_tortuosity").at(0), 1, 1e-8);
  EXPECT_TRUE(std::isnan(chain.numbers("streamline_tortuosity").at(1))); // not shown
  // What the lines carry is what flows in: k · height / length.
  EXPECT_NEAR(chain.numbers("line_flux").at(0) * 60, series * 18 / 24, 1e-7);
}

TEST(FluxMap, KeepsTheInputAndAddsTheMagnitude)
{
  Chain chain(picture(24, 18, 1, vtktest::blobs), vtkSteadyDiffusion::ALL);
  chain.map->SetDirection(vtkFluxMap::Y);
  ASSERT_EQ(errorOf(chain.map), "");
  vtkImageData* const output = chain.map->GetOutput();
  for (const char* const name : { "phase", "temperature_x", "temperature_y", "flux_x", "flux_y" })
    EXPECT_NE(points(output, name), nullptr) << name;
  vtkDataArray* const magnitude = points(output, "flux_magnitude");
  ASSERT_NE(magnitude, nullptr);
  for (const vtkIdType node : { 0, 77, 431 })
  {
    double q[3];
    points(output, "flux_y")->GetTuple(node, q);
    EXPECT_DOUBLE_EQ(magnitude->GetTuple1(node), std::hypot(q[0], q[1]));
  }
  // The solver's own number, from the energy, stays.
  EXPECT_EQ(fieldNumbers(output, "effective_conductivity").at(4), chain.solver->GetEffectiveConductivity()[4]);
  EXPECT_NE(provenance(output).find("flux_map"), std::string::npos);
  EXPECT_EQ(fieldNumbers(chain.map->GetStreamlines(), "tortuosity").size(), 3U);
}

struct Setting
{
  int lattice;
  int sides;
  int direction;
  bool threeDimensional;
};

class RecomputedFlux : public ::testing::TestWithParam<Setting>
{
};

// The flux that the map computes from field and phases is the solver's own, on every lattice and at every side.
TEST_P(RecomputedFlux, EqualsTheSolvers)
{
  const Setting& setting = GetParam();
  for (const double weak : { 0.0, 0.1 }) // what does not conduct has no value
  {
    const auto image =
      setting.threeDimensional ? picture(10, 9, 8, vtktest::blobs) : picture(23, 20, 1, vtktest::blobs);
    Chain with(image, setting.direction, weak, 1);
    Chain without(image, setting.direction, weak, 1);
    for (Chain* const chain : { &with, &without })
    {
      chain->solver->SetLattice(setting.lattice);
      chain->solver->SetSides(setting.sides);
    }
    without.solver->ComputeFluxOff();
    ASSERT_EQ(errorOf(with.map), "");
    ASSERT_EQ(errorOf(without.map), "");
    vtkDataArray* const expected = points(with.map->GetOutput(), "flux");
    vtkDataArray* const found = points(without.map->GetOutput(), "flux");
    ASSERT_NE(found, nullptr);
    const double scale = points(with.map->GetOutput(), "flux_magnitude")->GetRange()[1];
    double worst = 0;
    for (vtkIdType node = 0; node < expected->GetNumberOfTuples(); ++node)
      for (int axis = 0; axis < 3; ++axis)
        worst = std::max(worst, std::abs(expected->GetComponent(node, axis) - found->GetComponent(node, axis)));
    EXPECT_LT(worst / scale, 1e-11) << "weak phase " << weak; // round-off of differences of values near 1
    // The lines follow what flows in to where it flows out: none is lost on the way.
    vtkDataArray* const arrived = without.map->GetStreamlines()->GetCellData()->GetArray("arrived");
    ASSERT_GT(arrived->GetNumberOfTuples(), 0);
    if (setting.sides == vtkSteadyDiffusion::INSULATED)
    {
      EXPECT_EQ(arrived->GetRange()[0], 1);
      EXPECT_EQ(arrived->GetNumberOfTuples(), 60);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllLattices, RecomputedFlux,
  ::testing::Values(Setting{ vtkSteadyDiffusion::D2Q5, 0, 0, false }, Setting{ vtkSteadyDiffusion::D2Q5, 0, 1, false },
    Setting{ vtkSteadyDiffusion::D2Q5, 1, 0, false }, Setting{ vtkSteadyDiffusion::D2Q5, 1, 1, false },
    Setting{ vtkSteadyDiffusion::D2Q9, 0, 0, false }, Setting{ vtkSteadyDiffusion::D2Q9, 0, 1, false },
    Setting{ vtkSteadyDiffusion::D2Q9, 1, 1, false }, Setting{ vtkSteadyDiffusion::D3Q7, 0, 1, true },
    Setting{ vtkSteadyDiffusion::D3Q7, 1, 2, true }, Setting{ vtkSteadyDiffusion::D3Q19, 0, 2, true },
    Setting{ vtkSteadyDiffusion::D3Q19, 1, 0, true }),
  [](const auto& setting)
  {
    return vtktest::latticeName(setting.param.lattice) +
      (setting.param.sides == vtkSteadyDiffusion::PERIODIC ? "_periodic_" : "_insulated_") +
      "xyz"[setting.param.direction];
  });

TEST(Streamlines, StayInWhatConducts)
{
  const auto image = picture(40, 40, 1, vtktest::blobs);
  Chain chain(image, vtkSteadyDiffusion::X, 0, 1);
  chain.map->SetNumberOfStreamlines(200);
  ASSERT_EQ(errorOf(chain.map), "");
  vtkPolyData* const lines = chain.map->GetStreamlines();
  ASSERT_EQ(lines->GetNumberOfLines(), 200);
  vtkDataArray* const phase = points(image, "phase");
  for (vtkIdType line = 0; line < lines->GetNumberOfCells(); ++line)
  {
    vtkPoints* const path = lines->GetCell(line)->GetPoints();
    for (vtkIdType i = 0; i + 1 < path->GetNumberOfPoints(); ++i)
    {
      double a[3];
      double b[3];
      path->GetPoint(i, a);
      path->GetPoint(i + 1, b);
      // Each step crosses one pixel: its middle lies inside.
      const int x = static_cast<int>((a[0] + b[0]) / 2e-6);
      const int y = static_cast<int>((a[1] + b[1]) / 2e-6);
      ASSERT_EQ(phase->GetTuple1(x + 40 * y), 1) << "line " << line << " at pixel " << x << ", " << y;
    }
  }
}

TEST(Streamlines, CrowdWhereMuchFlows)
{
  // Two channels side by side, one ten times as conductive: ten elevenths of the lines are in it.
  Chain chain(picture(20, 20, 1, [](int, int y, int) { return y >= 10 ? 1 : 0; }), vtkSteadyDiffusion::X);
  chain.map->SetNumberOfStreamlines(110);
  ASSERT_EQ(errorOf(chain.map), "");
  vtkPolyData* const lines = chain.map->GetStreamlines();
  int upper = 0;
  for (vtkIdType line = 0; line < lines->GetNumberOfCells(); ++line)
    upper += lines->GetCell(line)->GetPoints()->GetPoint(0)[1] > 10e-6 ? 1 : 0;
  EXPECT_EQ(upper, 100);
  EXPECT_NEAR(lines->GetBounds()[0], 0, 1e-12); // from edge to edge
  EXPECT_NEAR(lines->GetBounds()[1], 20e-6, 1e-12);
}

TEST(Streamlines, ValuesFallFromOneToZeroAndArcLengthGrows)
{
  Chain chain(picture(30, 30, 1, vtktest::blobs), vtkSteadyDiffusion::Y);
  ASSERT_EQ(errorOf(chain.map), "");
  vtkPolyData* const lines = chain.map->GetStreamlines();
  vtkDataArray* const value = lines->GetPointData()->GetArray("temperature");
  vtkDataArray* const arc = lines->GetPointData()->GetArray("arc_length");
  vtkDataArray* const length = lines->GetCellData()->GetArray("length");
  for (vtkIdType line = 0; line < lines->GetNumberOfCells(); ++line)
  {
    vtkIdList* const ids = lines->GetCell(line)->GetPointIds();
    const vtkIdType first = ids->GetId(0);
    const vtkIdType last = ids->GetId(ids->GetNumberOfIds() - 1);
    EXPECT_EQ(value->GetTuple1(first), 1);
    EXPECT_EQ(value->GetTuple1(last), 0);
    EXPECT_EQ(arc->GetTuple1(first), 0);
    EXPECT_DOUBLE_EQ(arc->GetTuple1(last), length->GetTuple1(line));
    EXPECT_GE(length->GetTuple1(line), 30e-6 * (1 - 1e-12));
    const double top = lines->GetPoint(first)[1]; // GetPoint() has one buffer
    EXPECT_GT(top, lines->GetPoint(last)[1]);
  }
}

TEST(Streamlines, SeedsCoverAFaceByItsFlux)
{
  // 8 × 8 nodes, half of the face with three times the flux: three quarters of the seeds.
  std::vector<double> inflow(64);
  for (std::size_t i = 0; i < 64; ++i)
    inflow[i] = i % 8 < 4 ? 3.0 : 1.0;
  const auto seeds = flux::seedInlet(inflow, { 8, 8 }, 400);
  ASSERT_EQ(seeds.size(), 400U);
  std::map<std::pair<int, int>, int> blocks; // 4 × 4 blocks of 2 × 2 nodes
  for (const auto& seed : seeds)
    ++blocks[{ static_cast<int>(seed[0]) / 2, static_cast<int>(seed[1]) / 2 }];
  for (int u = 0; u < 4; ++u)
  {
    for (int v = 0; v < 4; ++v)
    {
      const int even = u < 2 ? 37 : 12;                           // 400 · 12 (or 4) / 128
      EXPECT_NEAR((blocks[{ u, v }]), even, 3) << u << ", " << v; // the lattice's discrepancy: a few points a block
    }
  }
  EXPECT_TRUE(flux::seedInlet(std::vector<double>(64, 0.0), { 8, 8 }, 10).empty());
}

TEST(FluxMap, WorksOnFluxAlone)
{
  Chain chain(picture(24, 18, 1, layersAcrossX), vtkSteadyDiffusion::Y);
  chain.solver->Update();
  vtkNew<vtkImageData> bare;
  bare->CopyStructure(chain.solver->GetOutput());
  bare->GetPointData()->AddArray(points(chain.solver->GetOutput(), "flux"));
  vtkNew<vtkFluxMap> map;
  map->SetInputData(bare);
  ASSERT_EQ(errorOf(map), "");
  EXPECT_NEAR(fieldNumbers(map->GetOutput(), "effective_conductivity").at(4), 5.5, 1e-8);
  EXPECT_TRUE(std::isnan(fieldNumbers(map->GetOutput(), "tortuosity_factor").at(1))); // no conductivities
  EXPECT_EQ(map->GetStreamlines()->GetNumberOfLines(), 60);
  map->SetNumberOfStreamlines(0);
  ASSERT_EQ(errorOf(map), "");
  EXPECT_EQ(map->GetStreamlines()->GetNumberOfLines(), 0);
}

TEST(FluxMap, StatesInTimeHaveLinesAndNoConductivity)
{
  vtkNew<vtkLatticeBoltzmann> stepper;
  stepper->SetInputData(picture(20, 6, 1, [](int, int y, int) { return y / 3; }));
  stepper->SetDiffusivity("a", 1e-7);
  stepper->SetDiffusivity("b", 1e-8);
  stepper->SetInletValue(20);
  stepper->SetOutletValue(5);
  stepper->SetSides(vtkLatticeBoltzmann::PERIODIC);
  stepper->SetEndTime(0.4); // at rest: ten times L²/D of b
  stepper->SetNumberOfSteps(1);
  stepper->ComputeFluxOn();
  vtkNew<vtkFluxMap> map;
  map->SetInputConnection(stepper->GetOutputPort());
  map->SetNumberOfStreamlines(12);
  ASSERT_EQ(errorOf(map), "");
  vtkImageData* const output = map->GetOutput();
  EXPECT_TRUE(std::isnan(fieldNumbers(output, "effective_from_flux").at(0)));
  EXPECT_TRUE(fieldNumbers(output, "effective_conductivity").empty());
  EXPECT_NEAR(fieldNumbers(output, "tortuosity").at(0), 1, 1e-6);
  // Layers in parallel: 15 × 5.5e-8 / 20 µm through 6 µm, an equal share for each line.
  const double through = 15 * 5.5e-8 / 20e-6 * 6e-6;
  EXPECT_NEAR(12 * fieldNumbers(output, "line_flux").at(0) / through, 1, 1e-6);
}

TEST(FluxMap, AbortLeavesNothing)
{
  Chain chain(picture(24, 18, 1, vtktest::blobs), vtkSteadyDiffusion::X);
  chain.solver->Update();
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  chain.map->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(errorOf(chain.map), "");
  EXPECT_EQ(chain.map->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(chain.map->GetStreamlines()->GetNumberOfPoints(), 0);
}

TEST(FluxMap, InputThatCannotBeUsedIsRefusedInWords)
{
  Chain chain(picture(12, 12, 1, layersAcrossX), vtkSteadyDiffusion::X);
  chain.solver->Update();
  struct Case
  {
    const char* what;
    std::function<void(vtkFluxMap*, vtkImageData*)> spoil;
    const char* words;
  };
  const std::vector<Case> cases{
    { "nothing", [](auto*, auto* i) { i->GetPointData()->Initialize(); }, "no point array 'temperature'" },
    { "cells",
      [](auto*, auto* i)
      {
        i->GetPointData()->Initialize();
        vtkNew<vtkDoubleArray> q;
        q->SetName("flux");
        q->SetNumberOfComponents(3);
        q->SetNumberOfTuples(121);
        i->GetCellData()->AddArray(q);
      },
      "cell data" },
    { "components",
      [](auto*, auto* i)
      {
        vtkNew<vtkDoubleArray> q;
        q->SetName("flux");
        q->SetNumberOfComponents(2);
        q->SetNumberOfTuples(144);
        q->Fill(0);
        i->GetPointData()->AddArray(q);
      },
      "'flux' has 2 component" },
    { "finite", [](auto*, auto* i) { points(i, "flux")->SetComponent(77, 1, std::nan("")); }, "nan at node 77" },
    { "infinite", [](auto*, auto* i) { points(i, "temperature")->SetComponent(5, 0, INFINITY); }, "inf at node 5" },
    { "neither flux nor phases",
      [](auto*, auto* i)
      {
        i->GetPointData()->RemoveArray("flux");
        i->GetFieldData()->RemoveArray("phase_conductivity");
      },
      "cannot be computed from 'temperature'" },
    { "direction", [](auto* f, auto*) { f->SetDirection(vtkFluxMap::Y); }, "direction y was not solved" },
    { "chosen", [](auto* f, auto*) { f->SetInputArrayToProcess(0, 0, 0, 0, "pressure"); },
      "no point array 'pressure'" },
  };
  for (const Case& test : cases)
  {
    vtkNew<vtkImageData> input;
    input->DeepCopy(chain.solver->GetOutput());
    vtkNew<vtkFluxMap> map;
    map->SetInputData(input);
    test.spoil(map.Get(), input.Get());
    const std::string error = errorOf(map);
    EXPECT_NE(error.find(test.words), std::string::npos) << test.what << ": " << error;
    EXPECT_EQ(map->GetOutput()->GetNumberOfPoints(), 0) << test.what;
  }
}

} // namespace
