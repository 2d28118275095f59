#include "BreakRun.h"
#include "DynamicsReport.h"
#include "Text.h"
#include "Units.h"

#include "vtkBondDynamics.h"

#include <vtkNew.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct DynamicsOptions : BreakOptions
{
  std::string load;
  std::string strainRate;
  std::string travelTimes;
  std::string start = "98%";
  std::vector<std::string> velocities;
  std::vector<std::string> tractions;
  std::vector<std::string> boxes;
  std::string initialVelocity;
  std::string tau;
  std::string omega0;
  std::string deltaL;
  std::string startRate = "100%";
  std::string damping = "0";
  std::string step;
  std::string stepShare = "80%";
  std::string endTime;
  std::string historyEvery;
  std::vector<std::string> atTimes;
  std::string frames;
};

const std::vector<std::string> loads{ "stretch", "shear", "sides" };
constexpr const char* seconds = "write it in seconds, such as 4e-5";

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

constexpr std::array<const char*, 3> components{ "x", "y", "z" };

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
    {
      if (values[c])
      {
        set(side.c_str(), components[c], *values[c]);
      }
    }
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
  {
    throw ParameterError(fmt::format("{} with --load {}", sides, load), "leave one of them out");
  }
  filter->SetPull(kind < 2);
  filter->SetLoad(static_cast<int>(kind < 2 ? kind : 0));
  const char* const rate = "write it in 1/s, such as 10";
  filter->SetStrainRate(o.strainRate.empty() ? 0 : positive("--strain-rate", o.strainRate, rate));
  if (!o.travelTimes.empty())
  {
    filter->SetTravelTimes(positive("--travel-times", o.travelTimes, "30 is quick, 100 slow"));
  }
  filter->SetStartShare(share("--start", o.start));
  eachSide("--velocity", o.velocities, toNumber,
    [filter](const char* side, const char* c, double value) { filter->SetSideVelocity(side, c, value); });
  eachSide("--traction", o.tractions, pascals,
    [filter](const char* side, const char* c, double value) { filter->SetSideTraction(side, c, value); });
  for (const std::string& text : o.boxes)
  {
    const auto [corners, vector] = keyValue("--box-velocity", text, "X1,Y1,X2,Y2=VX,VY");
    std::vector<double> p;
    for (const std::string& part : split(corners, ','))
    {
      p.push_back(coordinate("--box-velocity", part));
    }
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
          p[0], p[1], d == 3 ? p[2] : 0, p[d], p[d + 1], d == 3 ? p[5] : 0, components[c], *values[c]);
      }
    }
  }
  if (!o.initialVelocity.empty())
  {
    const auto v = vectorOf("--initial-velocity", o.initialVelocity, false);
    filter->SetInitialVelocity(*v[0], *v[1], v.size() > 2 ? *v[2] : 0);
  }
}

void applyRate(const DynamicsOptions& o, vtkBondDynamics* filter)
{
  const double startRate = share("--start-rate", o.startRate);
  const char* const ofTau = !o.omega0.empty() ? "--omega0"
    : !o.deltaL.empty()                       ? "--delta-l"
    : startRate != 1                          ? "--start-rate"
                                              : nullptr;
  if (o.tau.empty() && ofTau != nullptr)
  {
    throw ParameterError(fmt::format("{} without --tau", ofTau), "add --tau, or leave it out");
  }
  if (!o.omega0.empty() && !o.deltaL.empty())
  {
    throw ParameterError("--omega0 and --delta-l", "each says what the other one does: leave one out");
  }
  filter->SetRelaxation(o.tau.empty() ? 0 : positive("--tau", o.tau, seconds));
  filter->SetReferenceEnergy(
    o.omega0.empty() ? 0 : positive("--omega0", o.omega0, "write it in J/m, of a volume in J"));
  filter->SetReferenceCrack(o.deltaL.empty() ? 0 : lengthInMetres("--delta-l", o.deltaL));
  filter->SetStartRate(startRate);
}

/// @returns how many states are asked for at times
std::size_t applyTimes(const DynamicsOptions& o, vtkBondDynamics* filter)
{
  filter->SetEndTime(o.endTime.empty() ? 0 : positive("--end-time", o.endTime, seconds));
  const auto whole = [](const char* option, const std::string& text)
  {
    const auto value = toInteger(text);
    if (!value || *value < 1)
    {
      throw ParameterError(fmt::format("{} '{}' is not a whole number above 0", option, text), "such as 10");
    }
    return *value;
  };
  filter->SetHistoryEvery(o.historyEvery.empty() ? 0 : whole("--history-every", o.historyEvery));
  std::size_t states = 0;
  for (const std::string& text : listed(o.atTimes))
  {
    filter->AddStateAtTime(positive("--at-time", text, seconds));
    ++states;
  }
  if (!o.frames.empty())
  {
    const std::int64_t frames = whole("--frames", o.frames);
    if (filter->GetEndTime() == 0 || frames > 100000)
    {
      throw ParameterError(
        frames > 100000 ? "--frames " + o.frames + " is above 100000" : "--frames without --end-time",
        "it is how many states are kept until the time of the end");
    }
    for (std::int64_t k = 1; k < frames; ++k) // the end is the last one
    {
      filter->AddStateAtTime(filter->GetEndTime() * static_cast<double>(k) / static_cast<double>(frames));
      ++states;
    }
  }
  return states;
}

