// What a quasi-static fracture keeps on disk, and how it goes on from it.
#include "core/Clock.h"
#include "core/Error.h"
#include "peridynamics/fracture/Fracture.h"
#include "peridynamics/fracture/FractureEngine.h"
#include "peridynamics/fracture/LoosePieces.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

constexpr const char* kind = "quasi-static fracture";

/// Calls f(name, value) for every number of a record that is not in a list.
template <class Record, class F>
void eachNumber(Record& r, F&& f)
{
  f("modulus", r.modulus);
  f("peak strain", r.peak.strain);
  f("peak stress", r.peak.stress);
  f("peak broken", r.peak.broken);
  f("first strain", r.first.strain);
  f("first stress", r.first.stress);
  auto& t = r.statistics;
  f("events", t.events);
  f("raises", t.raises);
  f("equilibria", t.equilibria);
  f("global iterations", t.globalIterations);
  f("local cycles", t.localCycles);
  f("nodes visited", t.nodesVisited);
  f("searches", t.searches);
  f("loose pieces", t.loosePieces);
  f("loose nodes", t.looseNodes);
  f("loose bonds", t.looseBonds);
  f("global seconds", t.globalSeconds);
  f("local seconds", t.localSeconds);
  f("search seconds", t.searchSeconds);
  f("total seconds", t.totalSeconds);
  f("checkpoints", t.checkpoints);
  f("checkpoint seconds", t.checkpointSeconds);
}

template <class List, class F>
io::CheckpointArray listOf(const List& list, const char* unit, const char* description, F&& value)
{
  std::vector<decltype(value(list.front()))> values;
  for (const auto& one : list)
    values.push_back(value(one));
  return { { static_cast<std::int64_t>(list.size()) }, std::move(values), unit, description };
}

/// Calls f(name, unit, description, of) for what branches have; of(branch) is a reference to it.
template <class F>
void eachColumn(F&& f)
{
  f(
    "branch_from", "", "strain at its beginning", [](auto& b) -> auto& { return b.from; });
  f(
    "branch_to", "", "strain at its end; the last is not done", [](auto& b) -> auto& { return b.to; });
  f(
    "branch_stress", "Pa", "at its end", [](auto& b) -> auto& { return b.stress; });
  f(
    "branch_modulus", "Pa", "at its end", [](auto& b) -> auto& { return b.modulus; });
  f(
    "branch_work", "J/m^3", "of the platens", [](auto& b) -> auto& { return b.work; });
  f(
    "branch_released", "J/m^3", "went with the breaks", [](auto& b) -> auto& { return b.released; });
  f(
    "branch_broken", "", "bonds on the way", [](auto& b) -> auto& { return b.broken; });
}

} // namespace

std::string sceneOf(const Loading& l, const FractureOptions& o)
{
  const char* cases[] = { "stretch", "shear", "biaxial", "traction", "pressure" };
  std::string text;
  const auto line = [&](const char* name, const auto& value) { text += fmt::format("{}: {}\n", name, value); };
  line("load", cases[static_cast<int>(l.load)]);
  line("axis of the load", l.axis);
  line("unit strain", l.strain);
  line("lateral strain", l.lateralStrain);
  line("platens", l.smooth ? "smooth" : "rough");
  line("rigid platens", l.rigid ? "yes" : "no");
  line("layers of a platen", l.layers);
  line("method", o.method == FractureMethod::Events ? "events" : "accurate");
  line("breaking", o.breaking == Breaking::Strict ? "strict" : "batched");
  line("strain step", o.strainStep);
  line("tolerance", o.tolerance);
  line("events between renewals", o.renewEvery);
  if (!o.turningPoints.empty())
    line("load in time", "turns round");
  if (o.contact)
    line("contact of cracks, of which there were first", o.cracks.size());
  if (o.method != FractureMethod::Events)
    return text;
  const EventOptions& e = o.events;
  line("radius of local corrections", e.radius);
  line("radius on coarse levels", e.coarseRadius);
  line("reduction by local corrections", e.reduction);
  line("most cycles around a bond", e.maxCycles);
  line("events between global corrections", e.globalEvery);
  line("iterations of a global correction", e.globalIterations);
  line("tolerance of a global correction", e.globalTolerance);
  line("rivals within", e.rivals);
  line("tolerance among rivals", e.rivalTolerance);
  line("tolerance before a rise", e.riseTolerance);
  line("tolerance before a rise below the peak", e.softeningTolerance);
  return text;
}

