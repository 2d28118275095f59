#include "convert/Conversion.h"

#include "convert/PointTable.h"
#include "convert/Source.h"
#include "convert/Surface.h"
#include "convert/Types.h"
#include "convert/Xdmf.h"
#include "files/Collection.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "session/Text.h"

#include "CellConversion.h"
#include "GridReaders.h"
#include "core/Clock.h"
#include "core/Error.h"
#include "core/PartFile.h"
#include "vtkLatticeConversion.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkMassProperties.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>
#include <vtkUnstructuredGrid.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

namespace lamella::cli
{

namespace
{

/// The same changes for all steps.
struct Plan
{
  const ConversionWords& words;
  const Format& target;
  std::string ending;                           ///< of the files that are written
  std::optional<int> type{};                    ///< --type
  std::optional<std::array<double, 2>> range{}; ///< --range
  std::optional<double> pixelSize{};
  std::vector<std::string> warnings{};
};

std::string nameOf(vtkAbstractArray* array)
{
  return array->GetName() == nullptr ? "" : array->GetName();
}

std::vector<std::string> namesOf(vtkFieldData* data)
{
  std::vector<std::string> names;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    names.push_back(nameOf(data->GetAbstractArray(i)));
  return names;
}

/// Leaves out all arrays but those that are wanted, if any are named.
void select(vtkDataSetAttributes* data, const std::vector<std::string>& wanted)
{
  for (const std::string& name : wanted.empty() ? std::vector<std::string>() : namesOf(data))
    if (std::ranges::find(wanted, name) == wanted.end())
      data->RemoveArray(name.c_str());
}

/// @throws ParameterError for a name that the grid does not have
void requireArrays(vtkDataSet* grid, const std::vector<std::string>& wanted)
{
  auto names = namesOf(grid->GetPointData());
  const auto cells = namesOf(grid->GetCellData());
  names.insert(names.end(), cells.begin(), cells.end());
  for (const std::string& name : wanted)
  {
    if (std::ranges::find(names, name) == names.end())
    {
      throw ParameterError(fmt::format("--array '{}': there is none of that name", name),
        names.empty() ? "the file holds no array" : suggestion(name, names, "there are " + quotedList(names, "and")));
    }
  }
}

/// The type that the numbers of an array are to have, as --type and --range say.
vtkSmartPointer<vtkDataArray> shaped(const Plan& plan, vtkDataArray* array)
{
  if (plan.range)
    return spread(array, plan.type.value_or(VTK_UNSIGNED_CHAR), plan.range->front(), plan.range->back());
  return plan.type ? cast(array, *plan.type, !plan.words.lossy) : vtkSmartPointer<vtkDataArray>(array);
}

void shape(const Plan& plan, vtkDataSetAttributes* data)
{
  for (const std::string& name : plan.type || plan.range ? namesOf(data) : std::vector<std::string>())
    if (vtkDataArray* const array = data->GetArray(name.c_str()))
      data->AddArray(shaped(plan, array)); // takes the place of the one of this name
}

/// A spacing from outside: the image is as large again, about the same corner.
void resize(vtkImageData* image, double pixelSize)
{
  std::array<double, 3> origin{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    origin[axis] = image->GetOrigin()[axis] / image->GetSpacing()[axis] * pixelSize;
  image->SetOrigin(origin.data());
  image->SetSpacing(pixelSize, pixelSize, pixelSize);
  setFieldText(image, "pixel_size_source", "option");
}

std::unique_ptr<Volume> selected(std::unique_ptr<Volume> volume, const Plan& plan)
{
  requireArrays(volume->sample(), plan.words.arrays);
  return changed(std::move(volume),
    [&plan](vtkImageData* image)
    {
      select(image->GetPointData(), plan.words.arrays);
      select(image->GetCellData(), plan.words.arrays);
      shape(plan, image->GetPointData());
      shape(plan, image->GetCellData());
      if (plan.pixelSize)
        resize(image, *plan.pixelSize);
    });
}

/// Where a format has one array of pixels, that of cells becomes pixels at their centres.
std::unique_ptr<Volume> onePixelArray(std::unique_ptr<Volume> volume, const Plan& plan)
{
  vtkImageData* const sample = volume->sample();
  auto names = namesOf(sample->GetPointData());
  const auto cells = namesOf(sample->GetCellData());
  const bool inCells = names.empty();
  names.insert(names.end(), cells.begin(), cells.end());
  if (names.empty())
    throw InputError(fmt::format("'{}' holds no array", plan.words.raw.file), "nothing can be converted");
  if (names.size() > 1)
  {
    throw InputError(fmt::format("'{}' holds {} arrays ({}), and {} takes one", plan.words.raw.file, names.size(),
                       quotedList(names, "and"), plan.ending),
      "choose one with --array NAME, or write .vti or .hdf");
  }
  return inCells ? cellsAsPoints(std::move(volume)) : std::move(volume);
}

/// The least and the largest whole number, read slab by slab.
std::array<double, 2> wholeRange(Session& session, Volume& volume)
{
  std::array<double, 2> all{ std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity() };
  forSlabs(session, volume,
    [&](vtkDataArray* values, int, int)
    {
      double range[2];
      values->GetRange(range, 0);
      all = { std::min(all[0], range[0]), std::max(all[1], range[1]) };
    });
  return all;
}

/// Values of a type that the format has. Whole numbers that fit into 8 or 16 bits lose nothing.
/// @param noted takes the type that they had
std::unique_ptr<Volume> holdable(Session& session, std::unique_ptr<Volume> volume, const Plan& plan, int& noted)
{
  vtkDataArray* const array = onlyArray(volume->sample());
  const int type = array->GetDataType();
  const int components = array->GetNumberOfComponents();
  if (plan.target.holds(type, components))
    return volume;
  const std::string name = nameOf(array);
  if (components != 1)
  {
    throw InputError(fmt::format("'{}' has {} values of {} a pixel, and {} holds {}", name, components, typeName(type),
                       plan.ending, plan.target.values),
      "write .vti, .hdf, .mhd or .nhdr");
  }
  if (isReal(type) || !plan.target.holds(VTK_UNSIGNED_CHAR, 1))
  {
    throw InputError(
      fmt::format("'{}' holds {} values, and {} holds {}", name, typeName(type), plan.ending, plan.target.values),
      "map them to greys with --range LOW,HIGH, or write .tif, .mhd, .nhdr, .vti or .hdf, which keep them");
  }
  const auto [least, most] = wholeRange(session, *volume);
  if (least < 0 || most > std::numeric_limits<std::uint16_t>::max())
  {
    throw InputError(fmt::format("'{}' holds whole numbers from {:.0f} to {:.0f}, and {} holds {}", name, least, most,
                       plan.ending, plan.target.values),
      "map them to greys with --range LOW,HIGH, or write .tif, .mhd, .nhdr, .vti or .hdf, which keep them");
  }
  noted = type;
  const int small = most > 255 ? VTK_UNSIGNED_SHORT : VTK_UNSIGNED_CHAR;
  return changed(std::move(volume),
    [small](vtkImageData* image)
    {
      const auto values = cast(onlyArray(image), small, true);
      image->GetPointData()->Initialize();
      image->GetPointData()->SetScalars(values);
    });
}

void prepareImage(Session& session, Step& step, Plan& plan)
{
  step.volume = selected(std::move(step.volume), plan);
  if (!plan.target.manyArrays)
  {
    step.volume = onePixelArray(std::move(step.volume), plan);
    step.volume = holdable(session, std::move(step.volume), plan, step.noted);
    return;
  }
  vtkImageData* const sample = step.volume->sample();
  if (plan.ending == ".vti" || sample->GetCellData()->GetNumberOfArrays() == 0)
    return;
  if (sample->GetPointData()->GetNumberOfArrays() == 0)
  {
    step.volume = cellsAsPoints(std::move(step.volume));
  }
  else if (!plan.words.lossy)
  {
    throw InputError(fmt::format("the image holds arrays at points and in cells ({}), and {} has no place for those",
                       quotedList(namesOf(sample->GetCellData()), "and"), plan.ending),
      "choose those of one kind with --array NAME, write .vti, or leave those in cells out with --lossy");
  }
  else
  {
    step.volume = changed(
      std::move(step.volume), [](vtkImageData* image) { image->GetCellData()->Initialize(); });
  }
}

void preparePoints(Step& step, Plan& plan)
{
  if (plan.words.phases.empty()) // of an image they were those of the image
    requireArrays(step.points, plan.words.arrays);
  const auto points = vtkSmartPointer<vtkPointSet>::Take(step.points->NewInstance());
  points->ShallowCopy(step.points);
  select(points->GetPointData(), plan.words.arrays);
  select(points->GetCellData(), plan.words.arrays);
  shape(plan, points->GetPointData());
  shape(plan, points->GetCellData());
  step.points = points;
  if (plan.ending == ".csv" && !onlyPoints(points) && !plan.words.lossy)
  {
    throw InputError(
      fmt::format("'{}' has {} cells, of which a table keeps nothing", plan.words.raw.file, points->GetNumberOfCells()),
      "write .vtp, .vtu or .hdf, or take the points alone with --lossy");
  }
  if (plan.target.writes == Surface && !onlySurface(points) && !plan.words.lossy)
  {
    throw InputError(fmt::format("'{}' holds arrays, or cells that are no polygons, and {} keeps polygons alone",
                       plan.words.raw.file, plan.ending),
      "write .vtp, or take the polygons alone with --lossy");
  }
}

/// The surface of phases in place of the image that they are in.
void takeSurface(Session& session, Step& step, const Plan& plan)
{
  const std::string& file = plan.words.raw.file;
  if (step.volume == nullptr)
    throw InputError(
      fmt::format("'{}' holds no image, and --phase makes a surface of an image's phases", file), "give a volume");
  step.volume = selected(std::move(step.volume), plan);
  if (plan.words.arrays.empty() && step.volume->sample()->GetPointData()->HasArray("phase"))
  {
    step.volume = changed(
      std::move(step.volume),
      [](vtkImageData* image)
      {
        select(image->GetPointData(), { "phase" });
        image->GetCellData()->Initialize();
      });
  }
  step.volume = onePixelArray(std::move(step.volume), plan);
  if (fieldText(step.volume->sample(), "pixel_size_source") == "none")
    session.warn(fmt::format("'{}' tells no pixel size: the surface is in pixels; --pixel-size METRES tells it", file));
  step.points = surfaceOf(session, *step.volume, plan.words.phases, plan.words.smoothing);
  step.volume = nullptr;
}

/// What the source cannot be in the target.
void requireKind(Step& step, const Plan& plan)
{
  if (step.table != nullptr)
  {
    if ((plan.target.writes & Numbers) == 0)
    {
      throw ParameterError(
        fmt::format("the arrays of a checkpoint have no place, and {} needs one", plan.ending), "write them as .csv");
    }
    return;
  }
  if (step.volume == nullptr && (plan.target.writes & (Points | Surface)) == 0)
  {
    if (!onlyPoints(step.points))
    {
      throw InputError(fmt::format("'{}' holds points with {} cells, and {} holds an image", plan.words.raw.file,
                         step.points->GetNumberOfCells(), plan.ending),
        "write .vtp, .vtu or .hdf");
    }
    step.volume = wholeVolume(gridOf(step.points));
    step.points = nullptr;
  }
  if (step.volume != nullptr && (plan.target.writes & Image) == 0)
  {
    const bool surface = plan.target.writes == Surface;
    throw InputError(fmt::format("'{}' holds an image, and {} holds {}", plan.words.raw.file, plan.ending,
                       surface ? "surfaces" : "points"),
      surface ? "name the phase of a volume whose surface you want: --phase NAME"
              : "write .vti or .hdf; a table (.csv) has a line for each node, and can become points");
  }
}

vtkDataObject* headOf(Step& step)
{
  if (step.volume != nullptr)
    return step.volume->sample();
  return step.points != nullptr ? static_cast<vtkDataObject*>(step.points) : step.table;
}

/// Writes a record, unless it is empty, and the time where there is one, into the field data.
void stamp(Step& step, const std::string& record, std::optional<double> time)
{
  const auto mark = [record, time](vtkDataObject* data)
  {
    if (!record.empty())
      setProvenance(data, record);
    if (time)
      setFieldNumbers(data, "TimeValue", std::array{ *time });
  };
  if (step.volume == nullptr)
  {
    mark(headOf(step));
    return;
  }
  step.volume = changed(std::move(step.volume), mark);
}

Plan planOf(const ConversionWords& o, const Format& target, const std::string& ending)
{
  Plan plan{ o, target, ending };
  if (!o.type.empty())
    plan.type = typeNamed(numberTypes()[oneOf("--type", o.type, numberTypes())]);
  if (o.range)
  {
    if (!((*o.range)[0] < (*o.range)[1]))
      throw ParameterError(
        fmt::format("range {:g} to {:g} is empty", (*o.range)[0], (*o.range)[1]), "give the lower end first");
    plan.range = *o.range;
    if (plan.type && *plan.type != VTK_UNSIGNED_CHAR && *plan.type != VTK_UNSIGNED_SHORT)
    {
      throw ParameterError("--range maps values to the greys of u8 or u16, and --type says " + o.type,
        "leave --type out, or take u8 or u16");
    }
  }
  plan.pixelSize = o.raw.read.pixelSize;
  if (o.smoothing > 0 && o.phases.empty())
  {
    throw ParameterError(
      fmt::format("smooth {} without a phase", o.smoothing), "it is for surfaces: --phase NAME --smooth 20");
  }
  if (target.write == nullptr)
  {
    throw ParameterError(
      fmt::format("-o '{}': JPEG blurs the values and is not written", o.output), "end the name in .png");
  }
  return plan;
}

Json arraysJson(vtkDataObject* data)
{
  Json arrays = Json::array();
  auto* const set = vtkDataSet::SafeDownCast(data);
  if (set == nullptr)
    return arrays;
  for (vtkFieldData* const from : std::array<vtkFieldData*, 2>{ set->GetPointData(), set->GetCellData() })
  {
    for (int i = 0; i < from->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* const array = from->GetAbstractArray(i);
      arrays.push_back({ { "name", nameOf(array) }, { "type", typeName(array->GetDataType()) },
        { "components", array->GetNumberOfComponents() }, { "in", set->GetCellData() == from ? "cells" : "points" } });
    }
  }
  return arrays;
}

void describeStep(Json& json, Step& step)
{
  if (step.volume != nullptr)
  {
    const auto& e = step.volume->extent();
    json["kind"] = "image";
    json["size"] = { e[1] - e[0] + 1, e[3] - e[2] + 1, e[5] - e[4] + 1 };
  }
  else if (step.points != nullptr)
  {
    json["kind"] =
      step.points->GetClassName() == std::string("vtkUnstructuredGrid") ? "unstructured grid" : "poly data";
    json["points"] = step.points->GetNumberOfPoints();
    json["cells"] = step.points->GetNumberOfCells();
  }
  else
  {
    json["kind"] = "table";
    json["rows"] = step.table->GetNumberOfRows();
  }
  json["arrays"] = arraysJson(headOf(step));
}

Json surfaceJson(const ConversionWords& o, vtkPointSet* surface)
{
  vtkNew<vtkMassProperties> measured;
  measured->SetInputData(surface);
  measured->Update();
  return { { "phases", o.phases }, { "triangles", surface->GetNumberOfCells() }, { "area", measured->GetSurfaceArea() },
    { "volume", measured->GetVolume() } };
}

/// The step that was asked for, if one was. @throws ParameterError
std::optional<std::size_t> chosenStep(const ConversionWords& o, const Source& source)
{
  if (o.step && (*o.step < 0 || static_cast<std::size_t>(*o.step) >= source.files.size()))
  {
    throw ParameterError(fmt::format("step {} is none of the {} steps", *o.step, source.files.size()),
      fmt::format("steps count from 0 to {}", source.files.size() - 1));
  }
  return o.step;
}

/// A file that lists the files of steps.
bool isList(const std::string& ending)
{
  return ending == ".pvd" || ending == ".xdmf" || ending == ".xmf";
}

std::vector<std::size_t> stepsOf(const ConversionWords& o, const Source& source, const std::string& ending)
{
  if (const auto step = chosenStep(o, source))
    return { *step };
  if (source.files.size() > 1 && !isList(ending) && !isPattern(o.output))
  {
    throw ParameterError(
      fmt::format("'{}' is a series of {} steps, and '{}' one file", o.raw.file, source.files.size(), o.output),
      "choose one with --step NUMBER (from 0), or write -o NAME.pvd, NAME.xdmf or a pattern such as -o NAME_%03d.vti");
  }
  std::vector<std::size_t> steps(source.files.size());
  std::iota(steps.begin(), steps.end(), std::size_t{ 0 });
  return steps;
}

/// The time of a step, where the source or the step itself tells one.
std::optional<double> timeOf(const Source& source, std::size_t number, vtkDataObject* head)
{
  if (!source.times.empty())
    return source.times[number];
  const auto known = source.series ? fieldNumbers(head, "TimeValue") : std::vector<double>();
  return known.size() == 1 ? std::optional(known.front()) : std::nullopt;
}

/// Data that somebody has in memory, with arrays of its own to be changed. @throws InputError
Step stepOf(vtkDataObject* data)
{
  const auto own = vtkSmartPointer<vtkDataObject>::Take(data->NewInstance());
  own->ShallowCopy(data);
  if (auto* const image = vtkImageData::SafeDownCast(own))
    return { wholeVolume(image) };
  if (vtkPolyData::SafeDownCast(own) != nullptr || vtkUnstructuredGrid::SafeDownCast(own) != nullptr)
    return { .points = vtkPointSet::SafeDownCast(own) };
  if (auto* const table = vtkTable::SafeDownCast(own))
    return { .table = table };
  throw InputError(fmt::format("a {} cannot be written", data->GetClassName()),
    "give an image, poly data, an unstructured grid or a table");
}

/// Selects and changes its arrays, and makes it what the target can hold.
void prepare(Session& session, Step& step, Plan& plan)
{
  if (step.volume != nullptr)
    prepareImage(session, step, plan);
  else if (step.points != nullptr)
    preparePoints(step, plan);
}

/// The ending of the file of VTK that holds what a step is.
const char* endingFor(const Step& step)
{
  return step.volume != nullptr ? ".vti" : vtkPolyData::SafeDownCast(step.points) != nullptr ? ".vtp" : ".vtu";
}

/// The name that a step's files have, by what the step is.
std::string stepName(const std::string& output, const std::string& ending, std::size_t number, bool several, Step& step)
{
  if (!isList(ending))
    return numbered(output, number);
  const bool steps = ending == ".pvd" || several;
  return withSuffix(std::filesystem::path(output).replace_extension(ending == ".pvd" ? endingFor(step) : ".h5"),
    steps ? fmt::format("_{:03}", number) : "")
    .string();
}

} // namespace

Converted convert(Session& session, const ConversionWords& o, const std::string& command, vtkDataObject* data)
{
  const auto start = Clock::now();
  const std::string& file = o.raw.file;
  const std::string ending = endingOf(o.output.c_str());
  const Format& named = ending == ".pvd" ? formatOf("-o", "steps.vti") : formatOf("-o", o.output);
  Reading reading{ o.raw, o.arrays, o.lossy };
  (void)planOf(o, named, ending);
  Source source;
  if (data == nullptr)
    source = findSource(file, reading);
  else
    source.files = { file };
  const std::vector<std::size_t> steps = stepsOf(o, source, ending);
  const bool several = steps.size() > 1;

  Converted result;
  Json& json = result.report;
  json["file"] = file;
  json["format"] = data == nullptr ? source.format->name : data->GetClassName();
  std::vector<std::string> names;
  std::vector<std::string> stepNames;
  std::vector<double> times;
  std::vector<std::string> grids;
  std::vector<OutputFile> done;
  std::vector<OutputFile> list;
  if (isList(ending))
    list.emplace_back(o.output, o.overwrite);
  std::optional<io::Provenance> run;
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    Step step = data == nullptr ? source.open(steps[i], reading) : stepOf(data);
    if (!o.phases.empty())
      takeSurface(session, step, planOf(o, named, ending));
    const std::string name = stepName(o.output, ending, several || isList(ending) ? i : steps[i], several, step);
    const Format& target = ending == ".pvd" ? formatOf("-o", name) : named;
    Plan plan = planOf(o, target, ending == ".pvd" ? endingOf(name.c_str()) : ending);
    if (several && !isList(ending) && target.slices)
    {
      throw ParameterError(fmt::format("'{}' is a series of {} steps, and numbered pictures are the slices of a volume",
                             file, steps.size()),
        "choose one with --step NUMBER, or draw them with lamella snapshot");
    }
    requireKind(step, plan);
    prepare(session, step, plan);
    std::vector<OutputFile> files;
    // Slices have the numbers of a pattern for themselves.
    for (const std::string& one : target.files(target.slices ? o.output : name, step))
      files.emplace_back(one, o.overwrite);
    if (!run)
      run = recordRun(session, command, data == nullptr ? file : "", provenance(headOf(step)));
    const std::optional<double> time = timeOf(source, steps[i], headOf(step));
    stamp(step, io::toJson(*run), time);
    if (i == 0)
      describeStep(json, step);
    if (i == 0 && !o.phases.empty())
      json["surface"] = surfaceJson(o, step.points);
    if (ending != ".pvd" && isList(ending))
    {
      const std::string values = std::filesystem::path(name).filename().string();
      grids.push_back(xdmfGrid(*step.volume, values, several ? std::optional(time.value_or(i)) : time));
    }
    target.write({ session, step, files });
    times.push_back(time.value_or(static_cast<double>(i)));
    stepNames.push_back(std::filesystem::path(name).filename().string());
    for (OutputFile& one : files)
    {
      if (!one.inMemory()) // as what would lie beside standard output
        names.push_back(one.path().string());
      done.push_back(std::move(one));
    }
    Session::checkInterrupt();
  }
  for (OutputFile& one : list)
  {
    one.write(ending == ".pvd" ? collectionText(stepNames, times) : xdmfText(grids));
    names.push_back(one.path().string());
  }
  const PartFile::Hold together;
  for (OutputFile& one : done)
    one.commit();
  for (OutputFile& one : list)
    one.commit();
  for (const std::string& warning : reading.warnings)
    session.warn(warning);
  json["steps"] = steps.size();
  json["times"] = times;
  json["files"] = names;
  json["seconds"] = secondsSince(start);
  result.run = *run;
  return result;
}

Loaded load(Session& session, const ConversionWords& o)
{
  Reading reading{ o.raw, o.arrays, o.lossy };
  const std::string& file = o.raw.file;
  const Source source = findSource(file, reading);
  const auto chosen = chosenStep(o, source);
  if (!chosen && source.files.size() > 1)
  {
    throw ParameterError(
      fmt::format("'{}' is a series of {} steps", file, source.files.size()), "choose one with --step NUMBER (from 0)");
  }
  const std::size_t number = chosen.value_or(0);
  Step step = source.open(number, reading);
  const std::string ending = endingFor(step);
  Plan plan = planOf(o, formatOf("", "data" + ending), ending);
  prepare(session, step, plan);
  stamp(step, "", timeOf(source, number, headOf(step)));
  Loaded loaded;
  loaded.steps = source.files.size();
  loaded.times = source.times;
  loaded.data = step.volume != nullptr ? readAll(session, *step.volume).Get() : headOf(step);
  session.endProgress();
  for (const std::string& warning : reading.warnings)
    session.warn(warning);
  return loaded;
}

} // namespace lamella::cli
