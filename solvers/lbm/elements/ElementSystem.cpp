#include "lbm/elements/ElementSystem.h"

#include "core/Error.h"
#include "lbm/Connectivity.h"
#include "lbm/DirectedLinks.h"
#include "lbm/PlaneBalance.h"
#include "lbm/elements/ElementMultigrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace lamella::lbm
{
namespace
{

constexpr double leastTarget = 1e-14; // of the value's relative error
constexpr double safety = 3;          // on what the falls of the energy tell of what is left
constexpr double leastRate = 0.3;     // of these falls: one of them may be large by chance
constexpr double tensorRounding = std::numeric_limits<float>::epsilon() / 2;
constexpr double fluxRounding = std::numeric_limits<double>::epsilon(); // of the best conductor's, times the contrast
constexpr int restarts = 5; // from a new residual, where directions in single precision have drifted
// Means of the squares of 1, x, y, xy, z … on −1 to 1.
constexpr std::array<double, 7> squares{ 1, 1.0 / 3, 1.0 / 3, 1.0 / 9, 1.0 / 3, 1.0 / 9, 1.0 / 9 };

ElementBox boxOf(const Problem& problem)
{
  ElementBox box;
  box.elements = problem.lattice.size;
  box.periodic = problem.periodic();
  box.fixed = problem.options.sides == Sides::Periodic ? -1 : problem.axis;
  return box;
}

/// The tensors of a row of voxels, over the largest diffusivity, and of unlike edges by (δ_x / δ_a)(δ_x / δ_b).
class VoxelTensors
{
public:
  VoxelTensors(const Problem& problem, double scale)
    : nx_(problem.lattice.size[0])
    , ny_(problem.lattice.size[1])
    , phase_(problem.phase)
  {
    const DirectedDiffusivity* const directed = problem.options.directed.get();
    for (std::size_t id = 0; id < problem.diffusivity.size(); ++id)
    {
      along_.push_back(static_cast<float>((directed ? directed->along[id] : problem.diffusivity[id]) / scale));
      across_.push_back(static_cast<float>((directed ? directed->across[id] : problem.diffusivity[id]) / scale));
    }
    const std::array<double, 3>& aspect = problem.lattice.aspect;
    for (std::size_t c = 0; c < 6; ++c)
      factor_[c] = static_cast<float>(aspect[0] * aspect[0] / (aspect[axes[c][0]] * aspect[axes[c][1]]));
    if (along_ == across_)
      return;
    const bool volume = problem.lattice.dimension == 3;
    axis_.resize(phase_.size());
    std::int64_t lost = 0;
    for (std::size_t i = 0; i < phase_.size(); ++i)
    {
      const std::array<float, 3>& a = directed->axis[i];
      const double length = std::hypot(a[0], a[1], volume ? a[2] : 0.0);
      const bool none = !(length > 0) || !std::isfinite(length);
      lost += none && along_[phase_[i]] != across_[phase_[i]] ? 1 : 0;
      if (!none)
        for (std::size_t k = 0; k < 3; ++k)
          axis_[i][k] = k == 2 && !volume ? 0.0F : static_cast<float>(a[k] / length);
    }
    if (lost > 0)
      throw ParameterError(
        fmt::format("{} nodes of phases that conduct differently along and across have no axis to go by", lost),
        "give these nodes an axis, or the phase one value");
  }

  void row(std::int64_t y, std::int64_t z, float* const tensor[6]) const
  {
    const auto first = static_cast<std::size_t>(nx_ * (y + ny_ * z));
    for (std::size_t x = 0; x < static_cast<std::size_t>(nx_); ++x)
    {
      const float across = across_[phase_[first + x]];
      for (std::size_t c = 0; c < 6; ++c)
        tensor[c][x] = c < 3 ? factor_[c] * across : 0.0F;
    }
    if (axis_.empty())
      return;
    for (std::size_t x = 0; x < static_cast<std::size_t>(nx_); ++x)
    {
      const std::uint8_t id = phase_[first + x];
      const float more = along_[id] - across_[id];
      const std::array<float, 3>& a = axis_[first + x];
      for (std::size_t c = 0; c < 6; ++c)
        tensor[c][x] += factor_[c] * more * a[axes[c][0]] * a[axes[c][1]];
    }
  }
  /// Of length 1; 0: the voxel conducts the same in every direction.
  [[nodiscard]] std::array<float, 3> axis(std::size_t node) const
  {
    return axis_.empty() || along_[phase_[node]] == across_[phase_[node]] ? std::array<float, 3>{} : axis_[node];
  }
  [[nodiscard]] bool conducts(std::size_t node) const { return along_[phase_[node]] > 0 || across_[phase_[node]] > 0; }
  [[nodiscard]] std::size_t bytes() const noexcept { return axis_.size() * sizeof(axis_[0]); }

private:
  static constexpr std::array<std::array<std::size_t, 2>, 6> axes{ { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 },
    { 1, 2 } } };

  std::int64_t nx_;
  std::int64_t ny_;
  std::span<const std::uint8_t> phase_;
  std::vector<float> along_;
  std::vector<float> across_;
  std::array<float, 6> factor_{};
  std::vector<std::array<float, 3>> axis_; ///< of length 1 or 0; none where no phase has two values
};

class ElementSystem final : public Backend
{
public:
  explicit ElementSystem(const Problem& problem)
    : problem_(problem)
    , scale_(std::ranges::max(problem.diffusivity))
    , tensors_(problem, scale_)
    , op_(
        boxOf(problem), [this](std::int64_t y, std::int64_t z, float* const tensor[6]) { tensors_.row(y, z, tensor); },
        std::max(1, problem.options.threads))
    , multigrid_(op_)
    , v_(static_cast<std::size_t>(op_.box().nodes()), 0.0)
  {
    gradient_[static_cast<std::size_t>(problem.axis)] = -1;
  }
  ElementSystem(const ElementSystem&) = delete;
  ElementSystem& operator=(const ElementSystem&) = delete;

  SteadyResult solve() override
  {
    const SteadyOptions& options = problem_.options;
    const bool periodic = options.sides == Sides::Periodic;
    SteadyResult result;
    result.method = Method::Multigrid;
    result.nodes = problem_.lattice.count();
    for (std::size_t i = 0; i < problem_.phase.size(); ++i)
      result.stored += tensors_.conducts(i) ? 1 : 0;
    result.skipped = result.nodes - result.stored;
    const std::size_t n = v_.size();
    result.bytes = multigrid_.bytes() + tensors_.bytes() + problem_.phase.size() + n * (16 + 16);
    double target = std::min(options.tolerance, options.fieldTolerance * options.fieldTolerance);
    if (periodic) // the rest of a periodic cell's column errs like the field
      target = std::min(target, options.tolerance * options.tolerance);
    target = std::max(target, leastTarget);

    std::vector<double> r(n);
    std::vector<float> b(n);
    std::vector<float> z(n);
    std::vector<float> p(n);
    std::vector<float> q(n);
    const double units =
      std::pow(static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(problem_.axis)]), 2);
    double energy = units * sums().energy; // drops of 1 over a voxel
    double load = 0;                       // norm of the residual of the linear profile
    for (int start = 0;; ++start)
    {
      op_.apply<double>(v_, r, gradient_);
      for (double& value : r)
        value = -value;
      if (start == 0)
        load = std::sqrt(dot(r, r));
      std::ranges::fill(p, 0.0F);
      double before = 0;
      double fallBefore = 0;
      std::array<double, 3> rates{ 0, 0, 0 };
      bool first = true;
      for (;;)
      {
        const double norm = std::sqrt(dot(r, r));
        if (!(norm > 0))
        {
          result.solverError = 0;
          break;
        }
        for (std::size_t i = 0; i < n; ++i)
          b[i] = static_cast<float>(r[i] / norm); // far from the least float
        multigrid_.cycle(b, z);
        if (periodic)
          takeOffMean(z);
        const double now = norm * dot(r, z); // of the residual and what a cycle makes of it
        if (first && now <= target * energy && start > 0)
        {
          result.solverError = std::max(result.solverError, now / energy);
          break;
        }
        const double share = first ? 0.0 : now / before;
        before = now;
        for (std::size_t i = 0; i < n; ++i)
          p[i] = static_cast<float>(norm * static_cast<double>(z[i]) + share * static_cast<double>(p[i]));
        op_.apply<float>(p, q);
        const double along = dot(p, q);
        if (!(along > 0) || !std::isfinite(along))
          fail(result);
        const double step = now / along;
        for (std::size_t i = 0; i < n; ++i)
        {
          v_[i] += step * static_cast<double>(p[i]);
          r[i] -= step * static_cast<double>(q[i]);
        }
        ++result.iterations;
        const double fall = step * now;
        energy -= fall;
        if (!(energy > 0) || !std::isfinite(energy))
          fail(result);
        // what is left falls like what fell: as slowly as in the slowest of the last steps
        rates = { rates[1], rates[2], first ? 1.0 : fall / fallBefore };
        const double slowest = std::max(std::ranges::max(rates), leastRate);
        fallBefore = fall;
        result.solverError = slowest < 1 ? safety * fall / energy * slowest / (1 - slowest) : 1.0;
        first = false;
        reportProgress(options, problem_.comm, progressOf(result.solverError, target), "solving");
        if (result.solverError <= target)
          break;
        if (result.iterations >= options.maxIterations)
          fail(result);
      }
      if (first || start == restarts) // the residual, made anew, is as small as it was thought to be
        break;
    }
    balance();
    result.solverError = std::max(result.solverError, tensorRounding + fluxRounding * problem_.contrast());
    op_.apply<double>(v_, r, gradient_);
    result.residual = load > 0 ? std::sqrt(dot(r, r)) / load : 0.0;
    setEffective(result, sums(), problem_.lattice, problem_.axis, scale_);
    return result;
  }

  void value(std::span<double> out, Layers layers) const override
  {
    const ElementBox& box = op_.box();
    const auto axis = static_cast<std::size_t>(problem_.axis);
    const double length = static_cast<double>(box.elements[axis]);
    const auto at = [&](const std::array<std::int64_t, 3>& p)
    {
      double sum = 0;
      for (int k = 0; k < 4; ++k)
      {
        const auto corner = static_cast<std::size_t>(box.row(p[1] + (k & 1), p[2] + (k >> 1)) + p[0]);
        sum += v_[corner] + v_[corner + 1];
      }
      return sum / 8 / length;
    };
    if (!mean_)
    {
      double sum = 0;
      std::int64_t counted = 0;
      if (problem_.options.sides == Sides::Periodic)
        forVoxels(
          [&](std::size_t i, const std::array<std::int64_t, 3>& p)
          {
            if (!tensors_.conducts(i))
              return;
            sum += at(p);
            ++counted;
          });
      mean_ = counted > 0 ? sum / static_cast<double>(counted) : 0.0;
    }
    const std::int64_t before = box.elements[0] * box.elements[1] * layers.first;
    forVoxels(
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        const auto voxel = static_cast<std::size_t>(before) + i;
        out[i] = tensors_.conducts(voxel) ? at(p) + 1 - *mean_ - (static_cast<double>(p[axis]) + 0.5) / length
                                          : std::numeric_limits<double>::quiet_NaN();
      },
      layers);
  }

  void flux(std::span<double> out, Layers layers) const override
  {
    const std::array<double, 3>& aspect = problem_.lattice.aspect;
    const double length = static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(problem_.axis)]);
    const double unit = scale_ / length / problem_.lattice.spacingAlong(0);
    const std::int64_t nx = op_.box().elements[0];
    op_.forFluxes(v_, gradient_,
      [&](std::int64_t y, std::int64_t z, const double* const q[3], double)
      {
        if (z < layers.first || z >= layers.last)
          return;
        double* row = out.data() + 3 * nx * (y + op_.box().elements[1] * (z - layers.first));
        for (std::int64_t x = 0; x < nx; ++x)
          for (std::size_t a = 0; a < 3; ++a)
            row[3 * x + static_cast<std::int64_t>(a)] =
              a == 2 && problem_.lattice.dimension == 2 ? 0.0 : 0.0 - unit * aspect[a] / aspect[0] * q[a][x];
      });
  }

  [[nodiscard]] FieldEnergies energies() const override
  {
    const ElementBox& box = op_.box();
    const std::array<double, 3>& aspect = problem_.lattice.aspect;
    FieldEnergies energies;
    energies.along.assign(problem_.diffusivity.size(), 0.0);
    energies.across.assign(problem_.diffusivity.size(), 0.0);
    forVoxels(
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        std::array<double, 8> m{};
        for (std::size_t k = 0; k < 8; ++k)
          m[k] = v_[static_cast<std::size_t>(
            box.row(p[1] + static_cast<std::int64_t>(k >> 1 & 1), p[2] + static_cast<std::int64_t>(k >> 2)) + p[0] +
            static_cast<std::int64_t>(k & 1))];
        // corners to factors of 1, x, y, xy, z … on −1 to 1, times 8; such products are orthogonal
        for (const std::size_t bit : { 1, 2, 4 })
          for (std::size_t k = 0; k < 8; ++k)
            if ((k & bit) == 0)
            {
              const double low = m[k];
              m[k] += m[k | bit];
              m[k | bit] -= low;
            }
        double all = 0; // means over the voxel
        double along = 0;
        const std::array<float, 3> a = tensors_.axis(i);
        for (std::size_t k = 0; k < 7; ++k)
        {
          double own = 0;
          double projected = 0;
          for (std::size_t c = 0; c < 3; ++c)
            if ((k >> c & 1) == 0)
            {
              const double slope =
                aspect[0] / aspect[c] * (0.25 * m[k | std::size_t{ 1 } << c] + (k == 0 ? gradient_[c] : 0.0));
              own += slope * slope;
              projected += slope * a[c];
            }
          all += squares[k] * own;
          along += squares[k] * projected * projected;
        }
        energies.along[problem_.phase[i]] += along;
        energies.across[problem_.phase[i]] += all - along;
      });
    return energies;
  }

