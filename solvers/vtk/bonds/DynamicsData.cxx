#include "DynamicsData.h"

#include "BondFields.h"
#include "FieldNumbers.h"
#include "FractureData.h"
#include "NewArray.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"

#include <array>
#include <functional>
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
  const std::size_t count = result.broken.size();
  std::vector<pd::Bond> bonds;
  const auto event = newArray<vtkTypeInt64Array>("event", 1, count);
  const auto step = newArray<vtkTypeInt64Array>("step", 1, count);
  const auto time = newArray<vtkDoubleArray>("time", 1, count);
  const auto energy = newArray<vtkDoubleArray>("energy", 1, count);
  std::int64_t events = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    const pd::DynamicBreak& b = result.broken[i];
    const auto id = static_cast<vtkIdType>(i);
    events += i == 0 || b.step != result.broken[i - 1].step ? 1 : 0;
    bonds.push_back(b.bond);
    event->SetValue(id, events);
    step->SetValue(id, b.step);
    time->SetValue(id, b.time);
    energy->SetValue(id, b.energy);
  }
  describe(event, "1", "from 1; bonds that broke in one step share it", creator);
  describe(step, "1", "step in which it broke, from 1", creator);
  describe(time, "s", "when it broke", creator);
  describe(energy, scene.lattice().dimension == 3 ? "J" : "J/m", "that it held when it broke", creator);
  setBonds(output, bonds, result.ends, scene, creator, { event, step, time, energy });
}

void setHistory(vtkTable* output, const pd::DynamicsResult& result, int dimension, const char* creator)
{
  output->Initialize();
  const auto column = [&](const char* name, const char* unit, const char* text,
                        const std::function<double(const pd::MotionPoint&)>& value)
  {
    const auto array = newArray<vtkDoubleArray>(name, 1, result.history.size());
    for (std::size_t i = 0; i < result.history.size(); ++i)
      array->SetValue(static_cast<vtkIdType>(i), value(result.history[i]));
    describe(array, unit, text, creator);
    output->AddColumn(array);
  };
  const char* const joule = dimension == 3 ? "J" : "J/m";
  column(
    "time", "s", "since the start", [](const auto& p) { return p.time; });
  column(
    "strain", "1", "of the platens, or how far the two sides have moved apart over their distance",
    [](const auto& p) { return p.strain; });
  column(
    "stress", "Pa", "mean force on both platens over the section, or the mean over the box along the axis",
    [](const auto& p) { return p.stress; });
  column(
    "rate", "1", "of the imposed speeds over what they are without regulation", [](const auto& p) { return p.rate; });
  column(
    "kinetic_energy", joule, "of all nodes", [](const auto& p) { return p.energies.kinetic; });
  column(
    "elastic_energy", joule, "of all bonds", [](const auto& p) { return p.energies.elastic; });
  column(
    "broken_energy", joule, "that bonds held when they broke, since the start",
    [](const auto& p) { return p.energies.broken; });
  column(
    "damped_energy", joule, "lost to viscous damping, since the start",
    [](const auto& p) { return p.energies.damped; });
  column(
    "supplied_energy", joule, "work of loads and of moved nodes, since the start",
    [](const auto& p) { return p.energies.supplied; });
  column("energy_defect", "1",
    "kinetic, elastic, broken and damped less supplied and what there was at the start, over the largest of them",
    [](const auto& p) { return p.energies.defect(); });
  for (const char* const name : { "broken", "step" })
  {
    const bool bonds = name[0] == 'b';
    const auto array = newArray<vtkTypeInt64Array>(name, 1, result.history.size());
    for (std::size_t i = 0; i < result.history.size(); ++i)
      array->SetValue(static_cast<vtkIdType>(i), bonds ? result.history[i].broken : result.history[i].step);
    describe(array, "1", bonds ? "bonds broken so far" : "number of the step", creator);
    output->AddColumn(array);
  }
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
