#include "vtkVTKHDFWriter.h"

#include "../TemporaryFolder.h"
#include "CellConversion.h"
#include "NewArray.h"
#include "VtkTesting.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkErrorCode.h"
#include "vtkFloatArray.h"
#include "vtkHDFReader.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <array>
#include <unistd.h>

#include <cstring>
#include <numeric>

// VTKHDF 1.0 read back by VTK's own reader: every bit is the same.
namespace lamella
{
namespace
{

using lamella::testing::TemporaryFolder;
using vtktest::errorOf;

/// Values that no two places share.
template <typename Array>
vtkSmartPointer<Array> counted(const char* name, int components, vtkIdType tuples)
{
  const auto array = newArray<Array>(name, components, static_cast<std::size_t>(tuples));
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
    array->SetValue(i, static_cast<typename Array::ValueType>(i * 1.37 + 1));
  return array;
}

vtkSmartPointer<vtkImageData> sample(int nx, int ny, int nz)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(2, 1 + nx, 0, ny - 1, 3, 2 + nz);
  image->SetSpacing(1e-6, 2e-6, 3e-6);
  image->SetOrigin(0.1, 1.0 / 3, -7);
  image->GetPointData()->AddArray(counted<vtkDoubleArray>("stress", 6, image->GetNumberOfPoints()));
  image->GetPointData()->SetScalars(counted<vtkUnsignedCharArray>("phase", 1, image->GetNumberOfPoints()));
  describe(image->GetPointData()->GetArray("stress"), "Pa", "of the node", "a test");
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "cell wall" });
  setFieldNumbers(image, "strain", std::vector<double>{ 0.1, 1.0 / 3 });
  return image;
}

bool sameBits(vtkDataArray* a, vtkDataArray* b)
{
  return a != nullptr && b != nullptr && a->GetDataType() == b->GetDataType() &&
    a->GetNumberOfComponents() == b->GetNumberOfComponents() && a->GetNumberOfTuples() == b->GetNumberOfTuples() &&
    std::memcmp(a->GetVoidPointer(0), b->GetVoidPointer(0),
      static_cast<std::size_t>(a->GetNumberOfValues() * a->GetDataTypeSize())) == 0;
}

std::string write(vtkDataObject* data, const std::string& file)
{
  vtkNew<vtkVTKHDFWriter> writer;
  writer->SetInputDataObject(data);
  writer->SetFileName(file.c_str());
  return errorOf(writer);
}

vtkSmartPointer<vtkDataSet> read(const std::string& file)
{
  vtkNew<vtkHDFReader> reader;
  reader->SetFileName(file.c_str());
  EXPECT_EQ(reader->CanReadFile(file.c_str()), 1);
  EXPECT_EQ(errorOf(reader), "");
  return reader->GetOutputAsDataSet();
}

void expectSameImage(vtkImageData* image, vtkDataSet* readBack)
{
  auto* const back = vtkImageData::SafeDownCast(readBack);
  ASSERT_NE(back, nullptr);
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_EQ(back->GetDimensions()[i], image->GetDimensions()[i]);
    EXPECT_EQ(back->GetSpacing()[i], image->GetSpacing()[i]);
    EXPECT_EQ(back->GetPoint(0)[i], image->GetPoint(0)[i]);
  }
  for (const char* const name : { "stress", "phase" })
    EXPECT_TRUE(sameBits(back->GetPointData()->GetArray(name), image->GetPointData()->GetArray(name))) << name;
}

TEST(VTKHDFWriter, KeepsAnImage)
{
  const TemporaryFolder folder;
  const auto image = sample(5, 4, 3);
  const std::string file = (folder / "a.hdf").string();
  ASSERT_EQ(write(image, file), "");
  expectSameImage(image, read(file));
}