private:
  [[noreturn]] void fail(const SteadyResult& result) const
  {
    throw DivergenceError(fmt::format("elements: the value still errs by {:.1e} after {} iterations",
                            result.solverError, result.iterations),
      "allow more iterations, or a larger tolerance");
  }

  template <class F>
  void forVoxels(F&& f) const
  {
    forVoxels(f, { 0, op_.box().elements[2] });
  }
  // f(place among those of the layers, position)
  template <class F>
  void forVoxels(F&& f, Layers layers) const
  {
    const auto& e = op_.box().elements;
    std::size_t i = 0;
    for (std::int64_t z = layers.first; z < layers.last; ++z)
      for (std::int64_t y = 0; y < e[1]; ++y)
        for (std::int64_t x = 0; x < e[0]; ++x)
          f(i++, std::array<std::int64_t, 3>{ x, y, z });
  }

  // Over the nodes, of two copies one; rows are summed in parts that no number of threads changes.
  template <class A, class B>
  [[nodiscard]] double dot(const std::vector<A>& a, const std::vector<B>& b) const
  {
    const ElementBox& box = op_.box();
    std::vector<double> parts(static_cast<std::size_t>(box.owned(2)), 0.0);
    const int threads = op_.threads();
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t z = 0; z < box.owned(2); ++z)
      for (std::int64_t y = 0; y < box.owned(1); ++y)
      {
        const A* p = a.data() + box.row(y, z);
        const B* q = b.data() + box.row(y, z);
        double sum = 0;
#pragma omp simd reduction(+ : sum)
        for (std::int64_t x = 0; x < box.owned(0); ++x)
          sum += static_cast<double>(p[x]) * static_cast<double>(q[x]);
        parts[static_cast<std::size_t>(z)] += sum;
      }
    double total = 0;
    for (const double part : parts)
      total += part;
    return total;
  }

  // A constant is free in a periodic cell, and round-off would let it grow.
  void takeOffMean(std::vector<float>& z) const
  {
    double sum = 0;
    std::int64_t count = 0;
    for (const float value : z)
      if (value != 0)
      {
        sum += static_cast<double>(value);
        ++count;
      }
    const auto mean = static_cast<float>(count > 0 ? sum / static_cast<double>(count) : 0.0);
    for (float& value : z)
      if (value != 0)
        value -= mean;
  }

  // In the units of a field that falls by 1 over the box.
  struct Sums
  {
    FieldSums all;
    PlaneSums planes;
  };
  [[nodiscard]] Sums sumsAndPlanes() const
  {
    const ElementBox& box = op_.box();
    const auto axis = static_cast<std::size_t>(problem_.axis);
    const std::int64_t layers = box.elements[axis];
    struct Part
    {
      double energy = 0;
      std::array<double, 3> flux{ 0, 0, 0 };
      std::vector<double> layer, conductance;
    };
    std::vector<Part> parts(static_cast<std::size_t>(box.elements[2]));
    for (Part& part : parts)
    {
      part.layer.assign(static_cast<std::size_t>(layers), 0.0);
      part.conductance = part.layer;
    }
    op_.forFluxes(v_, gradient_,
      [&](std::int64_t y, std::int64_t z, const double* const q[3], double energy)
      {
        Part& part = parts[static_cast<std::size_t>(z)];
        part.energy += energy;
        std::vector<float> tensor(static_cast<std::size_t>(6 * box.elements[0]));
        float* rows[6];
        for (std::size_t c = 0; c < 6; ++c)
          rows[c] = tensor.data() + static_cast<std::ptrdiff_t>(c) * box.elements[0];
        tensors_.row(y, z, rows);
        for (std::int64_t x = 0; x < box.elements[0]; ++x)
        {
          for (std::size_t a = 0; a < 3; ++a)
            part.flux[a] -= q[a][x];
          const auto layer = static_cast<std::size_t>(axis == 0 ? x : axis == 1 ? y : z);
          part.layer[layer] -= q[axis][x];
          part.conductance[layer] += static_cast<double>(rows[axis][x]);
        }
      });
    const double unit = 1.0 / static_cast<double>(layers);
    Sums s{ {}, PlaneSums(static_cast<std::size_t>(layers)) };
    const bool periodic = problem_.options.sides == Sides::Periodic;
    for (const Part& part : parts)
    {
      s.all.energy += unit * unit * part.energy;
      for (std::size_t a = 0; a < 3; ++a)
        s.all.flux[a] += unit * part.flux[a];
      for (std::int64_t l = 0; l < layers; ++l)
      {
        const auto plane = static_cast<std::size_t>(periodic ? (l + 1) % layers : l);
        s.planes.flux[plane] += unit * part.layer[static_cast<std::size_t>(l)];
        s.planes.conductance[plane] += part.conductance[static_cast<std::size_t>(l)];
      }
    }
    s.all.inlet = s.planes.flux.front();
    s.all.outlet = periodic ? s.planes.flux[static_cast<std::size_t>(layers / 2)] : s.planes.flux.back();
    return s;
  }
  [[nodiscard]] FieldSums sums() const
  {
    return sumsAndPlanes().all;
  }

  // v is what is left of u n, without the linear profile.
  void balance()
  {
    const Sums s = sumsAndPlanes();
    const bool periodic = problem_.options.sides == Sides::Periodic;
    if (!std::ranges::all_of(s.planes.conductance, [](double c) { return c > 0; }))
      return;
    const PlaneBalance best(s.planes, s.all.energy, periodic, true);
    const ElementBox& box = op_.box();
    const auto axis = static_cast<std::size_t>(problem_.axis);
    const double n = static_cast<double>(box.elements[axis]);
    const auto shift = [&](std::int64_t plane)
    {
      if (periodic)
        return n * best.shift[static_cast<std::size_t>(plane % box.elements[axis])];
      return plane == 0 || plane == box.elements[axis]
        ? 0.0
        : n * best.shift[static_cast<std::size_t>(plane - 1)] + (best.factor - 1) * (n - static_cast<double>(plane));
    };
    for (std::int64_t z = 0; z < box.nodes(2); ++z)
      for (std::int64_t y = 0; y < box.nodes(1); ++y)
        for (std::int64_t x = 0; x < box.nodes(0); ++x)
        {
          double& value = v_[static_cast<std::size_t>(box.row(y, z) + x)];
          value = best.factor * value + shift(axis == 0 ? x : axis == 1 ? y : z);
        }
    PlaneBalance::requireGain(s.all.energy, sums().energy);
  }

  Problem problem_;
  double scale_;
  VoxelTensors tensors_;
  ElementOperator op_;
  ElementMultigrid multigrid_;
  std::vector<double> v_;              ///< what is left of the field, in drops of the linear profile over a voxel
  mutable std::optional<double> mean_; ///< of the field in a periodic cell, once it was asked for
  std::array<double, 3> gradient_{ 0, 0, 0 };
};

