#include "BreakRun.h"

#include "GridFile.h"
#include "ResultFiles.h"
#include "Text.h"
#include "Units.h"
#include "Workspace.h"

#include "lattice/Clock.h"
#include "vtkBondBreakAlgorithm.h"
#include "vtkBondFracture.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

namespace lamella::cli
{

namespace
{

std::int64_t count(const char* option, const std::string& text)
{
  const auto value = toInteger(text);
  if (!value || *value < 1)
  {
    throw ParameterError(fmt::format("{} '{}' is not a whole number above 0", option, text),
      "it is a number of broken bonds, such as 100");
  }
  return *value;
}

/// Of a scene whose pictures and filters show other things of the states, the displacements are left out, and with them
/// an equilibrium for each state.
bool statesNeedDisplacement(const BreakOptions& o)
{
  return Workspace::current() == nullptr || Workspace::current()->wants("displacement") || o.stress || o.strainEnergy;
}

/// What rank 0 writes.
struct Files
{
  StateWriter states;
  std::optional<OutputFile> broken;
  ResultFiles curve;

  void open(const BreakOptions& o, vtkBondBreakAlgorithm* filter, std::size_t mostStates)
  {
    states = StateWriter(o.output, mostStates, o.common.overwrite, ".vti",
      { "the fields", "broken bonds go to --broken FILE.vtp, the curve to --curve FILE.csv" });
    if (!o.broken.empty())
    {
      if (std::filesystem::path(o.broken).extension() != ".vtp")
      {
        throw ParameterError("--broken '" + o.broken + "': broken bonds are written as .vtp", "end the name in .vtp");
      }
      broken.emplace(o.broken, o.common.overwrite);
    }
    curve.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
  }

