#include "Commands.h"
#include "FilterRun.h"
#include "FractureFiles.h"
#include "GridFile.h"
#include "JsonReport.h"
#include "OutputFile.h"
#include "PackingInput.h"
#include "Record.h"
#include "Text.h"
#include "Workspace.h"

#include "FieldNumbers.h"
#include "PackingData.h"
#include "io/Provenance.h"
#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "packing/Packing.h"
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
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> sizesNames{ "volume", "volume-share", "diameter" };

struct PackingCommandOptions
{
  CommonOptions common;
  packing::PackingOptions packing;
  TableOptions table;
  std::string meanDiameter = fmt::format("{:g}mm", packing::PackingOptions().meanDiameter * 1e3);
  std::string sizes = sizesNames.front();
  std::string packingFraction;
  std::string seeds;
  int threads = 1;
  std::string read;
  std::string output;
  std::string contacts;
  std::vector<CLI::Option*> generates; ///< options that --read makes useless
  std::vector<CLI::Option*> seedOption;
  std::vector<CLI::Option*> threadsOption;
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
    {
      throw ParameterError("--seeds '" + text + "' are too many", fmt::format("up to {} at once", most));
    }
    for (std::int64_t seed = *first; seed <= *last; ++seed)
    {
      seeds.push_back(static_cast<std::uint64_t>(seed));
    }
  }
  return seeds;
}

/// The name of a seed's file; without a seed the name as it is.
std::string nameFor(std::string name, const std::string& seed)
{
  for (std::size_t at = name.find(seedMark); at != std::string::npos && !seed.empty(); at = name.find(seedMark))
  {
    name.replace(at, std::char_traits<char>::length(seedMark), seed);
  }
  return name;
}

void checkName(
  const std::string& option, const std::string& name, const std::vector<std::string>& endings, std::size_t samples)
{
  if (name.empty())
  {
    return;
  }
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

Json rows(const Made& made, const char* tensor)
{
  const std::vector<double> all = fieldNumbers(made.grains, tensor);
  Json json = Json::array();
  const std::ptrdiff_t dimension = made.spheres() ? 3 : 2;
  for (std::ptrdiff_t row = 0; row < dimension; ++row)
  {
    json.push_back(std::vector<double>(all.begin() + 3 * row, all.begin() + 3 * row + dimension));
  }
  return json;
}

Json toJson(const Made& made)
{
  const std::array<double, 3> box = made.box();
  const double unbalanced = made.number("unbalanced_force");
  Json json;
  json["seed"] = made.seed ? Json(*made.seed) : Json(nullptr);
  json["dimension"] = made.spheres() ? 3 : 2;
  json["count"] = made.count();
  json["box"] = std::vector<double>(box.begin(), box.begin() + (made.spheres() ? 3 : 2));
  json["periodic"] = made.number("periodic") != 0;
  json["packing_fraction"] = made.number("packing_fraction");
  json["aspect"] = made.number("aspect");
  json["rattlers"] = made.whole("rattlers");
  json["contacts"] = made.whole("contacts");
  json["wall_contacts"] = made.whole("wall_contacts");
  json["coordination"] = made.number("coordination");
  json["fabric"] = rows(made, "fabric");
  json["stress"] = rows(made, "stress");
  json["fabric_anisotropy"] = made.number("fabric_anisotropy");
  json["stress_anisotropy"] = made.number("stress_anisotropy");
  json["unbalanced_force"] = std::isfinite(unbalanced) ? Json(unbalanced) : Json(nullptr);
  json["pressure"] = made.number("pressure");
  json["steps"] = made.whole("relaxation_steps");
  json["warnings"] = fieldTexts(made.grains, "warnings");
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
    {
      sum[i] += values[i] / static_cast<double>(samples.size());
    }
    line(std::to_string(*made.seed), values);
  }
  line("mean", sum);
  std::size_t files = 0;
  for (const Made& made : samples)
  {
    files += made.files.size();
  }
  text += fmt::format("\n  {:.2f} s", seconds);
  text += files > 0 ? fmt::format(", wrote {} files\n", files) : "\n";
  return text;
}

