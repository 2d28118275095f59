#pragma once

#include "lattice/Decomposition.h"
#include "lbm/Links.h"
#include "lbm/SteadyDiffusion.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// Sums that threads may make at once, of as many parts of a block: the same sums, whatever their number.
inline constexpr std::int64_t sumParts = 16;

/// What both methods work on: one direction of one box, this rank's part of it.
struct Problem
{
  const Lattice& lattice;
  const Decomposition& parts;
  const Communicator& comm;
  const SteadyOptions& options;
  std::span<const std::uint8_t> phase; ///< parts.block().count() ids
  std::span<const double> diffusivity; ///< one a phase id
  int axis = 0;
  const LinkTable* table = nullptr; ///< of the whole lattice, or none

  [[nodiscard]] Links links() const
  {
    return { lattice, options.stencil, boundary(), diffusivity, table, options.pairs.get() };
  }
  [[nodiscard]] std::array<Boundary, 3> boundary() const
  {
    const Boundary side = options.sides == Sides::Insulated ? Boundary::Insulated : Boundary::Periodic;
    std::array<Boundary, 3> b{ side, side, side };
    if (options.sides != Sides::Periodic)
      b[axis] = Boundary::Fixed;
    return b;
  }
  [[nodiscard]] std::array<bool, 3> periodic() const
  {
    const auto wraps = [b = boundary()](int a) { return b[a] == Boundary::Periodic; };
    return { wraps(0), wraps(1), wraps(2) && lattice.dimension == 3 };
  }
  /// Largest over least of what conducts: phases, or links where they are given one by one.
  [[nodiscard]] double contrast() const;
};

/// Where the energy of a field is, in any unit.
struct FieldEnergies
{
  /// Of links by the ids at their ends, [a * ids + b] with a ≤ b, of those to walls by the node's at both; by axis as
  /// the table of pairs is (Links::tables).
  std::vector<double> links;
  /// Of elements, by id: what the field has per unit of the diffusivity along the axis, and of that across.
  std::vector<double> along, across;
};

/// One way of solving the system of one direction.
class Backend
{
public:
  virtual ~Backend() = default;
  /// Iterates until the tolerances are met. Fills all of the result but the seconds.
  virtual SteadyResult solve() = 0;
  /// Of layers of this rank's block. The first one after a solve is collective.
  virtual void value(std::span<double> out, Layers layers) const = 0;
  virtual void flux(std::span<double> out, Layers layers) const = 0;
  /// Whether planes of the field may be asked for one by one, which takes no memory for the others.
  [[nodiscard]] virtual bool hasPlanes() const { return false; }
  /// Values of the plane z = −1 … nz of this rank's block, with a ghost around: (nx + 2)(ny + 2) of them; as BoxField
  /// has them, in a periodic cell without the linear profile. Ghosts beyond the box's faces say nothing.
  virtual void plane(std::int64_t /*z*/, double* /*out*/) const {}
  /// Of the field, all ranks'. Collective.
  [[nodiscard]] virtual FieldEnergies energies() const = 0;
  /// What surfaceDerivatives() tells, of elements with tensors, which go with the surfaces; nothing of others.
  /// Collective.
  [[nodiscard]] virtual std::optional<SurfaceDerivatives> surfaces() const { return std::nullopt; }
};

/// Energies of a field that a backend without one of its own in double has.
[[nodiscard]] FieldEnergies energiesOf(const Problem& problem, const Backend& backend);

/// Turns sums over all ranks into effective properties (result.effective, inletFlux, outletFlux, balance).
void setEffective(SteadyResult& result, const FieldSums& sums, const Lattice& lattice, int axis, double scale);

/// What a link's flux, scaled, is to be multiplied by to be one through its area, by axis.
[[nodiscard]] std::array<double, 3> fluxUnits(const Links& links, const Lattice& lattice) noexcept;

/// Cancels when the progress callback of any rank says so.
void reportProgress(const SteadyOptions& options, const Communicator& comm, double fraction, const char* what);

/// Share of the way from an error of 1 to the one that is wanted, on a logarithmic scale.
[[nodiscard]] double progressOf(double error, double wanted);

} // namespace lamella::lbm
