#include "lbm/elements/ElementSystem.h"

#include "core/Error.h"
#include "lattice/SurfaceMotions.h"
#include "lbm/Connectivity.h"
#include "lbm/DirectedDiffusivity.h"
#include "lbm/PlaneBalance.h"
#include "lbm/elements/ElementMultigrid.h"
#include "lbm/elements/ElementShare.h"
#include "lbm/elements/VoxelTensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
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
constexpr double seenByCycle = 1e-3;                                    // of an error's energy, at the least
constexpr int restarts = 5; // from a new residual, where directions in single precision have drifted
// Means of the squares of 1, x, y, xy, z … on −1 to 1.
constexpr std::array<double, 7> squares{ 1, 1.0 / 3, 1.0 / 3, 1.0 / 9, 1.0 / 3, 1.0 / 9, 1.0 / 9 };

/// What some phases have by voxel; empty where none has.
struct VoxelArrays
{
  std::vector<std::array<float, 3>> axis;
  std::vector<SymmetricTensor<float>> tensor;
};

/// Elements and their field: those that a rank works on, then the voxels of its block.
struct Piece
{
  std::array<std::int64_t, 3> start; ///< in the lattice, in the elements' axes
  VoxelTensors tensors;
  ElementOperator op;
  std::vector<double> v; ///< what is left of the field, in drops of the linear profile over a voxel

  Piece(const Problem& problem, double scale, const ElementShare& share, const Block& block, const ElementBox& box,
    std::span<const std::uint8_t> phase, VoxelArrays&& given)
    : start(share.turned(block.start))
    , tensors(problem, scale, share, block, phase, std::move(given.axis), std::move(given.tensor))
    , op(
        box, [this](std::int64_t y, std::int64_t z, float* const tensor[6]) { tensors.row(y, z, tensor); },
        std::max(1, problem.options.threads))
  {
  }
  Piece(const Piece&) = delete;
  Piece& operator=(const Piece&) = delete;

  /// f(place of the voxel in the lattice's order, its position) of rows of elements
  template <class F>
  void forVoxels(const ElementOperator::RowRange& rows, F&& f) const
  {
    for (std::int64_t z = rows[1][0]; z < rows[1][1]; ++z)
      for (std::int64_t y = rows[0][0]; y < rows[0][1]; ++y)
        for (std::int64_t x = 0; x < op.box().elements[0]; ++x)
          f(tensors.first(y, z) + static_cast<std::size_t>(x), std::array<std::int64_t, 3>{ x, y, z });
  }
  [[nodiscard]] ElementOperator::RowRange all() const
  {
    return { { { 0, op.box().elements[1] }, { 0, op.box().elements[2] } } };
  }
};

class ElementSystem final : public Backend
{
public:
  explicit ElementSystem(const Problem& problem)
    : problem_(problem)
    , scale_(std::ranges::max(problem.diffusivity))
    , share_(problem_)
    , axis_(share_.order()[static_cast<std::size_t>(problem.axis)])
    , phase_(share_.moves() ? share_.toSlab(problem.phase) : std::vector<std::uint8_t>{})
    , piece_(std::make_unique<Piece>(
        problem_, scale_, share_, share_.slab(), share_.box(), share_.moves() ? phase_ : problem.phase, arraysOfSlab()))
    , multigrid_(std::make_unique<ElementMultigrid>(piece_->op))
  {
    piece_->v.assign(static_cast<std::size_t>(share_.box().nodes()), 0.0);
    gradient_[static_cast<std::size_t>(axis_)] = -1;
  }

