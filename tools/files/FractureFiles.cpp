#include "files/FractureFiles.h"

#include "files/Collection.h"
#include "files/GridFile.h"
#include "session/Stopped.h"
#include "session/Text.h"
#include "session/Units.h"
#include "session/Workspace.h"

#include "vtkLatticeConversion.h"

#include "io/Checkpoint.h"
#include "io/Provenance.h"

#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

namespace lamella::cli
{

namespace
{

/// What is left of a run that ended before its time, and how to go on from it; empty where no checkpoint was asked for.
std::string howToContinue(const CheckpointWords& words, const KeptRun& run)
{
  // States that came before it stopped are there already.
  const std::string replace =
    run.leaves() && run.commandLine.find(" --overwrite") == std::string::npos ? " --overwrite" : "";
  const std::int64_t last = run.last();
  const bool same = !words.continueFrom.empty() && io::sameFile(words.file, words.continueFrom);
  const auto quoted = [](const std::string& name) { return io::quoteCommand(std::array{ name }); };
  if (last > 0)
  {
    const std::string launcher = run.ranks > 1 ? fmt::format("mpirun -n {} ", run.ranks) : "";
    const std::string go = same ? "the same command goes on from it"
      : words.continueFrom.empty()
      ? "go on from it with: " + launcher + run.commandLine + replace + " --continue " + quoted(words.file)
      : "go on from it with the same command but" + replace + " --continue " + quoted(words.file);
    return fmt::format("the checkpoint '{}' stands after {} {}; {}", words.file, last, run.unit, go);
  }
  if (!words.continueFrom.empty() && std::filesystem::exists(words.continueFrom))
    return "no checkpoint was written since; the same command goes on from '" + words.continueFrom + "' again";
  return words.file.empty() ? ""
    : checkedPacing(words).seconds
    ? "no checkpoint was written yet: the first comes after " + words.every + " (--checkpoint-every)"
    : fmt::format(
        "no checkpoint was written yet: the first comes after {} {} (--checkpoint-every)", run.every(), run.unit);
}

} // namespace

StateWriter::StateWriter(const std::string& name, std::size_t states, bool overwrite, const char* ending,
  const std::array<const char*, 2>& what)
{
  if (name.empty())
    return;
  if (std::filesystem::path(name).extension() != ending)
  {
    throw ParameterError(fmt::format("-o '{}': {} are written as {}", name, what[0], ending),
      fmt::format("end the name in {}; {}", ending, what[1]));
  }
  if (states == 1 || Workspace::holds(name))
  {
    files_.emplace_back(name, overwrite);
    return;
  }
  name_ = states == 0 ? name : "";
  overwrite_ = overwrite;
  for (std::size_t i = 0; i < std::max<std::size_t>(states, 1); ++i)
    files_.emplace_back(withSuffix(name, fmt::format("_{:03}", i)), overwrite);
  collection_.emplace_back(std::filesystem::path(name).replace_extension(".pvd"), overwrite);
}

void StateWriter::needs(std::uint64_t bytes) const
{
  if (!files_.empty())
    files_.front().needs(bytes * files_.size());
}

std::vector<std::string> StateWriter::write(std::span<vtkDataObject* const> states, const std::string& provenance)
{
  std::vector<std::string> names;
  std::vector<double> times;
  const std::vector<double> before =
    states.empty() ? std::vector<double>() : fieldNumbers(states.front(), "states_before");
  first_ = files_.size() > 1 && !before.empty() ? static_cast<std::size_t>(before.front()) : 0;
  if (!files_.empty() && files_.front().inMemory())
    return keep(states, provenance);
  for (std::size_t i = 0; !files_.empty() && i < states.size(); ++i)
  {
    vtkDataObject* const state = states[i];
    if (!name_.empty() && i == files_.size())
      files_.emplace_back(withSuffix(name_, fmt::format("_{:03}", i)), overwrite_);
    const OutputFile& file = files_.at(first_ + i);
    setProvenance(state, provenance);
    writeGrid(state, file);
    names.push_back(file.path().string());
    times.push_back(state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
    Session::checkInterrupt();
  }
  written_ = times.size();
  if (!collection_.empty())
  {
    std::vector<Listed> all = listed(first_);
    for (std::size_t i = 0; i < names.size(); ++i)
      all.push_back({ std::filesystem::path(names[i]).filename().string(), times[i] });
    writeList(std::move(all));
    names.push_back(collection_.front().path().string());
  }
  return names;
}

std::vector<StateWriter::Listed> StateWriter::listed(std::size_t most) const
{
  std::vector<Listed> found;
  const std::filesystem::path& list = collection_.front().path();
  std::error_code ignored;
  if (most == 0 || !std::filesystem::is_regular_file(list, ignored))
    return found;
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(list.c_str()));
  vtkXMLDataElement* const entries = root ? root->FindNestedElementWithName("Collection") : nullptr;
  for (int i = 0; entries != nullptr && i < entries->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* const entry = entries->GetNestedElement(i);
    const char* const name = entry->GetAttribute("file");
    double time = 0;
    const auto first = std::span(files_).first(most);
    const auto file = std::find_if(
      first.begin(), first.end(), [&](const OutputFile& f) { return name != nullptr && f.path().filename() == name; });
    if (file != first.end() && std::filesystem::is_regular_file(file->path(), ignored) &&
      entry->GetScalarAttribute("timestep", time) == 1)
      found.push_back({ name, time });
  }
  return found;
}

void StateWriter::writeList(std::vector<Listed> states)
{
  std::vector<std::string> names;
  std::vector<double> times;
  for (Listed& state : states)
  {
    names.push_back(std::move(state.file));
    times.push_back(state.time);
  }
  collection_.front().write(collectionText(names, times));
}

void StateWriter::follow(Session& session, const std::string& record)
{
  if (files_.size() > 1 && session.ranks() == 1 && session.scene() == nullptr)
    session.setOnStep([this, record](vtkDataObject* state) { this->writeNow(state, record); });
}

void StateWriter::writeNow(vtkDataObject* state, const std::string& provenance)
{
  const auto number = static_cast<std::size_t>(fieldNumbers(state, stateNumber).at(0));
  OutputFile& file = files_.at(number);
  const auto copy = vtkSmartPointer<vtkDataObject>::Take(state->NewInstance()); // the run goes on with its own
  copy->ShallowCopy(state);
  setProvenance(copy, provenance);
  writeGrid(copy, file);
  std::vector<Listed> all = listed(number);
  all.push_back({ file.path().filename().string(), state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) });
  writeList(std::move(all));
  for (OutputFile* const one : { &file, &collection_.front() })
  {
    one->commit();
    *one = OutputFile(one->path(), true);
  }
  leaves_ = true;
}

