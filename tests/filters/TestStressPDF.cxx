// Stresses through VTK's pipeline: tables, phases, points and cells, what is refused; on distributed data, the numbers
// of one rank.
#include "OnRanks.h"
#include "VtkTesting.h"

#include "vtkCellData.h"
#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkMPIController.h"
#include "vtkMultiProcessController.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStressPDF.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkTrivialProducer.h"
#include "vtkUnsignedCharArray.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <random>

namespace
{

using namespace lamella;
using vtktest::cell;
using vtktest::errorOf;
using vtktest::picture;
using vtktest::points;

class StressPDF : public vtktest::OnRanks
{
};

std::string word(vtkTable* table, vtkIdType row)
{
  auto* const array = vtkStringArray::SafeDownCast(table->GetColumnByName("phase"));
  return array != nullptr ? array->GetValue(row) : std::string();
}

double number(vtkDataObject* data, const char* name)
{
  return fieldNumbers(data, name).at(0);
}

/// Six components; component c of tuple i is rule(i, c).
vtkSmartPointer<vtkDoubleArray> tensors(vtkIdType count, const std::function<double(vtkIdType, int)>& rule)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName("stress");
  array->SetNumberOfComponents(6);
  array->SetNumberOfTuples(count);
  for (vtkIdType i = 0; i < count; ++i)
    for (int c = 0; c < 6; ++c)
      array->SetComponent(i, c, rule(i, c));
  return array;
}

/// A picture of the phases void, matrix and grain in vertical stripes of 4; yy is exponential, more compressed in the
/// matrix, xx is −yy, and voids hold NaN, which must not matter.
vtkSmartPointer<vtkImageData> loaded(int nx, int ny, int nz = 1)
{
  auto image = picture(nx, ny, nz, [](int x, int, int) { return x / 4 % 3; });
  setPhaseNames(image, PhaseTable({ "void", "matrix", "grain" }));
  std::mt19937_64 engine(5);
  std::exponential_distribution<double> law(1 / 2e5);
  std::vector<double> yy(static_cast<std::size_t>(image->GetNumberOfPoints()));
  for (std::size_t i = 0; i < yy.size(); ++i)
  {
    const double phase = points(image, "phase")->GetTuple1(static_cast<vtkIdType>(i));
    yy[i] = phase == 0 ? std::nan("") : law(engine) - (phase == 1 ? 5e4 : 0);
  }
  image->GetPointData()->AddArray(tensors(image->GetNumberOfPoints(),
    [&](vtkIdType i, int c)
    {
      const double value = yy[static_cast<std::size_t>(i)];
      return c == 0 ? -value : c == 1 ? value : c == 3 ? 1.0 : 0.0;
    }));
  return image;
}

