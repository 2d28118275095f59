#include "micrograph/MiddleLamella.h"

#include "lattice/Communicator.h"
#include "lattice/Error.h"
#include "micrograph/CellOutlines.h"
#include "pores/PoreLabelling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace lamella::micrograph
{
namespace
{

constexpr std::uint8_t kVoid = 0;
constexpr std::uint8_t kSecondary = 1;
constexpr std::uint8_t kLamella = 2;
/// Compound middle lamella of spruce, early- and latewood alike, as traced at half a micrometre a pixel [m].
constexpr double kCompound = 0.5e-6;

/// Pieces of one cell that are near each other follow each other, as the search wants them.
void arrange(std::vector<Segment>& segments, double spacing)
{
  const double tile = 4 * spacing;
  const auto key = [tile](const Segment& s)
  {
    return std::array<std::int64_t, 3>{ static_cast<std::int64_t>((s.from[1] + s.to[1]) / 2 / tile),
      static_cast<std::int64_t>((s.from[0] + s.to[0]) / 2 / tile), s.chain };
  };
  std::stable_sort(
    segments.begin(), segments.end(), [&](const Segment& a, const Segment& b) { return key(a) < key(b); });
}

class Finder
{
public:
  Finder(const ContourLattice& lattice, const WallDirections& directions, double thickness, double radius)
    : lattice_(lattice.image.lattice)
    , wall_(lattice.image.phase)
    , directions_(directions)
    , median_(lattice.thickness.median)
    , gap_(thickness)
    , radius_(radius)
    , phase_(wall_.size())
  {
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      phase_[node] = wall_[node] != 0 ? kSecondary : kVoid;
    }
  }

  void constant()
  {
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      if (wall_[node] != 0 && directions_.middle[node] < gap_ / 2)
      {
        phase_[node] = kLamella;
      }
    }
  }

  void growth()
  {
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      if (wall_[node] != 0 && excess(node) < 0)
      {
        phase_[node] = kLamella;
      }
    }
    if (radius_ > 0)
    {
      roundCorners();
    }
  }

  /// @returns nodes added
  std::int64_t join()
  {
    std::int64_t joined = 0;
    forLinks(
      [&](std::size_t a, std::size_t b)
      {
        const std::size_t nearer = wall_[a] == 0 ? b : wall_[b] == 0 ? a : beside(b) < beside(a) ? b : a;
        if (phase_[nearer] == kSecondary)
        {
          phase_[nearer] = kLamella;
          ++joined;
        }
      });
    return joined;
  }

  /// Links between wall nodes of two cells, or between such a node and another cell's lumen.
  template <typename Visit>
  void forLinks(const Visit& visit) const
  {
    const std::int64_t nx = lattice_.size[0];
    for (std::int64_t y = 0; y < lattice_.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < nx; ++x)
      {
        const auto node = static_cast<std::size_t>(x + nx * y);
        for (const std::size_t step : { std::size_t{ 1 }, static_cast<std::size_t>(nx) })
        {
          if (step == 1 ? x + 1 == nx : y + 1 == lattice_.size[1])
          {
            continue;
          }
          const std::size_t next = node + step;
          if (directions_.grain[node] != directions_.grain[next] && (wall_[node] != 0 || wall_[next] != 0))
          {
            visit(node, next);
          }
        }
      }
    }
  }

  /// Neighbouring nodes in two lumens: a wall thinner than a node that the lattice lost.
  [[nodiscard]] std::int64_t lostWalls() const
  {
    std::int64_t lost = 0;
    const auto nx = static_cast<std::size_t>(lattice_.size[0]);
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      for (const std::size_t next : { node + 1, node + nx })
      {
        const bool inside = next == node + 1 ? next % nx != 0 : next < wall_.size();
        lost += inside && wall_[node] == 0 && wall_[next] == 0 && directions_.grain[node] != directions_.grain[next];
      }
    }
    return lost;
  }

  [[nodiscard]] std::vector<std::uint8_t>& phase() { return phase_; }

