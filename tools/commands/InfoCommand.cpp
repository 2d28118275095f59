#include "convert/CheckpointTable.h"
#include "convert/Conversion.h"
#include "convert/Source.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/JsonReport.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

#include "GridReaders.h"
#include "core/Error.h"
#include "io/Checkpoint.h"
#include "io/Provenance.h"
#include "pictures/Slices.h"
#include "vtkFileConverter.h"
#include "vtkLatticeConversion.h"

#include <vtkAbstractArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

struct InfoOptions
{
  CommonOptions common;
  SettingOptions settings; ///< of vtkFileConverter
  ConversionWords words;   ///< what they say
};

Json recordJson(const std::string& text)
{
  Json record = Json::parse(text, nullptr, false);
  return record.is_object() ? std::move(record) : Json(nullptr);
}

/// Smallest and largest value of each component (of the magnitude, for vectors as well); NaN is left out and counted.
Json rangeJson(vtkDataArray* array)
{
  Json ranges = Json::array();
  for (int component = 0; component < array->GetNumberOfComponents(); ++component)
  {
    double range[2] = { 1, 0 };
    array->GetFiniteRange(range, component);
    ranges.push_back(range[0] <= range[1] ? Json{ range[0], range[1] } : Json(nullptr));
  }
  return ranges;
}

Json arraysJson(vtkFieldData* data)
{
  Json arrays = Json::array();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array == nullptr)
      continue;
    const auto [unit, text, creator] = description(array);
    Json json;
    json["name"] = array->GetName() == nullptr ? "" : array->GetName();
    json["type"] = array->GetDataTypeAsString();
    json["components"] = array->GetNumberOfComponents();
    json["range"] = rangeJson(array);
    json["unit"] = unit;
    json["description"] = text;
    json["creator"] = creator;
    arrays.push_back(std::move(json));
  }
  return arrays;
}

/// Field data: numbers as lists, strings as lists of strings; a single value on its own.
Json fieldJson(vtkFieldData* data)
{
  Json fields = Json::object();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    const std::string name = array->GetName() == nullptr ? "" : array->GetName();
    if (name == "provenance" || name == "phase_names")
      continue;
    Json values = Json::array();
    if (auto* strings = vtkStringArray::SafeDownCast(array))
    {
      for (vtkIdType k = 0; k < strings->GetNumberOfValues(); ++k)
        values.push_back(std::string(strings->GetValue(k)));
    }
    else if (auto* numbers = vtkDataArray::SafeDownCast(array))
    {
      constexpr vtkIdType most = 256; // a table in the field data is not for reading here
      for (vtkIdType k = 0; k < std::min(most, numbers->GetNumberOfValues()); ++k)
      {
        const int components = numbers->GetNumberOfComponents();
        values.push_back(jsonNumber(numbers->GetComponent(k / components, static_cast<int>(k % components))));
      }
    }
    fields[name] = values.size() == 1 ? values.front() : values;
  }
  return fields;
}

/// What is in data of VTK.
Json gridJson(const std::string& path, vtkDataObject* data)
{
  auto* set = vtkDataSet::SafeDownCast(data);
  Json json;
  json["file"] = path;
  json["kind"] = set->GetClassName();
  if (auto* image = vtkImageData::SafeDownCast(set))
  {
    int size[3];
    image->GetDimensions(size);
    const int dimension = size[2] > 1 ? 3 : 2;
    json["size"] = std::vector<int>(size, size + dimension);
    json["spacing"] = std::vector<double>(image->GetSpacing(), image->GetSpacing() + dimension);
    json["origin"] = std::vector<double>(image->GetOrigin(), image->GetOrigin() + dimension);
  }
  else
  {
    json["points"] = set->GetNumberOfPoints();
    json["cells"] = set->GetNumberOfCells();
  }
  json["point_arrays"] = arraysJson(set->GetPointData());
  json["cell_arrays"] = arraysJson(set->GetCellData());

  const PhaseTable names = phaseNames(set);
  if (auto* phase = set->GetPointData()->GetArray("phase"); phase != nullptr && phase->GetNumberOfComponents() == 1)
  {
    std::vector<std::int64_t> count(256, 0);
    for (vtkIdType i = 0; i < phase->GetNumberOfTuples(); ++i)
    {
      const double value = phase->GetTuple1(i);
      if (value >= 0 && value < 256)
        ++count[static_cast<std::size_t>(value)];
    }
    json["phases"] = Json::array();
    for (std::size_t id = 0; id < count.size(); ++id)
    {
      if (count[id] > 0 || id < names.size())
      {
        json["phases"].push_back({ { "id", id },
          { "name", id < names.size() ? Json(names.names()[id]) : Json(nullptr) }, { "nodes", count[id] },
          { "fraction", static_cast<double>(count[id]) / static_cast<double>(phase->GetNumberOfTuples()) } });
      }
    }
  }
  json["field_data"] = fieldJson(set->GetFieldData());
  json["provenance"] = recordJson(provenance(set));
  return json;
}