TEST_F(StressPDF, TablesAndNumbers)
{
  const auto image = loaded(240, 200);
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  filter->SetReferenceStress(1e5);
  filter->SetThreshold(1);
  ASSERT_EQ(errorOf(filter), "");
  vtkTable* const density = filter->GetOutput();
  const vtkIdType solid = 240 * 200 * 2 / 3;
  EXPECT_EQ(number(density, "stress_count"), static_cast<double>(solid)); // no void
  double sum = 0;
  vtkIdType count = 0;
  for (vtkIdType bin = 0; bin < density->GetNumberOfRows(); ++bin)
  {
    sum += 0.05 * cell(density, bin, "density");
    count += static_cast<vtkIdType>(cell(density, bin, "count"));
    EXPECT_EQ(cell(density, bin, "count"), cell(density, bin, "count_matrix") + cell(density, bin, "count_grain"));
    EXPECT_NEAR(
      cell(density, bin, "stress"), (cell(density, bin, "stress_low") + cell(density, bin, "stress_high")) / 2, 1e-12);
    const double x = cell(density, bin, "stress");
    EXPECT_EQ(std::isnan(cell(density, bin, "tail")), x < 1);
    // 20 000 values a unit: where 200 are in a bin the law is met within 5 root-mean-squares of counting.
    if (x > 1 && cell(density, bin, "count") > 200)
      EXPECT_NEAR(cell(density, bin, "tail") / cell(density, bin, "density"), 1, 5 / std::sqrt(200.0)) << x;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(count, solid);
  EXPECT_LT(cell(density, 0, "stress_low"), 0);
  // Both phases have the law e^{−σ/2·10⁵}: θ is the mean tensile stress over it.
  const double theta = number(density, "stress_theta");
  EXPECT_NEAR(theta, number(density, "stress_mean_tensile") / 2e5, 3 * number(density, "stress_theta_error"));
  EXPECT_EQ(number(density, "stress_tail_threshold"), 1);
  vtkTable* const phases = filter->GetPhaseTable();
  ASSERT_EQ(phases->GetNumberOfRows(), 3);
  EXPECT_EQ(word(phases, 0), "all");
  EXPECT_EQ(word(phases, 1), "matrix");
  EXPECT_EQ(word(phases, 2), "grain");
  EXPECT_EQ(cell(phases, 2, "compressive_share"), 0);
  EXPECT_EQ(cell(phases, 2, "mean_compressive"), 0);
  // Of e^{−x}, shifted by a quarter, 1 − e^{−1/4} is below 0; the rest has the old mean, 2·10⁵, within 1.5 % of 16 000.
  EXPECT_NEAR(cell(phases, 1, "compressive_share"), 1 - std::exp(-0.25), 0.01);
  EXPECT_NEAR(cell(phases, 1, "mean_tensile"), 2e5, 5e3);
  EXPECT_NEAR(cell(phases, 2, "mean_tensile"), 2e5, 5e3);
  EXPECT_DOUBLE_EQ(cell(phases, 0, "mean_tensile_over_reference"), cell(phases, 0, "mean_tensile") / 1e5);
  EXPECT_GT(filter->GetThresholdTable()->GetNumberOfRows(), 8);
  EXPECT_EQ(fieldText(phases, "stress_component"), "yy");
  EXPECT_NE(provenance(density).find("stress_pdf"), std::string::npos);
}

TEST_F(StressPDF, ComponentsPhasesAndPlatens)
{
  const auto image = loaded(60, 50);
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  ASSERT_EQ(errorOf(filter), "");
  const double tensile = number(filter->GetOutput(), "stress_mean_tensile");
  const double compressive = number(filter->GetOutput(), "stress_mean_compressive");
  filter->SetComponent(vtkStressPDF::XX);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_DOUBLE_EQ(number(filter->GetOutput(), "stress_mean_tensile"), -compressive);
  EXPECT_DOUBLE_EQ(number(filter->GetOutput(), "stress_mean_compressive"), -tensile);
  filter->SetComponent(vtkStressPDF::PRINCIPAL_1);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_compressive_share"), 0); // |yy| and more
  filter->SetComponent(vtkStressPDF::YY);
  filter->AddPhase("grain");
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 1000);
  ASSERT_EQ(filter->GetPhaseTable()->GetNumberOfRows(), 2);
  EXPECT_EQ(word(filter->GetPhaseTable(), 1), "grain");
  filter->ClearPhases();
  // The two lowest rows and the highest are held.
  setFieldText(image, "load_axis", "y");
  const std::array<double, 4> layers{ 0, 1, 49, 49 };
  setFieldNumbers(image, "platen_layers", layers);
  image->Modified();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 47 * 40);
  filter->LeaveOutPlatensOff();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 50 * 40);
}

TEST_F(StressPDF, LeavesOutAllThatHoldsNothing)
{
  const auto image = picture(
    30, 12, 1, [](int x, int, int) { return x / 10; });
  image->GetPointData()->AddArray(
    tensors(image->GetNumberOfPoints(), [](vtkIdType i, int) { return i % 30 < 20 ? 0 : 1e5; }));
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  setPhaseNames(image, PhaseTable({ "void", "Lumen", "wall" })); // as the solvers have it
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 120);
  EXPECT_NEAR(number(filter->GetOutput(), "stress_mean_tensile"), 1e5, 1e-6);
  setPhaseNames(image, PhaseTable({ "void", "lumen", "0" })); // or all of it
  image->Modified();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 360);
}

