#include "peridynamics/fracture/FractureStudy.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/fracture/CrackContact.h"
#include "peridynamics/fracture/EventHierarchy.h"
#include "peridynamics/fracture/FractureCheckpoint.h"
#include "peridynamics/fracture/LoosePieces.h"
#include "peridynamics/fracture/PlatenForce.h"
#include "peridynamics/fracture/WantedStates.h"
#include "peridynamics/multigrid/LevelSizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

/// Strains above this are none for which elongations are linear.
constexpr double small = 0.1;

FractureMethod methodOf(const FractureStudyOptions& o, const BondModel& model)
{
  const bool events = !o.fracture.contact && o.fracture.turningPoints.empty() && o.loading.load != LoadCase::Pressure &&
    model.periodic == std::array<bool, 3>{} && o.fracture.breaking == Breaking::Strict;
  return o.method.value_or(events ? FractureMethod::Events : FractureMethod::Accurate);
}

void check(const FractureStudyOptions& o)
{
  if (!o.fracture.turningPoints.empty() && !o.atStrains.empty())
    throw ParameterError("states at strains of a load that turns round, which passes them more than once",
      "ask for states at numbers of broken bonds");
  for (const double strain : o.atStrains)
    if (!(strain > 0 && std::isfinite(strain)))
      throw ParameterError(fmt::format("a state is asked for at the strain {}", strain),
        "strains count along the load: give a number above 0, such as 1e-3");
  for (const std::int64_t broken : o.atBroken)
    if (broken < 1)
      throw ParameterError(fmt::format("a state is asked for at {} broken bonds", broken), "give a number above 0");
  if (!o.displacement && (o.stress || o.energyDensity))
    throw ParameterError(fmt::format("the {} of nodes without their displacements", o.stress ? "stress" : "energy"),
      "ask for displacements too: the one follows from the others");
}

void requireBreakable(const BondLattice& bonds)
{
  const auto& kinds = bonds.kinds();
  if (std::none_of(kinds.begin() + 1, kinds.end(), [](const BondKind& k) { return std::isfinite(k.criticalStretch); }))
    throw ParameterError("nothing can break: no bond has a critical stretch, a toughness or a fracture energy",
      "give one of them for the pairs of phases that are to break");
}

/// Stress at a strain to which nothing more breaks.
double stressAt(const FractureRecord& record, double strain)
{
  if (!record.curve.empty() && record.curve.back().strain == strain)
    return record.curve.back().stress;
  const bool unbroken = record.curve.empty();
  return strain * (unbroken ? record.modulus : record.curve.back().stress / record.curve.back().strain);
}

int axisOf(const FractureStudyOptions& options, int dimension)
{
  return options.loading.axis < 0 ? dimension - 1 : options.loading.axis;
}

/// Makes the fields of states.
class StateFields
{
public:
  /// @param latest where the run stands, for the progress
  StateFields(const BondLattice& bonds, const FractureStudyOptions& options, const FractureProgress& latest)
    : bonds_(bonds)
    , options_(options)
    , latest_(latest)
    , damage_(bonds)
  {
  }

  void countFrom(std::int64_t number) { number_ = number; }

  void make(const QuasiStaticFracture& fracture, double strain, bool last, std::vector<std::string>& warnings)
  {
    const FractureRecord& record = fracture.record();
    FractureState s;
    s.strain = strain;
    s.stress = stressAt(record, strain);
    s.broken = static_cast<std::int64_t>(record.broken.size());
    s.last = last;
    s.number = number_++;
    s.axis = axisOf(options_, bonds_.dimension());
    s.lowPlaten = fracture.sample().lowLayers;
    s.highPlaten = fracture.sample().highLayers;
    for (; counted_ < record.broken.size(); ++counted_)
      damage_.add(record.broken[counted_].bond);
    s.bonds = damage_.counts();
    s.damage = damage_.damage();
    if (options_.displacement)
      solve(fracture, s, warnings);
    options_.keep(std::move(s));
  }

