#include "Commands.h"
#include "GridFile.h"
#include "JsonReport.h"
#include "OutputFile.h"
#include "PackingInput.h"
#include "Record.h"
#include "Text.h"

#include "PackingData.h"
#include "io/Provenance.h"
#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "packing/Packing.h"
#include "vtkLatticeConversion.h"

#include <vtkNew.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
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
  packing::Packing packing;
  packing::PackingStatistics numbers;
  std::vector<std::string> files;
};

Json rows(const std::array<double, 9>& tensor, int dimension)
{
  Json json = Json::array();
  for (std::size_t row = 0; row < static_cast<std::size_t>(dimension); ++row)
  {
    json.push_back(std::vector<double>(tensor.begin() + static_cast<std::ptrdiff_t>(3 * row),
      tensor.begin() + static_cast<std::ptrdiff_t>(3 * row) + dimension));
  }
  return json;
}

Json toJson(const Made& made)
{
  const packing::Packing& p = made.packing;
  const packing::PackingStatistics& s = made.numbers;
  Json json;
  json["seed"] = made.seed ? Json(*made.seed) : Json(nullptr);
  json["dimension"] = p.dimension;
  json["count"] = p.count();
  json["box"] = std::vector<double>(p.size.begin(), p.size.begin() + p.dimension);
  json["periodic"] = p.periodic[0];
  json["packing_fraction"] = s.packingFraction;
  json["aspect"] = s.aspect;
  json["rattlers"] = s.rattlers;
  json["contacts"] = s.grainContacts;
  json["wall_contacts"] = s.wallContacts;
  json["coordination"] = s.coordination;
  json["fabric"] = rows(s.fabric, p.dimension);
  json["stress"] = rows(s.stress, p.dimension);
  json["fabric_anisotropy"] = s.fabricAnisotropy;
  json["stress_anisotropy"] = s.stressAnisotropy;
  json["unbalanced_force"] = std::isfinite(p.unbalanced) ? Json(p.unbalanced) : Json(nullptr);
  json["pressure"] = p.pressure;
  json["files"] = made.files;
  return json;
}

std::string tableOf(const Made& made, double seconds)
{
  const packing::Packing& p = made.packing;
  const packing::PackingStatistics& s = made.numbers;
  std::string text = fmt::format("{} {}, {} {}\n\n", grouped(static_cast<std::int64_t>(p.count())),
    p.dimension == 3 ? "spheres" : "disks", p.periodic[0] ? "periodic box" : "box", boxText(p));
  const auto line = [&](const char* name, const std::string& value)
  { text += fmt::format("  {:<18} {}\n", name, value); };
  line("packing fraction", fmt::format("{:.5f}", s.packingFraction));
  line("aspect", fmt::format("{:.4f}", s.aspect));
  line("rattlers",
    fmt::format("{} ({:.1f} %)", s.rattlers, 100.0 * static_cast<double>(s.rattlers) / static_cast<double>(p.count())));
  line("contacts", fmt::format("{} between grains, {} with walls", s.grainContacts, s.wallContacts));
  line("coordination", fmt::format("{:.4f}", s.coordination));
  line("fabric anisotropy", fmt::format("{:.4f}", s.fabricAnisotropy));
  if (p.pressure > 0)
  {
    line("stress anisotropy", fmt::format("{:.4f}", s.stressAnisotropy));
    line("pressure", fmt::format("{:.5g} Pa", p.pressure));
    line("unbalanced force", fmt::format("{:.1e} of the mean contact force", p.unbalanced));
  }
  text += fmt::format("  {:.2f} s\n", seconds);
  text += wroteText(made.files);
  return text;
}

std::string tableOf(const std::vector<Made>& samples, double seconds)
{
  const packing::Packing& p = samples.front().packing;
  std::string text = fmt::format("{} packings of {} {}\n\n", samples.size(),
    grouped(static_cast<std::int64_t>(p.count())), p.dimension == 3 ? "spheres" : "disks");
  const auto line = [&](const std::string& name, const std::array<double, 6>& v)
  {
    text += fmt::format("  {:<6}  {:<16.5f}  {:<7.4f}  {:<8.4g}  {:<12.4f}  {:<17.4f}  {:.4f}\n", name, v[0], v[1],
      v[2], v[3], v[4], v[5]);
  };
  text += "  seed    packing fraction  aspect   rattlers  coordination  fabric anisotropy  stress anisotropy\n";
  std::array<double, 6> sum{};
  for (const Made& made : samples)
  {
    const packing::PackingStatistics& s = made.numbers;
    const std::array<double, 6> values{ s.packingFraction, s.aspect, static_cast<double>(s.rattlers), s.coordination,
      s.fabricAnisotropy, s.stressAnisotropy };
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
std::string toCsv(const packing::Packing& p)
{
  std::string text = p.dimension == 3 ? "x,y,z,r\n" : "x,z,r\n";
  for (std::size_t i = 0; i < p.count(); ++i)
  {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(p.dimension); ++axis)
    {
      text += fmt::format("{},", p.centre[i][axis]);
    }
    text += fmt::format("{}\n", p.radius[i]);
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
}

std::vector<Made> make(Session& session, const PackingCommandOptions& options, std::span<const std::uint64_t> seeds)
{
  std::vector<Made> samples;
  if (!options.read.empty())
  {
    Made made;
    made.packing = loadPacking(options.read, options.table).packing;
    samples.push_back(std::move(made));
  }
  else
  {
    packing::PackingOptions numbers = numbersOf(options);
    numbers.progress = [&](double done) { static_cast<void>(session.progress(done, "packing")); };
    numbers.interrupted = [] { return Session::interrupted(); };
    std::vector<packing::Packing> packed;
    if (seeds.size() == 1)
    {
      numbers.seed = seeds.front();
      packed.push_back(packing::pack(numbers)); // tells how far it is
    }
    else
    {
      packed = packing::packMany(numbers, seeds, options.threads);
    }
    session.endProgress();
    for (std::size_t i = 0; i < seeds.size(); ++i)
    {
      samples.push_back({ seeds[i], std::move(packed[i]), {}, {} });
    }
  }
  for (Made& made : samples)
  {
    made.numbers = packing::statistics(made.packing, options.packing.friction > 0);
  }
  return samples;
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
  vtkNew<vtkPolyData> grains;
  vtkNew<vtkPolyData> contacts;
  setPacking(made.packing, made.numbers, "lamella packing", grains, contacts);
  for (vtkPolyData* const data : { grains.Get(), contacts.Get() })
  {
    if (made.seed)
    {
      const auto seed = static_cast<double>(*made.seed);
      setFieldNumbers(data, "seed", std::span(&seed, 1));
    }
    setProvenance(data, text);
  }
  if (files.grains && files.grains->path().extension() == ".csv")
  {
    files.grains->write(toCsv(made.packing));
  }
  else if (files.grains)
  {
    writeGrid(grains, *files.grains);
  }
  if (files.contacts)
  {
    writeGrid(contacts, *files.contacts);
  }
}

void packingRun(Session& session, const PackingCommandOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  refuseContradictions(options);
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

  std::vector<Made> samples = make(session, options, seeds);
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

  const double seconds = secondsSince(start);
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
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella packing --count 400 --seed 3 -o grains.vtp --contacts forces.vtp",
      "lamella packing --dimension 3 --count 500 --friction 0.3 -o spheres.vtp",
      "lamella packing --seeds 1-10 --threads 2 -o pack_{seed}.vtp --json",
      "lamella packing --read measured.csv --unit 1mm -o grains.vtp" });
  return aloneCommand(app, o, packingRun);
}

} // namespace lamella::cli
