#include "vtkVTKHDFWriter.h"

#include "Attempt.h"
#include "CellConversion.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "core/PartFile.h"
#include "io/Hdf5.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string>
#include <vector>

using lamella::io::hdf5::good;
using lamella::io::hdf5::Handle;
using lamella::io::hdf5::Quiet;
using lamella::io::hdf5::writeText;

namespace
{

using Shape = std::vector<hsize_t>;

hid_t nativeType(int type, const std::string& name)
{
  switch (type)
  {
    case VTK_CHAR:
      return H5T_NATIVE_CHAR;
    case VTK_SIGNED_CHAR:
      return H5T_NATIVE_SCHAR;
    case VTK_UNSIGNED_CHAR:
      return H5T_NATIVE_UCHAR;
    case VTK_SHORT:
      return H5T_NATIVE_SHORT;
    case VTK_UNSIGNED_SHORT:
      return H5T_NATIVE_USHORT;
    case VTK_INT:
      return H5T_NATIVE_INT;
    case VTK_UNSIGNED_INT:
      return H5T_NATIVE_UINT;
    case VTK_LONG:
    case VTK_LONG_LONG:
    case VTK_ID_TYPE:
      return H5T_NATIVE_LONG;
    case VTK_UNSIGNED_LONG:
    case VTK_UNSIGNED_LONG_LONG:
      return H5T_NATIVE_ULONG;
    case VTK_FLOAT:
      return H5T_NATIVE_FLOAT;
    case VTK_DOUBLE:
      return H5T_NATIVE_DOUBLE;
    default:
      throw lamella::InputError(
        "the array '" + name + "' is of a type that VTKHDF cannot hold", "leave it out, or make numbers of it");
  }
}

template <typename Value>
void writeNumbers(hid_t at, const char* name, hid_t type, const std::vector<Value>& values)
{
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle attribute(H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  good(H5Awrite(attribute, type, values.data()));
}

/// A text of the format itself: ASCII and of fixed length, as the reader wants it.
void writeAscii(hid_t at, const char* name, const std::string& text)
{
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  good(H5Tset_size(type, text.size()));
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  good(H5Awrite(attribute, type, text.c_str()));
}

Handle newGroup(hid_t at, const char* name)
{
  return { H5Gcreate2(at, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose };
}

/// A dataset that is filled later, in chunks of whole layers (images) or rows.
Handle newSet(hid_t at, const std::string& name, hid_t type, const Shape& shape, int level, const Shape& chunk = {})
{
  if (name.empty() || name == "." || name.find('/') != std::string::npos)
  {
    throw lamella::InputError(
      "an array is called '" + name + "', which HDF5 cannot store", "give it a name without a slash");
  }
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const bool empty = std::find(shape.begin(), shape.end(), hsize_t{ 0 }) != shape.end();
  if (level > 0 && !empty)
  {
    Shape part = chunk;
    if (part.empty()) // a table of rows: about 256 kB
    {
      part = shape;
      const hsize_t row =
        std::accumulate(shape.begin() + 1, shape.end(), hsize_t{ H5Tget_size(type) }, std::multiplies<>());
      part[0] = std::clamp((hsize_t{ 1 } << 18) / row, hsize_t{ 1 }, shape[0]);
    }
    good(H5Pset_chunk(create, static_cast<int>(part.size()), part.data()));
    good(H5Pset_shuffle(create));
    good(H5Pset_deflate(create, static_cast<unsigned>(level)));
  }
  return { H5Dcreate2(at, name.c_str(), type, space, H5P_DEFAULT, create, H5P_DEFAULT), H5Dclose };
}

void writeAll(hid_t at, const std::string& name, hid_t type, const Shape& shape, const void* values, int level)
{
  Handle set = newSet(at, name, type, shape, level);
  if (std::find(shape.begin(), shape.end(), hsize_t{ 0 }) == shape.end())
    good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
}

std::string nameOf(vtkAbstractArray* array)
{
  return array->GetName() == nullptr ? "" : array->GetName();
}

void writeDescription(hid_t set, vtkDataArray* array)
{
  const auto [unit, text, creator] = lamella::description(array);
  for (const auto& [key, value] : { std::pair{ "unit", unit }, { "description", text }, { "creator", creator } })
    if (!value.empty())
      writeText(set, key, value);
}

/// Which arrays are the active ones.
void writeRoles(hid_t group, vtkDataSetAttributes* data)
{
  constexpr std::array<std::pair<int, const char*>, 6> roles{ { { vtkDataSetAttributes::SCALARS, "Scalars" },
    { vtkDataSetAttributes::VECTORS, "Vectors" }, { vtkDataSetAttributes::NORMALS, "Normals" },
    { vtkDataSetAttributes::TENSORS, "Tensors" }, { vtkDataSetAttributes::TCOORDS, "TCoords" },
    { vtkDataSetAttributes::GLOBALIDS, "GlobalIds" } } };
  for (const auto& [role, word] : roles)
    if (vtkAbstractArray* const array = data->GetAbstractAttribute(role); array != nullptr && !nameOf(array).empty())
      writeAscii(group, word, nameOf(array));
}

/// The arrays of points or of cells. @throws InputError for one that is no numbers
std::vector<vtkDataArray*> arraysOf(vtkDataSetAttributes* data)
{
  std::vector<vtkDataArray*> arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = data->GetAbstractArray(i);
    arrays.push_back(vtkDataArray::SafeDownCast(array));
    if (arrays.back() == nullptr)
    {
      throw lamella::InputError(
        "the array '" + nameOf(array) + "' holds texts, which VTKHDF has only in field data", "leave it out");
    }
  }
  return arrays;
}

void writeField(hid_t root, vtkFieldData* data)
{
  const Handle group = newGroup(root, "FieldData");
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = data->GetAbstractArray(i);
    if (auto* const texts = vtkStringArray::SafeDownCast(array))
    {
      const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
      good(H5Tset_size(type, H5T_VARIABLE));
      std::vector<const char*> lines;
      for (vtkIdType k = 0; k < texts->GetNumberOfValues(); ++k)
        lines.push_back(texts->GetValue(k).c_str());
      writeAll(group, nameOf(array), type, { lines.size() }, lines.data(), 0);
    }
    else if (auto* const numbers = vtkDataArray::SafeDownCast(array))
    {
      Shape shape{ static_cast<hsize_t>(numbers->GetNumberOfTuples()) };
      if (numbers->GetNumberOfComponents() != 1)
        shape.push_back(static_cast<hsize_t>(numbers->GetNumberOfComponents()));
      const hid_t type = nativeType(numbers->GetDataType(), nameOf(array));
      Handle set = newSet(group, nameOf(array), type, shape, 0);
      if (numbers->GetNumberOfValues() > 0)
        good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers->GetVoidPointer(0)));
      writeDescription(set, numbers);
    }
  }
}