  /// Equilibria of states begin with that of the one before, in a run that goes on too.
  void put(io::Checkpoint& checkpoint) const
  {
    if (unit_)
      checkpoint.arrays[name] = gathered(bonds_, *unit_, "m", "displacement of the last state at the unit load");
  }
  void take(const io::Checkpoint& checkpoint)
  {
    if (checkpoint.arrays.contains(name))
      unit_ = scattered(bonds_, checkpoint, name);
  }

private:
  static constexpr const char* name = "state displacement";

  void solve(const QuasiStaticFracture& fracture, FractureState& s, std::vector<std::string>& warnings)
  {
    if (!unit_)
      unit_ = fracture.sample().displacement;
    else // of fixed nodes: the load may have turned round
      for (int c = 0; c < unit_->components(); ++c)
        for (std::int64_t i = 0; i < bonds_.layout().count(); ++i)
          if ((fracture.sample().fixed[i] >> c & 1U) != 0)
            unit_->component(c)[i] = fracture.sample().displacement.component(c)[i];
    EquilibriumOptions o;
    o.tolerance = options_.fracture.tolerance;
    if (options_.fracture.progress)
      o.progress = [&](double) { return options_.fracture.progress(latest_); };
    Equilibrium equilibrium(bonds_, fracture.sample().fixed, o);
    try
    {
      const LoadedSample& sample = fracture.sample();
      const EquilibriumResult r = equilibrium.solve(*unit_, sample.load ? &*sample.load : nullptr);
      if (!sample.held)
        takeOutRigidMotion(bonds_, *sample.pores, *unit_);
      s.hinges = r.hinges;
      s.iterations = r.iterations;
    }
    catch (const DivergenceError& e)
    {
      warnings.push_back(
        fmt::format("the displacements after {} broken bonds are not at rest: {}", s.broken, e.what()));
    }
    s.displacement = *unit_;
    const double pressure = fracture.sample().pressure;
    const double scale = pressure != 0 ? s.stress / std::abs(pressure) : std::abs(s.strain / options_.loading.strain);
    for (int c = 0; c < s.displacement->components(); ++c)
      for (std::int64_t i = 0; i < bonds_.layout().count(); ++i)
        s.displacement->component(c)[i] *= scale;
    measure(s, bonds_, options_.stress, options_.energyDensity, false);
  }

  const BondLattice& bonds_;
  const FractureStudyOptions& options_;
  const FractureProgress& latest_;
  NodeDamage damage_;
  std::size_t counted_ = 0;               ///< of the record
  std::int64_t number_ = 0;               ///< of the next state
  std::optional<NodeField<double>> unit_; ///< displacements at unit load of the last state
};

/// Runs to the end and stops at the states on the way. @return strain at the end
double runThrough(QuasiStaticFracture& fracture, const FractureStudyOptions& o, StateFields* fields, FractureResult& r)
{
  Wanted<double> strains(o.atStrains, o.fracture.maxStrain);
  Wanted<std::int64_t> numbers(o.atBroken, o.fracture.maxBroken);
  if (r.continuedAt > 0)
    r.statesBefore = strains.skipBelow(fracture.strain()) +
      numbers.skipBelow(static_cast<std::int64_t>(fracture.record().broken.size()));
  if (fields != nullptr)
    fields->countFrom(r.statesBefore);
  for (;;)
  {
    fracture.setLimits(strains.next(), numbers.next());
    const FractureEnd end = fracture.run();
    if (end == FractureEnd::Interrupted)
      throw Cancelled();
    const bool atStrain = end == FractureEnd::MaxStrain && strains.some();
    const bool atNumber = end == FractureEnd::MaxBroken && numbers.some();
    const double strain =
      end == FractureEnd::MaxStrain ? std::max(strains.next(), fracture.strain()) : fracture.strain();
    const double start = lamella::seconds();
    if (fields != nullptr)
      fields->make(fracture, strain, !atStrain && !atNumber, r.warnings);
    r.stateSeconds += lamella::seconds() - start;
    numbers.passed(static_cast<std::int64_t>(fracture.record().broken.size()));
    if (atStrain)
      strains.passed(strain);
    if (atStrain || atNumber)
      continue;
    if (end == FractureEnd::MaxStrain)
      strains.passed(strain);
    r.missedStrains = strains.left();
    r.missedNumbers = numbers.left();
    return strain;
  }
}

