// Pores through VTK's pipeline: arrays, tables, field data, what is refused; on distributed images, the labels of one
// rank to the last byte.
#include "OnRanks.h"
#include "VtkTesting.h"

#include "pores/PoreLabelling.h"

#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkMPIController.h"
#include "vtkMultiProcessController.h"
#include "vtkPoreFloodFill.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
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

class PoreFloodFill : public vtktest::OnRanks
{
};

/// 'a' is void in two pores: 2 × 3 nodes in the corner, 1 node in the middle.
int twoPores(int x, int y, int)
{
  return (x < 2 && y < 3) || (x == 5 && y == 4) ? 0 : 1;
}

TEST_F(PoreFloodFill, LabelsSizesTableAndNumbers)
{
  const auto image = picture(8, 6, 1, twoPores, 2e-6);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputData(image);
  filter->SetPhase("a");
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* const output = filter->GetOutput();
  EXPECT_EQ(points(output, "phase"), points(image, "phase")); // passed on, not copied
  vtkDataArray* const pore = points(output, "pore");
  vtkDataArray* const size = points(output, "pore_size");
  EXPECT_EQ(pore->GetDataType(), VTK_INT);
  for (vtkIdType node = 0; node < 48; ++node)
  {
    const vtkIdType x = node % 8;
    const vtkIdType y = node / 8;
    const int expected = x < 2 && y < 3 ? 1 : x == 5 && y == 4 ? 2 : 0;
    EXPECT_EQ(pore->GetTuple1(node), expected) << node;
    if (expected == 0)
      EXPECT_TRUE(std::isnan(size->GetTuple1(node)));
    else
      EXPECT_EQ(size->GetTuple1(node), expected == 1 ? 6 : 1);
  }
  vtkTable* const table = filter->GetPores();
  ASSERT_EQ(table->GetNumberOfRows(), 2);
  EXPECT_EQ(cell(table, 0, "pore"), 1);
  EXPECT_EQ(cell(table, 0, "size"), 6);
  EXPECT_DOUBLE_EQ(cell(table, 0, "area"), 6 * 4e-12);
  EXPECT_DOUBLE_EQ(cell(table, 0, "equivalent_diameter"), 2 * std::sqrt(6 * 4e-12 / M_PI));
  EXPECT_DOUBLE_EQ(cell(table, 0, "centre_x"), 2e-6); // edge to edge: pixels 0 and 1 of 2 µm
  EXPECT_DOUBLE_EQ(cell(table, 0, "centre_y"), 3e-6);
  EXPECT_DOUBLE_EQ(cell(table, 1, "centre_x"), 11e-6);
  EXPECT_EQ(cell(table, 0, "x_last"), 1);
  EXPECT_EQ(cell(table, 0, "y_last"), 2);
  EXPECT_EQ(cell(table, 1, "x_first"), 5);
  EXPECT_EQ(cell(table, 0, "touches_x_min"), 1);
  EXPECT_EQ(cell(table, 0, "touches_y_min"), 1);
  EXPECT_EQ(cell(table, 0, "touches_y_max"), 0);
  EXPECT_EQ(cell(table, 1, "touches_x_min"), 0);
  EXPECT_EQ(cell(table, 0, "percolates_x"), 0);
  EXPECT_EQ(fieldNumbers(output, "pore_count").at(0), 2);
  EXPECT_EQ(fieldNumbers(output, "pore_total").at(0), 7);
  EXPECT_EQ(fieldNumbers(output, "pore_mean").at(0), 3.5);
  EXPECT_EQ(fieldNumbers(output, "pore_largest").at(0), 6);
  EXPECT_DOUBLE_EQ(fieldNumbers(output, "porosity").at(0), 7.0 / 48);
  EXPECT_DOUBLE_EQ(fieldNumbers(output, "pore_open").at(0), 6.0 / 7);
  EXPECT_EQ(fieldText(output, "pore_phase"), "a");
  EXPECT_EQ(fieldNumbers(table, "pore_count").at(0), 2);
  EXPECT_NE(provenance(output).find("pore_flood_fill"), std::string::npos);
  vtkTable* const classes = filter->GetSizeDistribution();
  ASSERT_EQ(classes->GetNumberOfRows(), 3); // 1, 2 to 3, 4 to 7
  EXPECT_EQ(cell(classes, 2, "size_to"), 7);
  EXPECT_EQ(cell(classes, 0, "pores"), 1);
  EXPECT_EQ(cell(classes, 1, "pores"), 0);
  EXPECT_DOUBLE_EQ(cell(classes, 2, "share_of_nodes"), 6.0 / 7);
  EXPECT_DOUBLE_EQ(cell(classes, 2, "cumulative_share_of_pores"), 1);
}

