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
void GrainSystem<Dim>::updatePairs()
{
  bool stale = positionOfList_.size() != position.size();
  if (!stale)
  {
    // Under the affine part of the motion a pair comes nearer by its distance (below 2.5 diameters) times the strain.
    const Vec ratio = box.cwiseQuotient(boxOfList_);
    const double affine = 2.5 * (ratio.array() - 1).abs().maxCoeff();
    const double allowed = 0.5 * (skin_ - affine);
    stale = allowed <= 0;
    for (std::size_t i = 0; !stale && i < position.size(); ++i)
      stale = (position[i] - positionOfList_[i].cwiseProduct(ratio)).squaredNorm() > allowed * allowed;
  }
  ++sinceList_;
  if (!stale)
    return;
  // a short list where little moves
  if (sinceList_ < 30)
    skin_ = std::min(0.3, 1.5 * skin_);
  else if (sinceList_ > 150)
    skin_ = std::max(0.02, 0.7 * skin_);
  sinceList_ = 0;
  findPairs();
}

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
  std::array<int, 3> cells{ 1, 1, 1 };
  for (int a = 0; a < Dim; ++a)
    cells[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(box[a] / (2 * largest + skin_)), 1, 4096);
  const auto cellOf = [&](const Vec& x, int a)
  {
    const int n = cells[static_cast<std::size_t>(a)];
    return std::clamp(static_cast<int>(x[a] / box[a] * n), 0, n - 1);
  };
  const std::size_t total =
    static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]);
  const auto index = [&](std::array<int, 3> c)
  { return static_cast<std::size_t>(c[0] + cells[0] * (c[1] + cells[1] * c[2])); };
  std::vector<std::int32_t> first(total, -1);
  std::vector<std::int32_t> next(position.size(), -1);
  for (std::size_t i = position.size(); i-- > 0;) // so that each cell's grains are in rising order
  {
    std::array<int, 3> c{ 0, 0, 0 };
    for (int a = 0; a < Dim; ++a)
      c[static_cast<std::size_t>(a)] = cellOf(position[i], a);
    next[i] = first[index(c)];
    first[index(c)] = static_cast<std::int32_t>(i);
  }

  const bool wraps = std::find(periodic.begin(), periodic.end(), true) != periodic.end();
  pairs_.clear();
  image_.clear();
  spring_.clear();
  for (std::size_t i = 0; i < position.size(); ++i)
  {
    std::array<int, 3> centre{ 0, 0, 0 };
    std::array<std::array<int, 3>, 3> near{};
    std::array<int, 3> many{ 1, 1, 1 };
    for (int a = 0; a < Dim; ++a)
    {
      const auto axis = static_cast<std::size_t>(a);
      centre[axis] = cellOf(position[i], a);
      many[axis] = 0;
      for (int s = -1; s <= 1; ++s)
      {
        int c = centre[axis] + s;
        if (c < 0 || c >= cells[axis])
        {
          if (!periodic[axis])
            continue;
          c = (c + cells[axis]) % cells[axis];
        }
        const int* const begin = near[axis].data();
        const int* const end = begin + many[axis];
        if (std::find(begin, end, c) == end)
          near[axis][static_cast<std::size_t>(many[axis]++)] = c;
      }
    }
    for (int cz = 0; cz < many[2]; ++cz)
      for (int cy = 0; cy < many[1]; ++cy)
        for (int cx = 0; cx < many[0]; ++cx)
          for (std::int32_t j = first[index({ near[0][static_cast<std::size_t>(cx)],
                 near[1][static_cast<std::size_t>(cy)], near[2][static_cast<std::size_t>(cz)] })];
               j >= 0; j = next[static_cast<std::size_t>(j)])
          {
            if (static_cast<std::size_t>(j) <= i)
              continue;
            const Pair pair{ static_cast<std::int32_t>(i), j, radius[i] + radius[static_cast<std::size_t>(j)] };
            Vec image = Vec::Zero();
            Vec r = position[static_cast<std::size_t>(j)] - position[i];
            for (int a = 0; a < Dim; ++a)
              if (periodic[static_cast<std::size_t>(a)])
              {
                image[a] = -std::round(r[a] / box[a]);
                r[a] += image[a] * box[a];
              }
            const double reach = pair.reach + skin_;
            if (r.squaredNorm() > reach * reach)
              continue;
            if (wraps)
              image_.push_back(image);
            if (friction > 0)
            {
              const auto known = springs.find(key(pair.first, pair.second));
              spring_.push_back(known == springs.end() ? Vec::Zero() : known->second);
            }
            pairs_.push_back(pair);
          }
  }
  positionOfList_ = position;
  boxOfList_ = box;
}

template <int Dim>
void GrainSystem<Dim>::computeForces(double dt)
{
  updatePairs();
  std::fill(force.begin(), force.end(), Vec::Zero());
  energy = 0;
  virial.setZero();
  forceSum = 0;
  contacts = 0;
  findContacts();
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
void GrainSystem<Dim>::findContacts()
{
  touching_.resize(pairs_.size() + 1);
  std::size_t n = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
  {
    touching_[n] = static_cast<std::int32_t>(k);
    n += separation(k).squaredNorm() < pairs_[k].reach * pairs_[k].reach ? 1 : 0;
  }
  if (friction > 0)
  {
    std::size_t next = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      if (next < n && touching_[next] == static_cast<std::int32_t>(k))
        ++next;
      else
        spring_[k].setZero();
  }
  touching_.resize(n);
}

template <int Dim>
template <bool Rubs>
void GrainSystem<Dim>::addGrainContacts(double dt)
{
  for (const std::int32_t k : touching_)
  {
    const Pair& pair = pairs_[static_cast<std::size_t>(k)];
    const auto i = static_cast<std::size_t>(pair.first);
    const auto j = static_cast<std::size_t>(pair.second);
    const Vec r = separation(static_cast<std::size_t>(k));
    const double distance = std::sqrt(r.squaredNorm());
    const double overlap = pair.reach - distance;
    const Vec normal = r * (1 / distance);
    Vec onSecond = overlap * normal;
    energy += 0.5 * overlap * overlap;
    forceSum += overlap;
    if constexpr (Rubs)
    {
      const Vec slip = (velocity[j] - velocity[i] + boxRate.cwiseProduct(r) -
                         crossSpin<Dim>(spin[i], radius[i] * normal) - crossSpin<Dim>(spin[j], radius[j] * normal)) *
        dt;
      Vec& spring = spring_[static_cast<std::size_t>(k)];
      const Vec onFirst = tangentialForce(spring, normal, slip, friction * overlap);
      onSecond -= onFirst;
      torque[i] += crossForce<Dim>(radius[i] * normal, onFirst);
      torque[j] += crossForce<Dim>(radius[j] * normal, onFirst);
      energy += 0.5 * tangentialStiffness * spring.squaredNorm();
    }
    force[i] -= onSecond;
    force[j] += onSecond;
    virial += onSecond.cwiseProduct(r);
  }
  contacts += static_cast<std::int64_t>(touching_.size());
}

template <int Dim>
template <bool Rubs>
void GrainSystem<Dim>::addWallContacts(double dt)
{
  for (std::size_t i = 0; i < position.size(); ++i)
    for (int axis = 0; axis < Dim; ++axis)
    {
      const double x = position[i][axis];
      const bool near = std::min(x, box[axis] - x) < radius[i];
      if (periodic[static_cast<std::size_t>(axis)] || !(near || Rubs))
        continue;
      for (const int wall : { 2 * axis, 2 * axis + 1 })
      {
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