/// Rows of a table: an array of points or cells of a grid.
void writeRows(hid_t at, const std::string& name, vtkDataArray* array, int level)
{
  Shape shape{ static_cast<hsize_t>(array->GetNumberOfTuples()) };
  if (array->GetNumberOfComponents() != 1)
    shape.push_back(static_cast<hsize_t>(array->GetNumberOfComponents()));
  const hid_t type = nativeType(array->GetDataType(), name);
  Handle set = newSet(at, name, type, shape, level);
  if (array->GetNumberOfValues() > 0)
    good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, array->GetVoidPointer(0)));
  writeDescription(set, array);
}

void writeGrid(hid_t root, vtkUnstructuredGrid* grid, int level)
{
  bool polyhedra = false;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells() && !polyhedra; ++cell)
    polyhedra = grid->GetCellType(cell) == VTK_POLYHEDRON;
  if (polyhedra)
  {
    throw lamella::InputError(
      "the grid has polyhedra, and VTKHDF 1.0 has no place for their faces", "write it as .vtu, or in tetrahedra");
  }
  const auto one = [&](const char* name, vtkIdType value) { writeAll(root, name, H5T_NATIVE_LONG, { 1 }, &value, 0); };
  vtkCellArray* const cells = grid->GetCells();
  vtkNew<vtkIdTypeArray> offsets; // always of 64 bits here, whatever the cells are kept in
  vtkNew<vtkIdTypeArray> ids;
  offsets->InsertNextValue(0);
  if (cells != nullptr)
  {
    offsets->DeepCopy(cells->GetOffsetsArray());
    ids->DeepCopy(cells->GetConnectivityArray());
  }
  one("NumberOfPoints", grid->GetNumberOfPoints());
  one("NumberOfCells", grid->GetNumberOfCells());
  one("NumberOfConnectivityIds", ids->GetNumberOfValues());
  if (grid->GetPoints() != nullptr)
    writeRows(root, "Points", grid->GetPoints()->GetData(), level);
  else
    writeAll(root, "Points", H5T_NATIVE_FLOAT, { 0, 3 }, nullptr, 0);
  writeRows(root, "Offsets", offsets, level);
  writeRows(root, "Connectivity", ids, level);
  vtkNew<vtkUnsignedCharArray> types; // cell by cell: VTK 9.6 keeps them otherwise
  types->SetNumberOfValues(grid->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
    types->SetValue(cell, static_cast<unsigned char>(grid->GetCellType(cell)));
  writeRows(root, "Types", types, level);
  for (const auto& [name, data] : { std::pair<const char*, vtkDataSetAttributes*>{ "PointData", grid->GetPointData() },
         { "CellData", grid->GetCellData() } })
  {
    const Handle group = newGroup(root, name);
    for (vtkDataArray* const array : arraysOf(data))
      writeRows(group, nameOf(array), array, level);
    writeRoles(group, data);
  }
}

