#include "mpm/PointDynamics.h"

#include "core/Error.h"
#include "core/Together.h"
#include "mpm/FusedStep.h"
#include "mpm/GeneralStep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lamella::mpm
{
namespace
{

constexpr std::int64_t between = 20;     // steps from one look at the whole body to the next
constexpr std::int64_t remeasure = 2000; // steps from one measurement of the wave factor to the next
constexpr double fastUpdates = 1e6;      // of points, on one thread and the fused path: a tenth of a second or so
constexpr double slowUpdates = 1e5;
constexpr double worthMass = 1e-12; // of a node, over that of the heaviest point: its round-off is 1e-16 or so
constexpr double otherShapes = 6;
constexpr double margin = 1.07;   // for power iteration, which ends early
constexpr double smoothing = 1.5; // greatest found: 1.49, APIC on tissue
constexpr double leastFactor = 4.5;
constexpr double mostStrain = 0.5; // of a point from one look to the next

void checkOptions(bool fine, const std::string& message, const char* hint)
{
  if (!fine)
    throw ParameterError(message, hint);
}

} // namespace

template <int Dim>
PointDynamics<Dim>::PointDynamics(
  MaterialPoints<Dim> points, std::shared_ptr<const PointLaw<Dim>> law, PointDynamicsOptions<Dim> options)
  : points_(std::move(points))
  , law_(std::move(law))
  , options_(std::move(options))
  , ranks_(options_.comm)
  , count_(options_.comm.sum(static_cast<std::int64_t>(points_.count())))
  , measured_(bulkRatio(*law_))
{
  together(options_.comm, [this] { check(); });
  ranks_.checkNumbers(points_);
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
    {
      const Side& given = options_.sides[static_cast<std::size_t>(a)][static_cast<std::size_t>(side)];
      walls_(a, side) = Wall{ given.straight, given.sticks, given.straight ? 0 : given.velocity, given.friction, 0 };
    }
  shareAffines();
  double heaviest = 0;
  for (const double mass : points_.column(MaterialPoints<Dim>::masses))
    heaviest = std::max(heaviest, mass);
  walls_.least = worthMass * options_.comm.max(heaviest);
  walls_.bodies = options_.bodies;
  walls_.bodies.density = densities();
  for (const auto& side : options_.sides)
    walled_ = walled_ && side[0].edge == Edge::Wall && side[1].edge == Edge::Wall;
  layGrid(false);
  ranks_.chooseAxis(grid_);
  if (!chooseStep())
    throw Cancelled();
  if (options_.fused && options_.shape == Shape::QuadraticSpline && options_.mass == MassMatrix::Lumped &&
    options_.transfer == Transfer::Apic && options_.update == StressUpdate::Last && !options_.acceleration &&
    static_cast<int>(law_->kind()) < (options_.precision == Precision::Single ? singleLawKinds : lawKinds))
    fused_ = std::make_unique<FusedStep<Dim>>(
      points_, *law_, walls_.bodies, options_.gravity, options_.precision == Precision::Single);
  if (!fused_ && options_.transfer == Transfer::Apic)
    points_.storeAffines();
  checkOptions(fused_ || options_.precision == Precision::Double, "single precision, but the step is not a fused one",
    "take quadratic splines, lumped mass, APIC, stress last, an elastic law and no acceleration; or double");
  checkOptions(!options_.comm.parallel() ||
      (options_.mass == MassMatrix::Lumped &&
        (options_.transfer == Transfer::Apic || options_.transfer == Transfer::Pic)),
    fmt::format("{} ranks with FLIP, XPIC or a consistent mass", options_.comm.size()),
    "take APIC or PIC and lumped mass; or one rank");
  looks_ = static_cast<std::int64_t>(
    std::clamp((fused_ ? fastUpdates : slowUpdates) / static_cast<double>(count_), 1.0, 100.0));
  initial_ = kineticEnergy() + elasticEnergy();
  startMoment_ = gravityMoment();
}

template <int Dim>
PointDynamics<Dim>::~PointDynamics() = default;

template <int Dim>
void PointDynamics<Dim>::shareAffines()
{
  if (options_.transfer != Transfer::Apic)
    points_.setAffines({});
  bool given = points_.storesAffines();
  for (const double c : points_.commonAffine().m)
    given = given || c != 0;
  if (options_.comm.parallel() && options_.comm.any(given))
    points_.storeAffines();
}

template <int Dim>
Matrix<Dim> PointDynamics<Dim>::affine(std::size_t p) const
{
  return fused_ ? fused_->affine(p) : points_.affine(p);
}

template <int Dim>
MaterialPoints<Dim> PointDynamics<Dim>::gather() const
{
  MaterialPoints<Dim> complete = points_;
  complete.storeAffines();
  for (std::size_t p = 0; p < complete.count(); ++p)
    complete.setAffine(p, affine(p));
  return ranks_.gather(complete);
}

template <int Dim>
void PointDynamics<Dim>::check() const
{
  using Points = MaterialPoints<Dim>;
  const auto& o = options_;
  checkOptions(o.spacing > 0, fmt::format("a grid spacing of {} m", o.spacing), "give one above 0");
  checkOptions(
    o.share > 0 && o.share <= 1, fmt::format("a share of {} of the stable step", o.share), "above 0, at most 1");
  checkOptions(!o.step || *o.step > 0, fmt::format("a step of {} s", o.step.value_or(0)), "give one above 0, or none");
  checkOptions(o.xpicOrder >= 1, fmt::format("XPIC of order {}", o.xpicOrder), "at least 1");
  checkOptions(o.massTerms >= 1, fmt::format("{} terms of the mass", o.massTerms), "at least 1");
  if (count_ == 0)
    throw InputError("no material points", "look at which phase is the empty one");
  for (int a = 0; a < Dim; ++a)
  {
    const auto& side = o.sides[static_cast<std::size_t>(a)];
    checkOptions((side[0].edge == Edge::Periodic) == (side[1].edge == Edge::Periodic),
      fmt::format("axis {} is periodic at one end only", a), "make both ends periodic, or none");
    if (side[0].edge != Edge::Open && side[1].edge != Edge::Open)
      checkOptions(side[1].position - side[0].position >= 2.5 * o.spacing,
        fmt::format("ends {} m apart along axis {}, the grid's spacing is {} m", side[1].position - side[0].position, a,
          o.spacing),
        "at least three cells have to lie between them: take a finer grid");
  }
  if (points_.history() != law_->history())
    throw InputError(
      fmt::format("points with a history of {} numbers, the law wants {}", points_.history(), law_->history()),
      "make the points with as many");
  std::size_t phases = 0;
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    phases = std::max<std::size_t>(phases, points_.phase()[p] + 1U);
    for (int c = 0; c < points_.columns(); ++c)
      if (!std::isfinite(points_.column(c)[p]))
        throw InputError(fmt::format("column {} of point {} is {}", c, p, points_.column(c)[p]), "give finite values");
    const double mass = points_.column(Points::masses)[p];
    const double volume = points_.column(Points::volumes)[p];
    if (!(mass > 0) || !(volume > 0))
      throw InputError(fmt::format("point {} has mass {} and volume {}", p, mass, volume), "both above 0");
    for (int a = 0; a < Dim; ++a)
    {
      const auto& side = o.sides[static_cast<std::size_t>(a)];
      const double x = points_.column(a)[p];
      if ((side[0].edge != Edge::Open && x < side[0].position) || (side[1].edge != Edge::Open && x > side[1].position))
        throw InputError(fmt::format("point {} at {} m along axis {} is not between {} and {} m", p, x, a,
                           side[0].position, side[1].position),
          "put the walls around the points");
    }
  }
  checkOptions(law_->phases() == 1 || law_->phases() >= phases,
    fmt::format("a law of {} phases for points of {}", law_->phases(), phases), "give the law of each phase");
  checkContact(phases);
}

