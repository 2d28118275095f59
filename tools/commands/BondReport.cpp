#include "commands/BondReport.h"

#include "commands/DiffusionReport.h"
#include "commands/SensitivityReport.h"
#include "files/Record.h"
#include "session/Text.h"

#include "vtkLatticeConversion.h"

#include <vtkDataObject.h>
#include <vtkImageData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

Json pairs(const BondFields& f)
{
  Json json = Json::object();
  const std::vector<std::string> names = fieldTexts(f.image, "pair_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    json[names[i]] = { { "young", jsonNumber(f("pair_youngs_modulus", i)) },
      { "critical_stretch", jsonNumber(f("pair_critical_stretch", i)) },
      { "fracture_energy", jsonNumber(f("pair_fracture_energy", i)) },
      { "toughness", jsonNumber(f("pair_toughness", i)) } };
  }
  return json;
}

Json thickness(const BondFields& f)
{
  Json json = Json::object();
  const std::vector<std::string> names = fieldTexts(f.image, "thickness_phases");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    json[names[i]] = { { "median_nodes", f("thickness_median", i) },
      { "share_below_horizon", f("thickness_thin_share", i) } };
  }
  return json;
}

} // namespace

std::string pascal(double value)
{
  return std::isfinite(value) ? fmt::format("{:.7g} Pa", value) : "-";
}

BondFields::BondFields(const BondRun& run)
  : Fields{ run.image, latticeOf(run.image).dimension }
  , image(run.image)
{
}

Json statesJson(
  std::span<vtkDataObject* const> states, const std::vector<std::string>& files, std::initializer_list<Key> keys)
{
  Json list = Json::array();
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    Json state = keysOf({ states[i] }, keys);
    state["file"] = i < files.size() ? Json(files[i]) : Json(nullptr);
    list.push_back(std::move(state));
  }
  return list;
}

void addPlatens(Json& json, const BondFields& f)
{
  addKeys(json, f, { { "gauge_length" }, { "section_area" } });
  json["platen_layers"] = nullptr;
  json["pore_volume"] = nullptr;
  json["open_pore_nodes"] = nullptr;
  if (!fieldNumbers(f.image, "pore_volume").empty())
    addKeys(json, f, { { "pore_volume" }, { "open_pore_nodes", Key::Kind::Whole } });
  if (f("platen_layers", 1) >= 0)
    json["platen_layers"] = Json{ { "low", { f.whole("platen_layers", 0), f.whole("platen_layers", 1) } },
      { "high", { f.whole("platen_layers", 2), f.whole("platen_layers", 3) } } };
}

std::string checkpointsText(const BondFields& f, const char* what)
{
  std::string text;
  if (f("continued_at") > 0)
    text += fmt::format("  continued after {} {}\n", grouped(f.whole("continued_at")), what);
  if (f("last_checkpoint") > 0)
  {
    text += fmt::format("  {} checkpoints, the last after {} {}\n", grouped(f.whole("checkpoints")),
      grouped(f.whole("last_checkpoint")), what);
  }
  return text;
}

void addModel(Json& json, const BondFields& f)
{
  json["pairs"] = pairs(f);
  const Json model = Json::parse(f.text("bond_model"), nullptr, false);
  json["continuum"] = f.text("continuum");
  json["poissons_ratio"] = f("poissons_ratio");
  for (const char* key : { "horizon", "micromodulus", "void_bonds", "surface_correction", "large_strains", "periodic" })
    json[key] = model[key];
  json["thickness"] = thickness(f);
  json["loose_pieces"] = f.whole("loose_pieces");
  json["loose_nodes"] = f.whole("loose_nodes");
  if (!f.numbers("hinges").empty()) // of an equilibrium
    json["hinges"] = f.whole("hinges");
  json["warnings"] = fieldTexts(f.image, "warnings");
}

namespace
{

constexpr const char* breakStress = "first_break_stress";

} // namespace

void addBreakSensitivity(Json& json, const BondFields& f)
{
  Json sensitivity;
  Json relative;
  Json inputs;
  MaterialNumbers(f.data).add(
    sensitivity, relative, breakStress, f(breakStress), fieldNumbers(f.data, "first_break_sensitivity"));
  if (const std::vector<double> error = fieldNumbers(f.data, "first_break_input_error"); !error.empty())
    inputs[breakStress] = jsonNumber(error[0] / std::abs(f(breakStress)));
  json["sensitivity"] = std::move(sensitivity);
  json["relative_sensitivity"] = std::move(relative);
  json["input_errors"] = std::move(inputs);
}

