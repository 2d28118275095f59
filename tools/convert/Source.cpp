#include "convert/Source.h"

#include "files/GridFile.h"

#include "GridReaders.h"
#include "core/Error.h"
#include "pictures/Slices.h"

#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

/// Files that a collection names, in the order of their times. @throws InputError
Source collection(const std::string& path, Reading& reading)
{
  requireFile(path);
  (void)VtkMessages::takeErrors();
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(path.c_str()));
  (void)VtkMessages::takeErrors();
  vtkXMLDataElement* const list = root == nullptr ? nullptr : root->FindNestedElementWithName("Collection");
  if (list == nullptr)
    throw InputError("'" + path + "' is not a whole .pvd file", "make or copy it again");
  std::vector<std::pair<double, std::string>> steps;
  std::vector<std::string> missing;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* const entry = list->GetNestedElement(i);
    if (std::string_view(entry->GetName()) != "DataSet")
      continue;
    const char* const file = entry->GetAttribute("file");
    double time = static_cast<double>(i);
    entry->GetScalarAttribute("timestep", time);
    if (file == nullptr)
      throw InputError(fmt::format("entry {} of '{}' names no file", i + 1, path), "make or copy it again");
    const fs::path named(file);
    const fs::path place = named.is_absolute() ? named : fs::path(path).parent_path() / named;
    if (!fs::exists(place))
    {
      missing.push_back(place.string());
      continue;
    }
    if (std::ranges::any_of(steps, [&](const auto& step) { return step.first == time; }))
    {
      throw InputError(fmt::format("'{}' has several parts at the time {}", path, time),
        "convert the parts one by one: they are files of their own");
    }
    steps.emplace_back(time, place.string());
  }
  if (!missing.empty() && !reading.lossy)
  {
    throw InputError(fmt::format("'{}' names '{}', which is not there ({} of {} steps)", path, missing.front(),
                       missing.size(), missing.size() + steps.size()),
      "bring it back, or leave the missing steps out with --lossy");
  }
  if (!missing.empty())
  {
    reading.warnings.push_back(
      fmt::format("{} steps are missing and left out, the first is '{}'", missing.size(), missing.front()));
  }
  if (steps.empty())
    throw InputError("'" + path + "' names no step that is there", "look at what wrote it");
  std::ranges::sort(steps);
  Source source;
  source.series = true;
  for (const auto& [time, file] : steps)
  {
    source.times.push_back(time);
    source.files.push_back(file);
  }
  source.format = &formatOf("a step of '" + path + "':", source.files.front());
  return source;
}

bool isPicture(const Format& format)
{
  return std::ranges::find(format.endings, ".png") != format.endings.end() ||
    std::ranges::find(format.endings, ".tif") != format.endings.end() ||
    std::ranges::find(format.endings, ".jpg") != format.endings.end();
}

} // namespace

Source findSource(const std::string& path, Reading& reading)
{
  std::error_code ignored;
  Source source;
  const std::string ending = endingOf(path.c_str());
  if (fs::is_directory(path, ignored))
  {
    source.format = &formatOf("", "slices.png"); // what they are is told by their first bytes
    source.files = { path };
    return source;
  }
  if (ending == ".pvd")
    return collection(path, reading);
  if (!micrograph::isSlicePattern(path))
  {
    requireFile(path);
    if (ending.ends_with(".gz") && ending != ".nii.gz")
      throw InputError("'" + path + "' is packed", "unpack it first: gunzip --keep " + path);
    source.format = &formatOf("the file", path);
    if (source.format->open == nullptr)
    {
      throw InputError(fmt::format("'{}': {} is written and not read", path, source.format->name),
        ending[1] == 'x' ? "it points to HDF5 files beside it, .h5: read those" : "read what it was made from");
    }
    source.files = { path };
    return source;
  }
  const micrograph::Slices slices = micrograph::listSlices(path);
  source.format = &formatOf("the file", slices.files.front().string());
  if (isPicture(*source.format))
  {
    source.files = { path };
    return source;
  }
  source.series = true;
  for (std::string warning : slices.warnings)
  {
    warning.erase(std::min(warning.size(), warning.find(';')));
    if (const std::size_t at = warning.find("slices"); at != std::string::npos)
      warning.replace(at, 6, "steps");
    if (!reading.lossy)
      throw InputError(warning, "add them, or go on without them with --lossy");
    reading.warnings.push_back(warning);
  }
  for (const fs::path& file : slices.files)
    source.files.push_back(file.string());
  return source;
}

Step Source::open(std::size_t step, Reading& reading) const
{
  const std::string& file = files.at(step);
  return format->open(file, reading);
}

} // namespace lamella::cli