template <int Dim>
void PointDynamics<Dim>::checkContact(std::size_t phases) const
{
  const auto& o = options_;
  const auto fine = [](double friction) { return std::isfinite(friction) && friction >= 0; };
  bool rubs = o.bodies.count > 1;
  for (const auto& ends : o.sides)
    for (const Side& side : ends)
    {
      checkOptions(fine(side.friction), fmt::format("a wall's friction of {}", side.friction), "finite, 0 or above");
      checkOptions(side.friction == 0 || (side.edge == Edge::Wall && !side.straight && !side.sticks),
        "friction at an end that is no wall, is straight or sticks", "take a wall that slides and has its velocity");
      rubs = rubs || side.friction > 0;
    }
  checkOptions(
    !rubs || o.mass == MassMatrix::Lumped, "friction with a consistent mass", "take a lumped mass, or no friction");
  const auto count = static_cast<std::size_t>(std::max(o.bodies.count, 0));
  checkOptions(count >= 1 && (count == 1 || o.bodies.friction.size() == count * count),
    fmt::format("{} bodies and {} coefficients of friction", o.bodies.count, o.bodies.friction.size()),
    "one body at least, and a coefficient for each pair");
  if (count == 1)
    return;
  checkOptions(o.precision == Precision::Double, "bodies that are not joined, in single precision", "take double");
  checkOptions(o.bodies.ofPhase.size() >= phases &&
      std::all_of(o.bodies.ofPhase.begin(), o.bodies.ofPhase.end(), [&](std::uint8_t b) { return b < count; }),
    fmt::format("bodies of {} phases for points of {}", o.bodies.ofPhase.size(), phases),
    "give each phase a body, from 0 on");
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b)
    {
      const double friction = o.bodies.friction[a * count + b];
      checkOptions(fine(friction) && friction == o.bodies.friction[b * count + a],
        fmt::format("a friction of {} between the bodies {} and {}", friction, a, b), "finite, 0 or above, symmetric");
    }
}

