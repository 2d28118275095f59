#pragma once

#include "peridynamics/BondLattice.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

/// Sums over the bonds of a lattice. Each is a template of float and double. Fields have the layout of the lattice; the
/// rim of what is read must be up to date (BondLattice::exchange), what is written is written for owned nodes only
/// (the rim of it is zero or left as it was). None allocates more than a few rows a thread; all use OpenMP's threads. A
/// sum at a node, and so every force, is the same to the last bit for any number of threads and ranks; where the rim is
/// exchanged meanwhile, for any number of threads, and to round-off for any number of ranks.
///
/// With k the stiffness of a bond (BondKind, surface correction included), ξ its vector, e = ξ/|ξ|, η = uⱼ − uᵢ:
/// linearised  f = (k/|ξ|) (e·η) e;   nonlinear  f = k (|ξ+η| − |ξ|)/|ξ| (ξ+η)/|ξ+η|.
namespace lamella::peridynamics
{

/// fᵢ = Σ f over the bonds of i: the force on each node [N], [N/m] in the plane. With K the stiffness matrix, f = −K u.
template <class Real>
void linearForce(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f);

/// The same on the layers first ≤ layer < last along the slowest axis (y in 2D, z in 3D) alone: of u those within the
/// horizon of them must be up to date; of f the others are left as they are.
template <class Real>
void linearForceOfLayers(
  const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f, std::int64_t first, std::int64_t last);

/// The same where the rim of u is not up to date: it is filled while the bonds between this rank's own nodes are
/// summed; those that lead to other ranks come last. Collective.
template <class Real>
void exchangeAndLinearForce(const BondLattice& bonds, NodeField<Real>& u, NodeField<Real>& f);

/// linearForce() were there no bonds but those of one kind.
void linearForceOfKind(const BondLattice& bonds, const NodeField<double>& u, int kind, NodeField<double>& f);

struct StretchMaximum
{
  double ratio = 0;           ///< the largest s/s₀ in tension; 0 where no bond is stretched or none can break
  std::optional<Bond> bond{}; ///< its bond, the same on every rank; the first in order where several are equal
};

/// What the check found among the bonds whose first node this rank owns. Not summed over ranks: that would make all
/// wait for each other once more a pass; callers that want the sum take it with their other sums.
struct CriticalBonds
{
  std::int64_t count = 0;    ///< bonds with s > s₀
  std::vector<Bond> bonds{}; ///< these, in order; only when asked for
};

/// The nonlinear force, and the bonds beyond their critical elongation. Exact for large rotations, and without loss of
/// digits for small strains.
/// @param list whether to name the critical bonds, else they are only counted
template <class Real>
CriticalBonds nonlinearForce(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f, bool list = false);

/// The same where the rim of u is not up to date. Collective.
template <class Real>
CriticalBonds exchangeAndNonlinearForce(
  const BondLattice& bonds, NodeField<Real>& u, NodeField<Real>& f, bool list = false);

/// The largest s/s₀ of a state: s = e·η/|ξ|, linearised, or (|ξ+η| − |ξ|)/|ξ|. Of a linear solution the first bond
/// breaks at 1/ratio times its load. Collective.
template <class Real>
[[nodiscard]] StretchMaximum largestStretch(const BondLattice& bonds, const NodeField<Real>& u, bool nonlinear);

/// The largest linearised s/s₀ among the bonds whose first node lies in a box of owned nodes [low, high).
template <class Real>
[[nodiscard]] StretchMaximum largestStretchWithin(const BondLattice& bonds, const NodeField<Real>& u,
  const std::array<std::int64_t, 3>& low, const std::array<std::int64_t, 3>& high);

/// Σ over bonds of ½ k s² |ξ| [J], [J/m] in the plane. Collective.
template <class Real>
[[nodiscard]] double elasticEnergy(const BondLattice& bonds, const NodeField<Real>& u, bool nonlinear);

/// Half of the energy of a node's bonds over its volume [J/m³]; `density` has one component.
template <class Real>
void energyDensity(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& density, bool nonlinear);

/// σᵢ = 1/(2 δx^d) Σ f ⊗ (ξ+η) over the bonds of i [Pa]; linearised: f ⊗ ξ. `stress` has 3 components in 2D (xx, yy,
/// xy) and 6 in 3D (xx, yy, zz, xy, yz, xz: VTK's order).
template <class Real>
void nodalStress(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& stress, bool nonlinear);

/// Force that the nodes above a plane between two layers exert on those below, through the bonds that cross it [N],
/// [N/m] in the plane: the section's traction times its area, positive in tension. Collective.
/// @param axis normal of the plane
/// @param layer of the whole lattice: the plane lies between `layer` - 1 and `layer`
template <class Real>
[[nodiscard]] std::array<double, 3> sectionForce(
  const BondLattice& bonds, const NodeField<Real>& u, int axis, std::int64_t layer, bool nonlinear);

/// Sum of a field of forces over the layers [first, last) of the whole lattice along an axis. Collective.
template <class Real>
[[nodiscard]] std::array<double, 3> layerSum(
  const BondLattice& bonds, const NodeField<Real>& f, int axis, std::int64_t first, std::int64_t last);

/// Diagonal blocks of K: Σ (k/|ξ|) e ⊗ e over the bonds of a node, components as nodalStress.
template <class Real>
void diagonalBlocks(const BondLattice& bonds, NodeField<Real>& blocks);

/// q = −K(u) p with the tangent stiffness of the nonlinear force at u; linearForce() when u = 0.
template <class Real>
void tangentProduct(const BondLattice& bonds, const NodeField<Real>& u, const NodeField<Real>& p, NodeField<Real>& q);

} // namespace lamella::peridynamics