TEST(VTKHDFWriter, KeepsTheValuesAndPlacesOfFlatImages)
{
  const TemporaryFolder folder;
  const double turned[] = { 0, -1, 0, 0.6, 0, 0.8, -0.8, 0, 0.6 };
  for (const bool turn : { false, true })
  {
    for (const auto& image : { sample(5, 4, 1), sample(5, 1, 4), sample(1, 5, 4) })
    {
      if (turn)
        image->SetDirectionMatrix(turned);
      const std::string file = (folder / "a.hdf").string();
      ASSERT_EQ(write(image, file), "");
      const auto back = read(file);
      ASSERT_EQ(back->GetNumberOfPoints(), image->GetNumberOfPoints());
      for (const char* const name : { "stress", "phase" })
        EXPECT_TRUE(sameBits(back->GetPointData()->GetArray(name), image->GetPointData()->GetArray(name))) << name;
      // VTK 9.2's reader sets the direction, and the places follow in a copy only.
      vtkNew<vtkImageData> flat;
      flat->ShallowCopy(back);
      for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          // Sums of four numbers up to 7, rounded in another order.
          EXPECT_NEAR(flat->GetPoint(i)[axis], image->GetPoint(i)[axis], 7 * 8 * 2.3e-16);
        }
      }
      EXPECT_EQ(flat->GetDimensions()[0], 1) << "the axis of one point comes first";
      EXPECT_NEAR(flat->GetDirectionMatrix()->Determinant(), 1, 1e-15) << "right-handed";
    }
  }
}

/// Makes what it is asked for and nothing else, and keeps how much that was.
class Layers : public vtkImageAlgorithm
{
public:
  static Layers* New();
  vtkTypeMacro(Layers, vtkImageAlgorithm);
  vtkSmartPointer<vtkImageData> Image;
  int Most = 0;
  int Runs = 0;

protected:
  Layers() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* const out = outputs->GetInformationObject(0);
    out->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), this->Image->GetExtent(), 6);
    out->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* const out = outputs->GetInformationObject(0);
    int extent[6];
    out->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
    vtkImageData* const part = vtkImageData::GetData(out);
    part->ShallowCopy(this->Image);
    part->Crop(extent);
    this->Most = std::max(this->Most, extent[5] - extent[4] + 1);
    ++this->Runs;
    return 1;
  }
};
vtkStandardNewMacro(Layers);

TEST(VTKHDFWriter, AsksForSlabs)
{
  const TemporaryFolder folder;
  vtkNew<Layers> source;
  source->Image = sample(6, 5, 40);
  const std::string file = (folder / "a.hdf").string();
  vtkNew<vtkVTKHDFWriter> writer;
  writer->SetInputConnection(source->GetOutputPort());
  writer->SetFileName(file.c_str());
  writer->SetSlabBytes(8 * 1024);
  EXPECT_EQ(writer->Write(), 1);
  EXPECT_GT(source->Runs, 4);
  EXPECT_LT(source->Most, 12);
  expectSameImage(source->Image, read(file));
}

vtkSmartPointer<vtkPolyData> cellsOfAllKinds()
{
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  const auto points = newPoints(7);
  for (vtkIdType i = 0; i < 7; ++i)
    points->SetPoint(i, 0.1 * static_cast<double>(i), static_cast<double>(i * i), 1.0 / 3);
  poly->SetPoints(points);
  vtkNew<vtkCellArray> vertices, lines, polygons;
  vertices->InsertNextCell({ 4 });
  lines->InsertNextCell({ 0, 1 });
  lines->InsertNextCell({ 1, 2, 3 });
  polygons->InsertNextCell({ 0, 1, 2 });
  polygons->InsertNextCell({ 2, 3, 4, 5, 6 });
  poly->SetVerts(vertices);
  poly->SetLines(lines);
  poly->SetPolys(polygons);
  poly->GetPointData()->AddArray(counted<vtkFloatArray>("radius", 1, 7));
  poly->GetCellData()->AddArray(counted<vtkIntArray>("lumen", 1, 5));
  return poly;
}

TEST(VTKHDFWriter, KeepsCellsOfPolyData)
{
  const TemporaryFolder folder;
  const auto poly = cellsOfAllKinds();
  setFieldTexts(poly, "phase_names", std::vector<std::string>{ "void", "cell wall" });
  setFieldNumbers(poly, "strain", std::vector<double>{ 0.1, 1.0 / 3 });
  const std::string file = (folder / "a.hdf").string();
  ASSERT_EQ(write(poly, file), "");
  const auto readBack = read(file);
  auto* const grid = vtkUnstructuredGrid::SafeDownCast(readBack);
  ASSERT_NE(grid, nullptr);
  EXPECT_TRUE(sameBits(grid->GetPoints()->GetData(), poly->GetPoints()->GetData()));
  EXPECT_EQ(fieldTexts(grid, "phase_names"), fieldTexts(poly, "phase_names"));
  EXPECT_EQ(fieldNumbers(grid, "strain"), fieldNumbers(poly, "strain"));
  const auto back = toPolyData(grid);
  ASSERT_EQ(back->GetNumberOfCells(), poly->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < poly->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> a, b;
    back->GetCellPoints(cell, a);
    poly->GetCellPoints(cell, b);
    EXPECT_TRUE(std::equal(a->begin(), a->end(), b->begin(), b->end())) << cell;
  }
  EXPECT_TRUE(sameBits(back->GetPointData()->GetArray("radius"), poly->GetPointData()->GetArray("radius")));
  EXPECT_TRUE(sameBits(back->GetCellData()->GetArray("lumen"), poly->GetCellData()->GetArray("lumen")));
}