/// What a run that went on from a checkpoint did not do.
void warnContinued(std::vector<std::string>& warnings, const FractureResult& r)
{
  if (r.continuedAt == 0)
    return;
  if (r.statesBefore > 0)
    warnings.push_back(fmt::format(
      "{} of the states asked for lie before the checkpoint, which stands after {} events: they are not made",
      r.statesBefore, r.continuedAt));
  if (r.record.statistics.events == r.continuedAt)
    warnings.push_back(fmt::format(
      "the run had ended where the checkpoint stands, after {} events: nothing broke since", r.continuedAt));
}

/// @param tolerance to which equilibria are found on the way
void warn(const BondModel& model, double tolerance, FractureResult& r)
{
  std::vector<std::string> warnings = modelWarnings(model, r.thickness);
  if (r.loosePieces > 0)
    warnings.push_back(looseWarning(r.loosePieces, r.looseNodes, r.solidNodes));
  if (r.openNodes > 0)
    warnings.push_back(openWarning(r.openNodes));
  if (const std::string text = doubtWarning(r.record.imbalance); !text.empty())
    warnings.push_back(text);
  // Of 77 plates with single nodes gone none was further off than 5 times tolerance/carried.
  const double left = 5 * tolerance / r.record.carried; // no number, or infinite, in a run that goes on
  constexpr double noted = 5e-3;
  if (left > noted && std::isfinite(left))
    warnings.push_back(fmt::format(
      "the sample carries {:.1e} of the force under even strain: at a tolerance of {:g}, which counts over that, "
      "stresses and strengths may be off by {:.2g} %. Ask for a smaller tolerance, with method accurate",
      r.record.carried, tolerance, 100 * left));
  if (!r.record.broken.empty() && r.peak.strain > small)
    warnings.push_back(
      fmt::format("the peak lies at a strain of {:.2g}: that is not small, and the answer with it is of "
                  "no great worth",
        r.peak.strain));
  if (const std::size_t missed = r.missedStrains.size() + r.missedNumbers.size(); missed > 0)
    warnings.push_back(
      fmt::format("{} of the states asked for lie beyond the end of the run: {}", missed, describe(r.record.end)));
  warnContinued(warnings, r);
  r.warnings.insert(r.warnings.begin(), warnings.begin(), warnings.end());
}

} // namespace

double fractureBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const FractureStudyOptions& options, int ranks)
{
  if (ranks > 1 && methodOf(options, model) == FractureMethod::Events) // the whole beside the part
    return fractureBytes(model, lattice, grains, options, 1) + BondLattice::bytesNeeded(model, lattice, ranks, grains);
  ElasticOptions elastic;
  elastic.loading = options.loading;
  elastic.stress = options.stress;
  elastic.energyDensity = options.energyDensity;
  const Stencil stencil(lattice.dimension, model.horizon);
  const NodeLayout layout =
    NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks, model.periodic[0]);
  const auto nodes = static_cast<double>(layout.count());
  const std::vector<NodeLayout> levels = levelLayouts(layout, ranks > 1);
  const bool rim = ranks > 1 || std::any_of(model.periodic.begin(), model.periodic.end(), [](bool p) { return p; });
  double onLevels = 0; // nodes of all of them
  for (const NodeLayout& level : levels)
    onLevels += static_cast<double>(level.count());
  const double d = lattice.dimension;
  // displacements in a checkpoint: gathered, as HDF5 has them, as a file
  const bool file = !options.fracture.checkpoint.path.empty() || !options.fracture.continueFrom.empty();
  const double checkpoint = file ? 3 * 8 * d * static_cast<double>(lattice.count()) : 0;
  // states have an equilibrium of their own, beside what goes on; four more fields of floats on all levels, which on
  // the finest may be three and a slow motion that is being looked at; tiles; displacements at unit load and those of
  // the state, its counts
  const double states = options.keep && options.displacement ? multigridBytes(levels, rim).held + 3 * 8 * d * nodes : 0;
  // the state before, and the way from it
  const double contact = options.fracture.contact ? 2 * 8 * d * nodes : 0;
  const double packed = methodOf(options, model) == FractureMethod::Events ? multigridBytes(levels, rim).held -
      multigridBytes(levels, rim, EventHierarchy::multigridOptions(lattice.dimension)).held
                                                                           : 0;
  return elasticBytes(model, lattice, grains, elastic, ranks) - packed + checkpoint + states + contact +
    4 * 4 * d * onLevels + nodes * (8 + (options.displacement ? 16 * d : 0) + 8 * 3);
}

