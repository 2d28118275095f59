#include "generators/Nearest.h"

namespace lamella::generators
{

Nearest nearestMarked(const std::vector<std::uint8_t>& marked, std::int64_t nx, std::int64_t ny)
{
  constexpr std::int32_t far = 1 << 15; // beyond any distance whose square fits
  Nearest result;
  result.node.assign(marked.size(), Nearest::none);
  result.squared.assign(marked.size(), std::numeric_limits<std::int32_t>::max());
  // Row of the nearest marked node of the same column.
  std::vector<std::int32_t> row(marked.size(), -far);
  for (std::int64_t x = 0; x < nx; ++x)
  {
    std::int32_t last = -far;
    for (std::int64_t y = 0; y < ny; ++y)
    {
      const auto i = static_cast<std::size_t>(x + nx * y);
      last = marked[i] != 0 ? static_cast<std::int32_t>(y) : last;
      row[i] = last;
    }
    last = -far;
    for (std::int64_t y = ny - 1; y >= 0; --y)
    {
      const auto i = static_cast<std::size_t>(x + nx * y);
      last = marked[i] != 0 ? static_cast<std::int32_t>(y) : last;
      const std::int64_t below = y - row[i];
      if (last >= 0 && (row[i] < 0 || last - y < below))
        row[i] = last;
    }
  }
  // Along a row: the lower envelope of the parabolas (x − i)² + gᵢ².
  std::vector<std::int64_t> at(static_cast<std::size_t>(nx));
  std::vector<std::int64_t> from(static_cast<std::size_t>(nx));
  for (std::int64_t y = 0; y < ny; ++y)
  {
    const auto g2 = [&](std::int64_t x)
    {
      const std::int64_t g = y - row[static_cast<std::size_t>(x + nx * y)];
      return g * g;
    };
    std::int64_t count = 0;
    for (std::int64_t x = 0; x < nx; ++x)
    {
      if (row[static_cast<std::size_t>(x + nx * y)] < 0)
        continue;
      std::int64_t begin = 0;
      while (count > 0)
      {
        const std::int64_t i = at[static_cast<std::size_t>(count - 1)];
        // The first place where parabola x is lower than parabola i.
        const std::int64_t numerator = x * x - i * i + g2(x) - g2(i);
        const std::int64_t divisor = 2 * (x - i);
        begin = numerator < 0 ? 0 : numerator / divisor + 1;
        if (begin > from[static_cast<std::size_t>(count - 1)])
          break;
        --count;
        begin = 0;
      }
      if (begin < nx)
      {
        at[static_cast<std::size_t>(count)] = x;
        from[static_cast<std::size_t>(count)] = begin;
        ++count;
      }
    }
    std::int64_t part = 0;
    for (std::int64_t x = 0; x < nx && count > 0; ++x)
    {
      while (part + 1 < count && from[static_cast<std::size_t>(part + 1)] <= x)
        ++part;
      const std::int64_t i = at[static_cast<std::size_t>(part)];
      const auto node = static_cast<std::size_t>(x + nx * y);
      const std::int64_t d = (x - i) * (x - i) + g2(i);
      result.squared[node] = static_cast<std::int32_t>(
        d < far * static_cast<std::int64_t>(far) ? d : far * static_cast<std::int64_t>(far) - 1);
      result.node[node] = static_cast<std::int32_t>(i + nx * row[static_cast<std::size_t>(i + nx * y)]);
    }
  }
  return result;
}

} // namespace lamella::generators
