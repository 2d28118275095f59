#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

/// Internal: disks and spheres that press on each other and on walls, in a box whose edges can change. Lengths in mean
/// diameters, forces in (normal stiffness × mean diameter), masses 1.
namespace lamella::packing
{

/// Of the normal stiffness; 2/7 to 1 are in use, without effect on a slow packing.
inline constexpr double tangentialStiffness = 0.8;

template <int Dim>
class GrainSystem
{
public:
  using Vec = Eigen::Matrix<double, Dim, 1>;
  using Spin = Eigen::Matrix<double, Dim == 2 ? 1 : 3, 1>;
  static constexpr int walls = 2 * Dim; ///< low x, high x, low y, ...

  /// Two grains near each other; 16 bytes, as most of the time goes into seeing which touch.
  struct Pair
  {
    std::int32_t first;
    std::int32_t second;
    double reach; ///< sum of the radii
  };

  std::vector<double> radius;
  std::vector<Vec> position;
  std::vector<Vec> velocity;
  std::vector<Vec> force;
  std::vector<Spin> spin;
  std::vector<Spin> torque;
  Vec box = Vec::Ones();
  Vec boxRate = Vec::Zero(); ///< d ln box / dt
  std::array<bool, Dim> periodic{};
  double friction = 0;
  double sight = 0; ///< pairs() has all that are nearer than this, and not only those that touch [diameters]

  // set by computeForces()
  double energy = 0;
  Vec virial = Vec::Zero(); ///< − dU / d ln box
  double forceSum = 0;      ///< of all contacts' normal forces
  std::int64_t contacts = 0;

  void resize(std::size_t count);
  [[nodiscard]] std::size_t count() const noexcept { return radius.size(); }
  [[nodiscard]] double volume() const noexcept { return box.prod(); }
  [[nodiscard]] double grainVolume() const noexcept;

  /// Forces, torques, energy and virial of the state as it is; `dt` is the time since the last call, by which the
  /// tangential springs have moved.
  void computeForces(double dt);

  /// Scales the box and all positions.
  void strain(const Vec& factor);

  /// Mean magnitude of a grain's net force over the mean normal contact force; infinite when there is no contact and 0
  /// when there is no force at all.
  [[nodiscard]] double unbalanced() const noexcept;

  [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }
  /// Another number whenever pairs() is another list.
  [[nodiscard]] std::int64_t pairsVersion() const noexcept { return pairsVersion_; }
  /// From the first grain's centre to the second's (its nearest image in a periodic box).
  [[nodiscard]] Vec separation(std::size_t pair) const noexcept
  {
    const Pair& p = pairs_[pair];
    Vec r = position[static_cast<std::size_t>(p.second)] - position[static_cast<std::size_t>(p.first)];
    if (!image_.empty())
      r += image_[pair].cwiseProduct(box);
    return r;
  }
  /// Tangential spring of a pair (friction only).
  [[nodiscard]] const Vec& spring(std::size_t pair) const noexcept { return spring_[pair]; }
  /// Overlap with a wall; negative: the gap.
  [[nodiscard]] double wallOverlap(std::size_t grain, int wall) const noexcept
  {
    const int axis = wall / 2;
    const double x = position[grain][axis];
    return radius[grain] - (wall % 2 == 0 ? x : box[axis] - x);
  }
  /// Unit vector from the grain into the wall.
  [[nodiscard]] static Vec wallNormal(int wall)
  {
    Vec n = Vec::Zero();
    n[wall / 2] = wall % 2 == 0 ? -1 : 1;
    return n;
  }
  /// Force of the tangential spring on the grain (friction only).
  [[nodiscard]] const Vec& wallSpring(std::size_t grain, int wall) const noexcept
  {
    return wallSpring_[grain * walls + static_cast<std::size_t>(wall)];
  }

  /// Finds the pairs anew where grains have moved or the box has changed since.
  void updatePairs();

  /// With friction from here on: tangential springs begin without a force.
  void rub(double coefficient);

private:
  /// Near a wall: found with the pairs.
  struct NearWall
  {
    std::int32_t grain;
    std::int32_t wall;
  };
  /// Numbers by touching pair, in rows of equal length: whole rows are computed at once.
  using Values = Eigen::Array<double, Eigen::Dynamic, 1>;

  [[nodiscard]] bool stalePairs() const;
  void findPairs();
  void findNearWalls();
  template <bool Wraps>
  void findContacts();
  void measureContacts();
  template <bool Rubs>
  void addGrainContacts(double dt);
  template <bool Rubs>
  void addWallContacts(double dt);

  std::vector<Pair> pairs_;
  std::vector<Vec> image_;  ///< #pairs in a periodic box, else empty: what is added to the second, in box edges
  std::vector<Vec> spring_; ///< #pairs with friction, else empty
  std::vector<NearWall> nearWalls_;
  std::vector<std::int32_t> touching_; ///< indices into pairs_, and room to spare
  std::vector<Vec> branch_;            ///< separations of those that touch
  Values distance_;                    ///< likewise
  Values overlap_;
  Values push_; ///< normal force over distance
  Eigen::Index touchingCount_ = 0;
  std::vector<Vec> wallSpring_;
  std::vector<Vec> positionOfList_;
  Vec boxOfList_ = Vec::Zero();
  double farthestOfList_ = 0; ///< no pair of the list was farther apart than this
  double skin_ = 0.2;
  double sightOfList_ = 0;
  std::int64_t pairsVersion_ = 0;
  int sinceList_ = 0; ///< calls of updatePairs() since the list was made
};

extern template class GrainSystem<2>;
extern template class GrainSystem<3>;

} // namespace lamella::packing
