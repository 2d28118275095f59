#include "segmentation/VolumePieces.h"

#include "core/Error.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace lamella::micrograph
{
namespace
{

/// Nodes first … next run's first − 1 of a row, of one phase.
struct Run
{
  std::int32_t first = 0;
  std::uint32_t piece = 0; ///< run that stands for the piece, or a step on the way to it
};

class PieceFinder
{
public:
  PieceFinder(const Lattice& lattice, std::span<std::uint8_t> phase)
    : lattice_(lattice)
    , phase_(phase)
  {
    const std::int64_t rows = lattice.size[1] * lattice.size[2];
    rowStart_.reserve(static_cast<std::size_t>(rows) + 1);
    for (std::int64_t row = 0; row < rows; ++row)
    {
      rowStart_.push_back(runs_.size());
      const std::uint8_t* const value = of(row);
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
      {
        if (x == 0 || value[x] != value[x - 1])
        {
          if (runs_.size() >= std::numeric_limits<std::int32_t>::max())
          {
            throw MemoryError("the volume falls into more than 2 147 483 647 runs of one phase",
              "give a window that takes a part of it");
          }
          runs_.push_back({ static_cast<std::int32_t>(x), static_cast<std::uint32_t>(runs_.size()) });
        }
      }
    }
    rowStart_.push_back(runs_.size());
    for (std::int64_t row = 0; row < rows; ++row)
      eachNeighbourRow(row, [&](std::int64_t other) { join(row, other); });
    count();
  }

  ClearedPieces clear(std::int64_t smallest)
  {
    // Votes of the faces around every small piece, by phase; those of other small pieces in a second set.
    std::vector<std::uint32_t> number(runs_.size(), none);
    std::vector<std::uint32_t> small;
    for (std::uint32_t run = 0; run < runs_.size(); ++run)
    {
      if (runs_[run].piece == run && size_[run] < smallest)
      {
        number[run] = static_cast<std::uint32_t>(small.size());
        small.push_back(run);
      }
    }
    ClearedPieces cleared;
    if (small.empty())
      return cleared;
    const std::size_t kinds = static_cast<std::size_t>(*std::max_element(phase_.begin(), phase_.end())) + 1;
    std::vector<std::int32_t> votes(small.size() * kinds * 2, 0);
    const auto vote = [&](std::uint32_t run, std::uint32_t neighbour, std::uint8_t phase, std::int64_t faces)
    {
      const std::uint32_t of = number[root(run)];
      if (of != none && root(run) != root(neighbour))
      {
        const bool alsoSmall = number[root(neighbour)] != none;
        votes[(of * 2 + (alsoSmall ? 1 : 0)) * kinds + phase] += static_cast<std::int32_t>(faces);
      }
    };
    const std::int64_t rows = lattice_.size[1] * lattice_.size[2];
    for (std::int64_t row = 0; row < rows; ++row)
    {
      const std::uint8_t* const here = of(row);
      for (std::size_t run = rowStart_[static_cast<std::size_t>(row)] + 1;
           run < rowStart_[static_cast<std::size_t>(row) + 1]; ++run)
      {
        const std::int32_t x = runs_[run].first;
        vote(static_cast<std::uint32_t>(run), static_cast<std::uint32_t>(run - 1), here[x - 1], 1);
        vote(static_cast<std::uint32_t>(run - 1), static_cast<std::uint32_t>(run), here[x], 1);
      }
      eachNeighbourRow(row,
        [&](std::int64_t other)
        {
          const std::uint8_t* const there = of(other);
          eachOverlap(row, other,
            [&](std::uint32_t a, std::uint32_t b, std::int64_t first, std::int64_t end)
            {
              vote(a, b, there[first], end - first);
              vote(b, a, here[first], end - first);
            });
        });
    }
    std::vector<std::uint8_t> becomes(small.size());
    std::vector<bool> changes(small.size());
    for (std::size_t i = 0; i < small.size(); ++i)
    {
      const auto of = votes.begin() + static_cast<std::ptrdiff_t>(i * 2 * kinds);
      const auto settled = of + static_cast<std::ptrdiff_t>(kinds);
      const bool any = std::any_of(of, settled, [](std::int32_t v) { return v > 0; });
      const auto best = any ? std::max_element(of, settled) - of
                            : std::max_element(settled, settled + static_cast<std::ptrdiff_t>(kinds)) - settled;
      becomes[i] = static_cast<std::uint8_t>(best);
      changes[i] = any || *(settled + best) > 0;
      cleared.pieces += changes[i] ? 1 : 0;
      cleared.voxels += changes[i] ? size_[small[i]] : 0;
    }
    for (std::int64_t row = 0; row < rows; ++row)
    {
      eachRun(
        row,
        [&](std::uint32_t run, std::int64_t first, std::int64_t end)
        {
          if (const std::uint32_t i = number[root(run)]; i != none && changes[i])
            std::fill(phase_.begin() + row * lattice_.size[0] + first, phase_.begin() + row * lattice_.size[0] + end,
              becomes[i]);
        });
    }
    return cleared;
  }

private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] std::uint8_t* of(std::int64_t row) const { return phase_.data() + row * lattice_.size[0]; }

  /// The rows before this one along y and z.
  template <typename F>
  void eachNeighbourRow(std::int64_t row, const F& f) const
  {
    if (row % lattice_.size[1] > 0)
      f(row - 1);
    if (row >= lattice_.size[1])
      f(row - lattice_.size[1]);
  }

  template <typename F>
  void eachRun(std::int64_t row, const F& f) const
  {
    const std::size_t end = rowStart_[static_cast<std::size_t>(row) + 1];
    for (std::size_t run = rowStart_[static_cast<std::size_t>(row)]; run < end; ++run)
      f(static_cast<std::uint32_t>(run), runs_[run].first, run + 1 < end ? runs_[run + 1].first : lattice_.size[0]);
  }

  /// Calls f(run, run of the other row, first, end) for all that lie side by side.
  template <typename F>
  void eachOverlap(std::int64_t row, std::int64_t other, const F& f) const
  {
    const std::size_t endA = rowStart_[static_cast<std::size_t>(row) + 1];
    const std::size_t endB = rowStart_[static_cast<std::size_t>(other) + 1];
    std::size_t a = rowStart_[static_cast<std::size_t>(row)];
    std::size_t b = rowStart_[static_cast<std::size_t>(other)];
    std::int64_t first = 0;
    while (a < endA && b < endB)
    {
      const std::int64_t afterA = a + 1 < endA ? runs_[a + 1].first : lattice_.size[0];
      const std::int64_t afterB = b + 1 < endB ? runs_[b + 1].first : lattice_.size[0];
      const std::int64_t end = std::min(afterA, afterB);
      f(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), first, end);
      a += afterA == end ? 1 : 0;
      b += afterB == end ? 1 : 0;
      first = end;
    }
  }

  std::uint32_t root(std::uint32_t run)
  {
    while (runs_[run].piece != run)
    {
      runs_[run].piece = runs_[runs_[run].piece].piece; // halves the way for the next one
      run = runs_[run].piece;
    }
    return run;
  }

  void join(std::int64_t row, std::int64_t other)
  {
    const std::uint8_t* const here = of(row);
    const std::uint8_t* const there = of(other);
    eachOverlap(row, other,
      [&](std::uint32_t a, std::uint32_t b, std::int64_t first, std::int64_t)
      {
        if (here[first] == there[first])
        {
          const std::uint32_t rootA = root(a);
          const std::uint32_t rootB = root(b);
          runs_[std::max(rootA, rootB)].piece = std::min(rootA, rootB);
        }
      });
  }

  void count()
  {
    size_.assign(runs_.size(), 0);
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    for (std::int64_t row = 0; row < lattice_.size[1] * lattice_.size[2]; ++row)
    {
      eachRun(
        row,
        [&](std::uint32_t run, std::int64_t first, std::int64_t end)
        {
          std::int32_t& size = size_[root(run)];
          size = static_cast<std::int32_t>(std::min(most, size + end - first));
        });
    }
  }

  Lattice lattice_;
  std::span<std::uint8_t> phase_;
  std::vector<std::size_t> rowStart_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> size_; ///< of pieces, at the run that stands for each; larger ones count as 2³¹ − 1
};

} // namespace