/// What is in a file that is read as `lamella convert` reads it.
Json convertedJson(Session& session, const InfoOptions& o)
{
  const Loaded loaded = load(session, o.words);
  Json json = gridJson(o.words.raw.file, loaded.data);
  if (loaded.steps > 1)
  {
    json["steps"] = loaded.steps;
    json["times"] = loaded.times.empty() ? Json(nullptr) : Json(loaded.times);
  }
  return json;
}

/// What is in the checkpoint of a run.
Json checkpointJson(const std::string& path)
{
  const io::Checkpoint checkpoint = io::readFile(path);
  Json json;
  json["file"] = path;
  json["kind"] = "checkpoint";
  json["run"] = checkpoint.kind;
  json["arrays"] = Json::array();
  for (const auto& [name, array] : checkpoint.arrays)
  {
    const bool real = std::holds_alternative<std::vector<double>>(array.values);
    json["arrays"].push_back({ { "name", name }, { "type", real ? "f64" : "i64" }, { "shape", array.shape },
      { "unit", array.unit }, { "description", array.description } });
  }
  json["provenance"] = recordJson(checkpoint.provenance);
  return json;
}

/// Does the file hold grey values or colours of 8 or 16 bits, which are counted?
bool isPicture(const RawOptions& raw)
{
  const std::string ending = endingOf(raw.file.c_str());
  const auto anyOf = [&](std::initializer_list<const char*> list)
  { return std::find(list.begin(), list.end(), ending) != list.end(); };
  if (!anyOf({ ".tif", ".tiff", ".raw", ".npy" }))
  {
    return !anyOf({ ".bin", ".mhd", ".mha", ".nhdr", ".nrrd", ".nii", ".nii.gz", ".hdr", ".vtk", ".vti", ".vtp", ".vtu",
      ".pvd", ".hdf", ".vtkhdf", ".h5", ".hdf5", ".csv", ".xdmf", ".xmf", ".stl", ".ply" });
  }
  try
  {
    Reading reading{ raw, {}, true };
    Step step = findSource(raw.file, reading).open(0, reading);
    const int type = onlyArray(step.volume->sample())->GetDataType();
    return type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT;
  }
  catch (const Error&)
  {
    return true; // what is wrong is said where it is read
  }
}

/// What is in a picture or volume.
Json pictureJson(const RawOptions& options)
{
  micrograph::ReadOptions read = options.read;
  read.keepColour = true;
  const PictureFile file = readPictureFile(options.file, read);
  const micrograph::Picture& picture = file.picture;
  const std::optional<micrograph::PictureRecord>& record = file.record;
  const int dimension = picture.lattice.dimension;
  Json json;
  json["file"] = options.file;
  json["kind"] = dimension == 3 ? "volume" : "picture";
  json["size"] = std::vector<std::int64_t>(picture.lattice.size.begin(), picture.lattice.size.begin() + dimension);
  json["bits"] = picture.bits;
  json["format"] = picture.format;
  json["colour"] = !picture.colour.empty();
  json["pixel_size_source"] = picture.pixelSizeSource;
  json["pixel_size"] = picture.pixelSizeSource == "none" ? Json(nullptr) : Json(picture.lattice.spacing);
  json["slice_distance"] =
    picture.pixelSizeSource == "none" || dimension == 2 ? Json(nullptr) : Json(picture.lattice.spacingAlong(2));
  json["warnings"] = picture.warnings;

  std::vector<std::int64_t> count(65536, 0);
  for (const std::uint16_t grey : picture.grey)
    ++count[grey];
  json["greys"] = Json::array();
  for (std::size_t grey = 0; grey < count.size(); ++grey)
  {
    if (count[grey] > 0)
    {
      Json line = { { "grey", grey }, { "nodes", count[grey] },
        { "fraction", static_cast<double>(count[grey]) / static_cast<double>(picture.grey.size()) } };
      if (record && record->phases.contains(static_cast<int>(grey)))
        line["name"] = record->phases.at(static_cast<int>(grey));
      json["greys"].push_back(std::move(line));
    }
  }
  json["provenance"] = recordJson(record ? record->provenance : picture.provenance);
  return json;
}

