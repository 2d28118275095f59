#include "commands/FilterRun.h"
#include "commands/PackingInput.h"
#include "files/FieldReport.h"
#include "files/FractureFiles.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "FieldNumbers.h"
#include "core/Clock.h"
#include "core/Error.h"
#include "io/Provenance.h"
#include "vtkGrainPacking.h"
#include "vtkLatticeConversion.h"
#include "vtkSampleAlgorithm.h"

#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct PackingCommandOptions
{
  CommonOptions common;
  SettingOptions settings;
  SettingOptions table; ///< of vtkPackingReader
  std::string seeds;
  std::string read;
  std::string output;
  std::string contacts;
};

constexpr const char* seedMark = "{seed}";

/// "1-10", "3,5,8" or "1-4,9". @throws ParameterError
std::vector<std::uint64_t> parseSeeds(const std::string& text)
{
  constexpr std::size_t most = 10000;
  std::vector<std::uint64_t> seeds;
  for (const std::string& part : split(text, ','))
  {
    const std::vector<std::string> ends = split(part, '-');
    const auto first = toInteger(ends.front());
    const auto last = toInteger(ends.back());
    if (ends.size() > 2 || !first || !last || *first < 0 || *last < *first)
    {
      throw ParameterError(fmt::format("--seeds '{}': '{}' is no seed and no range of seeds", text, part),
        "write --seeds 1-10, or --seeds 3,5,8");
    }
    if (static_cast<std::uint64_t>(*last - *first) >= most - seeds.size())
      throw ParameterError("--seeds '" + text + "' are too many", fmt::format("up to {} at once", most));
    for (std::int64_t seed = *first; seed <= *last; ++seed)
      seeds.push_back(static_cast<std::uint64_t>(seed));
  }
  return seeds;
}

/// The name of a seed's file; without a seed the name as it is.
std::string nameFor(std::string name, const std::string& seed)
{
  for (std::size_t at = name.find(seedMark); at != std::string::npos && !seed.empty(); at = name.find(seedMark))
    name.replace(at, std::char_traits<char>::length(seedMark), seed);
  return name;
}

void checkName(
  const std::string& option, const std::string& name, const std::vector<std::string>& endings, std::size_t samples)
{
  if (name.empty())
    return;
  const std::string ending = std::filesystem::path(name).extension().string();
  if (std::find(endings.begin(), endings.end(), ending) == endings.end())
  {
    throw ParameterError(option + " '" + name + "' has no ending that can be written",
      endings.size() == 1 ? "contacts are written as .vtp" : "end it in .vtp for ParaView and bridges, or in .csv");
  }
  if (samples > 1 && name.find(seedMark) == std::string::npos)
  {
    throw ParameterError(fmt::format("{} '{}' is one name for {} packings", option, name, samples),
      "put {seed} into it, as in pack_{seed}" + ending);
  }
}

/// One sample as it is reported and written.
struct Made
{
  std::optional<std::uint64_t> seed;
  vtkSmartPointer<vtkPolyData> grains = vtkSmartPointer<vtkPolyData>::New(); ///< with all numbers as field data
  vtkSmartPointer<vtkPolyData> contacts = vtkSmartPointer<vtkPolyData>::New();
  std::vector<std::string> files;

  [[nodiscard]] double number(const char* name) const { return fieldNumbers(grains, name).at(0); }
  [[nodiscard]] std::int64_t whole(const char* name) const { return static_cast<std::int64_t>(number(name)); }
  [[nodiscard]] std::array<double, 3> box() const
  {
    const std::vector<double> edges = fieldNumbers(grains, "box");
    return { edges.at(0), edges.at(1), edges.at(2) };
  }
  [[nodiscard]] bool spheres() const { return box()[2] > 0; }
  [[nodiscard]] std::int64_t count() const { return grains->GetNumberOfPoints(); }
};

Json toJson(const Made& made)
{
  const std::array<double, 3> box = made.box();
  Json json;
  json["seed"] = made.seed ? Json(*made.seed) : Json(nullptr);
  json["dimension"] = made.spheres() ? 3 : 2;
  json["count"] = made.count();
  json["box"] = std::vector<double>(box.begin(), box.begin() + (made.spheres() ? 3 : 2));
  using enum Key::Kind;
  addKeys(json, { made.grains, made.spheres() ? 3 : 2 },
    { { "periodic", Flag }, { "packing_fraction" }, { "aspect" }, { "rattlers", Whole }, { "contacts", Whole },
      { "wall_contacts", Whole }, { "coordination" }, { "fabric", Matrix }, { "stress", Matrix },
      { "fabric_anisotropy" }, { "stress_anisotropy" }, { "unbalanced_force" }, { "pressure" },
      { "steps", Whole, "relaxation_steps" }, { "warnings", Texts } });
  json["files"] = made.files;
  return json;
}

