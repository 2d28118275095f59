#include "convert/VtkFiles.h"

#include "files/ArrayRanges.h"
#include "files/GridFile.h"

#include "GridChecks.h"
#include "GridReaders.h"
#include "core/Error.h"
#include "core/Plausible.h"
#include "io/Hdf5.h"
#include "io/Survives.h"
#include "vtkLatticeConversion.h"
#include "vtkVTKHDFWriter.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkHDFReader.h>
#include <vtkImageAlgorithm.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>

namespace
{

using lamella::cli::Session;
using lamella::cli::Volume;
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// A volume as the beginning of a pipeline that asks for one slab after the other.
class SlabSource : public vtkImageAlgorithm
{
public:
  static SlabSource* New();
  vtkTypeMacro(SlabSource, vtkImageAlgorithm);

  void Set(Session* session, Volume* volume)
  {
    this->TheSession = session;
    this->TheVolume = volume;
  }
  bool HasFailed() const { return this->Failure != nullptr; }
  /// What went wrong on the way, as it was. @throws it
  void Rethrow() const
  {
    if (this->Failure)
      std::rethrow_exception(this->Failure);
  }

protected:
  SlabSource() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* const out = outputs->GetInformationObject(0);
    vtkImageData* const sample = this->TheVolume->sample();
    out->Set(Pipeline::WHOLE_EXTENT(), this->TheVolume->extent().data(), 6);
    out->Set(vtkDataObject::SPACING(), sample->GetSpacing(), 3);
    out->Set(vtkDataObject::ORIGIN(), sample->GetOrigin(), 3);
    out->Set(vtkDataObject::DIRECTION(), sample->GetDirectionMatrix()->GetData(), 9);
    out->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* const out = outputs->GetInformationObject(0);
    int extent[6];
    out->Get(Pipeline::UPDATE_EXTENT(), extent);
    // A sink that continues would ask for ever where this returned 0 (VTK 9.2): after a failure there are no arrays.
    vtkImageData::GetData(out)->Initialize();
    vtkImageData::GetData(out)->SetExtent(extent);
    if (this->HasFailed())
      return 1;
    try
    {
      Session::checkInterrupt();
      const auto slab = this->TheVolume->read(extent[4], extent[5]);
      lamella::cli::forgetRanges(slab);
      vtkImageData::GetData(out)->ShallowCopy(slab);
      const auto& whole = this->TheVolume->extent();
      this->TheSession->progress(static_cast<double>(extent[5] - whole[4] + 1) / (whole[5] - whole[4] + 1), "writing");
      return 1;
    }
    catch (...)
    {
      this->Failure = std::current_exception();
      return 1;
    }
  }

private:
  Session* TheSession = nullptr;
  Volume* TheVolume = nullptr;
  std::exception_ptr Failure;
};
vtkStandardNewMacro(SlabSource);

/// VTK's writer, with pieces that are slabs of layers: its own would be blocks.
class SlabWriter : public vtkXMLImageDataWriter
{
public:
  static SlabWriter* New();
  vtkTypeMacro(SlabWriter, vtkXMLImageDataWriter);

protected:
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    auto* const source = SlabSource::SafeDownCast(this->GetInputAlgorithm());
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()) != 0 && source != nullptr && source->HasFailed())
    {
      request->Remove(Pipeline::CONTINUE_EXECUTING());
      return 0;
    }
    const vtkTypeBool done = this->Superclass::ProcessRequest(request, inputs, outputs);
    if (request->Has(Pipeline::REQUEST_UPDATE_EXTENT()) != 0 && this->NumberOfPieces > 1)
    {
      vtkInformation* const in = inputs[0]->GetInformationObject(0);
      int extent[6];
      in->Get(Pipeline::WHOLE_EXTENT(), extent);
      // Pieces share a layer of points, as VTK has it: so many cells each.
      const auto cells = static_cast<vtkIdType>(extent[5] - extent[4]);
      const int first = extent[4];
      extent[4] = first + static_cast<int>(cells * this->CurrentPiece / this->NumberOfPieces);
      extent[5] = first + static_cast<int>(cells * (this->CurrentPiece + 1) / this->NumberOfPieces);
      in->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
    }
    return done;
  }
};
vtkStandardNewMacro(SlabWriter);

} // namespace