FractureResult studyFracture(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const FractureStudyOptions& options, const Communicator& comm)
{
  check(options);
  const ThreadScope threads(options.threads);
  const double need = fractureBytes(model, lattice, !grain.empty(), options, comm.size());
  if (comm.parallel() && methodOf(options, model) == FractureMethod::Events) // ranks of a machine do not share it out
  {
    const double free = static_cast<double>(availableMemory()) / comm.sizeOnMachine();
    requireMemory("fracture by events, of which every rank has the whole sample,", lattice, need,
      options.memory > 0 ? options.memory : free, comm,
      "take the accurate method, fewer ranks a machine or a smaller sample");
  }
  else
    requireMemory("fracture", lattice, need, options.memory, comm);
  FractureResult r;
  double start = lamella::seconds();
  const auto lap = [&start]
  {
    const double before = start;
    start = lamella::seconds();
    return start - before;
  };
  BondLattice bonds(model, lattice, phase, grain, comm);
  requireBreakable(bonds);
  static_cast<SampleCounts&>(r) = countSample(bonds, model, phase);
  FractureProgress latest;
  std::optional<StateFields> fields;
  if (options.keep)
    fields.emplace(bonds, options, latest);
  r.bondSeconds = lap();

  FractureOptions fractureOptions = options.fracture;
  fractureOptions.cracks.clear();
  if (options.fracture.contact)
    fractureOptions.cracks = notchedBonds(bonds, model, lattice, phase, grain);
  fractureOptions.method = r.method = methodOf(options, model);
  if (options.fracture.progress)
    fractureOptions.progress = [&](const FractureProgress& p)
    {
      latest = p; // a limit of the whole run may be nearer than the end of the sample
      latest.share = std::min(1.0,
        std::max({ p.share, p.strain / options.fracture.maxStrain,
          static_cast<double>(p.broken) / static_cast<double>(options.fracture.maxBroken) }));
      return options.fracture.progress(latest);
    };
  std::vector<std::string> unwritten; // what stood in the way of checkpoints
  fractureOptions.checkpoint.warn = [&](const std::string& why)
  {
    unwritten.push_back(why);
    if (options.fracture.checkpoint.warn)
      options.fracture.checkpoint.warn(why);
  };
  if (fields)
  {
    fractureOptions.keepWith = [&](io::Checkpoint& c) { fields->put(c); };
    fractureOptions.takeBack = [&](const io::Checkpoint& c) { fields->take(c); };
  }
  QuasiStaticFracture fracture(bonds, options.loading, fractureOptions, phase);
  latest.equilibrium = 1;
  r.continuedAt = fracture.record().statistics.events;
  const LoadedSample& sample = fracture.sample();
  r.axis = axisOf(options, lattice.dimension);
  r.area = PlatenForce(bonds, options.loading, sample).area();
  r.lowPlaten = sample.lowLayers;
  r.highPlaten = sample.highLayers;
  r.length =
    sample.pores ? lattice.length(r.axis) : static_cast<double>(r.highPlaten[0] - r.lowPlaten[1] + 1) * lattice.spacing;
  if (sample.pores)
  {
    r.poreVolume = sample.pores->volume();
    r.openNodes = sample.pores->openNodes();
  }
  r.loosePieces = sample.loosePieces;
  r.looseNodes = sample.looseNodes;
  r.firstSeconds = lap();

  const double strain = runThrough(fracture, options, fields ? &*fields : nullptr, r);
  r.record = fracture.record();
  r.checkpointAt = fracture.checkpointAt();
  if (!unwritten.empty())
    r.warnings.push_back(
      fmt::format("{} of the checkpoints could not be written: {}", unwritten.size(), unwritten.front()));
  r.curve = fractureCurve(r.record);
  r.peak = r.record.peak;
  if (strain > r.curve.back().strain) // nothing more broke up to there
  {
    const CurvePoint end{ strain, stressAt(r.record, strain), static_cast<std::int64_t>(r.record.broken.size()) };
    r.curve.push_back({ end.strain, end.stress, end.broken, end.strain, end.stress });
    if (end.stress > r.peak.stress)
      r.peak = end;
  }
  r.ends = endsOf(bonds, r.record.broken, phase, grain);
  r.brokenEnergy = brokenEnergy(bonds, model, r.record.broken, r.ends);
  r.bytes = comm.sum(bonds.bytes() + r.record.statistics.bytes);
  const double tolerance = options.fracture.tolerance;
  warn(model,
    r.method == FractureMethod::Events ? options.fracture.events.beforeRise(bonds.dimension(), r.record.carried)
                                       : tolerance,
    r);
  return r;
}

