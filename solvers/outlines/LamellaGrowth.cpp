#include "outlines/LamellaGrowth.h"

#include "outlines/CellOutlines.h"
#include "outlines/LamellaPhases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lamella::micrograph
{
namespace
{

/// Squares of nodes that are gone through together, so that pieces of one cell that are near each other follow each
/// other, as the search wants them.
constexpr std::int64_t kTile = 12;
/// Points that are searched together lie within a square of so many nodes.
constexpr double kTogether = 16;

class Growth
{
public:
  Growth(const ContourLattice& lattice, const WallDirections& directions, double gap, double radius,
    std::span<std::uint8_t> phase)
    : lattice_(lattice.image.lattice)
    , wall_(lattice.image.phase)
    , directions_(directions)
    , median_(lattice.thickness.median)
    , gap_(gap)
    , radius_(radius)
    , phase_(phase)
    , grown_(wall_.size())
  {
  }

  void grow()
  {
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      const double distance = excess(node);
      grown_[node] = distance > 0 ? 1 : 0;
      phase_[node] = wall_[node] != 0 && distance < 0 ? kLamella : phase_[node];
    }
    if (radius_ > 0)
      roundCorners();
  }

private:
  /// How far a node is from where its cell stops growing: twice the distance in a straight wall; below 0: lamella.
  [[nodiscard]] double excess(std::size_t node) const
  {
    return static_cast<double>(directions_.second[node]) - static_cast<double>(directions_.nearest[node]) - gap_;
  }

  /// Draws lines of value 0 through all squares of nodes, cell by cell.
  /// @param skip whether there is none in the square of these nodes, whose cells may differ
  /// @param value of a node for a cell
  template <typename Skip, typename Value>
  [[nodiscard]] std::vector<Segment> lines(const Skip& skip, const Value& value) const;

  /// Where cells stop growing, the cell on the left of each piece.
  [[nodiscard]] std::vector<Segment> grownOutlines() const;
  /// Pieces within which the disk that touches them does not fit.
  [[nodiscard]] std::vector<Segment> tightPieces(const NearestContours& outlines) const;
  /// How far nodes near tight pieces are inside the cells' outlines; elsewhere `most`.
  [[nodiscard]] std::vector<float> depths(
    const NearestContours& outlines, std::span<const Segment> tight, double most) const;
  /// Nodes that may be outside all disks.
  [[nodiscard]] std::vector<std::uint8_t> inQuestion(
    std::span<const Segment> tight, const std::vector<float>& inside) const;
  /// 1 at the nodes in squares about segments that reach so far beyond them, 0 elsewhere.
  [[nodiscard]] std::vector<std::uint8_t> around(std::span<const Segment> segments, double distance) const;
  void roundCorners();

  const Lattice& lattice_;
  const std::vector<std::uint8_t>& wall_;
  const WallDirections& directions_;
  double median_;
  double gap_;
  double radius_;
  std::span<std::uint8_t> phase_;
  std::vector<std::uint8_t> grown_; ///< whether the node's cell has grown over it
};

template <typename Skip, typename Value>
std::vector<Segment> Growth::lines(const Skip& skip, const Value& value) const
{
  std::vector<Segment> found;
  const std::int64_t columns = lattice_.size[0] - 1;
  const std::int64_t rows = lattice_.size[1] - 1;
  const auto square = [&](std::int64_t x, std::int64_t y)
  {
    const auto node = static_cast<std::size_t>(x + lattice_.size[0] * y);
    const auto above = node + static_cast<std::size_t>(lattice_.size[0]);
    const std::array<std::size_t, 4> nodes{ node, node + 1, above + 1, above };
    if (skip(nodes))
      return;
    const Point low{ (static_cast<double>(x) + 0.5) * lattice_.spacing,
      (static_cast<double>(y) + 0.5) * lattice_.spacing };
    for (std::size_t i = 0; i < 4; ++i)
    {
      const std::int32_t cell = directions_.grain[nodes[i]];
      if (std::none_of(nodes.begin(), nodes.begin() + i, [&](std::size_t n) { return directions_.grain[n] == cell; }))
      {
        Corners values;
        std::transform(nodes.begin(), nodes.end(), values.begin(),
          [&](std::size_t n) { return value(n, directions_.grain[n] == cell); });
        zeroLines(values, low, lattice_.spacing, cell, found);
      }
    }
  };
  for (std::int64_t top = 0; top < rows; top += kTile)
  {
    for (std::int64_t left = 0; left < columns; left += kTile)
    {
      const auto before = static_cast<std::ptrdiff_t>(found.size());
      for (std::int64_t y = top; y < std::min(rows, top + kTile); ++y)
        for (std::int64_t x = left; x < std::min(columns, left + kTile); ++x)
          square(x, y);
      const auto byCell = [](const Segment& a, const Segment& b) { return a.chain < b.chain; };
      if (!std::is_sorted(found.begin() + before, found.end(), byCell))
        std::stable_sort(found.begin() + before, found.end(), byCell);
    }
  }
  return found;
}

std::vector<Segment> Growth::grownOutlines() const
{
  return lines(
    [&](const std::array<std::size_t, 4>& nodes)
    {
      // One cell that has grown, or not, over all of the square; or no wall.
      const auto& [a, b, c, d] = nodes;
      const std::vector<std::int32_t>& grain = directions_.grain;
      const bool same = grain[a] == grain[b] && grain[b] == grain[c] && grain[c] == grain[d];
      const int grown = grown_[a] + grown_[b] + grown_[c] + grown_[d];
      return (same && (grown == 0 || grown == 4)) || (wall_[a] | wall_[b] | wall_[c] | wall_[d]) == 0;
    },
    [&](std::size_t node, bool own)
    {
      // A node of another cell counts as far beyond the outline as beyond its own and the gap.
      const double distance = excess(node);
      return own ? distance : -distance - 2 * gap_;
    });
}

std::vector<Segment> Growth::tightPieces(const NearestContours& outlines) const
{
  const double slack = std::max(1e-3 * radius_, 0.02 * lattice_.spacing);
  const double reach = radius_ - slack;
  std::vector<Point> centres;
  centres.reserve(outlines.segments().size());
  for (const Segment& segment : outlines.segments())
  {
    const double dx = segment.to[0] - segment.from[0];
    const double dy = segment.to[1] - segment.from[1];
    const double inwards = radius_ / std::max(std::sqrt(dx * dx + dy * dy), 1e-300);
    centres.push_back(
      { (segment.from[0] + segment.to[0]) / 2 - dy * inwards, (segment.from[1] + segment.to[1]) / 2 + dx * inwards });
  }
  std::vector<Segment> tight;
  outlines.atPoints(centres, kTogether * lattice_.spacing, reach,
    [&](std::int64_t index, const Point&, const Nearest& nearest)
    {
      if (nearest.squared[0] < reach * reach)
        tight.push_back(outlines.segments()[static_cast<std::size_t>(index)]);
    });
  return tight;
}

std::vector<std::uint8_t> Growth::around(std::span<const Segment> segments, double distance) const
{
  std::vector<std::uint8_t> mask(wall_.size(), 0);
  for (const Segment& segment : segments)
  {
    std::array<std::int64_t, 2> low{};
    std::array<std::int64_t, 2> high{};
    for (const std::size_t axis : { 0U, 1U })
    {
      const auto most = static_cast<double>(lattice_.size[axis]);
      low[axis] = static_cast<std::int64_t>(
        std::clamp((std::min(segment.from[axis], segment.to[axis]) - distance) / lattice_.spacing, 0.0, most));
      high[axis] = static_cast<std::int64_t>(std::ceil(
        std::clamp((std::max(segment.from[axis], segment.to[axis]) + distance) / lattice_.spacing, 0.0, most)));
    }
    for (std::int64_t y = low[1]; y < high[1]; ++y)
      std::fill(mask.begin() + lattice_.index(low[0], y), mask.begin() + lattice_.index(high[0], y), std::uint8_t{ 1 });
  }
  return mask;
}

std::vector<float> Growth::depths(const NearestContours& outlines, std::span<const Segment> tight, double most) const
{
  std::vector<float> inside(wall_.size(), static_cast<float>(most));
  // Corners of the squares with centres of disks that reach a node in question, see there.
  const double reach = 2.002 * radius_ + 2.1 * lattice_.spacing;
  outlines.atNodes(lattice_.size[0], lattice_.size[1], lattice_.spacing, around(tight, reach), most,
    [&](std::int64_t index, const Point&, const Nearest& nearest)
    {
      const auto node = static_cast<std::size_t>(index);
      const double distance = std::min(std::sqrt(nearest.squared[0]), most);
      inside[node] = static_cast<float>(phase_[node] == kLamella ? -distance : distance);
    });
  return inside;
}

std::vector<std::uint8_t> Growth::inQuestion(std::span<const Segment> tight, const std::vector<float>& inside) const
{
  const double spacing = lattice_.spacing;
  const double free = std::max(0.0, (median_ - gap_) / 2);
  std::vector<std::uint8_t> wanted = around(tight, radius_ + spacing);
  for (std::int64_t row = 0; row < lattice_.size[1]; ++row)
  {
    for (std::int64_t column = 0; column < lattice_.size[0]; ++column)
    {
      const auto node = static_cast<std::size_t>(lattice_.index(column, row));
      if (wanted[node] != 0)
      {
        const double x = (static_cast<double>(column) + 0.5) * spacing;
        const double y = (static_cast<double>(row) + 0.5) * spacing;
        const double border = std::min({ x, y, lattice_.length(0) - x, lattice_.length(1) - y });
        const bool shallow = static_cast<double>(inside[node]) < radius_;
        const bool late = static_cast<double>(directions_.nearest[node]) > free;
        wanted[node] = phase_[node] == kSecondary && shallow && late && border > radius_;
      }
    }
  }
  return wanted;
}

void Growth::roundCorners()
{
  const double spacing = lattice_.spacing;
  const NearestContours outlines(grownOutlines(), 1);
  // Where the disk that touches an outline from within fits, it covers all nodes before its centre. The others are near
  // corners, and only there anything else has to be looked at.
  const std::vector<Segment> tight = tightPieces(outlines);
  // How far nodes are inside, as centres of disks; where it is more than the radius by a square's diagonal it does not
  // matter by how much.
  const double most = radius_ + 1.5 * spacing;
  const std::vector<float> inside = depths(outlines, tight, most);
  const auto far = static_cast<float>(most);
  std::vector<Segment> centres = lines([&](const std::array<std::size_t, 4>& nodes)
    { return std::all_of(nodes.begin(), nodes.end(), [&](std::size_t node) { return inside[node] >= far; }); },
    [&](std::size_t node, bool own)
    {
      const auto depth = static_cast<double>(inside[node]);
      return (own ? depth : -std::abs(depth)) - radius_;
    });

  // What no disk covers. A part in a thousand of the radius is the lines' straightness between nodes.
  const std::vector<std::uint8_t> wanted = inQuestion(tight, inside);
  const double reach = radius_ * 1.001;
  const NearestContours disks(std::move(centres), 1);
  if (disks.empty())
    for (std::size_t node = 0; node < wall_.size(); ++node)
      phase_[node] = wanted[node] != 0 ? kLamella : phase_[node];
  disks.atNodes(lattice_.size[0], lattice_.size[1], spacing, wanted, reach,
    [&](std::int64_t index, const Point&, const Nearest& nearest)
    {
      if (nearest.squared[0] > reach * reach)
        phase_[static_cast<std::size_t>(index)] = kLamella;
    });
}

} // namespace

void growLamella(const ContourLattice& lattice, const WallDirections& directions, double gap, double radius,
  std::span<std::uint8_t> phase)
{
  Growth(lattice, directions, gap, radius, phase).grow();
}

} // namespace lamella::micrograph
