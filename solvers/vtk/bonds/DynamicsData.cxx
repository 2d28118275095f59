#include "DynamicsData.h"

#include "BondFields.h"
#include "FieldNumbers.h"
#include "FractureData.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"

#include <array>
#include <limits>

namespace pd = lamella::peridynamics;

namespace lamella
{

const char* wordOf(pd::MotionEnd end)
{
  constexpr std::array<const char*, 4> words{ "time", "stress-fell", "maximum-strain", "maximum-broken" };
  return words.at(static_cast<std::size_t>(end));
}

void setBrokenBonds(vtkPolyData* output, const pd::DynamicsResult& result, const BondScene& scene, const char* creator)
{
  using Break = pd::DynamicBreak;
  std::vector<pd::Bond> bonds;
  std::vector<std::int64_t> events; // from 1
  for (const Break& b : result.broken)
  {
    const bool begins = bonds.empty() || b.step != result.broken[bonds.size() - 1].step;
    events.push_back((events.empty() ? 0 : events.back()) + (begins ? 1 : 0));
    bonds.push_back(b.bond);
  }
  const Columns<pd::Bond> rest = setBonds(output, bonds, scene, creator);
  const Columns columns{ rest.data, result.broken, creator };
  columns.add<vtkTypeInt64Array>(
    "event", "1", "from 1; bonds that broke in one step share it", [&](std::size_t i) { return events[i]; });
  columns.add<vtkTypeInt64Array>("step", "1", "step in which it broke, from 1", &Break::step);
  columns.numbers("time", "s", "when it broke", &Break::time);
  columns.numbers("energy", scene.lattice().dimension == 3 ? "J" : "J/m", "that it held when it broke", &Break::energy);
  addEnds(rest, result.ends, scene);
  output->GetPointData()->SetActiveScalars("event");
}

void setHistory(vtkTable* output, const pd::DynamicsResult& result, int dimension, const char* creator)
{
  using Point = pd::MotionPoint;
  output->Initialize();
  const Columns columns{ output->GetRowData(), result.history, creator };
  const auto energy = [&](const char* name, const char* text, double pd::EnergyBalance::*part)
  { columns.numbers(name, dimension == 3 ? "J" : "J/m", text, [&](const Point& p) { return p.energies.*part; }); };
  columns.numbers("time", "s", "since the start", &Point::time);
  columns.numbers(
    "strain", "1", "of the platens, or how far the two sides have moved apart over their distance", &Point::strain);
  columns.numbers("stress", "Pa",
    "mean force on both platens over the section, or the mean over the box along the axis", &Point::stress);
  columns.numbers("rate", "1", "of the imposed speeds over what they are without regulation", &Point::rate);
  energy("kinetic_energy", "of all nodes", &pd::EnergyBalance::kinetic);
  energy("elastic_energy", "of all bonds", &pd::EnergyBalance::elastic);
  energy("broken_energy", "that bonds held when they broke, since the start", &pd::EnergyBalance::broken);
  energy("damped_energy", "lost to viscous damping, since the start", &pd::EnergyBalance::damped);
  energy("supplied_energy", "work of loads and of moved nodes, since the start", &pd::EnergyBalance::supplied);
  columns.numbers("energy_defect", "1",
    "kinetic, elastic, broken and damped less supplied and what there was at the start, over the largest of them",
    [](const Point& p) { return p.energies.defect(); });
  columns.add<vtkTypeInt64Array>("broken", "1", "bonds broken so far", &Point::broken);
  columns.add<vtkTypeInt64Array>("step", "1", "number of the step", &Point::step);
}

void setDynamicsNumbers(vtkImageData* output, const pd::DynamicsResult& r)
{
  const auto set = [output](const char* name, double value) { setFieldNumber(output, name, value); };
  const auto whole = [&](const char* name, std::int64_t value) { set(name, static_cast<double>(value)); };
  const pd::EnergyBalance& e = r.history.back().energies;
  setPlatens(output, r);
  setWork(output, r);
  setFieldText(output, "end", wordOf(r.end));
  setFieldText(output, "end_reason", pd::describe(r.end));
  set("end_time", r.history.back().time);
  set("peak_stress", r.peak.stress);
  set("peak_strain", r.peak.strain);
  set("peak_time", r.peak.time);
  whole("peak_broken", r.peak.broken);
  set("first_break_time", r.broken.empty() ? std::numeric_limits<double>::quiet_NaN() : r.broken.front().time);
  whole("total_broken", static_cast<std::int64_t>(r.broken.size()));
  set("kinetic_energy", e.kinetic);
  set("elastic_energy", e.elastic);
  set("broken_energy", e.broken);
  set("damped_energy", e.damped);
  set("supplied_energy", e.supplied);
  set("initial_energy", e.initial);
  set("energy_defect", e.defect());
  whole("steps", r.history.back().step);
  set("time_step", r.step);
  set("stable_step", r.stable);
  set("viscosity", r.viscosity);
  set("mean_density", r.density);
  set("reference_energy", r.referenceEnergy);
  set("effective_modulus", r.modulus);
  set("small_strain_break", r.firstBreak);
  set("strain_rate", r.strainRate);
  set("travel_time", r.travelTime);
  setFieldNumbers(output, "seconds", std::array{ r.bondSeconds, r.startSeconds, r.motionSeconds, r.stateSeconds });
  whole("continued_at", r.continuedAt);
  whole("states_before", r.statesBefore);
  whole("checkpoints", r.checkpoints);
  whole("last_checkpoint", r.checkpointAt);
}

void setMotionState(vtkImageData* output, const pd::MotionState& state, const BondScene& scene, const char* creator)
{
  setBrokenState(output, state, scene, creator);
  if (state.velocity)
  {
    const std::array<int, 3> from{ 0, 1, scene.lattice().dimension == 3 ? 2 : -1 };
    const auto velocity = scene.toPiece(*state.velocity, from, "velocity");
    describe(velocity, "m/s", "0 in voids", creator);
    output->GetPointData()->AddArray(velocity);
  }
  setFieldNumber(output, "time", state.time);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), state.time);
}

} // namespace lamella