std::string sceneOf(const BondLattice& bonds, const LoadedSample& sample)
{
  if (!sample.pores)
    return "";
  const NodeLayout& l = bonds.layout();
  const std::string hash = hashOfRows(bonds,
    [&](std::int64_t y, std::int64_t z)
    {
      std::string row;
      for (int c = 0; c < l.dimension; ++c)
        row.append(reinterpret_cast<const char*>(sample.load->component(c) + l.index(0, y, z)),
          static_cast<std::size_t>(l.size[0]) * sizeof(double));
      return row;
    });
  return fmt::format("sides: {}\nforces of the pressure: {}\n", sample.held ? "straight" : "free", hash);
}

void QuasiStaticFracture::saveBranches(io::Checkpoint& c) const
{
  c.numbers["direction"] = direction_;
  c.numbers["trough strain"] = record_.trough.strain;
  c.numbers["trough stress"] = record_.trough.stress;
  c.numbers["trough broken"] = static_cast<double>(record_.trough.broken);
  std::vector<LoadBranch> all = record_.branches;
  all.push_back(branch_);
  eachColumn(
    [&](const char* name, const char* unit, const char* description, auto&& of)
    {
      const auto value = [&](const LoadBranch& b) { return of(b); };
      c.arrays[name] = listOf(all, unit, description, value);
    });
}

void QuasiStaticFracture::restoreBranches(const io::Checkpoint& c)
{
  direction_ = c.number("direction") < 0 ? -1 : 1;
  record_.trough = { c.number("trough strain"), c.number("trough stress"), c.count("trough broken") };
  std::vector<LoadBranch> all(c.reals("branch_from").size());
  if (all.empty())
    throw InputError("the checkpoint's branches are none", "start the run anew");
  eachColumn(
    [&](const char* name, const char*, const char*, auto&& of)
    {
      const auto take = [&](const auto& values)
      {
        if (values.size() != all.size())
          throw InputError("the checkpoint's branches are not as many everywhere", "start the run anew");
        for (std::size_t k = 0; k < all.size(); ++k)
          of(all[k]) = values[k];
      };
      if constexpr (std::is_integral_v<std::decay_t<decltype(of(all.front()))>>)
        take(c.integers(name));
      else
        take(c.reals(name));
    });
  branch_ = all.back();
  all.pop_back();
  turns_ = all.size();
  constexpr double roundOff = 1e-12;
  for (std::size_t k = 0; k < turns_; ++k)
    if (k >= options_.turningPoints.size() || std::abs(options_.turningPoints[k] - all[k].to) > roundOff)
      throw InputError(fmt::format("turning point {} was {:g} in the run that the checkpoint is of", k + 1, all[k].to),
        "go on with the same turning points; later ones may differ");
  record_.branches = std::move(all);
}

void QuasiStaticFracture::save()
{
  const double start = seconds();
  savedAt_ = record_.statistics.events;
  EngineState state = engine_->state();
  io::Checkpoint c;
  c.kind = kind;
  c.scene = scene_;
  c.provenance = options_.checkpoint.provenance;
  c.arrays["displacement"] = gathered(lattice(), state.displacement, "m", "displacement at the unit load");
  FractureRecord now;
  now.peak = record_.peak;
  now.first = record_.first;
  now.modulus = record_.modulus;
  now.statistics = statistics();
  ++now.statistics.checkpoints;
  eachNumber(now, [&](const char* name, const auto& value) { c.numbers[name] = static_cast<double>(value); });
  for (const auto& [name, value] : state.numbers)
    c.numbers["state: " + name] = value;
  c.numbers["load"] = load_;
  c.numbers["share"] = share_;
  if (!options_.turningPoints.empty())
    saveBranches(c);
  c.numbers["first ratio"] = firstRatio_;
  c.numbers["bonds left"] = static_cast<double>(bonds_.bonds());
  const auto& broken = record_.broken;
  std::vector<Bond> list;
  for (const BrokenBond& b : broken)
    list.push_back(b.bond);
  c.arrays["broken"] = arrayOf(list);
  if (contact_)
    c.arrays["closed"] = arrayOf(contact_->closed());
  const auto add = [&](const char* name, const auto& from, const char* unit, const char* description, auto&& value)
  { c.arrays[name] = listOf(from, unit, description, value); };
  using B = BrokenBond;
  add(
    "event", broken, "", "in which the bond broke, from 1", [](const B& b) { return b.event; });
  add(
    "strain", broken, "", "imposed when it broke", [](const B& b) { return b.strain; });
  add(
    "critical_strain", broken, "", "at which it was critical", [](const B& b) { return b.criticalStrain; });
  add("stress", broken, "Pa", "before it broke", [](const B& b) { return b.stress; });
  using P = CurvePoint;
  const auto& curve = record_.curve;
  add(
    "curve_strain", curve, "", "strain-controlled curve", [](const P& p) { return p.strain; });
  add(
    "curve_stress", curve, "Pa", "strain-controlled curve", [](const P& p) { return p.stress; });
  add("curve_broken", curve, "", "bonds broken so far", [](const P& p) { return p.broken; });
  if (options_.keepWith)
    options_.keepWith(c);
  pace_.written();
  if (write(std::move(c), options_.checkpoint, bonds_.communicator()))
  {
    ++record_.statistics.checkpoints;
    writtenAt_ = savedAt_;
  }
  record_.statistics.checkpointSeconds += seconds() - start;
}