ClearedPieces clearPieces(const Lattice& lattice, std::span<std::uint8_t> phase, std::int64_t smallest)
{
  return smallest > 1 ? PieceFinder(lattice, phase).clear(smallest) : ClearedPieces{};
}

std::vector<double> thicknesses(const Lattice& lattice, std::span<const std::uint8_t> phase, std::size_t phases)
{
  std::vector<std::int64_t> voxels(phases, 0);
  std::vector<std::int64_t> atEdge(phases, 0);
  const auto [nx, ny, nz] = lattice.size;
  const std::int64_t slice = nx * ny;
  const std::uint8_t* at = phase.data();
  for (std::int64_t z = 0; z < nz; ++z)
  {
    for (std::int64_t y = 0; y < ny; ++y)
    {
      for (std::int64_t x = 0; x < nx; ++x, ++at)
      {
        const std::uint8_t own = *at;
        const bool edge = (x > 0 && at[-1] != own) || (x + 1 < nx && at[1] != own) || (y > 0 && at[-nx] != own) ||
          (y + 1 < ny && at[nx] != own) || (z > 0 && at[-slice] != own) || (z + 1 < nz && at[slice] != own);
        ++voxels[own];
        atEdge[own] += edge ? 1 : 0;
      }
    }
  }
  const auto longest = static_cast<double>(std::max({ nx, ny, nz }));
  std::vector<double> thick(phases, 0);
  for (std::size_t id = 0; id < phases; ++id)
  {
    if (voxels[id] > 0)
    {
      thick[id] = std::min(
        longest, 2 * static_cast<double>(voxels[id]) / static_cast<double>(std::max<std::int64_t>(1, atEdge[id])));
    }
  }
  return thick;
}

