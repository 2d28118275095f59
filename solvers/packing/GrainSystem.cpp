// Contact forces (linear, harmonic overlap; tangential springs cut off at Coulomb's limit) and the list of near pairs.
#include "packing/GrainSystem.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace lamella::packing
{
namespace
{

template <int Dim>
Eigen::Matrix<double, Dim, 1> crossSpin(
  const typename GrainSystem<Dim>::Spin& w, const Eigen::Matrix<double, Dim, 1>& r)
{
  if constexpr (Dim == 2)
    return { -w[0] * r[1], w[0] * r[0] };
  else
    return w.cross(r);
}

template <int Dim>
typename GrainSystem<Dim>::Spin crossForce(
  const Eigen::Matrix<double, Dim, 1>& r, const Eigen::Matrix<double, Dim, 1>& f)
{
  if constexpr (Dim == 2)
    return typename GrainSystem<2>::Spin(r[0] * f[1] - r[1] * f[0]);
  else
    return r.cross(f);
}

// Moves the spring with the contact and gives the tangential force on the first partner.
template <class Vec>
Vec tangentialForce(Vec& spring, const Vec& normal, const Vec& slip, double limit)
{
  spring -= spring.dot(normal) * normal;
  spring += slip - slip.dot(normal) * normal;
  const double force = tangentialStiffness * spring.norm();
  if (force > limit)
    spring *= limit / force;
  return tangentialStiffness * spring;
}

} // namespace

template <int Dim>
void GrainSystem<Dim>::resize(std::size_t count)
{
  radius.resize(count);
  position.assign(count, Vec::Zero());
  velocity.assign(count, Vec::Zero());
  force.assign(count, Vec::Zero());
  spin.assign(count, Spin::Zero());
  torque.assign(count, Spin::Zero());
  wallSpring_.assign(count * walls, Vec::Zero());
  positionOfList_.clear();
}

template <int Dim>
double GrainSystem<Dim>::grainVolume() const noexcept
{
  double sum = 0;
  for (const double r : radius)
    sum += Dim == 2 ? std::numbers::pi * r * r : 4.0 / 3.0 * std::numbers::pi * r * r * r;
  return sum;
}

template <int Dim>
void GrainSystem<Dim>::strain(const Vec& factor)
{
  box = box.cwiseProduct(factor);
  for (Vec& x : position)
    x = x.cwiseProduct(factor);
}

template <int Dim>
bool GrainSystem<Dim>::stalePairs() const
{
  if (positionOfList_.size() != position.size() || sight != sightOfList_)
    return true;
  // Under the affine part of the motion a pair comes nearer by its distance times the strain.
  const Vec ratio = box.cwiseQuotient(boxOfList_);
  const double affine = farthestOfList_ * (ratio.array() - 1).abs().maxCoeff();
  const double allowed = 0.5 * (skin_ - affine);
  if (allowed <= 0)
    return true;
  double farthest = 0;
  for (std::size_t i = 0; i < position.size(); ++i)
    farthest = std::max(farthest, (position[i] - positionOfList_[i].cwiseProduct(ratio)).squaredNorm());
  return farthest > allowed * allowed;
}

template <int Dim>
void GrainSystem<Dim>::updatePairs()
{
  const bool stale = stalePairs();
  ++sinceList_;
  if (!stale)
    return;
  // a short list where little moves
  if (sinceList_ < 30)
    skin_ = std::min(0.3, 1.5 * skin_);
  else if (sinceList_ > 150)
    skin_ = std::max(0.02, 0.7 * skin_);
  sinceList_ = 0;
  ++pairsVersion_;
  findPairs();
  findNearWalls();
}

namespace
{

/// Grains by cells of the box.
template <int Dim>
class Cells
{
public:
  using Vec = typename GrainSystem<Dim>::Vec;

  /// @param size least edge of a cell
  Cells(const std::vector<Vec>& position, const Vec& box, const std::array<bool, Dim>& periodic, double size)
    : box_(box)
    , periodic_(periodic)
  {
    for (int a = 0; a < Dim; ++a)
      cells_[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(box[a] / size), 1, 4096);
    first_.assign(
      static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]),
      -1);
    next_.assign(position.size(), -1);
    for (std::size_t i = position.size(); i-- > 0;) // so that each cell's grains are in rising order
    {
      std::array<int, 3> c{ 0, 0, 0 };
      for (int a = 0; a < Dim; ++a)
        c[static_cast<std::size_t>(a)] = cellOf(position[i], a);
      next_[i] = first_[index(c)];
      first_[index(c)] = static_cast<std::int32_t>(i);
    }
  }

  /// visit(j) for all grains in the cell at x and next to it.
  template <class Visit>
  void forEachNear(const Vec& x, Visit&& visit) const
  {
    std::array<std::array<int, 3>, 3> near{};
    std::array<int, 3> many{ 1, 1, 1 };
    for (int a = 0; a < Dim; ++a)
      many[static_cast<std::size_t>(a)] = cellsNear(cellOf(x, a), a, near[static_cast<std::size_t>(a)]);
    for (int cz = 0; cz < many[2]; ++cz)
      for (int cy = 0; cy < many[1]; ++cy)
        for (int cx = 0; cx < many[0]; ++cx)
          for (std::int32_t j = first_[index({ near[0][static_cast<std::size_t>(cx)],
                 near[1][static_cast<std::size_t>(cy)], near[2][static_cast<std::size_t>(cz)] })];
               j >= 0; j = next_[static_cast<std::size_t>(j)])
            visit(j);
  }

private:
  [[nodiscard]] int cellOf(const Vec& x, int a) const
  {
    const int n = cells_[static_cast<std::size_t>(a)];
    return std::clamp(static_cast<int>(x[a] / box_[a] * n), 0, n - 1);
  }
  [[nodiscard]] std::size_t index(std::array<int, 3> c) const
  {
    return static_cast<std::size_t>(c[0] + cells_[0] * (c[1] + cells_[1] * c[2]));
  }
  /// Each once, also where a periodic axis has few. @return how many
  [[nodiscard]] int cellsNear(int centre, int a, std::array<int, 3>& near) const
  {
    const auto axis = static_cast<std::size_t>(a);
    int many = 0;
    for (int s = -1; s <= 1; ++s)
    {
      int c = centre + s;
      if (c < 0 || c >= cells_[axis])
      {
        if (!periodic_[axis])
          continue;
        c = (c + cells_[axis]) % cells_[axis];
      }
      const int* const begin = near.data();
      const int* const end = begin + many;
      if (std::find(begin, end, c) == end)
        near[static_cast<std::size_t>(many++)] = c;
    }
    return many;
  }

  Vec box_;
  std::array<bool, Dim> periodic_;
  std::array<int, 3> cells_{ 1, 1, 1 };
  std::vector<std::int32_t> first_; ///< of a cell
  std::vector<std::int32_t> next_;  ///< in the cell, of a grain
};

} // namespace

