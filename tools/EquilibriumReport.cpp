#include "EquilibriumReport.h"

#include "DiffusionReport.h"
#include "Text.h"

#include "lattice/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

#include <cmath>

namespace lamella::cli
{

namespace
{

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity.
Json number(double value)
{
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// The field data of the image.
struct Fields
{
  vtkImageData* image;
  int dimension;

  double operator()(const char* name, std::size_t i = 0) const { return fieldNumbers(image, name).at(i); }
  [[nodiscard]] std::int64_t whole(const char* name, std::size_t i = 0) const { return std::llround((*this)(name, i)); }
  [[nodiscard]] std::string text(const char* name) const { return fieldText(image, name).value_or(""); }
  [[nodiscard]] Json vector(const char* name) const
  {
    Json json = Json::array();
    for (int c = 0; c < dimension; ++c)
    {
      json.push_back(number((*this)(name, static_cast<std::size_t>(c))));
    }
    return json;
  }
};

Json firstBreak(const Fields& f)
{
  if (!std::isfinite(f("first_break_strain")))
  {
    return nullptr;
  }
  return { { "strain", f("first_break_strain") }, { "stress", f("first_break_stress") },
    { "position", f.vector("first_break_position") }, { "phases", fieldTexts(f.image, "first_break_phases") } };
}

Json pairs(const Fields& f)
{
  Json json = Json::object();
  const std::vector<std::string> names = fieldTexts(f.image, "pair_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    json[names[i]] = { { "young", number(f("pair_youngs_modulus", i)) },
      { "critical_stretch", number(f("pair_critical_stretch", i)) },
      { "fracture_energy", number(f("pair_fracture_energy", i)) }, { "toughness", number(f("pair_toughness", i)) } };
  }
  return json;
}

Json thickness(const Fields& f)
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

Fields fieldsOf(const EquilibriumReport& report)
{
  return { report.image, latticeOf(report.image).dimension };
}

std::string pascal(double value)
{
  return std::isfinite(value) ? fmt::format("{:.7g} Pa", value) : "-";
}

} // namespace

std::string toJson(const EquilibriumReport& report)
{
  const Fields f = fieldsOf(report);
  const Lattice lattice = latticeOf(report.image);
  Json json;
  json["effective_modulus"] = number(f("effective_modulus"));
  json["effective_stress"] = number(f("effective_stress"));
  json["strain"] = number(f("strain"));
  json["first_break"] = firstBreak(f);
  json["largest_stretch_ratio"] = number(f("largest_stretch_ratio"));
  Json mean;
  const std::array<const char*, 6> components{ "xx", "yy", "zz", "xy", "yz", "xz" };
  for (std::size_t c = 0; c < 6; ++c)
  {
    if (f.dimension == 3 || c == 0 || c == 1 || c == 3)
    {
      mean[components[c]] = number(f("mean_stress", c));
    }
  }
  json["mean_stress"] = std::move(mean);
  json["reactions"] = { { "low", f.vector("reaction_low") }, { "high", f.vector("reaction_high") } };
  json["elastic_energy"] = number(f("elastic_energy"));
  json["load"] = f.text("load");
  json["axis"] = f.text("load_axis");
  json["gauge_length"] = f("gauge_length");
  json["section_area"] = f("section_area");
  json["platen_layers"] = Json{ { "low", { f.whole("platen_layers", 0), f.whole("platen_layers", 1) } },
    { "high", { f.whole("platen_layers", 2), f.whole("platen_layers", 3) } } };
  json["pairs"] = pairs(f);
  const Json model = Json::parse(f.text("bond_model"), nullptr, false);
  json["continuum"] = f.text("continuum");
  json["poissons_ratio"] = f("poissons_ratio");
  for (const char* key : { "horizon", "micromodulus", "void_bonds", "surface_correction", "large_strains", "periodic" })
  {
    json[key] = model[key];
  }
  json["thickness"] = thickness(f);
  json["loose_pieces"] = f.whole("loose_pieces");
  json["loose_nodes"] = f.whole("loose_nodes");
  json["hinges"] = f.whole("hinges");
  json["warnings"] = fieldTexts(report.image, "warnings");
  json["solver"] = f.text("solver");
  json["iterations"] = f.whole("iterations");
  json["newton_steps"] = f.whole("newton_steps");
  json["residual"] = number(f("residual"));
  json["levels"] = f.whole("levels");
  json["products"] = f.whole("products");
  json["nodes"] = lattice.count();
  json["solid_nodes"] = f.whole("solid_nodes");
  json["bonds"] = f.whole("bonds");
  json["strips"] = { { "skipped", f.whole("skipped_strips") }, { "uniform", f.whole("visited_strips", 0) },
    { "mixed", f.whole("visited_strips", 1) } };
  json["bytes"] = f.whole("bytes");
  json["seconds"] = report.seconds;
  json["bond_seconds"] = f("seconds", 0);
  json["load_seconds"] = f("seconds", 1);
  json["setup_seconds"] = f("seconds", 2);
  json["solve_seconds"] = f("seconds", 3);
  json["measure_seconds"] = f("seconds", 4);
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["file"] = report.file;
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["refine"] = report.refine;
  json["pixel_size"] = report.pixelSizeSource != "none" ? Json(lattice.spacing * report.refine) : Json(nullptr);
  json["pixel_size_source"] = report.pixelSizeSource;
  const std::vector<std::string> names = fieldTexts(report.image, "phase_names");
  json["phases"] = Json::array();
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    json["phases"].push_back({ { "name", names[id] }, { "fraction", f("phase_fraction", id) } });
  }
  json["threads"] = report.threads;
  json["ranks"] = report.ranks;
  json["files"] = report.written;
  json["version"] = report.provenance.version;
  json["commit"] = report.provenance.commit;
  json["provenance"] = Json::parse(io::toJson(report.provenance));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string toTable(const EquilibriumReport& report)
{
  const Fields f = fieldsOf(report);
  const Lattice lattice = latticeOf(report.image);
  const bool known = report.pixelSizeSource != "none";
  std::string text = fmt::format("{}: {} nodes{}\n\n", report.file, sizeText(lattice.size, lattice.dimension),
    known ? fmt::format(" of {:g} µm", lattice.spacing * 1e6) : ", pixel size unknown");
  const std::vector<std::string> names = fieldTexts(report.image, "pair_names");
  std::size_t width = 5;
  for (const std::string& name : names)
  {
    width = std::max(width, name.size());
  }
  text += fmt::format("  {:<{}}  Young's modulus  breaks at  fracture energy\n", "bonds", width);
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const double s0 = f("pair_critical_stretch", i);
    text += fmt::format("  {:<{}}  {:<15}  {:<9}  {}\n", names[i], width, pascal(f("pair_youngs_modulus", i)),
      std::isfinite(s0) ? fmt::format("{:.4g}", s0) : "never",
      std::isfinite(s0) && known ? fmt::format("{:.4g} J/m²", f("pair_fracture_energy", i)) : "-");
  }
  const bool shear = f.text("load") == "shear";
  text += fmt::format("\n  {} along {} at a strain of {:g}\n", f.text("load"), f.text("load_axis"), f("strain"));
  text += fmt::format(
    "    effective {}  {}\n", shear ? "shear modulus  " : "modulus        ", pascal(f("effective_modulus")));
  text += fmt::format("    stress on the platen       {}\n", pascal(f("effective_stress")));
  text +=
    fmt::format("    elastic energy             {:.6g} {}\n", f("elastic_energy"), f.dimension == 2 ? "J/m" : "J");
  if (std::isfinite(f("first_break_strain")))
  {
    const std::vector<std::string> ends = fieldTexts(report.image, "first_break_phases");
    std::string where;
    for (int c = 0; c < f.dimension; ++c)
    {
      where += fmt::format("{}{:.6g}", c == 0 ? "" : ", ", f("first_break_position", static_cast<std::size_t>(c)));
    }
    text += fmt::format("    first bond breaks at       strain {:.6g}, stress {}\n", f("first_break_strain"),
      pascal(f("first_break_stress")));
    text += fmt::format("      between {} and {}, at {} m\n", ends.at(0), ends.at(1), where);
  }
  else if (f("largest_stretch_ratio") > 0)
  {
    text += fmt::format("    most stretched bond        {:.4g} of what breaks it\n", f("largest_stretch_ratio"));
  }
  const double solve = f("seconds", 2) + f("seconds", 3);
  text += fmt::format("\n  {}, horizon {:g}, {}; {} iterations, residual {:.1e}, {:.3f} s (everything: {:.2f} s, {})\n",
    f.text("continuum"), f("horizon"), f.text("solver"), f.whole("iterations"), f("residual"), solve, report.seconds,
    bytesText(static_cast<double>(peakMemoryBytes())));
  text += fmt::format("  {} nodes, of which {} carry {} bonds and {} were skipped\n", grouped(lattice.count()),
    grouped(f.whole("solid_nodes")), grouped(f.whole("bonds")), grouped(f.whole("skipped_nodes")));
  text += fmt::format("  Strain: movement of the platen over the {:g} {} between the platens; stress: force over the\n"
                      "  section of the box, voids included.\n",
    known ? f("gauge_length") : f("gauge_length") / lattice.spacing, known ? "m" : "pixels");
  for (const std::string& file : report.written)
  {
    text += "  wrote " + file + "\n";
  }
  return text;
}

} // namespace lamella::cli