TEST_F(PoreFloodFill, CentresLieWhereTheImageDoes)
{
  const auto image = picture(8, 6, 1, twoPores, 2e-6);
  image->SetExtent(10, 17, 20, 25, 0, 0);
  image->SetOrigin(5e-6, 3e-6, 0);
  image->SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputData(image);
  filter->SetPhase("a");
  ASSERT_EQ(errorOf(filter), "");
  std::array<double, 3> there{};
  image->TransformContinuousIndexToPhysicalPoint(std::array<double, 3>{ 15, 24, 0 }.data(), there.data());
  EXPECT_NEAR(cell(filter->GetPores(), 1, "centre_x"), there[0], 1e-18); // 1e-18 m: round-off of places of 1e-5 m
  EXPECT_NEAR(cell(filter->GetPores(), 1, "centre_y"), there[1], 1e-18);
}

TEST_F(PoreFloodFill, ProvenanceHasEachTimeThatAFilterRan)
{
  vtkNew<vtkPoreFloodFill> first;
  first->SetInputData(picture(8, 6, 1, twoPores));
  first->SetPhase("a");
  vtkNew<vtkPoreFloodFill> second;
  second->SetInputConnection(first->GetOutputPort());
  second->SetPhase("b");
  ASSERT_EQ(errorOf(second), "");
  const std::string text = provenance(second->GetOutput());
  EXPECT_NE(text.find("pore_flood_fill 2"), std::string::npos) << text;
}

TEST_F(PoreFloodFill, PhasesByNameByValueAndByWhatTheyAreCalled)
{
  const auto image = picture(8, 6, 1, twoPores);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputData(image);
  for (const auto& [phase, count] : std::vector<std::pair<std::string, int>>{ { "a", 2 }, { "b", 1 }, { "1", 1 } })
  {
    filter->SetPhase(phase);
    ASSERT_EQ(errorOf(filter), "");
    EXPECT_EQ(fieldNumbers(filter->GetOutput(), "pore_count").at(0), count) << phase;
  }
  setPhaseNames(image, PhaseTable({ "wall", "Lumen", "other" }));
  image->Modified();
  filter->SetPhase("");
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(fieldText(filter->GetOutput(), "pore_phase"), "Lumen");
}

TEST_F(PoreFloodFill, ThreadsAndSettings)
{
  const auto image = picture(40, 40, 1, vtktest::blobs);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputData(image);
  filter->SetPhase("a");
  ASSERT_EQ(errorOf(filter), "");
  vtkNew<vtkImageData> alone;
  alone->DeepCopy(filter->GetOutput());
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ 4, "STDThread", false },
    [&]
    {
      filter->Modified();
      EXPECT_EQ(errorOf(filter), "");
    });
  for (vtkIdType node = 0; node < 1600; ++node)
    ASSERT_EQ(points(filter->GetOutput(), "pore")->GetTuple1(node), points(alone, "pore")->GetTuple1(node));
  filter->ComputePoreSizeOff();
  filter->SetMinimumSize(3);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(points(filter->GetOutput(), "pore_size"), nullptr);
  EXPECT_GT(fieldNumbers(filter->GetOutput(), "pore_dropped").at(0), 0);
  EXPECT_LT(filter->GetPores()->GetNumberOfRows(), fieldNumbers(alone, "pore_count").at(0));
  const vtkIdType rows = filter->GetPores()->GetNumberOfRows();
  filter->ComputeLabelsOff(); // counted and measured all the same
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(points(filter->GetOutput(), "pore"), nullptr);
  EXPECT_EQ(filter->GetPores()->GetNumberOfRows(), rows);
}