private:
  [[nodiscard]] double beside(std::size_t node) const
  {
    return static_cast<double>(directions_.second[node]) - static_cast<double>(directions_.nearest[node]);
  }
  /// How far a node is from where its cell stops growing: twice the distance in a straight wall; below 0: lamella.
  [[nodiscard]] double excess(std::size_t node) const { return beside(node) - gap_; }

  /// Calls `visit(cell, nodes, low)` for each square of nodes and each of the cells at its corners.
  template <typename Visit>
  void forSquares(const Visit& visit) const;
  template <typename Visit>
  void forCells(std::int64_t x, std::int64_t y, const Visit& visit) const;
  /// Where cells stop growing, the cell on the left of each piece.
  [[nodiscard]] std::vector<Segment> grownOutlines() const;
  /// 1 at the nodes in squares about segments that reach so far beyond them, 0 elsewhere.
  [[nodiscard]] std::vector<std::uint8_t> around(std::span<const Segment> segments, double distance) const;
  void roundCorners();

  const Lattice& lattice_;
  const std::vector<std::uint8_t>& wall_;
  const WallDirections& directions_;
  double median_;
  double gap_;
  double radius_;
  std::vector<std::uint8_t> phase_;
};

template <typename Visit>
void Finder::forSquares(const Visit& visit) const
{
  for (std::int64_t y = 0; y + 1 < lattice_.size[1]; ++y)
  {
    for (std::int64_t x = 0; x + 1 < lattice_.size[0]; ++x)
    {
      forCells(x, y, visit);
    }
  }
}

template <typename Visit>
void Finder::forCells(std::int64_t x, std::int64_t y, const Visit& visit) const
{
  const auto node = static_cast<std::size_t>(x + lattice_.size[0] * y);
  const auto above = node + static_cast<std::size_t>(lattice_.size[0]);
  const std::array<std::size_t, 4> nodes{ node, node + 1, above + 1, above };
  const Point low{ (static_cast<double>(x) + 0.5) * lattice_.spacing,
    (static_cast<double>(y) + 0.5) * lattice_.spacing };
  for (std::size_t i = 0; i < 4; ++i)
  {
    const std::int32_t cell = directions_.grain[nodes[i]];
    if (std::none_of(nodes.begin(), nodes.begin() + i, [&](std::size_t n) { return directions_.grain[n] == cell; }))
    {
      visit(cell, nodes, low);
    }
  }
}

std::vector<Segment> Finder::grownOutlines() const
{
  // A node of another cell counts as far beyond the outline as beyond its own and the gap.
  std::vector<Segment> outlines;
  forSquares(
    [&](std::int32_t cell, const std::array<std::size_t, 4>& nodes, const Point& low)
    {
      if (std::none_of(nodes.begin(), nodes.end(), [&](std::size_t node) { return wall_[node] != 0; }))
      {
        return;
      }
      Corners values;
      for (std::size_t i = 0; i < 4; ++i)
      {
        const double own = excess(nodes[i]);
        values[i] = directions_.grain[nodes[i]] == cell ? own : -own - 2 * gap_;
      }
      zeroLines(values, low, lattice_.spacing, cell, outlines);
    });
  arrange(outlines, lattice_.spacing);
  return outlines;
}

std::vector<std::uint8_t> Finder::around(std::span<const Segment> segments, double distance) const
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
    {
      std::fill(mask.begin() + lattice_.index(low[0], y), mask.begin() + lattice_.index(high[0], y), std::uint8_t{ 1 });
    }
  }
  return mask;
}