/// x,z,r or x,y,z,r, as packings are exchanged; lengths in metres, all digits.
std::string toCsv(const Made& made)
{
  std::string text = made.spheres() ? "x,y,z,r\n" : "x,z,r\n";
  vtkDataArray* const radius = made.grains->GetPointData()->GetArray("radius");
  for (vtkIdType i = 0; i < made.grains->GetNumberOfPoints(); ++i)
  {
    const double* const centre = made.grains->GetPoint(i);
    for (int axis = 0; axis < (made.spheres() ? 3 : 2); ++axis)
    {
      text += fmt::format("{},", centre[axis]);
    }
    text += fmt::format("{}\n", radius->GetTuple1(i));
  }
  return text;
}

/// The options in numbers. @throws ParameterError
packing::PackingOptions numbersOf(const PackingCommandOptions& options)
{
  packing::PackingOptions numbers = options.packing;
  numbers.meanDiameter = lengthInMetres("--mean-diameter", options.meanDiameter);
  numbers.sizes = static_cast<packing::Sizes>(oneOf("--sizes", options.sizes, sizesNames));
  if (!options.packingFraction.empty())
  {
    numbers.packingFraction = share("--packing-fraction", options.packingFraction);
  }
  return numbers;
}

void refuseContradictions(const PackingCommandOptions& options)
{
  if (!options.read.empty())
  {
    std::string given = firstGiven(options.generates);
    given = given.empty() ? firstGiven(options.seedOption) : given;
    given = given.empty() ? firstGiven(options.threadsOption) : given;
    if (!given.empty() || !options.seeds.empty())
    {
      throw ParameterError("--read takes a packing as it is, and " + (given.empty() ? "--seeds" : given) + " makes one",
        "leave one of them out");
    }
    if (isParticleFile(options.read))
    {
      throw ParameterError("--read is for tables, and '" + options.read + "' holds particles already",
        "lamella info shows what is in it, lamella bridges takes it as it is");
    }
    return;
  }
  if (const std::string given = firstGiven(options.table.declared); !given.empty())
  {
    throw ParameterError(given + " is about a table, and none is read", "add --read FILE.csv, or leave it out");
  }
  if (!options.seeds.empty() && !firstGiven(options.seedOption).empty())
  {
    throw ParameterError("--seed and --seeds contradict each other", "give one of them");
  }
  if (options.seeds.empty() && !firstGiven(options.threadsOption).empty())
  {
    throw ParameterError(
      "--threads is for --seeds: one packing runs on one thread", "add --seeds 1-10, or leave it out");
  }
  checkThreads(options.threads, "1 is the default");
  if (options.packing.every < 0)
  {
    throw ParameterError(fmt::format("--every {} is below 0", options.packing.every),
      "it is a number of steps from one state to the next, such as 200");
  }
  if (options.packing.every > 0 && !options.seeds.empty())
  {
    throw ParameterError("--every with --seeds: states are those of one packing", "give one --seed");
  }
  if (options.packing.every > 0 && options.output.empty())
  {
    throw ParameterError("--every without a file to write to", "add -o FILE.vtp");
  }
}

/// One packing by the VTK class, which tells its states. @throws Error
void packOne(Session& session, vtkGrainPacking* filter, const PackingCommandOptions& options, std::uint64_t seed)
{
  const packing::PackingOptions numbers = numbersOf(options);
  if (seed > static_cast<std::uint64_t>(std::numeric_limits<vtkIdType>::max()))
  {
    throw ParameterError(
      fmt::format("--seed {} is too large", seed), fmt::format("up to {}", std::numeric_limits<vtkIdType>::max()));
  }
  filter->SetDimension(numbers.dimension);
  filter->SetCount(static_cast<vtkIdType>(numbers.count));
  filter->SetMeanDiameter(numbers.meanDiameter);
  filter->SetDiameterRatio(numbers.diameterRatio);
  filter->SetSizes(static_cast<int>(numbers.sizes));
  filter->SetAspect(numbers.aspect);
  filter->SetPeriodic(numbers.periodic);
  filter->SetFriction(numbers.friction);
  filter->SetPressure(numbers.pressure);
  filter->SetSoftness(numbers.softness);
  filter->SetPackingFraction(numbers.packingFraction.value_or(0));
  filter->SetSeed(static_cast<vtkIdType>(seed));
  filter->SetTolerance(numbers.tolerance);
  filter->SetStateEvery(static_cast<vtkIdType>(options.packing.every));
  filter->SetKeepStates(Workspace::current() == nullptr || !Workspace::current()->lastStateOnly);
  runFilter(session, filter, "packing");
  if (filter->GetFailure() != vtkSampleAlgorithm::NO_FAILURE)
  {
    throwFailure(filter->GetFailure());
  }
  (void)VtkMessages::takeWarnings(); // the same as in the field data
}

