// Lattices from outlines through the pipeline: what the numerics give, under the names of the data model.
#include "ContourData.h"
#include "MicrographTesting.h"
#include "vtkMicrographLattice.h"

#include "outlines/ContourLattice.h"
#include "outlines/MiddleLamella.h"
#include "outlines/WallDirection.h"

#include "vtkInformation.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;
using micrograph::ContourSet;

TEST_F(Micrograph, OutlinesLieOverTheirPicture)
{
  const auto image = toImageData(tissue());
  const double spacing = image->GetSpacing()[0];
  image->SetOrigin(3e-3, -1e-3, 5e-6);
  const auto filter = contoursOf(image);
  vtkNew<vtkMicrographLattice> lattice;
  lattice->SetInputConnection(filter->GetOutputPort());
  lattice->SetSpacing(spacing);
  ASSERT_EQ(errorOf(lattice), "");
  const std::array<double, 3> corner = cornerOf(filter->GetOutput());
  EXPECT_NEAR(corner[0], 3e-3 - spacing / 2, 1e-15);
  EXPECT_EQ(corner[2], 5e-6);
  // At the pixels' own spacing nodes fall on the pixels, and outlines pass between nodes of different phases.
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(lattice->GetOutput()->GetOrigin()[axis], image->GetOrigin()[axis], 1e-15);
  const PhaseView view = viewPhases(lattice->GetOutput());
  EXPECT_TRUE(std::equal(view.phase.begin(), view.phase.end(), tissue().phase.begin()));
}

TEST_F(Micrograph, LatticeIsThatOfTheLibrary)
{
  const ContourSet contours = expectedContours();
  for (const int type : { vtkMicrographLattice::NONE, vtkMicrographLattice::GROWTH, vtkMicrographLattice::CONSTANT })
  {
    vtkNew<vtkMicrographLattice> filter;
    filter->SetInputData(toPolyData(contours, "test"));
    filter->SetSpacing(0.3e-6);
    filter->SetLamella(type);
    filter->SetLamellaThickness(0.6e-6);
    ASSERT_EQ(errorOf(filter), "");
    micrograph::ContourLatticeOptions options;
    options.spacing = 0.3e-6;
    options.lines = 0;
    const micrograph::ContourLattice lattice = micrograph::contourLattice(contours, options);
    const micrograph::WallDirections directions = micrograph::wallDirections(contours, lattice);
    vtkImageData* const image = filter->GetOutput();
    PhaseImage expected = lattice.image;
    if (type != vtkMicrographLattice::NONE)
    {
      micrograph::LamellaOptions lamella;
      lamella.method =
        type == vtkMicrographLattice::GROWTH ? micrograph::LamellaMethod::Growth : micrograph::LamellaMethod::Constant;
      lamella.thickness = 0.6e-6;
      const micrograph::MiddleLamella middle = micrograph::middleLamella(lattice, directions, lamella);
      expected = middle.image;
      EXPECT_EQ(fieldNumbers(image, "lamella_thickness").at(0), 0.6e-6);
      EXPECT_EQ(fieldNumbers(image, "lamella_radius").at(0), middle.radius);
      EXPECT_EQ(fieldNumbers(image, "lamella_share").at(0), middle.wallShare);
      EXPECT_EQ(
        fieldNumbers(image, "lamella_nodes_across"), (std::vector<double>{ middle.across.mean, middle.across.low }));
      EXPECT_EQ(fieldNumbers(image, "cells").at(0), static_cast<double>(middle.cells));
    }
    const PhaseView view = viewPhases(image);
    EXPECT_EQ(view.lattice.size, expected.lattice.size);
    EXPECT_EQ(view.lattice.spacing, expected.lattice.spacing);
    EXPECT_EQ(view.lattice.origin, expected.lattice.origin);
    EXPECT_EQ(view.phases.names(), expected.phases.names());
    EXPECT_TRUE(std::equal(view.phase.begin(), view.phase.end(), expected.phase.begin(), expected.phase.end()));
    vtkPointData* const points = image->GetPointData();
    for (std::size_t i = 0; i < expected.phase.size(); ++i)
    {
      const auto id = static_cast<vtkIdType>(i);
      ASSERT_EQ(points->GetArray("grain")->GetTuple1(id), directions.grain[i]);
      ASSERT_EQ(points->GetArray("lumen_share")->GetTuple1(id), lattice.lumenShare[i]);
      const double* const axis = points->GetArray("axis")->GetTuple3(id);
      ASSERT_EQ(axis[0], directions.axis[i][0]);
      ASSERT_EQ(axis[1], directions.axis[i][1]);
      ASSERT_EQ(axis[2], 0);
      // A unit vector (single precision) in walls, nothing in lumens.
      ASSERT_NEAR(std::hypot(axis[0], axis[1]), expected.phase[i] == 0 ? 0 : 1, 1e-5);
    }
    EXPECT_EQ(fieldNumbers(image, "lumen_fraction").at(0), lattice.lumenFraction);
    EXPECT_EQ(
      fieldNumbers(image, "wall_thickness"), (std::vector<double>{ lattice.thickness.low, lattice.thickness.median }));
    EXPECT_EQ(fieldText(image, "pixel_size_source").value_or(""), "outlines");
    EXPECT_NE(provenance(image).find("\"lattice\""), std::string::npos);
  }
}

