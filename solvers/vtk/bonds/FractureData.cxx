#include "FractureData.h"

#include "BondFields.h"
#include "FieldNumbers.h"
#include "NewArray.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <array>
#include <cmath>
#include <limits>

namespace pd = lamella::peridynamics;

namespace lamella
{
const char* wordOf(pd::FractureEnd end)
{
  constexpr std::array<const char*, 7> words{ "running", "stress-fell", "severed", "nothing-breaks", "maximum-strain",
    "maximum-broken", "interrupted" };
  return words.at(static_cast<std::size_t>(end));
}

const char* wordOf(pd::FractureMethod method)
{
  return method == pd::FractureMethod::Events ? "events" : "accurate";
}

const char* wordOf(pd::Breaking breaking)
{
  return breaking == pd::Breaking::Strict ? "strict" : "batched";
}

void setBonds(vtkPolyData* output, std::span<const pd::Bond> bonds, std::span<const pd::BondEnds> ends,
  const BondScene& scene, const char* creator, std::initializer_list<vtkDataArray*> first)
{
  const Lattice& lattice = scene.lattice();
  const pd::Stencil stencil(lattice.dimension, scene.model().horizon);
  const auto points = newPoints(bonds.size());
  const auto vector = newArray<vtkDoubleArray>("bond", 3, bonds.size());
  const auto phases = newArray<vtkUnsignedCharArray>("phases", 2, bonds.size());
  const auto between = newArray<vtkUnsignedCharArray>("between_grains", 1, bonds.size());
  for (std::size_t i = 0; i < bonds.size(); ++i)
  {
    const auto id = static_cast<vtkIdType>(i);
    points->SetPoint(id, pd::middleOf(lattice, stencil, bonds[i]).data());
    const auto& step = stencil.half()[static_cast<std::size_t>(bonds[i].offset)].step;
    vector->SetTuple3(id, lattice.spacing * step[0], lattice.spacing * step[1], lattice.spacing * step[2]);
    phases->SetTypedComponent(id, 0, ends[i].low);
    phases->SetTypedComponent(id, 1, ends[i].high);
    between->SetValue(id, ends[i].betweenGrains ? 1 : 0);
  }
  describe(vector, "m", "from its first node to its second", creator);
  describe(phases, "1", "phases of both ends, the lesser first", creator);
  describe(between, "1", "1 where the ends lie in two different grains", creator);
  setVertices(output, points);
  vtkPointData* const data = output->GetPointData();
  addArrays(data, first);
  addArrays(data, { vector, phases, between });
  data->SetActiveScalars("event");
}

void setBrokenBonds(vtkPolyData* output, const pd::FractureResult& result, const BondScene& scene, const char* creator)
{
  const std::vector<pd::BrokenBond>& broken = result.record.broken;
  const std::size_t count = broken.size();
  std::vector<pd::Bond> bonds;
  const auto event = newArray<vtkTypeInt64Array>("event", 1, count);
  const auto strain = newArray<vtkDoubleArray>("strain", 1, count);
  const auto critical = newArray<vtkDoubleArray>("critical_strain", 1, count);
  const auto stress = newArray<vtkDoubleArray>("stress", 1, count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const pd::BrokenBond& b = broken[i];
    const auto id = static_cast<vtkIdType>(i);
    bonds.push_back(b.bond);
    event->SetValue(id, b.event);
    strain->SetValue(id, b.strain);
    critical->SetValue(id, b.criticalStrain);
    stress->SetValue(id, b.stress);
  }
  describe(event, "1", "number of the event in which it broke, from 1", creator);
  describe(strain, "1", "strain that was imposed when it broke", creator);
  describe(critical, "1", "strain at which it was just critical: the path that follows every snap-back", creator);
  describe(stress, "Pa", "stress at the imposed strain, just before it broke", creator);
  setBonds(output, bonds, result.ends, scene, creator, { event, strain, critical, stress });
}

void setFractureCurve(vtkTable* output, const pd::FractureResult& result, const char* creator)
{
  const std::size_t rows = result.curve.size();
  const auto strain = newArray<vtkDoubleArray>("strain", 1, rows);
  const auto stress = newArray<vtkDoubleArray>("stress", 1, rows);
  const auto broken = newArray<vtkTypeInt64Array>("broken", 1, rows);
  const auto criticalStrain = newArray<vtkDoubleArray>("critical_strain", 1, rows);
  const auto criticalStress = newArray<vtkDoubleArray>("critical_stress", 1, rows);
  for (std::size_t i = 0; i < rows; ++i)
  {
    const pd::FractureCurvePoint& p = result.curve[i];
    const auto row = static_cast<vtkIdType>(i);
    strain->SetValue(row, p.strain);
    stress->SetValue(row, p.stress);
    broken->SetValue(row, p.broken);
    criticalStrain->SetValue(row, p.criticalStrain);
    criticalStress->SetValue(row, p.criticalStress);
  }
  describe(strain, "1", "imposed strain, which never falls", creator);
  describe(stress, "Pa", "force on the platen over the section of the box, at that strain", creator);
  describe(broken, "1", "bonds broken so far", creator);
  describe(criticalStrain, "1", "strain at which the next bond is just critical: follows every snap-back", creator);
  describe(criticalStress, "Pa", "stress at that strain", creator);
  output->Initialize();
  addArrays(output->GetRowData(), { strain, stress, broken, criticalStrain, criticalStress });
}

void setFractureNumbers(vtkImageData* output, const pd::FractureResult& r)
{
  const auto set = [output](const char* name, double value) { setFieldNumber(output, name, value); };
  const auto whole = [&](const char* name, std::int64_t value) { set(name, static_cast<double>(value)); };
  const pd::FractureStatistics& s = r.record.statistics;
  const bool some = !r.record.broken.empty();
  setPlatens(output, r);
  setWork(output, r);
  set("effective_modulus", r.record.modulus);
  set("peak_stress", r.peak.stress);
  set("peak_strain", r.peak.strain);
  whole("peak_broken", r.peak.broken);
  set("first_break_strain", some ? r.record.first.strain : unknown);
  set("first_break_stress", some ? r.record.first.stress : unknown);
  whole("total_broken", static_cast<std::int64_t>(r.record.broken.size()));
  set("broken_energy", r.brokenEnergy);
  setFieldText(output, "end", wordOf(r.record.end));
  setFieldText(output, "end_reason", pd::describe(r.record.end));
  setFieldText(output, "method", wordOf(r.method));
  whole("events", s.events);
  whole("raises", s.raises);
  whole("equilibria", s.equilibria);
  whole("iterations", s.globalIterations);
  whole("local_cycles", s.localCycles);
  whole("visited_nodes", s.nodesVisited);
  whole("searches", s.searches);
  whole("freed_pieces", s.loosePieces);
  whole("freed_nodes", s.looseNodes);
  whole("freed_bonds", s.looseBonds);
  setFieldNumbers(output, "seconds",
    std::array{ r.bondSeconds, r.firstSeconds, s.globalSeconds, s.localSeconds, s.searchSeconds, s.totalSeconds,
      r.stateSeconds, s.checkpointSeconds });
  whole("continued_at", r.continuedAt);
  whole("states_before", r.statesBefore);
  whole("checkpoints", s.checkpoints);
  whole("last_checkpoint", r.checkpointAt);
}

void setLatticeNumbers(vtkDataObject* output, const Lattice& lattice)
{
  setFieldNumbers(output, "spacing", std::array{ lattice.spacing, lattice.spacing, lattice.spacing });
  setFieldNumbers(output, "lattice_size",
    std::array{ static_cast<double>(lattice.size[0]), static_cast<double>(lattice.size[1]),
      static_cast<double>(lattice.size[2]) });
  setFieldNumbers(output, "lattice_origin", lattice.origin);
}

void setBrokenState(vtkImageData* output, const pd::BrokenState& state, const BondScene& scene, const char* creator)
{
  setFieldNumber(output, stateNumber, static_cast<double>(state.number));
  vtkPointData* const points = output->GetPointData();
  const auto add = [points](vtkDataArray* array) { points->AddArray(array); };
  // a void is not whole, as 0 would paint it: it has no bonds
  const auto damage = scene.toPiece(state.damage, std::array<int, 1>{ 0 }, "damage", unknown);
  describe(damage, "1", "share of the node's bonds that are broken; NaN in voids, which have none", creator);
  add(damage);
  points->SetActiveScalars("damage");
  const auto counts = scene.toPiece(state.bonds, std::array<int, 1>{ 0 }, "broken");
  const auto broken = newArray<vtkIntArray>("broken", 1, static_cast<std::size_t>(counts->GetNumberOfTuples()));
  for (vtkIdType i = 0; i < counts->GetNumberOfTuples(); ++i)
    broken->SetValue(i, static_cast<int>(counts->GetValue(i)));
  describe(broken, "1", "broken bonds of the node", creator);
  add(broken);
  if (state.displacement)
    addDisplacement(output, scene, *state.displacement, creator);
  if (state.stressOfNodes)
    add(stressArray(scene, *state.stressOfNodes, creator));
  if (state.energyDensity)
    addStrainEnergy(output, scene, *state.energyDensity, creator);
  setFieldNumber(output, "strain", state.strain);
  setFieldNumber(output, "stress", state.stress);
  setFieldNumber(output, "broken_bonds", static_cast<double>(state.broken));
  setPlatenLayers(output, state);
}

void setFractureState(vtkImageData* output, const pd::FractureState& state, const BondScene& scene, const char* creator)
{
  setBrokenState(output, state, scene, creator);
  setFieldNumber(output, "hinges", static_cast<double>(state.hinges));
  setFieldNumber(output, "state_iterations", static_cast<double>(state.iterations));
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), state.strain);
}

} // namespace lamella