TEST_F(StressPDF, NineComponentsOneComponentCellsAndNoPhases)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(3, 2, 1); // 2 cells
  image->SetSpacing(1, 2, 3);    // no lattice, no matter
  vtkNew<vtkDoubleArray> full;
  full->SetName("sigma");
  full->SetNumberOfComponents(9);
  const std::array<double, 9> first{ 1, 2, 3, 4, 5, 6, 7, 8, 9 };
  const std::array<double, 9> second{ 1, 2, 3, 4, 15, 6, 7, 8, 9 };
  full->InsertNextTuple(first.data());
  full->InsertNextTuple(second.data());
  image->GetCellData()->AddArray(full);
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS, "sigma");
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_mean_tensile"), 10);
  EXPECT_EQ(filter->GetPhaseTable()->GetNumberOfRows(), 1);
  EXPECT_EQ(filter->GetOutput()->GetColumnByName("density_"), nullptr);
  filter->SetComponent(vtkStressPDF::XY);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_mean"), 3); // the symmetric part

  vtkNew<vtkPoints> places;
  vtkNew<vtkPolyData> particles;
  vtkNew<vtkFloatArray> scalar;
  scalar->SetName("force");
  for (int i = 0; i < 4; ++i)
  {
    places->InsertNextPoint(i, 0, 0);
    scalar->InsertNextValue(static_cast<float>(i) - 1);
  }
  particles->SetPoints(places);
  particles->GetPointData()->AddArray(scalar);
  filter->SetInputData(particles);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "force");
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "stress_mean_tensile"), 1.5);
  EXPECT_EQ(number(filter->GetOutput(), "stress_mean_compressive"), -1);
  EXPECT_EQ(fieldText(filter->GetOutput(), "stress_component"), "as it is");
}

TEST_F(StressPDF, ThreadsChangeNothing)
{
  const auto image = loaded(300, 200);
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  ASSERT_EQ(errorOf(filter), "");
  vtkNew<vtkTable> alone;
  alone->DeepCopy(filter->GetOutput());
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ 4, "STDThread", false },
    [&]
    {
      filter->Modified();
      EXPECT_EQ(errorOf(filter), "");
    });
  ASSERT_EQ(filter->GetOutput()->GetNumberOfRows(), alone->GetNumberOfRows());
  for (vtkIdType bin = 0; bin < alone->GetNumberOfRows(); ++bin)
    EXPECT_EQ(cell(filter->GetOutput(), bin, "count"), cell(alone, bin, "count"));
  EXPECT_NEAR(number(filter->GetOutput(), "stress_theta"), number(alone, "stress_theta"), 1e-12);
}

