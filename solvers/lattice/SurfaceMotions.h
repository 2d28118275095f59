#pragma once

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella
{

// Normals at nodes: along an axis differences, across it means, of four voxels each.
inline constexpr std::array<int, 4> slopeDifferences{ -1, -1, 1, 1 };
inline constexpr std::array<int, 4> slopeMeans{ 1, 3, 3, 1 };

/// How the nodes between voxels move where the surface between two phases moves by the normal out of the first: those
/// that touch both by 1, all others not, and what is between goes with its corners. Energies of fields on the voxels
/// tell by that what the surface's place does to them (Eshelby, Phil. Trans. R. Soc. A 244 (1951) 87). Normals are from
/// the 4 × 4 (× 4) voxels around a node.
template <int D>
class SurfaceMotions
{
public:
  static constexpr int corners = 1 << D;
  using Place = std::array<std::int64_t, D>;
  using Normal = Eigen::Matrix<double, D, 1>;
  /// How the nodes of an element move where a phase grows into another.
  struct Motion
  {
    std::uint8_t first = 0, second = 0;
    Eigen::Matrix<double, D, D> gradient = Eigen::Matrix<double, D, D>::Zero(); ///< ∂_a V_b at [b][a]
  };

  /// @param phase    ids of all voxels, x fastest; they outlive this
  /// @param size     voxels along each axis
  /// @param edge     of a voxel, over that along x; 0: 1
  /// @param periodic axes along which the box goes on into itself; along others it is mirrored
  SurfaceMotions(std::span<const std::uint8_t> phase, const std::array<std::int64_t, D>& size,
    const std::array<double, D>& edge, const std::array<bool, D>& periodic)
    : phase_(phase)
  {
    std::int64_t stride = 1;
    for (std::size_t a = 0; a < D; ++a)
    {
      edge_[a] = edge[a] == 0 ? 1.0 : edge[a];
      const std::int64_t count = size[a];
      const auto voxel = [&](std::int64_t i)
      {
        if (periodic[a])
          return ((i % count) + count) % count;
        return std::clamp<std::int64_t>(i < 0 ? -1 - i : i >= count ? 2 * count - 1 - i : i, 0, count - 1); // mirrored
      };
      for (std::int64_t node = 0; node <= count; ++node)
        for (std::int64_t by = -2; by < 2; ++by)
          around_[a].push_back(stride * voxel(node + by));
      stride *= count;
    }
  }

  /// Whether all voxels that share a node with one are of its phase.
  [[nodiscard]] bool alone(const Place& p) const
  {
    const std::uint8_t own = phaseOf(p);
    for (int corner = 0; corner < corners; ++corner)
      for (int which = 0; which < corners; ++which)
      {
        std::int64_t index = 0;
        for (std::size_t a = 0; a < D; ++a)
          index += around_[a][static_cast<std::size_t>(4 * (p[a] + (corner >> a & 1)) + 1 + (which >> a & 1))];
        if (phase_[static_cast<std::size_t>(index)] != own)
          return false;
      }
    return true;
  }

  /// How the element of a voxel moves, by the pairs of phases that meet at its nodes.
  void motions(const Place& p, std::vector<Motion>& found) const
  {
    found.clear();
    for (int corner = 0; corner < corners; ++corner)
    {
      Place node = p;
      for (std::size_t a = 0; a < D; ++a)
        node[a] += corner >> a & 1;
      std::array<std::uint8_t, corners> beside{};
      std::size_t phases = 0;
      for (int which = 0; which < corners; ++which)
      {
        std::int64_t index = 0;
        for (std::size_t a = 0; a < D; ++a)
          index += around_[a][static_cast<std::size_t>(4 * node[a] + 1 + (which >> a & 1))];
        const std::uint8_t id = phase_[static_cast<std::size_t>(index)];
        std::size_t place = 0; // ids in order, each once
        while (place < phases && beside[place] < id)
          ++place;
        if (place < phases && beside[place] == id)
          continue;
        for (std::size_t k = phases++; k > place; --k)
          beside[k] = beside[k - 1];
        beside[place] = id;
      }
      if (phases < 2)
        continue;
      for (std::size_t i = 0; i < phases; ++i)
        for (std::size_t j = i + 1; j < phases; ++j)
        {
          const Normal v = normal(node, beside[i], beside[j]);
          auto to =
            std::ranges::find_if(found, [&](const Motion& m) { return m.first == beside[i] && m.second == beside[j]; });
          if (to == found.end())
            to = found.insert(found.end(), { beside[i], beside[j] });
          for (int a = 0; a < D; ++a)
            to->gradient.col(a) +=
              ((corner >> a & 1) != 0 ? 1 : -1) * (2.0 / corners) / edge_[static_cast<std::size_t>(a)] * v;
        }
    }
  }

private:
  [[nodiscard]] std::uint8_t phaseOf(const Place& p) const
  {
    std::int64_t index = 0;
    for (std::size_t a = 0; a < D; ++a)
      index += around_[a][static_cast<std::size_t>(4 * p[a] + 2)];
    return phase_[static_cast<std::size_t>(index)];
  }
  /// Of a node, from one phase to another; zeros where they lie on both sides alike.
  [[nodiscard]] Normal normal(const Place& node, std::uint8_t from, std::uint8_t to) const
  {
    constexpr int all = D == 3 ? 64 : 16;
    std::array<int, D> slope{};
    for (int which = 0; which < all; ++which)
    {
      const std::array<std::size_t, 3> by{ static_cast<std::size_t>(which & 3),
        static_cast<std::size_t>(which >> 2 & 3), static_cast<std::size_t>(which >> 4) };
      std::int64_t index = 0;
      for (std::size_t a = 0; a < D; ++a)
        index += around_[a][static_cast<std::size_t>(4 * node[a]) + by[a]];
      const std::uint8_t id = phase_[static_cast<std::size_t>(index)];
      if (id != from && id != to)
        continue;
      for (std::size_t a = 0; a < D; ++a)
      {
        int weight = slopeDifferences[by[a]];
        for (std::size_t b = 0; b < D; ++b)
          weight *= b == a ? 1 : slopeMeans[by[b]];
        slope[a] += id == to ? weight : -weight;
      }
    }
    Normal m;
    for (std::size_t a = 0; a < D; ++a)
      m(static_cast<Eigen::Index>(a)) = slope[a] / edge_[a];
    const double length = m.norm();
    return length > 0 ? Normal(m / length) : Normal(Normal::Zero());
  }

  std::span<const std::uint8_t> phase_;
  std::array<double, D> edge_{};
  std::array<std::vector<std::int64_t>, D> around_; ///< by axis and node, the four voxels along it, times their stride
};

} // namespace lamella