template <int Dim>
void GrainSystem<Dim>::findPairs()
{
  std::unordered_map<std::uint64_t, Vec> springs;
  const auto key = [](std::int32_t a, std::int32_t b)
  { return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b); };
  if (friction > 0)
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      if (!spring_[k].isZero(0))
        springs.emplace(key(pairs_[k].first, pairs_[k].second), spring_[k]);

  for (int a = 0; a < Dim; ++a)
    if (periodic[static_cast<std::size_t>(a)])
      for (Vec& x : position)
        x[a] -= box[a] * std::floor(x[a] / box[a]);

  const double largest = *std::max_element(radius.begin(), radius.end());
  const Cells<Dim> cells(position, box, periodic, 2 * largest + sight + skin_);
  const bool wraps = std::find(periodic.begin(), periodic.end(), true) != periodic.end();
  pairs_.clear();
  image_.clear();
  spring_.clear();
  for (std::size_t i = 0; i < position.size(); ++i)
    cells.forEachNear(position[i],
      [&](std::int32_t j)
      {
        if (static_cast<std::size_t>(j) <= i)
          return;
        const Pair pair{ static_cast<std::int32_t>(i), j, radius[i] + radius[static_cast<std::size_t>(j)] };
        Vec image = Vec::Zero();
        Vec r = position[static_cast<std::size_t>(j)] - position[i];
        for (int a = 0; a < Dim; ++a)
          if (periodic[static_cast<std::size_t>(a)])
          {
            image[a] = -std::round(r[a] / box[a]);
            r[a] += image[a] * box[a];
          }
        const double reach = pair.reach + sight + skin_;
        if (r.squaredNorm() > reach * reach)
          return;
        if (wraps)
          image_.push_back(image);
        if (friction > 0)
        {
          const auto known = springs.find(key(pair.first, pair.second));
          spring_.push_back(known == springs.end() ? Vec::Zero() : known->second);
        }
        pairs_.push_back(pair);
      });
  positionOfList_ = position;
  boxOfList_ = box;
  // of grains that are not very uneven it is far below the 2.5; the room lets lists of pairs live equally long
  farthestOfList_ = std::max(2.5, 2 * largest + sight + skin_);
  sightOfList_ = sight;
}