TEST_F(PoreFloodFill, WhatCannotBeDoneIsRefusedInWords)
{
  struct Case
  {
    std::function<void(vtkPoreFloodFill*, vtkImageData*)> spoil;
    const char* words;
    const char* hint;
  };
  const std::vector<Case> cases{
    { [](auto* f, auto*) { f->SetPhase("c"); }, "no node of the image is 'c'", "choose another phase" },
    { [](auto* f, auto*) { f->SetPhase("d"); }, "'d' is no phase of this image", "its phases are 'a', 'b' and 'c'" },
    { [](auto* f, auto*) { f->SetPhase(""); }, "no phase is called void, pore, lumen or air", "there are: a, b, c" },
    { [](auto* f, auto*) { f->SetConnectivity(26); }, "connectivity 26 does not fit a picture", "4 (sides) or 8" },
    { [](auto* f, auto*) { f->SetMinimumSize(-1); }, "minimum size -1 is below 0", "0 or more" },
    { [](auto* f, auto*) { f->SetMaximumNumberOfLabels(1); }, "there are 2 pores; 1 can be told apart",
      "give a minimum size" },
    { [](auto* f, auto*) { f->SetPeriodic(0, 0, 1); }, "periodic along z", "leave z out" },
    { [](auto*, auto* i) { i->GetPointData()->Initialize(); }, "no point array 'phase'", "picture reader" },
  };
  for (const Case& test : cases)
  {
    const auto image = picture(8, 6, 1, twoPores);
    vtkNew<vtkPoreFloodFill> filter;
    filter->SetInputData(image);
    filter->SetPhase("a");
    test.spoil(filter.Get(), image.Get());
    const std::string error = errorOf(filter);
    EXPECT_NE(error.find(test.words), std::string::npos) << test.words << ": " << error;
    EXPECT_NE(error.find(test.hint), std::string::npos) << test.words << ": " << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0) << test.words;
    EXPECT_EQ(filter->GetPores()->GetNumberOfRows(), 0) << test.words;
  }
}

TEST_F(PoreFloodFill, AbortLeavesNothing)
{
  const auto image = picture(8, 6, 1, twoPores);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputData(image);
  filter->SetPhase("a");
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetPores()->GetNumberOfRows(), 0);
}

struct Setting
{
  std::array<int, 3> size;
  int connectivity;
  std::array<int, 3> periodic;
  double porosity;
  int minimumSize = 1;
};
class SameAsOneRank
  : public PoreFloodFill
  , public ::testing::WithParamInterface<Setting>
{
};

vtkSmartPointer<vtkImageData> noise(const Setting& setting)
{
  std::mt19937 engine(3);
  return picture(setting.size[0], setting.size[1], setting.size[2],
    [&](int, int, int) { return engine() / 4294967296.0 < setting.porosity ? 0 : 1; });
}

void configure(vtkPoreFloodFill* filter, const Setting& setting)
{
  filter->SetPhase("a");
  filter->SetConnectivity(setting.connectivity);
  filter->SetPeriodic(setting.periodic.data());
  filter->SetMinimumSize(setting.minimumSize);
}

