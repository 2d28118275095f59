#pragma once

#include "lattice/Lattice.h"
#include "pores/PoreLabelling.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

/// Images of pores and the plainest way to find them, which the tests compare with.
namespace lamella::test
{

struct PoreImage
{
  Lattice lattice;
  std::vector<std::uint8_t> phase;
};

/// A picture from rows of text, the top row first; '#' is phase 1 (solid), anything else phase 0.
inline PoreImage drawn(const std::vector<std::string>& rows)
{
  const auto nx = static_cast<std::int64_t>(rows.front().size());
  const auto ny = static_cast<std::int64_t>(rows.size());
  PoreImage image{ makeLattice(nx, ny, 1, 2, 1), {} };
  for (auto row = rows.rbegin(); row != rows.rend(); ++row)
    for (const char c : *row)
      image.phase.push_back(c == '#' ? 1 : 0);
  return image;
}

/// Every node is void (phase 0) by chance; the others are phases 1 and 2.
inline PoreImage noise(std::array<std::int64_t, 3> size, int dimension, double porosity, unsigned seed)
{
  PoreImage image{ makeLattice(size[0], size[1], size[2], dimension, 1), {} };
  std::mt19937 engine(seed);
  for (std::int64_t i = 0; i < image.lattice.count(); ++i)
  {
    const double draw = engine() / 4294967296.0;
    image.phase.push_back(draw < porosity ? 0 : draw < 0.5 + 0.5 * porosity ? 1 : 2);
  }
  return image;
}

struct Flooded
{
  std::vector<pores::Pore> pores; ///< in the order of their labels; no `touches` along axes of one layer in 2D
  std::vector<std::int32_t> labels;
};

/// Node by node with a queue. Along periodic axes places are followed beyond the box, so that a pore that meets itself
/// elsewhere is seen to percolate.
inline Flooded flood(const PoreImage& image, std::uint8_t wanted, const pores::LabelOptions& options)
{
  const Lattice& l = image.lattice;
  using Place = std::array<std::int64_t, 3>;
  std::vector<Place> steps;
  for (int z = -1; z <= 1; ++z)
  {
    for (int y = -1; y <= 1; ++y)
    {
      for (int x = -1; x <= 1; ++x)
      {
        const int off = (x != 0 ? 1 : 0) + (y != 0 ? 1 : 0) + (z != 0 ? 1 : 0);
        const int c = options.connectivity;
        const int most = c == 4 || c == 6 ? 1 : c == 8 || c == 18 ? 2 : 3;
        if (off > 0 && off <= most && (l.dimension == 3 || z == 0))
          steps.push_back({ x, y, z });
      }
    }
  }
  Flooded result;
  result.labels.assign(image.phase.size(), 0);
  struct Found
  {
    pores::Pore pore;
    std::vector<std::int64_t> nodes;
  };
  std::vector<Found> all;
  std::vector<char> seen(image.phase.size(), 0);
  std::vector<Place> placeOf(image.phase.size());
  const auto split = [&](std::int64_t i) {
    return Place{ i % l.size[0], i / l.size[0] % l.size[1], i / (l.size[0] * l.size[1]) };
  };
  for (std::int64_t start = 0; start < l.count(); ++start)
  {
    if (seen[static_cast<std::size_t>(start)] != 0 || image.phase[static_cast<std::size_t>(start)] != wanted)
      continue;
    Found found{ { 0, start, {}, {}, {}, 0, 0 }, { start } };
    std::uint8_t wraps = 0;
    seen[static_cast<std::size_t>(start)] = 1;
    placeOf[static_cast<std::size_t>(start)] = split(start);
    for (std::size_t next = 0; next < found.nodes.size(); ++next)
    {
      const Place at = placeOf[static_cast<std::size_t>(found.nodes[next])];
      for (const Place& step : steps)
      {
        Place to{};
        Place in{};
        bool exists = true;
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          const std::int64_t n = l.size[axis];
          to[axis] = at[axis] + step[axis];
          in[axis] = ((to[axis] % n) + n) % n;
          const std::int64_t inBox = ((at[axis] % n) + n) % n + step[axis];
          exists = exists && (options.periodic[axis] || (inBox >= 0 && inBox < n));
        }
        const std::int64_t node = l.index(in[0], in[1], in[2]);
        if (!exists || image.phase[static_cast<std::size_t>(node)] != wanted)
          continue;
        if (seen[static_cast<std::size_t>(node)] == 0)
        {
          seen[static_cast<std::size_t>(node)] = 1;
          placeOf[static_cast<std::size_t>(node)] = to;
          found.nodes.push_back(node);
          continue;
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
          wraps |= placeOf[static_cast<std::size_t>(node)][axis] != to[axis] ? 1U << axis : 0U;
      }
    }
    pores::Pore& pore = found.pore;
    pore.size = static_cast<std::int64_t>(found.nodes.size());
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const std::int64_t n = l.size[axis];
      const bool wrapped = (wraps >> axis & 1U) != 0;
      std::int64_t sum = 0;
      std::int64_t low = n;
      std::int64_t high = -1;
      bool first = true;
      for (const std::int64_t node : found.nodes)
      {
        const std::int64_t inside = split(node)[axis];
        const std::int64_t place = wrapped ? inside : placeOf[static_cast<std::size_t>(node)][axis];
        sum += place;
        low = first ? place : std::min(low, place);
        high = first ? place : std::max(high, place);
        first = false;
        if (axis < static_cast<std::size_t>(l.dimension))
        {
          pore.touches |= static_cast<std::uint8_t>((inside == 0 ? 1U : 0U) << (2 * axis));
          pore.touches |= static_cast<std::uint8_t>((inside == n - 1 ? 2U : 0U) << (2 * axis));
        }
      }
      const std::int64_t move = wrapped ? 0 : (((low % n) + n) % n) - low;
      pore.low[axis] = static_cast<std::int32_t>(wrapped ? 0 : low + move);
      pore.high[axis] = static_cast<std::int32_t>(wrapped ? n - 1 : high + move);
      for (; 2 * sum < -pore.size; sum += n * pore.size)
      {
      }
      for (; 2 * sum >= (2 * n - 1) * pore.size; sum -= n * pore.size)
      {
      }
      pore.centre[axis] = static_cast<double>(sum) / static_cast<double>(pore.size);
      const bool across = options.periodic[axis] ? wrapped : (pore.touches >> (2 * axis) & 3U) == 3U;
      pore.percolates |= static_cast<std::uint8_t>(across ? 1U << axis : 0U);
    }
    all.push_back(std::move(found));
  }
  if (options.sortBySize)
    std::stable_sort(all.begin(), all.end(), [](const Found& a, const Found& b) { return a.pore.size > b.pore.size; });
  for (const Found& found : all)
  {
    if (found.pore.size >= options.minimumSize)
    {
      result.pores.push_back(found.pore);
      for (const std::int64_t node : found.nodes)
        result.labels[static_cast<std::size_t>(node)] = static_cast<std::int32_t>(result.pores.size());
    }
  }
  return result;
}

} // namespace lamella::test