void Finder::roundCorners()
{
  const double spacing = lattice_.spacing;
  const NearestContours outlines(grownOutlines(), 1);
  // Where the disk that touches an outline from within fits, it covers all nodes before its centre. The others are near
  // corners, and only there anything else has to be looked at.
  const double slack = std::max(1e-3 * radius_, 0.02 * spacing);
  std::vector<Segment> tight;
  for (const Segment& segment : outlines.segments())
  {
    const double dx = segment.to[0] - segment.from[0];
    const double dy = segment.to[1] - segment.from[1];
    const double inwards = radius_ / std::max(std::hypot(dx, dy), 1e-300);
    const Point centre{ (segment.from[0] + segment.to[0]) / 2 - dy * inwards,
      (segment.from[1] + segment.to[1]) / 2 + dx * inwards };
    if (outlines.at(centre, radius_ - slack).squared[0] < (radius_ - slack) * (radius_ - slack))
    {
      tight.push_back(segment);
    }
  }

  // How far nodes are inside, as centres of disks; where it is more than the radius it does not matter by how much.
  const double most = radius_ + 2 * spacing;
  std::vector<float> inside(wall_.size(), static_cast<float>(most));
  outlines.atNodes(lattice_.size[0], lattice_.size[1], spacing, around(tight, 2 * most), most,
    [&](std::int64_t index, const Point&, const Nearest& nearest)
    {
      const auto node = static_cast<std::size_t>(index);
      const double distance = std::min(std::sqrt(nearest.squared[0]), most);
      inside[node] = static_cast<float>(phase_[node] == kLamella ? -distance : distance);
    });
  std::vector<Segment> centres;
  forSquares(
    [&](std::int32_t cell, const std::array<std::size_t, 4>& nodes, const Point& low)
    {
      if (std::all_of(
            nodes.begin(), nodes.end(), [&](std::size_t node) { return inside[node] >= static_cast<float>(most); }))
      {
        return;
      }
      Corners values;
      for (std::size_t i = 0; i < 4; ++i)
      {
        const double own = static_cast<double>(inside[nodes[i]]);
        values[i] = (directions_.grain[nodes[i]] == cell ? own : -std::abs(own)) - radius_;
      }
      zeroLines(values, low, spacing, cell, centres);
    });

  const double free = std::max(0.0, (median_ - gap_) / 2);
  std::vector<std::uint8_t> wanted = around(tight, radius_ + spacing);
  for (std::size_t node = 0; node < wall_.size(); ++node)
  {
    if (wanted[node] != 0)
    {
      const std::int64_t column = static_cast<std::int64_t>(node) % lattice_.size[0];
      const std::int64_t row = static_cast<std::int64_t>(node) / lattice_.size[0];
      const double x = (static_cast<double>(column) + 0.5) * spacing;
      const double y = (static_cast<double>(row) + 0.5) * spacing;
      const double border = std::min({ x, y, lattice_.length(0) - x, lattice_.length(1) - y });
      wanted[node] = phase_[node] == kSecondary &&
        static_cast<double>(inside[node])<radius_&& static_cast<double>(directions_.nearest[node])> free &&
        border > radius_;
    }
  }
  // What no disk covers. A part in a thousand of the radius is the lines' straightness between nodes.
  const double reach = radius_ * 1.001;
  arrange(centres, spacing);
  const NearestContours disks(std::move(centres), 1);
  if (disks.empty())
  {
    for (std::size_t node = 0; node < wall_.size(); ++node)
    {
      phase_[node] = wanted[node] != 0 ? kLamella : phase_[node];
    }
  }
  disks.atNodes(lattice_.size[0], lattice_.size[1], spacing, wanted, reach,
    [&](std::int64_t index, const Point&, const Nearest& nearest)
    {
      if (nearest.squared[0] > reach * reach)
      {
        phase_[static_cast<std::size_t>(index)] = kLamella;
      }
    });
}