// Pieces with the shared layers of points that VTK makes, and with a ghost layer: pieces of a split along x, along z
// and into blocks. The labels are those that one rank gives, node by node, and so is every number.
TEST_P(SameAsOneRank, LabelsAndNumbers)
{
  const Setting& setting = GetParam();
  const auto image = noise(setting);
  vtkNew<vtkPoreFloodFill> alone;
  alone->SetInputData(image);
  configure(alone, setting);
  alone->UpdatePiece(0, 1, 0);
  vtkImageData* const whole = alone->GetOutput();
  ASSERT_GT(alone->GetPores()->GetNumberOfRows(), 3);
  for (const int split :
    { vtkExtentTranslator::X_SLAB_MODE, vtkExtentTranslator::Z_SLAB_MODE, vtkExtentTranslator::BLOCK_MODE })
  {
    for (const int ghosts : { 0, 1 })
    {
      vtkNew<vtkExtentTranslator> translator;
      translator->SetWholeExtent(image->GetExtent());
      translator->SetNumberOfPieces(ranks());
      translator->SetPiece(rank());
      split == vtkExtentTranslator::X_SLAB_MODE                           ? translator->SetSplitModeToXSlab()
        : split == vtkExtentTranslator::Z_SLAB_MODE&& setting.size[2] > 1 ? translator->SetSplitModeToZSlab()
                                                                          : translator->SetSplitModeToBlock();
      translator->SetGhostLevel(ghosts);
      translator->PieceToExtent();
      vtkNew<vtkImageData> piece;
      piece->DeepCopy(image);
      piece->Crop(translator->GetExtent());
      vtkNew<vtkTrivialProducer> producer;
      producer->SetOutput(piece);
      producer->SetWholeExtent(image->GetExtent());
      vtkNew<vtkPoreFloodFill> together;
      together->SetInputConnection(producer->GetOutputPort());
      configure(together, setting);
      together->UpdatePiece(rank(), ranks(), 0);
      vtkImageData* const part = together->GetOutput();
      ASSERT_EQ(part->GetNumberOfPoints(), piece->GetNumberOfPoints());
      for (const char* const name : { "pore", "pore_size" })
      {
        vtkDataArray* const found = points(part, name);
        vtkDataArray* const expected = points(whole, name);
        for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
        {
          const double value = found->GetTuple1(i);
          const double other = expected->GetTuple1(whole->FindPoint(part->GetPoint(i)));
          ASSERT_TRUE(value == other || (std::isnan(value) && std::isnan(other))) << name << " at " << i;
        }
      }
      for (const char* const name : { "pore_count", "pore_total", "pore_mean", "pore_largest", "porosity",
             "pore_dropped", "pore_open", "pore_closed", "pore_percolates" })
        EXPECT_EQ(fieldNumbers(part, name), fieldNumbers(whole, name)) << name;
      vtkTable* const table = together->GetPores();
      vtkTable* const expected = alone->GetPores();
      ASSERT_EQ(table->GetNumberOfRows(), rank() == 0 ? expected->GetNumberOfRows() : 0);
      for (vtkIdType column = 0; column < expected->GetNumberOfColumns(); ++column)
      {
        for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
        {
          ASSERT_EQ(table->GetValue(row, column), expected->GetValue(row, column))
            << expected->GetColumnName(column) << " of row " << row;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SameAsOneRank,
  ::testing::Values(Setting{ { 70, 40, 1 }, 4, { 0, 0, 0 }, 0.55 }, Setting{ { 70, 40, 1 }, 8, { 0, 0, 0 }, 0.4, 2 },
    Setting{ { 66, 31, 1 }, 8, { 1, 1, 0 }, 0.35 }, Setting{ { 40, 33, 1 }, 4, { 0, 1, 0 }, 0.5 },
    Setting{ { 20, 18, 16 }, 6, { 0, 0, 0 }, 0.25 }, Setting{ { 20, 18, 16 }, 18, { 1, 0, 1 }, 0.12 },
    Setting{ { 17, 12, 11 }, 26, { 1, 1, 1 }, 0.1, 2 }, Setting{ { 20, 18, 16 }, 26, { 0, 1, 0 }, 0.08 }),
  [](const auto& setting)
  {
    std::string name = "n" + std::to_string(setting.param.connectivity) + "_periodic";
    for (const int axis : setting.param.periodic)
      name += std::to_string(axis);
    return name;
  });

TEST_F(PoreFloodFill, AnErrorIsOneOnEveryRank)
{
  const auto image = picture(30, 24, 1, [](int x, int, int) { return x % 2; });
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(image);
  vtkNew<vtkPoreFloodFill> filter;
  filter->SetInputConnection(producer->GetOutputPort());
  filter->SetPhase("a");
  filter->SetMaximumNumberOfLabels(14);
  filter->UpdateInformation();
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), ranks());
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), rank());
  EXPECT_NE(errorOf(filter).find("there are 15 pores; 14 can be told apart"), std::string::npos);
}

} // namespace