template <int Dim>
std::vector<double> PointDynamics<Dim>::densities() const
{
  std::vector<double> mass(static_cast<std::size_t>(options_.bodies.count));
  std::vector<double> volume(mass.size());
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    const std::size_t body = options_.bodies.of(points_.phase()[p]);
    mass[body] += points_.column(MaterialPoints<Dim>::masses)[p];
    volume[body] += points_.column(MaterialPoints<Dim>::volumes)[p];
  }
  options_.comm.sum(mass);
  options_.comm.sum(volume);
  for (std::size_t b = 0; b < mass.size(); ++b)
    mass[b] = volume[b] > 0 ? mass[b] / volume[b] : 1; // of a body without points: never asked for
  return mass;
}

template <int Dim>
double PointDynamics<Dim>::stableStep() const
{
  return 2 * grid_.smallestSpacing() / std::sqrt(factor_ * stiffest()) *
    (options_.mass == MassMatrix::Consistent ? 0.5 : 1);
}

template <int Dim>
double PointDynamics<Dim>::stiffest() const
{
  using Points = MaterialPoints<Dim>;
  if (looked_.stiffestAt == step_)
    return looked_.stiffest;
  double worst = 0;
#pragma omp parallel for schedule(static) reduction(max : worst) if (points_.count() > 2000)
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    const double stiffness = law_->stiffness(points_.phase()[p], points_.matrix(Points::deformations, p),
      points_.vector(Points::axes, p), points_.memory(p).data());
    const double ratio = stiffness * points_.column(Points::volumes)[p] / points_.column(Points::masses)[p];
    // what is not a number must come out on top
    worst = ratio <= worst ? worst : std::isfinite(ratio) ? ratio : std::numeric_limits<double>::infinity();
  }
  return options_.comm.max(worst);
}

template <int Dim>
bool PointDynamics<Dim>::stops() const
{
  return options_.comm.any(options_.progress && options_.progress(step_, time_));
}

template <int Dim>
bool PointDynamics<Dim>::measureFactor()
{
  if (options_.shape != Shape::QuadraticSpline || options_.mass != MassMatrix::Lumped)
  {
    factor_ = otherShapes;
    return true;
  }
  const auto seen =
    measured_.measure(points_, grid_, walls_.bodies, factor_ == 0 ? 24 : 8, options_.comm, [this] { return stops(); });
  if (!seen)
    return false;
  // transfers that smooth velocities (T) are stable up to the greatest eigenvalue of (½ M (1 + T))⁻¹ K
  factor_ = std::max({ factor_, *seen * margin * (options_.transfer == Transfer::Flip ? 1 : smoothing), leastFactor });
  return true;
}

