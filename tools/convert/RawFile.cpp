#include "convert/RawFile.h"

#include "convert/Notes.h"
#include "convert/Types.h"
#include "program/Commands.h"
#include "session/Text.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

/// VTK's number of a type.
int vtkTypeOf(micrograph::NumberType type)
{
  return *typeNamed(type.name());
}

micrograph::NumberType numbersOf(int type)
{
  const std::string name = type == VTK_CHAR ? "i8" : type == VTK_ID_TYPE ? "i64" : typeName(type);
  return { name.front(), std::stoi(name.substr(1)) / 8 };
}

class Raw : public Volume
{
public:
  Raw(const RawLayout& layout, std::string name)
    : numbers_(layout)
    , name_(std::move(name))
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      extent_[2 * axis] = 0;
      extent_[2 * axis + 1] = static_cast<int>(layout.size[axis] - 1);
    }
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    const RawLayout& layout = numbers_.layout();
    auto slab = vtkSmartPointer<vtkImageData>::New();
    setPlace(slab, extent_, first, last);
    slab->SetSpacing(layout.spacing.data());
    slab->SetOrigin(layout.origin.data());
    slab->SetDirectionMatrix(layout.direction.data());
    vtkSmartPointer<vtkDataArray> values;
    values.TakeReference(vtkDataArray::CreateDataArray(vtkTypeOf(layout.type)));
    values->SetName(name_.c_str());
    values->SetNumberOfComponents(layout.components);
    values->SetNumberOfTuples(slab->GetNumberOfPoints());
    numbers_.read(first, last, values->GetVoidPointer(0));
    slab->GetPointData()->SetScalars(values);
    setFieldText(slab, "pixel_size_source", layout.pixelSizeSource);
    return slab;
  }

private:
  micrograph::RawVolume numbers_;
  std::string name_;
};

} // namespace

RawLayout rawLayout(const std::string& path, const RawOptions& options)
{
  const micrograph::ReadOptions& read = options.read;
  const std::string notes = notesBeside(path);
  const auto noted = rawNotes(notes);
  micrograph::RawSaid said;
  said.offset = read.rawHeader;
  said.size = read.rawSize ? read.rawSize : noted ? std::optional(noted->size) : std::nullopt;
  if (!options.type.empty())
  {
    said.type = numbersOf(*typeNamed(numberTypes()[oneOf("--raw-type", options.type, numberTypes())]));
  }
  else if (read.rawBits)
  {
    said.type = micrograph::NumberType{ 'u', *read.rawBits / 8 };
  }
  else if (noted)
  {
    said.type = numbersOf(noted->type);
    said.components = noted->components;
  }
  const std::vector<std::string> orders{ "little", "big" };
  said.bigEndian = !options.order.empty() && oneOf("--raw-order", options.order, orders) == 1;
  RawLayout layout = micrograph::rawLayout(path, said);
  if (read.pixelSize)
  {
    layout.spacing.fill(*read.pixelSize);
    layout.pixelSizeSource = "option";
  }
  const double half = layout.spacing[0] / 2;
  layout.origin = { half, half, layout.size[2] > 1 ? half : 0 };
  return layout;
}

std::unique_ptr<Volume> openRaw(const RawLayout& layout)
{
  return std::make_unique<Raw>(layout, "grey");
}

ByteStream::ByteStream(const OutputFile& file)
  : file_(file)
  , number_(::open(file.temporary().c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC))
{
  if (number_ < 0)
    file.failed(std::strerror(errno));
}

ByteStream::~ByteStream()
{
  if (number_ >= 0)
    ::close(number_);
}

void ByteStream::write(const void* bytes, std::size_t count)
{
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0)
  {
    const ssize_t written = ::write(number_, from, count);
    if (written < 0 && errno != EINTR)
      file_.failed(std::strerror(errno));
    from += std::max<ssize_t>(0, written);
    count -= static_cast<std::size_t>(std::max<ssize_t>(0, written));
  }
}

void ByteStream::finish()
{
  if (::close(std::exchange(number_, -1)) != 0)
    file_.failed(std::strerror(errno));
}

namespace
{

int axesOf(const std::array<int, 6>& extent)
{
  return extent[5] > extent[4] ? 3 : 2;
}

/// A vector of the place's axes: its first numbers, all their digits.
std::string numbersText(const double* numbers, int count, const char* separator)
{
  return fmt::format("{}", fmt::join(numbers, numbers + count, separator));
}

/// Where the first point lies: what VTK calls the origin is the place of point 0, 0, 0 even where the extent begins
/// elsewhere.
std::array<double, 3> firstPoint(vtkImageData* sample, const std::array<int, 6>& extent)
{
  std::array<double, 3> place{};
  sample->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], place.data());
  return place;
}

} // namespace

