#include "peridynamics/fracture/Dynamics.h"

#include "core/Error.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

/// Of the stable step, at least.
constexpr double leastShare = 1e-5;
/// From one look at the energies to the next, and at most from one call of progress() to the next.
constexpr std::int64_t lookSteps = 100;

/// The largest eigenvalue of a symmetric block, components as nodalStress().
double largest(const NodeField<double>& blocks, std::int64_t i)
{
  if (blocks.components() == 3)
  {
    const double xx = blocks.component(0)[i];
    const double yy = blocks.component(1)[i];
    return (xx + yy) / 2 + std::hypot((xx - yy) / 2, blocks.component(2)[i]);
  }
  Eigen::Matrix3d block;
  const auto at = [&](int c) { return blocks.component(c)[i]; };
  block << at(0), at(3), at(5), at(3), at(1), at(4), at(5), at(4), at(2);
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

double massOf(const BondLattice& bonds, double density)
{
  return density * std::pow(bonds.spacing(), bonds.dimension());
}

/// The masses of nodes of these densities, rim filled. Collective.
NodeField<double> massesOf(const BondLattice& bonds, const NodeField<double>& densities)
{
  if (!(densities.layout() == bonds.layout()) || densities.components() != 1)
    throw ParameterError("densities of another lattice", "make them for this lattice");
  const NodeLayout& l = bonds.layout();
  NodeField<double> masses(l, 1);
  double bad = 1;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        if (const double density = densities.component(0)[i]; bonds.solid(i))
        {
          bad = density > 0 && std::isfinite(density) ? bad : density;
          masses.component(0)[i] = massOf(bonds, density);
        }
  const bool mine = !(bad > 0) || !std::isfinite(bad);
  if (bonds.communicator().any(mine))
    throw ParameterError(mine ? fmt::format("a density of {} kg/m³", bad) : "a density that is not above 0",
      "give one above 0 for all that is solid");
  bonds.exchange(masses);
  return masses;
}

/// The largest step for which 2/step is at least any frequency. @param mass of a position
template <class F>
double stableStepOf(const BondLattice& bonds, F&& mass)
{
  const NodeLayout& l = bonds.layout();
  NodeField<double> blocks(l, l.dimension == 3 ? 6 : 3);
  diagonalBlocks(bonds, blocks);
  double most = 0;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        if (bonds.solid(i))
          most = std::max(most, largest(blocks, i) / mass(i));
  most = bonds.communicator().max(most);
  return most > 0 ? std::sqrt(2 / most) : std::numeric_limits<double>::infinity();
}

/// The least √(2 m k/|ξ|) of all bonds, m of the lighter end. @param mass of a position
template <class F>
double criticalViscosity(const BondLattice& bonds, F&& mass)
{
  double least = 0;
  const NodeLayout& l = bonds.layout();
  for (std::int64_t z = -l.ghostZ(); z < l.size[2]; ++z)
    for (std::int64_t y = -l.ghost; y < l.size[1]; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t j, int offset, int)
        {
          const double k = bonds.springConstant(i, offset) * std::min(mass(i), mass(j));
          least = k > 0 && (least == 0 || k < least) ? k : least;
        });
  // The least over ranks as the largest inverse; ranks without bonds say nothing.
  const double inverse = bonds.communicator().max(least > 0 ? 1 / least : 0);
  return inverse > 0 ? std::sqrt(2 / inverse) : 0;
}

} // namespace

double EnergyBalance::defect() const noexcept
{
  const double terms = std::max({ kinetic, elastic, broken, damped, std::abs(supplied), initial });
  return terms > 0 ? (kinetic + elastic + broken + damped - supplied - initial) / terms : 0;
}

double stableStep(const BondLattice& bonds, double mass)
{
  return stableStepOf(
    bonds, [mass](std::int64_t) { return mass; });
}

double stableStep(const BondLattice& bonds, const NodeField<double>& masses)
{
  return stableStepOf(
    bonds, [m = masses.component(0)](std::int64_t i) { return m[i]; });
}

