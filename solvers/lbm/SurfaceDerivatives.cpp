#include "lbm/SurfaceDerivatives.h"

#include "lbm/BoxField.h"
#include "lbm/PhaseRows.h"
#include "lbm/SurfaceSlope.h"

#include "core/Error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace lamella::lbm
{
namespace
{

using Vector = std::array<double, 3>;

/// The field and its phases around every node of this rank's block: of three planes at a time, which the backend gives
/// one by one where it can; else of a copy of the whole field in double.
class Surroundings
{
public:
  Surroundings(const Problem& problem, const Backend& backend, const PhaseRows& phases, BoxField* whole)
    : problem_(problem)
    , backend_(backend)
    , phases_(phases)
    , whole_(whole)
    , block_(problem.parts.block())
    , periodic_(problem.periodic())
    , stride_(block_.size[0] + 2)
  {
    if (whole_ == nullptr)
      for (std::vector<double>& plane : own_)
        plane.resize(static_cast<std::size_t>(stride_ * (block_.size[1] + 2)));
    for (int a = 0; a < problem.lattice.dimension; ++a)
      spacing_[static_cast<std::size_t>(a)] = problem.lattice.aspect[static_cast<std::size_t>(a)];
  }

  /// Takes the planes around z; all that is asked for then lies in them.
  void moveTo(std::int64_t z)
  {
    if (z == z_)
      return;
    z_ = z;
    const std::int64_t depth = problem_.lattice.dimension == 3 ? 1 : 0;
    for (std::int64_t dz = -depth; dz <= depth; ++dz)
    {
      const auto at = static_cast<std::size_t>(dz + 1);
      if (whole_ != nullptr)
      {
        planes_[at] = whole_->rowValues(0, z + dz);
        continue;
      }
      const auto slot = static_cast<std::size_t>((z + dz + 3) % 3);
      if (held_[slot] != z + dz)
        backend_.plane(held_[slot] = z + dz, own_[slot].data());
      planes_[at] = own_[slot].data() + stride_ + 1;
    }
  }

  /// Everything at one node of a row.
  struct Node
  {
    std::int64_t x = 0, y = 0, z = 0;
    std::uint8_t phase = 0;
    double u = 0;
  };

  [[nodiscard]] Node node(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return { x, y, z, phases_(y, z)[x], rowValues(y, z)[x] };
  }

  /// Whether there is a node at a place, which is then in `of`; its value is less the jump of a cell that repeats.
  bool neighbour(const Node& n, int axis, int step, Node& of) const
  {
    std::int64_t x = n.x;
    std::int64_t y = n.y;
    std::int64_t z = n.z;
    (axis == 0 ? x : axis == 1 ? y : z) += step;
    if (!inside(n, axis, step))
      return false;
    const std::int64_t wrapped = x < 0 ? x + block_.size[0] : x >= block_.size[0] ? x - block_.size[0] : x;
    of = { wrapped, y, z, phases_(y, z)[wrapped], rowValues(y, z)[wrapped] };
    if (periodic_[static_cast<std::size_t>(axis)] && axis == problem_.axis)
      of.u -= step / static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(axis)]);
    return true;
  }

  /// Unit normal out of the phase of a node; zeros where it lies on both sides alike.
  [[nodiscard]] Vector normal(const Node& n) const
  {
    const NearestNodes window{ problem_.lattice.dimension == 2 };
    const auto beside = [&](int dx) // beyond a side, its mirror image
    {
      const std::int64_t x = inside(n, 0, dx) ? n.x + dx : n.x;
      return x < 0 ? x + block_.size[0] : x >= block_.size[0] ? x - block_.size[0] : x;
    };
    const std::array<int, 3> slope = surfaceSlope(n.phase, window, std::array{ beside(-1), n.x, beside(1) },
      [&](int dy, int dz) { return phases_(inside(n, 1, dy) ? n.y + dy : n.y, inside(n, 2, dz) ? n.z + dz : n.z); });
    Vector sum{ slope[0] / spacing_[0], slope[1] / spacing_[1], slope[2] / spacing_[2] };
    const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (double& component : sum)
      component = length > 1e-9 ? component / length : 0;
    return sum;
  }

  /// Gradient of the field within the phase of a node, per spacing along x.
  [[nodiscard]] Vector gradient(const Node& n) const
  {
    Vector g{ 0, 0, 0 };
    for (int a = 0; a < problem_.lattice.dimension; ++a)
    {
      double within = 0;
      double all = 0;
      int links = 0;
      for (const int step : { -1, 1 })
      {
        Node other;
        double slope = 0;
        bool same = true;
        if (neighbour(n, a, step, other))
        {
          same = other.phase == n.phase;
          if (const double k = problem_.diffusivity[n.phase]; !std::isnan(other.u))
            slope = step * (other.u - n.u) * harmonicMean(k, problem_.diffusivity[other.phase]) / k;
        }
        else if (a == problem_.axis) // the face's value, half a spacing away
          slope = 2.0 * step * ((step < 0 ? 1.0 : 0.0) - n.u);
        all += slope / 2;
        within += same ? slope : 0;
        links += same ? 1 : 0;
      }
      const auto axis = static_cast<std::size_t>(a);
      g[axis] = (links > 0 ? within / links : all) / spacing_[axis];
    }
    return g;
  }

  [[nodiscard]] const Vector& spacing() const noexcept { return spacing_; }

  /// Which nodes of a row have another phase at a face: most have not.
  void mark(std::int64_t y, std::int64_t z, std::span<std::uint8_t> marks) const
  {
    const std::uint8_t* const row = phases_(y, z);
    const std::int64_t nx = block_.size[0];
    marks[0] = marks[static_cast<std::size_t>(nx - 1)] = 1; // where sides wrap or end
    for (std::int64_t x = 1; x < nx - 1; ++x)
      marks[static_cast<std::size_t>(x)] =
        static_cast<std::uint8_t>((row[x] ^ row[x - 1]) | (row[x] ^ row[x + 1])); // not 0 where one differs
    for (int a = 1; a < problem_.lattice.dimension; ++a)
      for (const int step : { -1, 1 })
        if (inside({ 0, y, z }, a, step))
        {
          const std::uint8_t* const other = a == 1 ? phases_(y + step, z) : phases_(y, z + step);
          for (std::int64_t x = 0; x < nx; ++x)
            marks[static_cast<std::size_t>(x)] |= static_cast<std::uint8_t>(row[x] ^ other[x]);
        }
  }

private:
  // Whether a step along an axis stays in the lattice.
  [[nodiscard]] bool inside(const Node& n, int axis, int step) const
  {
    const auto a = static_cast<std::size_t>(axis);
    const std::int64_t p = (axis == 0 ? n.x : axis == 1 ? n.y : n.z) + block_.start[a] + step;
    return periodic_[a] || (p >= 0 && p < problem_.lattice.size[a]);
  }

  [[nodiscard]] const double* rowValues(std::int64_t y, std::int64_t z) const noexcept
  {
    return planes_[static_cast<std::size_t>(z - z_ + 1)] + y * stride_;
  }

  const Problem& problem_;
  const Backend& backend_;
  const PhaseRows& phases_;
  BoxField* whole_;
  Block block_;
  std::array<bool, 3> periodic_;
  std::int64_t stride_;
  Vector spacing_{ 1, 1, 1 };
  std::int64_t z_ = -9;                            ///< of no plane
  std::array<const double*, 3> planes_{};          ///< values of their nodes at 0, 0, below, at and above z
  std::array<std::vector<double>, 3> own_;         ///< where there is no copy of the whole
  std::array<std::int64_t, 3> held_{ -9, -9, -9 }; ///< which planes those are
};