  SteadyResult solve() override
  {
    const SteadyOptions& options = problem_.options;
    const bool periodic = options.sides == Sides::Periodic;
    SteadyResult result;
    result.method = Method::Multigrid;
    result.nodes = problem_.lattice.count();
    const ElementOperator& op = piece_->op;
    std::vector<double>& v = piece_->v;
    for (const std::uint8_t id : problem_.phase)
      result.stored += problem_.diffusivity[id] > 0 ? 1 : 0;
    result.stored = problem_.comm.sum(result.stored);
    result.skipped = result.nodes - result.stored;
    const std::size_t n = v.size();
    result.bytes = static_cast<std::uint64_t>(problem_.comm.sum(static_cast<std::int64_t>(
      multigrid_->bytes() + piece_->tensors.bytes() + problem_.phase.size() + phase_.size() + n * (16 + 16))));
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
      op.apply<double>(v, r, gradient_);
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
        multigrid_->cycle(b, z);
        if (periodic)
          takeOffMean(z);
        const double now = norm * dot(r, z); // of the residual and what a cycle makes of it
        if (first && now <= target * energy && start > 0)
        {
          result.solverError = std::max(result.solverError, now / energy);
          break;
        }
        if (!first && now <= seenByCycle * leastTarget * energy) // exact at once: what falls on is round-off
        {
          result.solverError = leastTarget;
          break;
        }
        const double share = first ? 0.0 : now / before;
        before = now;
        for (std::size_t i = 0; i < n; ++i)
          p[i] = static_cast<float>(norm * static_cast<double>(z[i]) + share * static_cast<double>(p[i]));
        op.apply<float>(p, q);
        const double along = dot(p, q);
        if (!(along > 0) || !std::isfinite(along))
          fail(result);
        const double step = now / along;
        for (std::size_t i = 0; i < n; ++i)
        {
          v[i] += step * static_cast<double>(p[i]);
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
    op.apply<double>(v, r, gradient_);
    result.residual = load > 0 ? std::sqrt(dot(r, r)) / load : 0.0;
    multigrid_.reset();
    setEffective(result, sums(), problem_.lattice, problem_.axis, scale_);
    return result;
  }

  void value(std::span<double> out, Layers layers) const override
  {
    takeField();
    const std::size_t before = placesBefore(layers);
    const double length = static_cast<double>(share_.box().whole(axis_));
    piece_->forVoxels(rowsOf(layers),
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        const auto axis = static_cast<std::size_t>(axis_);
        const double place = static_cast<double>(piece_->start[axis] + p[axis]) + 0.5;
        out[i - before] = piece_->tensors.conducts(i) ? centre(p) + 1 - *mean_ - place / length
                                                      : std::numeric_limits<double>::quiet_NaN();
      });
  }

  void flux(std::span<double> out, Layers layers) const override
  {
    takeField();
    const std::size_t before = placesBefore(layers);
    const std::array<double, 3>& aspect = problem_.lattice.aspect;
    const double length = static_cast<double>(share_.box().whole(axis_));
    const double unit = scale_ / length / problem_.lattice.spacingAlong(0);
    piece_->op.forFluxes(piece_->v, gradient_, rowsOf(layers),
      [&](std::int64_t y, std::int64_t z, const double* const q[3], double)
      {
        double* row = out.data() + 3 * (piece_->tensors.first(y, z) - before);
        for (std::int64_t x = 0; x < piece_->op.box().elements[0]; ++x)
          for (std::size_t a = 0; a < 3; ++a)
            row[3 * x + static_cast<std::int64_t>(a)] = a == 2 && problem_.lattice.dimension == 2
              ? 0.0
              : 0.0 - unit * aspect[a] / aspect[0] * q[share_.order()[a]][x];
      });
  }

