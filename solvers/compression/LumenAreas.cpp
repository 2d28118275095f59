#include "compression/LumenAreas.h"

#include "core/Communicator.h"
#include "core/Error.h"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::compression
{
namespace
{

using Place = std::array<double, 3>;

Place from(const Place& a, const double* b)
{
  return { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
}

double determinant(const Place& a, const Place& b, const Place& c)
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Calls `found(label, corners)` for every edge (face) of a pixel (voxel) between a lumen and what is not that lumen;
/// the corners run around with the lumen to the left (inside).
template <class Found>
void eachEdge(const Lattice& lattice, std::span<const std::int32_t> labels, const Found& found)
{
  const int dimension = lattice.dimension;
  const CornerLattice all(lattice);
  std::size_t node = 0;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x, ++node)
      {
        if (labels[node] == 0)
          continue;
        const std::array<std::int64_t, 3> at{ x, y, z };
        for (int side = 0; side < 2 * dimension; ++side)
        {
          const int axis = side / 2;
          std::array<std::int64_t, 3> beside = at;
          beside[axis] += side % 2 == 0 ? -1 : 1;
          if (beside[axis] >= 0 && beside[axis] < lattice.size[axis] &&
            labels[static_cast<std::size_t>(lattice.index(beside[0], beside[1], beside[2]))] == labels[node])
            continue;
          // counterclockwise, as seen from outside
          const int b = dimension == 2 ? 1 - axis : (axis + 1) % 3;
          const int c = (axis + 2) % 3;
          const auto corner = [&](int alongB, int alongC)
          {
            std::array<std::int64_t, 3> place = at;
            place[axis] += side % 2;
            place[b] += alongB;
            if (dimension == 3)
              place[c] += alongC;
            return all.index(place);
          };
          const bool turn = side % 2 == 0;
          if (dimension == 2)
          {
            const int begin = (side % 2 == 1) == (axis == 0) ? 0 : 1; // up the right side, back along the top
            found(labels[node], std::array{ corner(begin, 0), corner(1 - begin, 0) });
          }
          else
            found(labels[node],
              std::array{
                corner(0, 0), corner(turn ? 0 : 1, turn ? 1 : 0), corner(1, 1), corner(turn ? 1 : 0, turn ? 0 : 1) });
        }
      }
}

} // namespace

LumenAreas::LumenAreas(const Lattice& lattice, std::span<const std::uint8_t> phase, const LumenOptions& options)
  : lattice_(lattice)
{
  const auto nodes = static_cast<std::size_t>(lattice.count());
  if (phase.size() != nodes)
    throw InputError(fmt::format("{} phases for {} nodes", phase.size(), nodes), "give one a node");
  if (std::ranges::count(phase, options.empty) == lattice.count())
    throw InputError(fmt::format("all {} nodes are lumen", nodes), "look at which phase lumens are of");
  pores::LabelOptions label;
  label.connectivity = options.connectivity != 0 ? options.connectivity : 2 * lattice.dimension;
  label.minimumSize = options.minimumSize;
  {
    const pores::PoreLabelling labelling(lattice, Communicator(MPI_COMM_SELF), phase, options.empty, label);
    lumens_.assign(labelling.pores().begin(), labelling.pores().end());
    if (lumens_.empty())
      throw InputError(labelling.summary().phaseNodes == 0
          ? std::string("no node is lumen")
          : fmt::format("all {} lumens are smaller than {} nodes", labelling.summary().dropped, options.minimumSize),
        "look at which phase lumens are of, or take smaller ones");
    labels_.resize(nodes);
    labelling.labels(labels_);
  }

  first_.assign(lumens_.size() + 1, 0);
  eachEdge(lattice_, labels_,
    [&](std::int32_t lumen, const auto& around) { first_[static_cast<std::size_t>(lumen)] += around.size(); });
  for (std::size_t lumen = 1; lumen < first_.size(); ++lumen)
    first_[lumen] += first_[lumen - 1];
  corners_.resize(first_.back());
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  constexpr std::size_t most = none / 8; // each is shared by as many nodes
  std::vector<std::uint32_t> known(static_cast<std::size_t>(CornerLattice(lattice_).count()), none);
  std::vector<std::int64_t> corners;
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  eachEdge(lattice_, labels_,
    [&](std::int32_t lumen, const auto& around)
    {
      for (const std::int64_t corner : around)
      {
        std::uint32_t& number = known[static_cast<std::size_t>(corner)];
        if (number == none)
        {
          if (corners.size() == most)
            throw InputError(fmt::format("lumens have more than {} corners", most), "take a part of the image");
          number = static_cast<std::uint32_t>(corners.size());
          corners.push_back(corner);
        }
        corners_[next[static_cast<std::size_t>(lumen) - 1]++] = number;
      }
    });
  known.clear();
  known.shrink_to_fit();
  motion_ = CornerMotion(lattice_, phase, options.empty, std::move(corners));
  initial_.resize(lumens_.size());
  const double node = std::pow(lattice_.spacing, lattice_.dimension);
  std::ranges::transform(
    lumens_, initial_.begin(), [&](const pores::Pore& lumen) { return node * static_cast<double>(lumen.size); });
}

std::size_t LumenAreas::bytes() const noexcept
{
  return motion_.bytes() + first_.size() * sizeof(std::size_t) + corners_.size() * sizeof(std::uint32_t);
}

void LumenAreas::areas(const PointState& state, std::span<double> areas) const
{
  std::vector<double> places(3 * motion_.count());
  motion_.places(state, places);
  const bool flat = lattice_.dimension == 2;
  for (std::size_t lumen = 0; lumen < lumens_.size(); ++lumen)
  {
    const auto at = [&](std::size_t i) { return places.data() + 3 * static_cast<std::size_t>(corners_[i]); };
    // seen from a corner of its own, a lumen's size does not drown in its distance from the origin
    const double* const first = at(first_[lumen]);
    const Place origin{ first[0], first[1], first[2] };
    double sum = 0;
    for (std::size_t i = first_[lumen]; i < first_[lumen + 1]; i += cornersOfEdge())
    {
      const Place a = from(origin, at(i));
      const Place b = from(origin, at(i + 1));
      if (flat)
      {
        sum += (a[0] * b[1] - a[1] * b[0]) / 2;
        continue;
      }
      // a face between four corners that are not in a plane: the mean of both ways to cut it into triangles
      const Place c = from(origin, at(i + 2));
      const Place d = from(origin, at(i + 3));
      sum += (determinant(a, b, c) + determinant(a, c, d) + determinant(a, b, d) + determinant(b, c, d)) / 12;
    }
    areas[lumen] = sum;
  }
}

} // namespace lamella::compression
