// Files to phases through the pipeline. What micrograph::readPicture() does with each format is tested there.
#include "VtkTesting.h"

#include "pictures/PictureRecord.h"
#include "pictures/WritePicture.h"

#include "vtkCellData.h"
#include "vtkPNGWriter.h"
#include "vtkPictureReader.h"
#include "vtkUnsignedCharArray.h"
#include "vtkXMLImageDataWriter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace
{

using namespace lamella;
using vtktest::errorOf;

class PictureReader : public ::testing::Test
{
protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] static vtkNew<vtkPictureReader> reader(const std::string& file)
  {
    vtkNew<vtkPictureReader> result;
    result->SetFileName(file.c_str());
    return result;
  }

  static void write(vtkImageData* image, const std::string& file)
  {
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetInputData(image);
    writer->SetFileName(file.c_str());
    ASSERT_EQ(writer->Write(), 1);
  }

  /// 4 × 3 greys; the bottom row of the picture is 0 0 128 128.
  [[nodiscard]] static vtkNew<vtkImageData> greys()
  {
    vtkNew<vtkImageData> image;
    image->SetDimensions(4, 3, 1);
    image->GetPointData()->SetScalars(adopt({ 0, 0, 128, 128, 0, 255, 255, 128, 0, 0, 0, 255 }, "scan"));
    return image;
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
    ("lamella-reader-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
      ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

std::vector<int> phases(vtkPictureReader* reader)
{
  const auto view = viewPhases(reader->GetOutput());
  return { view.phase.begin(), view.phase.end() };
}

TEST_F(PictureReader, PngStandsUpright)
{
  vtkNew<vtkPNGWriter> writer; // VTK writes the first row in memory at the bottom of the picture
  writer->SetInputData(greys());
  writer->SetFileName(path("a.png").c_str());
  writer->Write();
  const auto picture = reader(path("a.png"));
  picture->SetPhase(0, "lumen");
  picture->SetPhase(128, "wall");
  picture->SetPhase(255, "wall");
  picture->SetPixelSize(5e-7);
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 1 }));
  EXPECT_EQ(phaseNames(picture->GetOutput()).names(), (std::vector<std::string>{ "lumen", "wall" }));
  EXPECT_DOUBLE_EQ(picture->GetOutput()->GetSpacing()[0], 5e-7);
  EXPECT_DOUBLE_EQ(picture->GetOutput()->GetOrigin()[1], 2.5e-7);
  EXPECT_EQ(fieldText(picture->GetOutput(), "pixel_size_source"), "option");
  EXPECT_NE(provenance(picture->GetOutput()).find("sha256"), std::string::npos);
}

TEST_F(PictureReader, WindowCountsFromTheTopAndNeedsNoPhaseOutside)
{
  write(greys(), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  picture->SetPhase(0, "lumen");
  picture->SetPhase(255, "wall");
  picture->SetWindow(0, 0, 0, 3, 2, 0); // the two upper rows without the last column: no 128
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 1, 1, 0, 0, 0 }));
  picture->SetWindow(2, 0, 0, 3, 2, 0);
  const std::string error = errorOf(picture);
  EXPECT_NE(error.find("reaches outside"), std::string::npos) << error;
}

TEST_F(PictureReader, RefinementSplitsPixels)
{
  write(greys(), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  picture->SetRefinement(2);
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(picture->GetOutput()->GetDimensions()[0], 8);
  EXPECT_DOUBLE_EQ(picture->GetOutput()->GetSpacing()[0], 0.5);
  const auto all = phases(picture);
  EXPECT_EQ(std::vector<int>(all.begin(), all.begin() + 8), (std::vector<int>{ 0, 0, 0, 0, 1, 1, 1, 1 }));
}

TEST_F(PictureReader, NamelessGreysAreTheirOwnPhases)
{
  write(greys(), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phaseNames(picture->GetOutput()).names(), (std::vector<std::string>{ "0", "128", "255" }));
}

TEST_F(PictureReader, AGreyInNoPhaseIsAnErrorUnlessOtherSaysWhatItIs)
{
  write(greys(), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  picture->SetPhase(0, "lumen");
  const std::string error = errorOf(picture);
  EXPECT_NE(error.find("grey value 128 is in no phase"), std::string::npos) << error;
  picture->SetOtherPhase("wall");
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 1 }));
}

