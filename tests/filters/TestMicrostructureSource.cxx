// All generators through the pipeline: the same sample whole and in pieces.
#include "VtkTesting.h"

#include "generators/Generators.h"
#include "vtkMicrostructureSource.h"

#include <gtest/gtest.h>

#include <numeric>

namespace
{

using namespace lamella;

struct Kind
{
  int kind;
  std::array<int, 3> size;
  double solid;
  double tolerance; // lattice: half a node (softwood), half a row of nodes, pixels of a curved edge
};

class MicrostructureSource : public ::testing::TestWithParam<Kind>
{
};

TEST_P(MicrostructureSource, HasTheSolidFractionAskedFor)
{
  const Kind& kind = GetParam();
  vtkNew<vtkMicrostructureSource> source;
  source->SetKind(kind.kind);
  source->SetSize(kind.size.data());
  source->SetSolidFraction(0.4);
  ASSERT_EQ(vtktest::errorOf(source), "");
  vtkImageData* const image = source->GetOutput();
  EXPECT_EQ(image->GetDimensions()[0], kind.size[0]);
  EXPECT_EQ(image->GetDimensions()[2], kind.size[2]);
  const auto view = viewPhases(image);
  const double solid =
    std::accumulate(view.phase.begin(), view.phase.end(), 0.0) / static_cast<double>(view.phase.size());
  EXPECT_NEAR(solid, kind.solid, kind.tolerance);
  const bool tissue = kind.kind == vtkMicrostructureSource::SOFTWOOD || kind.kind == vtkMicrostructureSource::HARDWOOD;
  EXPECT_EQ(view.phases.names()[1], tissue || kind.kind == vtkMicrostructureSource::HONEYCOMB ? "wall" : "inclusion");
  EXPECT_NE(provenance(image).find("\"microstructure\""), std::string::npos);
  EXPECT_EQ(provenance(image).find("\"seed\"") != std::string::npos, tissue);
}

TEST_P(MicrostructureSource, PiecesAreCutsOfTheWhole)
{
  const Kind& kind = GetParam();
  vtkNew<vtkMicrostructureSource> source;
  source->SetKind(kind.kind);
  source->SetSize(kind.size.data());
  source->Update();
  vtkNew<vtkImageData> whole;
  whole->ShallowCopy(source->GetOutput());
  std::array<int, 6> extent{ 3, 20, 5, 31, 0, kind.size[2] > 1 ? 4 : 0 };
  vtkNew<vtkMicrostructureSource> part;
  part->SetKind(kind.kind);
  part->SetSize(kind.size.data());
  part->UpdateExtent(extent.data());
  vtkImageData* const piece = part->GetOutput();
  ASSERT_TRUE(std::equal(extent.begin(), extent.end(), piece->GetExtent()));
  for (int z = extent[4]; z <= extent[5]; ++z)
  {
    for (int y = extent[2]; y <= extent[3]; ++y)
      for (int x = extent[0]; x <= extent[1]; ++x)
        ASSERT_EQ(piece->GetScalarComponentAsDouble(x, y, z, 0), whole->GetScalarComponentAsDouble(x, y, z, 0));
  }
}

std::string nameOf(const ::testing::TestParamInfo<Kind>& kind)
{
  static const char* const names[] = { "softwood", "honeycomb", "checkerboard", "inclusions", "laminate", "hardwood" };
  return std::string(names[kind.param.kind]) + (kind.param.size[2] > 1 ? "_3D" : "_2D");
}

INSTANTIATE_TEST_SUITE_P(All, MicrostructureSource,
  ::testing::Values(Kind{ vtkMicrostructureSource::SOFTWOOD, { 120, 100, 1 }, 0.4, 1e-4 },
    Kind{ vtkMicrostructureSource::SOFTWOOD, { 48, 40, 40 }, 0.4, 1e-4 },
    Kind{ vtkMicrostructureSource::HONEYCOMB, { 120, 100, 1 }, 0.4, 0.02 },
    Kind{ vtkMicrostructureSource::CHECKERBOARD, { 48, 40, 1 }, 0.5, 1e-12 },
    Kind{ vtkMicrostructureSource::INCLUSIONS, { 160, 160, 1 }, 0.4, 0.01 },
    Kind{ vtkMicrostructureSource::INCLUSIONS, { 80, 80, 80 }, 0.4, 0.02 },
    Kind{ vtkMicrostructureSource::LAMINATE, { 40, 40, 1 }, 0.4, 1e-12 },
    Kind{ vtkMicrostructureSource::HARDWOOD, { 220, 200, 1 }, 0.4, 1e-4 }),
  nameOf);

TEST(MicrostructureSourceDefaults, AreTheGenerators)
{
  // A whole ring and a depth, so that every default has a say.
  generators::SoftwoodOptions options;
  options.dimension = 3;
  options.size = { 200, 60, 8 };
  options.ringPosition1 = 1;
  const PhaseImage expected = generators::softwood(options);
  vtkNew<vtkMicrostructureSource> source;
  source->SetSize(200, 60, 8);
  source->SetRingPosition(0, 1);
  ASSERT_EQ(vtktest::errorOf(source), "");
  const auto view = viewPhases(source->GetOutput());
  EXPECT_EQ(view.lattice.spacing, expected.lattice.spacing);
  EXPECT_TRUE(std::equal(view.phase.begin(), view.phase.end(), expected.phase.begin(), expected.phase.end()));
  vtkNew<vtkMicrostructureSource> whole; // the size is a default too
  EXPECT_EQ(whole->GetSize()[0], generators::SoftwoodOptions().size[0]);
  EXPECT_EQ(whole->GetSize()[1], generators::SoftwoodOptions().size[1]);
  EXPECT_EQ(whole->GetSize()[2], generators::SoftwoodOptions().size[2]);
}

TEST(MicrostructureSourceDefaults, AreTheHardwoodGenerators)
{
  generators::HardwoodOptions options;
  options.size = { 500, 300, 1 };
  options.ringPosition1 = 1;
  const PhaseImage expected = generators::hardwood(options);
  vtkNew<vtkMicrostructureSource> source;
  source->SetKind(vtkMicrostructureSource::HARDWOOD);
  source->SetSize(500, 300, 1);
  source->SetSolidFraction(options.solidFraction);
  source->SetRingPosition(0, 1);
  ASSERT_EQ(vtktest::errorOf(source), "");
  const auto view = viewPhases(source->GetOutput());
  EXPECT_TRUE(std::equal(view.phase.begin(), view.phase.end(), expected.phase.begin(), expected.phase.end()));
  source->SetSize(60, 60, 9);
  EXPECT_NE(vtktest::errorOf(source).find("a hardwood sample of 3 dimensions"), std::string::npos);
}

TEST(MicrostructureSourceErrors, SaysWhatIsWrong)
{
  vtkNew<vtkMicrostructureSource> source;
  source->SetSolidFraction(1.5);
  EXPECT_NE(vtktest::errorOf(source).find("1.5"), std::string::npos);
  source->SetSolidFraction(0.4);
  source->SetSize(0, 10, 1);
  EXPECT_NE(vtktest::errorOf(source).find("size (x) 0 is below 1"), std::string::npos);
  source->SetSize(50, 50, 1);
  source->SetSeed(-1);
  EXPECT_NE(vtktest::errorOf(source).find("seed -1 is below 0"), std::string::npos);
}

} // namespace