std::string tableOf(const Made& made, double seconds)
{
  std::string text = fmt::format("{} {}, {} {}\n\n", grouped(made.count()), made.spheres() ? "spheres" : "disks",
    made.number("periodic") != 0 ? "periodic box" : "box", boxText(made.box()));
  const auto line = [&](const char* name, const std::string& value)
  { text += fmt::format("  {:<18} {}\n", name, value); };
  line("packing fraction", fmt::format("{:.5f}", made.number("packing_fraction")));
  line("aspect", fmt::format("{:.4f}", made.number("aspect")));
  line("rattlers",
    fmt::format(
      "{} ({:.1f} %)", made.whole("rattlers"), 100.0 * made.number("rattlers") / static_cast<double>(made.count())));
  line(
    "contacts", fmt::format("{} between grains, {} with walls", made.whole("contacts"), made.whole("wall_contacts")));
  line("coordination", fmt::format("{:.4f}", made.number("coordination")));
  line("fabric anisotropy", fmt::format("{:.4f}", made.number("fabric_anisotropy")));
  if (made.number("pressure") > 0)
  {
    line("stress anisotropy", fmt::format("{:.4f}", made.number("stress_anisotropy")));
    line("pressure", fmt::format("{:.5g} Pa", made.number("pressure")));
    line("unbalanced force", fmt::format("{:.1e} of the mean contact force", made.number("unbalanced_force")));
  }
  text += fmt::format("  {:.2f} s\n", seconds);
  text += wroteText(made.files);
  return text;
}

std::string tableOf(const std::vector<Made>& samples, double seconds)
{
  std::string text = fmt::format("{} packings of {} {}\n\n", samples.size(), grouped(samples.front().count()),
    samples.front().spheres() ? "spheres" : "disks");
  const auto line = [&](const std::string& name, const std::array<double, 6>& v)
  {
    text += fmt::format("  {:<6}  {:<16.5f}  {:<7.4f}  {:<8.4g}  {:<12.4f}  {:<17.4f}  {:.4f}\n", name, v[0], v[1],
      v[2], v[3], v[4], v[5]);
  };
  text += "  seed    packing fraction  aspect   rattlers  coordination  fabric anisotropy  stress anisotropy\n";
  std::array<double, 6> sum{};
  for (const Made& made : samples)
  {
    const std::array<double, 6> values{ made.number("packing_fraction"), made.number("aspect"), made.number("rattlers"),
      made.number("coordination"), made.number("fabric_anisotropy"), made.number("stress_anisotropy") };
    for (std::size_t i = 0; i < values.size(); ++i)
      sum[i] += values[i] / static_cast<double>(samples.size());
    line(std::to_string(*made.seed), values);
  }
  line("mean", sum);
  std::size_t files = 0;
  for (const Made& made : samples)
    files += made.files.size();
  text += fmt::format("\n  {:.2f} s", seconds);
  text += files > 0 ? fmt::format(", wrote {} files\n", files) : "\n";
  return text;
}

/// x,z,r or x,y,z,r, as packings are exchanged; lengths in metres, all digits.
std::string packingCsv(const Made& made)
{
  std::string text = made.spheres() ? "x,y,z,r\n" : "x,z,r\n";
  vtkDataArray* const radius = made.grains->GetPointData()->GetArray("radius");
  for (vtkIdType i = 0; i < made.grains->GetNumberOfPoints(); ++i)
  {
    const double* const centre = made.grains->GetPoint(i);
    for (int axis = 0; axis < (made.spheres() ? 3 : 2); ++axis)
      text += fmt::format("{},", centre[axis]);
    text += fmt::format("{}\n", radius->GetTuple1(i));
  }
  return text;
}