template <int Dim>
double PointDynamics<Dim>::fastestStrain() const
{
  double worst = 0;
  if (fused_)
    worst = fused_->fastest();
  else
    for (std::size_t p = 0; p < points_.count(); ++p)
      for (const double c : points_.affine(p).m)
        worst = std::max(worst, std::fabs(c));
  return options_.comm.max(worst);
}

template <int Dim>
bool PointDynamics<Dim>::chooseStep()
{
  if (step_ % remeasure == 0 && !measureFactor())
    return false;
  const double stable = stableStep();
  if (!(stable > 0))
    throw DivergenceError(
      fmt::format("at step {} (time {:.6g} s) a point is turned inside out or no longer finite", step_, time_),
      "take a smaller step, slower walls, or a law with a barrier against collapse");
  if (!options_.step)
  {
    // not for every trifle: a step of another length costs the fused path a pass over the points
    const double wanted = std::min(options_.share * stable, mostStrain / (between * fastestStrain()));
    if (step_ == 0 || dt_ > wanted * (1 + 0.1 * (1 - options_.share)) || dt_ < 0.9 * wanted)
      dt_ = wanted;
  }
  else if (*options_.step <= stable)
    dt_ = *options_.step;
  else if (step_ == 0)
    throw ParameterError(
      fmt::format("a step of {:.4g} s is unstable: the largest stable one is {:.4g} s", *options_.step, stable),
      "take a smaller one, or none: it is then chosen");
  else
    throw DivergenceError(
      fmt::format("at step {} the step of {:.4g} s became unstable: the deformed body allows {:.4g} s", step_,
        *options_.step, stable),
      "take a smaller one, or none: it is then chosen");
  return true;
}

template <int Dim>
void PointDynamics<Dim>::setVelocity(int axis, int side, double velocity)
{
  Wall& wall = walls_(axis, side);
  checkOptions(!wall.straight, fmt::format("the end {} of axis {} finds its own velocity", side, axis),
    "make it a wall that is not straight");
  wall.velocity = velocity;
}

template <int Dim>
bool PointDynamics<Dim>::run(std::int64_t steps, double dt, bool energies)
{
  for (std::int64_t i = 0; i < steps; ++i)
  {
    if (step_ % between == 0 && step_ > 0 && !chooseStep())
      return false;
    const bool stop = step_ % looks_ == 0 && step_ > 0 && i > 0 && stops();
    const double now = dt > 0 ? std::min(dt, dt_) : dt_;
    const bool end = stop || i + 1 == steps;
    const bool due = (step_ + 1) % between == 0;
    if (fused_)
      fusedStep(now, (before_ + now) / 2, end || due, end && energies ? Look::Sums : due ? Look::Stiffness : Look::No);
    else
      generalStep(now, (before_ + now) / 2);
    before_ = now;
    time_ += now;
    ++step_;
    if (stop && i + 1 < steps) // after a step that the points can be looked at
      return false;
  }
  return true;
}

template <int Dim>
bool PointDynamics<Dim>::advance(std::int64_t steps, bool energies)
{
  return run(steps, 0, energies);
}

template <int Dim>
bool PointDynamics<Dim>::advanceTo(double time, bool energies)
{
  // steps may have to shrink on the way
  while (time - time_ > 1e-9 * dt_)
  {
    if (step_ >= evenTo_)
    {
      const auto count = static_cast<std::int64_t>(std::ceil((time - time_) / dt_ - 1e-9));
      evenStep_ = (time - time_) / static_cast<double>(count);
      evenTo_ = step_ + std::min(count, between);
    }
    const bool last = time - time_ - static_cast<double>(evenTo_ - step_) * evenStep_ <= 1e-9 * dt_;
    if (!run(evenTo_ - step_, evenStep_, energies && last))
      return false;
  }
  return true;
}