void countNetworks(const ContourLattice& lattice, const WallDirections& directions, MiddleLamella& result)
{
  pores::LabelOptions options;
  options.connectivity = 8;
  const pores::PoreLabelling labelling(result.image.lattice, Communicator(), result.image.phase, kLamella, options);
  const pores::PoreSummary& summary = labelling.summary();
  result.networks = summary.count;
  result.largestNetwork =
    summary.total > 0 ? static_cast<double>(summary.largest) / static_cast<double>(summary.total) : 0;
  std::vector<std::int32_t> labels(result.image.phase.size());
  labelling.labels(labels);
  std::unordered_set<std::int32_t> cells;
  std::unordered_set<std::int32_t> touched;
  for (std::size_t node = 0; node < labels.size(); ++node)
  {
    if (lattice.image.phase[node] == 0)
    {
      if (node == 0 || directions.grain[node] != directions.grain[node - 1] || lattice.image.phase[node - 1] != 0)
      {
        cells.insert(directions.grain[node]);
      }
    }
    else if (labels[node] == 1)
    {
      touched.insert(directions.grain[node]);
      touched.insert(directions.neighbour[node]);
    }
  }
  result.cells = static_cast<std::int64_t>(cells.size());
  result.cellsTouched =
    std::count_if(cells.begin(), cells.end(), [&](std::int32_t cell) { return touched.contains(cell); });
}

void warn(const LamellaOptions& options, std::int64_t lost, MiddleLamella& result)
{
  const double wanted = std::max(options.horizon, 1.0);
  if (result.across.low < wanted || result.joined > 0)
  {
    result.warnings.push_back(
      fmt::format("the middle lamella is {:.2g} nodes thick (5 % of it {:.2g} or less){}: take a "
                  "spacing of {:.2g} m, or a thicker lamella",
        result.across.mean, result.across.low,
        options.horizon > 0 ? fmt::format(", thinner than the horizon of {:g}", options.horizon) : "",
        result.thickness / (wanted + 1)));
  }
  if (lost > 0)
  {
    result.warnings.push_back(
      fmt::format("{} links lead from one lumen straight into another: walls there are thinner than a node", lost));
  }
  if (result.cellsTouched < result.cells)
  {
    result.warnings.push_back(
      fmt::format("the largest network of middle lamella ({:.1f} % of it, one of {}) touches {} of {} "
                  "cells",
        100 * result.largestNetwork, result.networks, result.cellsTouched, result.cells));
  }
}

} // namespace

MiddleLamella middleLamella(
  const ContourLattice& lattice, const WallDirections& directions, const LamellaOptions& options)
{
  const double thickness = options.thickness.value_or(std::min(kCompound, lattice.thickness.median / 8));
  const double radius = options.radius.value_or(lattice.thickness.median / 4);
  if (!(lattice.thickness.median > 0))
  {
    throw InputError("a picture with fewer than two lumens has no middle lamella", "take a larger part of the picture");
  }
  if (!(thickness > 0) || !std::isfinite(thickness))
  {
    throw ParameterError(
      fmt::format("a middle lamella {} m thick", thickness), "give a thickness in metres, such as 5e-7");
  }
  if (!(radius >= 0) || !std::isfinite(radius))
  {
    throw ParameterError(
      fmt::format("cells with corners of radius {} m", radius), "give a radius in metres, or 0 for sharp corners");
  }
  MiddleLamella result;
  result.thickness = thickness;
  result.radius = options.method == LamellaMethod::Growth ? radius : 0;
  Finder finder(lattice, directions, thickness, radius);
  if (options.method == LamellaMethod::Growth)
  {
    finder.growth();
  }
  else
  {
    finder.constant();
  }
  result.joined = finder.join();
  const std::int64_t lost = finder.lostWalls();
  result.image = { lattice.image.lattice, std::move(finder.phase()),
    PhaseTable({ "void", "secondary wall", "middle lamella" }) };
  const std::vector<double> shares = result.image.fractions();
  result.wallShare = shares[kLamella] / std::max(shares[kLamella] + shares[kSecondary], 1e-300);
  result.across = nodesAcross(lattice, directions, result.image.phase);
  countNetworks(lattice, directions, result);
  warn(options, lost, result);
  return result;
}

