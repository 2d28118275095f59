#pragma once

#include "mpm/PointMatrix.h"

namespace lamella::mpm
{

/// What keeps a point from being crushed to nothing: the energy density κ d⁴/J, d = max(1 − J, 0), per initial volume.
/// It and its first three derivatives vanish at J = 1, so small strains do not know of it; pressure is κ d³(3J + 1)/J²
/// and grows without bound, ever faster, as J → 0. Tension is left alone.
struct VolumeBarrier
{
  double modulus = 0; ///< κ [Pa]

  /// [J/m³]
  template <class Real>
  LAMELLA_POINT_INLINE Real energy(Real j) const
  {
    const Real d = depth(j);
    return Real(modulus) * d * d * d * d / j;
  }

  /// J times the derivative of the energy: the part of the Kirchhoff stress along the identity [Pa], 0 or negative.
  template <class Real>
  LAMELLA_POINT_INLINE Real kirchhoff(Real j) const
  {
    const Real d = depth(j);
    return -Real(modulus) * d * d * d * (3 * j + 1) / j;
  }

  /// J² times the second derivative [Pa].
  template <class Real>
  LAMELLA_POINT_INLINE Real waveModulus(Real j) const
  {
    const Real d = depth(j);
    return Real(modulus) * d * d * (12 * j * j + 8 * d * j + 2 * d * d) / j;
  }

private:
  // (|x| + x)/2: no branch
  template <class Real>
  LAMELLA_POINT_INLINE static Real depth(Real j)
  {
    const Real x = 1 - j;
    return Real(0.5) * (std::abs(x) + x);
  }
};

} // namespace lamella::mpm
