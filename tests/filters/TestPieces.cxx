// Distributed images: whatever pieces the ranks hold, the answer is that of one rank. Also runs on one rank, where the
// pieces are those of a single process.
#include "OnRanks.h"
#include "VtkTesting.h"

#include "BoxExchange.h"
#include "core/Error.h"
#include "vtkPieces.h"

#include "vtkCellData.h"
#include "vtkExtentTranslator.h"
#include "vtkFloatArray.h"
#include "vtkFluxMap.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkMPIController.h"
#include "vtkMicrostructureSource.h"
#include "vtkMultiProcessController.h"
#include "vtkPolyData.h"
#include "vtkSteadyDiffusion.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTrivialProducer.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace
{

using namespace lamella;

class Pieces : public vtktest::OnRanks
{
};

Block heldBy(const Lattice& lattice, int piece, int pieces, int split, int ghosts)
{
  vtkNew<vtkExtentTranslator> translator;
  translator->SetWholeExtent(0, static_cast<int>(lattice.size[0]) - 1, 0, static_cast<int>(lattice.size[1]) - 1, 0,
    static_cast<int>(lattice.size[2]) - 1);
  translator->SetNumberOfPieces(pieces);
  translator->SetPiece(piece);
  if (split == vtkExtentTranslator::X_SLAB_MODE)
    translator->SetSplitModeToXSlab();
  else if (split == vtkExtentTranslator::Z_SLAB_MODE)
    translator->SetSplitModeToZSlab();
  translator->SetGhostLevel(ghosts);
  translator->PieceToExtent();
  return blockOf(translator->GetExtent(), translator->GetWholeExtent());
}

std::vector<std::int64_t> numbered(const Lattice& lattice, const Block& box)
{
  std::vector<std::int64_t> values;
  for (std::int64_t z = 0; z < box.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < box.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < box.size[0]; ++x)
      {
        const auto wrap = [&](std::int64_t i, std::size_t axis)
        { return (i + box.start[axis] + lattice.size[axis]) % lattice.size[axis]; };
        values.push_back(lattice.index(wrap(x, 0), wrap(y, 1), wrap(z, 2)));
      }
    }
  }
  return values;
}

TEST_F(Pieces, ValuesReachTheBoxesThatNeedThem)
{
  const Lattice lattice = makeLattice(11, 9, 7, 3, 1);
  for (const int split :
    { vtkExtentTranslator::X_SLAB_MODE, vtkExtentTranslator::Z_SLAB_MODE, vtkExtentTranslator::BLOCK_MODE })
  {
    for (const int ghosts : { 0, 1 })
    {
      const Block held = heldBy(lattice, rank(), ranks(), split, ghosts);
      Block needed = decompose(lattice, MPI_COMM_WORLD);
      for (std::size_t axis = 0; axis < 3; ++axis) // with a layer that wraps round
      {
        --needed.start[axis];
        needed.size[axis] += 2;
      }
      const BoxExchange exchange(lattice, held, needed, { true, true, true }, MPI_COMM_WORLD, ranks());
      const auto values = numbered(lattice, held);
      std::vector<std::int64_t> found(static_cast<std::size_t>(needed.count()), -1);
      exchange.run<std::int64_t>(values, found);
      EXPECT_EQ(found, numbered(lattice, needed));
    }
  }
}

TEST_F(Pieces, NodesThatNobodyHoldsAreAnError)
{
  const Lattice lattice = makeLattice(8, 9, 1, 2, 1);
  Block held = decompose(lattice, MPI_COMM_WORLD);
  --held.size[0];
  EXPECT_THROW(
    BoxExchange(lattice, held, decompose(lattice, MPI_COMM_WORLD), { false, false, false }, MPI_COMM_WORLD, ranks()),
    InputError);
}

/// Numbers of a chain source → diffusion → flux map.
struct Chain
{
  vtkNew<vtkMicrostructureSource> source;
  vtkNew<vtkSteadyDiffusion> solver;
  vtkNew<vtkFluxMap> map;

  explicit Chain(bool volume, int sides, int lattice)
  {
    const std::array<int, 3> size = volume ? std::array<int, 3>{ 24, 20, 18 } : std::array<int, 3>{ 80, 70, 1 };
    source->SetSize(size.data());
    solver->SetInputConnection(source->GetOutputPort());
    solver->SetConductivity("wall", 1);
    solver->SetConductivity("lumen", 0.023);
    solver->SetDirection(vtkSteadyDiffusion::ALL);
    solver->SetSides(sides);
    solver->SetLattice(lattice);
    solver->SetTolerance(1e-10);
    map->SetInputConnection(solver->GetOutputPort());
    map->SetDirection(vtkFluxMap::Y);
    map->SetNumberOfStreamlines(40);
  }
};