template <int Dim>
void GrainSystem<Dim>::rub(double coefficient)
{
  friction = coefficient;
  std::fill(wallSpring_.begin(), wallSpring_.end(), Vec::Zero());
  pairs_.clear();
  spring_.clear();
  positionOfList_.clear();
}

template <int Dim>
void GrainSystem<Dim>::findNearWalls()
{
  nearWalls_.clear();
  for (std::size_t i = 0; i < position.size(); ++i)
    for (int wall = 0; wall < walls; ++wall)
      if (periodic[static_cast<std::size_t>(wall / 2)])
        continue;
      else if (wallOverlap(i, wall) > -skin_)
        nearWalls_.push_back({ static_cast<std::int32_t>(i), wall });
      else
        wallSpring_[i * walls + static_cast<std::size_t>(wall)].setZero();
}

template <int Dim>
void GrainSystem<Dim>::computeForces(double dt)
{
  updatePairs();
  std::fill(force.begin(), force.end(), Vec::Zero());
  if (image_.empty())
    findContacts<false>();
  else
    findContacts<true>();
  measureContacts();
  if (friction > 0)
  {
    std::fill(torque.begin(), torque.end(), Spin::Zero());
    addGrainContacts<true>(dt);
    addWallContacts<true>(dt);
  }
  else
  {
    addGrainContacts<false>(dt);
    addWallContacts<false>(dt);
  }
}

// The pairs that touch, without a branch: which do is unpredictable.
template <int Dim>
template <bool Wraps>
void GrainSystem<Dim>::findContacts()
{
  const std::size_t room = pairs_.size() + 1;
  if (touching_.size() < room)
  {
    const std::size_t more = room + room / 8;
    touching_.resize(more);
    branch_.resize(more);
    for (Values* values : { &distance_, &overlap_, &push_ })
      values->resize(static_cast<Eigen::Index>(more));
  }
  // copies and bare pointers: what is written below could be any member, as far as the compiler can see
  const Vec* const x = position.data();
  const Pair* const pairs = pairs_.data();
  const Vec* const image = image_.data();
  const std::size_t count = pairs_.size();
  const Vec edges = box;
  std::int32_t* const touching = touching_.data();
  Vec* const branch = branch_.data();
  double* const square = distance_.data();
  double* const reach = overlap_.data();
  std::size_t n = 0;
  for (std::size_t k = 0; k < count; ++k)
  {
    const double most = pairs[k].reach;
    Vec r = x[pairs[k].second] - x[pairs[k].first];
    if constexpr (Wraps)
      r += image[k].cwiseProduct(edges);
    const double squared = r.squaredNorm();
    touching[n] = static_cast<std::int32_t>(k);
    branch[n] = r;
    square[n] = squared;
    reach[n] = most;
    n += squared < most * most ? 1 : 0;
  }
  touchingCount_ = static_cast<Eigen::Index>(n);
  if (friction > 0)
  {
    std::size_t next = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      if (next < n && touching_[next] == static_cast<std::int32_t>(k))
        ++next;
      else
        spring_[k].setZero();
  }
}

