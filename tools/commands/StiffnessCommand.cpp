#include "commands/BondReport.h"
#include "commands/DiffusionReport.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "commands/StiffnessReport.h"
#include "commands/WindowReport.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

#include "WindowFields.h"
#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "vtkLatticeConversion.h"
#include "vtkVoxelStiffness.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

Json isotropicJson(const Fields& f)
{
  return { { "bulk", f("isotropic_part", 0) }, { "shear", f("isotropic_part", 1) }, { "young", f("isotropic_part", 2) },
    { "poisson", f("isotropic_part", 3) }, { "rest", f("isotropic_part", 4) } };
}

constexpr std::array<const char*, 3> directed{ "young", "shear", "poisson" };

/// The place of an extreme among those of the field data, least and most of each constant.
std::array<double, 3> directionOf(const Fields& f, const char* name, std::size_t i)
{
  return { f(name, 3 * i), f(name, 3 * i + 1), f(name, 3 * i + 2) };
}

Json byDirectionJson(const Fields& f)
{
  Json json = Json::object();
  for (std::size_t k = 0; k < directed.size(); ++k)
    for (std::size_t most = 0; most < 2; ++most)
    {
      const std::size_t i = 2 * k + most;
      const auto vector = [&](const char* name)
      {
        Json list = Json::array();
        for (int a = 0; a < f.dimension; ++a)
          list.push_back(jsonNumber(directionOf(f, name, i)[static_cast<std::size_t>(a)]));
        return list;
      };
      Json& one = json[directed[k]][most != 0 ? "most" : "least"];
      one = { { "value", jsonNumber(f("extremes", i)) }, { "direction", vector("extreme_directions") } };
      if (k > 0)
        one["across"] = vector("extreme_across");
    }
  return json;
}

std::string stiffnessJson(const BondRun& run)
{
  const BondFields f(run);
  Json json;
  addStiffness(json, f);
  json["error_leaves_out"] = "what no pixel shows; how far the box speaks for more of its material";
  if (!f.numbers("hashin_shtrikman").empty())
    json["bounds"]["hashin_shtrikman"] = { { "bulk", { f("hashin_shtrikman", 0), f("hashin_shtrikman", 1) } },
      { "shear", { f("hashin_shtrikman", 2), f("hashin_shtrikman", 3) } } };
  if (!f.numbers("isotropic_part").empty())
  {
    json["isotropic"] = isotropicJson(f);
    json["orthotropic"] = { { "stiffness", rowsOf(f.numbers("orthotropic_part"), f.dimension == 3 ? 6 : 3) },
      { "axes", rowsOf(f.numbers("orthotropic_axes"), 3) }, { "rest", f("orthotropic_rest") } };
    json["by_direction"] = byDirectionJson(f);
  }
  addSensitivity(json, f);
  json["window_errors"] = windowsJson(windowFields(run.image));
  if (!f.numbers("expansion").empty())
    json["expansion"] = f.numbers("expansion");
  if (!f.numbers("load_strain").empty())
    json["load"] = { { "strain", f.numbers("load_strain") }, { "stress", f.numbers("load_stress") },
      { "energy", f("load_energy") }, { "iterations", f.whole("load_iterations") } };
  const Json model = Json::parse(f.text("element_model"), nullptr, false);
  json["materials"] = model["phases"];
  json["continuum"] = f.text("continuum");
  json["sides"] = f.text("sides");
  json["loose_pieces"] = f.whole("loose_pieces");
  json["loose_nodes"] = f.whole("loose_nodes");
  json["warnings"] = fieldTexts(f.image, "warnings");
  addStiffnessSolves(json, f, run.refine);
  addKeys(json, f, { { "solver_error" }, { "levels", Key::Kind::Whole } });
  json["nodes"] = latticeOf(f.image, Voxels::Any).count();
  addKeys(json, f, { { "solid_nodes", Key::Kind::Whole }, { "bytes", Key::Kind::Whole } });
  json["seconds"] = run.seconds;
  addKeys(json, f,
    { { "setup_seconds", Key::Kind::Number, "seconds", 0 }, { "solve_seconds", Key::Kind::Number, "seconds", 1 },
      { "load_seconds", Key::Kind::Number, "seconds", 2 }, { "estimate_seconds", Key::Kind::Number, "seconds", 3 },
      { "sensitivity_seconds", Key::Kind::Number, "seconds", 4 } });
  addRun(json, run);
  return dump(json);
}

