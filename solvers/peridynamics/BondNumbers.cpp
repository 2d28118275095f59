#include "peridynamics/BondNumbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::peridynamics
{

template <class Real>
BondNumbers<Real>::BondNumbers(const BondLattice& bonds, int only)
  : perKind(bonds.stencil().half().size())
  , safe(Real(1) / 16) // the range of the series in RowKernelsImpl.cpp
{
  const auto& kinds = bonds.kinds();
  const double spacing = bonds.spacing();
  const auto stiffnessOf = [&](std::size_t k)
  { return only == 0 || k == static_cast<std::size_t>(only) ? kinds[k].stiffness : 0; };
  for (std::size_t k = 0; k < kinds.size(); ++k)
  {
    for (const Offset& o : bonds.stencil().half())
    {
      const double force = o.weight * (k == 0 ? 1 : stiffnessOf(k));
      OffsetNumbers<Real> n{};
      const double length = o.length * spacing;
      for (std::size_t c = 0; c < 3; ++c)
      {
        n.step[c] = static_cast<Real>(o.step[c]);
        n.xi[c] = static_cast<Real>(o.step[c] * spacing);
        n.linear[c] = static_cast<Real>(force * o.step[c] / (spacing * o.length * o.length * o.length));
      }
      for (std::size_t c = 0; c < 3; ++c)
        n.halfSquare[c] = static_cast<Real>(0.5 * o.step[c] * o.step[c] / (o.length * o.length));
      n.inverseSquare = static_cast<Real>(1 / (length * length));
      n.spring = static_cast<Real>(force / length);
      offsets.push_back(n);
    }
  }
  const std::size_t room = std::max<std::size_t>(256, kinds.size());
  const Real never = std::numeric_limits<Real>::max();
  stiffness.assign(room, 0);
  critical.assign(room, never);
  inverse.assign(room, 0);
  for (std::size_t k = 1; k < kinds.size(); ++k)
  {
    const double s0 = kinds[k].criticalStretch;
    stiffness[k] = static_cast<Real>(stiffnessOf(k));
    const double q = s0 * (2 + s0);
    critical[k] = q < static_cast<double>(never) ? static_cast<Real>(q) : never;
    inverse[k] = static_cast<Real>(1 / s0);
    safe = std::min(safe, critical[k]);
  }
}

template struct BondNumbers<double>;
template struct BondNumbers<float>;

} // namespace lamella::peridynamics