std::vector<std::string> StateWriter::keep(std::span<vtkDataObject* const> states, const std::string& provenance)
{
  const std::filesystem::path& name = files_.front().path();
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    setProvenance(states[i], provenance);
    Workspace::keep(withSuffix(name, fmt::format("_{:03}", i)), states[i]);
  }
  Workspace::keep(name, states.back());
  return { name.string() };
}

void StateWriter::commit()
{
  for (std::size_t i = first_; i < first_ + written_; ++i)
    files_[i].commit();
  for (OutputFile& file : collection_)
    file.commit();
}

CheckpointPacing checkedPacing(const CheckpointWords& words)
{
  const std::string ending = std::filesystem::path(words.file).extension().string();
  if (!words.file.empty() && ending != ".h5" && ending != ".hdf5")
    throw ParameterError("--checkpoint '" + words.file + "': checkpoints are written as HDF5", "end the name in .h5");
  CheckpointPacing pacing;
  for (const std::string& part : split(words.every, ','))
  {
    const auto units = toInteger(part);
    const auto seconds = units ? std::nullopt : secondsFrom(part);
    if (words.every.empty())
      break;
    if ((!units || *units < 1 || pacing.units) && (!seconds || !(*seconds > 0) || pacing.seconds))
    {
      throw ParameterError("--checkpoint-every '" + words.every + "' is neither a whole number above 0 nor a time",
        "such as 500, 10min, or 500,10min; a time has its unit: s, min or h");
    }
    pacing.units = units ? units : pacing.units;
    pacing.seconds = seconds ? seconds : pacing.seconds;
  }
  return pacing;
}

void addCheckpointOptions(CLI::App& command, CheckpointWords& words, const char* every, const char* standard)
{
  const auto checkpoints = [](CLI::Option* option) { return option->group("Checkpoints"); };
  checkpoints(command.add_option("--checkpoint", words.file, "Keep where the run stands, to go on from it"))
    ->type_name("FILE.h5");
  checkpoints(command.add_option("--checkpoint-every", words.every, every))
    ->type_name("NUMBER|TIME")
    ->default_str(standard);
  checkpoints(command.add_option("--continue", words.continueFrom,
                "Go on from a checkpoint of the same run; where it is that of --checkpoint and not there yet, begin"))
    ->type_name("FILE.h5");
}

void checkCheckpoint(const CheckpointWords& words, bool overwrite)
{
  std::error_code ignored;
  if (!words.file.empty() && !overwrite && std::filesystem::is_regular_file(words.file, ignored) &&
    (words.continueFrom.empty() || !io::sameFile(words.file, words.continueFrom)))
  {
    throw OutputError("'" + words.file + "' exists already",
      "add --continue " + io::quoteCommand(std::array{ words.file }) +
        " to go on from it, --overwrite to begin anew, or choose another name");
  }
}

void runKept(Session& session, const CheckpointWords& words, const KeptRun& kept, const std::function<void()>& run)
{
  try
  {
    run();
  }
  catch (const Cancelled&)
  {
    const std::string hint = session.scene() == nullptr ? howToContinue(words, kept) : "";
    if (hint.empty())
      throw;
    throw Stopped(hint);
  }
  catch (const Error&)
  {
    if (kept.last() > 0 && session.scene() == nullptr)
      session.warn(howToContinue(words, kept));
    throw;
  }
}

} // namespace lamella::cli
