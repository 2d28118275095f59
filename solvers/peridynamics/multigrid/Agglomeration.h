#pragma once

#include "core/Communicator.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// How a lattice that is cut into slabs goes on as thicker slabs on fewer ranks, and what was found there comes back:
/// coarse levels can be halved further so, however thin their slabs had become. Members that move fields are collective
/// over the ranks of the thinner slabs.
class Agglomeration
{
public:
  /// How many slabs to make of a lattice: each can be halved twice, and there are no more of them than ranks.
  /// @param reach of a matrix on the lattice half as fine
  [[nodiscard]] static std::int64_t slabs(std::int64_t layers, int reach, const Communicator& comm) noexcept;

  /// Collective.
  /// @param part one rank's slab, cut along the slowest axis
  /// @param comm of the ranks, in the slabs' order; must outlive this
  /// @param slabs that there shall be, at least two
  Agglomeration(const NodeLayout& part, const Communicator& comm, std::int64_t slabs);
  ~Agglomeration();
  Agglomeration(const Agglomeration&) = delete;
  Agglomeration& operator=(const Agglomeration&) = delete;

  /// Has this rank one of the thicker slabs?
  [[nodiscard]] bool leads() const noexcept { return comm_.handle() != MPI_COMM_NULL; }
  /// Of those who have one, in their order; only for these.
  [[nodiscard]] const Communicator& comm() const noexcept { return comm_; }
  /// Layout of this rank's, of a field like the part's; only where it has one.
  [[nodiscard]] NodeLayout layout() const;

  /// Own layers of some components of the thin slabs into those of the thick ones.
  /// @param whole null where this rank has none
  void gather(const NodeField<float>& part, NodeField<float>* whole, int first, int count) const;
  /// The way back of all components.
  void spread(const NodeField<float>* whole, NodeField<float>& part) const;

private:
  /// Layers of the whole lattice that go to a rank, or come from there.
  struct Layers
  {
    int rank;
    std::int64_t first;
    std::int64_t last;
  };
  void send(const NodeField<float>* from, const std::vector<Layers>& out, NodeField<float>* to,
    const std::vector<Layers>& in, int first, int count) const;

  NodeLayout part_;
  const Communicator& all_;
  Communicator comm_;
  std::array<std::int64_t, 2> thick_{}; ///< own thick slab: first ≤ layer < last
  std::vector<Layers> give_;            ///< own layers, by the rank that gets them
  std::vector<Layers> take_;            ///< those of the thick slab, by the rank that has them
};

} // namespace lamella::peridynamics
