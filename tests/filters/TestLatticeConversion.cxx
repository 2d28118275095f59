// Between the numerics' structs and VTK's images: nothing copied, nothing lost.
#include "VtkTesting.h"

#include "core/Error.h"

#include "vtkCellData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLImageDataWriter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace
{

using namespace lamella;

PhaseImage threeByTwo()
{
  return PhaseImage{ makeLattice(3, 2, 1, 2, 5e-7), { 0, 1, 1, 1, 0, 0 }, PhaseTable({ "lumen", "wall" }) };
}

TEST(LatticeConversion, ImageTakesOverTheVector)
{
  PhaseImage image = threeByTwo();
  const void* const before = image.phase.data();
  const auto data = toImageData(std::move(image));
  auto* const array = vtkUnsignedCharArray::SafeDownCast(vtktest::points(data, "phase"));
  ASSERT_NE(array, nullptr);
  EXPECT_EQ(array->GetPointer(0), before); // no copy
  EXPECT_EQ(viewPhases(data).phase.data(), before);
}

TEST(LatticeConversion, MemoryLivesAsLongAsTheLastArrayThatSharesIt)
{
  vtkNew<vtkUnsignedCharArray> shared;
  {
    const auto first = adopt({ 7, 8, 9 }, "phase");
    shared->ShallowCopy(first);
  }
  EXPECT_EQ(shared->GetValue(0), 7);
  EXPECT_EQ(shared->GetValue(2), 9);
  shared->InsertNextValue(10); // grows: the old memory must be left properly
  EXPECT_EQ(shared->GetValue(2), 9);
  EXPECT_EQ(shared->GetValue(3), 10);
}

TEST(LatticeConversion, RoundTrip)
{
  const PhaseImage before = threeByTwo();
  const PhaseImage after = toPhaseImage(toImageData(before));
  EXPECT_EQ(after.phase, before.phase);
  EXPECT_EQ(after.phases.names(), before.phases.names());
  EXPECT_EQ(after.lattice.size, before.lattice.size);
  EXPECT_EQ(after.lattice.dimension, 2);
  EXPECT_DOUBLE_EQ(after.lattice.spacing, 5e-7);
  EXPECT_DOUBLE_EQ(after.lattice.origin[0], 2.5e-7); // half a spacing from the edge
}

TEST(LatticeConversion, FilesKeepUnitsTextsAndNumbers)
{
  const auto data = toImageData(threeByTwo());
  setProvenance(data, R"({"program":"lamella"})");
  const std::array<double, 3> numbers{ 1.5, std::nan(""), -2 };
  setFieldNumbers(data, "effective_conductivity", numbers);
  describe(vtktest::points(data, "phase"), "1", "phase of the node", "a test");
  const std::string file = (std::filesystem::temp_directory_path() / "lamella-conversion.vti").string();
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(data);
  writer->SetFileName(file.c_str());
  ASSERT_EQ(writer->Write(), 1);
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  std::filesystem::remove(file);

  vtkImageData* const read = reader->GetOutput();
  EXPECT_EQ(provenance(read), R"({"program":"lamella"})");
  EXPECT_EQ(phaseNames(read).names(), (std::vector<std::string>{ "lumen", "wall" }));
  const auto back = fieldNumbers(read, "effective_conductivity");
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back[0], 1.5);
  EXPECT_TRUE(std::isnan(back[1]));
  const auto texts = description(vtktest::points(read, "phase"));
  EXPECT_EQ(texts[0], "1");
  EXPECT_EQ(texts[1], "phase of the node");
  EXPECT_EQ(texts[2], "a test");
}

TEST(LatticeConversion, NamesThatAreMissingAreNumbers)
{
  const auto data = toImageData(threeByTwo());
  data->GetFieldData()->RemoveArray("phase_names");
  EXPECT_EQ(viewPhases(data).phases.names(), (std::vector<std::string>{ "0", "1" }));
}

TEST(LatticeConversion, RefusesWhatIsNoLattice)
{
  const auto data = toImageData(threeByTwo());
  EXPECT_THROW((void)viewPhases(data, "grain"), InputError);
  data->GetCellData()->AddArray(adopt({ 1, 1 }, "grain"));
  try
  {
    (void)viewPhases(data, "grain");
    FAIL() << "cell data was taken for points";
  }
  catch (const InputError& error)
  {
    EXPECT_NE(std::string(error.what()).find("cell data"), std::string::npos) << error.what();
  }
  data->SetSpacing(1, 2, 1);
  EXPECT_THROW((void)latticeOf(data), InputError);
  data->SetSpacing(1, 1, 2); // one layer along z: its spacing does not matter
  EXPECT_NO_THROW((void)latticeOf(data));
}

} // namespace