EngineState QuasiStaticFracture::restore(const PlatenForce& platens)
{
  const Communicator& comm = bonds_.communicator();
  const io::Checkpoint c = io::readCheckpoint(options_.continueFrom, kind, scene_, comm);
  EngineState state{ scattered(lattice(), c, "displacement"), {}, {} };
  const std::vector<Bond> list = bondsIn(c, "broken", bonds_);
  const auto& event = c.integers("event");
  const auto& strain = c.reals("strain");
  const auto& critical = c.reals("critical_strain");
  const auto& stress = c.reals("stress");
  const auto& curveStrain = c.reals("curve_strain");
  const auto& curveStress = c.reals("curve_stress");
  const auto& curveBroken = c.integers("curve_broken");
  if (event.size() != list.size() || strain.size() != list.size() || critical.size() != list.size() ||
    stress.size() != list.size() || curveStress.size() != curveStrain.size() ||
    curveBroken.size() != curveStrain.size())
    throw InputError("the checkpoint's broken bonds or its curve are not as many everywhere", "start the run anew");
  for (const char* const name : { "displacement", "load", "share" })
    c.expectFinite(name);
  for (std::size_t k = 0; k < list.size(); ++k)
    record_.broken.push_back({ list[k], event.at(k), strain.at(k), critical.at(k), stress.at(k) });
  for (std::size_t k = 0; k < curveStrain.size(); ++k)
    record_.curve.push_back({ curveStrain[k], curveStress.at(k), curveBroken.at(k) });
  eachNumber(record_,
    [&](const char* name, auto& value)
    {
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_integral_v<Value>)
        value = static_cast<Value>(c.count(name));
      else
        value = c.number(name);
    });
  load_ = c.number("load");
  share_ = c.number("share");
  if (!options_.turningPoints.empty())
    restoreBranches(c);
  firstRatio_ = c.number("first ratio");
  savedAt_ = record_.statistics.events;
  state.statistics = record_.statistics;
  const std::string prefix = "state: ";
  for (const auto& [name, value] : c.numbers)
    if (name.starts_with(prefix))
      state.numbers[name.substr(prefix.size())] = value;

  if (options_.takeBack)
    options_.takeBack(c);
  if (contact_)
    contact_->watch(list);
  bonds_.breakBonds(comm.rank() == 0 ? std::span<const Bond>(list) : std::span<const Bond>());
  // what has come loose since follows from what has broken
  const auto takeOutLoosePieces = [&platens](BondLattice& bonds, const LoadedSample& sample)
  {
    const AlignedArray<std::uint8_t> marks = platens.marks(bonds, sample);
    bonds.breakBonds(bondsOfLoosePieces(bonds, findFragments(bonds, &marks)));
  };
  if (contact_)
    contact_->close(bondsIn(c, "closed", bonds_));
  else if (sample_.pores)
    bonds_.breakBonds(looseUnderPressure(bonds_, sample_).bonds);
  else
    takeOutLoosePieces(bonds_, sample_);
  if (whole_)
  {
    whole_->bonds.breakBonds(list);
    takeOutLoosePieces(whole_->bonds, whole_->sample);
  }
  if (static_cast<double>(bonds_.bonds()) != c.number("bonds left"))
    throw InputError(
      fmt::format("{} bonds are left of the sample, {} in the checkpoint", bonds_.bonds(), c.number("bonds left")),
      "start the run anew, and report it");
  return state;
}

} // namespace lamella::peridynamics