std::string materialsText(const BondFields& f)
{
  std::string text;
  const Json model = Json::parse(f.text("element_model"), nullptr, false);
  for (const auto& [phase, constants] : model["phases"].items())
  {
    std::string list;
    for (const auto& [name, value] : constants.items())
    {
      std::string word = name;
      std::ranges::replace(word, '_', ' ');
      list += (list.empty() ? "" : ", ") + word +
        (value.is_number()     ? fmt::format(" {:g}", value.get<double>())
            : value.is_array() ? " " + value.dump()
                               : std::string());
    }
    text += fmt::format("  {}: {}\n", phase, list);
  }
  return text;
}

/// Numbers of a strain or stress with their names: "xx 0.001, yy 0".
std::string componentsText(const std::vector<std::string>& names, const std::vector<double>& values, double unit)
{
  const double least = 1e-6 * std::abs(*std::ranges::max_element(values, {}, [](double v) { return std::abs(v); }));
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format(
      "{}{} {:.5g}", text.empty() ? "" : ", ", names[i], std::abs(values[i]) <= least ? 0.0 : values[i] / unit);
  return text;
}

/// "(0, 0.71, 0.71)"; in the plane an angle from x.
std::string directionText(const std::array<double, 3>& v, int dimension)
{
  if (dimension == 2)
    return fmt::format("{:.4g}°", std::atan2(v[1], v[0]) * 180 / std::numbers::pi);
  const auto hundredths = [](double c) { return 0.01 * static_cast<double>(std::lround(100 * c)); };
  return fmt::format("({:.2g}, {:.2g}, {:.2g})", hundredths(v[0]), hundredths(v[1]), hundredths(v[2]));
}

std::string byDirectionText(const Fields& f)
{
  constexpr std::array<const char*, 3> symbols{ "E", "G", "nu" };
  const auto [unit, name] = stressUnit(f("extremes", 1));
  std::string text = "  of all directions\n";
  for (std::size_t i = 0; i < 2 * symbols.size(); ++i)
  {
    const double value = f("extremes", i);
    text += fmt::format("    {:<4}{}", i % 2 == 0 ? symbols[i / 2] : "", i % 2 == 0 ? "least " : "most  ");
    if (!std::isfinite(value))
    {
      text += "-\n";
      continue;
    }
    text += i / 2 == 2 ? fmt::format("{:.4f}", value) : fmt::format("{:.5g} {}", value / unit, name);
    text += " along " + directionText(directionOf(f, "extreme_directions", i), f.dimension);
    if (i > 1 && f.dimension == 3)
      text += " across " + directionText(directionOf(f, "extreme_across", i), f.dimension);
    text += '\n';
  }
  return text;
}

/// Which phases have no constants that anything could change with.
std::string untoldText(const Fields& f)
{
  if (fieldTexts(f.data, "material_numbers").empty())
    return "";
  std::string list;
  const Json model = Json::parse(f.text("element_model"), nullptr, false);
  for (const auto& [phase, constants] : model["phases"].items())
    if (constants.contains("rigid") || constants.contains("stiffness"))
      list += fmt::format("{}'{}', {}", list.empty() ? "" : "; ", phase,
        constants.contains("rigid") ? "which is rigid" : "whose tensor is given");
  return list.empty() ? list : "    not told of " + list + "\n";
}

