#include "peridynamics/fracture/AccurateEngine.h"

#include "core/Clock.h"
#include "core/Error.h"

#include "peridynamics/Fragments.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/fracture/LoosePieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::peridynamics
{
AccurateEngine::AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens,
  CrackContact* contact, double unitStrain, double tolerance, std::function<bool(double)> progress)
  : bonds_(bonds)
  , sample_(sample)
  , platens_(platens)
  , contact_(contact)
  , unitStrain_(unitStrain)
  , tolerance_(tolerance)
  , graph_(bonds)
  , u_(sample.displacement)
{
  if (contact_ != nullptr)
  {
    contact_->follow(u_);
    measure();
    evenForce_ = force_;
  }
  first_.progress = std::move(progress);
  first_.doubt = [this](const NodeField<double>& u, const NodeField<double>& force)
  { return sample_.pores ? workOfResidual(bonds_, sample_, u, force) : platens_.imbalance(bonds_, force); };
  solve();
  first_ = {}; // the progress of those that follow is the events'
  if (equilibrium_)
  {
    equilibrium_->setProgress({});
    equilibrium_->setDoubt({});
  }
}

AccurateEngine::AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens,
  CrackContact* contact, double unitStrain, double tolerance, const EngineState& resumed)
  : bonds_(bonds)
  , sample_(sample)
  , platens_(platens)
  , contact_(contact)
  , unitStrain_(unitStrain)
  , tolerance_(tolerance)
  , graph_(bonds)
  , u_(resumed.displacement)
{
  bonds.exchange(u_);
  force_ = resumed.numbers.at("force");
  if (sample.pores)
    scale_ = resumed.numbers.at("scale");
  if (contact != nullptr)
  {
    largestForce_ = resumed.numbers.at("largest force");
    evenForce_ = resumed.numbers.at("even force");
  }
  statistics_ = resumed.statistics;
  loose_ = statistics_.looseNodes;
}

AccurateEngine::~AccurateEngine() = default;

EngineState AccurateEngine::state() const
{
  EngineState state{ u_, { { "force", force_ } }, statistics_ };
  if (sample_.pores)
    state.numbers["scale"] = scale_;
  if (contact_ != nullptr)
  {
    state.numbers["largest force"] = largestForce_;
    state.numbers["even force"] = evenForce_;
  }
  return state;
}

void AccurateEngine::prepare()
{
  EquilibriumOptions o = first_;
  o.tolerance = tolerance_;
  equilibrium_ = std::make_unique<Equilibrium>(bonds_, sample_.fixed, o);
  fresh_ = true;
}

// The preconditioner remains one, if a worse one, when bonds break; a new one costs as much as a few iterations.
void AccurateEngine::solve()
{
  const double start = seconds();
  try
  {
    if (contact_ != nullptr)
      solveContact();
    else
      solveOnce();
  }
  catch (const DivergenceError&)
  {
    // what a pressure moves without end is a mechanism: the last bonds of a wall are a hinge
    constexpr double endless = 1e3;
    if (!sample_.pores || force_ == 0 || std::abs(poreStrain(bonds_, sample_, u_)) < endless * unitStrain_ / scale_)
      throw;
    holds_ = false;
    statistics_.globalSeconds += seconds() - start;
    return;
  }
  measure();
  if (contact_ != nullptr)
  {
    // Pieces that only touch bear what the residual leaves, which counts over the force under even strain.
    constexpr double surely = 1e-3; // of the largest force: what bears as much need not be searched
    holds_ = force_ > tolerance_ * evenForce_ && ((largestForce_ > 0 && force_ > surely * largestForce_) || reaches());
    largestForce_ = std::max(largestForce_, force_);
  }
  statistics_.globalSeconds += seconds() - start;
}

void AccurateEngine::solveOnce()
{
  if (!equilibrium_)
    prepare();
  const bool fresh = fresh_;
  const EquilibriumResult r = equilibrium_->solve(u_, sample_.load ? &*sample_.load : nullptr);
  statistics_.bytes = r.bytes + (contact_ != nullptr ? contact_->bytes() : 0);
  if (fresh)
    usual_ = r.iterations;
  else if (r.iterations > usual_ + 5)
    equilibrium_.reset();
  fresh_ = false;
  ++statistics_.equilibria;
  statistics_.globalIterations += r.iterations;
}

void AccurateEngine::solveContact()
{
  constexpr int most = 200;
  constexpr int mostSlow = 10;
  int slow = 0;
  for (int step = 0; step < most; ++step)
  {
    const NodeField<double> from = u_;
    std::optional<DivergenceError> hindered;
    try
    {
      solveOnce();
    }
    catch (const DivergenceError& e)
    {
      // What conjugate gradients came to is a way down, too, and where bonds close there more may be held.
      if (++slow > mostSlow)
        throw;
      hindered = e;
      equilibrium_.reset();
    }
    if (!hindered && contact_->violation(u_) <= tolerance_ * unitStrain_) // strains are not known any better
      return;
    const double gain = contact_->lower(from, u_);
    if (contact_->follow(u_) == 0 && hindered)
      throw *hindered;
    // so bonds that bear nothing do not go on to open and close in turn
    if (gain <= tolerance_ * tolerance_ * 2 * elasticEnergy(bonds_, u_, false))
      return;
  }
  throw DivergenceError(fmt::format("which broken bonds are pressed still changes after {} equilibria", most),
    "a tighter tolerance; or leave contact out");
}

bool AccurateEngine::reaches() const
{
  const AlignedArray<std::uint8_t> marks = platens_.marks(bonds_, sample_);
  return std::ranges::any_of(
    findFragments(bonds_, &marks).pieces, [](const Fragment& f) { return (f.fixed & 3U) == 3; });
}