namespace lamella::cli
{

namespace
{

[[noreturn]] void damaged(const std::string& path, const char* kind)
{
  throw InputError(fmt::format("'{}' is a {} file that is damaged or cut short", path, kind),
    fmt::format("give a whole {} file; make or copy it again", kind));
}

class XmlImage : public Volume
{
public:
  explicit XmlImage(const std::string& path)
    : path_(path)
    , reader_(newImageReader())
  {
    (void)VtkMessages::takeErrors();
    if (reader_->CanReadFile(path.c_str()) == 0)
    {
      (void)VtkMessages::takeErrors();
      throw InputError(
        "'" + path + "' is not a .vti file, or is cut short", "give a whole .vti file; make or copy it again");
    }
    reader_->SetFileName(path.c_str());
    requireReadable(reader_, path);
    reader_->GetOutputInformation(0)->Get(Pipeline::WHOLE_EXTENT(), extent_.data());
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    auto extent = extent_;
    extent[4] = first;
    extent[5] = last;
    update(reader_, path_, extent);
    auto slab = vtkSmartPointer<vtkImageData>::New();
    slab->ShallowCopy(reader_->GetOutput());
    int held[6];
    slab->GetExtent(held);
    if (held[4] > first || held[5] < last)
      damaged(path_, ".vti");
    return held[4] == first && held[5] == last ? slab : wholeVolume(slab)->read(first, last);
  }

private:
  std::string path_;
  vtkSmartPointer<vtkXMLImageDataReader> reader_;
};

/// What vtkVTKHDFWriter notes at the arrays, and VTK's reader passes over.
struct Described
{
  std::string unit, description, creator;
};
using Descriptions = std::map<std::pair<std::string, std::string>, Described>;

/// Does something with each member of a group, where there is such a group.
template <typename Visit>
void forMembers(hid_t root, const std::string& group, const Visit& visit)
{
  namespace hdf5 = io::hdf5;
  if (H5Lexists(root, group.c_str(), H5P_DEFAULT) <= 0)
    return;
  const hdf5::Handle at(H5Gopen2(root, group.c_str(), H5P_DEFAULT), H5Gclose);
  std::vector<std::string> names;
  hdf5::good(H5Literate(
    at, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
    [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t
    {
      static_cast<std::vector<std::string>*>(list)->emplace_back(name);
      return 0;
    },
    &names));
  for (const std::string& name : names)
    visit(static_cast<hid_t>(at), name);
}

/// Reads what stands at the datasets of a group.
void describeGroup(hid_t root, const std::string& group, Descriptions& to)
{
  namespace hdf5 = io::hdf5;
  forMembers(root, group,
    [&](hid_t at, const std::string& name)
    {
      const hdf5::Handle object(H5Oopen(at, name.c_str(), H5P_DEFAULT), H5Oclose);
      const auto text = [&](const char* key)
      { return H5Aexists(object, key) > 0 ? hdf5::readText(object, key) : std::string(); };
      to[{ group, name }] = { text("unit"), text("description"), text("creator") };
    });
}

/// VTK's type of numbers in HDF5; 0 for what is none.
int numberType(hid_t type)
{
  const std::size_t size = H5Tget_size(type);
  if (H5Tget_class(type) == H5T_FLOAT)
    return size == 4 ? VTK_FLOAT : size == 8 ? VTK_DOUBLE : 0;
  if (H5Tget_class(type) != H5T_INTEGER)
    return 0;
  const bool positive = H5Tget_sign(type) == H5T_SGN_NONE;
  switch (size)
  {
    case 1:
      return positive ? VTK_UNSIGNED_CHAR : VTK_SIGNED_CHAR;
    case 2:
      return positive ? VTK_UNSIGNED_SHORT : VTK_SHORT;
    case 4:
      return positive ? VTK_UNSIGNED_INT : VTK_INT;
    case 8:
      return positive ? VTK_UNSIGNED_LONG : VTK_LONG;
    default:
      return 0;
  }
}

/// An array of field data: numbers, or texts of any length.
vtkSmartPointer<vtkAbstractArray> readField(hid_t group, const std::string& name)
{
  namespace hdf5 = io::hdf5;
  const hdf5::Handle set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  const std::size_t count = hdf5::countStored(set);
  const hdf5::Handle stored(H5Dget_type(set), H5Tclose);
  const hdf5::Handle space(H5Dget_space(set), H5Sclose);
  std::array<hsize_t, 2> shape{ 1, 1 };
  const int axes = H5Sget_simple_extent_ndims(space);
  constexpr std::size_t most = std::size_t{ 1 } << 26; // of what describes a grid
  if (axes > 2 || H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0)
    return nullptr;
  hdf5::good(count <= most && (count == 0 || shape[1] <= 9999) ? 0 : -1);
  vtkSmartPointer<vtkAbstractArray> array;
  if (H5Tis_variable_str(stored) > 0)
  {
    vtkNew<vtkStringArray> texts;
    std::vector<char*> lines(shape[0], nullptr);
    hdf5::good(H5Dread(set, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, lines.data()));
    for (const char* const line : lines)
      texts->InsertNextValue(line == nullptr ? "" : line);
    H5Dvlen_reclaim(stored, space, H5P_DEFAULT, lines.data());
    array = texts;
  }
  else if (const int type = numberType(stored); type != 0)
  {
    const hdf5::Handle native(H5Tget_native_type(stored, H5T_DIR_ASCEND), H5Tclose);
    array.TakeReference(vtkAbstractArray::CreateArray(type));
    array->SetNumberOfComponents(static_cast<int>(shape[1]));
    array->SetNumberOfTuples(static_cast<vtkIdType>(shape[0]));
    if (array->GetNumberOfValues() > 0)
      hdf5::good(H5Dread(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, array->GetVoidPointer(0)));
  }
  if (array != nullptr)
    array->SetName(name.c_str());
  return array;
}

struct HdfHeader
{
  std::string type;
  Descriptions described;
  vtkNew<vtkFieldData> fields; ///< in vtkVTKHDFWriter's own group
};

/// @throws InputError
void readHeader(const std::string& path, HdfHeader& header)
{
  namespace hdf5 = io::hdf5;
  const hdf5::Quiet quiet;
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError("'" + path + "' is not an HDF5 file, or is cut short", "make or copy it again");
  try
  {
    const hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (H5Lexists(file, "VTKHDF", H5P_DEFAULT) <= 0)
    {
      throw InputError("'" + path + "' is an HDF5 file, but no VTKHDF: it has no group VTKHDF",
        "only the HDF5 files that ParaView reads as VTKHDF can be read");
    }
    const hdf5::Handle root(H5Gopen2(file, "VTKHDF", H5P_DEFAULT), H5Gclose);
    std::array<std::int64_t, 2> version{};
    const hdf5::Handle attribute(H5Aopen(root, "Version", H5P_DEFAULT), H5Aclose);
    hdf5::readNumbers(attribute, H5T_NATIVE_INT64, version.size(), version.data());
    if (version[0] > 1)
    {
      throw InputError(
        fmt::format("'{}' is VTKHDF {}.{}, and versions up to 1 can be read", path, version[0], version[1]),
        "save it as .vti, .vtp or .vtu with the program that wrote it");
    }
    header.type = hdf5::readText(root, "Type");
    for (const char* const group : { "PointData", "CellData", "FieldData" })
      describeGroup(root, group, header.described);
    describeGroup(file, "FieldData", header.described);
    forMembers(file, "FieldData",
      [&](hid_t at, const std::string& name)
      {
        if (const auto array = readField(at, name))
          header.fields->AddArray(array);
      });
  }
  catch (const InputError&)
  {
    throw;
  }
  catch (const Error&)
  {
    throw InputError("'" + path + "' is a VTKHDF file that is damaged", "make or copy it again");
  }
}

void describeArrays(vtkDataSet* grid, const Descriptions& described)
{
  for (const auto& [key, words] : described)
  {
    const auto& [group, name] = key;
    vtkFieldData* const data = group == "PointData" ? static_cast<vtkFieldData*>(grid->GetPointData())
      : group == "CellData"                         ? grid->GetCellData()
                                                    : grid->GetFieldData();
    vtkDataArray* const array = data->GetArray(name.c_str());
    if (array != nullptr && !(words.unit + words.description + words.creator).empty())
      describe(array, words.unit, words.description, words.creator);
  }
}

/// VTK 9.2's reader reads beyond its memory where a part of an image is asked for: this reads the format's datasets.
class HdfImage final : public Volume
{
public:
  HdfImage(const std::string& path, const HdfHeader& header)
    : path_(path)
    , described_(header.described)
    , file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose)
    , root_(H5Gopen2(file_, "VTKHDF", H5P_DEFAULT), H5Gclose)
  {
    fields_->ShallowCopy(header.fields);
    this->numbers("WholeExtent", H5T_NATIVE_INT, extent_);
    this->numbers("Origin", H5T_NATIVE_DOUBLE, origin_);
    this->numbers("Spacing", H5T_NATIVE_DOUBLE, spacing_);
    if (H5Aexists(root_, "Direction") > 0)
      this->numbers("Direction", H5T_NATIVE_DOUBLE, direction_);
    if (H5Aexists(root_, "axes") > 0)
    {
      this->numbers("axes", H5T_NATIVE_INT, axes_);
      this->turnBack();
    }
    constexpr double longest = mostPlausible; // metres, as of .vti
    const auto isLength = [&](double value) { return std::abs(value) <= longest; };
    double points = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      points *= static_cast<double>(extent_[2 * axis + 1]) - static_cast<double>(extent_[2 * axis]) + 1;
      constexpr int farthest = 1 << 30; // a difference is an int, too
      if (extent_[2 * axis + 1] < extent_[2 * axis] || std::abs(double{ 1 } * extent_[2 * axis]) > farthest ||
        std::abs(double{ 1 } * extent_[2 * axis + 1]) > farthest || !(spacing_[axis] >= 1 / longest))
        damaged(path, "VTKHDF");
    }
    if (points > 0x1p53 || !std::ranges::all_of(spacing_, isLength) || !std::ranges::all_of(origin_, isLength) ||
      !std::ranges::all_of(direction_, [](double value) { return std::abs(value) <= 1; }))
      damaged(path, "VTKHDF");
    for (const bool cells : { false, true })
    {
      forMembers(
        root_, cells ? "CellData" : "PointData",
        [&](hid_t at, const std::string& name) { this->open(at, name, cells); });
    }
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  try
  {
    const io::hdf5::Quiet quiet;
    auto slab = vtkSmartPointer<vtkImageData>::New();
    setPlace(slab, extent_, first, last);
    slab->SetOrigin(origin_.data());
    slab->SetSpacing(spacing_.data());
    slab->SetDirectionMatrix(direction_.data());
    for (const Set& set : sets_)
    {
      const bool flat = extent_[4] == extent_[5];
      const int layers = set.cells && !flat ? last - first : last - first + 1;
      if (layers > 0)
      {
        const auto values = this->values(set, static_cast<hsize_t>(first - extent_[4]), static_cast<hsize_t>(layers));
        (set.cells ? static_cast<vtkFieldData*>(slab->GetCellData()) : slab->GetPointData())->AddArray(values);
      }
    }
    slab->GetFieldData()->ShallowCopy(fields_);
    describeArrays(slab, described_);
    return slab;
  }
  catch (const Cancelled&)
  {
    throw;
  }
  catch (const Error&)
  {
    damaged(path_, "VTKHDF");
  }

private:
  struct Set
  {
    std::string name;
    bool cells;
    bool all; ///< its axes of one point are there
    int type;
    int components;
    bool vectors; ///< the last axis is that of the components
    io::hdf5::Handle handle;
  };

  template <typename Array>
  void numbers(const char* name, hid_t type, Array& to)
  {
    const io::hdf5::Handle attribute(H5Aopen(root_, name, H5P_DEFAULT), H5Aclose);
    io::hdf5::readNumbers(attribute, type, to.size(), to.data());
  }

  /// From the file's axes to the image's, as vtkVTKHDFWriter turned them.
  void turnBack()
  {
    constexpr std::array<std::array<int, 3>, 3> turns{ { { 0, 1, 2 }, { 1, 0, 2 }, { 2, 0, 1 } } };
    if (std::ranges::find(turns, axes_) == turns.end())
      damaged(path_, "VTKHDF");
    const auto extent = extent_;
    const auto spacing = spacing_;
    const auto direction = direction_;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto image = static_cast<std::size_t>(axes_[axis]);
      extent_[2 * image] = extent[2 * axis];
      extent_[2 * image + 1] = extent[2 * axis + 1];
      spacing_[image] = spacing[axis];
      for (std::size_t row = 0; row < 3; ++row)
      {
        const double value = direction[3 * row + axis];
        direction_[3 * row + image] = axis == 0 && image == 1 && value != 0 ? -value : value;
      }
    }
  }

