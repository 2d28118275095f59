#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// Unilateral contact of crack faces, bond by bond: a bond that is gone carries compression as it did before where its
/// ends are nearer to each other than at first (it is closed), and nothing else where they are not (it is open). A
/// closed bond is in the lattice, an open one is not.
///
/// With g the linearised elongations and K₀ the bonds that are whole, displacements minimise
/// ½ uᵀK₀u + ½ Σ k/|ξ| min(0, g)² over all that have the imposed components: convex, quadratic in pieces, its gradient
/// continuous. So the force is unique, whatever broke first, and since no bond has a gap at no load the minimum is in
/// proportion to a load that keeps its sign, closed bonds and all. It is found by Newton's method with an exact line
/// search (J. Sun, Math. Program. 76 (1997) 451); a Newton step is an equilibrium with the bonds that are closed now.
class CrackContact
{
public:
  /// @param bonds must outlive this
  explicit CrackContact(BondLattice& bonds)
    : bonds_(bonds)
  {
  }

  /// Bonds that are whole and are to break. Every rank names all of them.
  void watch(std::span<const Bond> bonds);
  /// Bonds that are not in the lattice. Likewise.
  void watch(std::span<const KnownBond> bonds);

  /// Puts bonds back or takes them out as a state has it. Collective.
  /// @param u rim filled
  /// @return how many, of all ranks
  std::int64_t follow(const NodeField<double>& u);
  /// Largest strain by which a closed bond is longer than at first, or an open one shorter; 0 where none is.
  /// Collective.
  [[nodiscard]] double violation(const NodeField<double>& u) const;
  /// The state of least energy on the way from one to the equilibrium of the bonds that are closed there.
  /// @param from which follow() was last called with
  /// @param u in: that equilibrium; out: from + t (u − from), t > 0
  /// @return (u − from)ᵀ K (u − from), twice the energy that the quadratic of `from` would lose. Collective.
  double lower(const NodeField<double>& from, NodeField<double>& u) const;

  /// The bonds that are closed now, in order; the same on every rank. Collective.
  [[nodiscard]] std::vector<Bond> closed() const;
  /// Closes these in place of those that are. Every rank names all of them. Collective.
  void close(std::span<const Bond> bonds);
  /// Has this bond been named? Collective.
  [[nodiscard]] bool watched(const Bond& bond) const;
  [[nodiscard]] std::int64_t bytes() const noexcept
  {
    return static_cast<std::int64_t>(springs_.capacity() * sizeof(Spring));
  }

private:
  /// A bond that is gone, of which this rank owns the first node.
  struct Spring
  {
    Bond bond;
    int kind = 0;
    std::int64_t i = 0; ///< of the layout
    std::int64_t j = 0;
    double stiffness = 0; ///< k/|ξ|
    double length = 0;    ///< |ξ|
    bool closed = false;
  };
  void watch(const Bond& bond, int kind);
  /// e·η
  [[nodiscard]] double elongation(const Spring& s, const NodeField<double>& u) const;
  /// Opens and closes bonds until s.closed is what this says. Collective. @return how many, of all ranks
  template <class Closed>
  std::int64_t set(Closed&& closed);

  BondLattice& bonds_;
  std::vector<Spring> springs_; ///< in the order in which they were named
};

} // namespace lamella::peridynamics
