#include "commands/BreakRun.h"

#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "core/Clock.h"
#include "vtkBondBreakAlgorithm.h"
#include "vtkBondFracture.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <filesystem>

namespace lamella::cli
{

namespace
{

/// Of a scene whose pictures and filters show other things of the states, the displacements are left out, and with them
/// an equilibrium for each state.
bool statesNeedDisplacement(const Session& session, const BreakOptions& o)
{
  return session.scene() == nullptr || session.scene()->wants("displacement") || o.bonds.settings.given("stress") ||
    o.bonds.settings.given("strain-energy");
}

/// What rank 0 writes.
struct BreakFiles
{
  StateWriter states;
  ResultFiles others;

  void open(const BreakOptions& o, vtkBondBreakAlgorithm* filter, std::size_t mostStates)
  {
    states = StateWriter(o.output, mostStates, o.common.overwrite, ".vti",
      { "the fields", "broken bonds go to --broken FILE.vtp, the curve to --curve FILE.csv" });
    if (!o.broken.empty() && std::filesystem::path(o.broken).extension() != ".vtp")
      throw ParameterError("--broken '" + o.broken + "': broken bonds are written as .vtp", "end the name in .vtp");
    others.addGrid("--broken", o.broken, ".vtp", filter->GetBrokenBonds(), o.common.overwrite);
    others.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
  }

  /// All are written before the first appears under its name.
  void write(FractureReport& report)
  {
    const std::string provenance = io::toJson(report.run.provenance);
    const std::vector<vtkDataObject*> images(report.states.begin(), report.states.end());
    report.run.written = states.write(images, provenance);
    report.stateFiles = report.run.written;
    const std::vector<std::string> more = others.write(provenance);
    states.commit();
    report.run.written.insert(report.run.written.end(), more.begin(), more.end());
  }
};

} // namespace

void addFileOptions(CLI::App& command, BreakOptions& o, const BreakWords& words)
{
  addOutputOptions(command, o.output, o.common, words.fields);
  addResultFile(command, "--broken", o.broken, "Write the broken bonds in order, a point each", "FILE.vtp");
  addResultFile(command, "--curve", o.curve, words.curve);
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

void applyBreak(const Session& session, const BreakOptions& o, vtkBondBreakAlgorithm* filter, const char* forStates)
{
  applyBonds(o.bonds, filter);
  applyCheckpoint(session, o.checkpoint, filter, vtkBondFracture::SafeDownCast(filter) == nullptr);
  filter->SetKeepStates(session.keepsAllStates());
  std::string forFields = forStates != nullptr ? forStates : "";
  for (const char* const word : { "at-strain", "at-time", "at-broken", "stress", "strain-energy" })
    forFields = forFields.empty() && o.bonds.settings.given(word) ? std::string("--") + word : forFields;
  if (o.output.empty() && !forFields.empty())
    throw ParameterError(forFields + " without a file to write to", "add -o FILE.vti");
  filter->SetComputeDisplacement(!o.output.empty() && statesNeedDisplacement(session, o));
}

void runBreak(Session& session, const BreakOptions& options, vtkBondBreakAlgorithm* filter,
  const std::string& commandLine, const char* what, const char* unit, std::size_t states, int perNode,
  const std::function<std::string(const FractureReport&)>& print)
{
  const auto start = Clock::now();
  ImageSample sample;
  BreakFiles files; // rank 0
  session.onRoot(
    [&]
    {
      checkCheckpoint(options.checkpoint, options.common.overwrite);
      files.open(options, filter, 1 + states + options.bonds.settings.count("at-broken"));
      sample = loadBondSample(session, options.picture, options.bonds, filter);
      const int bytes =
        perNode + 1 + 12 + 24 + (filter->GetComputeStress() ? 48 : 0) + (filter->GetComputeStrainEnergy() ? 8 : 0);
      files.states.needs(
        static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * static_cast<std::uint64_t>(bytes));
      if (!options.checkpoint.file.empty())
        files.states.follow(
          session, io::toJson(recordRun(session, commandLine, options.picture.file, sample.provenance)));
    });
  const auto finish = [&]
  {
    FractureReport report{ bondRun(session, filter, options.picture, options.bonds, sample, commandLine),
      filter->GetBrokenBonds(), {}, {}, false };
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
      report.states.push_back(filter->GetStateImage(i));
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