/// Several at once, the same but without states. @throws Error
std::vector<packing::Packing> packAll(
  Session& session, const PackingCommandOptions& options, std::span<const std::uint64_t> seeds)
{
  packing::PackingOptions numbers = numbersOf(options);
  numbers.progress = [&](double done, const char* what) { static_cast<void>(session.progress(done, what)); };
  numbers.interrupted = [] { return Session::interrupted(); };
  std::vector<packing::Packing> packed = packing::packMany(numbers, seeds, options.threads);
  session.endProgress();
  return packed;
}

Made madeOf(const packing::Packing& packing, bool friction)
{
  Made made;
  setPacking(packing, packing::statistics(packing, friction), "lamella packing", made.grains, made.contacts);
  setFieldNumber(made.grains, "relaxation_steps", static_cast<double>(packing.steps));
  return made;
}

struct Files
{
  std::optional<OutputFile> grains;
  std::optional<OutputFile> contacts;
};

void write(const Made& made, const Files& files, io::Provenance record)
{
  record.seed = made.seed;
  const std::string text = io::toJson(record);
  for (vtkPolyData* const data : { made.grains.Get(), made.contacts.Get() })
  {
    if (made.seed)
    {
      setFieldNumber(data, "seed", static_cast<double>(*made.seed));
    }
    setProvenance(data, text);
  }
  if (files.grains && files.grains->path().extension() == ".csv")
  {
    files.grains->write(toCsv(made));
  }
  else if (files.grains)
  {
    writeGrid(made.grains, *files.grains);
  }
  if (files.contacts)
  {
    writeGrid(made.contacts, *files.contacts);
  }
}

