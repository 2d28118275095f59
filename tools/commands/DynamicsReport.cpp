#include "commands/DynamicsReport.h"

#include "commands/DiffusionReport.h"
#include "session/Text.h"

#include "core/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace lamella::cli
{

namespace
{

constexpr std::array<const char*, 6> energies{ "kinetic", "elastic", "broken", "damped", "supplied", "initial" };
constexpr std::array<const char*, 4> times{ "bonds", "start", "motion", "states" };

} // namespace

std::string dynamicsJson(const FractureReport& report)
{
  const BondFields f(report.run);
  Json json;
  using enum Key::Kind;
  addKeys(json, f,
    { { "peak_stress" }, { "peak_strain" }, { "peak_time" }, { "peak_broken", Whole }, { "first_break_time" },
      { "broken", Whole, "total_broken" } });
  json["broken_by_pair"] = brokenByPairJson(report);
  json["energies"] = Json::object();
  for (const char* name : energies)
    json["energies"][name] = f((std::string(name) + "_energy").c_str());
  addKeys(json, f, { { "energy_defect" }, { "end", Text }, { "end_reason", Text }, { "end_time" } });
  const std::vector<vtkDataObject*> states(report.states.begin(), report.states.end());
  json["states"] = statesJson(
    states, report.stateFiles, { { "time" }, { "strain" }, { "stress" }, { "broken", Whole, "broken_bonds" } });
  addKeys(json, f,
    { { "steps", Whole }, { "continued_at", Whole }, { "states_before", Whole }, { "checkpoints", Whole },
      { "last_checkpoint", Whole }, { "time_step" }, { "stable_step" }, { "viscosity" }, { "mean_density" },
      { "reference_energy" }, { "load", Text }, { "axis", Text, "load_axis" }, { "compression", Flag },
      { "effective_modulus" }, { "small_strain_break" }, { "strain_rate" }, { "travel_time" }, { "gauge_length" },
      { "section_area" } });
  addModel(json, f);
  json["statistics"] = Json::object();
  for (std::size_t i = 0; i < times.size(); ++i)
    json["statistics"][std::string(times[i]) + "_seconds"] = f("seconds", i);
  addSizes(json, f);
  json["seconds"] = report.run.seconds;
  addRun(json, report.run);
  return dump(json);
}

std::string dynamicsTable(const FractureReport& report)
{
  const BondFields f(report.run);
  std::string text = sampleText(report.run, true);
  const bool pull = f.text("load") != "sides";
  if (pull)
  {
    text += fmt::format("\n  {} along {}{}, {:.4g} 1/s\n", f.text("load"), f.text("load_axis"),
      f("compression") != 0 ? ", platens approaching: strains and stresses are positive in compression" : "",
      f("strain_rate"));
    text += fmt::format("    modulus           {}; a wave takes {:.4g} s from platen to platen\n",
      pascal(f("effective_modulus")), f("travel_time"));
  }
  else
  {
    text += fmt::format("\n  sides and boxes; strain and stress along {}\n", f.text("load_axis"));
  }
  if (f("total_broken") > 0)
    text += fmt::format("    first break at    {:.6g} s\n", f("first_break_time"));
  text += fmt::format("    peak at           {:.6g} s, strain {:.6g}, stress {}, {} bonds broken\n", f("peak_time"),
    f("peak_strain"), pascal(f("peak_stress")), grouped(f.whole("peak_broken")));
  const auto end = [&](const char* name) { return fieldNumbers(report.states.back(), name).at(0); };
  text += fmt::format("    end at            {:.6g} s, strain {:.6g}, stress {}, {} bonds broken:\n      {}\n",
    f("end_time"), end("strain"), pascal(end("stress")), grouped(f.whole("total_broken")), f.text("end_reason"));
  if (f("total_broken") > 0)
    text += "    broken            " + brokenByPairText(report) + "\n";
  const char* const joule = f.dimension == 2 ? "J/m" : "J";
  text += fmt::format("    energy            kinetic {:.5g} {}, elastic {:.5g}, broken {:.5g}, damped {:.5g};\n"
                      "                      supplied {:.5g}, at first {:.5g}; off by {:.1e} of the largest\n",
    f("kinetic_energy"), joule, f("elastic_energy"), f("broken_energy"), f("damped_energy"), f("supplied_energy"),
    f("initial_energy"), f("energy_defect"));
  for (std::size_t i = 0; i + 1 < report.states.size(); ++i)
  {
    const auto number = [&](const char* name) { return fieldNumbers(report.states[i], name).at(0); };
    text += fmt::format("    state kept at     {:.6g} s, {} bonds broken\n", number("time"),
      grouped(std::llround(number("broken_bonds"))));
  }
  text += fmt::format("\n  {}, horizon {:g}; {} steps of {:.4g} s, {:.2g} of the largest stable one "
                      "(motion: {:.2f} s, everything: {:.2f} s, {})\n",
    f.text("continuum"), f("horizon"), grouped(f.whole("steps")), f("time_step"), f("time_step") / f("stable_step"),
    f("seconds", 2), report.run.seconds, bytesText(static_cast<double>(peakMemoryBytes())));
  text += checkpointsText(f, "steps");
  text += sizesText(f);
  text += wroteText(report.run.written);
  return text;
}

} // namespace lamella::cli
