#include "mpm/MaterialPoints.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace lamella::mpm
{

template <int Dim>
MaterialPoints<Dim>::MaterialPoints(std::size_t count, int history)
  : count_(count)
  // an odd number of cache lines, or all columns of a point would fall upon the same lines of the first cache
  , pitch_(((count + padding + 7) / 8 | 1) * 8)
  , columns_(histories + history)
  , data_(pitch_ * static_cast<std::size_t>(columns_))
  , phase_(count + padding)
  , id_(count)
{
  for (int i = 0; i < Dim; ++i)
    std::fill_n(column(deformations + i * (Dim + 1)).data(), pitch_, 1.0);
  std::fill_n(column(axes).data(), pitch_, 1.0);
  std::iota(id_.begin(), id_.end(), 0U);
}

template <int Dim>
std::size_t MaterialPoints<Dim>::bytes() const noexcept
{
  return (data_.size() + affine_.size()) * sizeof(double) + phase_.size() + id_.size() * sizeof(std::uint32_t);
}

template <int Dim>
void MaterialPoints<Dim>::setAffines(const Matrix<Dim>& c) noexcept
{
  common_ = c;
  stored_ = false;
  decltype(affine_)().swap(affine_);
}

template <int Dim>
void MaterialPoints<Dim>::storeAffines()
{
  if (stored_)
    return;
  affine_.resize(pitch_ * Dim * Dim);
  for (std::size_t i = 0; i < Dim * Dim; ++i)
    std::fill_n(affine_.begin() + static_cast<std::ptrdiff_t>(i * pitch_), pitch_, common_.m[i]);
  stored_ = true;
}

template <int Dim>
void MaterialPoints<Dim>::changeAffines(double keep, int axis, double rate)
{
  const auto change = [&](double c, int i) { return keep * c + (i == axis * (Dim + 1) ? rate : 0); };
  for (int i = 0; i < Dim * Dim; ++i)
  {
    common_.m[i] = change(common_.m[i], i);
    if (stored_)
      for (double& c : column(affines() + i))
        c = change(c, i);
  }
}

template <int Dim>
void MaterialPoints<Dim>::reorder(std::span<const std::uint32_t> order)
{
#pragma omp parallel if (count_ > 2000)
  {
    const auto old = std::make_unique_for_overwrite<double[]>(count_);
#pragma omp for schedule(dynamic, 1)
    for (int c = 0; c < columns(); ++c)
    {
      double* const values = at(c);
      std::copy_n(values, count_, old.get());
      for (std::size_t p = 0; p < count_; ++p)
        values[p] = old[order[p]];
    }
  }
  std::vector<std::uint32_t> ids(count_);
  std::vector<std::uint8_t> phases(phase_.size());
#pragma omp parallel for schedule(static) if (count_ > 2000)
  for (std::size_t p = 0; p < count_; ++p)
  {
    ids[p] = id_[order[p]];
    phases[p] = phase_[order[p]];
  }
  id_.swap(ids);
  phase_.swap(phases);
}

template <int Dim>
MaterialPoints<Dim> pointsFromLattice(const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::array<float, Dim>> axis, const PointOptions& options)
{
  MaterialPoints<Dim> points = pointsFromLattice<Dim>(lattice, { { 0, 0, 0 }, lattice.size }, phase, axis, options, 0);
  if (points.count() == 0)
    throw InputError(fmt::format("all {} nodes are empty (phase {})", lattice.count(), options.empty),
      "look at which phase is the empty one");
  return points;
}

template <int Dim>
MaterialPoints<Dim> pointsFromLattice(const Lattice& lattice, const Block& part, std::span<const std::uint8_t> phase,
  std::span<const std::array<float, Dim>> axis, const PointOptions& options, std::int64_t firstNumber)
{
  if (lattice.dimension != Dim)
    throw ParameterError(
      fmt::format("a lattice of {} dimensions for points in {}", lattice.dimension, Dim), "take points of as many");
  const int k = options.perNode;
  if (k < 1)
    throw ParameterError(fmt::format("{} points a node and direction", k), "at least 1");
  const auto nodes = static_cast<std::size_t>(part.count());
  if (phase.size() != nodes || (!axis.empty() && axis.size() != nodes))
    throw InputError(fmt::format("{} phases and {} directions for {} nodes", phase.size(), axis.size(), nodes),
      "give one a node, or no directions");
  std::size_t solid = 0;
  for (const std::uint8_t id : phase)
    if (id != options.empty)
    {
      ++solid;
      const std::size_t row = options.density.size() == 1 ? 0 : id;
      if (row >= options.density.size() || !(options.density[row] > 0))
        throw ParameterError(row >= options.density.size()
            ? fmt::format("no density for phase {}", id)
            : fmt::format("a density of {} kg/m³ for phase {}", options.density[row], id),
          "give each phase a density above 0");
    }
  const double each = std::pow(k, Dim);
  const double all = static_cast<double>(firstNumber) + static_cast<double>(solid) * each;
  if (all > std::numeric_limits<std::uint32_t>::max())
    throw InputError(
      fmt::format("{} nodes with {} points each are too many", std::floor(all / each), each), "at most 2³² - 1 points");

  using Points = MaterialPoints<Dim>;
  Points points(solid * static_cast<std::size_t>(each), options.history);
  const double side = lattice.spacing / k;
  const double volume = std::pow(side, Dim);
  std::size_t p = 0;
  for (std::int64_t z = 0; z < part.size[2]; ++z)
    for (std::int64_t y = 0; y < part.size[1]; ++y)
      for (std::int64_t x = 0; x < part.size[0]; ++x)
      {
        const auto node = static_cast<std::size_t>(x + part.size[0] * (y + part.size[1] * z));
        if (phase[node] == options.empty)
          continue;
        Vector<Dim> along{};
        along[0] = 1;
        double length = 0;
        for (int i = 0; i < Dim && !axis.empty(); ++i)
          length += static_cast<double>(axis[node][i]) * static_cast<double>(axis[node][i]);
        for (int i = 0; i < Dim && length > 0; ++i)
          along[i] = static_cast<double>(axis[node][i]) / std::sqrt(length);
        const double density = options.density[options.density.size() == 1 ? 0 : phase[node]];
        const std::array<std::int64_t, 3> at{ x + part.start[0], y + part.start[1], z + part.start[2] };
        for (int n = 0; n < static_cast<int>(each); ++n, ++p)
        {
          Vector<Dim> position;
          for (int i = 0, rest = n; i < Dim; ++i, rest /= k)
            position[i] =
              lattice.origin[i] + lattice.spacing * (static_cast<double>(at[i]) - 0.5) + side * (rest % k + 0.5);
          points.setVector(Points::positions, p, position);
          points.setVector(Points::axes, p, along);
          points.column(Points::masses)[p] = density * volume;
          points.column(Points::volumes)[p] = volume;
          points.phase()[p] = phase[node];
          points.id()[p] = static_cast<std::uint32_t>(firstNumber + static_cast<std::int64_t>(p));
        }
      }
  return points;
}

template class MaterialPoints<2>;
template class MaterialPoints<3>;
template MaterialPoints<2> pointsFromLattice<2>(
  const Lattice&, std::span<const std::uint8_t>, std::span<const std::array<float, 2>>, const PointOptions&);
template MaterialPoints<3> pointsFromLattice<3>(
  const Lattice&, std::span<const std::uint8_t>, std::span<const std::array<float, 3>>, const PointOptions&);
template MaterialPoints<2> pointsFromLattice<2>(const Lattice&, const Block&, std::span<const std::uint8_t>,
  std::span<const std::array<float, 2>>, const PointOptions&, std::int64_t);
template MaterialPoints<3> pointsFromLattice<3>(const Lattice&, const Block&, std::span<const std::uint8_t>,
  std::span<const std::array<float, 3>>, const PointOptions&, std::int64_t);

} // namespace lamella::mpm