TEST_F(PictureReader, RangesOfGreysAreTextsThatOneReaderReads)
{
  write(greys(), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  picture->SetPhase("..127", "lumen");
  picture->SetPhase("128..", "wall");
  EXPECT_EQ(picture->GetNumberOfPhases(), 2);
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 1 }));
  EXPECT_NE(provenance(picture->GetOutput()).find("128.."), std::string::npos);
  picture->SetPhase("120..140", "lamella");
  EXPECT_NE(errorOf(picture).find("overlap"), std::string::npos);
  picture->RemoveAllPhases();
  picture->SetPhase("..otsu", "lumen");
  picture->SetPhase("otsu..", "wall");
  ASSERT_EQ(errorOf(picture), "");
  // 0, 128 and 255: 128 goes with 255, and the level to the middle between 0 and 128.
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 1 }));
  EXPECT_NE(fieldText(picture->GetOutput(), "segmentation")->find("parted at 64"), std::string::npos);
}

TEST_F(PictureReader, AVolumeIsSegmentedAndSaysHow)
{
  // A slab of bright voxels with a speck beside it.
  vtkNew<vtkImageData> image;
  image->SetDimensions(20, 20, 20);
  std::vector<std::uint8_t> values(8000, 50);
  for (std::size_t node = 0; node < values.size(); ++node)
    values[node] = static_cast<std::uint8_t>(50 + (node % 20 >= 8 && node % 20 < 16 ? 100 : 0) + node * 7919 % 11);
  values[20 * 20 * 10 + 20 * 10 + 2] = 160;
  image->GetPointData()->SetScalars(adopt(values, "scan"));
  write(image, path("v.vti"));
  const auto volume = reader(path("v.vti"));
  volume->SegmentOn();
  ASSERT_EQ(errorOf(volume), "");
  EXPECT_EQ(phaseNames(volume->GetOutput()).names(), (std::vector<std::string>{ "void", "solid" }));
  const std::vector<int> found = phases(volume);
  EXPECT_EQ(std::count(found.begin(), found.end(), 1), 8 * 400);
  EXPECT_NE(fieldText(volume->GetOutput(), "segmentation"), "");
  volume->SetPhase("..otsu", "air");
  volume->SetPhase("otsu..", "fibre");
  ASSERT_EQ(errorOf(volume), "");
  EXPECT_EQ(phaseNames(volume->GetOutput()).names(), (std::vector<std::string>{ "air", "fibre" }));
  volume->SetWindow(4, 0, 0, 8, 20, 20); // cut before it is segmented
  ASSERT_EQ(errorOf(volume), "");
  EXPECT_EQ(volume->GetOutput()->GetDimensions()[0], 8);
  EXPECT_EQ(phases(volume)[3], 0);
  EXPECT_EQ(phases(volume)[4], 1);
  volume->SetRim(2);
  EXPECT_NE(errorOf(volume).find("is for pictures"), std::string::npos);
  volume->SetRim(-1);
  volume->SetThreshold(100);
  EXPECT_NE(errorOf(volume).find("contradict"), std::string::npos);
}

TEST_F(PictureReader, CellsBecomeNodesAtTheirCentres)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(5, 4, 1);
  image->SetSpacing(2, 2, 2);
  image->GetCellData()->SetScalars(adopt({ 0, 0, 1, 1, 0, 2, 2, 1, 0, 0, 0, 2 }, "label"));
  write(image, path("cells.vti"));
  const auto picture = reader(path("cells.vti"));
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(picture->GetOutput()->GetDimensions()[0], 4);
  EXPECT_DOUBLE_EQ(picture->GetOutput()->GetOrigin()[0], 1);
  EXPECT_EQ(phases(picture), (std::vector<int>{ 0, 0, 1, 1, 0, 2, 2, 1, 0, 0, 0, 2 }));
}

TEST_F(PictureReader, FilesOfPhasesKeepTheirNames)
{
  write(vtktest::picture(6, 5, 1, vtktest::blobs), path("a.vti"));
  const auto picture = reader(path("a.vti"));
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phaseNames(picture->GetOutput()).names(), (std::vector<std::string>{ "a", "b", "c" }));
  picture->SetArrayName("nothing");
  const std::string error = errorOf(picture);
  EXPECT_NE(error.find("no array 'nothing'"), std::string::npos) << error;
}

