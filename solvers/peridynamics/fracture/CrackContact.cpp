#include "peridynamics/fracture/CrackContact.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/RimExchange.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{

void CrackContact::watch(const Bond& bond, int kind)
{
  const auto own = bonds_.layout().ownedIndex(bond.node);
  if (!own)
    return;
  Spring s;
  s.bond = bond;
  s.i = *own;
  s.j = *own + bonds_.jump(bond.offset);
  s.kind = kind > 0 ? kind : bonds_.kind(s.i, bond.offset);
  s.stiffness = bonds_.springConstant(s.i, bond.offset, s.kind);
  s.length = bonds_.stencil().half()[static_cast<std::size_t>(bond.offset)].length * bonds_.spacing();
  springs_.push_back(s);
}

void CrackContact::watch(std::span<const Bond> bonds)
{
  for (const Bond& b : bonds)
    watch(b, 0);
}

void CrackContact::watch(std::span<const KnownBond> bonds)
{
  for (const KnownBond& b : bonds)
    watch(b.bond, b.kind);
}

bool CrackContact::watched(const Bond& bond) const
{
  return bonds_.communicator().any(std::ranges::any_of(
    springs_, [&](const Spring& s) { return s.bond == bond; }));
}

double CrackContact::elongation(const Spring& s, const NodeField<double>& u) const
{
  const Offset& o = bonds_.stencil().half()[static_cast<std::size_t>(s.bond.offset)];
  double along = 0;
  for (int c = 0; c < u.components(); ++c)
    along += o.step[static_cast<std::size_t>(c)] * (u.component(c)[s.j] - u.component(c)[s.i]);
  return along / o.length;
}

template <class Closed>
std::int64_t CrackContact::set(Closed&& closed)
{
  std::vector<KnownBond> closing;
  std::vector<Bond> opening;
  for (Spring& s : springs_)
  {
    const bool to = closed(s);
    if (to && !s.closed)
      closing.push_back({ s.bond, s.kind });
    else if (!to && s.closed)
      opening.push_back(s.bond);
    s.closed = to;
  }
  return bonds_.restoreBonds(closing) + bonds_.breakBonds(opening);
}

std::int64_t CrackContact::follow(const NodeField<double>& u)
{
  return set([&](const Spring& s) { return elongation(s, u) < 0; });
}

double CrackContact::violation(const NodeField<double>& u) const
{
  double most = 0;
  for (const Spring& s : springs_)
  {
    const double strain = elongation(s, u) / s.length;
    most = std::max(most, s.closed ? strain : -strain);
  }
  return bonds_.communicator().max(most);
}

double CrackContact::lower(const NodeField<double>& from, NodeField<double>& u) const
{
  NodeField<double> d = u;
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      d.component(c)[i] -= from.component(c)[i];
  const double bent = 2 * elasticEnergy(bonds_, d, false);
  if (!(bent > 0))
    return 0;
  // Along the way the energy's slope is (t − 1) dᵀKd, but for the bonds that open or close.
  struct Way
  {
    double stiffness;
    double from;
    double by;
    bool closed;
  };
  std::vector<Way> ways;
  for (const Spring& s : springs_)
    ways.push_back({ s.stiffness, elongation(s, from), elongation(s, d), s.closed });
  const auto slope = [&](double t)
  {
    double sum = 0;
    for (const Way& w : ways)
    {
      const double g = w.from + t * w.by;
      if ((g < 0) != w.closed)
        sum += (w.closed ? -1 : 1) * w.stiffness * g * w.by;
    }
    return (t - 1) * bent + bonds_.communicator().sum(sum);
  };
  // It never falls, and rises for good in the end.
  double low = 0;
  double high = 1;
  double atHigh = slope(high);
  constexpr double farthest = 1024; // where it has not risen yet bonds without end open: the next step goes on
  while (atHigh < 0 && high < farthest)
  {
    low = high;
    high *= 2;
    atHigh = slope(high);
  }
  if (low > 0 || atHigh > 0)
    for (int halvings = 0; halvings < 30 && atHigh > 0; ++halvings)
    {
      const double middle = 0.5 * (low + high);
      const double now = slope(middle);
      (now > 0 ? high : low) = middle;
      if (now > 0)
        atHigh = now;
    }
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      u.component(c)[i] = from.component(c)[i] + high * d.component(c)[i];
  return bent;
}

std::vector<Bond> CrackContact::closed() const
{
  std::vector<std::int64_t> mine;
  for (const Spring& s : springs_)
    if (s.closed)
      mine.insert(mine.end(), { s.bond.node[0], s.bond.node[1], s.bond.node[2], s.bond.offset });
  const std::vector<std::int64_t> all = gather(bonds_.communicator(), mine, 4);
  std::vector<Bond> list;
  for (std::size_t k = 0; k < all.size(); k += 4)
    list.push_back({ { all[k], all[k + 1], all[k + 2] }, static_cast<int>(all[k + 3]) });
  std::sort(list.begin(), list.end());
  return list;
}

void CrackContact::close(std::span<const Bond> bonds)
{
  std::vector<Bond> sorted(bonds.begin(), bonds.end());
  std::sort(sorted.begin(), sorted.end());
  set([&](const Spring& s) { return std::binary_search(sorted.begin(), sorted.end(), s.bond); });
}

} // namespace lamella::peridynamics
