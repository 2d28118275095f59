// Crack paths of broken bonds and images that ranks hold in pieces: the answer of one rank.
#include "CrackBonds.h"

#include "vtkExtentTranslator.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTrivialProducer.h"

#include <gtest/gtest.h>

#include <random>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;

/// The part of a data set that this rank holds: points by lot, some on two ranks, in an order of its own.
vtkSmartPointer<vtkPolyData> shareOf(std::vector<cracks::CutBond> bonds, int rank, int ranks, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<cracks::CutBond> mine;
  for (const cracks::CutBond& b : bonds)
  {
    const auto owner = static_cast<int>(random() % static_cast<unsigned>(ranks));
    const bool twice = random() % 5 == 0;
    if (owner == rank || (twice && (owner + 1) % ranks == rank))
      mine.push_back(b);
  }
  std::shuffle(mine.begin(), mine.end(), std::mt19937(seed + static_cast<unsigned>(rank)));
  return brokenBonds(lattice(), horizon, mine);
}

void expectSameTable(vtkTable* found, vtkTable* expected)
{
  ASSERT_EQ(found->GetNumberOfRows(), expected->GetNumberOfRows());
  ASSERT_EQ(found->GetNumberOfColumns(), expected->GetNumberOfColumns());
  for (vtkIdType column = 0; column < expected->GetNumberOfColumns(); ++column)
  {
    for (vtkIdType row = 0; row < expected->GetNumberOfRows(); ++row)
    {
      ASSERT_EQ(found->GetValue(row, column).ToString(), expected->GetValue(row, column).ToString())
        << expected->GetColumnName(column) << " of row " << row;
    }
  }
}

TEST_F(CrackPath, SameAsOneRank)
{
  const auto bonds = sampleBonds();
  const auto image = strippedPicture();
  vtkNew<vtkCrackPath> alone;
  alone->SetInputData(brokenBonds(lattice(), horizon, bonds));
  alone->SetImageData(image);
  alone->UpdatePiece(0, 1, 0);
  ASSERT_EQ(alone->GetOutput()->GetNumberOfCells(), 2);
  for (const bool onlyLast : { false, true }) // all broken bonds on the last rank
  {
    vtkNew<vtkExtentTranslator> translator;
    translator->SetWholeExtent(image->GetExtent());
    translator->SetNumberOfPieces(ranks());
    translator->SetPiece(rank());
    onlyLast ? translator->SetSplitModeToXSlab() : translator->SetSplitModeToBlock();
    translator->SetGhostLevel(onlyLast ? 1 : 0);
    translator->PieceToExtent();
    vtkNew<vtkImageData> piece;
    piece->DeepCopy(image);
    piece->Crop(translator->GetExtent());
    vtkNew<vtkTrivialProducer> producer;
    producer->SetOutput(piece);
    producer->SetWholeExtent(image->GetExtent());
    vtkSmartPointer<vtkPolyData> mine = shareOf(bonds, rank(), ranks(), 3);
    if (onlyLast)
      mine = rank() == ranks() - 1 ? brokenBonds(lattice(), horizon, bonds) : vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkTrivialProducer> points_;
    points_->SetOutput(mine);
    vtkNew<vtkCrackPath> together;
    together->SetInputConnection(points_->GetOutputPort());
    together->SetImageConnection(producer->GetOutputPort());
    together->UpdatePiece(rank(), ranks(), 0);
    vtkPolyData* const lines = together->GetOutput();
    ASSERT_EQ(lines->GetNumberOfCells(), rank() == 0 ? 2 : 0);
    for (vtkIdType i = 0; i < lines->GetNumberOfPoints(); ++i)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(lines->GetPoint(i)[c], alone->GetOutput()->GetPoint(i)[c]) << i;
    if (rank() == 0)
    {
      expectSameTable(together->GetPathTable(), alone->GetPathTable());
      expectSameTable(together->GetPairTable(), alone->GetPairTable());
      expectSameTable(together->GetGrowthTable(), alone->GetGrowthTable());
      expectSameTable(together->GetFragmentTable(), alone->GetFragmentTable());
    }
    for (const char* const name : { "crack_count", "crack_length", "broken_bonds", "counted_size", "fragment_count",
           "severed", "left_out_bonds", "main_through", "main_start", "main_tip", "main_extension" })
      EXPECT_EQ(fieldNumbers(lines, name), fieldNumbers(alone->GetOutput(), name)) << name;
    vtkImageData* const part = together->GetImage();
    ASSERT_EQ(part->GetNumberOfPoints(), piece->GetNumberOfPoints());
    for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
    {
      ASSERT_EQ(points(part, "fragment")->GetTuple1(i),
        points(alone->GetImage(), "fragment")->GetTuple1(alone->GetImage()->FindPoint(part->GetPoint(i))))
        << i;
    }
  }
}

TEST_F(CrackPath, AnErrorIsOneOnEveryRank)
{
  auto mine = shareOf(sampleBonds(), rank(), ranks(), 4);
  if (rank() == ranks() - 1)
    mine->GetPointData()->RemoveArray("bond");
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(mine);
  vtkNew<vtkCrackPath> filter;
  filter->SetInputConnection(producer->GetOutputPort());
  filter->UpdateInformation();
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), ranks());
  filter->GetOutputInformation(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), rank());
  EXPECT_NE(errorOf(filter).find("the points have no array 'bond'"), std::string::npos);
}

} // namespace
