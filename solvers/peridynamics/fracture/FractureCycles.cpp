// A load that turns round. All is in proportion to the load while that keeps its sign and nothing breaks, so from break
// to break, to a turning point or through 0 the curve is straight, and what is unloaded goes back to 0 as it came.
#include "peridynamics/fracture/Fracture.h"
#include "peridynamics/fracture/FractureEngine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::peridynamics
{
namespace
{

constexpr double sameLoad = 1e-9;   // relative: elongations have fewer digits
constexpr double noticeable = 1e-3; // of the first break's s/s₀ at unit load: less is what equilibria leave

/// Elastic energy of a volume, of a state that is in proportion to its load [J/m³].
double held(double strain, double stress)
{
  return 0.5 * strain * stress;
}

} // namespace

void QuasiStaticFracture::moveTo(double load)
{
  const auto broken = static_cast<std::int64_t>(record_.broken.size());
  const CurvePoint before{ strain(), stress(load_), broken };
  if (const auto& c = record_.curve;
      c.empty() || c.back().strain != before.strain || c.back().stress != before.stress || c.back().broken != broken)
    record_.curve.push_back(before); // what the breaks left, or the unloaded sample
  load_ = load;
  ++record_.statistics.raises;
  const CurvePoint now{ strain(), stress(load_), broken };
  record_.curve.push_back(now);
  branch_.work += 0.5 * (now.stress + before.stress) * (now.strain - before.strain);
  if (now.stress > record_.peak.stress)
    record_.peak = now;
  if (now.stress < record_.trough.stress)
    record_.trough = now;
}

void QuasiStaticFracture::turnBack()
{
  double before = 0; // that the sample held
  auto broken = static_cast<std::int64_t>(record_.broken.size());
  if (!record_.branches.empty())
  {
    const LoadBranch& last = record_.branches.back();
    before = held(last.to, last.stress);
  }
  for (const LoadBranch& b : record_.branches)
    broken -= b.broken;
  branch_.to = strain();
  branch_.stress = stress(load_);
  branch_.modulus = load_ > 0 ? branch_.stress / branch_.to : std::numeric_limits<double>::quiet_NaN();
  branch_.released = branch_.work + before - held(branch_.to, branch_.stress);
  branch_.broken = broken;
  record_.branches.push_back(branch_);
  branch_ = {};
  branch_.from = strain();
  ++turns_;
}

// Running: an event took place, or the load went on.
FractureEnd QuasiStaticFracture::stepOnBranch()
{
  if (!engine_->holds() && !contact_)
    return FractureEnd::Severed; // it would bear nothing the other way, either
  if (static_cast<std::int64_t>(record_.broken.size()) >= options_.maxBroken)
    return FractureEnd::MaxBroken;
  const StretchMaximum most = engine_->mostCritical();
  // else only platens are strained, which are as the mean strain has it
  const bool breakable = engine_->holds() && most.ratio > 0 && most.ratio > noticeable * firstRatio_;
  if (!breakable || load_ * most.ratio < 1 - sameLoad)
  {
    if (turns_ == options_.turningPoints.size())
      return FractureEnd::LastTurn;
    const double target = direction_ * options_.turningPoints[turns_] / reference_; // along the load as it is now
    const double aim = std::max(0.0, target);                                       // this side of 0
    if (!(aim > load_ && breakable && 1 / most.ratio <= aim))
    {
      if (aim != load_)
        moveTo(aim);
      if (target >= 0)
        turnBack();
      else
      {
        engine_->turn();
        direction_ = -direction_;
      }
      return report() ? FractureEnd::Interrupted : FractureEnd::Running;
    }
    moveTo(1 / most.ratio);
    if (record_.broken.empty())
    {
      firstRatio_ = most.ratio;
      record_.first = record_.curve.back();
    }
  }
  breakCritical(most);
  return report() ? FractureEnd::Interrupted : FractureEnd::Running;
}

} // namespace lamella::peridynamics
