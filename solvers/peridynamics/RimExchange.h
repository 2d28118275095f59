#pragma once

#include "core/Communicator.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// Fills the rim of an array of a layout in slabs along its slowest axis: images at periodic sides, the rows of the
/// neighbouring ranks. Elsewhere the rim is left alone. Collective.
template <class T>
void exchangeRim(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm, T* data);

/// The same for several arrays, while work goes on that does not need the rows of other ranks. Those lie beyond this
/// rank's first and last layer along the slowest axis; the owned rows must not change until finish().
template <class T>
class RimInFlight
{
public:
  /// Starts; what this rank has itself is in place at once. Collective.
  RimInFlight(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm,
    std::span<T* const> arrays);
  RimInFlight(const RimInFlight&) = delete;
  RimInFlight& operator=(const RimInFlight&) = delete;
  ~RimInFlight() { finish(); }

  /// Do rows come from another rank below the first layer, above the last one?
  [[nodiscard]] bool low() const noexcept { return low_; }
  [[nodiscard]] bool high() const noexcept { return high_; }
  /// Lets messages move on; to be called now and then, from the thread that started.
  void poll();
  /// Waits until the rim is there.
  void finish();

private:
  std::vector<MPI_Request> requests_;
  MPI_Datatype row_ = MPI_DATATYPE_NULL;
  bool low_ = false;
  bool high_ = false;
};

/// The lists of all ranks one after another, in order of rank; each entry is `stride` numbers. Collective.
[[nodiscard]] std::vector<std::int64_t> gather(
  const Communicator& comm, const std::vector<std::int64_t>& mine, int stride);

} // namespace lamella::peridynamics