void refuseContradictions(const PackingCommandOptions& options)
{
  const SettingOptions& settings = options.settings;
  if (!options.read.empty())
  {
    std::vector<std::string> given = settings.idle("");
    if (!options.seeds.empty())
      given.emplace_back("seeds");
    if (!given.empty())
    {
      throw ParameterError(
        "--read takes a packing as it is, and --" + given.front() + " makes one", "leave one of them out");
    }
    if (isParticleFile(options.read))
    {
      throw ParameterError("--read is for tables, and '" + options.read + "' holds particles already",
        "lamella info shows what is in it, lamella bridges takes it as it is");
    }
    return;
  }
  if (const std::string given = options.table.firstGiven({ "unit", "box" }); !given.empty())
    throw ParameterError(given + " is about a table, and none is read", "add --read FILE.csv, or leave it out");
  if (!options.seeds.empty() && settings.given("seed"))
    throw ParameterError("--seed and --seeds contradict each other", "give one of them");
  if (options.seeds.empty() && settings.given("threads"))
  {
    throw ParameterError(
      "--threads is for --seeds: one packing runs on one thread", "add --seeds 1-10, or leave it out");
  }
  if (settings.given("every") && options.output.empty())
    throw ParameterError("--every without a file to write to", "add -o FILE.vtp");
}

/// Runs the filter. @throws Error
void pack(Session& session, vtkGrainPacking* filter)
{
  runFilter(session, filter, "packing");
  (void)VtkMessages::takeWarnings(); // the same as in the field data
}

/// A packing of somebody else's.
Made readMade(Session& session, const PackingCommandOptions& options)
{
  const Grains grains = readPacking(session, options.read, options.table);
  Made made{ {}, grains.grains, grains.contacts, {} };
  setFieldNumber(made.grains, "relaxation_steps", 0);
  return made;
}

struct PackingFiles
{
  std::optional<OutputFile> grains;
  std::optional<OutputFile> contacts;
};

void writePacking(const Made& made, const PackingFiles& files, io::Provenance record)
{
  record.seed = made.seed;
  const std::string text = io::toJson(record);
  for (vtkPolyData* const data : { made.grains.Get(), made.contacts.Get() })
  {
    if (made.seed)
      setFieldNumber(data, "seed", static_cast<double>(*made.seed));
    setProvenance(data, text);
  }
  if (files.grains && files.grains->path().extension() == ".csv")
    files.grains->write(packingCsv(made));
  else if (files.grains)
    writeGrid(made.grains, *files.grains);
  if (files.contacts)
    writeGrid(made.contacts, *files.contacts);
}

/// Prints the samples, one alone or as a list.
void report(Session& session, const PackingCommandOptions& options, const std::vector<Made>& samples,
  const io::Provenance& record, double seconds)
{
  for (const Made& made : samples)
    for (const std::string& warning : fieldTexts(made.grains, "warnings"))
      session.warn(samples.size() == 1 ? warning : fmt::format("seed {}: {}", *made.seed, warning));
  if (options.common.json)
  {
    Json json;
    if (options.seeds.empty())
    {
      json = toJson(samples.front());
    }
    else
    {
      json["samples"] = Json::array();
      for (const Made& made : samples)
        json["samples"].push_back(toJson(made));
    }
    json["seconds"] = seconds;
    addRecord(json, record);
    session.print(dump(json));
  }
  else if (!options.common.quiet)
  {
    session.print(samples.size() == 1 ? tableOf(samples.front(), seconds) : tableOf(samples, seconds));
  }
}

/// One packing with the states on its way: all of them are written, with a list that tells their steps as times.
void packInStates(
  Session& session, const PackingCommandOptions& options, vtkGrainPacking* filter, const std::string& commandLine)
{
  const auto start = Clock::now();
  const auto seed = static_cast<std::uint64_t>(filter->GetSeed());
  StateWriter grains(options.output, 0, options.common.overwrite, ".vtp", { "states", "a table has room for one" });
  StateWriter contacts(options.contacts, 0, options.common.overwrite, ".vtp", { "contacts", "there is no other form" });
  filter->SetKeepStates(session.keepsAllStates());
  pack(session, filter);
  std::vector<vtkDataObject*> states;
  std::vector<vtkDataObject*> forces;
  for (int i = 0; i < filter->GetNumberOfStates(); ++i)
  {
    states.push_back(filter->GetStateGrains(i));
    forces.push_back(filter->GetStateContacts(i));
  }
  io::Provenance record = recordRun(session, commandLine, "", "");
  record.seed = seed;
  const std::string text = io::toJson(record);
  std::vector<Made> samples(1);
  Made& made = samples.front();
  made.seed = seed;
  made.grains = filter->GetOutput();
  made.files = grains.write(states, text);
  const std::vector<std::string> more = contacts.write(forces, text);
  made.files.insert(made.files.end(), more.begin(), more.end());
  Session::checkInterrupt();
  grains.commit();
  contacts.commit();
  if (!options.common.json && made.files.size() > 6) // hundreds
  {
    std::vector<std::string> few{ made.files.front(), fmt::format("... {} states in all", states.size()) };
    std::copy_if(made.files.begin(), made.files.end(), std::back_inserter(few),
      [](const std::string& name) { return std::filesystem::path(name).extension() == ".pvd"; });
    made.files = few;
  }
  report(session, options, samples, record, secondsSince(start));
}

