#include "elasticity/VoxelStiffness.h"

#include "core/Clock.h"
#include "core/Communicator.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "elasticity/ElasticSystem.h"
#include "lattice/Subsample.h"
#include "pores/PoreLabelling.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

namespace lamella::elasticity
{
namespace
{

// Every second, third and fourth voxel make pictures; of each kind about so many are solved.
constexpr std::array strides{ 2, 3, 4 };
constexpr std::size_t fewPictures = 8;
// A picture of fewer pixels along an axis tells nothing.
constexpr std::int64_t fewestAcross = 3;
// Eigenvalues of the tensor at most this share of the largest are none.
double leastStiffness(double tolerance)
{
  return std::max(1e-9, 10 * tolerance);
}

// Voxels that stresses reach: the solid without pieces that hang on nothing.
struct Solid
{
  std::vector<std::uint8_t> kept; ///< the phases, loose voxels made void; empty: none is
  std::int64_t voxels = 0;
  std::int64_t pieces = 0, loosePieces = 0, looseVoxels = 0;
  std::array<bool, 3> crosses{ false, false, false };
};

Solid findSolid(const Lattice& lattice, std::span<const std::uint8_t> phase, const std::vector<bool>& isVoid,
  std::uint8_t voidId, StiffnessSides sides)
{
  Solid solid;
  std::vector<std::uint8_t> mask(phase.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
    mask[i] = isVoid[phase[i]] ? 0 : 1;
  solid.voxels = std::count(mask.begin(), mask.end(), std::uint8_t{ 1 });
  if (solid.voxels == static_cast<std::int64_t>(phase.size()))
  {
    solid.pieces = 1;
    for (int a = 0; a < lattice.dimension; ++a)
      solid.crosses[static_cast<std::size_t>(a)] = true;
    return solid;
  }
  pores::LabelOptions o;
  o.connectivity = lattice.dimension == 3 ? 6 : 4;
  for (int a = 0; a < lattice.dimension; ++a)
    o.periodic[static_cast<std::size_t>(a)] = sides == StiffnessSides::Periodic;
  const Communicator alone;
  const pores::PoreLabelling labelling(lattice, alone, mask, 1, o);
  const auto pieces = labelling.pores();
  solid.pieces = static_cast<std::int64_t>(pieces.size());
  std::vector<bool> loose(pieces.size() + 1, false);
  for (std::size_t k = 0; k < pieces.size(); ++k)
  {
    const pores::Pore& piece = pieces[k];
    for (std::size_t a = 0; a < 3; ++a)
      solid.crosses[a] = solid.crosses[a] || (piece.percolates >> a & 1) != 0;
    loose[k + 1] = sides == StiffnessSides::Periodic ? piece.percolates == 0 : piece.touches == 0;
    solid.loosePieces += loose[k + 1] ? 1 : 0;
    solid.looseVoxels += loose[k + 1] ? piece.size : 0;
  }
  if (solid.loosePieces == 0)
    return solid;
  std::vector<std::int32_t> labels(phase.size());
  labelling.labels(labels);
  solid.kept.assign(phase.begin(), phase.end());
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (loose[static_cast<std::size_t>(labels[i])])
      solid.kept[i] = voidId;
  return solid;
}

template <int D>
class Study
{
public:
  static constexpr int n = voigtSize(D);

  Study(const Lattice& lattice, std::span<const std::uint8_t> phase, const std::vector<PhaseStiffness>& stiffness,
    const VoxelStiffnessOptions& options)
    : lattice_(lattice)
    , phase_(phase)
    , options_(options)
  {
    for (const PhaseStiffness& values : stiffness)
    {
      ElasticLaw<D>& law = laws_.emplace_back();
      std::copy(values.begin(), values.end(), law.stiffness.begin());
      isVoid_.push_back(law.isVoid());
    }
    const auto any = std::find(isVoid_.begin(), isVoid_.end(), true);
    voidId_ = static_cast<std::uint8_t>(any - isVoid_.begin());
    if (any == isVoid_.end())
    {
      laws_.emplace_back();
      isVoid_.push_back(true);
    }
  }

  VoxelStiffness run()
  {
    VoxelStiffness r;
    const auto own = static_cast<double>(lattice_.count());
    const double ahead = options_.estimateError ? foreseen() : 0.0;
    const Solved cell = solve(lattice_, phase_, 0, own, own + ahead);
    if (cell.step.stiffness.empty())
      throw NoPathError("the solid leads across the box along no axis", "take another window, or make it less porous");
    take(r, cell);
    warn(r, cell.solid);
    if (!options_.estimateError)
      return r;
    const double start = seconds();
    try
    {
      estimate(r, own, own + ahead);
    }
    catch (const Cancelled&)
    {
      throw;
    }
    catch (const Error& error) // the answer itself is there
    {
      r.warnings.push_back(fmt::format("the error is not known: {}", error.what()));
    }
    r.estimateSeconds = seconds() - start;
    return r;
  }

private:
  struct Solved
  {
    Solid solid;
    VoxelStiffnessStep step;
    Eigen::MatrixXd tensor;   ///< as solved
    std::vector<double> held; ///< mean stress of the box that swells and is not let
    std::array<double, n * n> voigt{};
    double solverError = 0;
    std::size_t levels = 0;
    double setupSeconds = 0;
    double bytes = 0;
  };

  // Progress goes from `from` on by `length`, of `all`.
  Solved solve(
    const Lattice& lattice, std::span<const std::uint8_t> phase, double from, double length, double all) const
  {
    const double start = seconds();
    Solved s;
    s.solid = findSolid(lattice, phase, isVoid_, voidId_, options_.sides);
    s.step.nodes = lattice.count();
    s.tensor = Eigen::MatrixXd::Zero(n, n);
    const bool crosses = std::ranges::any_of(s.solid.crosses, [](bool c) { return c; });
    if (!crosses && options_.sides == StiffnessSides::Periodic)
      return s;
    ElasticProblem<D> problem;
    for (std::size_t a = 0; a < D; ++a)
    {
      problem.elements[a] = lattice.size[a];
      problem.aspect[a] = lattice.aspect[a] / lattice.aspect[0];
      problem.periodic[a] = options_.sides == StiffnessSides::Periodic;
    }
    problem.phase = s.solid.kept.empty() ? phase : std::span<const std::uint8_t>(s.solid.kept);
    problem.laws = laws_;
    problem.threads = options_.threads;
    ElasticOptions o;
    o.tolerance = options_.tolerance;
    o.maxIterations = options_.maxIterations;
    int load = 0;
    o.progress = [&](int, double error)
    {
      const double done = std::clamp(std::log(error) / std::log(options_.tolerance), 0.0, 1.0);
      return !options_.progress || options_.progress((from + length * (load + done) / n) / all);
    };
    std::optional<ElasticSystem<D>> system;
    for (; load < n; ++load)
    {
      if (const auto held = heldUnder(load); !system || held != problem.held)
      {
        problem.held = held;
        const double begin = seconds();
        system.emplace(problem, o);
        s.setupSeconds += seconds() - begin;
      }
      ElasticLoad<D> unit;
      unit.strain[static_cast<std::size_t>(load)] = 1;
      const ElasticResult<D> result = system->solve(unit);
      for (int k = 0; k < n; ++k)
        s.tensor(k, load) = result.stress[static_cast<std::size_t>(k)];
      s.step.iterations.push_back(result.iterations);
      s.solverError = std::max(s.solverError, result.solverError);
    }
    if (!options_.expansion.empty())
    {
      std::vector<std::array<double, n>> strains(options_.expansion.size());
      for (std::size_t id = 0; id < strains.size(); ++id)
        std::copy(options_.expansion[id].begin(), options_.expansion[id].end(), strains[id].begin());
      if (const auto held = heldUnder(0); held != problem.held)
      {
        problem.held = held;
        system.emplace(problem, o);
      }
      ElasticLoad<D> swelling;
      swelling.initial = system->eigenstress(strains);
      const ElasticResult<D> result = system->solve(swelling);
      s.step.iterations.push_back(result.iterations);
      s.held.assign(result.stress.begin(), result.stress.end());
    }
    s.voigt = system->voigtBound();
    s.levels = system->levels();
    s.bytes = static_cast<double>(system->bytes() + s.solid.kept.size());
    if (options_.sides == StiffnessSides::Straight) // what mirror images make of other components is no mean of the box
      for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
          if (k != l && (k >= D || l >= D))
            s.tensor(k, l) = 0;
    s.step.seconds = seconds() - start;
    const Eigen::MatrixXd even = 0.5 * (s.tensor + s.tensor.transpose());
    s.step.stiffness.assign(even.data(), even.data() + n * n);
    return s;
  }

  // Components of displacements, but for the mean strain's, that sides hold under a unit strain. Of mirror images a
  // stretch is even across every side: what crosses it is held. A shear of two axes is odd across sides normal to them:
  // what slides along the other axis is held.
  [[nodiscard]] std::array<std::array<bool, D>, D> heldUnder(int load) const
  {
    std::array<std::array<bool, D>, D> held{};
    for (int a = 0; a < D; ++a)
      for (int c = 0; c < D; ++c)
      {
        bool is = options_.sides == StiffnessSides::UniformStrain;
        if (options_.sides == StiffnessSides::Straight)
        {
          is = a == c;
          for (int i = 0; i < D && load >= D; ++i)
            for (int j = 0; j < D; ++j)
              if (i != j && voigt(D, i, j) == load && a == i)
                is = c == j;
        }
        held[static_cast<std::size_t>(a)][static_cast<std::size_t>(c)] = is;
      }
    return held;
  }

  void take(VoxelStiffness& r, const Solved& cell) const
  {
    const double most = cell.tensor.cwiseAbs().maxCoeff();
    r.stiffness = cell.step.stiffness;
    r.asymmetry = most > 0 ? (cell.tensor - cell.tensor.transpose()).cwiseAbs().maxCoeff() / most : 0.0;
    r.solverError = cell.solverError;
    r.voigt.assign(cell.voigt.begin(), cell.voigt.end());
    r.reuss = reuss();
    if (!cell.held.empty())
    {
      const Eigen::Map<const Eigen::VectorXd> stress(cell.held.data(), n);
      const Eigen::MatrixXd even = 0.5 * (cell.tensor + cell.tensor.transpose());
      const Eigen::VectorXd free = -even.completeOrthogonalDecomposition().solve(stress);
      r.expansion.assign(free.data(), free.data() + n);
    }
    r.constants = elasticConstants(r.stiffness, D, leastStiffness(options_.tolerance));
    r.steps.push_back(cell.step);
    r.solidVoxels = cell.solid.voxels;
    r.pieces = cell.solid.pieces;
    r.loosePieces = cell.solid.loosePieces;
    r.looseVoxels = cell.solid.looseVoxels;
    r.crosses = cell.solid.crosses;
    r.sides = sideMatch(lattice_, phase_);
    r.levels = cell.levels;
    r.setupSeconds = cell.setupSeconds;
    r.solveSeconds = cell.step.seconds - cell.setupSeconds;
    r.bytes = static_cast<std::int64_t>(cell.bytes);
  }

  [[nodiscard]] std::vector<double> reuss() const
  {
    std::array<double, 256> counts{};
    for (const std::uint8_t id : phase_)
      ++counts[id];
    Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t id = 0; id < laws_.size(); ++id)
    {
      if (counts[id] == 0)
        continue;
      if (isVoid_[id])
        return std::vector<double>(n * n, 0.0);
      Eigen::MatrixXd c(n, n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          c(i, j) = laws_[id].stiffness[static_cast<std::size_t>(triangle(n, i, j))];
      compliance += counts[id] / static_cast<double>(phase_.size()) * c.inverse();
    }
    const Eigen::MatrixXd bound = compliance.inverse();
    return { bound.data(), bound.data() + n * n };
  }

  void warn(VoxelStiffness& r, const Solid& solid) const
  {
    if (solid.loosePieces > 0)
      r.warnings.push_back(fmt::format("{} loose pieces with {} voxels ({:.2g} % of the solid) {} and were taken out: "
                                       "they carry nothing",
        solid.loosePieces, solid.looseVoxels,
        100.0 * static_cast<double>(solid.looseVoxels) / static_cast<double>(solid.voxels),
        options_.sides == StiffnessSides::Periodic ? "do not go on into the next cell" : "reach no side"));
    std::string closed;
    for (std::size_t a = 0; a < D; ++a)
      if (!solid.crosses[a])
        closed += (closed.empty() ? "" : " and ") + std::string(1, "xyz"[a]);
    if (!closed.empty() && options_.sides == StiffnessSides::Periodic)
      r.warnings.push_back(
        fmt::format("no piece of the cell goes on into the next one along {}: it has no stiffness there", closed));
    else if (r.constants.resisting < n)
      r.warnings.push_back(
        fmt::format("the cell resists {} of {} independent strains: it is a mechanism", r.constants.resisting, n));
    if (options_.sides == StiffnessSides::Periodic)
      for (const std::string& words : sideWarnings(r.sides, D))
        r.warnings.push_back(words);
  }

  [[nodiscard]] Lattice pixels() const
  {
    Lattice p = lattice_;
    for (std::size_t a = 0; a < D; ++a)
      p.size[a] = lattice_.size[a] / options_.nodesPerPixel;
    return p;
  }
  [[nodiscard]] bool serves(const Lattice& p, int stride, const std::array<bool, 3>& matters) const
  {
    for (std::size_t a = 0; a < D; ++a)
      if (matters[a] && p.size[a] < stride * fewestAcross)
        return false;
    return true;
  }
  [[nodiscard]] double foreseen() const
  {
    double voxels = 0;
    for (const int stride : strides)
    {
      const double all = std::pow(stride, D);
      voxels += std::min(all, static_cast<double>(fewPictures)) / all;
    }
    return voxels * static_cast<double>(lattice_.count());
  }

  void estimate(VoxelStiffness& r, double done, double all) const
  {
    const Lattice p = pixels();
    std::array<bool, 3> matters{ false, false, false };
    for (std::size_t a = 0; a < D; ++a)
    {
      if (lattice_.size[a] % options_.nodesPerPixel != 0)
        throw ParameterError(fmt::format("{} voxels along {} are no whole number of pixels of {} voxels",
                               lattice_.size[a], "xyz"[a], options_.nodesPerPixel),
          "");
      matters[a] = r.sides[a].across > 0 || r.sides[a].inside > 0;
    }
    for (std::size_t a = 0; a < D; ++a)
      if (matters[a] && p.size[a] < strides.front() * fewestAcross)
        throw ParameterError(
          fmt::format("of {} pixels along {} every second one is too few to tell anything: it takes {}", p.size[a],
            "xyz"[a], fewestAcross * strides.front()),
          "");
    std::vector<SubsampleTensors> tensors;
    for (const int stride : strides)
    {
      if (!serves(p, stride, matters))
        continue;
      const PeriodicThinning thinning = periodicThinning(p, stride, matters);
      Lattice varying = p;
      for (std::size_t a = 0; a < D; ++a)
        varying.size[a] = matters[a] ? p.size[a] : 1;
      SubsampleTensors answer{ thinning.stride, {} };
      VoxelStiffnessStep sum{ thinning.stride, 0, 0, std::vector<double>(n * n, 0.0), std::vector<std::int64_t>(n, 0),
        0 };
      for (const auto& first : subsampleStarts(varying, stride, fewPictures))
      {
        const auto [lattice, phase] = thinned(thinning, first);
        const auto voxels = static_cast<double>(lattice.count());
        const Solved s = solve(lattice, phase, done, voxels, all);
        done += voxels;
        answer.tensors.push_back(s.step.stiffness.empty() ? std::vector<double>(n * n, 0.0) : s.step.stiffness);
        ++sum.pictures;
        sum.nodes += s.step.nodes;
        sum.seconds += s.step.seconds;
        for (std::size_t i = 0; i < sum.stiffness.size(); ++i)
          sum.stiffness[i] += answer.tensors.back()[i];
        sum.iterations.resize(std::max(sum.iterations.size(), s.step.iterations.size()), 0);
        for (std::size_t i = 0; i < s.step.iterations.size(); ++i)
          sum.iterations[i] += s.step.iterations[i];
      }
      for (double& c : sum.stiffness)
        c /= sum.pictures;
      r.steps.push_back(std::move(sum));
      tensors.push_back(std::move(answer));
    }
    r.error = stiffnessError(r.stiffness, tensors, D, { .zero = leastStiffness(options_.tolerance) });
  }

  // A coarser picture of the box, its pixels split as the box's are.
  [[nodiscard]] std::pair<Lattice, std::vector<std::uint8_t>> thinned(
    const PeriodicThinning& thinning, const std::array<std::int64_t, 3>& first) const
  {
    const int split = options_.nodesPerPixel;
    Lattice lattice = lattice_;
    std::array<std::vector<std::int64_t>, 3> from{ { { 0 }, { 0 }, { 0 } } };
    for (std::size_t a = 0; a < D; ++a)
    {
      lattice.size[a] = thinning.size[a] * split;
      from[a].clear();
      for (std::int64_t i = 0; i < lattice.size[a]; ++i)
        from[a].push_back(thinning.node(a, i / split, first[a]) * split + i % split);
    }
    std::vector<std::uint8_t> phase;
    phase.reserve(static_cast<std::size_t>(lattice.count()));
    for (const std::int64_t z : from[2])
      for (const std::int64_t y : from[1])
        for (const std::int64_t x : from[0])
          phase.push_back(phase_[static_cast<std::size_t>(lattice_.index(x, y, z))]);
    return { lattice, std::move(phase) };
  }

  const Lattice& lattice_;
  std::span<const std::uint8_t> phase_;
  const VoxelStiffnessOptions& options_;
  std::vector<ElasticLaw<D>> laws_; ///< a void among them
  std::vector<bool> isVoid_;
  std::uint8_t voidId_ = 0;
};

} // namespace

double voxelStiffnessBytes(const Lattice& lattice, bool isotropic)
{
  const int d = lattice.dimension;
  double nodes = 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(d); ++a)
    nodes *= static_cast<double>(lattice.size[a] + 1);
  const double kinds = isotropic ? 2 : stiffnessSize(d);
  const double children = d == 3 ? 7 : 3; // levels are 1/8 + 1/64 + … of the finest, or 1/4 + …
  return nodes * (16.0 * d + 4 * (2 * d + kinds) / children) + 3.0 * static_cast<double>(lattice.count());
}

VoxelStiffness studyVoxelStiffness(const Lattice& lattice, std::span<const std::uint8_t> phase,
  const std::vector<PhaseStiffness>& stiffness, const VoxelStiffnessOptions& options)
{
  const Continuum continuum = lattice.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  std::array<bool, 256> present{};
  for (const std::uint8_t id : phase)
    present[id] = true;
  bool solid = false;
  for (std::size_t id = 0; id < present.size(); ++id)
  {
    if (!present[id])
      continue;
    if (id >= stiffness.size())
      throw ParameterError(fmt::format("phase {} has no stiffness", id), "give it one, or make it a void");
    requireStable(continuum, stiffness[id], fmt::format("phase {}", id).c_str());
    solid = solid || std::ranges::any_of(stiffness[id], [](double c) { return c != 0; });
  }
  if (!solid)
    throw NoPathError("all of the box is void", "give some phase a Young's modulus");
  for (const std::vector<double>& strain : options.expansion)
    if (strain.size() != static_cast<std::size_t>(voigtSize(lattice.dimension)) ||
      !std::ranges::all_of(strain, [](double e) { return std::isfinite(e); }))
      throw ParameterError(fmt::format("an expansion of {} numbers", strain.size()),
        fmt::format("give {} finite ones for every phase", voigtSize(lattice.dimension)));
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw ParameterError(fmt::format("a tolerance of {}", options.tolerance), "ask for one between 0 and 1: 1e-6");
  const bool isotropic = std::ranges::all_of(stiffness,
    [&](const PhaseStiffness& values)
    {
      double lambda = 0;
      double mu = 0;
      if (lattice.dimension == 2)
      {
        ElasticLaw<2> law;
        std::copy(values.begin(), values.end(), law.stiffness.begin());
        return law.isotropic(lambda, mu);
      }
      ElasticLaw<3> law;
      std::copy(values.begin(), values.end(), law.stiffness.begin());
      return law.isotropic(lambda, mu);
    });
  const double bytes = voxelStiffnessBytes(lattice, isotropic);
  const double free = options.memory > 0 ? options.memory : static_cast<double>(availableMemory());
  if (bytes > free)
    throw MemoryError(fmt::format("the stiffness of {} × {} × {} voxels takes {}, and {} are free", lattice.size[0],
                        lattice.size[1], lattice.size[2], bytesText(bytes), bytesText(free)),
      "take a window, or every second voxel");
  return lattice.dimension == 3 ? Study<3>(lattice, phase, stiffness, options).run()
                                : Study<2>(lattice, phase, stiffness, options).run();
}

} // namespace lamella::elasticity