/// What is in any file.
Json anyJson(Session& session, const InfoOptions& o)
{
  const std::string& file = o.words.raw.file;
  const std::string ending = endingOf(file.c_str());
  if (isPicture(o.words.raw))
    return pictureJson(o.words.raw);
  if (ending == ".h5" || ending == ".hdf5")
  {
    requireFile(file);
    if (isCheckpoint(file))
      return checkpointJson(file);
  }
  const bool ofVtk = ending == ".vti" || ending == ".vtp" || ending == ".vtu";
  return ofVtk && !micrograph::isSlicePattern(file) ? gridJson(file, readGrid(file)) : convertedJson(session, o);
}

std::string listText(const Json& list, const char* separator = ", ")
{
  std::string text;
  for (const Json& value : list)
  {
    text += (text.empty() ? "" : separator) +
      (value.is_string()      ? value.get<std::string>()
          : value.is_number() ? fmt::format("{:.7g}", value.get<double>())
                              : value.dump());
  }
  return text;
}

std::string arraysText(const char* title, const Json& arrays)
{
  std::string text;
  for (const Json& array : arrays)
  {
    std::string range;
    for (const Json& r : array["range"])
    {
      range += (range.empty() ? "" : ", ") +
        (r.is_null() ? "no value" : fmt::format("{:.6g} to {:.6g}", r[0].get<double>(), r[1].get<double>()));
    }
    const auto unit = array["unit"].get<std::string>();
    text += fmt::format("  {:<16} {:<14} {}{}{}\n", array["name"].get<std::string>(), array["type"].get<std::string>(),
      range, unit.empty() || unit == "1" ? "" : " " + unit,
      array["description"].get<std::string>().empty() ? "" : "; " + array["description"].get<std::string>());
  }
  return text.empty() ? "" : title + text;
}

