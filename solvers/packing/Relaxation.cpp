#include "packing/Relaxation.h"

#include "core/Error.h"

#include <algorithm>
#include <cmath>

namespace lamella::packing
{
namespace
{

// Below 2/ω of a grain with twelve contacts; smooth disks have six at most.
constexpr double longestStep = 0.25;
constexpr double longestStepOfDisks = 0.45;
constexpr double shortestStep = 1e-3;
constexpr double mixing = 0.25;

template <int Dim>
double inertia(const GrainSystem<Dim>& g, std::size_t i)
{
  return (Dim == 2 ? 0.5 : 0.4) * g.radius[i] * g.radius[i];
}

/// Force times velocity, and squares of both over and times the mass, of grains and box.
struct Motion
{
  double power = 0;
  double forces = 0;
  double speeds = 0;
};

template <int Dim, class Force, class Velocity>
Motion motionOf(const GrainSystem<Dim>& g, const Force& force, const Velocity& velocity,
  const typename GrainSystem<Dim>::Vec& onBox, double boxMass)
{
  Motion m;
  m.power = onBox.dot(g.boxRate);
  m.forces = onBox.squaredNorm() / boxMass;
  m.speeds = g.boxRate.squaredNorm() * boxMass;
  m.power += force.dot(velocity);
  m.forces += force.squaredNorm();
  m.speeds += velocity.squaredNorm();
  if (g.friction > 0)
    for (std::size_t i = 0; i < g.count(); ++i)
    {
      m.power += g.torque[i].dot(g.spin[i]);
      m.forces += g.torque[i].squaredNorm() / inertia<Dim>(g, i);
      m.speeds += g.spin[i].squaredNorm() * inertia<Dim>(g, i);
    }
  return m;
}

/// Half a step back, then from rest.
template <int Dim>
void stepBack(GrainSystem<Dim>& g, double dt)
{
  for (std::size_t i = 0; i < g.count(); ++i)
  {
    g.position[i] -= 0.5 * dt * g.velocity[i];
    g.velocity[i].setZero();
    g.spin[i].setZero();
  }
  g.strain((-0.5 * dt * g.boxRate).array().exp());
  g.boxRate.setZero();
}

/// What drives the box.
template <int Dim>
typename GrainSystem<Dim>::Vec forceOnBox(const GrainSystem<Dim>& g, const RelaxationOptions& options)
{
  using Vec = typename GrainSystem<Dim>::Vec;
  if (options.box == BoxMotion::Fixed)
    return Vec::Zero();
  const Vec each = g.virial - options.pressure * g.volume() * wallShares<Dim>(g, options);
  if (options.box == BoxMotion::EachAxis)
    return each;
  return Vec::Constant(each.mean());
}

} // namespace

template <int Dim>
RelaxationResult relax(GrainSystem<Dim>& g, const RelaxationOptions& options)
{
  using Vec = typename GrainSystem<Dim>::Vec;
  using Spin = typename GrainSystem<Dim>::Spin;
  const std::size_t n = g.count();
  const bool rubs = g.friction > 0;
  // about the stiffness of the box over that of a grain, so that both move at one pace
  const double boxMass = 0.5 * static_cast<double>(n);

  std::fill(g.velocity.begin(), g.velocity.end(), Vec::Zero());
  std::fill(g.spin.begin(), g.spin.end(), Spin::Zero());
  g.boxRate.setZero();
  g.computeForces(0);

  // all components in a row
  const auto flat = [n](std::vector<Vec>& values)
  { return Eigen::Map<Eigen::VectorXd>(values.data()->data(), static_cast<Eigen::Index>(n) * Dim); };
  auto position = flat(g.position);
  auto velocity = flat(g.velocity);
  const auto force = flat(g.force);

  const bool smoothDisks = Dim == 2 && !rubs;
  const double longest = smoothDisks ? longestStepOfDisks : longestStep;
  const double calmer = smoothDisks ? 0.98 : 0.99; // of the mixing, a step
  double dt = 0.5 * longest;
  double alpha = mixing;
  int downhill = 0;
  RelaxationResult result;
  for (; result.steps < options.maxSteps; ++result.steps)
  {
    if (options.watch)
      options.watch(result.steps);
    const Vec onBox = forceOnBox(g, options);
    const double pressureError =
      options.box == BoxMotion::Fixed ? 0 : onBox.cwiseAbs().maxCoeff() / (options.pressure * g.volume());
    const bool apart = options.box == BoxMotion::Fixed && g.forceSum <= options.negligible * static_cast<double>(n);
    const bool asked = !smoothDisks || result.steps % 8 == 0; // square roots of all forces: not every step
    if (apart || (asked && pressureError <= options.tolerance && g.unbalanced() <= options.tolerance))
    {
      result.atRest = true;
      break;
    }
    if (options.interrupted && result.steps % 64 == 0 && options.interrupted())
      throw Cancelled();

    auto [power, forces, speeds] = motionOf<Dim>(g, force, velocity, onBox, boxMass);
    if (power >= 0)
    {
      if (++downhill > 20)
      {
        dt = std::min(1.1 * dt, longest);
        alpha *= calmer;
      }
    }
    else
    {
      downhill = 0;
      dt = std::max(0.5 * dt, shortestStep);
      alpha = mixing;
      stepBack(g, dt);
      speeds = 0;
    }
    const double turn = forces > 0 ? alpha * std::sqrt(speeds / forces) : 0;
    velocity = (1 - alpha) * velocity + ((1 - alpha) * dt + turn) * force;
    position += dt * velocity;
    if (rubs)
      for (std::size_t i = 0; i < n; ++i)
        g.spin[i] =
          (1 - alpha) * (g.spin[i] + dt / inertia<Dim>(g, i) * g.torque[i]) + turn / inertia<Dim>(g, i) * g.torque[i];
    if (options.box != BoxMotion::Fixed)
    {
      g.boxRate = (1 - alpha) * (g.boxRate + dt / boxMass * onBox) + turn / boxMass * onBox;
      g.strain((dt * g.boxRate).array().exp());
    }
    g.computeForces(dt);
  }
  return result;
}

template RelaxationResult relax<2>(GrainSystem<2>&, const RelaxationOptions&);
template RelaxationResult relax<3>(GrainSystem<3>&, const RelaxationOptions&);

} // namespace lamella::packing