template <int Dim>
void PointDynamics<Dim>::addWork(double kick)
{
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
    {
      const Wall& wall = walls_(a, side);
      supplied_ -= wall.force * wall.velocity * kick;
      impulse_[static_cast<std::size_t>(a)][static_cast<std::size_t>(side)] += wall.force * kick;
    }
}

template <int Dim>
void PointDynamics<Dim>::generalStep(double dt, double kick)
{
  ranks_.distribute(points_, grid_);
  const BackgroundGrid<Dim> mine = ranks_.local(grid_);
  supplied_ +=
    options_.comm.sum(GeneralStep<Dim>{ points_, *law_, options_, mine, walls_, ranks_.rows(), time_, dt, kick }.run());
  addWork(kick);
  moveWalls(dt);
  wrap();
  layGrid(false);
}

template <int Dim>
void PointDynamics<Dim>::prepare(double kick)
{
  if (options_.comm.parallel()) // for where they go there is no grid that knows
    fused_->storeAffines();
  ranks_.distribute(points_, grid_);
  together(options_.comm, [&] { fused_->prepare(ranks_.local(grid_), kick); });
}

template <int Dim>
void PointDynamics<Dim>::noteLooked(Look look)
{
  const auto& mine = fused_->looked();
  const std::int64_t after = step_ + 1;
  looked_ = { after, -1, -1, 0, 0, options_.comm.max(mine.stiffest) };
  if (look != Look::Sums)
    return;
  std::array<double, 2> energies{ mine.kinetic, mine.elastic };
  options_.comm.sum(energies);
  looked_ = { after, after, after, energies[0], energies[1], looked_.stiffest };
}

template <int Dim>
void PointDynamics<Dim>::fusedStep(double dt, double kick, bool keep, Look look)
{
  // of the rank that is worst off
  constexpr int leaving = 1;
  constexpr int empty = 2;
  constexpr int lost = 3;
  const auto state = static_cast<int>(options_.comm.max(fused_->lost() ? lost
      : !fused_->ready()                                               ? empty
      : fused_->leaving()                                              ? leaving
                                                                       : 0));
  if (state == lost)
    throw DivergenceError(
      fmt::format("at step {} (time {:.6g} s) a point has gone further than half a cell in a step, or is no longer "
                  "finite",
        step_, time_),
      "take a smaller step, slower walls, or a law with a barrier against collapse");
  if (state == empty)
  {
    if (options_.comm.parallel())
      fused_->storeAffines();
    wrap();
    layGrid(false);
    prepare(kick);
  }
  else
    fused_->adjust(kick);
  constrain(ranks_.local(grid_), walls_, fused_->nodes(), kick, true, ranks_.rows(), &points_);
  addWork(kick);
  moveWalls(dt);
  const BackgroundGrid<Dim> old = grid_;
  layGrid(true);
  bool same = true;
  for (int a = 0; a < Dim; ++a)
    same = same && grid_.axis(a).cells == old.axis(a).cells;
  if (same)
  {
    keep = keep || !walled_ || state == leaving;
    if (fused_->run(ranks_.local(old), ranks_.local(grid_), dt, dt, keep, look))
      noteLooked(look);
  }
  else
  {
    // another number of cells: give to a grid of as many as before, then sort the points into the new one
    std::array<GridAxis, Dim> axes = grid_.axes();
    for (int a = 0; a < Dim; ++a)
    {
      GridAxis& g = axes[static_cast<std::size_t>(a)];
      g.spacing = g.length() / old.axis(a).cells;
      g.cells = old.axis(a).cells;
    }
    fused_->run(ranks_.local(old), ranks_.local(BackgroundGrid<Dim>(axes)), dt, dt, true, Look::No);
  }
  if (!same)
    fused_->forget();
  else if (state == leaving && !options_.comm.any(!fused_->ready()))
    prepare(dt); // and nothing is wrapped: when that is done must not depend on where the cuts are
}

template class PointDynamics<2>;
template class PointDynamics<3>;

} // namespace lamella::mpm