/// What the faces of one node add to the derivative and to the area of each pair.
void addNode(const Surroundings& around, const Surroundings::Node& n, std::span<const double> k, int dimension,
  double* shift, double* area)
{
  std::array<Surroundings::Node, 6> across;
  std::array<int, 6> axes{};
  std::size_t faces = 0;
  for (int a = 0; a < dimension; ++a)
    for (const int step : { -1, 1 })
      if (around.neighbour(n, a, step, across[faces]) && across[faces].phase != n.phase)
        axes[faces++] = a;
  if (faces == 0)
    return;
  const Vector normal = around.normal(n);
  const bool flat = normal != Vector{ 0, 0, 0 };
  const double own = k[n.phase];
  const bool conducts = own > 0 && !std::isnan(n.u);
  const Vector g = conducts ? around.gradient(n) : Vector{ 0, 0, 0 };
  const double square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
  const double out = g[0] * normal[0] + g[1] * normal[1] + g[2] * normal[2];
  for (std::size_t f = 0; f < faces; ++f)
  {
    const auto a = static_cast<std::size_t>(axes[f]);
    const double part = (flat ? std::abs(normal[a]) : 1.0) / around.spacing()[a];
    const double through = flat ? out : g[a];
    const double other = k[across[f].phase];
    const std::size_t i = std::min(n.phase, across[f].phase) * k.size() + std::max(n.phase, across[f].phase);
    area[i] += part / 2; // both sides count
    if (!conducts)
      continue;
    const double gain = n.phase < across[f].phase ? 1 : -1; // by the lower id's growth
    if (own > other)
      shift[i] += gain * part * (own - other) * (square - through * through);
    else if (other > own)
      shift[i] += gain * part * (1 / other - 1 / own) * own * own * through * through;
  }
}

} // namespace