// A picture that the program wrote says what its greys are, whoever reads it.
TEST_F(PictureReader, PicturesOfLamellaKeepTheirNamesAndPixels)
{
  const PhaseImage image = toPhaseImage(vtktest::picture(6, 5, 1, vtktest::blobs));
  const std::vector<std::uint8_t> values{ 0, 127, 255 };
  micrograph::PictureRecord record;
  record.pixelSize = 1.0 / 3e6;
  for (std::size_t id = 0; id < values.size(); ++id)
    record.phases[values[id]] = image.phases.names()[id];
  micrograph::writeLabels(image, path("a.png"), values, toJson(record));
  const auto picture = reader(path("a.png"));
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phaseNames(picture->GetOutput()).names(), image.phases.names());
  EXPECT_EQ(phases(picture), (std::vector<int>{ image.phase.begin(), image.phase.end() }));
  EXPECT_EQ(picture->GetOutput()->GetSpacing()[0], 1.0 / 3e6); // PNG alone would round it
  EXPECT_EQ(fieldText(picture->GetOutput(), "pixel_size_source"), "lamella record");
  picture->SetPhase("0..127", "wood"); // who reads it has the last word
  picture->SetOtherPhase("air");
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(phaseNames(picture->GetOutput()).names().front(), "wood");

  record.size = image.lattice.size;
  std::ofstream(path("a.raw"), std::ios::binary)
    .write(reinterpret_cast<const char*>(image.phase.data()), static_cast<std::streamsize>(image.phase.size()));
  record.phases = { { 0, "a" }, { 1, "b" }, { 2, "c" } };
  std::ofstream(path("a.raw.json")) << toJson(record);
  const auto raw = reader(path("a.raw")); // neither name nor user tells its size
  ASSERT_EQ(errorOf(raw), "");
  EXPECT_EQ(raw->GetOutput()->GetDimensions()[0], 6);
  EXPECT_EQ(phaseNames(raw->GetOutput()).names(), (std::vector<std::string>{ "a", "b", "c" }));
}

// Solvers look for grains and for the way walls run: without them their answer is another one.
TEST_F(PictureReader, WhatElseTheFileHoldsIsCarriedAlong)
{
  const auto image = vtktest::picture(6, 5, 1, vtktest::blobs);
  vtkNew<vtkDoubleArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(30);
  axis->SetComponentName(1, "up");
  vtkNew<vtkDoubleArray> field;
  field->SetName("field");
  field->SetNumberOfTuples(30);
  for (vtkIdType i = 0; i < 30; ++i)
  {
    axis->SetTuple3(i, static_cast<double>(i), 1, 0);
    field->SetValue(i, static_cast<double>(i));
  }
  image->GetPointData()->AddArray(axis);
  image->GetPointData()->AddArray(field);
  setFieldText(image, "load_axis", "x");
  write(image, path("a.vti"));
  const auto picture = reader(path("a.vti"));
  ASSERT_EQ(errorOf(picture), "");
  const auto value = [&](const char* name, vtkIdType node)
  { return vtktest::points(picture->GetOutput(), name)->GetComponent(node, 0); };
  EXPECT_EQ(value("axis", 29), 29);
  EXPECT_EQ(value("field", 7), 7);
  EXPECT_EQ(fieldText(picture->GetOutput(), "load_axis"), "x");
  EXPECT_NE(provenance(picture->GetOutput()).find("\"picture\""), std::string::npos); // of this reading

  picture->SetWindow(2, 0, 0, 3, 2, 0); // of the two upper rows, which are the last in memory
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(value("axis", 0), 6 * 3 + 2);
  EXPECT_EQ(value("field", 5), 6 * 4 + 4);
  EXPECT_STREQ(vtktest::points(picture->GetOutput(), "axis")->GetComponentName(1), "up");
  EXPECT_FALSE(fieldText(picture->GetOutput(), "load_axis")); // of the whole

  picture->SetRefinement(2);
  ASSERT_EQ(errorOf(picture), "");
  EXPECT_EQ(value("axis", 6 * 3 + 5), 6 * 4 + 4);
  EXPECT_EQ(vtktest::points(picture->GetOutput(), "field"), nullptr); // solved on a coarser lattice
}

TEST_F(PictureReader, SaysWhatIsWrongWithAFile)
{
  EXPECT_NE(errorOf(vtkNew<vtkPictureReader>()).find("no file is named"), std::string::npos);
  EXPECT_NE(errorOf(reader(path("missing.vti"))).find("missing.vti"), std::string::npos);
  std::ofstream(path("empty.vti")).close();
  EXPECT_NE(errorOf(reader(path("empty.vti"))).find("is empty"), std::string::npos);
  write(greys(), path("a.vti"));
  std::ifstream whole(path("a.vti"), std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(whole)), std::istreambuf_iterator<char>());
  std::ofstream(path("half.vti"), std::ios::binary) << text.substr(0, text.size() / 2);
  const std::string error = errorOf(reader(path("half.vti")));
  EXPECT_NE(error.find("is a .vti file that is damaged or cut short"), std::string::npos) << error;
}

} // namespace