TEST_F(StressPDF, WhatCannotBeDoneIsRefusedInWords)
{
  struct Case
  {
    std::function<void(vtkStressPDF*, vtkImageData*)> spoil;
    const char* words;
    const char* hint;
  };
  const auto choose = [](int index, const char* name)
  {
    return [=](vtkStressPDF* f, vtkImageData*)
    { f->SetInputArrayToProcess(index, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name); };
  };
  const std::vector<Case> cases{
    { choose(0, "sigma"), "the data has no array 'sigma'", "there are: phase, stress" },
    { choose(0, ""), "no array of stresses is chosen", "choose one" },
    { [](auto*, auto* i) { i->GetPointData()->Initialize(); }, "no array 'stress'", "no arrays at all" },
    { [](auto* f, auto*) { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "stress"); },
      "'stress' is point data, not cell data", "array of points" },
    { choose(1, "grain"), "no point array 'grain'", "choose the array of phases" },
    { [](auto*, auto* i)
      {
        vtkNew<vtkDoubleArray> vectors;
        vectors->SetName("stress");
        vectors->SetNumberOfComponents(3);
        vectors->SetNumberOfTuples(i->GetNumberOfPoints());
        vectors->Fill(1);
        i->GetPointData()->AddArray(vectors);
      },
      "'stress' has 3 components", "a stress has 6" },
    { [](auto*, auto* i) { points(i, "stress")->SetComponent(5, 3, INFINITY); }, "1 stresses are not finite",
      "compute the field again" },
    { [](auto*, auto* i) { points(i, "stress")->Fill(-1); }, "none of 32 stresses is above 0", "another component" },
    { [](auto*, auto* i) { points(i, "stress")->Fill(0); }, "none of 32 stresses is above 0", "is loaded" },
    { [](auto* f, auto*) { f->AddPhase("stone"); }, "'stone' is no phase of this data", "void, matrix, grain" },
    { [](auto* f, auto*) { f->SetThreshold(1e3); }, "no stress is beyond the threshold of 1000", "a lower threshold" },
    { [](auto* f, auto*) { f->SetThreshold(-2); }, "threshold -2 is below 0", "0 or more" },
    { [](auto* f, auto*) { f->SetTailShare(0); }, "tail share 0 is not above 0", "up to 1" },
    { [](auto* f, auto*) { f->SetBinWidth(-1); }, "bin width -1 is not above 0", "a number above 0" },
    { [](auto* f, auto*) { f->SetRange(2, 1); }, "is empty", "lower end first" },
    { [](auto*, auto* i) { i->Initialize(); }, "the data has no points", "source before it" },
  };
  for (const Case& test : cases)
  {
    const auto image = loaded(12, 4);
    vtkNew<vtkStressPDF> filter;
    filter->SetInputData(image);
    test.spoil(filter.Get(), image.Get());
    const std::string error = errorOf(filter);
    EXPECT_NE(error.find(test.words), std::string::npos) << test.words << ": " << error;
    EXPECT_NE(error.find(test.hint), std::string::npos) << test.words << ": " << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfRows(), 0) << test.words;
    EXPECT_EQ(filter->GetPhaseTable()->GetNumberOfRows(), 0) << test.words;
  }
}

TEST_F(StressPDF, AbortLeavesNothing)
{
  const auto image = loaded(30, 20);
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(image);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfRows(), 0);
}

