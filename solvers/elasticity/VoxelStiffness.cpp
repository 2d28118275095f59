#include "elasticity/VoxelStiffness.h"

#include "core/Clock.h"
#include "core/Communicator.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "core/Together.h"
#include "elasticity/ElasticSystem.h"
#include "elasticity/SharedVoxels.h"
#include "elasticity/WindowStiffness.h"
#include "lattice/SpacingError.h"
#include "lattice/Subsample.h"
#include "pores/PoreLabelling.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

namespace lamella::elasticity
{
namespace
{

// Every second, third and fourth voxel make pictures; of each kind about so many are solved.
constexpr std::array strides{ 2, 3, 4 };
constexpr std::size_t fewPictures = 4;
// Contrast from which on stiff pieces count as rigid, and what that errs by, over the soft phases' share of the
// stiffness.
constexpr double nearlyRigid = 1e5;
constexpr double softShare = 10;
constexpr double mostHanging = 1e-3; // of the stiff voxels, by corners or edges alone
// Largest stiffness over the bound of uniform strain below which displacements are in double.
constexpr double soft = 1e-3;
// The same for what iterations leave, over the largest stiffness, where less was asked for.
constexpr double poor = 1e-4;
constexpr double finestSingle = 1e-8; // tolerance
constexpr double lost = 0.01;
constexpr double none = 1e-9; // stiffness
// What single precision leaves of a stiffness as large as that bound.
constexpr double rounding = 5e-8;
// Of a strain's energy, left by iterations, from which on people are warned.
constexpr double muchLeft = 0.01;
// Voxels from which on a picture has all threads.
constexpr double aloneFrom = 1e6;
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
  o.connectivity = lattice.dimension == 3 ? 26 : 8; // elements that share a node hold each other
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