  /// Points, or cells between them, along an axis.
  [[nodiscard]] hsize_t count(std::size_t axis, bool cells) const
  {
    const int points = extent_[2 * axis + 1] - extent_[2 * axis] + 1;
    return static_cast<hsize_t>(cells ? std::max(1, points - 1) : points);
  }

  void open(hid_t group, const std::string& name, bool cells)
  {
    io::hdf5::Handle handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    const io::hdf5::Handle type(H5Dget_type(handle), H5Tclose);
    const io::hdf5::Handle space(H5Dget_space(handle), H5Sclose);
    static_cast<void>(io::hdf5::countStored(handle));
    std::array<hsize_t, 4> shape{};
    const int axes = H5Sget_simple_extent_ndims(space);
    if (axes < 1 || axes > 4 || H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0 || numberType(type) == 0)
      this->refuse(name);
    // Axes of one point may be there or not.
    for (const bool all : { false, true })
    {
      const auto expected =
        this->shapeOf(cells, all, { this->count(0, cells), this->count(1, cells), this->count(2, cells) });
      const bool alike = std::equal(expected.begin(), expected.end(), shape.begin());
      const auto more = static_cast<std::size_t>(axes) - expected.size();
      if (static_cast<std::size_t>(axes) >= expected.size() && alike && more <= 1)
      {
        const int components = more == 1 ? static_cast<int>(shape[expected.size()]) : 1;
        sets_.push_back({ name, cells, all, numberType(type), components, more == 1, std::move(handle) });
        return;
      }
    }
    this->refuse(name);
  }

