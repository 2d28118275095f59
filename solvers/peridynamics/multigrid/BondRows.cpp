#include "peridynamics/multigrid/BondRows.h"

#include "peridynamics/multigrid/FreeBlocks.h"

#include <algorithm>

namespace lamella::peridynamics
{
MatrixRows rowsOfBonds(const BondLattice& bonds, const FixedComponents& fixed, const NodeField<float>& diagonal)
{
  const NodeLayout& l = bonds.layout();
  const int d = l.dimension;
  const std::uint8_t all = allComponents(d);
  MatrixRows rows;
  rows.reach = bonds.stencil().layers();
  for (const Offset& o : bonds.stencil().half())
  {
    std::array<double, 3> e{};
    for (std::size_t a = 0; a < 3; ++a)
      e[a] = o.step[a] / o.length;
    MatrixRows::Neighbour n{ o.step, {} };
    if (d == 2)
      n.tensor = { static_cast<float>(e[0] * e[0]), static_cast<float>(e[1] * e[1]), static_cast<float>(e[0] * e[1]) };
    else
      n.tensor = { static_cast<float>(e[0] * e[0]), static_cast<float>(e[1] * e[1]), static_cast<float>(e[2] * e[2]),
        static_cast<float>(e[0] * e[1]), static_cast<float>(e[1] * e[2]), static_cast<float>(e[0] * e[2]) };
    rows.neighbours.push_back(n);
  }
  // k/|ξ| by offset and kind; with surface correction every bond has its own
  const std::size_t kinds = bonds.kinds().size();
  std::vector<float> table(bonds.stencil().half().size() * kinds, 0.0F);
  for (std::size_t q = 0; q < bonds.stencil().half().size(); ++q)
  {
    const Offset& o = bonds.stencil().half()[q];
    for (std::size_t k = 1; k < kinds; ++k)
      table[q * kinds + k] = static_cast<float>(-o.weight * bonds.kinds()[k].stiffness / (o.length * bonds.spacing()));
  }
  rows.block = [&bonds, &fixed, l, all, table, kinds](int q, std::int64_t y, std::int64_t z, float* out, std::int64_t)
  {
    const std::uint8_t* strips = bonds.stripsOf(l.row(y, z)) + l.before / 16;
    const std::int64_t first = l.index(0, y, z);
    const std::int64_t jump = bonds.jump(q);
    const float* k = table.data() + static_cast<std::size_t>(q) * kinds;
    bool any = false;
    for (std::int64_t x = 0; x < l.size[0]; x += 16)
    {
      const std::int64_t end = std::min(l.size[0], x + 16);
      const std::uint8_t strip = strips[x / 16];
      any = any || strip != 0;
      if (strip == 0)
        std::fill(out + x, out + end, 0.0F);
      else if (strip != 255 && !bonds.corrected())
        std::fill(out + x, out + end, k[strip]);
      else if (bonds.corrected())
        for (std::int64_t i = x; i < end; ++i)
          out[i] = static_cast<float>(-bonds.springConstant(first + i, q));
      else
        for (std::int64_t i = x; i < end; ++i)
          out[i] = k[bonds.kind(first + i, q)];
      if (strip != 0)
        for (std::int64_t i = x; i < end; ++i)
          if (fixed[first + i] == all || fixed[first + i + jump] == all)
            out[i] = 0.0F;
    }
    return any;
  };
  rows.diagonal = [&diagonal, &fixed, l, d, all](std::int64_t y, std::int64_t z, float* out, std::int64_t stride)
  {
    const std::int64_t first = l.index(0, y, z);
    for (int e = 0; e < blockEntries(d); ++e)
      std::copy_n(diagonal.component(e) + first, l.size[0], out + e * stride);
    for (std::int64_t i = 0; i < l.size[0]; ++i)
      if (const std::uint8_t bits = fixed[first + i]; bits == all)
        for (int e = 0; e < blockEntries(d); ++e)
          out[e * stride + i] = 0.0F;
      else if (bits != 0)
        for (int c = 0; c < d; ++c)
          if ((bits >> c & 1U) != 0)
            out[c * stride + i] *= 1 + fixedSpring;
  };
  rows.stiffness = [&diagonal, &fixed, l, d](std::int64_t y, std::int64_t z, float* out)
  {
    const std::int64_t first = l.index(0, y, z);
    for (std::int64_t i = 0; i < l.size[0]; ++i)
    {
      out[i] = 0;
      for (int c = 0; c < d; ++c)
        if ((fixed[first + i] >> c & 1U) == 0)
          out[i] = std::max(out[i], diagonal.component(c)[first + i]);
    }
  };
  return rows;
}

} // namespace lamella::peridynamics