void expectNear(const std::vector<double>& found, const std::vector<double>& expected, const char* what)
{
  ASSERT_EQ(found.size(), expected.size()) << what;
  double scale = 0;
  for (const double value : expected)
    scale = std::max(scale, std::isnan(value) ? 0.0 : std::abs(value));
  for (std::size_t i = 0; i < found.size(); ++i)
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(found[i])) << what << " " << i;
    else
      EXPECT_NEAR(found[i], expected[i], 1e-9 * scale) << what << " " << i; // ten times the solver's tolerance
}

struct Setting
{
  bool volume;
  int sides;
  int lattice;
};
class SameAsOneRank
  : public Pieces
  , public ::testing::WithParamInterface<Setting>
{
};

TEST_P(SameAsOneRank, NumbersFieldsAndLines)
{
  const auto [volume, sides, lattice] = GetParam();
  Chain together(volume, sides, lattice);
  together.map->UpdatePiece(rank(), ranks(), 0);
  Chain alone(volume, sides, lattice); // one piece of one: every rank for itself
  alone.map->UpdatePiece(0, 1, 0);
  vtkImageData* const part = together.map->GetOutput();
  vtkImageData* const whole = alone.map->GetOutput();

  for (const char* const name : { "effective_conductivity", "effective_from_flux", "mean_flux", "tortuosity",
         "tortuosity_factor", "streamline_tortuosity", "line_flux", "phase_fraction", "bounds" })
    expectNear(fieldNumbers(part, name), fieldNumbers(whole, name), name);

  // Fields: every node of the piece, the shared layers included.
  if (ranks() > 1)
    ASSERT_LT(part->GetNumberOfPoints(), whole->GetNumberOfPoints());
  int extent[6];
  part->GetExtent(extent);
  for (const char* const name : { "temperature_x", "temperature_y", "flux_y", "flux_magnitude" })
  {
    vtkDataArray* const found = vtktest::points(part, name);
    vtkDataArray* const expected = vtktest::points(whole, name);
    const double scale = expected->GetRange(-1)[1];
    double worst = 0;
    for (int z = extent[4]; z <= extent[5]; ++z)
    {
      for (int y = extent[2]; y <= extent[3]; ++y)
      {
        for (int x = extent[0]; x <= extent[1]; ++x)
        {
          int at[3] = { x, y, z };
          for (int component = 0; component < found->GetNumberOfComponents(); ++component)
          {
            worst = std::max(worst,
              std::abs(found->GetComponent(part->ComputePointId(at), component) -
                expected->GetComponent(whole->ComputePointId(at), component)));
          }
        }
      }
    }
    EXPECT_LT(worst / scale, 1e-8) << name; // the field's error is the root of the flux balance's at worst
  }

  // Lines: the same numbers, each as long as on one rank.
  const auto lengths = [](vtkPolyData* lines)
  {
    std::map<vtkIdType, double> result;
    for (vtkIdType i = 0; i < lines->GetNumberOfLines(); ++i)
      result[static_cast<vtkIdType>(lines->GetCellData()->GetArray("line")->GetTuple1(i))] =
        lines->GetCellData()->GetArray("length")->GetTuple1(i);
    return result;
  };
  const auto expected = lengths(alone.map->GetStreamlines());
  EXPECT_EQ(expected.size(), 40U);
  for (const auto& [line, length] : lengths(together.map->GetStreamlines()))
    EXPECT_NEAR(length, expected.at(line), 1e-6 * length) << line;
  std::int64_t steps =
    together.map->GetStreamlines()->GetNumberOfPoints() - together.map->GetStreamlines()->GetNumberOfLines();
  MPI_Allreduce(MPI_IN_PLACE, &steps, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(steps, alone.map->GetStreamlines()->GetNumberOfPoints() - alone.map->GetStreamlines()->GetNumberOfLines());
}

INSTANTIATE_TEST_SUITE_P(All, SameAsOneRank,
  ::testing::Values(Setting{ false, vtkSteadyDiffusion::INSULATED, vtkSteadyDiffusion::D2Q5 },
    Setting{ false, vtkSteadyDiffusion::PERIODIC, vtkSteadyDiffusion::D2Q9 },
    Setting{ true, vtkSteadyDiffusion::INSULATED, vtkSteadyDiffusion::D3Q19 },
    Setting{ true, vtkSteadyDiffusion::PERIODIC, vtkSteadyDiffusion::D3Q7 }),
  [](const auto& setting)
  {
    return std::string(setting.param.volume ? "volume_" : "picture_") +
      (setting.param.sides == vtkSteadyDiffusion::PERIODIC ? "periodic_" : "insulated_") +
      vtktest::latticeName(setting.param.lattice);
  });

/// A pipeline in which only rank 0 holds anything.
TEST_F(Pieces, RanksWithoutAPieceWorkAlong)
{
  const auto whole = vtktest::picture(30, 24, 1, [](int x, int, int) { return x / 3 % 2; });
  vtkNew<vtkImageData> mine;
  if (rank() == 0)
    mine->ShallowCopy(whole);
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(mine);
  producer->SetWholeExtent(0, 29, 0, 23, 0, 0);
  vtkNew<vtkSteadyDiffusion> solver;
  solver->SetInputConnection(producer->GetOutputPort());
  solver->SetConductivity("a", 1);
  solver->SetConductivity("b", 10);
  vtkNew<vtkFluxMap> map;
  map->SetInputConnection(solver->GetOutputPort());
  map->UpdatePiece(rank(), ranks(), 0);
  EXPECT_NEAR(solver->GetEffectiveConductivity()[0], 2 / 1.1, 1e-7);
  EXPECT_NEAR(fieldNumbers(map->GetOutput(), "effective_from_flux").at(0), 2 / 1.1, 1e-7);
  EXPECT_EQ(map->GetOutput()->GetNumberOfPoints(), rank() == 0 ? 720 : 0);
}

TEST_F(Pieces, DirectionsAlongWallsReachEveryRank)
{
  const auto whole = vtktest::picture(30, 24, 1, [](int x, int y, int) { return (x + y / 2) / 3 % 2; });
  vtkNew<vtkFloatArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(2);
  for (int node = 0; node < 720; ++node)
    axis->InsertNextTuple2(std::cos(0.02 * node), std::sin(0.02 * node));
  whole->GetPointData()->AddArray(axis);
  vtkNew<vtkImageData> mine; // rows, the seams shared
  mine->ShallowCopy(whole);
  const int rows[6] = { 0, 29, 23 * rank() / ranks(), 23 * (rank() + 1) / ranks(), 0, 0 };
  mine->Crop(rows);
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(mine);
  producer->SetWholeExtent(0, 29, 0, 23, 0, 0);
  for (const int lattice : { vtkSteadyDiffusion::D2Q9, vtkSteadyDiffusion::Q1 })
  {
    const auto set = [lattice](vtkSteadyDiffusion* solver)
    {
      solver->SetConductivity("a", 0.1);
      solver->SetConductivity("b", 3);
      solver->SetConductivityAcross("b", 1);
      solver->SetLattice(lattice);
      solver->SetDirection(vtkSteadyDiffusion::ALL);
      solver->SetTolerance(1e-10);
    };
    vtkNew<vtkSteadyDiffusion> together;
    together->SetInputConnection(producer->GetOutputPort());
    set(together);
    vtkNew<vtkFluxMap> map; // has the nodes' fluxes to go by
    map->SetInputConnection(together->GetOutputPort());
    map->UpdatePiece(rank(), ranks(), 0);
    vtkNew<vtkSteadyDiffusion> alone;
    alone->SetInputData(whole);
    set(alone);
    alone->Update();
    for (const int i : { 0, 4 })
      EXPECT_NEAR(together->GetEffectiveConductivity()[i], alone->GetEffectiveConductivity()[i], 1e-9);
    EXPECT_NEAR(
      fieldNumbers(map->GetOutput(), "effective_from_flux").at(0), alone->GetEffectiveConductivity()[0], 1e-6);
  }
}

TEST_F(Pieces, AnErrorOnOneRankIsAnErrorOnAll)
{
  // The last rank holds another type of array, with a value that is no phase.
  const int last = ranks() - 1;
  const auto whole = vtktest::picture(30, 24, 1, [](int x, int, int) { return x / 3 % 2; });
  if (rank() == last)
  {
    vtkNew<vtkDoubleArray> wrong;
    wrong->SetName("phase");
    wrong->SetNumberOfTuples(720);
    wrong->Fill(0.25);
    whole->GetPointData()->AddArray(wrong);
  }
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(whole);
  vtkNew<vtkSteadyDiffusion> solver;
  solver->SetInputConnection(producer->GetOutputPort());
  solver->SetConductivity("a", 1);
  solver->SetConductivity("b", 10);
  solver->UpdateInformation();
  solver->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), ranks());
  solver->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), rank());
  const std::string error = vtktest::errorOf(solver);
  EXPECT_NE(error.find("holds 0.25"), std::string::npos) << "rank " << rank() << ": " << error;
}

} // namespace