// From squares of distances and sums of radii, which findContacts() left here.
template <int Dim>
void GrainSystem<Dim>::measureContacts()
{
  auto distance = distance_.head(touchingCount_);
  auto overlap = overlap_.head(touchingCount_);
  distance = distance.sqrt();
  overlap -= distance;
  push_.head(touchingCount_) = overlap / distance;
  energy = 0.5 * overlap.square().sum();
  forceSum = overlap.sum();
  contacts = touchingCount_;
}

template <int Dim>
template <bool Rubs>
void GrainSystem<Dim>::addGrainContacts(double dt)
{
  // bare pointers, as in findContacts()
  const Pair* const pairs = pairs_.data();
  const std::int32_t* const touching = touching_.data();
  const Vec* const branch = branch_.data();
  const double* const push = push_.data();
  Vec* const net = force.data();
  Vec work = Vec::Zero();
  double rubbing = 0;
  const auto count = static_cast<std::size_t>(touchingCount_);
  for (std::size_t k = 0; k < count; ++k)
  {
    const auto index = static_cast<std::size_t>(touching[k]);
    const auto i = static_cast<std::size_t>(pairs[index].first);
    const auto j = static_cast<std::size_t>(pairs[index].second);
    const Vec r = branch[k];
    Vec onSecond = push[k] * r;
    if constexpr (Rubs)
    {
      const auto at = static_cast<Eigen::Index>(k);
      const Vec normal = r * (1 / distance_[at]);
      const Vec slip = (velocity[j] - velocity[i] + boxRate.cwiseProduct(r) -
                         crossSpin<Dim>(spin[i], radius[i] * normal) - crossSpin<Dim>(spin[j], radius[j] * normal)) *
        dt;
      Vec& spring = spring_[index];
      const Vec onFirst = tangentialForce(spring, normal, slip, friction * overlap_[at]);
      onSecond -= onFirst;
      torque[i] += crossForce<Dim>(radius[i] * normal, onFirst);
      torque[j] += crossForce<Dim>(radius[j] * normal, onFirst);
      rubbing += 0.5 * tangentialStiffness * spring.squaredNorm();
    }
    net[i] -= onSecond;
    net[j] += onSecond;
    work += onSecond.cwiseProduct(r);
  }
  virial = work;
  energy += rubbing;
}

template <int Dim>
template <bool Rubs>
void GrainSystem<Dim>::addWallContacts(double dt)
{
  for (const auto [grain, wall] : nearWalls_)
  {
    const auto i = static_cast<std::size_t>(grain);
    const int axis = wall / 2;
    const double overlap = wallOverlap(i, wall);
    Vec& spring = wallSpring_[i * walls + static_cast<std::size_t>(wall)];
    if (overlap <= 0)
    {
      if (Rubs)
        spring.setZero();
      continue;
    }
    energy += 0.5 * overlap * overlap;
    forceSum += overlap;
    ++contacts;
    const double push = wall % 2 == 0 ? overlap : -overlap;
    force[i][axis] += push;
    virial[axis] += overlap * (radius[i] - overlap);
    if constexpr (Rubs)
    {
      const Vec normal = wallNormal(wall);
      const Vec slip = -(velocity[i] + crossSpin<Dim>(spin[i], radius[i] * normal)) * dt;
      const Vec tangential = tangentialForce(spring, normal, slip, friction * overlap);
      force[i] += tangential;
      torque[i] += crossForce<Dim>(radius[i] * normal, tangential);
      energy += 0.5 * tangentialStiffness * spring.squaredNorm();
    }
  }
}

template <int Dim>
double GrainSystem<Dim>::unbalanced() const noexcept
{
  double sum = 0;
  for (const Vec& f : force)
    sum += f.norm();
  if (sum == 0)
    return 0;
  if (contacts == 0)
    return std::numeric_limits<double>::infinity();
  return sum / static_cast<double>(count()) / (forceSum / static_cast<double>(contacts));
}

template class GrainSystem<2>;
template class GrainSystem<3>;

} // namespace lamella::packing