NodesAcross nodesAcross(
  const ContourLattice& lattice, const WallDirections& directions, std::span<const std::uint8_t> phase)
{
  constexpr double step = 1.0 / 8;
  const std::int64_t nx = lattice.image.lattice.size[0];
  const std::int64_t ny = lattice.image.lattice.size[1];
  NodesAcross across;
  const auto beside = [&](std::size_t node)
  { return static_cast<double>(directions.second[node]) - static_cast<double>(directions.nearest[node]); };
  const auto measure = [&](std::size_t a, std::size_t b)
  {
    // The middle lies between the two nodes; nodes are unit squares around whole numbers here.
    const double t = beside(a) / std::max(beside(a) + beside(b), 1e-300);
    const bool alongX = b == a + 1;
    const std::size_t column = a % static_cast<std::size_t>(nx);
    const std::size_t row = a / static_cast<std::size_t>(nx);
    const Point middle{ static_cast<double>(column) + (alongX ? t : 0), static_cast<double>(row) + (alongX ? 0 : t) };
    const std::array<float, 2>& axis = directions.axis[t < 0.5 ? a : b];
    std::int64_t steps = 0;
    for (const int side : { 1, -1 })
    {
      for (std::int64_t i = 0; i < 8 * (nx + ny); ++i)
      {
        const double way = side * (static_cast<double>(i) + 0.5) * step;
        const auto x = static_cast<std::int64_t>(std::floor(middle[0] - way * static_cast<double>(axis[1]) + 0.5));
        const auto y = static_cast<std::int64_t>(std::floor(middle[1] + way * static_cast<double>(axis[0]) + 0.5));
        if (x < 0 || y < 0 || x >= nx || y >= ny || phase[static_cast<std::size_t>(x + nx * y)] != kLamella)
        {
          break;
        }
        ++steps;
      }
    }
    across.all.push_back(static_cast<float>(step * static_cast<double>(steps)));
  };
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(x + nx * y);
      const auto isLink = [&](std::size_t next)
      {
        return directions.grain[node] != directions.grain[next] && lattice.image.phase[node] != 0 &&
          lattice.image.phase[next] != 0;
      };
      if (x + 1 < nx && isLink(node + 1))
      {
        measure(node, node + 1);
      }
      if (y + 1 < ny && isLink(node + static_cast<std::size_t>(nx)))
      {
        measure(node, node + static_cast<std::size_t>(nx));
      }
    }
  }
  if (!across.all.empty())
  {
    double sum = 0;
    for (const float value : across.all)
    {
      sum += static_cast<double>(value);
    }
    across.mean = sum / static_cast<double>(across.all.size());
    const auto low = across.all.begin() + static_cast<std::ptrdiff_t>(across.all.size() / 20);
    std::nth_element(across.all.begin(), low, across.all.end());
    across.low = static_cast<double>(*low);
  }
  return across;
}

PhaseImage lamellaFromLabels(const Lattice& lattice, std::span<const std::uint16_t> grey)
{
  const GreyMap map{ { { 0, "void" }, { 128, "middle lamella" }, { 255, "secondary wall" } }, {} };
  PhaseImage image = map.apply(lattice, grey);
  const PhaseTable phases({ "void", "secondary wall", "middle lamella" });
  std::array<std::uint8_t, 3> id{};
  for (std::size_t i = 0; i < image.phases.size(); ++i)
  {
    id.at(i) = phases.find(image.phases.name(static_cast<std::uint8_t>(i))).value();
  }
  for (std::uint8_t& phase : image.phase)
  {
    phase = id.at(phase);
  }
  image.phases = phases;
  return image;
}

double overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, std::uint8_t phase)
{
  std::int64_t both = 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    const bool left = a[i] == phase;
    const bool right = b[i] == phase;
    both += left && right;
    sum += static_cast<int>(left) + static_cast<int>(right);
  }
  return sum > 0 ? 2.0 * static_cast<double>(both) / static_cast<double>(sum) : 1.0;
}

} // namespace lamella::micrograph