std::string stiffnessTable(const BondRun& run)
{
  const BondFields f(run);
  const Lattice lattice = latticeOf(run.image, Voxels::Any);
  std::string text = fmt::format("{}: {} nodes{}\n\n", run.file, sizeText(lattice.size, lattice.dimension),
    sizeKnown(run) ? fmt::format(" of {:g} µm", lattice.spacing * 1e6) : ", pixel size unknown");
  text += materialsText(f);
  const std::vector<std::string> names = fieldTexts(run.image, "stiffness_components");
  const bool tensor = std::isfinite(f("stiffness"));
  if (tensor)
    text += stiffnessText(f);
  if (!f.numbers("hashin_shtrikman").empty() && tensor)
  {
    const auto [unit, name] = stressUnit(f("hashin_shtrikman", 1));
    text +=
      fmt::format("  bounds of isotropic mixtures (Hashin, Shtrikman)\n    K   {:.5g} to {:.5g} {}\n    G   {:.5g} "
                  "to {:.5g} {}\n",
        f("hashin_shtrikman", 0) / unit, f("hashin_shtrikman", 1) / unit, name, f("hashin_shtrikman", 2) / unit,
        f("hashin_shtrikman", 3) / unit, name);
  }
  if (!f.numbers("isotropic_part").empty())
  {
    const auto [unit, name] = stressUnit(f("isotropic_part", 2));
    const auto percent = [](double share)
    { return share < 1e-5 ? std::string("0") : fmt::format("{:.2g}", 100 * share); };
    text += fmt::format("  nearest isotropic tensor: E {:.5g} {}, nu {:.4f}; it leaves {} % of the norm, the nearest "
                        "orthotropic one {} %\n",
      f("isotropic_part", 2) / unit, name, f("isotropic_part", 3), percent(f("isotropic_part", 4)),
      percent(f("orthotropic_rest")));
    text += byDirectionText(f);
  }
  if (const auto windows = windowFields(run.image); !windows.empty())
  {
    text += windowHeading;
    double largest = 0;
    for (const statistics::WindowError& window : windows)
      largest = std::max(largest, window.name.starts_with("nu") ? 0.0 : window.value);
    const auto [unit, name] = stressUnit(largest);
    for (const statistics::WindowError& window : windows)
    {
      const bool ratio = window.name.starts_with("nu");
      if (ratio || window.name.find('_') != std::string::npos) // the diagonal is in the field data
        text += windowText(window.name, window, ratio ? "" : std::string(" ") + name, ratio ? 1 : 1 / unit);
    }
  }
  text += sensitivityText(f) + untoldText(f);
  if (!f.numbers("expansion").empty())
    text += fmt::format("  expansion for a change of 1: {}\n", componentsText(names, f.numbers("expansion"), 1));
  if (!f.numbers("load_strain").empty())
  {
    const std::vector<double> stress = f.numbers("load_stress");
    const double largest = std::abs(*std::ranges::max_element(stress, {}, [](double v) { return std::abs(v); }));
    const auto [unit, name] = stressUnit(largest);
    text += fmt::format("\n  load: mean strain {}\n        mean stress {} {}\n",
      componentsText(names, f.numbers("load_strain"), 1), componentsText(names, stress, unit), name);
  }
  text +=
    fmt::format("\n  {}, sides {}; {} iterations, error of energies {:.1e}, {:.3f} s, error {:.3f} s (everything: "
                "{:.2f} s, {})\n",
      f.text("continuum"), f.text("sides"),
      f.numbers("iterations").empty() ? fmt::format("{}", f.whole("load_iterations")) : iterationsText(f),
      f("solver_error"), f("seconds", 0) + f("seconds", 1), f("seconds", 3), run.seconds,
      bytesText(static_cast<double>(peakMemoryBytes())));
  text +=
    fmt::format("  {} nodes, of which {} were skipped\n", grouped(lattice.count()), grouped(f.whole("skipped_nodes")));
  text += "  Each node is one element of its phase. Mean stress over the whole box, voids included; shear strains as "
          "angles.\n";
  return text +
    stiffnessEnd(f,
      { "pixels and elements", "the material", "what no pixel shows, how far the box speaks for more of its material" },
      run.written);
}

struct StiffnessOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions settings;
  int refine = 1;
  std::string output;
  std::string tensor;
  std::string constants;
  std::string directions;
};

