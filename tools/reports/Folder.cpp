#include "reports/Folder.h"

#include "reports/DataTable.h"
#include "reports/Pictures.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

constexpr int deepest = 3;                                         // levels of folders below the first
constexpr const char* sceneMark = "lamella-results.json";          // in the folder that a scene's samples lie in
constexpr std::size_t mostPictures = 100;                          // in a page that nobody ordered
constexpr std::size_t mostTables = 50;                             //
constexpr std::uintmax_t largestText = std::uintmax_t{ 16 } << 20; // of JSON and scenes [bytes]
constexpr int deepestJson = 100;                                   // levels in an object

std::string textOf(const fs::path& path)
{
  std::error_code none;
  if (fs::file_size(path, none) > largestText)
    throw InputError("'" + path.filename().string() + "' is larger than 16 MB", "");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError("'" + path.filename().string() + "' cannot be read", "");
  return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}

/// No more than so many, the first ones; says how many there are besides.
template <typename T>
void keepFirst(std::vector<T>& all, std::size_t most, const char* what, std::vector<std::string>& notes)
{
  if (all.size() > most)
  {
    notes.push_back(
      fmt::format("{} of {} {} are shown, the first by name; report.json can choose others", most, all.size(), what));
    all.resize(most);
  }
}

void readJson(const fs::path& path, const std::string& name, bool beside, Found& found, Problems& problems)
{
  try
  {
    const auto shallow = [&](int depth, cli::Json::parse_event_t, cli::Json&)
    {
      if (depth > deepestJson)
        throw InputError("'" + name + "' is nested too deep", "");
      return true;
    };
    cli::Json json = cli::Json::parse(textOf(path), shallow, false);
    if (json.is_discarded())
    {
      problems.push_back("'" + name + "' is no whole JSON");
    }
    else if (json.is_object())
    {
      (beside ? found.besides : found.reports).push_back({ name, std::move(json) });
    }
    else
    {
      std::error_code none;
      found.others.emplace_back(name, fs::file_size(path, none));
    }
  }
  catch (const Error& error)
  {
    problems.emplace_back(error.what());
  }
}

/// "a/b/c.csv" → "a/b"
std::string folderOf(const std::string& name)
{
  return fs::path(name).parent_path().string();
}

std::string nameOf(const std::string& name)
{
  return fs::path(name).filename().string();
}

/// Charts of the table's numbers over its first column, if that rises from row to row.
std::vector<CurvesPlan> curvesOf(const std::string& file, const DataTable& table)
{
  if (table.rows() < fewestPoints || table.names().size() < 2 || !table.isNumeric(0))
    return {};
  const std::vector<double> x = table.numbers(0);
  if (std::adjacent_find(x.begin(), x.end(), [](double a, double b) { return !(a < b); }) != x.end())
    return {};
  std::vector<CurvesPlan> curves;
  for (std::size_t column = 1; column < table.names().size() && curves.size() < drawnColumns; ++column)
  {
    if (table.isNumeric(column))
    {
      const std::string& name = table.names()[column];
      curves.push_back({ file, table.names()[0], { name }, "", "", table.label(table.names()[0]), table.label(name), 1,
        1, false, false, false, literal(nameOf(file)) + ": " + literal(name) });
    }
  }
  return curves;
}

} // namespace

fs::path requireWithin(const fs::path& folder, const fs::path& file)
{
  std::error_code failed;
  const fs::path root = fs::canonical(folder, failed);
  const fs::path real = failed ? fs::path() : fs::weakly_canonical(file, failed);
  if (failed || std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first != root.end())
  {
    throw InputError("'" + file.lexically_relative(folder).string() + "' is a link out of the folder, and not shown",
      "put the file itself there");
  }
  return file;
}