/// Points of an image along x, y and z.
std::array<hsize_t, 3> countsOf(const std::array<int, 6>& extent)
{
  std::array<hsize_t, 3> counts{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<hsize_t>(extent[2 * axis + 1] - extent[2 * axis] + 1);
  return counts;
}

/// Which axis of the image each axis of the file is, x first.
using Axes = std::array<std::size_t, 3>;

/// VTK 9.2's reader writes beyond its memory where there is one point along y or z, and not where there is one along
/// x: the axis of one point comes first. Values stay in their order.
/// @throws lamella::InputError for a single line of points
Axes axesOf(const std::array<hsize_t, 3>& counts)
{
  Axes axes{ 0, 1, 2 };
  if (counts[2] == 1)
    axes = { 2, 0, 1 };
  else if (counts[1] == 1)
    axes = { 1, 0, 2 };
  if (counts[axes[1]] == 1 || counts[axes[2]] == 1)
  {
    throw lamella::InputError(
      "the image is a single line of points, on which VTK 9.2's reader of VTKHDF crashes", "write it as .vti");
  }
  return axes;
}

/// As HDF5 counts: the last axis first, components last.
Shape shapeOf(const std::array<hsize_t, 3>& xyz, const Axes& axes, int components)
{
  Shape shape{ xyz[axes[2]], xyz[axes[1]], xyz[axes[0]] };
  if (components != 1)
    shape.push_back(static_cast<hsize_t>(components));
  return shape;
}

/// Columns that point along the file's axes. A swap of two turns the one of one point round, and hands stay hands.
std::vector<double> directionOf(const double* columns, const Axes& axes)
{
  std::vector<double> turned(9);
  for (std::size_t row = 0; row < 3; ++row)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const double value = columns[3 * row + axes[axis]];
      turned[3 * row + axis] = axis == 0 && axes[0] == 1 && value != 0 ? -value : value;
    }
  }
  return turned;
}

} // namespace

