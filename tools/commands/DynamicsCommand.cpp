#include "commands/BreakRun.h"
#include "commands/DiffusionReport.h"
#include "commands/FractureReport.h"
#include "session/Text.h"
#include "session/Units.h"

#include "core/Memory.h"
#include "lattice/AxisNames.h"
#include "vtkBondDynamics.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

namespace lamella::cli
{

namespace
{

constexpr std::array<const char*, 6> energies{ "kinetic", "elastic", "broken", "damped", "supplied", "initial" };
constexpr std::array<const char*, 4> times{ "bonds", "start", "motion", "states" };

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

struct DynamicsOptions : BreakOptions
{
  std::string load;
  std::vector<std::string> velocities;
  std::vector<std::string> tractions;
  std::vector<std::string> boxes;
  std::string initialVelocity;
  std::string frames;
};

const std::vector<std::string> loads{ "stretch", "shear", "sides" };

/// "VX,VY": numbers, or "free".
std::vector<std::optional<double>> vectorOf(const char* option, const std::string& text, bool mayBeFree,
  std::optional<double> (*read)(std::string_view) = toNumber)
{
  std::vector<std::optional<double>> values;
  for (const std::string& part : split(text, ','))
  {
    const auto number = read(part);
    if (!(number && (*number == 0 || plausible(*number))) && !(mayBeFree && part == "free"))
    {
      throw ParameterError(fmt::format("{} '{}': '{}' is no number", option, text, part),
        mayBeFree ? "give a number along x, y and, of a volume, z; or 'free'"
                  : "give a number along x, y and, of a volume, z");
    }
    values.push_back(number);
  }
  if (values.size() < 2 || values.size() > 3)
  {
    throw ParameterError(fmt::format("{} '{}' has {} numbers", option, text, values.size()),
      "give one along x, one along y and, of a volume, one along z");
  }
  return values;
}

/// "SIDE=VX,VY".
template <class Set>
void eachSide(
  const char* option, const std::vector<std::string>& texts, std::optional<double> (*read)(std::string_view), Set&& set)
{
  const std::vector<std::string> sides{ "x-", "x+", "y-", "y+", "z-", "z+" };
  for (const std::string& text : texts)
  {
    const auto [side, vector] = keyValue(option, text, "SIDE=VX,VY");
    (void)oneOf(option, side, sides);
    const auto values = vectorOf(option, vector, true, read);
    for (std::size_t c = 0; c < values.size(); ++c)
      if (values[c])
        set(side.c_str(), axisNames[c], *values[c]);
  }
}

void applyMovement(const DynamicsOptions& o, vtkBondDynamics* filter)
{
  const char* const sides = !o.velocities.empty() ? "--velocity"
    : !o.tractions.empty()                        ? "--traction"
    : !o.boxes.empty()                            ? "--box-velocity"
    : !o.initialVelocity.empty()                  ? "--initial-velocity"
                                                  : nullptr;
  const std::string load = !o.load.empty() ? o.load : sides != nullptr ? "sides" : "stretch";
  const std::size_t kind = oneOf("--load", load, loads);
  if (kind < 2 && sides != nullptr)
    throw ParameterError(fmt::format("{} with --load {}", sides, load), "leave one of them out");
  filter->SetPull(kind < 2);
  filter->SetLoad(static_cast<int>(kind < 2 ? kind : 0));
  eachSide(
    "--velocity", o.velocities, toNumber,
    [filter](const char* side, const char* c, double value) { filter->SetSideVelocity(side, c, value); });
  eachSide("--traction", o.tractions, pascals,
    [filter](const char* side, const char* c, double value) { filter->SetSideTraction(side, c, value); });
  for (const std::string& text : o.boxes)
  {
    const auto [corners, vector] = keyValue("--box-velocity", text, "X1,Y1,X2,Y2=VX,VY");
    std::vector<double> p;
    for (const std::string& part : split(corners, ','))
      p.push_back(coordinate("--box-velocity", part));
    if (p.size() != 4 && p.size() != 6)
    {
      throw ParameterError(fmt::format("--box-velocity '{}' has {} coordinates", text, p.size()),
        "a picture takes X1,Y1,X2,Y2=VX,VY, a volume X1,Y1,Z1,X2,Y2,Z2=VX,VY,VZ");
    }
    const std::size_t d = p.size() / 2;
    const auto values = vectorOf("--box-velocity", vector, true);
    for (std::size_t c = 0; c < values.size(); ++c)
    {
      if (values[c])
      {
        filter->AddBoxVelocity(
          p[0], p[1], d == 3 ? p[2] : 0, p[d], p[d + 1], d == 3 ? p[5] : 0, axisNames[c], *values[c]);
      }
    }
  }
  if (!o.initialVelocity.empty())
  {
    const auto v = vectorOf("--initial-velocity", o.initialVelocity, false);
    filter->SetInitialVelocity(*v[0], *v[1], v.size() > 2 ? *v[2] : 0);
  }
}

/// @returns how many states are asked for at times
std::size_t applyFrames(const DynamicsOptions& o, vtkBondDynamics* filter)
{
  const std::size_t states = o.bonds.settings.count("at-time");
  if (o.frames.empty())
    return states;
  const auto frames = toInteger(o.frames).value_or(0);
  if (frames < 1 || frames > 100000)
    throw ParameterError("--frames '" + o.frames + "' is not a whole number from 1 to 100000", "such as 10");
  if (filter->GetEndTime() == 0)
    throw ParameterError("--frames without --end-time", "it is how many states are kept until the time of the end");
  for (std::int64_t k = 1; k < frames; ++k) // the end is the last one
    filter->AddStateAtTime(filter->GetEndTime() * static_cast<double>(k) / static_cast<double>(frames));
  return states + static_cast<std::size_t>(frames - 1);
}

/// What can be said without the sample. @returns how many states are asked for at times @throws ParameterError
std::size_t apply(const Session& session, const DynamicsOptions& o, vtkBondDynamics* filter)
{
  applyMovement(o, filter);
  applyBreak(session, o, filter, o.frames.empty() ? nullptr : "--frames");
  filter->SetComputeVelocity(!o.output.empty());
  return applyFrames(o, filter);
}

void dynamics(Session& session, const DynamicsOptions& options, const std::string& commandLine)
{
  vtkNew<vtkBondDynamics> filter;
  const std::size_t states = apply(session, options, filter);
  if (filter->GetEndTime() == 0)
    session.sharesAreGuesses(); // when the sample has failed is to be found
  runBreak(session, options, filter, commandLine, "motion", "steps", states, 24, // velocities
    [&](const FractureReport& report) { return options.common.json ? dynamicsJson(report) : dynamicsTable(report); });
}

} // namespace

Command dynamicsCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "dynamics", "Bonds in motion: waves and cracks that run in a picture or volume, with every energy accounted for");
  auto o = std::make_shared<DynamicsOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondDynamics",
    { "pull", "load", "side-velocity", "side-traction", "box-velocity", "initial-velocity", "use-input-velocity" });
  o->bonds.settings.formerly(*app, "step", "time-step");
  const auto option = [&](const char* group, const char* name, auto& value, const char* text, const char* type)
  { return app->add_option(name, value, text)->type_name(type)->group(group); };
  const char* const load = "Load";
  option(load, "--load", o->load, "Platens pull or shear it; sides: what is said of them and of boxes",
    "stretch|shear|sides");
  option(load, "--velocity", o->velocities, "Nodes of a side (x-, x+, y-, y+, ...) keep this velocity [m/s], or free",
    "SIDE=VX,VY")
    ->allow_extra_args(false);
  option(load, "--traction", o->tractions, "Force on the area of a side [Pa]", "SIDE=TX,TY")->allow_extra_args(false);
  option(load, "--box-velocity", o->boxes, "Nodes between two corners keep this velocity [m/s], or free",
    "X1,Y1,X2,Y2=VX,VY")
    ->allow_extra_args(false);
  option(load, "--initial-velocity", o->initialVelocity, "Of all that is free, at the start [m/s]", "VX,VY");
  addFileOptions(*app, *o,
    { "Write damage, displacement and velocity at the end as .vti, for ParaView",
      "Write the history: time, strain, stress, every energy", "Steps between two", "1000" });
  const char* const out = "Output";
  option(out, "--frames", o->frames, "Write so many states, evenly until --end-time", "NUMBER");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella dynamics grains.vti --young matrix=1e9 --young grain=4e9 --toughness matrix=1e5 --toughness grain=4e5 "
      "--like matrix-grain=matrix --like grain-grain=matrix --density 1500 --damping 0.1 --curve history.csv",
      "lamella dynamics plate.png --phase 255=glass --pixel-size 0.25mm --young glass=72e9 --fracture-energy glass=3.8 "
      "--density 2440 --notch 0,20mm,50mm,20mm --traction y+=0,2e6 --traction y-=0,-2e6 --end-time 43e-6 "
      "--step-share 40% --frames 4 -o branching.vti",
      "lamella dynamics bar.png --phase 255=steel --pixel-size 1mm --young steel=2e11 --density 7800 "
      "--velocity x-=5,free --end-time 1e-4 --curve wave.csv",
      "lamella snapshot branching_003.vti --array damage -o branching.png" });
  return jointCommand(app, o, dynamics);
}

} // namespace lamella::cli
