#include "mpm/PointDynamics.h"

#include "lattice/Error.h"
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

constexpr std::int64_t between = 10; // steps from one look at the whole body to the next
constexpr int rim = 4;               // cells beyond the points where an axis is open

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
{
  check();
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
    {
      const Side& given = options_.sides[static_cast<std::size_t>(a)][static_cast<std::size_t>(side)];
      walls_(a, side) = Wall{ given.straight, given.sticks, given.straight ? 0 : given.velocity, 0 };
    }
  layGrid();
  chooseStep();
  initial_ = kineticEnergy() + elasticEnergy();
}

template <int Dim>
PointDynamics<Dim>::~PointDynamics() = default;

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
  if (points_.count() == 0)
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
}

template <int Dim>
std::array<std::array<double, 2>, Dim> PointDynamics<Dim>::extents() const
{
  std::array<std::array<double, 2>, Dim> extent{};
  for (int a = 0; a < Dim; ++a)
  {
    const auto x = points_.column(a);
    double low = x[0];
    double high = x[0];
    for (const double value : x)
    {
      low = std::min(low, value);
      high = std::max(high, value);
    }
    extent[static_cast<std::size_t>(a)] = { low, high };
  }
  return extent;
}

template <int Dim>
void PointDynamics<Dim>::layGrid()
{
  std::array<GridAxis, Dim> axes;
  const auto extent = extents();
  const double h = options_.spacing;
  double cells = 1;
  for (int a = 0; a < Dim; ++a)
  {
    const auto& side = options_.sides[static_cast<std::size_t>(a)];
    const auto [low, high] = extent[static_cast<std::size_t>(a)];
    GridAxis& g = axes[static_cast<std::size_t>(a)];
    g.edge = { side[0].edge, side[1].edge };
    g.spacing = h;
    const double room = rim * h;
    double lower = side[0].position;
    double upper = side[1].position;
    if (side[0].edge == Edge::Open && side[1].edge == Edge::Open)
    {
      lower = std::floor((low - room) / h) * h; // nodes at multiples of the spacing
      upper = lower + std::ceil((high + room - lower) / h) * h;
    }
    else if (side[0].edge == Edge::Open)
      lower = upper - std::ceil((upper - low + room) / h) * h;
    else if (side[1].edge == Edge::Open)
      upper = lower + std::ceil((high + room - lower) / h) * h;
    cells *= (upper - lower) / h;
    if (!(cells < std::max(1e7, 1e3 * static_cast<double>(points_.count()))))
      throw DivergenceError(
        fmt::format("at step {} the points are spread from {} to {} m along axis {}", step_, low, high, a),
        "take a smaller step, or hold them with walls");
    g.lower = lower;
    const double wanted = (upper - lower) / h;
    g.cells = static_cast<int>(std::lround(wanted));
    // walls that come and go across half a cell do not change the number of cells each time
    const int last = grid_.count() > 0 ? grid_.axis(a).cells : 0;
    if (last > 0 && side[0].edge != Edge::Open && side[1].edge != Edge::Open && std::fabs(wanted - last) < 0.75)
      g.cells = last;
    if (g.cells < 3)
      throw DivergenceError(fmt::format("at step {} the walls along axis {} are {} m apart, three cells are {} m",
                              step_, a, upper - lower, 3 * h),
        "stop before, or take a finer grid");
    g.spacing = (upper - lower) / g.cells;
  }
  grid_.set(axes);
}

template <int Dim>
void PointDynamics<Dim>::moveWalls(double dt)
{
  for (int a = 0; a < Dim; ++a)
  {
    auto& side = options_.sides[static_cast<std::size_t>(a)];
    for (int s = 0; s < 2; ++s)
      if (side[static_cast<std::size_t>(s)].edge != Edge::Open)
        side[static_cast<std::size_t>(s)].position += walls_(a, s).velocity * dt;
    if (side[0].edge != Edge::Periodic)
      continue;
    const double period = side[1].position - side[0].position;
    const double rate = walls_(a, 1).velocity;
    auto x = points_.column(a);
    auto v = points_.column(MaterialPoints<Dim>::velocities + a);
    for (std::size_t p = 0; p < points_.count(); ++p)
      if (x[p] < side[0].position)
      {
        x[p] += period;
        v[p] += rate;
      }
      else if (x[p] >= side[1].position)
      {
        x[p] -= period;
        v[p] -= rate;
      }
  }
}

