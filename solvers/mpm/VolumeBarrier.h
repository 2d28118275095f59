#pragma once

#include <cmath>

namespace lamella::mpm
{

/// What keeps a point from being crushed to nothing: the energy density κ d⁴/J, d = max(1 − J, 0), over initial volume.
/// It and its first three derivatives vanish at J = 1, so small strains do not know of it; its pressure κ d³(3J + 1)/J²
/// grows without bound, ever faster, as J → 0. Tension is left alone. κ [Pa] comes with every call.
struct VolumeBarrier
{
  /// [J/m³]
  template <class Real>
  [[nodiscard]] static Real energy(const Real& modulus, const Real& J)
  {
    const Real d = depth(J);
    return modulus * d * d * d * d / J;
  }

  /// J times the derivative of the energy: the part of the Kirchhoff stress along the identity [Pa], 0 or negative.
  template <class Real>
  [[nodiscard]] static Real kirchhoff(const Real& modulus, const Real& J)
  {
    const Real d = depth(J);
    return -(modulus * d * d * d * (3.0 * J + 1.0) / J);
  }

  /// J² times the second derivative [Pa].
  template <class Real>
  [[nodiscard]] static Real stiffness(const Real& modulus, const Real& J)
  {
    const Real d = depth(J);
    return modulus * d * d * (12.0 * J * J + 8.0 * d * J + 2.0 * d * d) / J;
  }

private:
  // (|x| + x)/2: no branch
  template <class Real>
  [[nodiscard]] static Real depth(const Real& J)
  {
    using std::abs;
    const Real x = 1.0 - J;
    return 0.5 * (abs(x) + x);
  }
};

} // namespace lamella::mpm