  /// All are written before the first appears under its name.
  void write(FractureReport& report)
  {
    const std::string provenance = io::toJson(report.run.provenance);
    if (broken)
    {
      setProvenance(report.broken, provenance);
      writeGrid(report.broken, *broken);
    }
    const std::vector<vtkDataObject*> images(report.states.begin(), report.states.end());
    report.run.written = states.write(images, provenance);
    report.stateFiles = report.run.written;
    const std::vector<std::string> tables = curve.write(provenance);
    states.commit();
    if (broken)
    {
      broken->commit();
      report.run.written.push_back(broken->path().string());
    }
    report.run.written.insert(report.run.written.end(), tables.begin(), tables.end());
  }
};

} // namespace

void addPullOptions(CLI::App& command, BreakOptions& o)
{
  command.add_flag("--compression", o.compression, "The high platen moves the other way, towards the low one")
    ->group("Load");
  addPlatenOptions(command, o.platens);
}

void addEndOptions(CLI::App& command, BreakOptions& o)
{
  const auto breaks = [](CLI::Option* option) { return option->group("Breaking"); };
  breaks(command.add_option("--stop", o.stop, "End when the stress has fallen to this share of the peak"))
    ->type_name("SHARE")
    ->capture_default_str();
  breaks(command.add_option("--max-strain", o.maxStrain, "End at this strain"))->type_name("NUMBER");
  breaks(command.add_option("--max-broken", o.maxBroken, "End after so many broken bonds"))->type_name("NUMBER");
}

void addFileOptions(CLI::App& command, BreakOptions& o, const BreakWords& words)
{
  addOutputOptions(command, o.output, o.common, words.fields);
  const auto out = [](CLI::Option* option) { return option->group("Output"); };
  out(command.add_option("--at-broken", o.atBroken,
        "Write the state at these numbers of broken bonds too: FILE_000.vti ... and FILE.pvd"))
    ->type_name("LIST")
    ->allow_extra_args(false);
  out(command.add_flag("--stress", o.stress, "Write the stress of every node too"));
  out(command.add_flag("--strain-energy", o.strainEnergy, "Write the strain energy of every node too"));
  out(command.add_option("--broken", o.broken, "Write the broken bonds in order, a point each"))->type_name("FILE.vtp");
  out(command.add_option("--curve", o.curve, words.curve))->type_name("FILE.csv");
  addCheckpointOptions(command, o.checkpoint, words.checkpoint, words.every);
}

std::vector<std::string> listed(const std::vector<std::string>& lists)
{
  std::vector<std::string> all;
  for (const std::string& list : lists)
  {
    const std::vector<std::string> some = split(list, ',');
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

void applyBreak(const BreakOptions& o, vtkBondBreakAlgorithm* filter, const char* forStates)
{
  applyBonds(o.bonds, filter);
  applyPlatens(o.platens, filter);
  filter->SetCompression(o.compression);
  filter->SetStopShare(share("--stop", o.stop));
  if (!(filter->GetStopShare() >= 0 && filter->GetStopShare() < 1))
  {
    throw ParameterError("--stop '" + o.stop + "' is not from 0 up to 100 %",
      "5% of the peak is usual; hinges never part, so 0 may never be reached");
  }
  filter->SetMaximumStrain(o.maxStrain.empty() ? 0 : positiveStrain("--max-strain", o.maxStrain, alongTheLoad));
  filter->SetMaximumBroken(o.maxBroken.empty() ? 0 : count("--max-broken", o.maxBroken));
  for (const std::string& text : listed(o.atBroken))
  {
    filter->AddStateAtBroken(count("--at-broken", text));
  }
  applyCheckpoint(o.checkpoint, filter, vtkBondFracture::SafeDownCast(filter) == nullptr);
  filter->SetKeepStates(Workspace::current() == nullptr || !Workspace::current()->lastStateOnly);
  const char* const forFields = forStates != nullptr ? forStates
    : !o.atBroken.empty()                            ? "--at-broken"
    : o.stress                                       ? "--stress"
    : o.strainEnergy                                 ? "--strain-energy"
                                                     : nullptr;
  if (o.output.empty() && forFields != nullptr)
  {
    throw ParameterError(fmt::format("{} without a file to write to", forFields), "add -o FILE.vti");
  }
  filter->SetComputeDisplacement(!o.output.empty() && statesNeedDisplacement(o));
  filter->SetComputeStress(o.stress);
  filter->SetComputeStrainEnergy(o.strainEnergy);
}

void runBreak(Session& session, const BreakOptions& options, vtkBondBreakAlgorithm* filter,
  const std::string& commandLine, const char* what, const char* unit, std::size_t states, int perNode,
  const std::function<std::string(const FractureReport&)>& print)
{
  const auto start = Clock::now();
  BondSample sample;
  Files files; // rank 0
  session.onRoot(
    [&]
    {
      checkCheckpoint(options.checkpoint, options.common.overwrite);
      files.open(options, filter, 1 + states + listed(options.atBroken).size());
      sample = loadBondSample(session, options.picture, options.bonds);
      const int bytes = perNode + 1 + 12 + 24 + (options.stress ? 48 : 0) + (options.strainEnergy ? 8 : 0);
      files.states.needs(
        static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * static_cast<std::uint64_t>(bytes));
      if (!options.checkpoint.file.empty())
      {
        files.states.follow(session, io::toJson(recordRun(commandLine, options.picture.file, sample.provenance)));
      }
    });
  const auto finish = [&]
  {
    FractureReport report{ bondRun(session, filter, options.picture, options.bonds, sample, commandLine),
      filter->GetBrokenBonds(), {}, {}, false };
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
    {
      report.states.push_back(filter->GetStateImage(i));
    }
    files.write(report);
    report.run.seconds = secondsSince(start);
    session.print(options.common.quiet && !options.common.json ? "" : print(report));
  };
  const KeptRun kept{ commandLine, session.ranks(), unit, [filter] { return filter->GetLastCheckpoint(); },
    [filter] { return filter->GetCheckpointEvery(); }, [&] { return files.states.leaves(); } };
  runKept(session, options.checkpoint, kept,
    [&]
    {
      runBonds(session, filter, sample, what);
      session.onRoot(finish);
    });
}

} // namespace lamella::cli