std::int64_t clearShells(
  const Lattice& lattice, std::span<std::uint8_t> cls, std::span<const std::uint16_t> grey, double between, int reach)
{
  const std::uint8_t brightest = cls.empty() ? std::uint8_t{ 0 } : *std::max_element(cls.begin(), cls.end());
  const std::array<std::int64_t, 3> step{ 1, lattice.size[0], lattice.size[0] * lattice.size[1] };
  // Marked first and changed afterwards, so that what has changed misleads nobody; 255 − new id is the mark.
  std::int64_t changed = 0;
  std::size_t node = 0;
  const auto classOf = [&](std::size_t i) { return cls[i] >= 128 ? std::uint8_t{ 1 } : cls[i]; };
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < lattice.size[0]; ++x, ++node)
      {
        if (cls[node] == 0 || cls[node] == brightest)
          continue;
        const std::array<std::int64_t, 3> at{ x, y, z };
        bool shell = false;
        for (std::size_t axis = 0; axis < 3 && !shell; ++axis)
        {
          // Nearest other class on either side.
          std::array<int, 2> side{ -1, -1 };
          for (const int sense : { 0, 1 })
          {
            for (int k = 1; k <= reach && side[static_cast<std::size_t>(sense)] < 0; ++k)
            {
              const std::int64_t to = at[axis] + (sense == 0 ? -k : k);
              if (to < 0 || to >= lattice.size[axis])
                break;
              const std::uint8_t other = classOf(node + static_cast<std::size_t>((sense == 0 ? -k : k) * step[axis]));
              if (other == 0 || other == brightest)
                side[static_cast<std::size_t>(sense)] = other;
            }
          }
          shell = side[0] >= 0 && side[1] >= 0 && side[0] != side[1];
        }
        if (shell)
        {
          cls[node] = static_cast<std::uint8_t>(255 - (grey[node] > between ? brightest : 0));
          ++changed;
        }
      }
    }
  }
  for (std::uint8_t& id : cls)
    id = id >= 128 ? static_cast<std::uint8_t>(255 - id) : id;
  return changed;
}

} // namespace lamella::micrograph