/// Prints the samples, one alone or as a list.
void report(Session& session, const PackingCommandOptions& options, const std::vector<Made>& samples,
  const io::Provenance& record, double seconds)
{
  for (const Made& made : samples)
  {
    for (const std::string& warning : fieldTexts(made.grains, "warnings"))
    {
      session.warn(samples.size() == 1 ? warning : fmt::format("seed {}: {}", *made.seed, warning));
    }
  }
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
      {
        json["samples"].push_back(toJson(made));
      }
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
void packInStates(Session& session, const PackingCommandOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  const std::uint64_t seed = options.packing.seed;
  StateWriter grains(options.output, 0, options.common.overwrite, ".vtp", { "states", "a table has room for one" });
  StateWriter contacts(options.contacts, 0, options.common.overwrite, ".vtp", { "contacts", "there is no other form" });
  vtkNew<vtkGrainPacking> filter;
  packOne(session, filter, options, seed);
  std::vector<vtkDataObject*> states;
  std::vector<vtkDataObject*> forces;
  for (int i = 0; i < filter->GetNumberOfStates(); ++i)
  {
    states.push_back(filter->GetStateGrains(i));
    forces.push_back(filter->GetStateContacts(i));
  }
  io::Provenance record = recordRun(commandLine, "", "");
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
  if (options.packing.every > 0)
  {
    packInStates(session, options, commandLine);
    return;
  }
  std::vector<std::uint64_t> seeds{ options.packing.seed };
  if (!options.seeds.empty())
  {
    seeds = parseSeeds(options.seeds);
  }
  checkName("-o", options.output, { ".vtp", ".csv" }, seeds.size());
  checkName("--contacts", options.contacts, { ".vtp" }, seeds.size());
  if (!options.read.empty())
  {
    requireFile(options.read);
  }
  std::vector<Files> files(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i)
  {
    const std::string seed = options.read.empty() ? std::to_string(seeds[i]) : "";
    if (!options.output.empty())
    {
      files[i].grains.emplace(nameFor(options.output, seed), options.common.overwrite);
    }
    if (!options.contacts.empty())
    {
      files[i].contacts.emplace(nameFor(options.contacts, seed), options.common.overwrite);
    }
  }
  if (options.packing.periodic && std::filesystem::path(options.output).extension() == ".csv")
  {
    session.warn("a table does not tell that the box is periodic, nor how large it is; .vtp does");
  }

  std::vector<Made> samples;
  vtkNew<vtkGrainPacking> filter;
  if (!options.read.empty())
  {
    samples.push_back(madeOf(loadPacking(options.read, options.table).packing, false));
  }
  else if (seeds.size() == 1)
  {
    packOne(session, filter, options, seeds.front());
    samples.push_back({ seeds.front(), filter->GetOutput(), filter->GetContacts(), {} });
  }
  else
  {
    const std::vector<packing::Packing> packed = packAll(session, options, seeds);
    for (std::size_t i = 0; i < seeds.size(); ++i)
    {
      samples.push_back(madeOf(packed[i], options.packing.friction > 0));
      samples.back().seed = seeds[i];
    }
  }
  io::Provenance record = recordRun(commandLine, options.read, "");
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    write(samples[i], files[i], record);
  }
  if (samples.size() == 1)
  {
    record.seed = samples.front().seed;
  }
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
  packing::PackingOptions& p = o->packing;
  const auto in = [&](const char* group, const char* type, CLI::Option* option)
  {
    o->generates.push_back(option->type_name(type)->capture_default_str()->group(group));
    return option;
  };
  in("Grains", "2|3", app->add_option("--dimension", p.dimension, "2: disks, 3: spheres"));
  in("Grains", "NUMBER", app->add_option("--count", p.count, "How many grains"));
  in("Grains", "LENGTH", app->add_option("--mean-diameter", o->meanDiameter, "Mean of the diameters, as 1mm or 1e-3"));
  in("Grains", "RATIO", app->add_option("--diameter-ratio", p.diameterRatio, "Largest over smallest, 1 to 10"));
  in("Grains", "volume|volume-share|diameter",
    app->add_option("--sizes", o->sizes,
      "What is spread evenly from smallest to largest: areas or volumes, shares of the volume, diameters"));
  in("Grains", "RATIO", app->add_option("--aspect", p.aspect, "Last edge of the box over the first, 0.2 to 5"));
  o->generates.push_back(
    app->add_flag("--periodic", p.periodic, "A cell of an endless packing, instead of walls")->group("Grains"));
  o->seedOption = { app->add_option("--seed", p.seed, "The same seed gives the same packing")
                      ->type_name("NUMBER")
                      ->capture_default_str()
                      ->group("Grains") };
  app->add_option("--seeds", o->seeds, "Several packings, one a seed: 1-10 or 3,5,8; name the files pack_{seed}.vtp")
    ->type_name("LIST")
    ->group("Grains");
  o->threadsOption = { app->add_option("--threads", o->threads, "With --seeds: how many packings at once")
                         ->type_name("NUMBER")
                         ->capture_default_str()
                         ->group("Grains") };
  in("Compaction", "NUMBER", app->add_option("--friction", p.friction, "Coulomb's friction coefficient, 0 to 2"));
  in("Compaction", "PASCALS", app->add_option("--pressure", p.pressure, "What the walls press with"));
  in("Compaction", "RATIO",
    app->add_option("--softness", p.softness, "Pressure over stiffness of contacts, 1e-7 to 1e-2"));
  in("Compaction", "SHARE",
    app->add_option("--packing-fraction", o->packingFraction, "Stop at this share of the box, before grains touch"));
  in("Compaction", "NUMBER",
    app->add_option("--tolerance", p.tolerance, "Net force on a grain over the contact forces, at rest"));
  app->add_option("--read", o->read, "Take the grains of this table (x,z,r or x,y,z,r) instead of making some")
    ->type_name("FILE")
    ->group("Table");
  addTableOptions(*app, o->table);
  addOutputOptions(*app, o->output, o->common, "Write the grains: .vtp, or .csv (x,z,r or x,y,z,r)");
  app->add_option("--contacts", o->contacts, "Write the contacts and their forces: .vtp")
    ->type_name("FILE")
    ->group("Output");
  in("Output", "STEPS",
    app->add_option("--every", p.every,
      "Write states on the way too, each so many steps: FILE_000.vtp ... and FILE.pvd, the last at rest"));
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