void AccurateEngine::measure()
{
  if (!sample_.pores)
  {
    NodeField<double> f(bonds_.layout());
    linearForce(bonds_, u_, f);
    force_ = platens_.of(bonds_, f);
    return;
  }
  if (!sample_.held)
    takeOutRigidMotion(bonds_, *sample_.pores, u_);
  scale_ = unitStrain_ / std::abs(poreStrain(bonds_, sample_, u_));
  force_ = scale_ * std::abs(sample_.pressure);
}

NodeField<double> AccurateEngine::displacement()
{
  NodeField<double> u = u_;
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      u.component(c)[i] *= scale_;
  return u;
}

StretchMaximum AccurateEngine::mostCritical()
{
  const double start = seconds();
  StretchMaximum most = largestStretch(bonds_, u_, false);
  most.ratio *= scale_;
  if (contact_ != nullptr && most.bond && contact_->watched(*most.bond))
    most = {}; // all that is whole is stretched less than a closed bond, which is known to be pressed
  statistics_.searchSeconds += seconds() - start;
  return most;
}

std::vector<Bond> AccurateEngine::critical(double ratio)
{
  const NodeLayout& l = bonds_.layout();
  std::vector<std::int64_t> mine;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      bonds_.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t j, int o, int kind)
        {
          if (!l.ownedNode(l.node(i)))
            return;
          const Offset& half = bonds_.stencil().half()[static_cast<std::size_t>(o)];
          double along = 0;
          for (int c = 0; c < l.dimension; ++c)
            along += half.step[static_cast<std::size_t>(c)] * (u_.component(c)[j] - u_.component(c)[i]);
          const double s = along / (half.length * half.length * bonds_.spacing());
          if (scale_ * s < ratio * bonds_.kinds()[static_cast<std::size_t>(kind)].criticalStretch)
            return;
          const Bond b = bonds_.bond(i, o);
          mine.insert(mine.end(), { b.node[0], b.node[1], b.node[2], b.offset });
        });
  const std::vector<std::int64_t> all = gather(bonds_.communicator(), mine, 4);
  std::vector<Bond> found;
  for (std::size_t k = 0; k < all.size(); k += 4)
    found.push_back({ { all[k], all[k + 1], all[k + 2] }, static_cast<int>(all[k + 3]) });
  std::sort(found.begin(), found.end());
  return found;
}

bool AccurateEngine::joined(std::span<const Bond> bonds) const
{
  const NodeLayout& l = bonds_.layout();
  bool apart = false;
  for (const Bond& b : bonds)
  {
    std::array<std::int64_t, 3> n = b.node;
    for (std::size_t a = 0; a < 3; ++a)
      n[a] -= l.start[a];
    if (l.ownedNode(n))
      apart = apart ||
        !graph_.shareNeighbour(
          l.index(n[0], n[1], n[2]), bonds_.stencil().half()[static_cast<std::size_t>(b.offset)].step);
  }
  return !bonds_.communicator().any(apart);
}

void AccurateEngine::breakBonds(std::span<const Bond> bonds)
{
  if (contact_ != nullptr)
    contact_->watch(bonds);
  // every rank names all of them, and they count once
  bonds_.breakBonds(bonds_.communicator().rank() == 0 ? bonds : std::span<const Bond>());
  const double start = seconds();
  if (contact_ == nullptr && !joined(bonds)) // what is loose may be held by what is pressed to it
    takeOutLoosePieces();
  statistics_.searchSeconds += seconds() - start;
  if (holds_)
    solve();
}

// What is whole is where it was, mirrored; of what was pressed and is pulled now another part bears.
void AccurateEngine::turn()
{
  for (NodeField<double>* const field : { &sample_.displacement, &u_ })
    for (int c = 0; c < field->components(); ++c)
      for (std::int64_t i = 0; i < field->layout().count(); ++i)
        field->component(c)[i] = -field->component(c)[i];
  platens_.turn();
  if (contact_ != nullptr && contact_->follow(u_) > 0)
    equilibrium_.reset();
  solve();
}

void AccurateEngine::takeOutLoosePieces()
{
  ++statistics_.searches;
  if (sample_.pores)
  {
    const LostPieces lost = looseUnderPressure(bonds_, sample_);
    if (lost.pieces == 0)
      return;
    statistics_.loosePieces += lost.pieces;
    statistics_.looseNodes += lost.nodes;
    holds_ = sample_.pores->faces() > 0;
    statistics_.looseBonds += bonds_.breakBonds(lost.bonds);
    equilibrium_.reset();
    return;
  }
  const AlignedArray<std::uint8_t> marks = platens_.marks(bonds_, sample_);
  const Fragments fragments = findFragments(bonds_, &marks);
  holds_ = false;
  std::int64_t nodes = 0;
  std::int64_t larger = 0;
  std::int64_t ofLarger = 0;
  for (const Fragment& f : fragments.pieces)
  {
    holds_ = holds_ || (f.fixed & 3U) == 3;
    if ((f.fixed & 4U) != 0)
      continue;
    nodes += f.nodes;
    larger += f.nodes > 1 ? 1 : 0;
    ofLarger += f.nodes > 1 ? f.nodes : 0;
  }
  if (nodes == loose_)
    return;
  statistics_.loosePieces += larger + nodes - loose_ - ofLarger; // the others are single nodes
  statistics_.looseNodes += nodes - loose_;
  loose_ = nodes;
  if (larger == 0)
    return;
  statistics_.looseBonds += bonds_.breakBonds(bondsOfLoosePieces(bonds_, fragments));
  equilibrium_.reset();
}

} // namespace lamella::peridynamics
