#pragma once

#include "core/Error.h"
#include "lattice/Phases.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lamella::testing
{

/// The message and hint of the error that a call throws; empty when it throws none.
template <class E, class F>
std::pair<std::string, std::string> refusal(F&& call)
{
  try
  {
    call();
  }
  catch (const E& error)
  {
    return { error.what(), error.hint() };
  }
  return {};
}

/// FNV-1a, 64 bits: pins the bytes of a result.
inline std::uint64_t hashOf(std::span<const std::uint8_t> bytes)
{
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const std::uint8_t byte : bytes)
    hash = (hash ^ byte) * 0x100000001b3ULL;
  return hash;
}

/// A connected piece of one phase.
struct Piece
{
  std::int64_t nodes = 0;
  std::array<std::int64_t, 3> low{}, high{}; ///< first and last node along each axis
  bool atBorder = false;

  [[nodiscard]] std::int64_t extent(int axis) const { return high[axis] - low[axis] + 1; }
};

/// All pieces of a phase, connected through faces, or through corners (and edges) as well.
inline std::vector<Piece> piecesOf(const PhaseImage& image, std::uint8_t phase, bool corners)
{
  const Lattice& lattice = image.lattice;
  std::vector<bool> seen(image.phase.size(), false);
  std::vector<Piece> pieces;
  std::vector<std::array<std::int64_t, 3>> stack;
  const std::int64_t dz = lattice.dimension == 3 ? 1 : 0;
  for (std::int64_t start = 0; start < lattice.count(); ++start)
  {
    if (seen[start] || image.phase[start] != phase)
      continue;
    const std::int64_t nx = lattice.size[0];
    const std::int64_t ny = lattice.size[1];
    const std::array<std::int64_t, 3> first{ start % nx, start / nx % ny, start / (nx * ny) };
    Piece piece{ 0, first, first, false };
    seen[start] = true;
    stack.push_back(first);
    while (!stack.empty())
    {
      const auto at = stack.back();
      stack.pop_back();
      ++piece.nodes;
      for (int axis = 0; axis < lattice.dimension; ++axis)
      {
        piece.low[axis] = std::min(piece.low[axis], at[axis]);
        piece.high[axis] = std::max(piece.high[axis], at[axis]);
        piece.atBorder = piece.atBorder || at[axis] == 0 || at[axis] == lattice.size[axis] - 1;
      }
      for (std::int64_t k = -dz; k <= dz; ++k)
      {
        for (std::int64_t j = -1; j <= 1; ++j)
        {
          for (std::int64_t i = -1; i <= 1; ++i)
          {
            const std::array<std::int64_t, 3> to{ at[0] + i, at[1] + j, at[2] + k };
            const bool outside =
              to[0] < 0 || to[1] < 0 || to[2] < 0 || to[0] >= nx || to[1] >= ny || to[2] >= lattice.size[2];
            if (outside || (!corners && i * i + j * j + k * k > 1))
              continue;
            const std::int64_t node = lattice.index(to[0], to[1], to[2]);
            if (!seen[node] && image.phase[node] == phase)
            {
              seen[node] = true;
              stack.push_back(to);
            }
          }
        }
      }
    }
    pieces.push_back(piece);
  }
  return pieces;
}

} // namespace lamella::testing