  [[noreturn]] void refuse(const std::string& name) const
  {
    throw InputError(
      fmt::format("the array '{}' of '{}' does not have the shape of its image", name, path_), "look at what wrote it");
  }

  /// Numbers along z, y and x of the file; those of axes with one point left out unless `all`.
  [[nodiscard]] std::vector<hsize_t> shapeOf(bool cells, bool all, const std::array<hsize_t, 3>& xyz) const
  {
    std::vector<hsize_t> shape;
    for (std::size_t place = 3; place-- > 0;)
    {
      const auto axis = static_cast<std::size_t>(axes_[place]);
      if (all || this->count(axis, cells) > 1 || (place == 0 && shape.empty()))
        shape.push_back(xyz[axis]);
    }
    return shape;
  }

  [[nodiscard]] vtkSmartPointer<vtkDataArray> values(const Set& set, hsize_t first, hsize_t layers) const
  {
    auto start = this->shapeOf(set.cells, set.all, { 0, 0, first });
    auto size = this->shapeOf(set.cells, set.all, { this->count(0, set.cells), this->count(1, set.cells), layers });
    if (set.vectors)
    {
      start.push_back(0);
      size.push_back(static_cast<hsize_t>(set.components));
    }
    vtkSmartPointer<vtkDataArray> array;
    array.TakeReference(vtkDataArray::CreateDataArray(set.type));
    array->SetName(set.name.c_str());
    array->SetNumberOfComponents(set.components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(this->count(0, set.cells) * this->count(1, set.cells) * layers));
    const io::hdf5::Handle file(H5Dget_space(set.handle), H5Sclose);
    io::hdf5::good(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr));
    const io::hdf5::Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
    const io::hdf5::Handle stored(H5Dget_type(set.handle), H5Tclose);
    const io::hdf5::Handle native(H5Tget_native_type(stored, H5T_DIR_ASCEND), H5Tclose);
    io::hdf5::good(H5Dread(set.handle, native, memory, file, H5P_DEFAULT, array->GetVoidPointer(0)));
    return array;
  }