TEST_F(Micrograph, WallFractionHoldsAtEverySpacing)
{
  const auto outlines = toPolyData(expectedContours(), "test");
  const double wall = fieldNumbers(outlines, "wall_fraction").at(0);
  for (const double spacing : { 1e-6, 0.5e-6, 0.27e-6 })
  {
    vtkNew<vtkMicrographLattice> filter;
    filter->SetInputData(outlines);
    filter->SetSpacing(spacing);
    ASSERT_EQ(errorOf(filter), "");
    // What is cropped at the top, below one spacing of 100 µm, has another share of wall.
    EXPECT_NEAR(fieldNumbers(filter->GetOutput(), "wall_fraction").at(0), wall, 1e-3 + 0.6 * spacing / 100e-6);
  }
}

TEST_F(Micrograph, LatticeSaysWhatIsWrong)
{
  const auto outlines = toPolyData(expectedContours(), "test");
  vtkNew<vtkMicrographLattice> filter;
  filter->SetInputData(outlines);
  EXPECT_EQ(errorOf(filter), ""); // a quarter of the walls' median thickness
  EXPECT_NEAR(filter->GetOutput()->GetSpacing()[0] * 4, fieldNumbers(filter->GetOutput(), "wall_thickness").at(1),
    0.02 * fieldNumbers(filter->GetOutput(), "wall_thickness").at(1)); // a whole number fits the width
  for (const double spacing : { notANumber, -1e-6, std::numeric_limits<double>::infinity(), 1.0, 1e-12, 1e-300 })
  {
    filter->SetSpacing(spacing);
    EXPECT_NE(errorOf(filter).find("\nhint: "), std::string::npos) << spacing;
  }
  filter->SetSpacing(0.5e-6);
  filter->SetLamella(vtkMicrographLattice::GROWTH);
  filter->SetLamellaThickness(-1e-6);
  EXPECT_NE(errorOf(filter).find("\nhint: "), std::string::npos);
  filter->SetLamellaThickness(notANumber);
  EXPECT_NE(errorOf(filter).find("\nhint: "), std::string::npos);
  filter->SetLamellaThickness(0);
  filter->SetLamellaRadius(notANumber);
  EXPECT_NE(errorOf(filter).find("\nhint: "), std::string::npos);
  filter->SetLamellaRadius(-1);
  filter->SetHorizon(notANumber);
  EXPECT_NE(errorOf(filter).find("\nhint: "), std::string::npos);
  filter->SetHorizon(0);
  EXPECT_EQ(errorOf(filter), "");
  vtkNew<vtkPolyData> empty;
  filter->SetInputData(empty);
  EXPECT_NE(errorOf(filter).find("there are no outlines"), std::string::npos);
}