void expectSame(vtkTable* found, vtkTable* expected)
{
  ASSERT_EQ(found->GetNumberOfRows(), expected->GetNumberOfRows());
  for (vtkIdType column = 0; column < expected->GetNumberOfColumns(); ++column)
  {
    auto* const numbers = vtkDataArray::SafeDownCast(expected->GetColumn(column));
    const char* const name = expected->GetColumnName(column);
    for (vtkIdType row = 0; numbers != nullptr && row < expected->GetNumberOfRows(); ++row)
    {
      const double a = cell(found, row, name);
      const double b = numbers->GetTuple1(row);
      ASSERT_TRUE((std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= 1e-11 * std::abs(b))
        << name << " " << a << " " << b;
    }
  }
}

// Pieces with the shared layers of points that VTK makes, and with a ghost layer: every node counts once.
TEST_F(StressPDF, PiecesOfAnImageGiveTheNumbersOfTheWhole)
{
  for (const auto& [nx, ny, nz] : { std::array<int, 3>{ 60, 41, 1 }, { 24, 18, 12 } })
  {
    const auto image = loaded(nx, ny, nz);
    setFieldText(image, "load_axis", "y");
    const std::array<double, 4> layers{ 0, 1, ny - 2.0, ny - 1.0 };
    setFieldNumbers(image, "platen_layers", layers);
    vtkNew<vtkStressPDF> alone;
    alone->SetInputData(image);
    alone->UpdatePiece(0, 1, 0);
    ASSERT_EQ(number(alone->GetOutput(), "stress_count"), 2.0 / 3 * nx * (ny - 4) * nz);
    for (const int ghosts : { 0, 1 })
    {
      vtkNew<vtkExtentTranslator> translator;
      translator->SetWholeExtent(image->GetExtent());
      translator->SetNumberOfPieces(ranks());
      translator->SetPiece(rank());
      translator->SetSplitModeToBlock();
      translator->SetGhostLevel(ghosts);
      translator->PieceToExtent();
      vtkNew<vtkImageData> piece;
      piece->DeepCopy(image);
      piece->Crop(translator->GetExtent());
      vtkNew<vtkTrivialProducer> producer;
      producer->SetOutput(piece);
      producer->SetWholeExtent(image->GetExtent());
      vtkNew<vtkStressPDF> together;
      together->SetInputConnection(producer->GetOutputPort());
      together->UpdatePiece(rank(), ranks(), 0);
      for (const char* const name : { "stress_count", "stress_mean_tensile", "stress_mean_compressive", "stress_theta",
             "stress_theta_error", "stress_tail_threshold", "stress_tail_distance" })
      {
        const double expected = number(alone->GetOutput(), name);
        EXPECT_NEAR(number(together->GetOutput(), name), expected, 1e-11 * std::abs(expected)) << name;
      }
      if (rank() == 0)
      {
        expectSame(together->GetOutput(), alone->GetOutput());
        expectSame(together->GetPhaseTable(), alone->GetPhaseTable());
        expectSame(together->GetThresholdTable(), alone->GetThresholdTable());
      }
      else
      {
        EXPECT_EQ(together->GetOutput()->GetNumberOfRows(), 0);
      }
    }
  }
}

// Particles: the last rank has none; a ghost point and a hidden one do not count.
TEST_F(StressPDF, GhostAndHiddenPointsAndEmptyPieces)
{
  vtkNew<vtkPolyData> particles;
  const bool holds = rank() < ranks() - 1 || ranks() == 1;
  if (holds)
  {
    vtkNew<vtkPoints> places;
    vtkNew<vtkDoubleArray> stress;
    stress->SetName("stress");
    vtkNew<vtkUnsignedCharArray> ghost;
    ghost->SetName(vtkDataSetAttributes::GhostArrayName());
    for (int i = 0; i < 10; ++i)
    {
      places->InsertNextPoint(i, rank(), 0);
      stress->InsertNextValue(i);
      ghost->InsertNextValue(i == 9 ? static_cast<unsigned char>(vtkDataSetAttributes::DUPLICATEPOINT)
          : i == 8                  ? static_cast<unsigned char>(vtkDataSetAttributes::HIDDENPOINT)
                                    : static_cast<unsigned char>(0));
    }
    particles->SetPoints(places);
    particles->GetPointData()->AddArray(stress);
    particles->GetPointData()->AddArray(ghost);
  }
  vtkNew<vtkStressPDF> filter;
  filter->SetInputData(particles);
  filter->UpdateInformation();
  filter->UpdatePiece(rank(), ranks(), 0);
  const int pieces = std::max(1, ranks() - 1);
  EXPECT_EQ(number(filter->GetOutput(), "stress_count"), 8 * pieces);
  EXPECT_EQ(number(filter->GetOutput(), "stress_mean_tensile"), 4); // 1 … 7
}

TEST_F(StressPDF, AnErrorIsOneOnEveryRank)
{
  const auto image = loaded(24, 20);
  points(image, "stress")->SetComponent(5, 1, std::nan("")); // a node of the matrix, on one rank only
  vtkNew<vtkTrivialProducer> producer;
  vtkNew<vtkExtentTranslator> translator;
  translator->SetWholeExtent(image->GetExtent());
  translator->SetNumberOfPieces(ranks());
  translator->SetPiece(rank());
  translator->PieceToExtent();
  vtkNew<vtkImageData> piece;
  piece->DeepCopy(image);
  piece->Crop(translator->GetExtent());
  producer->SetOutput(piece);
  producer->SetWholeExtent(image->GetExtent());
  vtkNew<vtkStressPDF> filter;
  filter->SetInputConnection(producer->GetOutputPort());
  filter->UpdateInformation();
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), ranks());
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), rank());
  EXPECT_NE(errorOf(filter).find("1 stresses are not finite"), std::string::npos);
}

} // namespace