std::string breakSensitivityText(const BondFields& f)
{
  const std::vector<double> changes = fieldNumbers(f.data, "first_break_sensitivity");
  if (changes.empty())
    return "";
  return "      1 % more changes that stress by\n" +
    sensitivityText(MaterialNumbers(f.data).of("", f(breakStress), changes), 2, "the materials'");
}

void addSolve(Json& json, const BondFields& f)
{
  addKeys(json, f, { { "residual" }, { "levels", Key::Kind::Whole }, { "products", Key::Kind::Whole } });
}

void addSizes(Json& json, const BondFields& f)
{
  json["nodes"] = latticeOf(f.image).count();
  json["solid_nodes"] = f.whole("solid_nodes");
  json["bonds"] = f.whole("bonds");
  json["strips"] = { { "skipped", f.whole("skipped_strips") }, { "uniform", f.whole("visited_strips", 0) },
    { "mixed", f.whole("visited_strips", 1) } };
  json["bytes"] = f.whole("bytes");
}

void addRun(Json& json, const BondRun& run)
{
  const BondFields f(run);
  const Lattice lattice = latticeOf(run.image);
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["file"] = run.file;
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["refine"] = run.refine;
  json["pixel_size"] = sizeKnown(run) ? Json(lattice.spacing * run.refine) : Json(nullptr);
  json["pixel_size_source"] = run.pixelSizeSource;
  json["phases"] = phasesJson(fieldTexts(run.image, "phase_names"), f.numbers("phase_fraction"));
  json["threads"] = run.threads;
  json["ranks"] = run.ranks;
  json["files"] = run.written;
  addRecord(json, run.provenance);
}

bool sizeKnown(const BondRun& run)
{
  return run.pixelSizeSource != "none";
}

std::string lengthsText(const BondRun& run, const std::vector<double>& lengths)
{
  const double unit = sizeKnown(run) ? 1 : latticeOf(run.image).spacing * run.refine;
  std::string text;
  for (const double length : lengths)
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", length / unit);
  return text + (sizeKnown(run) ? " m" : " pixels");
}

std::string platensText(const BondRun& run)
{
  const BondFields fields(run);
  if (fields.text("load") == "pressure")
    return fmt::format("  Strain: growth of the {:.4g} {} of pores under pressure, over that; stress: the pressure.\n",
      fields("pore_volume"), fields.dimension == 2 ? "m²" : "m³");
  return fmt::format("  Strain: movement of the platen over the {} between the platens; stress: force over the\n"
                     "  section of the box, voids included.\n",
    lengthsText(run, { BondFields(run)("gauge_length") }));
}

std::string sampleText(const BondRun& run, bool fracture)
{
  const BondFields f(run);
  const Lattice lattice = latticeOf(run.image);
  const bool known = sizeKnown(run);
  std::string text = fmt::format("{}: {} nodes{}\n\n", run.file, sizeText(lattice.size, lattice.dimension),
    known ? fmt::format(" of {:g} µm", lattice.spacing * 1e6) : ", pixel size unknown");
  const std::vector<std::string> names = fieldTexts(run.image, "pair_names");
  std::size_t width = 5;
  for (const std::string& name : names)
    width = std::max(width, name.size());
  text += fmt::format("  {:<{}}  Young's modulus{}\n", "bonds", width, fracture ? "  breaks at  fracture energy" : "");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const std::string modulus = pascal(f("pair_youngs_modulus", i));
    if (!fracture)
    {
      text += fmt::format("  {:<{}}  {}\n", names[i], width, modulus);
      continue;
    }
    const double s0 = f("pair_critical_stretch", i);
    text += fmt::format("  {:<{}}  {:<15}  {:<9}  {}\n", names[i], width, modulus,
      std::isfinite(s0) ? fmt::format("{:.4g}", s0) : "never",
      std::isfinite(s0) && known ? fmt::format("{:.4g} J/m²", f("pair_fracture_energy", i)) : "-");
  }
  return text;
}

std::string sizesText(const BondFields& f)
{
  return fmt::format("  {} nodes, of which {} carry {} bonds and {} were skipped\n",
    grouped(latticeOf(f.image).count()), grouped(f.whole("solid_nodes")), grouped(f.whole("bonds")),
    grouped(f.whole("skipped_nodes")));
}

} // namespace lamella::cli