std::string metaHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data)
{
  const int axes = axesOf(extent);
  vtkDataArray* const values = onlyArray(sample);
  const auto origin = firstPoint(sample, extent);
  const double* const direction = sample->GetDirectionMatrix()->GetData();
  std::vector<double> turn;
  for (int axis = 0; axis < axes; ++axis)
    for (int row = 0; row < axes; ++row)
      turn.push_back(direction[3 * row + axis]);
  std::string size;
  for (int axis = 0; axis < axes; ++axis)
  {
    const auto at = static_cast<std::size_t>(2 * axis);
    size += (axis > 0 ? " " : "") + std::to_string(extent[at + 1] - extent[at] + 1);
  }
  std::string text = fmt::format("ObjectType = Image\nNDims = {}\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                                 "CompressedData = False\nTransformMatrix = {}\nOffset = {}\nElementSpacing = {}\n"
                                 "DimSize = {}\n",
    axes, fmt::join(turn, " "), numbersText(origin.data(), axes, " "), numbersText(sample->GetSpacing(), axes, " "),
    size);
  if (values->GetNumberOfComponents() > 1)
    text += fmt::format("ElementNumberOfChannels = {}\n", values->GetNumberOfComponents());
  return text +
    fmt::format("ElementType = {}\nElementDataFile = {}\n", micrograph::metaTypeName(numbersOf(values->GetDataType())),
      data.empty() ? "LOCAL" : data);
}

std::string nrrdHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data)
{
  const int axes = axesOf(extent);
  vtkDataArray* const values = onlyArray(sample);
  const int components = values->GetNumberOfComponents();
  const auto origin = firstPoint(sample, extent);
  const double* const direction = sample->GetDirectionMatrix()->GetData();
  std::string sizes = components > 1 ? std::to_string(components) : "";
  std::string kinds = components == 3 ? "vector" : components > 1 ? "list" : "";
  std::string directions = components > 1 ? "none" : "";
  std::string units;
  for (int axis = 0; axis < axes; ++axis)
  {
    const auto at = static_cast<std::size_t>(2 * axis);
    const char* const blank = sizes.empty() ? "" : " ";
    sizes += blank + std::to_string(extent[at + 1] - extent[at] + 1);
    kinds += std::string(blank) + "domain";
    std::vector<double> vector;
    for (int row = 0; row < axes; ++row)
      vector.push_back(direction[3 * row + axis] * sample->GetSpacing()[axis]);
    directions += fmt::format("{}({})", blank, fmt::join(vector, ","));
    units += std::string(axis > 0 ? " " : "") + "\"m\"";
  }
  std::string text = fmt::format("NRRD0004\ntype: {}\ndimension: {}\nspace dimension: {}\nsizes: {}\n"
                                 "space directions: {}\nkinds: {}\nendian: little\nencoding: raw\nspace units: {}\n"
                                 "space origin: ({})\n",
    micrograph::nrrdTypeName(numbersOf(values->GetDataType())), axes + (components > 1 ? 1 : 0), axes, sizes,
    directions, kinds, units, numbersText(origin.data(), axes, ","));
  return text + (data.empty() ? "\n" : "data file: " + data + "\n");
}

/// [z, y, x], of images [y, x]; a last axis for several values a point. 64 bytes go before the values, or a multiple.
std::string numpyHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string&)
{
  vtkDataArray* const values = onlyArray(sample);
  const micrograph::NumberType type = numbersOf(values->GetDataType());
  std::vector<int> shape;
  for (std::size_t axis = 2 + (axesOf(extent) > 2 || values->GetNumberOfComponents() > 1 ? 1 : 0); axis-- > 0;)
    shape.push_back(extent[2 * axis + 1] - extent[2 * axis] + 1);
  if (values->GetNumberOfComponents() > 1)
    shape.push_back(values->GetNumberOfComponents());
  std::string text = fmt::format("{{'descr': '{}{}{}', 'fortran_order': False, 'shape': ({}), }}",
    type.bytes == 1 ? '|' : '<', type.kind, type.bytes, fmt::join(shape, ", "));
  constexpr std::size_t before = 10; // magic, version and length
  text.resize((before + text.size() + 64) / 64 * 64 - before - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\0", 8);
  header.push_back(static_cast<char>(text.size() % 256));
  header.push_back(static_cast<char>(text.size() / 256));
  return header.append(text);
}

} // namespace lamella::cli