SurfaceDerivatives surfaceDerivatives(const Problem& problem, const Backend& backend)
{
  if (problem.options.links || problem.options.pairs)
    throw ParameterError("derivatives by surfaces of links that were given",
      problem.options.pairs ? "give each phase one conductivity"
                            : "with conductivities along and across take elements, q1");
  if (std::optional<SurfaceDerivatives> moved = backend.surfaces())
    return *std::move(moved);
  SteadyOptions options = problem.options; // the field's rows are all that is asked for: elements have them, too
  options.stencil = problem.lattice.dimension == 3 ? Stencil::D3Q7 : Stencil::D2Q5;
  const Problem straight{ problem.lattice, problem.parts, problem.comm, options, problem.phase, problem.diffusivity,
    problem.axis, nullptr };
  const Block& block = problem.parts.block();
  const Halo halo(problem.lattice.dimension, block.size, problem.parts, problem.comm, problem.periodic());
  const PhaseRows phases(block, halo, problem.phase, problem.lattice.dimension);
  std::optional<BoxField> whole;
  if (!backend.hasPlanes())
  {
    whole.emplace(straight);
    {
      std::vector<double> value(problem.phase.size());
      backend.value(value, { 0, problem.parts.block().size[2] });
      whole->setValue(value);
    }
    whole->fillGhosts();
  }
  const std::size_t pairs = problem.diffusivity.size() * problem.diffusivity.size();
  const std::int64_t rows = block.size[1] * block.size[2];
  const std::int64_t parts = std::clamp<std::int64_t>(rows, 1, sumParts);
  std::vector<double> sums(2 * pairs * static_cast<std::size_t>(parts), 0.0);
  const int threads = problem.options.threads;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t part = 0; part < parts; ++part)
  {
    double* const shift = sums.data() + 2 * pairs * static_cast<std::size_t>(part);
    Surroundings around(straight, backend, phases, whole ? &*whole : nullptr);
    std::vector<std::uint8_t> marks(static_cast<std::size_t>(block.size[0]));
    for (std::int64_t row = part * rows / parts; row < (part + 1) * rows / parts; ++row)
    {
      around.moveTo(row / block.size[1]);
      around.mark(row % block.size[1], row / block.size[1], marks);
      for (std::int64_t x = 0; x < block.size[0]; ++x)
        if (marks[static_cast<std::size_t>(x)] != 0)
          addNode(around, around.node(x, row % block.size[1], row / block.size[1]), problem.diffusivity,
            problem.lattice.dimension, shift, shift + pairs);
    }
  }
  SurfaceDerivatives all{ std::vector<double>(pairs, 0.0), std::vector<double>(pairs, 0.0) };
  for (std::size_t i = 0; i < sums.size(); ++i)
    (i % (2 * pairs) < pairs ? all.shift : all.area)[i % pairs] += sums[i];
  problem.comm.sum(all.shift);
  problem.comm.sum(all.area);
  const auto axis = static_cast<std::size_t>(problem.axis);
  const double gradient = 1 / (static_cast<double>(problem.lattice.size[axis]) * problem.lattice.aspect[axis]);
  const auto nodes = static_cast<double>(problem.lattice.count());
  for (double& s : all.shift)
    s /= nodes * gradient * gradient;
  for (double& a : all.area)
    a /= nodes;
  return all;
}

} // namespace lamella::lbm