template <int Dim>
double PointDynamics<Dim>::stableStep() const
{
  using Points = MaterialPoints<Dim>;
  double worst = 0; // stiffness over density [m²/s²]
#pragma omp parallel for schedule(static) reduction(max : worst)
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    const double stiffness =
      law_->stiffness(points_.phase()[p], points_.matrix(Points::deformations, p), points_.vector(Points::axes, p));
    const double ratio = stiffness * points_.column(Points::volumes)[p] / points_.column(Points::masses)[p];
    // what is not a number must come out on top
    worst = ratio <= worst ? worst : std::isfinite(ratio) ? ratio : std::numeric_limits<double>::infinity();
  }
  const double h = grid_.smallestSpacing();
  return 2 * h / std::sqrt(6 * worst) * (options_.mass == MassMatrix::Consistent ? 0.5 : 1);
}

template <int Dim>
void PointDynamics<Dim>::chooseStep()
{
  const double stable = stableStep();
  if (!(stable > 0))
    throw DivergenceError(
      fmt::format("at step {} (time {:.6g} s) a point is turned inside out or no longer finite", step_, time_),
      "take a smaller step, slower walls, or a law with a barrier against collapse");
  if (!options_.step)
    dt_ = options_.share * stable;
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
bool PointDynamics<Dim>::run(std::int64_t steps, double dt)
{
  for (std::int64_t i = 0; i < steps; ++i)
  {
    if (step_ % between == 0 && step_ > 0)
    {
      chooseStep();
      if (options_.progress && step_ % (10 * between) == 0 && options_.progress(step_, time_))
        return false;
    }
    const double now = dt > 0 ? std::min(dt, dt_) : dt_;
    generalStep(now, (before_ + now) / 2);
    moveWalls(now);
    before_ = now;
    time_ += now;
    ++step_;
    layGrid();
  }
  return true;
}

template <int Dim>
bool PointDynamics<Dim>::advance(std::int64_t steps)
{
  return run(steps, 0);
}

template <int Dim>
bool PointDynamics<Dim>::advanceTo(double time)
{
  // steps may have to shrink on the way
  while (time - time_ > 1e-9 * dt_)
  {
    const auto count = static_cast<std::int64_t>(std::ceil((time - time_) / dt_ - 1e-9));
    if (!run(std::min(count, between), (time - time_) / static_cast<double>(count)))
      return false;
  }
  return true;
}

template <int Dim>
void PointDynamics<Dim>::generalStep(double dt, double kick)
{
  supplied_ += GeneralStep<Dim>{ points_, *law_, options_, grid_, walls_, time_, dt, kick }.run();
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
      supplied_ -= walls_(a, side).force * walls_(a, side).velocity * kick;
}

template <int Dim>
double PointDynamics<Dim>::kineticEnergy() const
{
  using Points = MaterialPoints<Dim>;
  const auto mass = points_.column(Points::masses);
  const bool affine = options_.transfer == Transfer::Apic && options_.shape == Shape::QuadraticSpline;
  double sum = 0;
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    double squares = 0;
    for (int a = 0; a < Dim; ++a)
    {
      const double v = points_.column(Points::velocities + a)[p];
      squares += v * v;
      for (int b = 0; b < Dim && affine; ++b)
      {
        const double c = points_.column(Points::affines + a * Dim + b)[p] * grid_.axis(b).spacing;
        squares += c * c / 4;
      }
    }
    sum += mass[p] * squares / 2;
  }
  return sum;
}

template <int Dim>
double PointDynamics<Dim>::elasticEnergy() const
{
  using Points = MaterialPoints<Dim>;
  double sum = 0;
  for (std::size_t p = 0; p < points_.count(); ++p)
    sum += points_.column(Points::volumes)[p] *
      law_->energy(points_.phase()[p], points_.matrix(Points::deformations, p), points_.vector(Points::axes, p));
  return sum;
}

template <int Dim>
PointEnergies PointDynamics<Dim>::energies() const
{
  return { kineticEnergy(), elasticEnergy(), supplied_, initial_ };
}

template class PointDynamics<2>;
template class PointDynamics<3>;

} // namespace lamella::mpm