void packingRun(Session& session, const PackingCommandOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  refuseContradictions(options);
  vtkNew<vtkGrainPacking> filter;
  options.settings.give(filter);
  std::vector<std::uint64_t> seeds{ static_cast<std::uint64_t>(filter->GetSeed()) };
  if (!options.seeds.empty())
  {
    seeds = parseSeeds(options.seeds);
    for (const std::uint64_t seed : seeds)
      filter->AddSeed(static_cast<vtkIdType>(seed));
  }
  if (filter->GetStateEvery() > 0)
  {
    if (!options.seeds.empty())
      throw ParameterError("--every with --seeds: states are those of one packing", "give one --seed");
    packInStates(session, options, filter, commandLine);
    return;
  }
  checkName("-o", options.output, { ".vtp", ".csv" }, seeds.size());
  checkName("--contacts", options.contacts, { ".vtp" }, seeds.size());
  if (!options.read.empty())
    requireFile(options.read);
  std::vector<PackingFiles> files(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i)
  {
    const std::string seed = options.read.empty() ? std::to_string(seeds[i]) : "";
    if (!options.output.empty())
      files[i].grains.emplace(nameFor(options.output, seed), options.common.overwrite);
    if (!options.contacts.empty())
      files[i].contacts.emplace(nameFor(options.contacts, seed), options.common.overwrite);
  }
  if (filter->GetPeriodic() && std::filesystem::path(options.output).extension() == ".csv")
    session.warn("a table does not tell that the box is periodic, nor how large it is; .vtp does");

  std::vector<Made> samples;
  if (!options.read.empty())
  {
    samples.push_back(readMade(session, options));
  }
  else
  {
    pack(session, filter);
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
    {
      samples.push_back(
        { seeds[static_cast<std::size_t>(i)], filter->GetStateGrains(i), filter->GetStateContacts(i), {} });
    }
  }
  io::Provenance record = recordRun(session, commandLine, options.read, "");
  for (std::size_t i = 0; i < samples.size(); ++i)
    writePacking(samples[i], files[i], record);
  if (samples.size() == 1)
    record.seed = samples.front().seed;
  Session::checkInterrupt();
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    for (std::optional<OutputFile>* const file : { &files[i].grains, &files[i].contacts })
    {
      if (*file)
      {
        (*file)->commit();
        samples[i].files.push_back((*file)->path().string());
      }
    }
  }
  report(session, options, samples, record, secondsSince(start));
}

} // namespace

Command packingCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("packing", "Press disks or spheres together until they rest: a dense packing");
  auto o = std::make_shared<PackingCommandOptions>();
  o->settings.declare(*app, "vtkGrainPacking", { "seeds", "keep-states", "state" });
  addOption(*app, "Grains", "--seeds", o->seeds,
    "Several packings, one a seed: 1-10 or 3,5,8; name the files pack_{seed}.vtp", "LIST");
  addOption(*app, "Table", "--read", o->read, "Take the grains of this table (x,z,r or x,y,z,r) instead of making some",
    "FILE");
  addTableOptions(*app, o->table);
  addOutputOptions(*app, o->output, o->common, "Write the grains: .vtp, or .csv (x,z,r or x,y,z,r)");
  addResultFile(*app, "--contacts", o->contacts, "Write the contacts and their forces: .vtp", "FILE");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella packing --count 400 --seed 3 -o grains.vtp --contacts forces.vtp",
      "lamella packing --dimension 3 --count 500 --friction 0.3 -o spheres.vtp",
      "lamella packing --count 200 --every 1000 -o way.vtp --contacts forces.vtp",
      "lamella packing --seeds 1-10 --threads 2 -o pack_{seed}.vtp --json",
      "lamella packing --read measured.csv --unit 1mm -o grains.vtp" });
  return aloneCommand(app, o, packingRun);
}

} // namespace lamella::cli