void stiffness(Session& session, const StiffnessOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkVoxelStiffness> filter;
  o.settings.give(filter);
  if (o.refine < 1)
    throw ParameterError(fmt::format("--refine {} is below 1", o.refine), "every pixel becomes N × N");
  filter->SetNodesPerPixel(o.refine);
  ImageSample sample;
  ResultFiles files; // rank 0
  session.onRoot(
    [&]
    {
      files.addGrid("-o", o.output, ".vti", filter->GetImage(), o.common.overwrite);
      files.addGrid("--directions", o.directions, ".vtp", filter->GetDirections(), o.common.overwrite);
      files.addTable("--tensor", o.tensor, filter->GetTensor(), o.common.overwrite);
      files.addTable("--constants", o.constants, filter->GetConstants(), o.common.overwrite);
      const std::string change = o.settings.text("change-array");
      const std::vector<std::string> more(change.empty() ? 0 : 1, change);
      const double* const greys = filter->GetShares();
      if (greys[0] == greys[1])
        sample = loadImage(session, o.picture, o.settings, {}, o.refine, more);
      else if (o.refine > 1)
        throw ParameterError("--refine with --shares", "leave one out: greys tell where in a pixel the surface lies");
      else
        sample = loadGreys(session, o.picture, GreyBins::even(greys[0], greys[1]), more);
    });
  session.broadcast(sample.extent);
  const auto image = sample.image ? sample.image : vtkSmartPointer<vtkImageData>::New();
  runFilterOnRanks(session, filter.GetPointer(), image, sample.extent, "stiffness");
  session.onRoot(
    [&]
    {
      (void)VtkMessages::takeWarnings(); // the same as in the field data
      BondRun run;
      run.image = filter->GetImage();
      for (const std::string& warning : fieldTexts(run.image, "warnings"))
        session.warn(warning);
      run.file = o.picture.file;
      run.pixelSizeSource = sample.pixelSizeSource;
      run.provenance = recordRun(session, commandLine, o.picture.file, sample.provenance);
      run.refine = o.refine;
      run.threads = filter->GetThreads();
      run.ranks = session.ranks();
      run.written = files.write(io::toJson(run.provenance));
      run.seconds = secondsSince(start);
      session.print(o.common.json ? stiffnessJson(run) : o.common.quiet ? "" : stiffnessTable(run));
    });
}

} // namespace

Command stiffnessCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "stiffness", "Effective stiffness tensor of a picture or volume with its error; stresses under a mean load");
  auto o = std::make_shared<StiffnessOptions>();
  addPictureOptions(*app, o->picture);
  o->settings.declare(*app, "vtkVoxelStiffness", { "nodes-per-pixel" });
  addOption(*app, "Accuracy and cost", "--refine", o->refine, "Split every pixel into N × N (× N)", "N")
    ->capture_default_str();
  addOutputOptions(*app, o->output, o->common, "Write the image with its numbers and the stresses of a load as .vti");
  addResultFile(*app, "--tensor", o->tensor, "Write the tensor, one row a stress");
  addResultFile(
    *app, "--constants", o->constants, "Write Young's moduli, shear moduli and Poisson's ratios, one row each");
  addResultFile(*app, "--directions", o->directions, "Write the elastic constants by direction, as a surface or a line",
    "FILE.vtp");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella stiffness honeycomb.png --phase 0=void --other wall --young wall=10e9 --threads 0",
      "lamella stiffness composite.png --young matrix=3e9 --young inclusion=70e9 --plane plane-strain --json",
      "lamella stiffness tissue.png --young wall=10e9±0.5e9 --poisson wall=0.3±0.02",
      "lamella stiffness foam_128x128x128_u8.raw --phase 0=void --other solid --young solid=2e9 --poisson solid=0.4",
      "lamella stiffness tissue.vti --young wall=8e9 --young-across wall=6.4e9 --mean-strain xx=0.01 -o "
      "stresses.vti" });
  return jointCommand(app, o, stiffness);
}

} // namespace lamella::cli