  [[nodiscard]] FieldEnergies energies() const override
  {
    takeField();
    const Piece& piece = *piece_;
    const ElementBox& box = piece.op.box();
    const std::array<double, 3> aspect = share_.turned(problem_.lattice.aspect);
    FieldEnergies energies;
    energies.along.assign(problem_.diffusivity.size(), 0.0);
    energies.across.assign(problem_.diffusivity.size(), 0.0);
    piece.forVoxels(piece.all(),
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        std::array<double, 8> m{};
        for (std::size_t k = 0; k < 8; ++k)
          m[k] = piece.v[static_cast<std::size_t>(
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
        const std::array<float, 3> a = piece.tensors.axis(i);
        const bool general = piece.tensors.general(i);
        const std::array<float, 6> d = general ? piece.tensors.tensor(i) : std::array<float, 6>{};
        const double largest = general ? piece.tensors.largest(i) : 1;
        for (std::size_t k = 0; k < 7; ++k)
        {
          double own = 0;
          double projected = 0;
          std::array<double, 3> slopes{ 0, 0, 0 };
          for (std::size_t c = 0; c < 3; ++c)
            if ((k >> c & 1) == 0)
            {
              const double slope =
                aspect[0] / aspect[c] * (0.25 * m[k | std::size_t{ 1 } << c] + (k == 0 ? gradient_[c] : 0.0));
              own += slope * slope;
              projected += slope * a[c];
              slopes[c] = slope;
            }
          if (general) // of the tensor over its phase's largest principal value
          {
            const auto [x, y, z] = slopes;
            along += squares[k] / largest *
              (d[0] * x * x + d[1] * y * y + d[2] * z * z + 2 * (d[3] * x * y + d[4] * x * z + d[5] * y * z));
            continue;
          }
          all += squares[k] * own;
          along += squares[k] * projected * projected;
        }
        energies.along[piece.tensors.phase(i)] += along;
        if (!general)
          energies.across[piece.tensors.phase(i)] += all - along;
      });
    problem_.comm.sum(energies.along);
    problem_.comm.sum(energies.across);
    return energies;
  }

  [[nodiscard]] std::optional<SurfaceDerivatives> surfaces() const override
  {
    takeField();
    return problem_.lattice.dimension == 3 ? movedSurfaces<3>() : movedSurfaces<2>();
  }

private:
  // Mean gradient of a voxel of piece_ per spacing along x, in the lattice's axes.
  [[nodiscard]] std::array<double, 3> gradientOf(const std::array<std::int64_t, 3>& p) const
  {
    const ElementBox& box = piece_->op.box();
    std::array<double, 3> rise{ 0, 0, 0 }; // four times, in the elements' axes
    for (int k = 0; k < 4; ++k)
    {
      const auto corner = static_cast<std::size_t>(box.row(p[1] + (k & 1), p[2] + (k >> 1)) + p[0]);
      const double low = piece_->v[corner];
      const double high = piece_->v[corner + 1];
      rise[0] += high - low;
      rise[1] += ((k & 1) != 0 ? 1 : -1) * (low + high);
      rise[2] += ((k >> 1) != 0 ? 1 : -1) * (low + high);
    }
    std::array<double, 3> gradient{};
    for (std::size_t a = 0; a < 3; ++a)
    {
      const auto own = static_cast<std::size_t>(share_.order()[a]);
      gradient[a] = (0.25 * rise[own] + gradient_[own]) / problem_.lattice.aspect[a];
    }
    return gradient;
  }

  // Of a voxel of piece_, in the lattice's axes.
  template <int D>
  [[nodiscard]] Eigen::Matrix<double, D, D> tensorOf(std::size_t voxel) const
  {
    constexpr std::array<std::array<std::size_t, 3>, 3> places{ { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } } };
    const std::array<float, 6> tensor = piece_->tensors.tensor(voxel);
    Eigen::Matrix<double, D, D> result;
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = 0; b < D; ++b)
        result(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = scale_ *
          static_cast<double>(
            tensor[places[static_cast<std::size_t>(share_.order()[a])][static_cast<std::size_t>(share_.order()[b])]]);
    return result;
  }