BondDynamics::BondDynamics(BondLattice& bonds, FixedComponents fixed, DynamicsOptions options)
  : bonds_(bonds)
  , fixed_(std::move(fixed))
  , options_(std::move(options))
  , mass_(massOf(bonds, options_.density))
  , u_(bonds.layout())
  , v_(bonds.layout())
  , f_(bonds.layout())
  , rate_(options_.rate)
{
  if (!(options_.density > 0) || !std::isfinite(options_.density))
    throw ParameterError(fmt::format("a density of {} kg/m³", options_.density), "give one above 0");
  if (!(options_.safety >= leastShare && options_.safety <= 1))
    throw ParameterError(fmt::format("a step of {:g} times the stable one", options_.safety),
      fmt::format("give {:g} to 1, such as 0.8", leastShare));
  if (!(options_.damping >= 0 && options_.damping <= 1))
    throw ParameterError(fmt::format("damping of {} times the critical one", options_.damping), "give 0 to 1");
  if (fixed_.size() != bonds.layout().count())
    throw ParameterError("fixed components of another lattice", "make them for this lattice");
  if (bonds.solidNodes() == 0)
    throw ParameterError("a sample without matter", "check which phases are voids");
  if (options_.densities)
    masses_ = massesOf(bonds, *options_.densities);
  stable_ = masses_ ? stableStep(bonds, *masses_) : stableStep(bonds, mass_);
  const double* const masses = masses_ ? masses_->component(0) : nullptr;
  nu_ =
    options_.damping * criticalViscosity(bonds, [&](std::int64_t i) { return masses != nullptr ? masses[i] : mass_; });
  if (!std::isfinite(stable_) && !options_.step)
    throw ParameterError("a sample without bonds has no stable step", "give a step");
  dt_ = options_.step.value_or(options_.safety * stable_);
  if (!(dt_ > 0) || !std::isfinite(dt_))
    throw ParameterError(fmt::format("a step of {} s", dt_), "give a time above 0");
  if (dt_ < leastShare * stable_ && std::isfinite(stable_))
    throw ParameterError(fmt::format("a step of {:.4g} s is {:.2g} of the stable one, {:.4g} s: no run would come to "
                                     "its end",
                           dt_, dt_ / stable_, stable_),
      fmt::format("give {:.3g} s, or leave it out", 0.5 * stable_));
  if (options_.checkStep && dt_ > stable_)
    throw ParameterError(fmt::format("a step of {:.4g} s is above the stable one, {:.4g} s", dt_, stable_),
      fmt::format("give {:.3g} s or less, or leave it out", 0.99 * stable_));
  checkPlace(options_.checkpoint, bonds.communicator());
  if (!options_.checkpoint.path.empty() || !options_.continueFrom.empty())
    scene_ = scene();
  if (options_.continueFrom.empty())
    forces();
  else
    restore();
}

template <class F>
void BondDynamics::forEachRow(F&& f)
{
  const NodeLayout& l = u_.layout();
  const std::int64_t rows = l.size[1] * l.size[2];
#pragma omp parallel for schedule(static)
  for (std::int64_t r = 0; r < rows; ++r)
    f(r, l.index(0, r % l.size[1], r / l.size[1]), l.index(l.size[0], r % l.size[1], r / l.size[1]));
}

void BondDynamics::setState(const NodeField<double>& displacement, const NodeField<double>& velocity)
{
  if (!(displacement.layout() == u_.layout()) || !(velocity.layout() == u_.layout()))
    throw ParameterError("a state of another lattice", "make it for this lattice");
  u_ = displacement;
  v_ = velocity;
  imposed_.reset();
  const NodeLayout& l = u_.layout();
  bool moved = false;
  for (std::int64_t i = 0; i < l.count(); ++i)
    for (int c = 0; c < l.dimension; ++c)
      moved = moved || (((fixed_[i] >> c) & 1U) != 0 && velocity.component(c)[i] != 0);
  if (bonds_.communicator().any(moved))
    imposed_ = velocity;
  const double now = rate();
  for (std::int64_t i = 0; i < l.count(); ++i)
    for (int c = 0; c < l.dimension; ++c)
      if (((fixed_[i] >> c) & 1U) != 0)
        v_.component(c)[i] = imposed_ ? now * imposed_->component(c)[i] : 0;
  sums_ = {};
  brokenEnergy_ = 0;
  initial_ = 0;
  const bool critical = forces();
  balance_.reset();
  const EnergyBalance balance = energies();
  initial_ = balance.kinetic + balance.elastic;
  balance_.reset();
  if (critical)
    breakCritical();
}

void BondDynamics::setLoad(NodeField<double> load)
{
  if (!(load.layout() == u_.layout()))
    throw ParameterError("a load on another lattice", "make it for this lattice");
  load_ = std::move(load);
}

bool BondDynamics::forces()
{
  const CriticalBonds found = exchangeAndNonlinearForce(bonds_, u_, f_);
  return options_.breaking && bonds_.communicator().any(found.count > 0);
}