TEST(VTKHDFWriter, KeepsPointsWithoutCells)
{
  const TemporaryFolder folder;
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(cellsOfAllKinds()->GetPoints());
  const std::string file = (folder / "a.hdf").string();
  ASSERT_EQ(write(grid, file), "");
  EXPECT_EQ(read(file)->GetNumberOfPoints(), 7);
}

TEST(VTKHDFWriter, RefusesWhatTheFormatCannotHold)
{
  const TemporaryFolder folder;
  const std::string file = (folder / "a.hdf").string();
  const auto image = sample(3, 3, 3);
  image->GetPointData()->GetArray("phase")->SetName("wall/lumen");
  EXPECT_NE(write(image, file).find("'wall/lumen', which HDF5 cannot store"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file)) << "nothing half-written is left";
  EXPECT_NE(write(sample(3, 1, 1), file).find("a single line of points"), std::string::npos); // the reader would crash
  const auto cells = sample(3, 3, 3);
  cells->GetCellData()->AddArray(counted<vtkUnsignedShortArray>("grain", 1, cells->GetNumberOfCells()));
  EXPECT_NE(write(cells, file).find("an array in cells, 'grain'"), std::string::npos);
  const auto poly = cellsOfAllKinds();
  vtkNew<vtkStringArray> texts;
  texts->SetName("words");
  texts->SetNumberOfValues(7);
  poly->GetPointData()->AddArray(texts);
  EXPECT_NE(write(poly, file).find("'words' holds texts"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file));
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(poly->GetPoints());
  const std::array<vtkIdType, 4> points{ 0, 1, 2, 3 };
  const std::array<vtkIdType, 16> faces{ 3, 0, 1, 2, 3, 0, 1, 3, 3, 0, 2, 3, 3, 1, 2, 3 };
  grid->InsertNextCell(VTK_POLYHEDRON, 4, points.data(), 4, faces.data());
  EXPECT_NE(write(grid, file).find("polyhedra"), std::string::npos);
  // What was there before stays.
  ASSERT_EQ(write(sample(3, 3, 3), file), "");
  EXPECT_NE(write(grid, file).find("polyhedra"), std::string::npos);
  EXPECT_NE(write(image, file).find("'wall/lumen'"), std::string::npos);
  EXPECT_EQ(read(file)->GetNumberOfPoints(), 27);
  EXPECT_FALSE(std::filesystem::exists(file + ".part"));
}

TEST(VTKHDFWriter, SaysWhereNothingCanBeWritten)
{
  vtkNew<vtkVTKHDFWriter> writer;
  writer->SetInputData(sample(3, 3, 3));
  EXPECT_NE(errorOf(writer).find("no file is named"), std::string::npos);
  EXPECT_EQ(writer->GetErrorCode(), static_cast<unsigned long>(vtkErrorCode::NoFileNameError));
  writer->SetFileName("/proc/a.hdf");
  EXPECT_NE(errorOf(writer), "");
  EXPECT_EQ(writer->GetErrorCode(), static_cast<unsigned long>(vtkErrorCode::CannotOpenFileError));
}

TEST(CellConversion, RefusesSolids)
{
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(cellsOfAllKinds()->GetPoints());
  const vtkIdType ids[] = { 0, 1, 2, 3 };
  grid->InsertNextCell(VTK_TETRA, 4, ids);
  try
  {
    (void)toPolyData(grid);
    FAIL();
  }
  catch (const InputError& error)
  {
    EXPECT_EQ(std::string(error.what()), "1 of 1 cells are no vertices, lines or polygons (vtkTetra)");
  }
}

} // namespace
} // namespace lamella