  Study(const Lattice& lattice, std::span<const std::uint8_t> phase, const std::vector<VoxelMaterial>& materials,
    std::span<const std::array<float, 3>> axis, const VoxelStiffnessOptions& options)
    : lattice_(lattice)
    , phase_(phase)
    , axis_(axis)
    , options_(options)
    , all_{ options.threads, options.ranks }
  {
    for (const VoxelMaterial& material : materials)
    {
      ElasticLaw<D>& law = laws_.emplace_back();
      law.rigid = material.rigid;
      law.axial = material.axial;
      if (options.numbers > 0)
        law.changes = material.changes;
      if (!law.rigid && !law.turns() && material.stiffness.size() == law.stiffness.size())
        std::copy(material.stiffness.begin(), material.stiffness.end(), law.stiffness.begin());
      isVoid_.push_back(law.isVoid() && !law.turns());
      FreeStrain<D>& free = free_.emplace_back();
      expands_ = expands_ || std::ranges::any_of(material.expansion, [](double e) { return e != 0; });
      if (law.turns() && material.expansion.size() == 2)
      {
        free.along = material.expansion[0];
        free.across = material.expansion[1];
      }
      else if (material.expansion.size() == n)
        std::copy(material.expansion.begin(), material.expansion.end(), free.strain.begin());
    }
    const bool turns = std::ranges::any_of(laws_, [](const ElasticLaw<D>& law) { return law.turns(); });
    if (turns && axis_.empty() && !options_.shares.empty())
      axis_ = ownAxes_ =
        shareAxes(lattice, phase, options_.shares, options_.sides == StiffnessSides::Periodic, options_.threads);
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
    const double ahead = options_.tensor && options_.estimateError ? foreseen() : 0.0;
    const double part = own * (options_.load ? 1.0 / n : 0.0);
    const double all = (options_.tensor ? own : 0.0) + part + ahead;
    const Solid solid = findSolid(lattice_, phase_, isVoid_, voidId_, options_.sides);
    requireSides();
    if (options_.tensor)
    {
      const Solved cell = solve(lattice_, phase_, axis_, solid, progressOf(0, own, all), all_, true);
      if (cell.step.stiffness.empty())
        throw NoPathError(
          "the solid leads across the box along no axis", "take another window, or make it less porous");
      take(r, cell);
      if (cell.solverError > muchLeft)
        r.warnings.push_back(fmt::format("iterations leave up to {:.2g} of the energy of some strain: the phases' "
                                         "contrast is near what numbers can tell",
          cell.solverError));
      held_ = cell.held;
    }
    fill(r, solid);
    if (options_.load)
      r.loaded = solveLoad(r, solid, options_.tensor ? own : 0.0, part, all);
    if (ahead == 0)
      return r;
    const double start = seconds();
    try
    {
      estimate(r, own + part, all);
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
  using Axes = std::span<const std::array<float, 3>>;
  // Who works on a box.
  struct Crew
  {
    int threads = 1;
    Communicator ranks{ MPI_COMM_SELF };
  };
  struct Solved
  {
    StiffnessStep step;
    Eigen::MatrixXd tensor;   ///< as solved
    std::vector<double> held; ///< mean stress of the box that expands by a unit and is not let
    std::array<double, n * n> voigt{};
    std::vector<std::vector<double>> changes;
    std::vector<StiffnessSurface> surfaces;
    double changeSeconds = 0;
    double solverError = 0;
    std::size_t levels = 0;
    double setupSeconds = 0;
    double bytes = 0;
  };

  struct Thinned
  {
    Lattice lattice;
    std::vector<std::uint8_t> phase;
    std::vector<std::array<float, 3>> axis;
  };

  void requireSides() const
  {
    if (options_.sides != StiffnessSides::UniformStress)
      return;
    std::int64_t i = 0;
    for (std::int64_t z = 0; z < lattice_.size[2]; ++z)
      for (std::int64_t y = 0; y < lattice_.size[1]; ++y)
        for (std::int64_t x = 0; x < lattice_.size[0]; ++x, ++i)
        {
          const bool outer = x == 0 || x + 1 == lattice_.size[0] || y == 0 || y + 1 == lattice_.size[1] ||
            (D == 3 && (z == 0 || z + 1 == lattice_.size[2]));
          if (outer && isVoid_[phase_[static_cast<std::size_t>(i)]])
            throw ParameterError("a uniform stress pulls at all sides, and voids lie at some",
              "take other sides, or a window whose border is solid");
        }
  }

  [[nodiscard]] ElasticProblem<D> problemOf(
    const Lattice& lattice, std::span<const std::uint8_t> phase, Axes axis, const Solid& solid, const Crew& crew) const
  {
    ElasticProblem<D> problem;
    for (std::size_t a = 0; a < D; ++a)
    {
      problem.elements[a] = lattice.size[a];
      problem.aspect[a] = lattice.aspect[a] / lattice.aspect[0];
      problem.periodic[a] = options_.sides == StiffnessSides::Periodic;
    }
    problem.phase = solid.kept.empty() ? phase : std::span<const std::uint8_t>(solid.kept);
    problem.laws = laws_;
    problem.axis = axis;
    problem.threads = crew.threads;
    problem.ranks = crew.ranks;
    return problem;
  }

  // Stiff pieces in phases that are softer by more than single precision can tell move as bodies; where some piece goes
  // on from cell to cell, it carries, and the soft phases hardly matter. @returns what that errs by, relative
  double stiffen(ElasticProblem<D>& problem, const Lattice& lattice) const
  {
    if (options_.sides != StiffnessSides::Periodic || expands_)
      return 0;
    std::array<bool, 256> present{};
    for (const std::uint8_t id : problem.phase)
      present[id] = true;
    std::vector<double> moduli;
    const auto modulusOf = [&](std::size_t id) { return *std::ranges::max_element(problem.laws[id].stiffness); };
    for (std::size_t id = 0; id < problem.laws.size(); ++id)
      if (present[id] && !isVoid_[id])
      {
        if (problem.laws[id].rigid || problem.laws[id].turns())
          return 0;
        moduli.push_back(modulusOf(id));
      }
    std::ranges::sort(moduli, std::greater());
    std::size_t stiff = 1;
    while (stiff < moduli.size() && moduli[stiff - 1] <= nearlyRigid * moduli[stiff])
      ++stiff;
    if (stiff >= moduli.size())
      return 0;
    std::vector<std::uint8_t> mask(problem.phase.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
      mask[i] = !isVoid_[problem.phase[i]] && modulusOf(problem.phase[i]) >= moduli[stiff - 1] ? 1 : 0;
    pores::LabelOptions o;
    o.connectivity = D == 3 ? 26 : 8;
    for (std::size_t a = 0; a < D; ++a)
      o.periodic[a] = true;
    const Communicator alone;
    const pores::PoreLabelling labelling(lattice, alone, mask, 1, o);
    if (std::ranges::any_of(labelling.pores(), [](const pores::Pore& piece) { return piece.percolates != 0; }))
      return 0;
    // what hangs on a piece by a corner or an edge alone would turn about it
    o.connectivity = D == 3 ? 6 : 4;
    const pores::PoreLabelling byFaces(lattice, alone, mask, 1, o);
    double hanging = 0;
    if (byFaces.pores().size() != labelling.pores().size())
    {
      std::vector<std::int32_t> whole(mask.size());
      std::vector<std::int32_t> part(mask.size());
      labelling.labels(whole);
      byFaces.labels(part);
      std::vector<std::int64_t> largest(labelling.pores().size() + 1, 0);
      for (std::size_t i = 0; i < mask.size(); ++i)
        if (mask[i] != 0)
          largest[static_cast<std::size_t>(whole[i])] = std::max(
            largest[static_cast<std::size_t>(whole[i])], byFaces.pores()[static_cast<std::size_t>(part[i] - 1)].size);
      double all = 0;
      double carried = 0;
      for (std::size_t k = 0; k < labelling.pores().size(); ++k)
      {
        all += static_cast<double>(labelling.pores()[k].size);
        carried += static_cast<double>(largest[k + 1]);
      }
      hanging = (all - carried) / all;
      if (hanging > mostHanging)
        return 0;
    }
    for (std::size_t id = 0; id < problem.laws.size(); ++id)
      if (!isVoid_[id] && present[id] && modulusOf(id) >= moduli[stiff - 1])
      {
        problem.laws[id] = {};
        problem.laws[id].rigid = true;
      }
    return softShare * (moduli[stiff] / moduli[stiff - 1] + hanging);
  }

  // A solver for loads, made anew where sides hold something else.
  class Solver
  {
  public:
    Solver(ElasticProblem<D> problem, ElasticOptions options)
      : problem_(std::move(problem))
      , options_(std::move(options))
    {
    }
    ElasticSystem<D>& holding(const std::array<std::array<bool, D>, D>& held)
    {
      if (!system_ || held != problem_.held)
      {
        system_.reset();
        problem_.held = held;
        const double begin = seconds();
        system_.emplace(problem_, options_);
        setupSeconds_ += seconds() - begin;
      }
      return *system_;
    }
    [[nodiscard]] double setupSeconds() const { return setupSeconds_; }
    [[nodiscard]] const ElasticSystem<D>& system() const { return *system_; }

  private:
    ElasticProblem<D> problem_;
    ElasticOptions options_;
    std::optional<ElasticSystem<D>> system_;
    double setupSeconds_ = 0;
  };

  // The largest stiffness by uniform strain, but for rigid phases.
  static double largestOf(const ElasticProblem<D>& problem)
  {
    ElasticProblem<D> deforming = problem;
    for (ElasticLaw<D>& law : deforming.laws)
      law.rigid = false;
    return std::ranges::max(voigtBound(deforming));
  }

  using Progress = std::function<bool(double share)>;
  // Of the whole study's work, from `from` on by `length`, of `all`.
  [[nodiscard]] Progress progressOf(double from, double length, double all) const
  {
    return [this, from, length, all](double share)
    { return !options_.progress || options_.progress((from + length * share) / all); };
  }

  // In single precision, and where that does not end, in double. @param tells changes, where they are asked for
  Solved solve(const Lattice& lattice, std::span<const std::uint8_t> phase, Axes axis, const Solid& solid,
    const Progress& progress, const Crew& crew, bool tells = false) const
  {
    try
    {
      return solve(lattice, phase, axis, solid, progress, crew, tells, options_.tolerance < finestSingle);
    }
    catch (const DivergenceError&)
    {
      if (options_.tolerance < finestSingle)
        throw;
    }
    return solve(lattice, phase, axis, solid, progress, crew, tells, true);
  }

  Solved solve(const Lattice& lattice, std::span<const std::uint8_t> phase, Axes axis, const Solid& solid,
    const Progress& progress, const Crew& crew, bool tells, bool exact) const
  {
    const double start = seconds();
    Solved s;
    s.step.nodes = lattice.count();
    s.tensor = Eigen::MatrixXd::Zero(n, n);
    const bool crosses = std::ranges::any_of(solid.crosses, [](bool c) { return c; });
    if (!crosses && options_.sides == StiffnessSides::Periodic)
      return s;
    const int loads = between(options_.sides) ? D : n;
    int load = 0;
    ElasticProblem<D> problem = problemOf(lattice, phase, axis, solid, crew);
    s.voigt = voigtBound(problem);
    s.solverError = stiffen(problem, lattice);
    const double most = largestOf(problem);
    ElasticOptions settings = solverOptions([&](double done) { return progress((load + done) / loads); });
    settings.fields = exact;
    Solver solver(std::move(problem), settings);
    double doubt = 0; // [Pa]
    const bool keeps = tells && (options_.numbers > 0 || options_.surfaces);
    std::vector<Field> fields; // for changes
    const auto count = [&](const ElasticResult<D>& result)
    {
      s.step.iterations.push_back(result.iterations);
      s.solverError = std::max(s.solverError, result.solverError);
      doubt = std::max(doubt, result.solverError * std::abs(result.energy));
    };
    for (; load < loads; ++load)
    {
      ElasticSystem<D>& system = solver.holding(heldUnder(load));
      ElasticLoad<D> unit;
      if (options_.sides == StiffnessSides::UniformStress)
      {
        std::array<double, n> stress{};
        stress[static_cast<std::size_t>(load)] = system.scale();
        unit.initial = system.traction(stress);
      }
      else
        unit.strain[static_cast<std::size_t>(load)] = 1;
      const ElasticResult<D> result = system.solve(unit);
      for (int k = 0; k < n; ++k)
        if (options_.sides == StiffnessSides::UniformStress)
          s.tensor(k, load) = result.strain[static_cast<std::size_t>(k)] / system.scale();
        else if (!between(options_.sides) || k == load)
          s.tensor(k, load) = result.stress[static_cast<std::size_t>(k)];
      count(result);
      if (keeps)
      {
        const double copying = seconds();
        fields.push_back(system.field(unit));
        s.changeSeconds += seconds() - copying;
      }
    }
    if (expands_ && !between(options_.sides))
    {
      ElasticSystem<D>& system = solver.holding(heldUnder(0));
      ElasticLoad<D> expanding;
      expanding.initial = system.eigenstress(free_);
      const ElasticResult<D> result = system.solve(expanding);
      count(result);
      s.held.assign(result.stress.begin(), result.stress.end());
      if (options_.sides == StiffnessSides::UniformStress) // it was let
      {
        const Eigen::VectorXd stress =
          -s.tensor.completeOrthogonalDecomposition().solve(Eigen::Map<const Eigen::VectorXd>(result.strain.data(), n));
        s.held.assign(stress.data(), stress.data() + n);
      }
    }
    if (options_.sides == StiffnessSides::UniformStress)
      s.tensor = s.tensor.inverse().eval();
    // hardly anything carries: single precision has lost it
    const double found = s.tensor.diagonal().maxCoeff();
    const bool strains = options_.sides != StiffnessSides::UniformStress;
    if (!exact && (!(found > soft * most) || (strains && doubt > std::max(poor, 2 * options_.tolerance) * found)))
      return solve(lattice, phase, axis, solid, progress, crew, tells, true);
    if (exact && strains && found > none * most && doubt > lost * found)
      throw DivergenceError(
        fmt::format("iterations leave {:.1g} of the stiffness: the phases' contrast is more than numbers can tell",
          doubt / found),
        "make the softest phase void, or the stiffest one rigid");
    if (!exact)
      s.solverError += rounding * most / found;
    s.levels = solver.system().levels();
    s.bytes = crew.ranks.sum(static_cast<double>(solver.system().bytes() + solid.kept.size()));
    s.setupSeconds = solver.setupSeconds();
    if (options_.sides == StiffnessSides::Straight) // what mirror images make of other components is no mean of the box
      for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
          if (k != l && (k >= D || l >= D))
            s.tensor(k, l) = 0;
    s.step.seconds = seconds() - start;
    if (keeps)
      tellChanges(s, solver.system(), fields);
    for (const auto& field : fields)
      s.bytes += crew.ranks.sum(static_cast<double>(field.bytes()));
    const Eigen::MatrixXd even = 0.5 * (s.tensor + s.tensor.transpose());
    s.step.stiffness.assign(even.data(), even.data() + n * n);
    return s;
  }

  using Field = typename ElasticSystem<D>::Field;

  // Of s.tensor, by numbers and by surfaces. @param fields one a load
  void tellChanges(Solved& s, const ElasticSystem<D>& system, const std::vector<Field>& fields) const
  {
    const double start = seconds();
    if (options_.numbers > 0)
      s.changes = tensorChanges(s, system, fields,
        [&](std::span<const Field> some)
        {
          const std::vector<double> all = system.changes(some, options_.numbers);
          const std::size_t each = all.size() / options_.numbers;
          std::vector<std::vector<double>> by;
          for (auto at = all.begin(); at != all.end(); at += static_cast<std::ptrdiff_t>(each))
            by.emplace_back(at, at + static_cast<std::ptrdiff_t>(each));
          return by;
        });
    if (options_.surfaces)
    {
      std::vector<SurfaceChange> found;
      std::vector<std::vector<double>> changes = tensorChanges(s, system, fields,
        [&](std::span<const Field> some)
        {
          found = system.surfaces(some);
          std::vector<std::vector<double>> by;
          for (const SurfaceChange& surface : found)
            by.push_back(surface.shift);
          return by;
        });
      for (std::size_t i = 0; i < found.size(); ++i)
        s.surfaces.push_back({ found[i].first, found[i].second, found[i].area, std::move(changes[i]), {} });
    }
    s.changeSeconds += seconds() - start;
  }

  // How the tensor changes with each of some things. @param of  by pairs of the fields that it is given
  std::vector<std::vector<double>> tensorChanges(const Solved& s, const ElasticSystem<D>& system,
    std::span<const Field> fields,
    const std::function<std::vector<std::vector<double>>(std::span<const Field>)>& of) const
  {
    std::vector<Eigen::MatrixXd> by;
    const auto start = [&](const std::vector<std::vector<double>>& found)
    { by.resize(found.size(), Eigen::MatrixXd::Zero(n, n)); };
    if (between(options_.sides)) // each for itself
      for (int k = 0; k < D; ++k)
      {
        const auto own = of(fields.subspan(static_cast<std::size_t>(k), 1));
        start(own);
        for (std::size_t p = 0; p < own.size(); ++p)
          by[p](k, k) = own[p].front();
      }
    else
    {
      const auto all = of(fields);
      start(all);
      for (std::size_t p = 0; p < all.size(); ++p)
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j)
            if (options_.sides != StiffnessSides::Straight || i == j || (i < D && j < D)) // as the tensor
              by[p](i, j) = all[p][static_cast<std::size_t>(triangle(n, i, j))];
    }
    std::vector<std::vector<double>> changes;
    for (Eigen::MatrixXd& change : by)
    {
      if (options_.sides == StiffnessSides::UniformStress) // of the compliance it is −change
        change = (s.tensor * change * s.tensor / (system.scale() * system.scale())).eval();
      changes.emplace_back(change.data(), change.data() + n * n);
    }
    return changes;
  }

  template <class Progress>
  [[nodiscard]] ElasticOptions solverOptions(Progress progress) const
  {
    ElasticOptions o;
    o.tolerance = options_.tolerance;
    o.maxIterations = options_.maxIterations;
    o.progress = [progress, tolerance = options_.tolerance](int, double error)
    { return progress(std::clamp(std::log(error) / std::log(tolerance), 0.0, 1.0)); };
    return o;
  }

  // The strain of a load, and its stress where faces are pulled.
  VoxelLoaded solveLoad(const VoxelStiffness& r, const Solid& solid, double from, double length, double all) const
  {
    const double start = seconds();
    const VoxelLoad& given = *options_.load;
    ElasticOptions o = solverOptions(progressOf(from, length, all));
    const bool changes = given.change != 0 && expands_;
    std::vector<float> times(given.source.begin(), given.source.end());
    for (float& t : times)
      t *= static_cast<float>(given.change);
    std::vector<FreeStrain<D>> strains = free_;
    if (times.empty())
      for (FreeStrain<D>& free : strains)
      {
        for (double& e : free.strain)
          e *= given.change;
        free.along *= given.change;
        free.across *= given.change;
      }
    const int which = loadOf(given);
    const auto held = heldUnder(which);
    // what the expansion does to a box that is not let
    Eigen::VectorXd heldStress = Eigen::VectorXd::Zero(n);
    if (changes && !between(options_.sides) && wantsStress(given))
    {
      if (times.empty())
        heldStress = given.change * Eigen::Map<const Eigen::VectorXd>(held_.data(), n);
      else
      {
        Solver solver(problemOf(lattice_, phase_, axis_, solid, all_), o);
        ElasticSystem<D>& system = solver.holding(held);
        ElasticLoad<D> expanding;
        expanding.initial = system.eigenstress(strains, times);
        const ElasticResult<D> result = system.solve(expanding);
        heldStress = Eigen::Map<const Eigen::VectorXd>(result.stress.data(), n);
        if (options_.sides == StiffnessSides::UniformStress)
          heldStress = -Eigen::Map<const Eigen::MatrixXd>(r.stiffness.data(), n, n) *
            Eigen::Map<const Eigen::VectorXd>(result.strain.data(), n);
      }
    }
    const auto [strain, stress] = meansOf(given, r, heldStress, which);
    o.fields = static_cast<bool>(options_.fields);
    Solver solver(problemOf(lattice_, phase_, axis_, solid, all_), o);
    ElasticSystem<D>& system = solver.holding(held);
    ElasticLoad<D> load;
    const bool pulled = options_.sides == StiffnessSides::UniformStress;
    if (!pulled)
      std::copy(strain.begin(), strain.end(), load.strain.begin());
    std::function<void(std::int64_t, std::int64_t, double* const*)> swelling;
    if (changes)
      load.initial = swelling = system.eigenstress(strains, times);
    if (pulled)
    {
      std::array<double, n> by{};
      std::copy(stress.begin(), stress.end(), by.begin());
      const auto traction = system.traction(by);
      load.initial = [traction, swelling, nx = lattice_.size[0]](
                       std::int64_t row, std::int64_t plane, double* const* out)
      {
        traction(row, plane, out);
        if (!swelling)
          return;
        std::vector<double> more(static_cast<std::size_t>(n * nx));
        std::array<double*, n> rows{};
        for (std::size_t k = 0; k < n; ++k)
          rows[k] = more.data() + static_cast<std::int64_t>(k) * nx;
        swelling(row, plane, rows.data());
        for (std::size_t k = 0; k < n; ++k)
          for (std::int64_t i = 0; i < nx; ++i)
            out[k][i] += rows[k][i];
      };
    }
    const ElasticResult<D> result = system.solve(load);
    VoxelLoaded loaded;
    loaded.strain.assign(result.strain.begin(), result.strain.end());
    loaded.stress.assign(result.stress.begin(), result.stress.end());
    if (pulled)
      loaded.stress = stress;
    loaded.energy = result.energy;
    loaded.solverError = result.solverError;
    loaded.iterations = result.iterations;
    if (options_.numbers > 0 && !options_.tensor && !changes)
      loaded.changes = system.changes(std::array{ system.field(load) }, options_.numbers);
    if (options_.fields)
    {
      // stresses of the material: what pulls at the faces is none
      ElasticLoad<D> own = load;
      own.initial = swelling;
      const double metre = lattice_.spacing * lattice_.aspect[0];
      std::array<double, D> edge{};
      for (std::size_t a = 0; a < D; ++a)
        edge[a] = lattice_.aspect[a] / lattice_.aspect[0];
      system.forFields(own,
        [&](std::int64_t row, std::int64_t plane, const double* const* displacement, const double* const* inside,
          const double* const* stresses)
        {
          const std::int64_t nx = lattice_.size[0];
          std::vector<double> store(static_cast<std::size_t>(D * nx));
          std::array<double*, D> moved{};
          std::array<double, D> place{};
          place[D - 1] =
            edge[D - 1] * (static_cast<double>(plane) + 0.5 - 0.5 * static_cast<double>(lattice_.size[D - 1]));
          if constexpr (D == 3)
            place[1] = edge[1] * (static_cast<double>(row) + 0.5 - 0.5 * static_cast<double>(lattice_.size[1]));
          for (int c = 0; c < D; ++c)
          {
            moved[static_cast<std::size_t>(c)] = store.data() + c * nx;
            for (std::int64_t i = 0; i < nx; ++i)
            {
              place[0] = static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(nx);
              double u = displacement[c][i];
              for (int a = 0; a < D; ++a)
                u += (a == c ? 1 : 0.5) * own.strain[static_cast<std::size_t>(voigt(D, a, c))] *
                  place[static_cast<std::size_t>(a)];
              moved[static_cast<std::size_t>(c)][i] = metre * u;
            }
          }
          options_.fields(row, plane, moved.data(), inside, stresses);
        });
    }
    loaded.seconds = seconds() - start;
    return loaded;
  }

  static bool isGiven(const std::vector<double>& values, int k)
  {
    return !values.empty() && std::isfinite(values[static_cast<std::size_t>(k)]);
  }
  [[nodiscard]] bool wantsStress(const VoxelLoad& load) const
  {
    bool any = options_.sides == StiffnessSides::UniformStress;
    for (int k = 0; k < n; ++k)
      any = any || isGiven(load.stress, k);
    return any;
  }
  // Which unit strain's sides a load has.
  [[nodiscard]] int loadOf(const VoxelLoad& load) const
  {
    if (!between(options_.sides) && options_.sides != StiffnessSides::Straight)
      return 0;
    int which = 0;
    int normal = 0;
    int shears = 0;
    for (int k = 0; k < n; ++k)
      if (const double e = isGiven(load.strain, k) ? load.strain[static_cast<std::size_t>(k)]
            : isGiven(load.stress, k)              ? load.stress[static_cast<std::size_t>(k)]
                                                   : 0;
          e != 0)
      {
        which = k;
        ++(k < D ? normal : shears);
      }
    if (between(options_.sides) && (normal != 1 || shears != 0))
      throw ParameterError(fmt::format("a load of {} normal components and {} shears between platens", normal, shears),
        "give one, along the axis across which platens are to press");
    if (options_.sides == StiffnessSides::Straight && (shears > 1 || (shears == 1 && normal > 0)))
      throw ParameterError(
        fmt::format("a load of {} normal components and {} shears on straight sides", normal, shears),
        "give normal components alone, or one shear");
    return options_.sides == StiffnessSides::Straight && shears == 0 ? 0 : which;
  }

  // Mean strain and stress of a load, from the tensor.
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> meansOf(
    const VoxelLoad& load, const VoxelStiffness& r, const Eigen::VectorXd& held, int which) const
  {
    Eigen::VectorXd strain = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd stress = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> open; // whose stress is given
    const bool free = wantsStress(load) && (!load.stress.empty() || load.strain.empty());
    for (int k = 0; k < n; ++k)
      if (isGiven(load.strain, k))
        strain(k) = load.strain[static_cast<std::size_t>(k)];
      else if (isGiven(load.stress, k) || (free && !between(options_.sides)))
      {
        stress(k) = isGiven(load.stress, k) ? load.stress[static_cast<std::size_t>(k)] : 0.0;
        open.push_back(k);
      }
    if (options_.sides == StiffnessSides::Straight && which >= D)
      std::erase_if(open, [which](Eigen::Index k) { return k != which; });
    else if (options_.sides == StiffnessSides::Straight)
      std::erase_if(
        open, [](Eigen::Index k) { return k >= D; });
    const auto given = [](const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    if (r.stiffness.empty())
    {
      if (!open.empty() || options_.sides == StiffnessSides::UniformStress)
        throw ParameterError(
          "a mean stress without the tensor to find its strain by", "let the tensor be solved for, or give strains");
      return { given(strain), given(stress) };
    }
    const Eigen::Map<const Eigen::MatrixXd> c(r.stiffness.data(), n, n);
    if (!open.empty())
    {
      const Eigen::VectorXd rest = stress - held - c * strain;
      const Eigen::MatrixXd part = c(open, open);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(part);
      if (!(modes.eigenvalues().minCoeff() > leastStiffness(options_.tolerance) * c.diagonal().maxCoeff()))
        throw ParameterError("a mean stress that nothing in the box resists",
          "give strains of the directions that have no stiffness, instead of stresses");
      const Eigen::VectorXd found = part.ldlt().solve(rest(open));
      for (std::size_t k = 0; k < open.size(); ++k)
        strain(open[k]) = found(static_cast<Eigen::Index>(k));
    }
    return { given(strain), given(c * strain + held) };
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
        if (between(options_.sides))
          is = a == load && (c == load || options_.sides == StiffnessSides::Grip);
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
    r.zero = leastStiffness(options_.tolerance);
    r.constants = elasticConstants(r.stiffness, D, r.zero);
    r.changes = cell.changes;
    for (const std::vector<double>& change : r.changes)
      r.constantChanges.push_back(constantChanges(r.stiffness, change, D, r.zero));
    r.surfaces = cell.surfaces;
    for (StiffnessSurface& surface : r.surfaces)
      surface.constantChange = constantChanges(r.stiffness, surface.change, D, r.zero);
    r.changeSeconds = cell.changeSeconds;
    r.steps.push_back(cell.step);
    r.levels = cell.levels;
    r.setupSeconds = cell.setupSeconds;
    r.solveSeconds = cell.step.seconds - cell.setupSeconds;
    r.bytes = static_cast<std::int64_t>(cell.bytes);
  }

  void fill(VoxelStiffness& r, const Solid& solid) const
  {
    r.solidVoxels = solid.voxels;
    r.pieces = solid.pieces;
    r.loosePieces = solid.loosePieces;
    r.looseVoxels = solid.looseVoxels;
    r.crosses = solid.crosses;
    r.sides = sideMatch(lattice_, phase_);
    warn(r, solid);
  }

  // Zeros where there are voids; rigid phases have no compliance.
  [[nodiscard]] std::vector<double> reuss() const
  {
    std::array<double, 256> counts{};
    for (const std::uint8_t id : phase_)
      ++counts[id];
    const double each = 1 / static_cast<double>(phase_.size());
    Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(n, n);
    std::vector<ElasticLaw<D>> turning(laws_.size());
    bool any = false;
    for (std::size_t id = 0; id < laws_.size(); ++id)
    {
      if (counts[id] == 0 || laws_[id].rigid)
        continue;
      if (isVoid_[id])
        return std::vector<double>(n * n, 0.0);
      if (laws_[id].turns())
      {
        turning[id] = laws_[id].inverse();
        any = true;
        continue;
      }
      Eigen::MatrixXd c(n, n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          c(i, j) = laws_[id].stiffness[static_cast<std::size_t>(triangle(n, i, j))];
      compliance += counts[id] * each * c.inverse();
    }
    for (std::size_t k = 0; k < phase_.size() && any; ++k)
      if (const ElasticLaw<D>& law = turning[phase_[k]]; law.turns())
      {
        const auto s = law.turnedTo(axis_[k]); // components of a tensor: shears count twice or four times as angles
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j)
            compliance(i, j) +=
              each * (i < D ? 1 : 2) * (j < D ? 1 : 2) * s[static_cast<std::size_t>(triangle(n, i, j))];
      }
    if (!(compliance.norm() > 0)) // all is rigid
      return std::vector<double>(n * n, std::numeric_limits<double>::infinity());
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
    else if (options_.tensor && !between(options_.sides) && r.constants.resisting < n)
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
      voxels += (options_.shares.empty() ? std::min(all, static_cast<double>(fewPictures)) : 1.0) / all;
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
    if (!options_.shares.empty())
    {
      std::vector<std::vector<double>> found;
      for (const int stride : { 2, 4 })
      {
        if (!serves(p, stride, matters))
          continue;
        found.push_back(solvePictures(
          r, stride, 1, [&](std::size_t) { return averaged(stride, matters); }, done, all)
                          .tensors.front());
      }
      r.error = sharedStiffnessError(r.stiffness, found.front(),
        found.size() > 1 ? std::span<const double>(found[1]) : std::span<const double>(), D,
        leastStiffness(options_.tolerance), mixedPart(phase_, options_.shares));
      return;
    }
    std::vector<SubsampleTensors> tensors;
    for (const int stride : strides)
    {
      if (!serves(p, stride, matters))
        continue;
      const PeriodicThinning thinning = periodicThinning(p, stride, matters);
      Lattice varying = p;
      for (std::size_t a = 0; a < D; ++a)
        varying.size[a] = matters[a] ? p.size[a] : 1;
      const auto starts = subsampleStarts(varying, stride, fewPictures);
      tensors.push_back(solvePictures(
        r, thinning.stride, starts.size(), [&](std::size_t i) { return thinned(thinning, starts[i]); }, done, all));
    }
    r.error = stiffnessError(r.stiffness, tensors, D, { .zero = leastStiffness(options_.tolerance) });
  }

  // Solves coarser pictures of one kind; small ones side by side, one thread or rank each.
  SubsampleTensors solvePictures(VoxelStiffness& r, double every, std::size_t count,
    const std::function<Thinned(std::size_t)>& draw, double& done, double all) const
  {
    const double start = seconds();
    const Thinned first = draw(0);
    const auto voxels = static_cast<double>(first.lattice.count());
    const bool beside = options_.threads * options_.ranks.size() > 1 && count > 1 && voxels < aloneFrom;
    std::vector<std::size_t> mine;
    for (std::size_t i = 0; i < count; ++i)
      if (!beside ||
        i % static_cast<std::size_t>(options_.ranks.size()) == static_cast<std::size_t>(options_.ranks.rank()))
        mine.push_back(i);
    const int workers = beside ? std::clamp(static_cast<int>(mine.size()), 1, options_.threads) : 1;
    const Crew crew = beside ? Crew{ workers > 1 ? 1 : options_.threads } : all_;
    std::vector<Solved> solved(count);
    std::vector<std::exception_ptr> failures(count);
    const auto shares = std::make_unique<std::atomic<double>[]>(count);
    std::atomic<bool> stopped{ false };
#pragma omp parallel for num_threads(workers) if (workers > 1) schedule(dynamic)
    for (const std::size_t i : mine)
    {
      try
      {
        const Thinned picture = i == 0 ? first : draw(i);
        const Solid solid = findSolid(picture.lattice, picture.phase, isVoid_, voidId_, options_.sides);
        const Progress progress = [&, i](double share)
        {
          shares[i] = share;
          double sum = 0;
          for (const std::size_t k : mine)
            sum += shares[k] * static_cast<double>(count) / static_cast<double>(mine.size());
          if (omp_get_thread_num() == 0 && options_.progress && !options_.progress((done + voxels * sum) / all))
            stopped = true;
          return !stopped;
        };
        solved[i] = solve(picture.lattice, picture.phase, picture.axis, solid, progress, crew);
      }
      catch (...)
      {
        failures[i] = std::current_exception();
      }
    }
    const auto check = [&]
    {
      if (stopped)
        throw Cancelled();
      for (const std::exception_ptr& failure : failures)
        if (failure)
          std::rethrow_exception(failure);
    };
    if (beside)
    {
      together(options_.ranks, check);
      exchange(solved, mine);
    }
    else
      check();
    done += voxels * static_cast<double>(count);
    SubsampleTensors answer{ every, {} };
    StiffnessStep sum{ every, 0, 0, std::vector<double>(n * n, 0.0), std::vector<std::int64_t>(n, 0), 0 };
    for (const Solved& s : solved)
    {
      answer.tensors.push_back(s.step.stiffness.empty() ? std::vector<double>(n * n, 0.0) : s.step.stiffness);
      ++sum.pictures;
      sum.nodes += s.step.nodes;
      for (std::size_t i = 0; i < sum.stiffness.size(); ++i)
        sum.stiffness[i] += answer.tensors.back()[i] / static_cast<double>(count);
      sum.iterations.resize(std::max(sum.iterations.size(), s.step.iterations.size()), 0);
      for (std::size_t i = 0; i < s.step.iterations.size(); ++i)
        sum.iterations[i] += s.step.iterations[i];
    }
    sum.seconds = seconds() - start;
    r.steps.push_back(std::move(sum));
    return answer;
  }

  // What each rank solved by itself, to all.
  void exchange(std::vector<Solved>& solved, const std::vector<std::size_t>& mine) const
  {
    constexpr std::size_t most = n + 1; // solves of a picture
    constexpr std::size_t each = n * n + most + 2;
    if (!options_.ranks.parallel())
      return;
    std::vector<double> values(each * solved.size(), 0.0);
    for (const std::size_t i : mine)
    {
      const StiffnessStep& step = solved[i].step;
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(each * i);
      *at = static_cast<double>(step.nodes);
      *(at + 1) = static_cast<double>(step.iterations.size());
      std::ranges::copy(step.iterations, at + 2);
      std::ranges::copy(step.stiffness, at + 2 + most); // none: zeros
    }
    options_.ranks.sum(values);
    for (std::size_t i = 0; i < solved.size(); ++i)
    {
      StiffnessStep& step = solved[i].step;
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(each * i);
      step.nodes = static_cast<std::int64_t>(*at);
      step.iterations.assign(at + 2, at + 2 + static_cast<std::ptrdiff_t>(*(at + 1)));
      step.stiffness.assign(at + 2 + most, at + static_cast<std::ptrdiff_t>(each));
    }
  }

  // The box in larger voxels, whose shares are means.
  [[nodiscard]] Thinned averaged(int stride, const std::array<bool, 3>& matters) const
  {
    Thinned t{ lattice_, {}, {} };
    for (std::size_t a = 0; a < D; ++a)
    {
      t.lattice.size[a] = matters[a] ? std::max<std::int64_t>(1, (lattice_.size[a] + stride / 2) / stride) : 1;
      t.lattice.aspect[a] *= static_cast<double>(lattice_.size[a]) / static_cast<double>(t.lattice.size[a]);
    }
    t.phase = coarserShares(lattice_, phase_, options_.shares, t.lattice.size);
    if (!ownAxes_.empty())
      t.axis =
        shareAxes(t.lattice, t.phase, options_.shares, options_.sides == StiffnessSides::Periodic, options_.threads);
    else if (!axis_.empty())
      throw ParameterError("larger voxels have no axes of their own", "take it without the error");
    return t;
  }

  // A coarser picture of the box, its pixels split as the box's are.
  [[nodiscard]] Thinned thinned(const PeriodicThinning& thinning, const std::array<std::int64_t, 3>& first) const
  {
    const int split = options_.nodesPerPixel;
    Thinned t{ lattice_, {}, {} };
    std::array<std::vector<std::int64_t>, 3> from{ { { 0 }, { 0 }, { 0 } } };
    for (std::size_t a = 0; a < D; ++a)
    {
      t.lattice.size[a] = thinning.size[a] * split;
      from[a].clear();
      for (std::int64_t i = 0; i < t.lattice.size[a]; ++i)
        from[a].push_back(thinning.node(a, i / split, first[a]) * split + i % split);
    }
    t.phase.reserve(static_cast<std::size_t>(t.lattice.count()));
    for (const std::int64_t z : from[2])
      for (const std::int64_t y : from[1])
        for (const std::int64_t x : from[0])
        {
          const auto at = static_cast<std::size_t>(lattice_.index(x, y, z));
          t.phase.push_back(phase_[at]);
          if (!axis_.empty())
            t.axis.push_back(axis_[at]);
        }
    return t;
  }

  const Lattice& lattice_;
  std::span<const std::uint8_t> phase_;
  Axes axis_;
  std::vector<std::array<float, 3>> ownAxes_;
  const VoxelStiffnessOptions& options_;
  const Crew all_;
  std::vector<ElasticLaw<D>> laws_; ///< a void among them
  std::vector<FreeStrain<D>> free_;
  bool expands_ = false;
  std::vector<bool> isVoid_;
  std::uint8_t voidId_ = 0;
  std::vector<double> held_; ///< Solved::held of the box
};

} // namespace

double voxelStiffnessBytes(const Lattice& lattice, const VoxelKinds& kinds)
{
  const int d = lattice.dimension;
  double nodes = 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(d); ++a)
    nodes *= static_cast<double>(lattice.size[a] + 1);
  const double kind = kinds.isotropic ? 2 : stiffnessSize(d);
  // rows of coarse levels have spare values behind them
  const double moduli = kind * (1 + 2 * static_cast<double>(spareValues) / static_cast<double>(lattice.size[0]));
  const double children = d == 3 ? 7 : 3; // levels are 1/8 + 1/64 + … of the finest, or 1/4 + …
  const double shared = nodes *
      (((kinds.fields ? 20.0 : 16.0) + (kinds.changes ? 4.0 * voigtSize(d) : 0.0)) * d +
        4 * (2 * d + moduli) / children) +
    (d == 2 && !kinds.isotropic ? 4.0 * kind : 0.0) * static_cast<double>(lattice.count());
  return shared / kinds.ranks + (kinds.turns ? 15.0 : 3.0) * static_cast<double>(lattice.count());
}

namespace
{

bool isIsotropic(const PhaseStiffness& values, int dimension)
{
  double lambda = 0;
  double mu = 0;
  const auto is = [&](auto law)
  {
    std::copy(values.begin(), values.end(), law.stiffness.begin());
    return law.isotropic(lambda, mu);
  };
  return dimension == 2 ? is(ElasticLaw<2>{}) : is(ElasticLaw<3>{});
}

void requireComponents(const std::vector<double>& values, int dimension, const char* what)
{
  if (!values.empty() && values.size() != static_cast<std::size_t>(voigtSize(dimension)))
    throw ParameterError(fmt::format("{} of {} numbers", what, values.size()),
      fmt::format("give {}, as {} have", voigtSize(dimension), dimension == 3 ? "volumes" : "pictures"));
}

} // namespace

std::array<std::int64_t, 2> fieldPlanes(const Lattice& lattice, StiffnessSides sides, const Communicator& ranks)
{
  const auto of = [&](auto grid)
  {
    std::copy_n(lattice.size.begin(), grid.elements.size(), grid.elements.begin());
    grid.periodic.fill(sides == StiffnessSides::Periodic);
    grid.share(ranks);
    return std::array{ grid.first(), grid.lastElements() };
  };
  return lattice.dimension == 3 ? of(ElasticGrid<3>{}) : of(ElasticGrid<2>{});
}

VoxelStiffness studyVoxelStiffness(const Lattice& lattice, std::span<const std::uint8_t> phase,
  const std::vector<VoxelMaterial>& materials, std::span<const std::array<float, 3>> axis,
  const VoxelStiffnessOptions& options)
{
  const Continuum continuum = lattice.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  const auto n = static_cast<std::size_t>(voigtSize(lattice.dimension));
  std::array<bool, 256> present{};
  for (const std::uint8_t id : phase)
    present[id] = true;
  bool solid = false;
  bool deforms = false;
  VoxelKinds kinds;
  kinds.fields = static_cast<bool>(options.fields);
  kinds.changes = (options.numbers > 0 || options.surfaces) && options.tensor;
  for (std::size_t id = 0; id < present.size(); ++id)
  {
    if (id < materials.size())
    {
      const VoxelMaterial& m = materials[id];
      const bool turns = std::ranges::any_of(m.axial, [](double c) { return c != 0; });
      const std::size_t numbers = turns ? 2 : n;
      if (options.numbers > 0 &&
        std::ranges::any_of(m.changes, [&](const ModulusChange& c) { return c.number >= options.numbers; }))
        throw ParameterError(
          fmt::format("a change of phase {} by a number that is none of {}", id, options.numbers), "count them from 0");
      if ((!m.expansion.empty() && m.expansion.size() != numbers) ||
        !std::ranges::all_of(m.expansion, [](double e) { return std::isfinite(e); }))
        throw ParameterError(fmt::format("an expansion of {} numbers of phase {}", m.expansion.size(), id),
          fmt::format("give {} finite ones", numbers));
    }
    if (!present[id])
      continue;
    if (id >= materials.size() || (materials[id].stiffness.empty() && !materials[id].rigid))
      throw ParameterError(fmt::format("phase {} has no stiffness", id), "give it one, or make it a void");
    const VoxelMaterial& m = materials[id];
    solid = solid || m.rigid;
    if (m.rigid)
      continue;
    requireStable(continuum, m.stiffness, fmt::format("phase {}", id).c_str());
    const bool stiff = std::ranges::any_of(
      m.stiffness, [](double c) { return c != 0; });
    const bool turns = std::ranges::any_of(m.axial, [](double c) { return c != 0; });
    solid = solid || stiff;
    deforms = deforms || stiff;
    kinds.turns = kinds.turns || turns;
    kinds.isotropic = kinds.isotropic && !turns && isIsotropic(m.stiffness, lattice.dimension);
  }
  if (!solid)
    throw NoPathError("all of the box is void", "give some phase a Young's modulus");
  if (!deforms)
    throw ParameterError("all that is not void is rigid", "give some phase a Young's modulus");
  if (!options.shares.empty() && (options.shares.size() < materials.size() || options.nodesPerPixel > 1))
    throw ParameterError(options.nodesPerPixel > 1
        ? std::string("shares of pixels that are split")
        : fmt::format("{} shares for {} phases", options.shares.size(), materials.size()),
      "give each phase one, and leave pixels as they are");
  if (options.surfaces && !options.shares.empty())
    throw ParameterError(
      "a segmentation error of voxels that two phases share", "take the surfaces of whole voxels, or leave it out");
  const bool ownAxes = !options.shares.empty() && axis.empty();
  if (kinds.turns && !ownAxes && axis.size() != phase.size())
    throw ParameterError(fmt::format("{} axes for {} voxels", axis.size(), phase.size()),
      "give each voxel of a phase with an axis the direction of its axis");
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw ParameterError(fmt::format("a tolerance of {}", options.tolerance), "ask for one between 0 and 1: 1e-6");
  if (options.load)
  {
    requireComponents(options.load->strain, lattice.dimension, "a mean strain");
    requireComponents(options.load->stress, lattice.dimension, "a mean stress");
    if (!options.load->source.empty() && options.load->source.size() != phase.size())
      throw ParameterError(
        fmt::format("a source of {} values for {} voxels", options.load->source.size(), phase.size()),
        "give one a voxel");
    if (between(options.sides) && options.load->change != 0)
      throw ParameterError(
        "an expansion between platens whose other sides are free", "take periodic sides, or uniform ones");
  }
  kinds.ranks = options.ranks.size();
  const double bytes = voxelStiffnessBytes(lattice, kinds) * options.ranks.sizeOnMachine();
  together(options.ranks,
    [&]
    {
      const double free = options.memory > 0 ? options.memory : static_cast<double>(availableMemory());
      if (bytes > free)
        throw MemoryError(fmt::format("the stiffness of {} × {} × {} voxels takes {}, and {} are free", lattice.size[0],
                            lattice.size[1], lattice.size[2], bytesText(bytes), bytesText(free)),
          "take a window, or every second voxel");
    });
  VoxelStiffnessOptions own = options;
  const bool windows = options.windowError && options.tensor;
  if (windows && options.progress) // halves and thirds take about as long each as the box
    own.progress = [&options](double share) { return options.progress(share / 3); };
  VoxelStiffness result = lattice.dimension == 3 ? Study<3>(lattice, phase, materials, axis, own).run()
                                                 : Study<2>(lattice, phase, materials, axis, own).run();
  if (windows)
  {
    const double start = seconds();
    result.windows = stiffnessWindows(lattice, phase, materials, axis, options, result);
    result.windowSeconds = seconds() - start;
    if (result.windows.empty())
      result.warnings.emplace_back("the window error is not known: the box is too small to be cut into windows");
  }
  return result;
}

} // namespace lamella::elasticity