void BondDynamics::breakCritical()
{
  const std::vector<Bond> critical = nonlinearForce(bonds_, u_, f_, true).bonds;
  const NodeLayout& l = u_.layout();
  // Every rank lists the bonds whose first node it owns, and what they hold; all ranks take all down.
  std::vector<double> mine;
  for (const Bond& bond : critical)
  {
    std::array<std::int64_t, 3> at{};
    for (int a = 0; a < 3; ++a)
      at[a] = bond.node[a] - l.start[a];
    const std::int64_t i = l.index(at[0], at[1], at[2]);
    const std::int64_t j = i + bonds_.jump(bond.offset);
    const auto& step = bonds_.stencil().half()[static_cast<std::size_t>(bond.offset)];
    const double length = step.length * bonds_.spacing();
    double squared = 0;
    double along = 0;
    for (int c = 0; c < l.dimension; ++c)
    {
      const double xi = step.step[c] * bonds_.spacing();
      const double eta = u_.component(c)[j] - u_.component(c)[i];
      along += (2 * xi + eta) * eta; // |ξ+η|² − |ξ|², without loss of digits
      squared += (xi + eta) * (xi + eta);
    }
    const double elongation = along / (std::sqrt(squared) + length);
    const double energy = 0.5 * bonds_.springConstant(i, bond.offset) * elongation * elongation;
    for (const double value : { static_cast<double>(bond.node[0]), static_cast<double>(bond.node[1]),
           static_cast<double>(bond.node[2]), static_cast<double>(bond.offset), energy })
      mine.push_back(value);
  }
  const Communicator& comm = bonds_.communicator();
  const auto own = static_cast<std::int64_t>(mine.size());
  std::vector<double> all(static_cast<std::size_t>(comm.sum(own)), 0.0);
  std::copy(mine.begin(), mine.end(), all.begin() + comm.sumBefore(own));
  comm.sum(all);
  std::vector<DynamicBreak> fresh;
  for (std::size_t k = 0; k + 4 < all.size(); k += 5)
    fresh.push_back({ { { static_cast<std::int64_t>(all[k]), static_cast<std::int64_t>(all[k + 1]),
                          static_cast<std::int64_t>(all[k + 2]) },
                        static_cast<int>(all[k + 3]) },
      step_, time_, all[k + 4] });
  std::sort(fresh.begin(), fresh.end(), [](const auto& a, const auto& b) { return a.bond < b.bond; });
  for (const DynamicBreak& one : fresh)
    brokenEnergy_ += one.energy;
  broken_.insert(broken_.end(), fresh.begin(), fresh.end());
  bonds_.breakBonds(critical);
  nonlinearForce(bonds_, u_, f_);
}

void BondDynamics::halfKick(bool first)
{
  const NodeLayout& l = u_.layout();
  const double half = dt_ / 2;
  const double* const masses = masses_ ? masses_->component(0) : nullptr;
  const double rate = this->rate();
  std::vector<Sums> sums(static_cast<std::size_t>(l.size[1] * l.size[2]));
  forEachRow(
    [&](std::int64_t row, std::int64_t begin, std::int64_t end)
    {
      Sums& sum = sums[static_cast<std::size_t>(row)];
      for (int c = 0; c < l.dimension; ++c)
      {
        const unsigned bit = 1U << c;
        const double* const f = f_.component(c);
        const double* const load = load_ ? load_->component(c) : nullptr;
        const double* const imposed = imposed_ ? imposed_->component(c) : nullptr;
        double* const v = v_.component(c);
        for (std::int64_t i = begin; i < end; ++i)
        {
          if (!bonds_.solid(i))
            continue;
          const double mass = masses != nullptr ? masses[i] : mass_;
          // Over half a step the damping is implicit in the second half and explicit in the first: central in time.
          const double before = first ? 1 - half * nu_ / mass : 1;
          const double after = first ? 1 : 1 / (1 + half * nu_ / mass);
          const double push = load != nullptr ? load[i] : 0;
          const double old = v[i];
          const bool held = (fixed_[i] & bit) != 0;
          if (held)
            v[i] = imposed != nullptr ? rate * imposed[i] : 0;
          else
            v[i] = (before * old + half / mass * (f[i] + push)) * after;
          // The velocity with which nodes move over the step, and that which damps them in this half of it.
          const double moves = first ? v[i] : old;
          const double damps = held ? moves : first ? old : v[i];
          sum.damped += half * nu_ * damps * moves;
          // What holds a node supplies what its bonds, its damping and its own inertia take.
          sum.supplied +=
            held ? half * moves * (nu_ * moves - f[i]) + 0.5 * mass * (v[i] * v[i] - old * old) : half * moves * push;
        }
      }
    });
  for (const Sums& sum : sums)
  {
    sums_.supplied += sum.supplied;
    sums_.damped += sum.damped;
  }
}

