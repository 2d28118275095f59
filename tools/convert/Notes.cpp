#include "convert/Notes.h"

#include "convert/Types.h"
#include "files/SampleFile.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkAbstractArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkFieldData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVariant.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>

namespace lamella::cli
{

using Json = nlohmann::ordered_json;

namespace
{

/// @throws InputError for none
int storedType(const std::string& name)
{
  if (const auto type = typeNamed(name))
    return *type;
  throw InputError("the notes of the file speak of a type '" + name + "'", "they were made by a newer version");
}

/// JSON has no NaN and no infinity; here they are texts.
Json numberJson(double value)
{
  return std::isfinite(value) ? Json(value) : Json(std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
}

double numberOf(const Json& json)
{
  if (json.is_string())
  {
    const auto text = json.get<std::string>();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return text == "nan" ? std::numeric_limits<double>::quiet_NaN() : text == "-inf" ? -infinity : infinity;
  }
  return json.get<double>();
}

void describeJson(Json& json, vtkDataArray* array)
{
  const auto [unit, text, creator] = description(array);
  json["unit"] = unit;
  json["description"] = text;
  json["creator"] = creator;
}

Json fieldsJson(vtkFieldData* data)
{
  Json fields = Json::object();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = data->GetAbstractArray(i);
    const std::string name = array->GetName() == nullptr ? "" : array->GetName();
    if (name == "provenance" || name.empty())
      continue;
    Json json{ { "type", typeName(array->GetDataType()) }, { "components", array->GetNumberOfComponents() } };
    Json values = Json::array();
    auto* const numbers = vtkDataArray::SafeDownCast(array);
    for (vtkIdType k = 0; k < array->GetNumberOfValues(); ++k)
    {
      const vtkVariant value = array->GetVariantValue(k);
      values.push_back(numbers == nullptr ? Json(value.ToString())
          : isReal(array->GetDataType())  ? numberJson(value.ToDouble())
          : array->GetDataType() == VTK_UNSIGNED_LONG || array->GetDataType() == VTK_UNSIGNED_LONG_LONG
          ? Json(value.ToTypeUInt64())
          : Json(value.ToTypeInt64()));
    }
    json["values"] = std::move(values);
    if (numbers != nullptr)
      describeJson(json, numbers);
    fields[name] = std::move(json);
  }
  return fields;
}

void describeFrom(const Json& json, vtkDataArray* array)
{
  const std::string unit = json.value("unit", "");
  const std::string text = json.value("description", "");
  const std::string creator = json.value("creator", "");
  if (!unit.empty() || !text.empty() || !creator.empty())
    describe(array, unit, text, creator);
}

void addFields(const Json& fields, vtkDataSet* grid)
{
  for (const auto& [name, json] : fields.items())
  {
    vtkSmartPointer<vtkAbstractArray> array;
    array.TakeReference(vtkAbstractArray::CreateArray(storedType(json.at("type").get<std::string>())));
    array->SetName(name.c_str());
    array->SetNumberOfComponents(json.at("components").get<int>());
    const Json& values = json.at("values");
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / std::max(1, array->GetNumberOfComponents()));
    auto* const numbers = vtkDataArray::SafeDownCast(array);
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      const Json& value = values[k];
      array->SetVariantValue(static_cast<vtkIdType>(k),
        numbers == nullptr               ? vtkVariant(value.get<std::string>())
          : isReal(array->GetDataType()) ? vtkVariant(numberOf(value))
          : value.is_number_unsigned()   ? vtkVariant(value.get<unsigned long long>())
                                         : vtkVariant(value.get<long long>()));
    }
    if (numbers != nullptr)
      describeFrom(json, numbers);
    grid->GetFieldData()->AddArray(array);
  }
}

/// The phases that a record names, in the order of their ids, and the id of each grey.
struct Phases
{
  PhaseTable table;
  std::map<int, std::uint8_t> idOfGrey;
};