/// A file that is being written.
struct vtkVTKHDFWriter::File
{
  explicit File(const char* name)
    : Name(name)
    , Part(Name)
    , Id(H5Fcreate(Part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose)
    , Root(newGroup(Id, "VTKHDF"))
  {
    writeNumbers<long>(this->Root, "Version", H5T_NATIVE_LONG, { 1, 0 });
  }

  /// Whole, it gets its name.
  bool Close()
  {
    this->Sets.clear();
    return this->Root.finish() && this->Id.finish() && this->Part.take(this->Name) == 0;
  }

  /// Makes the datasets of an image; their values come with the slabs.
  void BeginImage(vtkImageData* image, const std::array<int, 6>& whole, int level);
  /// Layers [first, last] of points, which `image` holds.
  void WriteLayers(vtkImageData* image, int first, int last);

  std::string Name;
  lamella::PartFile Part; ///< beside it, until it is whole: what had the name stays where nothing comes of this
  Handle Id;
  Handle Root;
  std::array<int, 6> Whole{};
  Axes Order{ 0, 1, 2 };
  int Next = 0;                       ///< the first layer of points that is not written yet
  int Depth = 1;                      ///< layers a slab
  std::map<std::string, Handle> Sets; ///< by name
};

void vtkVTKHDFWriter::File::BeginImage(vtkImageData* image, const std::array<int, 6>& whole, int level)
{
  writeAscii(this->Root, "Type", "ImageData");
  const auto counts = countsOf(whole);
  this->Order = axesOf(counts);
  // From 0: VTK 9.2's reader takes the extent for places in the dataset.
  std::array<double, 3> first{};
  image->TransformIndexToPhysicalPoint(whole[0], whole[2], whole[4], first.data());
  std::vector<int> extent;
  std::vector<double> spacing;
  for (const std::size_t axis : this->Order)
  {
    extent.insert(extent.end(), { 0, whole[2 * axis + 1] - whole[2 * axis] });
    spacing.push_back(image->GetSpacing()[axis]);
  }
  writeNumbers<int>(this->Root, "WholeExtent", H5T_NATIVE_INT, extent);
  writeNumbers<double>(this->Root, "Origin", H5T_NATIVE_DOUBLE, { first.begin(), first.end() });
  writeNumbers<double>(this->Root, "Spacing", H5T_NATIVE_DOUBLE, spacing);
  writeNumbers<double>(
    this->Root, "Direction", H5T_NATIVE_DOUBLE, directionOf(image->GetDirectionMatrix()->GetData(), this->Order));
  if (this->Order[0] != 0)
    writeNumbers<int>(this->Root, "axes", H5T_NATIVE_INT, { this->Order.begin(), this->Order.end() });
  this->Whole = whole;
  this->Next = whole[4];
  if (vtkCellData* const cells = image->GetCellData(); cells->GetNumberOfArrays() > 0)
  {
    throw lamella::InputError("the image has an array in cells, '" + nameOf(cells->GetAbstractArray(0)) +
        "', which VTK 9.2's reader of VTKHDF takes for one at points",
      "make points of the cells (vtkCellDataToPointData), or write .vti");
  }
  const Handle group = newGroup(this->Root, "PointData");
  for (vtkDataArray* const array : arraysOf(image->GetPointData()))
  {
    const hid_t type = nativeType(array->GetDataType(), nameOf(array));
    const int components = array->GetNumberOfComponents();
    // About 1 MB at most, which is what HDF5 keeps of a dataset in memory.
    const hsize_t row = counts[0] * static_cast<hsize_t>(components) * H5Tget_size(type);
    std::array<hsize_t, 3> chunk{ counts[0], 1, 1 };
    const std::size_t stacked = counts[1] > 1 ? 1 : 2;
    chunk[stacked] = std::clamp((hsize_t{ 1 } << 20) / row, hsize_t{ 1 }, counts[stacked]);
    Handle set = newSet(group, nameOf(array), type, shapeOf(counts, this->Order, components), level,
      shapeOf(chunk, this->Order, components));
    writeDescription(set, array);
    this->Sets.emplace(nameOf(array), std::move(set));
  }
  writeRoles(group, image->GetPointData());
  // Not in the group of the format: VTK 9.2's reader would take them for values of the image and give up.
  writeField(this->Id, image->GetFieldData());
}

void vtkVTKHDFWriter::File::WriteLayers(vtkImageData* image, int first, int last)
{
  std::array<int, 6> held{};
  image->GetExtent(held.data());
  const auto counts = countsOf(this->Whole);
  for (auto& [name, set] : this->Sets)
  {
    vtkDataArray* const array = image->GetPointData()->GetArray(name.c_str());
    if (array == nullptr)
      throw lamella::InputError("the array '" + name + "' is missing in a part of the image", "look at what made it");
    const int components = array->GetNumberOfComponents();
    Shape start = shapeOf({ 0, 0, static_cast<hsize_t>(first - this->Whole[4]) }, this->Order, components);
    start.back() = components != 1 ? 0 : start.back();
    const Shape size =
      shapeOf({ counts[0], counts[1], static_cast<hsize_t>(last - first + 1) }, this->Order, components);
    const vtkIdType layer = static_cast<vtkIdType>(counts[0] * counts[1]) * array->GetNumberOfComponents();
    const vtkIdType offset = layer * (first - held[4]);
    if (offset < 0 || offset + layer * (last - first + 1) > array->GetNumberOfValues())
      throw lamella::InputError("the image does not hold the layers that it was asked for", "look at what made it");
    const Handle file(H5Dget_space(set), H5Sclose);
    good(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr));
    const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
    good(
      H5Dwrite(set, nativeType(array->GetDataType(), name), memory, file, H5P_DEFAULT, array->GetVoidPointer(offset)));
  }
  this->Next = last + 1;
}