// Lumens 16 pixels wide, walls of 8 with a lamella of 2 in their middle: at the pixels' own spacing, which is the
// default, outlines pass half-way between pixels.
TEST_F(Micrograph, ALamellaFromLabels)
{
  const auto labels =
    picture(96, 60, 1, [](int x, int, int) { return x % 24 < 16               ? 0
                                               : x % 24 == 19 || x % 24 == 20 ? 2
                                                                              : 1; });
  const auto outlines = contoursOf(labels);
  outlines->SetLumenPhase("a");
  vtkNew<vtkMicrographLattice> lattice;
  lattice->SetInputConnection(outlines->GetOutputPort());
  lattice->SetLamella(vtkMicrographLattice::LABELS);
  EXPECT_NE(errorOf(lattice).find("needs a picture of labels"), std::string::npos);
  lattice->SetPictureData(labels);
  EXPECT_NE(errorOf(lattice).find("which phase is the middle lamella"), std::string::npos);
  lattice->SetLamellaPhase("c");
  ASSERT_EQ(errorOf(lattice), "");
  vtkImageData* const image = lattice->GetOutput();
  EXPECT_NEAR(image->GetSpacing()[0], 1e-6, 1e-15);
  EXPECT_NEAR(fieldNumbers(image, "lamella_share").at(0), 0.25, 1e-12);
  EXPECT_NEAR(fieldNumbers(image, "lamella_nodes_across").at(0), 2, 0.1);
  EXPECT_EQ(viewPhases(image).phases.names(), (std::vector<std::string>{ "lumen", "wall", "middle lamella" }));
}

TEST_F(Micrograph, LatticeWarnsOfThinWallsAndLamellae)
{
  std::vector<std::string> warnings;
  vtkNew<vtkCallbackCommand> keep;
  keep->SetClientData(&warnings);
  keep->SetCallback([](vtkObject*, unsigned long, void* client, void* text)
    { static_cast<std::vector<std::string>*>(client)->emplace_back(static_cast<const char*>(text)); });
  vtkNew<vtkMicrographLattice> filter;
  filter->AddObserver(vtkCommand::WarningEvent, keep);
  filter->SetInputData(toPolyData(expectedContours(), "test"));
  filter->SetSpacing(0.3e-6);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_TRUE(warnings.empty());
  filter->SetLamella(vtkMicrographLattice::CONSTANT);
  filter->SetHorizon(4);
  ASSERT_EQ(errorOf(filter), "");
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("thinner than the horizon of 4"), std::string::npos) << warnings[0];
  warnings.clear();
  filter->SetLamella(vtkMicrographLattice::NONE);
  filter->SetSpacing(3e-6);
  ASSERT_EQ(errorOf(filter), "");
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("nodes thick"), std::string::npos) << warnings[0];
}

TEST_F(Micrograph, EveryRankHasTheWhole)
{
  const auto image = toImageData(tissue());
  const auto outlines = contoursOf(image);
  vtkNew<vtkMicrographLattice> lattice;
  lattice->SetInputConnection(outlines->GetOutputPort());
  lattice->SetSpacing(0.5e-6);
  lattice->UpdateInformation();
  std::array<int, 6> whole{};
  lattice->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  EXPECT_EQ(whole, (std::array<int, 6>{ 0, 239, 0, 199, 0, 0 }));
  ASSERT_EQ(lattice->UpdatePiece(rank(), ranks(), 0), 1);
  const std::vector<std::uint8_t> expected = tissue().phase;
  vtkImageData* const piece = lattice->GetOutput();
  int extent[6];
  piece->GetExtent(extent);
  ASSERT_GT(piece->GetNumberOfPoints(), 0);
  EXPECT_EQ(ranks() == 1, piece->GetNumberOfPoints() == 240 * 200);
  for (int y = extent[2]; y <= extent[3]; ++y)
    for (int x = extent[0]; x <= extent[1]; ++x)
      ASSERT_EQ(piece->GetScalarComponentAsDouble(x, y, 0, 0), expected[static_cast<std::size_t>(x + 240 * y)]);
  // Outlines are with the first.
  ASSERT_EQ(outlines->UpdatePiece(rank(), ranks(), 0), 1);
  EXPECT_EQ(outlines->GetOutput()->GetNumberOfCells() > 0, rank() == 0);
}

} // namespace