Phases phasesOf(const micrograph::PictureRecord& record, const Json& json)
{
  Phases phases;
  if (const auto fields = json.find("fields"); fields != json.end() && fields->contains("phase_names"))
    phases.table = PhaseTable(fields->at("phase_names").at("values").get<std::vector<std::string>>());
  else if (std::ranges::any_of(record.phases, [](const auto& phase) { return phase.second == "void"; }))
    phases.table.add("void"); // which is 0 wherever there is one, as in GreyMap
  for (const auto& [grey, name] : record.phases)
    phases.idOfGrey[grey] = phases.table.add(name);
  return phases;
}

vtkSmartPointer<vtkDataArray> phaseIds(vtkDataArray* greys, const Phases& phases)
{
  const vtkIdType count = greys->GetNumberOfTuples();
  auto ids = vtkSmartPointer<vtkUnsignedCharArray>::New();
  ids->SetNumberOfValues(count);
  std::vector<int> idOf(65536, -1);
  for (const auto& [grey, id] : phases.idOfGrey)
    idOf.at(static_cast<std::size_t>(std::clamp(grey, 0, 65535))) = id;
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto grey = static_cast<std::int64_t>(greys->GetComponent(i, 0));
    const int id = grey >= 0 && grey < 65536 ? idOf[static_cast<std::size_t>(grey)] : -1;
    if (id < 0)
    {
      throw InputError(fmt::format("a pixel has the value {}, which is none of the phases that the file names", grey),
        "the file was changed since lamella wrote it: name its grey values anew");
    }
    ids->SetValue(i, static_cast<unsigned char>(id));
  }
  return ids;
}

class Noted final : public Volume
{
public:
  Noted(std::unique_ptr<Volume> values, Json notes, micrograph::PictureRecord record)
    : values_(std::move(values))
    , notes_(std::move(notes))
    , record_(std::move(record))
    , fields_(vtkSmartPointer<vtkImageData>::New())
  {
    extent_ = values_->extent();
    if (const auto image = notes_.find("image"); image != notes_.end())
    {
      const auto extent = image->at("extent").get<std::array<int, 6>>();
      bool same = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        same = same && extent[2 * axis + 1] - extent[2 * axis] == extent_[2 * axis + 1] - extent_[2 * axis];
      if (same)
      {
        shift_ = extent_[4] - extent[4];
        extent_ = extent;
        placed_ = true;
      }
    }
    if (const auto fields = notes_.find("fields"); fields != notes_.end())
      addFields(*fields, fields_);
    if (!record_.phases.empty())
    {
      phases_ = phasesOf(record_, notes_);
      setPhaseNames(fields_, phases_.table);
    }
    setProvenance(fields_, record_.provenance);
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    const auto from = values_->read(first + shift_, last + shift_);
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->ShallowCopy(from);
    setPlace(image, extent_, first, last);
    if (placed_)
    {
      const Json& place = notes_.at("image");
      image->SetSpacing(place.at("spacing").get<std::array<double, 3>>().data());
      image->SetOrigin(place.at("origin").get<std::array<double, 3>>().data());
      image->SetDirectionMatrix(place.at("direction").get<std::array<double, 9>>().data());
    }
    else if (record_.pixelSize && fieldText(from, "pixel_size_source") != "option")
    {
      image->SetSpacing(*record_.pixelSize, *record_.pixelSize, *record_.pixelSize);
      const double half = *record_.pixelSize / 2;
      image->SetOrigin(half, half, extent_[5] > extent_[4] ? half : 0);
    }
    this->name(image);
    image->GetFieldData()->ShallowCopy(from->GetFieldData());
    if (!placed_ && image->GetSpacing()[0] != from->GetSpacing()[0])
      setFieldText(image, "pixel_size_source", "lamella record");
    for (int i = 0; i < fields_->GetFieldData()->GetNumberOfArrays(); ++i)
      image->GetFieldData()->AddArray(fields_->GetFieldData()->GetAbstractArray(i));
    return image;
  }

private:
  void name(vtkImageData* image)
  {
    vtkSmartPointer<vtkDataArray> values = onlyArray(image);
    const auto arrays = notes_.find("arrays");
    const Json json = arrays != notes_.end() && arrays->size() == 1 ? arrays->front() : Json::object();
    const bool phases = !phases_.idOfGrey.empty();
    if (phases)
      values = phaseIds(values, phases_);
    if (json.contains("type") && storedType(json.at("type").get<std::string>()) != values->GetDataType() && !phases)
    {
      const int type = storedType(json.at("type").get<std::string>());
      if (!isReal(type) && !isReal(values->GetDataType())) // a picture's 8 or 16 bits were enough for its whole numbers
        values = cast(values, type, true);
    }
    values->SetName(json.value("name", phases ? "phase" : values->GetName()).c_str());
    describeFrom(json, values);
    image->GetPointData()->Initialize();
    image->GetPointData()->SetScalars(values);
  }

