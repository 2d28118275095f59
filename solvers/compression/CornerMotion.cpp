#include "compression/CornerMotion.h"

#include "core/Error.h"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella::compression
{
namespace
{

constexpr const char* hint = "give the points that were made from this image, all of them, with their ids";

/// Which row a point of this id is in; the ids themselves where they are in order.
class RowOfId
{
public:
  explicit RowOfId(std::span<const std::uint32_t> id)
  {
    std::size_t same = 0;
    while (same < id.size() && id[same] == same)
      ++same;
    if (same == id.size())
      return;
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    row_.assign(id.size(), none);
    for (std::size_t i = 0; i < id.size(); ++i)
    {
      if (id[i] >= id.size())
        throw InputError(fmt::format("the id {} of a point among {}", id[i], id.size()), hint);
      if (row_[id[i]] != none)
        throw InputError(fmt::format("two points have the id {}", id[i]), hint);
      row_[id[i]] = static_cast<std::uint32_t>(i);
    }
  }
  [[nodiscard]] std::size_t operator[](std::size_t id) const { return row_.empty() ? id : row_[id]; }

private:
  std::vector<std::uint32_t> row_;
};

/// k of k^dimension points a node. @throws InputError
std::size_t pointsAlong(std::size_t points, std::size_t nodes, int dimension)
{
  const double each = static_cast<double>(points) / static_cast<double>(nodes);
  const auto k = static_cast<std::size_t>(std::llround(std::pow(each, 1.0 / dimension)));
  std::size_t expected = nodes;
  for (int i = 0; i < dimension; ++i)
    expected *= k;
  if (k == 0 || expected != points)
    throw InputError(fmt::format("{} points for {} nodes of the wall are {:.6g} a node, not 1, {} or {}", points, nodes,
                       each, dimension == 2 ? 4 : 8, dimension == 2 ? 9 : 27),
      hint);
  return k;
}

/// How one side of the lattice moved: u = (1, t) · coefficients, t along the side in spacings.
using SideFit = std::optional<Eigen::MatrixX3d>;

} // namespace

CornerLattice::CornerLattice(const Lattice& lattice) noexcept
{
  for (int axis = 0; axis < lattice.dimension; ++axis)
    size[axis] = lattice.size[axis] + 1;
}

CornerMotion::CornerMotion(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t empty, std::vector<std::int64_t> corners)
  : lattice_(lattice)
  , corners_(std::move(corners))
{
  std::vector<std::uint32_t> order(phase.size());
  for (std::size_t node = 0; node < phase.size(); ++node)
  {
    order[node] = static_cast<std::uint32_t>(solid_);
    solid_ += phase[node] != empty ? 1 : 0;
  }
  const CornerLattice all(lattice_);
  const int ends = 1 << lattice_.dimension;
  first_.assign(1, 0);
  first_.reserve(corners_.size() + 1);
  for (std::size_t i = 0; i < corners_.size(); ++i)
  {
    const std::array<std::int64_t, 3> corner = all.corner(corners_[i]);
    bool rim = false;
    for (int axis = 0; axis < lattice_.dimension; ++axis)
      rim = rim || corner[axis] == 0 || corner[axis] == lattice_.size[axis];
    if (rim)
      rim_.push_back(static_cast<std::uint32_t>(i));
    for (int end = 0; end < ends; ++end)
    {
      std::array<std::int64_t, 3> node{};
      bool inside = true;
      for (int axis = 0; axis < lattice_.dimension; ++axis)
      {
        node[axis] = corner[axis] - (end >> axis & 1);
        inside = inside && node[axis] >= 0 && node[axis] < lattice_.size[axis];
      }
      const auto at = static_cast<std::size_t>(lattice_.index(node[0], node[1], node[2]));
      if (inside && phase[at] != empty)
      {
        node_.push_back(order[at]);
        end_.push_back(static_cast<std::uint8_t>(end));
      }
    }
    first_.push_back(static_cast<std::uint32_t>(node_.size()));
  }
}

std::size_t CornerMotion::bytes() const noexcept
{
  return corners_.size() * sizeof(std::int64_t) + (first_.size() + node_.size() + rim_.size()) * sizeof(std::uint32_t) +
    end_.size();
}

std::array<double, 3> CornerMotion::start(std::size_t corner) const noexcept
{
  const std::array<std::int64_t, 3> at = CornerLattice(lattice_).corner(corners_[corner]);
  std::array<double, 3> place{};
  for (int axis = 0; axis < lattice_.dimension; ++axis)
    place[axis] = lattice_.origin[axis] + lattice_.spacing * (static_cast<double>(at[axis]) - 0.5);
  return place;
}

void CornerMotion::places(const PointState& state, std::span<double> places) const
{
  const int dimension = lattice_.dimension;
  const std::size_t points = state.id.size();
  const std::size_t components = points > 0 ? state.gradient.size() / points : 0;
  if (state.position.size() != 3 * points || components * points != state.gradient.size() ||
    (components != 9 && (components != 4 || dimension == 3)))
    throw InputError(fmt::format("{} ids, {} numbers of positions and {} of deformation gradients", points,
                       state.position.size(), state.gradient.size()),
      dimension == 2 ? "give 3 and 9 or 4 numbers a point" : "give 3 and 9 numbers a point");
  const std::size_t k = pointsAlong(points, solid_, dimension);
  const std::size_t columns = components == 9 ? 3 : 2;
  const std::size_t each = dimension == 2 ? k * k : k * k * k;
  const double half = lattice_.spacing / static_cast<double>(k) / 2;
  const RowOfId rows(state.id);
  for (std::size_t corner = 0; corner < count(); ++corner)
  {
    std::array<double, 3> sum{};
    const std::size_t shares = first_[corner + 1] - first_[corner];
    for (std::size_t n = first_[corner]; n < first_[corner + 1]; ++n)
    {
      std::size_t within = 0;
      for (int axis = dimension - 1; axis >= 0; --axis)
        within = within * k + ((end_[n] >> axis & 1) != 0 ? k - 1 : 0);
      const std::size_t row = rows[node_[n] * each + within];
      for (int i = 0; i < dimension; ++i)
      {
        double place = state.position[3 * row + static_cast<std::size_t>(i)];
        for (int j = 0; j < dimension; ++j)
          place +=
            state.gradient[components * row + columns * static_cast<std::size_t>(i) + static_cast<std::size_t>(j)] *
            ((end_[n] >> j & 1) != 0 ? half : -half);
        if (!std::isfinite(place))
          throw InputError(fmt::format("the point of id {} is not finite", state.id[row]), "stop the run before it");
        sum[i] += place;
      }
    }
    for (std::size_t i = 0; i < 3; ++i)
      places[3 * corner + i] = shares > 0 ? sum[i] / static_cast<double>(shares) : 0.0;
  }
  closeRim(places);
}

void CornerMotion::closeRim(std::span<double> places) const
{
  const int dimension = lattice_.dimension;
  const CornerLattice all(lattice_);
  const auto bare = [&](std::uint32_t corner) { return first_[corner] == first_[corner + 1]; };
  const auto onSide = [&](const std::array<std::int64_t, 3>& at, int side)
  { return at[side / 2] == (side % 2 == 0 ? 0 : lattice_.size[side / 2]); };
  // from the middle of the side on, so that a fit that the corners do not determine is a shift
  const auto row = [&](const std::array<std::int64_t, 3>& at, int side)
  {
    Eigen::RowVectorXd values(dimension);
    values[0] = 1;
    for (int i = 1; i < dimension; ++i)
    {
      const int axis = (side / 2 + i) % dimension;
      values[i] = static_cast<double>(at[axis]) - static_cast<double>(lattice_.size[axis]) / 2;
    }
    return values;
  };
  std::array<SideFit, 6> fits;
  for (int side = 0; side < 2 * dimension; ++side)
  {
    std::vector<std::uint32_t> held;
    for (const std::uint32_t corner : rim_)
      if (!bare(corner) && onSide(all.corner(corners_[corner]), side))
        held.push_back(corner);
    if (held.empty())
      continue;
    Eigen::MatrixXd rows(held.size(), dimension);
    Eigen::MatrixX3d moved(held.size(), 3);
    for (std::size_t i = 0; i < held.size(); ++i)
    {
      const auto r = static_cast<Eigen::Index>(i);
      rows.row(r) = row(all.corner(corners_[held[i]]), side);
      const std::array<double, 3> from = start(held[i]);
      for (int axis = 0; axis < 3; ++axis)
        moved(r, axis) = axis < dimension ? places[3 * held[i] + static_cast<std::size_t>(axis)] - from[axis] : 0.0;
    }
    fits[side] = rows.completeOrthogonalDecomposition().solve(moved);
  }
  for (const std::uint32_t corner : rim_)
  {
    if (!bare(corner))
      continue;
    const std::array<std::int64_t, 3> at = all.corner(corners_[corner]);
    const std::array<double, 3> from = start(corner);
    for (int axis = 0; axis < dimension; ++axis)
    {
      // along its normal a side tells; along itself it hardly matters, as a line closes wherever its corners lie
      double own = std::numeric_limits<double>::quiet_NaN();
      double sum = 0;
      int sides = 0;
      for (int side = 0; side < 2 * dimension; ++side)
      {
        if (!onSide(at, side))
          continue;
        const double moved =
          fits[side] ? (row(at, side) * *fits[side])[axis] : std::numeric_limits<double>::quiet_NaN();
        own = side / 2 == axis ? moved : own;
        sum += moved;
        ++sides;
      }
      const bool normal = onSide(at, 2 * axis) || onSide(at, 2 * axis + 1);
      places[3 * corner + static_cast<std::size_t>(axis)] = from[axis] + (normal ? own : sum / sides);
    }
  }
}

} // namespace lamella::compression