void BondDynamics::drift()
{
  const NodeLayout& l = u_.layout();
  forEachRow(
    [&](std::int64_t, std::int64_t begin, std::int64_t end)
    {
      for (int c = 0; c < l.dimension; ++c)
      {
        double* const u = u_.component(c);
        const double* const v = v_.component(c);
        for (std::int64_t i = begin; i < end; ++i)
          u[i] += dt_ * v[i];
      }
    });
}

DynamicsProgress BondDynamics::progress() const
{
  return { step_, time_, static_cast<std::int64_t>(broken_.size()), checkpointAt_ };
}

// The steps until the next look follow from what those since the last one took, on the slowest rank: all ranks agree.
bool BondDynamics::stops()
{
  if (!options_.progress || step_ < lookStep_)
    return false;
  const Communicator& comm = bonds_.communicator();
  const double spent = comm.max(secondsSince(lookedAt_));
  const double fit = options_.progressEvery * static_cast<double>(step_ - lookedStep_) / std::max(spent, 1e-9);
  lookStep_ = step_ + static_cast<std::int64_t>(std::clamp(fit, 1.0, static_cast<double>(lookSteps)));
  lookedAt_ = Clock::now();
  lookedStep_ = step_;
  return comm.any(options_.progress(progress()));
}

bool BondDynamics::advance(std::int64_t steps)
{
  for (std::int64_t k = 0; k < steps; ++k)
  {
    balance_.reset();
    halfKick(true);
    drift();
    ++step_;
    time_ += dt_;
    // A bond that is critical now held until now: it pulls to the end of the step.
    const bool critical = forces();
    halfKick(false);
    const double before = brokenEnergy_;
    if (critical)
      breakCritical();
    if (rate_)
      rate_->advance(dt_, brokenEnergy_ - before);
    if (!options_.checkpoint.path.empty() &&
      step_ % (options_.checkpoint.every > 0 ? options_.checkpoint.every : 1000) == 0 &&
      pace_.due(options_.checkpoint, bonds_.communicator()))
    {
      guard(); // the last good one is to stay
      save();
    }
    if (step_ % lookSteps == 0)
      guard();
    if (!stops())
      continue;
    if (!options_.checkpoint.path.empty() && checkpointAt_ != step_)
    {
      guard();
      save();
      options_.progress(progress());
    }
    return false;
  }
  guard();
  return true;
}

EnergyBalance BondDynamics::energies() const
{
  if (balance_)
    return *balance_;
  const NodeLayout& l = u_.layout();
  const double* const masses = masses_ ? masses_->component(0) : nullptr;
  double squares = 0; // times the mass where they differ
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
          if (bonds_.solid(i))
            squares += (masses != nullptr ? masses[i] : 1) * v_.component(c)[i] * v_.component(c)[i];
  std::array<double, 3> sums{ squares, sums_.supplied, sums_.damped };
  bonds_.communicator().sum(sums);
  balance_ = { 0.5 * (masses != nullptr ? 1 : mass_) * sums[0], elasticEnergy(bonds_, u_, true), brokenEnergy_, sums[2],
    sums[1], initial_ };
  return *balance_;
}

void BondDynamics::guard()
{
  const EnergyBalance e = energies();
  const double held = e.kinetic + e.elastic + e.broken + e.damped;
  const double given = std::abs(e.supplied) + e.initial;
  if (!std::isfinite(held))
    throw DivergenceError(fmt::format("the energy is no longer finite at step {} ({:.4g} s)", step_, time_),
      fmt::format("take a smaller step than {:.3g} s, or lower the load", dt_));
  // Of waves with ω dt/2 = x velocity Verlet's energy comes to 1/(1 − x²) of what was given at most, x ≤ dt/stable: a
  // defect of x². A quarter is more than shocks and breaks leave.
  const double share = dt_ / stable_;
  const double most = share <= 1 ? std::max(0.25, share * share) : 0.25;
  if (given > 0 && (held > 10 * given || e.defect() > most))
    throw DivergenceError(
      fmt::format(
        "at step {} ({:.4g} s) the sample holds {:.2g} times the energy that it was given", step_, time_, held / given),
      fmt::format("take a smaller step than {:.3g} s", dt_));
}

} // namespace lamella::peridynamics
