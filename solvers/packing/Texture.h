#pragma once

#include "packing/GrainSystem.h"
#include "packing/Packing.h"

#include <cstddef>
#include <span>

/// Internal: contacts that point more one way than another, and what is done about it.
///
/// The directions of N contacts are a sample: the anisotropy of their fabric is a random number of about 1/√N (4 % for
/// 700), and smooth walls add to it, since grains along a wall touch each other along it. A round region turned by 90°
/// keeps its inner contacts, but with the opposite share in the anisotropy, so that a few turns even it out where whole
/// shears of the sample would only draw another random number.
namespace lamella::packing
{

template <int Dim>
class Texture
{
public:
  using Vec = typename GrainSystem<Dim>::Vec;
  using Square = Eigen::Matrix<double, Dim, Dim>;

  static constexpr double radius = 2; ///< of the region that is turned [mean diameters]

  /// @param packing the grains' contacts, and what statistics() says of them
  Texture(const GrainSystem<Dim>& grains, const Packing& packing, const PackingStatistics& statistics);

  /// The grain around which a turn is expected to leave the least anisotropy; none near a wall or one of those `tried`.
  [[nodiscard]] std::size_t regionToTurn(std::span<const std::size_t> tried) const;
  /// Turns the grains around one by 90°, from the direction of most contacts to that of fewest. What then overlaps has
  /// to be relaxed.
  void turn(GrainSystem<Dim>& grains, std::size_t middle) const;

private:
  const GrainSystem<Dim>& grains_;
  Square fabric_ = Square::Zero(); ///< sum of n ⊗ n over the contacts
  Square turn_ = Square::Identity();
  std::vector<Square> own_; ///< by grain: half of each of its contacts
};

extern template class Texture<2>;
extern template class Texture<3>;

} // namespace lamella::packing
