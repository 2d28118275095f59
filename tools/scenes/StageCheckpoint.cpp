#include "scenes/StageCheckpoint.h"

#include "scenes/Results.h"
#include "session/OutputFile.h"

#include <algorithm>
#include <system_error>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

constexpr const char* fileEnding = ".checkpoint.h5";
constexpr const char* heldEnding = ".held"; // behind the checkpoint's name; an empty file: there was none
constexpr const char* stepsEnding = ".steps.jsonl";

/// Files of a folder whose names hold this; none where there is no folder.
std::vector<fs::path> filesWith(const fs::path& folder, const std::string& ending)
{
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().filename().string().find(ending) != std::string::npos)
      files.push_back(at->path());
  return files;
}

} // namespace

StageCheckpoint::StageCheckpoint(const fs::path& folder, const std::string& stage)
  : file_(folder / (stage + fileEnding))
  , steps_(folder / (stage + stepsEnding))
{
  makeFolder(folder);
  release();
}

bool StageCheckpoint::there() const
{
  std::error_code ignored;
  return fs::is_regular_file(file_, ignored);
}

std::vector<Json> StageCheckpoint::steps() const
{
  std::vector<Json> steps;
  std::ifstream file(steps_);
  for (std::string line; std::getline(file, line);)
  {
    Json step = Json::parse(line, nullptr, false);
    if (!step.is_object() || step.value("number", std::size_t{ 0 }) != steps.size())
      break;
    steps.push_back(std::move(step));
  }
  return steps;
}

void StageCheckpoint::begin(const std::vector<Json>& steps)
{
  lines_.close();
  std::string text;
  for (const Json& step : steps)
    text += step.dump() + "\n";
  OutputFile file(steps_, true);
  file.write(text);
  file.commit();
  lines_.open(steps_, std::ios::app);
}

void StageCheckpoint::add(const Json& step)
{
  lines_ << step.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  if (!lines_)
    throw OutputError("cannot write '" + steps_.string() + "'", "make room on the disk; the same command goes on");
}

void StageCheckpoint::hold()
{
  std::error_code ignored;
  const fs::path held = file_.string() + heldEnding;
  if (fs::exists(held, ignored))
    return;
  if (there())
    fs::rename(file_, held, ignored);
  else
    std::ofstream(held).close();
}

void StageCheckpoint::release()
{
  std::error_code ignored;
  const fs::path held = file_.string() + heldEnding;
  if (!fs::exists(held, ignored))
    return;
  fs::remove(file_, ignored);
  if (fs::is_empty(held, ignored))
    fs::remove(held, ignored);
  else
    fs::rename(held, file_, ignored);
}

void StageCheckpoint::remove()
{
  lines_.close();
  std::error_code ignored;
  fs::remove(file_, ignored);
  fs::remove(steps_, ignored);
}

void StageCheckpoint::removeAll(const fs::path& folder)
{
  std::error_code ignored;
  for (const char* const ending : { fileEnding, stepsEnding })
    for (const fs::path& file : filesWith(folder, ending))
      fs::remove(file, ignored);
}

bool StageCheckpoint::any(const fs::path& folder)
{
  const std::vector<fs::path> files = filesWith(folder, fileEnding);
  return std::ranges::any_of(
    files, [](const fs::path& file) { return file.filename().string().ends_with(fileEnding); });
}

} // namespace lamella::cli
