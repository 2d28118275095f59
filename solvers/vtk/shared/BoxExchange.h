#pragma once

#include "lattice/Lattice.h"
#include "lbm/SteadyDiffusion.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <mpi.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lamella
{

/// Moves one value a node from the boxes that ranks hold to the boxes that they need.
///
/// A pipeline splits an image as it likes, with shared layers of points at the seams and ghost layers around, and some
/// ranks may hold nothing; a solver wants disjoint blocks of whole rows. The boxes held may overlap (their values must
/// then be equal); every needed node must be held by some rank. Along periodic axes a needed box may reach beyond the
/// lattice; the nodes out there are those at the other end. One rank never calls MPI.
class VTKLAMELLASOLVERSVTK_EXPORT BoxExchange
{
public:
  /// Collective. Boxes are counted from the lattice's first node.
  /// @throws InputError (on every rank) when nodes are needed that no rank holds
  BoxExchange(const Lattice& lattice, const lbm::Block& held, const lbm::Block& needed, std::array<bool, 3> periodic,
    MPI_Comm comm, int ranks);

  /// Whether on every rank the needed box is the held box, so that nothing needs to move.
  [[nodiscard]] bool identity() const noexcept { return identity_; }

  /// Collective. Values of the held box in lattice order → values of the needed box.
  /// @param components values a node
  template <typename Value>
  void run(std::span<const Value> held, std::span<Value> needed, int components = 1) const
  {
    this->move(reinterpret_cast<const std::byte*>(held.data()), reinterpret_cast<std::byte*>(needed.data()),
      sizeof(Value) * static_cast<std::size_t>(components));
  }

private:
  /// The nodes `box` of the sender's box, wanted `shift` further on by the receiver.
  struct Part
  {
    int rank = 0; ///< the other side
    int tag = 0;
    lbm::Block box;
    std::array<std::int64_t, 3> shift{ 0, 0, 0 };
  };

  void move(const std::byte* held, std::byte* needed, std::size_t bytes) const;

  MPI_Comm comm_;
  int rank_ = 0;
  lbm::Block held_;
  lbm::Block needed_;
  std::vector<Part> sent_;
  std::vector<Part> received_;
  bool identity_ = false;
};

} // namespace lamella
