#include "lbm/PhaseRows.h"

namespace lamella::lbm
{

PhaseRows::PhaseRows(const Block& block, const Halo& halo, std::span<const std::uint8_t> phase, int dimension)
  : block_(block)
  , phase_(phase)
  , ghostZ_(dimension == 3 ? 1 : 0)
  , ghostRow_(static_cast<std::size_t>(halo.rows()), 0)
{
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
      ghostRow_[static_cast<std::size_t>(halo.row(y, z))] = -1;
  std::int64_t ghosts = 0;
  for (auto& offset : ghostRow_)
    if (offset == 0)
      offset = block_.size[0] * ghosts++;
  ghosts_.assign(static_cast<std::size_t>(ghosts * block_.size[0]), 0);
  halo.exchange(
    [&](std::int64_t row)
    {
      // owned rows are only read
      const auto* data = (*this)(row % (block_.size[1] + 2) - 1, row / (block_.size[1] + 2) - ghostZ_);
      return Halo::Segment{ reinterpret_cast<std::byte*>(const_cast<std::uint8_t*>(data)),
        static_cast<std::size_t>(block_.size[0]) };
    });
}

} // namespace lamella::lbm