void requireTensors(const Problem& problem)
{
  if (problem.comm.parallel())
    throw ParameterError(fmt::format("elements on {} ranks", problem.comm.size()), "start one process, with threads");
  const DirectedDiffusivity* const d = problem.options.directed.get();
  if (d == nullptr)
    return;
  if (d->axis.size() != problem.phase.size())
    throw ParameterError(
      fmt::format("{} axes were given for {} nodes", d->axis.size(), problem.phase.size()), "give one for every node");
  if (d->along.size() != problem.diffusivity.size() || d->across.size() != problem.diffusivity.size())
    throw ParameterError(fmt::format("{} conductivities along and {} across were given for {} phases", d->along.size(),
                           d->across.size(), problem.diffusivity.size()),
      "give two for each phase");
  for (std::size_t id = 0; id < d->along.size(); ++id)
    for (const double value : { d->along[id], d->across[id] })
      if (!std::isfinite(value) || value < 0)
        throw ParameterError(
          fmt::format("a conductivity of phase {} is {}", id, value), "give finite values of at least 0");
}

} // namespace

std::unique_ptr<Backend> makeElementSystem(const Problem& problem)
{
  requireTensors(problem);
  const Halo halo(
    problem.lattice.dimension, problem.parts.block().size, problem.parts, problem.comm, problem.periodic());
  if (!findPercolation(problem.lattice, problem.parts, halo, problem.comm, problem.links(), problem.axis, problem.phase)
         .exists)
    throw NoPathError(fmt::format("no conducting path leads across the box along {}", "xyz"[problem.axis]),
      "give the phase that should conduct a conductivity above 0, or choose another window or direction");
  return std::make_unique<ElementSystem>(problem);
}

std::uint64_t elementBytes(const Lattice& lattice) noexcept
{
  return static_cast<std::uint64_t>(lattice.count()) * (lattice.dimension == 3 ? 80 : 140);
}

} // namespace lamella::lbm
