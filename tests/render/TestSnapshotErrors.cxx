// What a picture cannot be made of, and how that is said; files that are there whole or not at all.

#include "Samples.h"

#include "vtkSnapshot.h"

#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkPNGReader.h>
#include <vtkPolyData.h>
#include <vtkTable.h>
#include <vtkUnstructuredGrid.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sys/resource.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace
{

class SnapshotErrors : public testing::Test
{
protected:
  void SetUp() override
  {
    this->Quiet->SetCallback([](vtkObject*, unsigned long, void* count, void*) { ++*static_cast<int*>(count); });
    this->Quiet->SetClientData(&this->Errors);
    this->Snapshot->AddObserver(vtkCommand::ErrorEvent, this->Quiet);
    this->Snapshot->SetInputData(this->Image);
    this->Folder = fs::temp_directory_path() /
      ("lamella_snapshot_" + std::to_string(getpid()) + "_" +
        testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(this->Folder);
  }
  void TearDown() override
  {
    fs::permissions(this->Folder, fs::perms::owner_all);
    fs::remove_all(this->Folder);
  }
  void expectError(const std::string& message)
  {
    EXPECT_EQ(this->Snapshot->Draw(), nullptr);
    EXPECT_EQ(this->Snapshot->GetErrorMessage(), message);
    EXPECT_STRNE(this->Snapshot->GetErrorHint(), "");
    EXPECT_EQ(this->Errors, 1) << "one error event";
  }
  std::string path(const char* name) const { return (this->Folder / name).string(); }
  std::size_t filesInFolder() const
  {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(this->Folder), fs::directory_iterator()));
  }

  vtkSmartPointer<vtkImageData> Image = samples::tissue();
  vtkNew<vtkSnapshot> Snapshot;
  vtkNew<vtkCallbackCommand> Quiet;
  int Errors = 0;
  fs::path Folder;
};

} // namespace

TEST_F(SnapshotErrors, NoData)
{
  this->Snapshot->SetInputData(nullptr);
  this->expectError("no data to draw were given");
}

TEST_F(SnapshotErrors, EmptyData)
{
  vtkNew<vtkImageData> empty;
  this->Snapshot->SetInputData(empty);
  this->expectError("the data to draw are empty");
}

TEST_F(SnapshotErrors, WrongKindOfData)
{
  vtkNew<vtkTable> table;
  this->Snapshot->SetInputData(table);
  this->expectError("data of the kind vtkTable cannot be drawn");
}

TEST_F(SnapshotErrors, MissingArrayListsThoseThere)
{
  this->Snapshot->SetArrayName("temprature");
  this->expectError("there is no array 'temprature' in the data; point data: phase, temperature, flux, grain, stress");
}

TEST_F(SnapshotErrors, PresetWithoutItsArray)
{
  this->Snapshot->SetPreset(vtkSnapshot::CONCENTRATION);
  this->expectError(
    "there is no array 'concentration' in the data; point data: phase, temperature, flux, grain, stress");
}

TEST_F(SnapshotErrors, NoArrayAtAll)
{
  this->Snapshot->SetInputData(samples::lattice(4, 4, 1, 1));
  this->expectError("the data have no array to draw");
}

TEST_F(SnapshotErrors, CellData)
{
  vtkNew<vtkDoubleArray> cells;
  cells->SetName("damage");
  cells->SetNumberOfTuples(this->Image->GetNumberOfCells());
  this->Image->GetCellData()->AddArray(cells);
  this->Snapshot->SetArrayName("damage");
  this->expectError("'damage' is an array of cells; a lattice is drawn of its points");
}

TEST_F(SnapshotErrors, NothingButNaN)
{
  samples::addField(this->Image, "temperature", { [](int, int, int) { return std::nan(""); } });
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->expectError("'temperature' has no finite value");
}

TEST_F(SnapshotErrors, ALogarithmicRangeFromZero)
{
  samples::addField(this->Image, "pore_size", { [](int, int, int) { return 5.0; } });
  this->Snapshot->SetPreset(vtkSnapshot::PORES);
  this->Snapshot->SetRange(0, 10);
  this->expectError("the range begins at 0.000000, which has no place on a logarithmic scale");
}

TEST_F(SnapshotErrors, ComponentOutside)
{
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  this->Snapshot->SetComponent(3);
  this->expectError("component 3 of 'flux' is asked for; it has 3");
}

TEST_F(SnapshotErrors, EmptyRange)
{
  this->Snapshot->SetRange(1, 1);
  this->expectError("the range 1.000000 to 1.000000 is empty");
}

TEST_F(SnapshotErrors, InfiniteRange)
{
  this->Snapshot->SetRange(0, std::numeric_limits<double>::infinity());
  this->expectError("the range 0.000000 to inf is empty");
}

TEST_F(SnapshotErrors, UnknownColorMap)
{
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->SetColorMap("jet");
  this->expectError("there is no colour map 'jet'");
  EXPECT_STREQ(
    this->Snapshot->GetErrorHint(), "choose one of viridis, inferno, magma, cividis, gray, coolwarm, blue-red");
}

TEST_F(SnapshotErrors, PhasesAreWholeNumbers)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetArrayName("temperature");
  EXPECT_EQ(this->Snapshot->Draw(), nullptr);
  EXPECT_NE(
    std::string(this->Snapshot->GetErrorMessage()).find("which is no id of a phase or grain"), std::string::npos);
}

TEST_F(SnapshotErrors, TooManyPhases)
{
  samples::addField(this->Image, "phase", { [](int i, int, int) { return static_cast<double>(i); } });
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->expectError("'phase' has 120 different values; as phases at most 32 can be told apart");
}