vtkStandardNewMacro(vtkVTKHDFWriter);
vtkPrintSettingsMacro(vtkVTKHDFWriter);

vtkVTKHDFWriter::vtkVTKHDFWriter() = default;

vtkVTKHDFWriter::~vtkVTKHDFWriter()
{
  this->Discard();
  this->SetFileName(nullptr);
}

void vtkVTKHDFWriter::Discard()
{
  if (this->Open)
  {
    const Quiet quiet;
    this->Open.reset();
  }
}

template <typename Action>
void vtkVTKHDFWriter::Coded(const Action& action)
try
{
  action();
}
catch (const lamella::InputError&)
{
  if (this->GetErrorCode() != vtkErrorCode::NoFileNameError)
    this->SetErrorCode(vtkErrorCode::FileFormatError);
  throw;
}

int vtkVTKHDFWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

vtkTypeBool vtkVTKHDFWriter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  if (request->Has(Pipeline::REQUEST_UPDATE_EXTENT()) != 0)
  {
    vtkInformation* const input = inputVector[0]->GetInformationObject(0);
    if (vtkImageData::GetData(input) != nullptr && input->Has(Pipeline::WHOLE_EXTENT()) != 0)
    {
      std::array<int, 6> extent{};
      input->Get(Pipeline::WHOLE_EXTENT(), extent.data());
      // How thick a slab may be is known once the arrays are: the first one is a layer.
      const int last = extent[5];
      extent[4] = this->Open ? this->Open->Next : extent[4];
      extent[5] = std::min(last, extent[4] + (this->Open ? this->Open->Depth : 1) - 1);
      input->Set(Pipeline::UPDATE_EXTENT(), extent.data(), 6);
    }
    return 1;
  }
  return this->Superclass::ProcessRequest(request, inputVector, outputVector);
}