std::vector<KnownBond> notchedBonds(const BondLattice& bonds, const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain)
{
  if (model.notches.empty())
    return {};
  BondModel sound = model;
  sound.notches.clear();
  const BondLattice all(sound, lattice, phase, grain, bonds.communicator());
  const NodeLayout& l = bonds.layout();
  std::vector<std::int64_t> mine;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      all.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t, int o, int kind)
        {
          if (!l.ownedNode(l.node(i)) || bonds.kind(i, o) != 0)
            return;
          const Bond b = bonds.bond(i, o);
          mine.insert(mine.end(), { b.node[0], b.node[1], b.node[2], b.offset, kind });
        });
  const std::vector<std::int64_t> list = gather(bonds.communicator(), mine, 5);
  std::vector<KnownBond> cut;
  for (std::size_t k = 0; k < list.size(); k += 5)
    cut.push_back(
      { { { list[k], list[k + 1], list[k + 2] }, static_cast<int>(list[k + 3]) }, static_cast<int>(list[k + 4]) });
  std::sort(cut.begin(), cut.end(), [](const KnownBond& a, const KnownBond& b) { return a.bond < b.bond; });
  return cut;
}

BondLattice remainingBonds(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, std::span<const Bond> broken, const Loading* held,
  const std::function<void(NodeField<double>&)>& contact, const Communicator& comm)
{
  BondLattice bonds(model, lattice, phase, grain, comm);
  if (contact)
  {
    NodeField<double> u(bonds.layout());
    contact(u);
    bonds.exchange(u);
    CrackContact cracks(bonds);
    cracks.watch(notchedBonds(bonds, model, lattice, phase, grain));
    cracks.watch(broken);
    bonds.breakBonds(comm.rank() == 0 ? broken : std::span<const Bond>());
    cracks.follow(u);
    return bonds;
  }
  std::optional<LoadedSample> sample;
  if (held != nullptr)
    sample = applyLoading(bonds, *held, phase);
  bonds.breakBonds(comm.rank() == 0 ? broken : std::span<const Bond>());
  if (sample && sample->pores)
    bonds.breakBonds(looseUnderPressure(bonds, *sample).bonds);
  else if (sample)
  {
    const AlignedArray<std::uint8_t> marks = PlatenForce(bonds, *held, *sample).marks(bonds, *sample);
    bonds.breakBonds(bondsOfLoosePieces(bonds, findFragments(bonds, &marks)));
  }
  return bonds;
}

} // namespace lamella::peridynamics