Found look(const fs::path& folder, const fs::path& own, Problems& problems)
{
  std::error_code failed;
  const fs::file_status status = fs::status(folder, failed);
  if (!fs::exists(status))
    throw InputError("there is no folder '" + folder.string() + "'", "check the name");
  if (!fs::is_directory(status))
    throw InputError("'" + folder.string() + "' is a file, not a folder", "give the folder that the results lie in");
  std::vector<fs::path> files;
  fs::recursive_directory_iterator walk(folder, failed);
  for (; !failed && walk != fs::recursive_directory_iterator(); walk.increment(failed))
  {
    const bool hidden = walk->path().filename().string().starts_with('.');
    std::error_code none;
    if (walk->is_directory(none) && (hidden || walk.depth() >= deepest))
    {
      walk.disable_recursion_pending();
    }
    else if (!hidden && walk->is_regular_file(none) && !fs::equivalent(walk->path(), own, none))
    {
      try
      {
        files.push_back(requireWithin(folder, walk->path()));
      }
      catch (const Error& error)
      {
        problems.emplace_back(error.what());
      }
    }
  }
  if (failed)
    throw InputError("cannot read the folder '" + folder.string() + "': " + failed.message(), "check its permissions");
  // Files of a folder before those of the folders in it.
  std::sort(files.begin(), files.end(),
    [](const fs::path& a, const fs::path& b)
    { return std::pair(a.parent_path(), a.filename()) < std::pair(b.parent_path(), b.filename()); });
  Found found;
  std::error_code none;
  const bool scene = fs::exists(folder / sceneMark, none);
  std::size_t finished = 0;
  for (const fs::path& path : files)
  {
    const std::string name = path.lexically_relative(folder).string();
    const std::string ending = path.extension().string();
    if (name == "report.json" || name == sceneMark)
      continue;
    if (scene && path.filename() == "record.json") // of a sample; its numbers are in the tables
    {
      ++finished;
      continue;
    }
    if (isPicture(path))
    {
      found.pictures.push_back(name);
    }
    else if (ending == ".csv")
    {
      found.tables.push_back(name);
    }
    else if (ending == ".json")
    {
      readJson(path, name, !path.stem().extension().empty(), found, problems);
    }
    else if (ending == ".toml")
    {
      try
      {
        found.scenes.emplace_back(name, textOf(path));
      }
      catch (const Error& error)
      {
        problems.emplace_back(error.what());
      }
    }
    else
    {
      found.others.emplace_back(name, fs::file_size(path, none));
    }
  }
  found.scene = scene;
  if (scene)
    found.notes.push_back(fmt::format("Samples that are finished: {}", finished));
  if (files.empty())
  {
    throw InputError(
      "the folder '" + folder.string() + "' is empty", "give the folder that a command or a study wrote to");
  }
  return found;
}

Plan planOf(const fs::path& path, const Found& all)
{
  Found found = all;
  Plan plan;
  std::error_code none;
  plan.title = fs::weakly_canonical(path, none).filename().string();
  std::map<std::string, SectionPlan> sections; // by folder; the first one is the folder itself
  const auto sectionOf = [&](const std::string& file) -> SectionPlan&
  {
    SectionPlan& section = sections[folderOf(file)];
    section.title = folderOf(file).empty() ? "Results" : folderOf(file);
    return section;
  };
  keepFirst(found.pictures, mostPictures, "pictures", found.notes);
  keepFirst(found.tables, mostTables, "tables", found.notes);
  for (const std::string& file : found.pictures)
    sectionOf(file).figures.push_back({ file, "", literal(nameOf(file)), nameOf(file) });
  for (const std::string& file : found.tables)
  {
    SectionPlan& section = sectionOf(file);
    TablePlan table{ file, literal(nameOf(file)), {}, shownRows };
    try
    {
      const std::vector<CurvesPlan> curves = curvesOf(file, DataTable(path / file));
      section.curves.insert(section.curves.end(), curves.begin(), curves.end());
    }
    catch (const Error&) // NOLINT(bugprone-empty-catch): the page says what is wrong with the table
    {
    }
    section.tables.push_back(std::move(table));
  }
  for (auto& [name, section] : sections)
    plan.sections.push_back(std::move(section));
  for (const std::string& note : found.notes)
    plan.text += "\n\n" + note + ".";
  return plan;
}

} // namespace lamella::reports