TEST_F(SnapshotErrors, ColorForAnUnknownPhase)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetPhaseColor("bark", 0.3, 0.2, 0.1);
  this->expectError("a colour is given for the phase 'bark', which the data do not have");
  EXPECT_STREQ(this->Snapshot->GetErrorHint(), "they have: lumen, cell wall, middle lamella");
}

TEST_F(SnapshotErrors, LinesWithoutAVector)
{
  this->Image->GetPointData()->RemoveArray("flux");
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->SetOverlay(vtkSnapshot::LINES_OVERLAY);
  this->expectError("lines and arrows need a vector field; there is no array 'flux' in the data");
}

TEST_F(SnapshotErrors, LinesAlongAScalar)
{
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->SetOverlay(vtkSnapshot::ARROWS_OVERLAY);
  this->Snapshot->SetOverlayArrayName("stress");
  this->expectError("lines or arrows are to follow 'stress', which is no vector");
}

TEST_F(SnapshotErrors, SizeOutside)
{
  this->Snapshot->SetSize(20000, 100);
  this->expectError("size (width) 20000 is above 16384");
}

TEST_F(SnapshotErrors, SizeWithoutRoom)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetSize(64, 64);
  this->Snapshot->SetFontScale(4);
  this->expectError("a picture of 64 × 64 pixels leaves no room for the data");
}

TEST_F(SnapshotErrors, UnknownNames)
{
  EXPECT_FALSE(this->Snapshot->SetPresetByName("fluxes"));
  EXPECT_EQ(this->Snapshot->GetPreset(), vtkSnapshot::AUTO);
  EXPECT_TRUE(this->Snapshot->SetPresetByName("grain"));
  EXPECT_EQ(this->Snapshot->GetPreset(), vtkSnapshot::GRAIN);
  EXPECT_FALSE(this->Snapshot->SetOverlayByName("streamline"));
  EXPECT_TRUE(this->Snapshot->SetOverlayByName("isolines"));
}

TEST_F(SnapshotErrors, VolumeOfVoids)
{
  auto image = samples::volume();
  samples::addField<vtkUnsignedCharArray>(image, "phase", { [](int, int, int) { return 0.0; } });
  this->Snapshot->SetInputData(image);
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->expectError("the volume has nothing but voids");
}

TEST_F(SnapshotErrors, PointsAllAlike)
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1, 1, 1);
  vtkNew<vtkPolyData> one;
  one->SetPoints(points);
  this->Snapshot->SetInputData(one);
  this->expectError("the geometry has no extent");
}

TEST_F(SnapshotErrors, WrongEnding)
{
  EXPECT_FALSE(this->Snapshot->Write(this->path("a.jpg").c_str()));
  EXPECT_STREQ(this->Snapshot->GetErrorMessage(), "pictures are written as PNG, not as 'a.jpg'");
}

TEST_F(SnapshotErrors, NoFolder)
{
  EXPECT_FALSE(this->Snapshot->Write("/no/such/folder/a.png"));
  EXPECT_STREQ(this->Snapshot->GetErrorMessage(), "there is no folder '/no/such/folder'");
}

TEST_F(SnapshotErrors, FolderThatCannotBeWrittenTo)
{
  // root may write anywhere but into /proc
  const std::string target = geteuid() == 0 ? "/proc/a.png" : this->path("a.png");
  if (geteuid() != 0)
    fs::permissions(this->Folder, fs::perms::owner_read | fs::perms::owner_exec);
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  EXPECT_FALSE(this->Snapshot->Write(target.c_str()));
  EXPECT_NE(std::string(this->Snapshot->GetErrorMessage()).find("cannot be written"), std::string::npos)
    << this->Snapshot->GetErrorMessage();
}

TEST_F(SnapshotErrors, NothingIsOverwrittenUnasked)
{
  const std::string target = this->path("a.png");
  std::ofstream(target) << "precious";
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  EXPECT_FALSE(this->Snapshot->Write(target.c_str()));
  EXPECT_EQ(this->Snapshot->GetErrorMessage(), "'" + target + "' exists");
  EXPECT_EQ(fs::file_size(target), 8U);
  this->Snapshot->OverwriteOn();
  EXPECT_TRUE(this->Snapshot->Write(target.c_str()));
  EXPECT_GT(fs::file_size(target), 1000U);
  EXPECT_STREQ(this->Snapshot->GetErrorMessage(), "");
  EXPECT_EQ(this->filesInFolder(), 1U) << "no temporary file is left";
}

TEST_F(SnapshotErrors, FullDiskLeavesNothing)
{
  // A limit on the size of files stands for a full disk: write() fails half-way.
  const std::string target = this->path("a.png");
  std::ofstream(target) << "precious";
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->OverwriteOn();
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 2000;
  setrlimit(RLIMIT_FSIZE, &small);
  const bool written = this->Snapshot->Write(target.c_str());
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(written);
  EXPECT_EQ(this->Snapshot->GetErrorMessage(), "'" + target + "' cannot be written: File too large");
  EXPECT_EQ(fs::file_size(target), 8U) << "the old file stays";
  EXPECT_EQ(this->filesInFolder(), 1U);
}

TEST_F(SnapshotErrors, ProvenanceTravelsInThePicture)
{
  samples::addStrings(this->Image, "provenance", { "{\"version\":\"0.1.0\"}" });
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  const std::string target = this->path("a.png");
  ASSERT_TRUE(this->Snapshot->Write(target.c_str())) << this->Snapshot->GetErrorMessage();
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(target.c_str());
  reader->Update();
  ASSERT_EQ(reader->GetNumberOfTextChunks(), 1U);
  EXPECT_STREQ(reader->GetTextKey(0), "provenance");
  EXPECT_STREQ(reader->GetTextValue(0), "{\"version\":\"0.1.0\"}");
}