int vtkVTKHDFWriter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* const input = inputVector[0]->GetInformationObject(0);
  auto* const image = vtkImageData::GetData(input);
  if (image == nullptr)
    return this->Superclass::RequestData(request, inputVector, outputVector);
  const Quiet quiet;
  bool more = false;
  const auto write = [&]
  {
    std::array<int, 6> held{};
    image->GetExtent(held.data());
    if (!this->Open)
    {
      this->SetErrorCode(vtkErrorCode::NoError);
      if (this->FileName == nullptr)
      {
        this->SetErrorCode(vtkErrorCode::NoFileNameError);
        throw lamella::InputError("no file is named", "set FileName");
      }
      std::array<int, 6> whole = held;
      input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
      this->SetErrorCode(vtkErrorCode::CannotOpenFileError);
      this->Open = std::make_unique<File>(this->FileName);
      this->SetErrorCode(vtkErrorCode::OutOfDiskSpaceError); // until it is closed well
      this->Open->BeginImage(image, whole, this->CompressionLevel);
      const vtkIdType layers = held[5] - held[4] + 1;
      this->Open->Depth = static_cast<int>(
        std::clamp(this->SlabBytes * layers / std::max<vtkIdType>(1, vtkIdType{ 1024 } * image->GetActualMemorySize()),
          vtkIdType{ 1 }, vtkIdType{ 1 } << 30));
    }
    const int last = this->Open->Whole[5];
    this->Open->WriteLayers(image, this->Open->Next, std::min(last, held[5]));
    more = this->Open->Next <= last;
    const int layers = last - this->Open->Whole[4] + 1;
    this->UpdateProgress(static_cast<double>(this->Open->Next - this->Open->Whole[4]) / layers);
    if (this->GetAbortExecute() != 0)
      throw lamella::Cancelled();
    if (!more && !this->Open->Close())
      throw lamella::Error(std::string("'") + this->FileName + "' cannot be finished", "make room on the disk");
  };
  const auto outcome = lamella::attempt(this, [&] { this->Coded(write); });
  if (outcome != lamella::Outcome::Done || !more)
  {
    request->Remove(vtkStreamingDemandDrivenPipeline::CONTINUE_EXECUTING());
    if (outcome == lamella::Outcome::Done)
    {
      this->Open.reset();
      this->SetErrorCode(vtkErrorCode::NoError);
      this->WriteTime.Modified();
    }
    this->Discard();
    return outcome == lamella::Outcome::Done ? 1 : 0;
  }
  request->Set(vtkStreamingDemandDrivenPipeline::CONTINUE_EXECUTING(), 1);
  return 1;
}

void vtkVTKHDFWriter::WriteData()
{
  const Quiet quiet;
  const auto write = [&]
  {
    if (this->FileName == nullptr)
    {
      this->SetErrorCode(vtkErrorCode::NoFileNameError);
      throw lamella::InputError("no file is named", "set FileName");
    }
    vtkSmartPointer<vtkUnstructuredGrid> grid = vtkUnstructuredGrid::SafeDownCast(this->GetInput());
    if (auto* const poly = vtkPolyData::SafeDownCast(this->GetInput()))
      grid = lamella::toUnstructuredGrid(poly);
    this->SetErrorCode(vtkErrorCode::CannotOpenFileError);
    this->Open = std::make_unique<File>(this->FileName);
    this->SetErrorCode(vtkErrorCode::OutOfDiskSpaceError);
    writeAscii(this->Open->Root, "Type", "UnstructuredGrid");
    writeGrid(this->Open->Root, grid, this->CompressionLevel);
    writeField(this->Open->Root, grid->GetFieldData());
    if (!this->Open->Close())
      throw lamella::Error(std::string("'") + this->FileName + "' cannot be finished", "make room on the disk");
  };
  const auto outcome = lamella::attempt(this, [&] { this->Coded(write); });
  if (outcome == lamella::Outcome::Done)
  {
    this->Open.reset();
    this->SetErrorCode(vtkErrorCode::NoError);
  }
  this->Discard();
}