  // ∂E/∂δ of E = ∫ g·D g over the box, by voxels that go with their corners: g·D g div V − 2 D g · (∇V)ᵀ g.
  template <int D>
  [[nodiscard]] SurfaceDerivatives movedSurfaces() const
  {
    using Vector = Eigen::Matrix<double, D, 1>;
    using Motions = SurfaceMotions<D>;
    const auto moved = share_.moves() ? share_.toAll(problem_.phase) : std::vector<std::uint8_t>{};
    const std::span<const std::uint8_t> all = share_.moves() ? std::span<const std::uint8_t>(moved) : problem_.phase;
    std::array<std::int64_t, D> size{};
    std::array<double, D> edge{};
    std::array<bool, D> periodic{};
    for (std::size_t a = 0; a < D; ++a)
    {
      size[a] = problem_.lattice.size[a];
      edge[a] = problem_.lattice.aspect[a];
      periodic[a] = problem_.periodic()[a];
    }
    const Motions nodes(all, size, edge, periodic);
    const std::size_t ids = problem_.diffusivity.size();
    SurfaceDerivatives sums{ std::vector<double>(ids * ids, 0.0), std::vector<double>(ids * ids, 0.0) };
    std::vector<typename Motions::Motion> motions;
    piece_->forVoxels(piece_->all(),
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        typename Motions::Place place{};
        for (std::size_t a = 0; a < D; ++a)
        {
          const auto own = static_cast<std::size_t>(share_.order()[a]);
          place[a] = piece_->start[own] + p[own];
        }
        if (nodes.alone(place))
          return;
        nodes.motions(place, motions);
        const std::uint8_t id = piece_->tensors.phase(i);
        const std::array<double, 3> rise = gradientOf(p);
        const Eigen::Matrix<double, D, D> tensor = tensorOf<D>(i);
        Vector g;
        for (int a = 0; a < D; ++a)
          g(a) = rise[static_cast<std::size_t>(a)];
        const Vector flux = tensor * g;
        for (const typename Motions::Motion& motion : motions)
        {
          const std::size_t pair = motion.first * ids + motion.second;
          const double swells = motion.gradient.trace();
          if (id == motion.first)
            sums.area[pair] += swells;
          if (piece_->tensors.conducts(i))
            sums.shift[pair] += swells * flux.dot(g) - 2 * flux.dot(motion.gradient.transpose() * g);
        }
      });
    problem_.comm.sum(sums.shift);
    problem_.comm.sum(sums.area);
    const auto nodesInAll = static_cast<double>(problem_.lattice.count());
    const double mean = 1 / problem_.lattice.aspect[static_cast<std::size_t>(problem_.axis)]; // gradient
    for (double& shift : sums.shift)
      shift /= nodesInAll * mean * mean;
    for (double& area : sums.area)
      area /= nodesInAll;
    return sums;
  }

  [[noreturn]] void fail(const SteadyResult& result) const
  {
    throw DivergenceError(fmt::format("elements: the value still errs by {:.1e} after {} iterations",
                            result.solverError, result.iterations),
      "allow more iterations, or a larger tolerance");
  }

  // Of this rank's block, as the lattice has them, or none.
  [[nodiscard]] VoxelArrays arraysOfBlock() const
  {
    const DirectedDiffusivity* const directed = problem_.options.directed.get();
    VoxelArrays arrays;
    if (hasDirections(problem_))
      arrays.axis = directed->axis;
    if (hasOwnTensors(problem_))
      arrays.tensor = directed->ofNode;
    return arrays;
  }

  // Of this rank's elements, likewise.
  [[nodiscard]] VoxelArrays arraysOfSlab() const
  {
    if (!share_.moves())
      return arraysOfBlock();
    const DirectedDiffusivity* const directed = problem_.options.directed.get();
    VoxelArrays arrays;
    if (hasDirections(problem_))
      arrays.axis = share_.toSlab(std::span<const std::array<float, 3>>(directed->axis));
    if (hasOwnTensors(problem_))
      arrays.tensor = share_.toSlab(std::span<const SymmetricTensor<float>>(directed->ofNode));
    return arrays;
  }

  // Once solved: from this rank's elements to its block, and the mean of a periodic cell. Collective.
  void takeField() const
  {
    if (mean_)
      return;
    if (share_.moves())
    {
      std::vector<double> v = share_.toBlock(piece_->v);
      piece_.reset();
      const Block& block = problem_.parts.block();
      ElementBox box;
      box.elements = share_.turned(block.size);
      piece_ = std::make_unique<Piece>(problem_, scale_, share_, block, box, problem_.phase, arraysOfBlock());
      piece_->v = std::move(v);
      phase_ = {};
    }
    mean_ = 0;
    if (problem_.options.sides != Sides::Periodic)
      return;
    std::array<double, 2> sums{ 0, 0 };
    piece_->forVoxels(piece_->all(),
      [&](std::size_t i, const std::array<std::int64_t, 3>& p)
      {
        if (!piece_->tensors.conducts(i))
          return;
        sums[0] += centre(p);
        sums[1] += 1;
      });
    problem_.comm.sum(sums);
    mean_ = sums[1] > 0 ? sums[0] / sums[1] : 0.0;
  }

  // What is left of the field in the middle of a voxel of piece_, in drops over the box.
  [[nodiscard]] double centre(const std::array<std::int64_t, 3>& p) const
  {
    double sum = 0;
    for (int k = 0; k < 4; ++k)
    {
      const auto corner = static_cast<std::size_t>(piece_->op.box().row(p[1] + (k & 1), p[2] + (k >> 1)) + p[0]);
      sum += piece_->v[corner] + piece_->v[corner + 1];
    }
    return sum / 8 / static_cast<double>(share_.box().whole(axis_));
  }

  // Of layers of this rank's block: the rows of elements, and the voxels before.
  [[nodiscard]] ElementOperator::RowRange rowsOf(Layers layers) const
  {
    ElementOperator::RowRange rows = piece_->all();
    rows[static_cast<std::size_t>(share_.order()[2] - 1)] = { layers.first, layers.last };
    return rows;
  }
  [[nodiscard]] std::size_t placesBefore(Layers layers) const
  {
    const auto& size = problem_.parts.block().size;
    return static_cast<std::size_t>(size[0] * size[1] * layers.first);
  }

  template <class A, class B>
  [[nodiscard]] double dot(const std::vector<A>& a, const std::vector<B>& b) const
  {
    return piece_->op.box().dot(a, b, piece_->op.threads());
  }

  // A constant is free in a periodic cell, and round-off would let it grow.
  void takeOffMean(std::vector<float>& z) const
  {
    const ElementBox& box = piece_->op.box();
    std::array<double, 2> sums{ 0, 0 };
    for (std::int64_t k = 0; k < box.owned(2); ++k)
      for (std::int64_t j = 0; j < box.owned(1); ++j)
        for (std::int64_t i = 0; i < box.owned(0); ++i)
          if (const float value = z[static_cast<std::size_t>(box.row(j, k) + i)]; value != 0)
          {
            sums[0] += static_cast<double>(value);
            sums[1] += 1;
          }
    box.parts.sum(sums);
    const auto mean = static_cast<float>(sums[1] > 0 ? sums[0] / sums[1] : 0.0);
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
    const ElementBox& box = piece_->op.box();
    const auto axis = static_cast<std::size_t>(axis_);
    const std::int64_t layers = box.whole(axis_);
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
    piece_->op.forFluxes(piece_->v, gradient_,
      [&](std::int64_t y, std::int64_t z, const double* const q[3], double energy)
      {
        Part& part = parts[static_cast<std::size_t>(z)];
        part.energy += energy;
        std::vector<float> tensor(static_cast<std::size_t>(6 * box.elements[0]));
        float* rows[6];
        for (std::size_t c = 0; c < 6; ++c)
          rows[c] = tensor.data() + static_cast<std::ptrdiff_t>(c) * box.elements[0];
        piece_->tensors.row(y, z, rows);
        for (std::int64_t x = 0; x < box.elements[0]; ++x)
        {
          for (std::size_t a = 0; a < 3; ++a)
            part.flux[a] -= q[a][x];
          const auto layer = static_cast<std::size_t>(axis == 0 ? x : axis == 1 ? y : box.first() + z);
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
        s.all.flux[a] += unit * part.flux[static_cast<std::size_t>(share_.order()[a])];
      for (std::int64_t l = 0; l < layers; ++l)
      {
        const auto plane = static_cast<std::size_t>(periodic ? (l + 1) % layers : l);
        s.planes.flux[plane] += unit * part.layer[static_cast<std::size_t>(l)];
        s.planes.conductance[plane] += part.conductance[static_cast<std::size_t>(l)];
      }
    }
    box.parts.sum(std::span<double>(&s.all.energy, 1));
    box.parts.sum(s.all.flux);
    box.parts.sum(s.planes.flux);
    box.parts.sum(s.planes.conductance);
    s.all.inlet = s.planes.flux.front();
    s.all.outlet = periodic ? s.planes.flux[static_cast<std::size_t>(layers / 2)] : s.planes.flux.back();
    return s;
  }
  [[nodiscard]] FieldSums sums() const { return sumsAndPlanes().all; }

  // v is what is left of u n, without the linear profile.
  void balance()
  {
    const Sums s = sumsAndPlanes();
    const bool periodic = problem_.options.sides == Sides::Periodic;
    if (!std::ranges::all_of(s.planes.conductance, [](double c) { return c > 0; }))
      return;
    const PlaneBalance best(s.planes, s.all.energy, periodic, true);
    const ElementBox& box = piece_->op.box();
    const std::int64_t layers = box.whole(axis_);
    const double n = static_cast<double>(layers);
    const auto shift = [&](std::int64_t plane)
    {
      if (periodic)
        return n * best.shift[static_cast<std::size_t>(plane % layers)];
      return plane == 0 || plane == layers
        ? 0.0
        : n * best.shift[static_cast<std::size_t>(plane - 1)] + (best.factor - 1) * (n - static_cast<double>(plane));
    };
    for (std::int64_t z = 0; z < box.nodes(2); ++z)
      for (std::int64_t y = 0; y < box.nodes(1); ++y)
        for (std::int64_t x = 0; x < box.nodes(0); ++x)
        {
          double& value = piece_->v[static_cast<std::size_t>(box.row(y, z) + x)];
          value = best.factor * value + shift(axis_ == 0 ? x : axis_ == 1 ? y : box.first() + z);
        }
    PlaneBalance::requireGain(s.all.energy, sums().energy);
  }

  Problem problem_;
  double scale_;
  ElementShare share_;
  int axis_;                                    ///< that is solved along, of the elements
  mutable std::vector<std::uint8_t> phase_;     ///< of the elements, where they are not those of this rank's block
  mutable std::unique_ptr<Piece> piece_;        ///< this rank's elements; once the field was asked for, its block
  std::unique_ptr<ElementMultigrid> multigrid_; ///< until solved
  mutable std::optional<double> mean_;          ///< of the field in a periodic cell, once the field was asked for
  std::array<double, 3> gradient_{ 0, 0, 0 };
};

void requireTensors(const Problem& problem)
{
  const DirectedDiffusivity* const d = problem.options.directed.get();
  if (d == nullptr)
    return;
  if (problem.comm.any(d->hasAxes() && d->axis.size() != problem.phase.size()))
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
  if (problem.comm.any(hasOwnTensors(problem) && d->ofNode.size() != problem.phase.size()))
    throw ParameterError(fmt::format("{} tensors were given for {} nodes", d->ofNode.size(), problem.phase.size()),
      "give one for every node");
  std::int64_t lost = 0;
  for (std::size_t i = 0; d->hasAxes() && i < problem.phase.size(); ++i)
  {
    const std::array<float, 3>& a = d->axis[i];
    const double length = std::hypot(a[0], a[1], problem.lattice.dimension == 3 ? a[2] : 0.0);
    lost += d->along[problem.phase[i]] != d->across[problem.phase[i]] && !(length > 0 && std::isfinite(length)) ? 1 : 0;
  }
  lost = problem.comm.sum(lost);
  if (lost > 0)
    throw ParameterError(
      fmt::format("{} nodes of phases that conduct differently along and across have no axis to go by", lost),
      "give these nodes an axis, or the phase one value");
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