  std::unique_ptr<Volume> values_;
  Json notes_;
  micrograph::PictureRecord record_;
  Phases phases_;
  vtkSmartPointer<vtkImageData> fields_;
  int shift_ = 0;
  bool placed_ = false;
};

/// Somebody else's JSON, or ours from a version to come, must not end the program.
template <typename Action>
auto understood(const Action& action)
try
{
  return action();
}
catch (const Json::exception&)
{
  throw InputError(
    "the notes of the file are damaged, or of a newer version", "remove them to read the values as they are");
}

} // namespace

std::vector<std::uint8_t> greysFor(vtkImageData* image, const std::string& ending)
{
  vtkDataArray* const array = image->GetPointData()->GetArray(0);
  const PhaseTable phases = phaseNames(image);
  if (phases.size() == 0 || array == nullptr || array->GetName() == nullptr ||
    std::string(array->GetName()) != "phase" || array->GetDataType() != VTK_UNSIGNED_CHAR ||
    array->GetNumberOfComponents() != 1)
    return {};
  const bool picture = ending == ".png" || ending == ".tif" || ending == ".tiff";
  return valuesInFile(phases, picture ? ending : ".raw");
}

std::string notesOf(
  vtkDataSet* grid, const std::array<int, 6>& extent, const std::vector<std::uint8_t>& greys, int stored, int before)
{
  auto* const image = vtkImageData::SafeDownCast(grid);
  micrograph::PictureRecord record;
  record.provenance = provenance(grid);
  const PhaseTable phases = phaseNames(grid);
  for (std::size_t id = 0; id < greys.size(); ++id)
    record.phases[greys[id]] = phases.names()[id];
  if (image != nullptr)
  {
    const double* const spacing = image->GetSpacing();
    const bool known = fieldText(image, "pixel_size_source") != "none";
    if (spacing[0] == spacing[1] && (spacing[1] == spacing[2] || extent[4] == extent[5]) && known)
      record.pixelSize = spacing[0];
    if (stored == VTK_UNSIGNED_CHAR || stored == VTK_UNSIGNED_SHORT)
    {
      record.size = { extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1 };
      record.bits = stored == VTK_UNSIGNED_CHAR ? 8 : 16;
    }
  }
  Json json = Json::parse(toJson(record));
  if (image != nullptr)
  {
    const double* const direction = image->GetDirectionMatrix()->GetData();
    json["image"] = { { "extent", extent },
      { "spacing", std::vector<double>(image->GetSpacing(), image->GetSpacing() + 3) },
      { "origin", std::vector<double>(image->GetOrigin(), image->GetOrigin() + 3) },
      { "direction", std::vector<double>(direction, direction + 9) }, { "stored", typeName(stored) } };
  }
  if (auto* const points = vtkPointSet::SafeDownCast(grid); points != nullptr && points->GetPoints() != nullptr)
    json["points"] = typeName(points->GetPoints()->GetDataType());
  json["arrays"] = Json::array();
  for (int i = 0; i < grid->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = grid->GetPointData()->GetArray(i);
    if (array == nullptr)
      continue;
    Json entry{ { "name", array->GetName() == nullptr ? "" : array->GetName() },
      { "type", typeName(before != 0 ? before : array->GetDataType()) },
      { "components", array->GetNumberOfComponents() } };
    describeJson(entry, array);
    json["arrays"].push_back(std::move(entry));
  }
  json["fields"] = fieldsJson(grid->GetFieldData());
  // ASCII only: what PNG and TIFF readers expect of a description.
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string notesBeside(const std::filesystem::path& file)
{
  std::ifstream beside(file.string() + ".json", std::ios::binary);
  std::string text = beside ? std::string(std::istreambuf_iterator<char>(beside), {}) : "";
  if (beside && !isNotes(text))
  {
    throw InputError("'" + file.string() + ".json' does not hold what lamella writes beside a file",
      "move it away to read the values without it");
  }
  return text;
}

bool isNotes(const std::string& text)
{
  return micrograph::parseRecord(text).has_value();
}

std::unique_ptr<Volume> withNotes(std::unique_ptr<Volume> values, const std::string& notes)
{
  const auto record = micrograph::parseRecord(notes);
  if (!record)
    return values;
  return understood([&]() -> std::unique_ptr<Volume>
    { return std::make_unique<Noted>(std::move(values), Json::parse(notes), *record); });
}

std::optional<RawNotes> rawNotes(const std::string& notes)
{
  const auto record = micrograph::parseRecord(notes);
  if (!record)
    return std::nullopt;
  return understood(
    [&]() -> std::optional<RawNotes>
    {
      const Json json = Json::parse(notes);
      RawNotes raw;
      if (record->size)
      {
        raw.size = *record->size;
        raw.type = record->bits == 16 ? VTK_UNSIGNED_SHORT : VTK_UNSIGNED_CHAR;
      }
      if (const auto image = json.find("image"); image != json.end())
      {
        const auto extent = image->at("extent").get<std::array<int, 6>>();
        for (std::size_t axis = 0; axis < 3; ++axis)
          raw.size[axis] = extent[2 * axis + 1] - extent[2 * axis] + 1;
        raw.type = storedType(image->at("stored").get<std::string>());
        raw.components = json.at("arrays").at(0).at("components").get<int>();
      }
      return raw.type == 0 ? std::nullopt : std::optional(raw);
    });
}

TableNotes tableNotes(const std::string& notes, vtkDataSet* fields)
{
  TableNotes table;
  const Json json = Json::parse(notes, nullptr, false);
  if (!json.is_object())
    return table;
  understood(
    [&]
    {
      if (json.contains("provenance"))
        setProvenance(fields, json.at("provenance").dump());
      const Json columns = json.value("columns", Json::object()); // as other commands write them
      for (const auto& [name, column] : columns.items())
        table.arrays.push_back(
          { name, VTK_DOUBLE, 1, column.value("unit", ""), column.value("meaning", ""), "lamella" });
      for (const Json& array : json.value("arrays", Json::array()))
        table.arrays.push_back({ array.at("name").get<std::string>(), storedType(array.at("type").get<std::string>()),
          array.at("components").get<int>(), array.value("unit", ""), array.value("description", ""),
          array.value("creator", "") });
      if (const auto image = json.find("image"); image != json.end())
      {
        table.image = vtkSmartPointer<vtkImageData>::New();
        table.image->SetExtent(image->at("extent").get<std::array<int, 6>>().data());
        table.image->SetSpacing(image->at("spacing").get<std::array<double, 3>>().data());
        table.image->SetOrigin(image->at("origin").get<std::array<double, 3>>().data());
        table.image->SetDirectionMatrix(image->at("direction").get<std::array<double, 9>>().data());
      }
      table.points = json.contains("points") ? storedType(json.at("points").get<std::string>()) : 0;
      addFields(json.value("fields", Json::object()), fields);
      return 0;
    });
  return table;
}

} // namespace lamella::cli
