#include "FractureData.h"

#include "BondFields.h"
#include "FieldNumbers.h"
#include "WindowFields.h"
#include "vtkLatticeConversion.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <array>

namespace pd = lamella::peridynamics;

namespace lamella
{
const char* wordOf(pd::FractureEnd end)
{
  constexpr std::array<const char*, 9> words{ "running", "stress-fell", "severed", "nothing-breaks", "maximum-strain",
    "maximum-broken", "interrupted", "pores-open", "last-turn" };
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

Columns<pd::Bond> setBonds(
  vtkPolyData* output, std::span<const pd::Bond> bonds, const BondScene& scene, const char* creator)
{
  const pd::Stencil stencil(scene.lattice().dimension, scene.model().horizon);
  const auto points = newPoints(bonds.size());
  for (std::size_t i = 0; i < bonds.size(); ++i)
    points->SetPoint(static_cast<vtkIdType>(i), pd::middleOf(scene.lattice(), stencil, bonds[i]).data());
  setVertices(output, points);
  return { output->GetPointData(), bonds, creator };
}

void addEnds(const Columns<pd::Bond>& columns, std::span<const pd::BondEnds> ends, const BondScene& scene)
{
  const Lattice& lattice = scene.lattice();
  const pd::Stencil stencil(lattice.dimension, scene.model().horizon);
  const auto vector = newArray<vtkDoubleArray>("bond", 3, ends.size());
  const auto phases = newArray<vtkUnsignedCharArray>("phases", 2, ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i)
  {
    const auto id = static_cast<vtkIdType>(i);
    const auto& step = stencil.half()[static_cast<std::size_t>(columns.rows[i].offset)].step;
    vector->SetTuple3(id, lattice.spacing * step[0], lattice.spacing * step[1], lattice.spacing * step[2]);
    phases->SetTypedComponent(id, 0, ends[i].low);
    phases->SetTypedComponent(id, 1, ends[i].high);
  }
  describe(vector, "m", "from its first node to its second", columns.creator);
  describe(phases, "1", "phases of both ends, the lesser first", columns.creator);
  addArrays(columns.data, { vector, phases });
  columns.add<vtkUnsignedCharArray>("between_grains", "1", "1 where the ends lie in two different grains",
    [&](std::size_t i) { return ends[i].betweenGrains; });
}

void setBrokenBonds(vtkPolyData* output, const pd::FractureResult& result, const BondScene& scene, const char* creator)
{
  using Broken = pd::BrokenBond;
  const std::vector<Broken>& broken = result.record.broken;
  std::vector<pd::Bond> bonds;
  for (const Broken& b : broken)
    bonds.push_back(b.bond);
  const Columns<pd::Bond> rest = setBonds(output, bonds, scene, creator);
  const Columns columns{ rest.data, broken, creator };
  columns.add<vtkTypeInt64Array>("event", "1", "number of the event in which it broke, from 1", &Broken::event);
  columns.numbers("strain", "1", "strain that was imposed when it broke", &Broken::strain);
  columns.numbers("critical_strain", "1", "strain at which it was just critical: the path that follows every snap-back",
    &Broken::criticalStrain);
  columns.numbers("stress", "Pa", "stress at the imposed strain, just before it broke", &Broken::stress);
  addEnds(rest, result.ends, scene);
  output->GetPointData()->SetActiveScalars("event");
}

void setFractureCurve(vtkTable* output, const pd::FractureResult& result, const char* creator)
{
  using Point = pd::FractureCurvePoint;
  output->Initialize();
  const Columns columns{ output->GetRowData(), result.curve, creator };
  columns.numbers("strain", "1", "imposed strain, which never falls", &Point::strain);
  columns.numbers("stress", "Pa", "force on the platen over the section of the box, at that strain", &Point::stress);
  columns.add<vtkTypeInt64Array>("broken", "1", "bonds broken so far", &Point::broken);
  columns.numbers("critical_strain", "1", "strain at which the next bond is just critical: follows every snap-back",
    &Point::criticalStrain);
  columns.numbers("critical_stress", "Pa", "stress at that strain", &Point::criticalStress);
}

namespace
{

/// Of a load that turns round; what an image has of them from before goes where it does not.
void setBranches(vtkImageData* output, const pd::FractureRecord& record)
{
  const auto set = [&](const char* name, auto&& of)
  {
    std::vector<double> values;
    for (const pd::LoadBranch& b : record.branches)
      values.push_back(static_cast<double>(of(b)));
    output->GetFieldData()->RemoveArray(name);
    if (!values.empty())
      setFieldNumbers(output, name, values);
  };
  using B = pd::LoadBranch;
  set(
    "branch_from", [](const B& b) { return b.from; });
  set(
    "branch_to", [](const B& b) { return b.to; });
  set(
    "branch_stress", [](const B& b) { return b.stress; });
  set(
    "branch_modulus", [](const B& b) { return b.modulus; });
  set(
    "branch_work", [](const B& b) { return b.work; });
  set(
    "branch_released", [](const B& b) { return b.released; });
  set("branch_broken", [](const B& b) { return b.broken; });
  for (const char* const name : { "trough_stress", "trough_strain" })
    output->GetFieldData()->RemoveArray(name);
  if (record.branches.empty())
    return;
  setFieldNumber(output, "trough_stress", record.trough.stress);
  setFieldNumber(output, "trough_strain", record.trough.strain);
}

} // namespace

void setFractureNumbers(vtkImageData* output, const pd::FractureResult& r)
{
  const auto set = [output](const char* name, double value) { setFieldNumber(output, name, value); };
  const auto whole = [&](const char* name, std::int64_t value) { set(name, static_cast<double>(value)); };
  const pd::FractureStatistics& s = r.record.statistics;
  const bool some = !r.record.broken.empty();
  setPlatens(output, r);
  setWork(output, r);
  setPores(output, r);
  setBranches(output, r.record);
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

std::vector<statistics::ErrorPart> strengthErrorParts(vtkImageData* image)
{
  std::vector<statistics::ErrorPart> parts;
  for (const statistics::WindowError& window : windowFields(image))
    parts.push_back({ "window", window.relative() });
  const std::vector<double> error = fieldNumbers(image, "strength_segmentation_error");
  const std::vector<double> peak = fieldNumbers(image, "peak_stress");
  if (error.size() == 1 && peak.size() == 1)
    parts.push_back({ "segmentation", error[0] / peak[0] });
  return parts;
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