  std::string path_;
  Descriptions described_;
  vtkNew<vtkFieldData> fields_;
  io::hdf5::Handle file_;
  io::hdf5::Handle root_;
  std::array<double, 3> origin_{};
  std::array<double, 3> spacing_{};
  std::array<double, 9> direction_{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  std::array<int, 3> axes_{ 0, 1, 2 }; ///< which axis of the image each of the file is
  std::vector<Set> sets_;
};

} // namespace

namespace
{

/// Everything that HDF5 looks at before it reads values.
void lookThrough(const std::string& path)
{
  HdfHeader header;
  readHeader(path, header);
  const io::hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  io::hdf5::good(H5Ovisit(
    file, H5_INDEX_NAME, H5_ITER_NATIVE,
    [](hid_t at, const char* name, const H5O_info_t* info, void*) -> herr_t
    {
      if (info->type == H5O_TYPE_DATASET)
      {
        const hid_t set = H5Dopen2(at, name, H5P_DEFAULT);
        static_cast<void>(H5Dget_storage_size(set)); // walks through the list of chunks
        H5Dclose(set);
      }
      return 0;
    },
    nullptr));
}

} // namespace

Step openXml(const std::string& path)
{
  requireFile(path);
  if (endingOf(path.c_str()) == ".vti")
    return { std::make_unique<XmlImage>(path) };
  return { .points = vtkPointSet::SafeDownCast(readGrid(path)) };
}

