#include "peridynamics/fracture/AccurateEngine.h"

#include "core/Clock.h"
#include "core/Error.h"

#include "peridynamics/Fragments.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/fracture/LoosePieces.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
AccurateEngine::AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens, double unitStrain,
  double tolerance, std::function<bool(double)> progress)
  : bonds_(bonds)
  , sample_(sample)
  , platens_(platens)
  , unitStrain_(unitStrain)
  , tolerance_(tolerance)
  , graph_(bonds)
  , u_(sample.displacement)
{
  prepare();
  equilibrium_->setProgress(std::move(progress));
  equilibrium_->setDoubt([this](const NodeField<double>& u, const NodeField<double>& force)
    { return sample_.pores ? workOfResidual(bonds_, sample_, u, force) : platens_.imbalance(bonds_, force); });
  solve();
  equilibrium_->setProgress({}); // of those that follow, the events are
  equilibrium_->setDoubt({});
}

AccurateEngine::AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens, double unitStrain,
  double tolerance, const EngineState& resumed)
  : bonds_(bonds)
  , sample_(sample)
  , platens_(platens)
  , unitStrain_(unitStrain)
  , tolerance_(tolerance)
  , graph_(bonds)
  , u_(resumed.displacement)
{
  bonds.exchange(u_);
  force_ = resumed.numbers.at("force");
  if (sample.pores)
    scale_ = resumed.numbers.at("scale");
  statistics_ = resumed.statistics;
  loose_ = statistics_.looseNodes;
}

AccurateEngine::~AccurateEngine() = default;

EngineState AccurateEngine::state() const
{
  EngineState state{ u_, { { "force", force_ } }, statistics_ };
  if (sample_.pores)
    state.numbers["scale"] = scale_;
  return state;
}

void AccurateEngine::prepare()
{
  EquilibriumOptions o;
  o.tolerance = tolerance_;
  equilibrium_ = std::make_unique<Equilibrium>(bonds_, sample_.fixed, o);
  fresh_ = true;
}

// The preconditioner remains one, if a worse one, when bonds break; a new one costs as much as a few iterations.
void AccurateEngine::solve()
{
  const double start = seconds();
  if (!equilibrium_)
    prepare();
  const bool fresh = fresh_;
  EquilibriumResult r;
  try
  {
    r = equilibrium_->solve(u_, sample_.load ? &*sample_.load : nullptr);
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
  if (fresh)
    usual_ = r.iterations;
  else if (r.iterations > usual_ + 5)
    equilibrium_.reset();
  fresh_ = false;
  ++statistics_.equilibria;
  statistics_.globalIterations += r.iterations;
  statistics_.bytes = r.bytes;
  measure();
  statistics_.globalSeconds += seconds() - start;
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
  // every rank names all of them, and they count once
  bonds_.breakBonds(bonds_.communicator().rank() == 0 ? bonds : std::span<const Bond>());
  const double start = seconds();
  if (!joined(bonds))
    takeOutLoosePieces();
  statistics_.searchSeconds += seconds() - start;
  if (holds_)
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
