#pragma once

#include "lattice/Decomposition.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// The rows of this rank's phases, ghost rows included: its own where they are, those of its neighbours copied.
class PhaseRows
{
public:
  PhaseRows(const Block& block, const Halo& halo, std::span<const std::uint8_t> phase, int dimension);
  /// y = -1 … ny, z = -1 … nz (3D); beyond the box zeros.
  [[nodiscard]] const std::uint8_t* operator()(std::int64_t y, std::int64_t z) const noexcept
  {
    const std::int64_t offset = ghostRow_[static_cast<std::size_t>((z + ghostZ_) * (block_.size[1] + 2) + y + 1)];
    return offset < 0 ? phase_.data() + block_.size[0] * (y + block_.size[1] * z) : ghosts_.data() + offset;
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return ghosts_.size() + ghostRow_.size() * 8; }

private:
  Block block_;
  std::span<const std::uint8_t> phase_;
  std::int64_t ghostZ_;
  std::vector<std::uint8_t> ghosts_;   ///< rows of the ghost layers, found through ghostRow_
  std::vector<std::int64_t> ghostRow_; ///< a padded row: offset into ghosts_, or -1 for a row of our own
};

} // namespace lamella::lbm