Step openHdf(const std::string& path)
{
  requireFile(path);
  const io::hdf5::Quiet quiet;
  HdfHeader header;
  if (!io::survives([&] { lookThrough(path); }))
    damaged(path, "VTKHDF");
  readHeader(path, header);
  if (header.type == "ImageData")
  {
    try
    {
      return { std::make_unique<HdfImage>(path, header) };
    }
    catch (const InputError&)
    {
      throw;
    }
    catch (const Error&)
    {
      damaged(path, "VTKHDF");
    }
  }
  if (header.type != "UnstructuredGrid")
  {
    throw InputError(fmt::format("'{}' holds VTKHDF data of the type '{}'", path, header.type),
      "ImageData and UnstructuredGrid can be read");
  }
  vtkNew<vtkHDFReader> reader;
  reader->SetFileName(path.c_str());
  (void)VtkMessages::takeErrors();
  if (!io::survives([&] { reader->Update(); })) // VTK's reader believes the numbers of points and cells
    damaged(path, "VTKHDF");
  reader->Update();
  auto* const grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutputAsDataSet());
  if (!VtkMessages::takeErrors().empty() || grid == nullptr)
    damaged(path, "VTKHDF");
  requireSound(grid, path);
  describeArrays(grid, header.described);
  return { .points = grid };
}

namespace
{

/// A writer that did not come to its end. @throws InputError for what the format has no place for; OutputError
[[noreturn]] void failed(vtkAlgorithm* writer, const OutputFile& file)
{
  if (writer->GetErrorCode() == vtkErrorCode::FileFormatError)
    throwVtkErrors("");
  file.failed();
}

/// Drives a writer over the slabs of a volume.
template <typename Writer>
void drive(Session& session, Volume& volume, Writer* writer, const OutputFile& file)
{
  vtkNew<SlabSource> source;
  source->Set(&session, &volume);
  writer->SetInputConnection(source->GetOutputPort());
  writer->SetFileName(file.temporary().c_str());
  (void)VtkMessages::takeErrors();
  const int written = writer->Write();
  session.endProgress();
  source->Rethrow();
  Session::checkInterrupt();
  if (written != 1 || writer->GetErrorCode() != vtkErrorCode::NoError)
    failed(writer, file);
}

} // namespace

void writeXmlImage(Session& session, Volume& volume, const OutputFile& file)
{
  vtkNew<SlabWriter> writer;
  writer->SetDataModeToBinary(); // inline: GridReaders.h says why not appended
  writer->SetCompressorTypeToLZ4();
  const int pieces = (volume.layers() + volume.slab() - 1) / volume.slab();
  writer->SetNumberOfPieces(std::clamp(pieces, 1, std::max(1, volume.layers() - 1)));
  drive(session, volume, writer.Get(), file);
}

void writeHdf(Session& session, Volume& volume, const OutputFile& file)
{
  vtkNew<vtkVTKHDFWriter> writer;
  drive(session, volume, writer.Get(), file);
}

void writeHdf(Session& session, vtkPointSet* points, const OutputFile& file)
{
  session.progress(0, "writing");
  vtkNew<vtkVTKHDFWriter> writer;
  writer->SetInputData(points);
  writer->SetFileName(file.temporary().c_str());
  (void)VtkMessages::takeErrors();
  if (writer->Write() != 1 || writer->GetErrorCode() != vtkErrorCode::NoError)
    failed(writer, file);
}

} // namespace lamella::cli
