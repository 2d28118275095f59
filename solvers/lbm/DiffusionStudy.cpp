#include "lbm/DiffusionStudy.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/Subsample.h"
#include "lbm/StudyChecks.h"
#include "lbm/WindowAnswers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace lamella::lbm
{
namespace
{

// Every second, third and fourth pixel make pictures.
constexpr std::array strides{ 2, 3, 4 };
// A subsample of fewer nodes along an axis tells nothing: second pixels only, then.
constexpr std::int64_t fewestAcross = 3;
// Pictures of a stride that are solved, about; in the plane there are 4, 9 and 16, in space 8, 27 and 64.
constexpr std::size_t fewPictures = 8;

/// The shares of solves in the whole, as far as they can be foreseen, handed on as one share that rises.
class StudyProgress
{
public:
  explicit StudyProgress(Progress outside)
    : outside_(std::move(outside))
  {
  }
  void foresee(double nodes, int solves = 1)
  {
    ahead_ += nodes * solves;
    solves_ += solves;
  }
  /// Of a solve that begins now.
  [[nodiscard]] Progress of(double nodes)
  {
    if (!outside_)
      return {};
    done_ += current_;
    current_ = nodes;
    begun_ += 1;
    ahead_ = std::max(ahead_, done_ + current_);
    return [this](double share, const char* what)
    {
      const std::string text = fmt::format("solve {} of {}: {}", begun_, std::max(begun_, solves_), what);
      told_ = std::max(told_, std::min(1.0, (done_ + share * current_) / ahead_)); // more may come than was foreseen
      return outside_(told_, text.c_str());
    };
  }

private:
  Progress outside_;
  double ahead_ = 0; ///< nodes of all solves
  double done_ = 0;
  double current_ = 0;
  double told_ = 0;
  int solves_ = 0;
  int begun_ = 0;
};

/// Which nodes of the study's picture another one holds: every stride-th from first on.
struct Part
{
  std::array<std::int64_t, 3> first{ 0, 0, 0 };
  std::int64_t stride = 1;
  bool window = false; ///< one of those that the picture is cut into: its sides are insulated, whatever the picture's
};

class Study
{
public:
  Study(const PhaseImage& image, std::span<const double> diffusivity, const StudyOptions& options, MPI_Comm comm,
    const FieldSink& sink)
    : image_(image)
    , diffusivity_(diffusivity)
    , options_(options)
    , comm_(comm)
    , sink_(sink)
    , factor_(image.lattice.dimension == 3 ? 8 : 4)
    , base_(nodesAt(options.refinement))
    , progress_(options.steady.progress)
  {
  }

  std::vector<DiffusionAnswer> run()
  {
    std::vector<DiffusionAnswer> answers;
    for (const int axis : options_.axes)
    {
      answers.emplace_back();
      answers.back().axis = axis;
    }
    foresee();
    const int refinement = options_.refinement;
    solvePicture(refinement, answers, !options_.targetError);
    if (options_.windowError)
      addWindowErrors(answers, image_.lattice, options_,
        [&](const SubWindow& window, std::span<RefinementStep> steps) { return solveWindow(window, answers, steps); });
    if (options_.targetError)
      refineToTarget(answers);
    else if (options_.estimateError)
      estimate(answers);
    for (DiffusionAnswer& a : answers)
      if (a.window) // a finer lattice changes what varies as it changes the value
        a.window = a.window->scaled(valueOf(a.result, a.axis) / a.window->value);
    return answers;
  }

private:
  [[nodiscard]] double nodesAt(int refinement) const
  {
    return static_cast<double>(image_.lattice.count()) * std::pow(refinement, image_.lattice.dimension);
  }

  void foresee()
  {
    const int axes = static_cast<int>(options_.axes.size());
    progress_.foresee(base_, axes);
    if (options_.windowError)
      for (const int parts : windowParts)
      {
        const double windows = std::pow(parts, image_.lattice.dimension);
        progress_.foresee(base_ / windows, axes * static_cast<int>(windows));
      }
    if (!options_.estimateError && !options_.targetError)
      return;
    const double most = static_cast<double>(options_.estimateNodes);
    if (base_ > most)
      progress_.foresee(most, axes);
    for (const int stride : strides)
      progress_.foresee(std::min(base_, most) / std::pow(stride, image_.lattice.dimension),
        axes * static_cast<int>(subsampleStarts(image_.lattice, stride, fewPictures).size()));
    if (base_ * factor_ <= most || options_.targetError)
      progress_.foresee(base_ * factor_, axes);
    else
    {
      progress_.foresee(most / factor_, axes);
      progress_.foresee(most, axes);
    }
  }

  /// Who solves a lattice: all ranks, or each by itself.
  [[nodiscard]] MPI_Comm handleOf(const Lattice& lattice) const { return shares(lattice) ? comm_ : MPI_COMM_SELF; }

  /// What membranes make of a picture; none: there are no membranes. @param axis that is solved along
  [[nodiscard]] std::optional<MembraneIds> membranesOf(
    const PhaseImage& refined, const Part& part, int refinement, int axis) const
  {
    if (options_.membranes.empty())
      return std::nullopt;
    const Sides sides = part.window ? Sides::Insulated : options_.steady.sides;
    std::array<bool, 3> wraps{ sides != Sides::Insulated, sides != Sides::Insulated, sides != Sides::Insulated };
    wraps[static_cast<std::size_t>(axis)] = sides == Sides::Periodic;
    return membraneIds(refined, refinement, options_.membranes, wraps);
  }

  /// @param refined   the nodes of `part`, split
  /// @param membranes of these nodes, which outlive the solver, or null
  /// @param solves    for how many directions
  SteadyDiffusion solverOf(const PhaseImage& refined, const MembraneIds* membranes, const Part& part, int refinement,
    bool fields, int solves = 1)
  {
    const MPI_Comm handle = handleOf(refined.lattice);
    const Block block = decompose(refined.lattice, handle);
    SteadyOptions steady = options_.steady;
    steady.progress = progress_.of(static_cast<double>(refined.lattice.count()) * solves);
    if (handle != comm_)
      steady.progress = {}; // a moment's work that every rank does: none may stop alone
    if (!fields)
      steady.fieldTolerance = std::numeric_limits<double>::infinity(); // nobody sees the field
    if (part.window)
    {
      steady.sides = Sides::Insulated;
      steady.tolerance = std::max(steady.tolerance, windowTolerance);
      steady.rough = true;
    }
    if (part.stride > 1 || part.window)
      steady.method = Method::Auto; // what suits the picture need not suit a part of it
    if (options_.directed)
    {
      const bool elements = steady.stencil == Stencil::Q1; // links are of the whole lattice on every rank
      auto directed = std::make_shared<DirectedDiffusivity>(
        directedOf(elements ? block : Block{ { 0, 0, 0 }, refined.lattice.size }, part, refinement));
      if (elements)
        steady.directed = std::move(directed);
      else
      {
        steady.stencil = Stencil::D2Q9;
        steady.links =
          std::make_shared<LinkTable>(directedLinks(refined.lattice, refined.phase, *directed, steady.sides));
      }
    }
    const bool whole = block.count() == refined.lattice.count();
    if (membranes != nullptr)
    {
      auto pairs =
        std::make_shared<PairTable>(membraneLinks(*membranes, diffusivity_, options_.membranes, refined.lattice));
      std::vector<double> byId;
      for (const std::uint8_t phase : membranes->phase)
        byId.push_back(diffusivity_[phase]);
      steady.pairs = std::move(pairs);
      return whole
        ? SteadyDiffusion(refined.lattice, block, membranes->id, byId, steady, handle)
        : SteadyDiffusion(refined.lattice, block, blockOf(refined.lattice, membranes->id, block), byId, steady, handle);
    }
    return whole ? SteadyDiffusion(refined.lattice, block, refined.phase, diffusivity_, steady, handle)
                 : SteadyDiffusion(refined.lattice, block, blockOf(refined, block), diffusivity_, steady, handle);
  }

  /// Solves a picture along one axis.
  SteadyResult solve(const PhaseImage& refined, const Part& part, int refinement, DiffusionAnswer& answer,
    RefinementStep& step, bool fields, bool whole = false)
  {
    const Communicator comm(handleOf(refined.lattice));
    const std::optional<MembraneIds> membranes = membranesOf(refined, part, refinement, answer.axis);
    SteadyDiffusion solver = solverOf(refined, membranes ? &*membranes : nullptr, part, refinement, fields);
    if (!std::exchange(pathsKnown_, true)) // splitting pixels changes no neighbourhood: the first solve tells of all
      requirePaths(solver, options_.axes, image_.lattice.dimension);
    SteadyResult result = solver.solve(answer.axis);
    step.refinement = refinement;
    step.nodes += refined.lattice.count();
    step.iterations += result.iterations;
    step.seconds += comm.max(result.setupSeconds + result.solveSeconds);
    step.value = valueOf(result, answer.axis);
    if (whole && membranes && (options_.derivatives || options_.estimateError))
      takeMembranes(solver, *membranes, refined.lattice, step.value, answer);
    else if (whole && options_.derivatives)
      answer.derivatives = solver.derivatives();
    if (whole && options_.surfaces)
    {
      answer.surfaces = solver.surfaceDerivatives();
      for (double& d : answer.surfaces.shift)
        d *= refinement;
      for (double& a : answer.surfaces.area)
        a *= refinement;
    }
    if (fields)
      sink_(solver, answer, refined.lattice, decompose(refined.lattice, handleOf(refined.lattice)));
    return result;
  }

  /// Derivatives, and what an error of the surfaces' area leaves; of planes along the lattice that is exact.
  void takeMembranes(const SteadyDiffusion& solver, const MembraneIds& membranes, const Lattice& lattice, double value,
    DiffusionAnswer& answer) const
  {
    ConductivityDerivatives by =
      membraneDerivatives(solver.pairDerivatives(), membranes, diffusivity_, options_.membranes, lattice);
    double part = 0;
    if (std::ranges::any_of(membranes.flatness, [](double f) { return f < 1; }))
      for (std::size_t i = 0; i < by.membranes.size(); ++i)
        part += std::abs(by.membranes[i]) * options_.membranes[i].resistance / value;
    answer.membraneError = membraneAreaError * part;
    if (options_.derivatives)
      answer.derivatives = std::move(by);
  }

  static double valueOf(const SteadyResult& result, int axis)
  {
    return result.effective[static_cast<std::size_t>(axis)];
  }

  /// Whether all ranks find rows in a lattice.
  [[nodiscard]] bool shares(const Lattice& lattice) const
  {
    const Communicator comm(comm_);
    if (!comm.parallel())
      return true;
    try
    {
      (void)Decomposition(lattice, comm);
      return true;
    }
    catch (const ParameterError&)
    {
      return lattice.count() == image_.lattice.count(); // the picture itself: refused as it is
    }
  }

  // Of a part of the picture, split.
  [[nodiscard]] DirectedDiffusivity directedOf(const Block& block, const Part& of, int refinement) const
  {
    const DirectedDiffusivity& whole = *options_.directed;
    DirectedDiffusivity part{ whole.along, whole.across, {}, whole.source, whole.ofPhase, {}, whole.least };
    const auto node = [&](std::size_t axis, std::int64_t i) { return of.first[axis] + of.stride * (i / refinement); };
    const auto last = [&](std::size_t axis) { return block.start[axis] + block.size[axis]; };
    const bool flat = image_.lattice.size[2] == 1;
    const auto take = [&](const auto& from, auto& to)
    {
      if (from.empty())
        return;
      to.reserve(static_cast<std::size_t>(block.count()));
      for (std::int64_t z = block.start[2]; z < last(2); ++z)
        for (std::int64_t y = block.start[1]; y < last(1); ++y)
          for (std::int64_t x = 0; x < block.size[0]; ++x)
            to.push_back(
              from[static_cast<std::size_t>(image_.lattice.index(node(0, x), node(1, y), flat ? 0 : node(2, z)))]);
    };
    take(whole.axis, part.axis);
    take(whole.ofNode, part.ofNode);
    return part;
  }

  /// The whole picture along all axes: the answers' results.
  void solvePicture(int refinement, std::vector<DiffusionAnswer>& answers, bool final)
  {
    const PhaseImage split = refinement == 1 ? PhaseImage{} : refine(image_, refinement);
    const PhaseImage& refined = refinement == 1 ? image_ : split;
    for (auto& a : answers)
    {
      RefinementStep step;
      a.refinement = refinement;
      a.result = solve(refined, {}, refinement, a, step, final && sink_, true);
      a.steps.push_back(step);
    }
  }

  /// Value of a centred window, or of all, noted as a step for the estimate.
  double solveSample(const PhaseImage& refined, const Part& part, int refinement, bool whole, DiffusionAnswer& a)
  {
    RefinementStep step;
    step.sampled = !whole;
    (void)solve(refined, part, refinement, a, step, false);
    a.steps.push_back(step);
    return step.value;
  }

  /// What an endlessly fine lattice would add to the values of `answers`, relative to them, from pixels split in two
  /// (Richardson, order 1: between order 1 and 2, whatever the corners do, it is the cautious choice). NaN: no path
  /// through the window.
  [[nodiscard]] std::vector<double> latticeChanges(std::vector<DiffusionAnswer>& answers)
  {
    const int n = options_.refinement;
    const bool whole = base_ * factor_ <= static_cast<double>(options_.estimateNodes);
    Part part;
    const PhaseImage window = whole ? PhaseImage{} : centredWindow(n, factor_, part);
    const PhaseImage& sample = whole ? image_ : window;
    const PhaseImage coarse = whole ? PhaseImage{} : refine(sample, n);
    const PhaseImage fine = refine(sample, 2 * n);
    std::vector<double> changes;
    for (auto& a : answers)
    {
      try
      {
        const double atN = whole ? valueOf(a.result, a.axis) : solveSample(coarse, part, n, whole, a);
        changes.push_back(2 * (solveSample(fine, part, 2 * n, whole, a) - atN) / atN);
      }
      catch (const NoPathError&)
      {
        changes.push_back(std::numeric_limits<double>::quiet_NaN());
      }
    }
    return changes;
  }

  /// What the picture's subsamples say, by answer; none: no path through the window.
  [[nodiscard]] std::vector<std::optional<PictureError>> pictureErrors(std::vector<DiffusionAnswer>& answers)
  {
    const int n = options_.refinement;
    const bool whole = base_ <= static_cast<double>(options_.estimateNodes);
    Part part;
    const PhaseImage window = whole ? PhaseImage{} : centredWindow(n, 1, part);
    const PhaseImage& sample = whole ? image_ : window;
    const PhaseImage refined = whole || n == 1 ? PhaseImage{} : refine(sample, n);
    std::vector<std::optional<PictureError>> errors;
    for (auto& a : answers)
    {
      try
      {
        const double value =
          whole ? valueOf(a.result, a.axis) : solveSample(n == 1 ? sample : refined, part, n, whole, a);
        std::vector<SubsampleValues> subsamples;
        for (const int stride : strides)
          if (stride == 2 ||
            std::ranges::all_of(
              sample.lattice.size, [&](std::int64_t s) { return s == 1 || s >= stride * fewestAcross; }))
            subsamples.push_back({ static_cast<double>(stride), subsampleValues(sample, part, stride, n, whole, a) });
        // A window's values differ from the whole picture's, the ratios between them hardly: all in the whole's.
        const double scale = valueOf(a.result, a.axis) / value;
        for (SubsampleValues& of : subsamples)
          for (double& v : of.values)
            v *= scale;
        errors.emplace_back(std::in_place, value * scale, subsamples);
      }
      catch (const NoPathError&)
      {
        errors.emplace_back();
      }
    }
    return errors;
  }

  [[nodiscard]] std::vector<double> subsampleValues(
    const PhaseImage& sample, const Part& part, int stride, int refinement, bool whole, DiffusionAnswer& a)
  {
    std::vector<double> values;
    RefinementStep step;
    step.sampled = !whole;
    step.every = stride;
    for (const auto& start : subsampleStarts(sample.lattice, stride, fewPictures))
    {
      PhaseImage picture = subsample(sample, start, stride);
      if (refinement > 1)
        picture = refine(picture, refinement);
      Part of = part;
      of.stride = stride;
      for (std::size_t axis = 0; axis < 3; ++axis)
        of.first[axis] += start[axis];
      try
      {
        (void)solve(picture, of, refinement, a, step, false);
        values.push_back(step.value);
      }
      catch (const NoPathError&)
      {
        values.push_back(0);
      }
    }
    summarise(step, values);
    a.steps.push_back(step);
    return values;
  }

  /// Values of one of the picture's windows along all axes.
  std::vector<double> solveWindow(
    const SubWindow& window, const std::vector<DiffusionAnswer>& answers, std::span<RefinementStep> steps)
  {
    PhaseImage picture = cut(image_, window);
    std::vector<double> values(answers.size(), 0.0);
    if (std::ranges::none_of(picture.phase, [&](std::uint8_t id) { return diffusivity_[id] > 0; }))
      return values;
    if (options_.refinement > 1)
      picture = refine(picture, options_.refinement);
    Part part;
    part.first = window.first;
    part.window = true;
    const Communicator comm(handleOf(picture.lattice));
    const std::optional<MembraneIds> membranes = membranesOf(picture, part, options_.refinement, answers.front().axis);
    SteadyDiffusion solver = solverOf(
      picture, membranes ? &*membranes : nullptr, part, options_.refinement, false, static_cast<int>(answers.size()));
    for (std::size_t i = 0; i < answers.size(); ++i)
    {
      try
      {
        const SteadyResult result = solver.solve(answers[i].axis);
        values[i] = valueOf(result, answers[i].axis);
        steps[i].iterations += result.iterations;
        steps[i].seconds += comm.max(result.setupSeconds + result.solveSeconds);
      }
      catch (const NoPathError&)
      {
      }
      steps[i].nodes += picture.lattice.count();
    }
    return values;
  }

  /// Adds what the iteration leaves.
  static ErrorEstimate withSolver(ErrorEstimate error, const SteadyResult& result)
  {
    error.relative += result.solverError;
    error.lattice += result.solverError;
    return error;
  }

  void estimate(std::vector<DiffusionAnswer>& answers)
  {
    lattices_ = latticeChanges(answers);
    pictures_ = pictureErrors(answers);
    changes_.assign(answers.size(), 0.0);
    takeErrors(answers);
  }

  void takeErrors(std::vector<DiffusionAnswer>& answers) const
  {
    for (std::size_t i = 0; i < answers.size(); ++i)
      if (pictures_[i])
      {
        answers[i].error = withSolver(pictures_[i]->estimate(changes_[i], lattices_[i]), answers[i].result);
        answers[i].error.relative += answers[i].membraneError;
        answers[i].error.picture += answers[i].membraneError;
      }
  }

  /// The worst total error once pixels are split `times` as often as now; infinite where it is not known.
  [[nodiscard]] double foreseen(double times, const std::vector<DiffusionAnswer>& answers) const
  {
    double worst = 0;
    for (std::size_t i = 0; i < pictures_.size(); ++i)
    {
      const double change = changes_[i] + (1 - 1 / times) * lattices_[i];
      const double bar =
        pictures_[i] ? pictures_[i]->bar(change) / (1 + change) + answers[i].membraneError : std::nan("");
      worst = std::isfinite(bar) ? std::max(worst, bar) : std::numeric_limits<double>::infinity();
    }
    return worst;
  }

  void refineToTarget(std::vector<DiffusionAnswer>& answers)
  {
    const double target = *options_.targetError;
    const auto allowed = static_cast<std::uint64_t>(options_.memoryShare * static_cast<double>(availableMemory()));
    std::vector<double> base; // values at the first refinement
    for (const auto& a : answers)
      base.push_back(valueOf(a.result, a.axis));
    estimate(answers);
    Target how = Target::Reached;
    TargetPlan plan;
    for (int refinement = options_.refinement; worst(answers) > target;)
    {
      constexpr int mostDoublings = 12;
      int doublings = 1;
      while (doublings <= mostDoublings && foreseen(std::exp2(doublings), answers) > target)
        ++doublings;
      if (doublings > mostDoublings)
      {
        how = Target::PictureTooCoarse;
        break;
      }
      const int next = refinement << doublings;
      plan = planOf(next, refinement, answers, allowed);
      if (plan.bytes > plan.allowed)
      {
        how = Target::MemoryShort;
        break;
      }
      if (options_.announce && Communicator(comm_).any(!options_.announce(plan)))
        throw Cancelled();
      progress_.foresee(nodesAt(next), static_cast<int>(answers.size()));
      const std::vector<double> before = changes_;
      solvePicture(next, answers, false);
      for (std::size_t i = 0; i < answers.size(); ++i)
      {
        changes_[i] = valueOf(answers[i].result, answers[i].axis) / base[i] - 1;
        lattices_[i] = (changes_[i] - before[i]) / (std::exp2(doublings) - 1); // order 1: what is still to come
      }
      takeErrors(answers);
      refinement = next;
    }
    for (auto& a : answers)
    {
      a.target = how;
      a.plan = plan;
    }
    if (sink_) // the fields of the refinement that counts: solved again, so that only one field is ever held
      solveFields(answers);
  }

  void solveFields(std::vector<DiffusionAnswer>& answers)
  {
    const int refinement = answers.front().refinement;
    const PhaseImage split = refinement == 1 ? PhaseImage{} : refine(image_, refinement);
    for (auto& a : answers)
    {
      RefinementStep step;
      a.result = solve(refinement == 1 ? image_ : split, {}, refinement, a, step, true);
    }
  }

  [[nodiscard]] TargetPlan planOf(
    int next, int refinement, const std::vector<DiffusionAnswer>& answers, std::uint64_t allowed) const
  {
    TargetPlan plan;
    plan.refinement = next;
    const double nodes = nodesAt(next);
    Lattice lattice = image_.lattice;
    // Only the count matters; more than this many need more memory than there is, whatever the rest.
    lattice.size = { static_cast<std::int64_t>(std::min(nodes, 1e17)), 1, 1 };
    plan.nodes = lattice.count();
    const std::int64_t zeros =
      std::ranges::count_if(image_.phase, [&](std::uint8_t id) { return !(diffusivity_[id] > 0); });
    const double share = 1 - static_cast<double>(zeros) / static_cast<double>(image_.lattice.count());
    plan.bytes =
      estimateBytes(lattice,
        options_.directed && options_.steady.stencil != Stencil::Q1 ? Stencil::D2Q9 : options_.steady.stencil,
        leanest(lattice, options_.steady.stencil, zeros == 0),
        static_cast<std::int64_t>(share * static_cast<double>(plan.nodes))) +
      static_cast<std::uint64_t>(plan.nodes);
    plan.allowed = allowed;
    double seconds = 0;
    for (const auto& a : answers)
      seconds += a.result.setupSeconds + a.result.solveSeconds;
    plan.seconds = Communicator(comm_).max(seconds) * nodes / nodesAt(refinement);
    // One decision for all ranks.
    plan.bytes = static_cast<std::uint64_t>(Communicator(comm_).max(static_cast<double>(plan.bytes)));
    plan.allowed = static_cast<std::uint64_t>(-Communicator(comm_).max(-static_cast<double>(allowed)));
    return plan;
  }

  /// Infinite where an error is not known.
  static double worst(const std::vector<DiffusionAnswer>& answers)
  {
    double e = 0;
    for (const auto& a : answers)
      e = std::isnan(a.error.relative) ? std::numeric_limits<double>::infinity() : std::max(e, a.error.relative);
    return e;
  }

  /// The largest centred window, the same shape as the picture, whose refined lattice times `factor` keeps to
  /// estimateNodes.
  [[nodiscard]] PhaseImage centredWindow(int n, int factor, Part& part) const
  {
    const int d = image_.lattice.dimension;
    const double allowed = static_cast<double>(options_.estimateNodes) / factor / std::pow(n, d);
    const double share = std::min(1.0, std::pow(allowed / static_cast<double>(image_.lattice.count()), 1.0 / d));
    Window w;
    for (int a = 0; a < d; ++a)
    {
      const auto full = image_.lattice.size[a];
      auto size = std::max<std::int64_t>(1, static_cast<std::int64_t>(share * static_cast<double>(full)));
      if (options_.steady.sides != Sides::Insulated)
        size = std::max<std::int64_t>(std::min<std::int64_t>(2, full), size / 2 * 2);
      w.size[a] = size;
      w.start[a] = (full - size) / 2;
    }
    part.first = firstNode(image_.lattice, w);
    return crop(image_, w);
  }

  const PhaseImage& image_;
  std::span<const double> diffusivity_;
  const StudyOptions& options_;
  MPI_Comm comm_;
  const FieldSink& sink_;
  int factor_;  ///< nodes a node becomes when it is split in two along each axis
  double base_; ///< nodes at the first refinement
  StudyProgress progress_;
  bool pathsKnown_ = false;
  std::vector<std::optional<PictureError>> pictures_; ///< by answer
  std::vector<double> changes_;  ///< by answer: of the value at the present refinement from that at the first, relative
  std::vector<double> lattices_; ///< what a lattice without end would add to it, over the value at the first
};

} // namespace

std::vector<std::uint8_t> blockOf(const PhaseImage& image, const Block& block)
{
  return blockOf(image.lattice, image.phase, block);
}

std::vector<std::uint8_t> blockOf(const Lattice& lattice, std::span<const std::uint8_t> ids, const Block& block)
{
  std::vector<std::uint8_t> part(static_cast<std::size_t>(block.count()));
  auto out = part.begin();
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      out = std::copy_n(
        ids.begin() + lattice.index(block.start[0], y + block.start[1], z + block.start[2]), block.size[0], out);
  return part;
}

std::vector<DiffusionAnswer> studyDiffusion(const PhaseImage& image, std::span<const double> diffusivity,
  const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
{
  if (options.refinement < 1)
    throw ParameterError(fmt::format("refinement {} is below 1", options.refinement), "use 1 or more");
  if (options.targetError && !(*options.targetError > 0 && *options.targetError < 1))
    throw ParameterError(fmt::format("target error {} is not between 0 and 1", *options.targetError),
      "ask for instance for 0.01, which is 1 %");
  if (options.directed)
    for (const auto& [count, needed, what] :
      { std::tuple{ options.directed->axis.size(), options.directed->hasAxes(), "axes" },
        std::tuple{ options.directed->ofNode.size(), !options.directed->ofNode.empty(), "tensors" } })
      if (needed && count != image.phase.size())
        throw ParameterError(fmt::format("{} {} were given for a picture of {} nodes", count, what, image.phase.size()),
          "give one for every node");
  if (!options.membranes.empty() && options.directed)
    throw ParameterError("membranes between phases that conduct differently by direction",
      "give each phase one conductivity, or leave the membranes out");
  if (!options.membranes.empty() && options.surfaces)
    throw ParameterError("derivatives by where surfaces lie, of surfaces with membranes", "leave one of them out");
  return Study(image, diffusivity, options, comm, sink).run();
}

} // namespace lamella::lbm