/// What can be said without the sample. @returns how many states are asked for at times @throws ParameterError
std::size_t apply(const DynamicsOptions& o, vtkBondDynamics* filter)
{
  const char* const forStates = !o.atTimes.empty() ? "--at-time" : !o.frames.empty() ? "--frames" : nullptr;
  applyBreak(o, filter, forStates);
  for (const std::string& text : listItems(o.bonds.density))
  {
    constexpr const char* hint = "write it as --density 2440 or --density wall=1500, in kg/m³";
    if (text.find('=') == std::string::npos)
    {
      filter->SetDensity(positive("--density", text, hint));
      continue;
    }
    const auto [phase, value] = keyValue("--density", text, "PHASE=VALUE");
    filter->SetPhaseDensity(phase.c_str(), positive(("--density " + phase).c_str(), value, hint));
  }
  applyMovement(o, filter);
  applyRate(o, filter);
  filter->SetDamping(share("--damping", o.damping));
  filter->SetTimeStep(o.step.empty() ? 0 : positive("--step", o.step, seconds));
  filter->SetStepShare(share("--step-share", o.stepShare));
  filter->SetComputeVelocity(!o.output.empty());
  return applyTimes(o, filter);
}

void dynamics(Session& session, const DynamicsOptions& options, const std::string& commandLine)
{
  vtkNew<vtkBondDynamics> filter;
  const std::size_t states = apply(options, filter);
  if (options.endTime.empty())
  {
    session.sharesAreGuesses(); // when the sample has failed is to be found
  }
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
  addBondOptions(*app, o->bonds, BondUse::Motion);
  const auto option = [&](const char* group, const char* name, auto& value, const char* text, const char* type)
  { return app->add_option(name, value, text)->type_name(type)->group(group); };
  const char* const load = "Load";
  option(load, "--load", o->load, "Platens pull or shear it; sides: what is said of them and of boxes",
    "stretch|shear|sides");
  option(
    load, "--strain-rate", o->strainRate, "Of platens [1/s]; such that the first break takes --travel-times", "NUMBER");
  option(load, "--travel-times", o->travelTimes, "Of a wave between the platens until the strain of the first break",
    "NUMBER")
    ->default_str("30");
  option(load, "--start", o->start, "Begin in equilibrium at this share of the strain of the first break", "SHARE")
    ->capture_default_str();
  addPullOptions(*app, *o);
  option(load, "--velocity", o->velocities, "Nodes of a side (x-, x+, y-, y+, ...) keep this velocity [m/s], or free",
    "SIDE=VX,VY")
    ->allow_extra_args(false);
  option(load, "--traction", o->tractions, "Force on the area of a side [Pa]", "SIDE=TX,TY")->allow_extra_args(false);
  option(load, "--box-velocity", o->boxes, "Nodes between two corners keep this velocity [m/s], or free",
    "X1,Y1,X2,Y2=VX,VY")
    ->allow_extra_args(false);
  option(load, "--initial-velocity", o->initialVelocity, "Of all that is free, at the start [m/s]", "VX,VY");
  const char* const rate = "Loading rate";
  option(rate, "--tau", o->tau, "Imposed speeds give way to what breaks, with this relaxation time [s]", "NUMBER");
  option(rate, "--omega0", o->omega0, "Their reference energy [J/m], of a volume [J]", "NUMBER");
  option(rate, "--delta-l", o->deltaL, "Or that of a crack so long; a hundredth of the shortest side", "LENGTH");
  option(rate, "--start-rate", o->startRate, "Share of the speeds at first", "SHARE")->capture_default_str();
  addEndOptions(*app, *o);
  option("Breaking", "--end-time", o->endTime, "End at this time [s]", "NUMBER");
  const char* const numerics = "Accuracy and cost";
  option(numerics, "--damping", o->damping, "Viscous force, as a share of the least critical viscosity of the bonds",
    "SHARE")
    ->capture_default_str();
  option(numerics, "--step", o->step, "Step [s]; refused above the largest stable one", "NUMBER");
  option(numerics, "--step-share", o->stepShare, "Step over the largest stable one; cracks that run want 20 to 40 %",
    "SHARE")
    ->capture_default_str();
  addFileOptions(*app, *o,
    { "Write damage, displacement and velocity at the end as .vti, for ParaView",
      "Write the history: time, strain, stress, every energy", "Steps between two", "1000" });
  const char* const out = "Output";
  option(out, "--at-time", o->atTimes, "Likewise at these times [s]", "LIST")->allow_extra_args(false);
  option(out, "--frames", o->frames, "Likewise so many times, evenly until --end-time", "NUMBER");
  option(out, "--history-every", o->historyEvery, "Steps between two points of the history", "NUMBER");
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
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      dynamics(session, *o, line);
    } };
}

} // namespace lamella::cli
