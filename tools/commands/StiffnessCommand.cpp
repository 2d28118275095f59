#include "commands/BondReport.h"
#include "commands/DiffusionReport.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "commands/StiffnessReport.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

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
#include <cmath>
#include <memory>
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
  }
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
      { "load_seconds", Key::Kind::Number, "seconds", 2 }, { "estimate_seconds", Key::Kind::Number, "seconds", 3 } });
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
  }
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
  if (tensor && std::isfinite(f("estimated_error")))
    text += "  The error is that of pixels and elements against the material, from every second, third and fourth\n"
            "  pixel. Not in it: what no pixel shows, how far the box speaks for more of its material.\n";
  if (f.text("continuum") == "plane-strain")
    text += "  Constants of the plane: an isotropic material would have E/(1 - nu²) and nu/(1 - nu).\n";
  text += wroteText(run.written);
  return text;
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
  addResultFile(
    *app, "--directions", o->directions, "Write Young's modulus by direction, as a surface or a line", "FILE.vtp");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella stiffness honeycomb.png --phase 0=void --other wall --young wall=10e9 --threads 0",
      "lamella stiffness composite.png --young matrix=3e9 --young inclusion=70e9 --plane plane-strain --json",
      "lamella stiffness foam_128x128x128_u8.raw --phase 0=void --other solid --young solid=2e9 --poisson solid=0.4",
      "lamella stiffness tissue.vti --young wall=8e9 --young-across wall=6.4e9 --mean-strain xx=0.01 -o "
      "stresses.vti" });
  return jointCommand(app, o, stiffness);
}

} // namespace lamella::cli
