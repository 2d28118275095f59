// What a record of broken bonds says of the whole run.
#include "peridynamics/fracture/FractureStudy.h"

#include <cmath>
#include <limits>

namespace lamella::peridynamics
{

std::vector<FractureCurvePoint> fractureCurve(const FractureRecord& record)
{
  std::vector<FractureCurvePoint> points{ {} };
  auto state = record.curve.begin();
  const auto statesUpTo = [&](std::int64_t broken, double before)
  {
    for (; state != record.curve.end() && state->broken <= broken; ++state)
    {
      const bool last = state + 1 == record.curve.end() || (state + 1)->broken > broken;
      if (last && state->broken == broken && state->strain == before)
        continue;                                              // that to which the load was raised is the event's own
      if (state != record.curve.begin() || state->strain != 0) // the unloaded sample is there
        points.push_back({ state->strain, state->stress, state->broken, state->strain, state->stress });
    }
  };
  for (std::size_t i = 0; i < record.broken.size();)
  {
    const BrokenBond& first = record.broken[i];
    statesUpTo(static_cast<std::int64_t>(i), first.strain);
    std::size_t end = i;
    double critical = first.criticalStrain;
    for (; end < record.broken.size() && record.broken[end].event == first.event; ++end)
      if (std::abs(record.broken[end].criticalStrain) < std::abs(critical))
        critical = record.broken[end].criticalStrain;
    points.push_back(
      { first.strain, first.stress, static_cast<std::int64_t>(i), critical, first.stress * critical / first.strain });
    i = end;
  }
  statesUpTo(static_cast<std::int64_t>(record.broken.size()), std::numeric_limits<double>::quiet_NaN());
  return points;
}

std::array<double, 3> middleOf(const Lattice& lattice, const Stencil& stencil, const Bond& bond)
{
  const Offset& o = stencil.half()[static_cast<std::size_t>(bond.offset)];
  std::array<double, 3> middle{ lattice.origin[0], lattice.origin[1], lattice.origin[2] };
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    middle[a] += lattice.spacing * (static_cast<double>(bond.node[a]) + 0.5 * o.step[a]);
  return middle;
}

double brokenEnergy(const BondLattice& bonds, const BondModel& model, const std::vector<BrokenBond>& broken,
  const std::vector<BondEnds>& ends)
{
  const NodeLayout& l = bonds.layout();
  const BondKinds kinds(model, bonds.stencil(), bonds.spacing());
  double sum = 0;
  for (std::size_t b = 0; b < broken.size(); ++b)
  {
    const auto own = l.ownedIndex(broken[b].bond.node);
    if (!own)
      continue;
    const int offset = broken[b].bond.offset;
    const BondEnds& e = ends[b];
    const int kind = model.pairByGrain && e.betweenGrains ? kinds.between(e.low, e.high) : kinds.within(e.low, e.high);
    const double length = bonds.stencil().half()[static_cast<std::size_t>(offset)].length * bonds.spacing();
    const double extension = kinds.kinds()[static_cast<std::size_t>(kind)].criticalStretch * length;
    sum += 0.5 * bonds.springConstant(*own, offset, kind) * extension * extension;
  }
  return bonds.communicator().sum(sum);
}

} // namespace lamella::peridynamics