/// The record, and below it, further in, that of what it was made from.
std::string provenanceText(const Json& record, std::size_t indent)
{
  const std::string margin(indent, ' ');
  std::string text;
  for (const auto& [name, value] : record.items())
  {
    if (name == "inputs")
    {
      for (const Json& input : value)
      {
        const bool ends = input.contains("sha256_of_ends");
        text += fmt::format("{}{:<10} {}, {} bytes, sha256{} {}\n", margin, "input", input.value("name", ""),
          input.value("bytes", std::uint64_t{ 0 }), ends ? " of its two ends" : "",
          input.value(ends ? "sha256_of_ends" : "sha256", ""));
      }
    }
    else if (name == "parameters" && value.is_object())
    {
      for (const auto& [key, parameter] : value.items())
      {
        text += key == "made_from" && parameter.is_object()
          ? margin + "made from\n" + provenanceText(parameter, indent + 2)
          : fmt::format("{}{:<10} {}\n", margin, key, parameter.dump());
      }
    }
    else
    {
      text += fmt::format("{}{:<10} {}\n", margin, name, value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return text;
}

std::string headText(const Json& json)
{
  std::string text = fmt::format("{}: {}", json["file"].get<std::string>(), json["kind"].get<std::string>());
  if (json.contains("size"))
    text += ", " + listText(json["size"], " × ");
  if (json.contains("bits"))
  {
    text += fmt::format(", {} bits; ", json["bits"].get<int>());
    text += json["pixel_size"].is_null()
      ? "pixel size unknown"
      : fmt::format("pixel size {:.6g} µm ({})", json["pixel_size"].get<double>() * 1e6,
          json["pixel_size_source"].get<std::string>());
    if (const Json& slices = json["slice_distance"]; !slices.is_null() && slices != json["pixel_size"])
      text += fmt::format(", {:.6g} µm from slice to slice", slices.get<double>() * 1e6);
  }
  if (json.contains("spacing"))
    text += "; spacing " + listText(json["spacing"]) + " m, origin " + listText(json["origin"]) + " m";
  if (json.contains("points"))
    text += fmt::format(", {} points, {} cells", json["points"].get<std::int64_t>(), json["cells"].get<std::int64_t>());
  if (json.contains("run"))
    text += " of a run (" + json["run"].get<std::string>() + ")";
  text += "\n";
  if (json.contains("steps"))
  {
    const Json& times = json["times"];
    text += fmt::format("steps: {}{}\n", json["steps"].get<std::int64_t>(),
      times.is_null() ? ""
                      : fmt::format(", at {:.7g} to {:.7g}", times.front().get<double>(), times.back().get<double>()));
  }
  return text;
}

/// A coarse histogram.
std::string histogramText(const Json& greys)
{
  std::string text;
  const int low = greys.front()["grey"].get<int>();
  const int high = greys.back()["grey"].get<int>();
  constexpr int bins = 16;
  std::array<double, bins> bin{};
  for (const Json& grey : greys)
  {
    bin[static_cast<std::size_t>((grey["grey"].get<int>() - low) * bins / (high - low + 1))] +=
      grey["fraction"].get<double>();
  }
  const double largest = *std::max_element(bin.begin(), bin.end());
  for (int i = 0; i < bins; ++i)
  {
    // Greys g with (g − low)·bins/(high − low + 1) = i, in whole numbers.
    const auto first = low + (i * (high - low + 1) + bins - 1) / bins;
    const auto last = low + ((i + 1) * (high - low + 1) + bins - 1) / bins - 1;
    text += fmt::format("  {:>5} to {:<5}  {:>6.2f} %  {}\n", first, last, 100 * bin[static_cast<std::size_t>(i)],
      std::string(static_cast<std::size_t>(std::lround(40 * bin[static_cast<std::size_t>(i)] / largest)), '#'));
  }
  return text;
}

/// All greys of a label picture; a coarse histogram of a scan.
std::string greysText(const Json& greys)
{
  std::string text = fmt::format("grey values: {}\n", greys.size());
  if (greys.size() <= 16)
  {
    for (const Json& grey : greys)
    {
      text += fmt::format("  {:>5}  {:>9.4f} %  {:>14}  {}\n", grey["grey"].get<int>(),
        100 * grey["fraction"].get<double>(), grouped(grey["nodes"].get<std::int64_t>()), grey.value("name", ""));
    }
  }
  else
  {
    text += histogramText(greys);
  }
  return text;
}

std::string infoText(const Json& json)
{
  std::string text = headText(json);
  if (json.contains("greys"))
    text += greysText(json["greys"]);
  if (json.contains("phases"))
  {
    text += "phases:\n";
    for (const Json& phase : json["phases"])
    {
      text += fmt::format("  {:>3}  {:<16} {:>9.4f} %  {:>14}\n", phase["id"].get<int>(),
        phase["name"].is_null() ? "(no name)" : phase["name"].get<std::string>(), 100 * phase["fraction"].get<double>(),
        grouped(phase["nodes"].get<std::int64_t>()));
    }
  }
  for (const Json& array : json.value("arrays", Json::array()))
  {
    const auto unit = array["unit"].get<std::string>();
    text += fmt::format("  {:<16} {:<4} {}{}; {}\n", array["name"].get<std::string>(), array["type"].get<std::string>(),
      listText(array["shape"], " × "), unit.empty() || unit == "1" ? "" : " " + unit,
      array["description"].get<std::string>());
  }
  if (json.contains("point_arrays"))
  {
    text += arraysText("arrays at points:\n", json["point_arrays"]);
    text += arraysText("arrays in cells:\n", json["cell_arrays"]);
  }
  if (json.contains("field_data") && !json["field_data"].empty())
  {
    text += "about the whole:\n";
    for (const auto& [name, value] : json["field_data"].items())
      text += fmt::format("  {:<29} {}\n", name, listText(value.is_array() ? value : Json::array({ value })));
  }
  text += json["provenance"].is_object() ? "provenance:\n" + provenanceText(json["provenance"], 2)
                                         : "provenance: none; lamella did not write this file\n";
  return text;
}

} // namespace

Command infoCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "info", "What is in a file: arrays, units, ranges, phases, grey values, pixel size, provenance");
  auto o = std::make_shared<InfoOptions>();
  app
    ->add_option("FILE", o->words.raw.file,
      "Any file that lamella convert reads: a picture, a folder or pattern of slices, a volume, .vti, .hdf, .csv, .pvd "
      "...")
    ->required();
  o->settings.declareSome(*app, "vtkFileConverter", rawWords(), "Sample");
  o->settings.declareSome(*app, "vtkFileConverter", { "step" }, "Sample");
  app->add_flag("--json", o->common.json, "Print one JSON object to standard output, and nothing else")
    ->group("Report");
  addExamples(*app, { "lamella info tissue.png", "lamella info heat_y.vti --json" });
  return { app,
    [o](Session& session, const std::string&)
    {
      session.onRoot(
        [&]
        {
          vtkNew<vtkFileConverter> converter;
          o->settings.give(converter);
          converter->SetFileName(o->words.raw.file);
          o->words = converter->GetWords();
          o->words.step = o->words.step.value_or(0);
          o->words.lossy = true;
          const Json json = anyJson(session, *o);
          if (!o->common.json && json.contains("warnings"))
            for (const Json& warning : json["warnings"])
              session.warn(warning.get<std::string>());
          session.print(o->common.json ? dump(json) : infoText(json));
        });
    } };
}

} // namespace lamella::cli
