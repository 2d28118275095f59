#include "lbm/DiffusionStudy.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"

#include <fmt/format.h>

#include <algorithm>

namespace lamella::lbm
{
namespace
{

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
    int refinement = options_.refinement;
    solveAll(refinement, answers, !options_.targetError);
    if (options_.targetError)
      refineToTarget(refinement, answers);
    else if (options_.estimateError)
      estimate(answers);
    return answers;
  }

private:
  // Solves `image` at a refinement along one axis and notes it as a step.
  double solveOne(const PhaseImage& refined, int refinement, DiffusionAnswer& answer, bool sampled, bool final)
  {
    const Communicator comm(comm_);
    const Block block = decompose(refined.lattice, comm_);
    SteadyOptions steady = options_.steady;
    if (!final || !sink_)
      steady.fieldTolerance = std::numeric_limits<double>::infinity(); // nobody sees the field
    if (options_.directed)
    {
      steady.stencil = Stencil::D2Q9;
      steady.links = std::make_shared<LinkTable>(linksOf(refined, refinement));
    }
    SteadyDiffusion solver(refined.lattice, block, blockOf(refined, block), diffusivity_, steady, comm_);
    const SteadyResult result = solver.solve(answer.axis);
    answer.steps.push_back({ refinement, result.effective[static_cast<std::size_t>(answer.axis)],
      refined.lattice.count(), result.iterations, comm.max(result.setupSeconds + result.solveSeconds), sampled });
    if (!sampled)
      answer.result = result;
    if (final && sink_)
      sink_(solver, answer, refined.lattice, block);
    return answer.steps.back().value;
  }

  // Links of the picture or, once there is one, of the window, split.
  [[nodiscard]] LinkTable linksOf(const PhaseImage& refined, int refinement) const
  {
    const DirectedDiffusivity& whole = *options_.directed;
    DirectedDiffusivity part{ whole.along, whole.across, {} };
    part.axis.reserve(refined.phase.size());
    for (std::int64_t y = 0; y < refined.lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < refined.lattice.size[0]; ++x)
        part.axis.push_back(whole.axis[static_cast<std::size_t>(
          image_.lattice.index(first_[0] + x / refinement, first_[1] + y / refinement))]);
    return directedLinks(refined.lattice, refined.phase, part, options_.steady.sides);
  }

  void solveAll(int refinement, std::vector<DiffusionAnswer>& answers, bool final)
  {
    if (refinement == 1)
      for (auto& a : answers)
        solveOne(image_, 1, a, false, final);
    else
    {
      const PhaseImage refined = refine(image_, refinement);
      for (auto& a : answers)
        solveOne(refined, refinement, a, false, final);
    }
  }

  void estimate(std::vector<DiffusionAnswer>& answers)
  {
    const int factor = image_.lattice.dimension == 3 ? 8 : 4;
    const int n = options_.refinement;
    std::int64_t base = image_.lattice.count();
    for (int i = 0; i < image_.lattice.dimension; ++i)
      base *= n;
    const bool whole = base * factor <= options_.estimateNodes;
    const PhaseImage part = whole ? PhaseImage{} : centredWindow(n, factor);
    const PhaseImage& sample = whole ? image_ : part;
    const PhaseImage fine = refine(sample, 2 * n);
    const PhaseImage coarse = whole ? PhaseImage{} : refine(sample, n);
    for (auto& a : answers)
    {
      try
      {
        const double atN = whole ? a.steps.front().value : solveOne(coarse, n, a, true, false);
        const double at2N = solveSampled(fine, 2 * n, a, whole);
        a.error.relative = richardsonError(atN, at2N, 1.0, false);
        const double change = (at2N - atN) / atN; // order 1: the limit lies as far again beyond the finer value
        a.error.extrapolated = a.result.effective[static_cast<std::size_t>(a.axis)] * (1 + 2 * change);
      }
      catch (const NoPathError&)
      {
        // the window does not percolate: no estimate, said as NaN
      }
    }
  }

  double solveSampled(const PhaseImage& fine, int refinement, DiffusionAnswer& a, bool whole)
  {
    const SteadyResult kept = a.result;
    const double value = solveOne(fine, refinement, a, true, false);
    a.steps.back().sampled = !whole;
    a.result = kept;
    return value;
  }

  void refineToTarget(int refinement, std::vector<DiffusionAnswer>& answers)
  {
    const double target = *options_.targetError;
    for (;;)
    {
      const int finer = 2 * refinement;
      std::int64_t nodes = image_.lattice.count();
      for (int i = 0; i < image_.lattice.dimension; ++i)
        nodes *= finer;
      Lattice lattice = image_.lattice;
      lattice.size[0] = nodes; // only the count matters
      lattice.size[1] = lattice.size[2] = 1;
      const std::uint64_t needed =
        estimateBytes(lattice, options_.steady.stencil, Method::Multigrid, nodes) + static_cast<std::uint64_t>(nodes);
      const double reached = answers.front().steps.size() < 2 ? 1.0 : worst(answers);
      const Communicator comm(comm_);
      if (comm.any(needed / static_cast<std::uint64_t>(comm.size()) > availableMemory()))
        throw MemoryError(
          fmt::format("an error of {:.2g} % needs refinement {} and about {}, and {} are available", 100 * target,
            finer, bytesText(static_cast<double>(needed)), bytesText(static_cast<double>(availableMemory()))),
          answers.front().steps.size() < 2
            ? std::string("ask for a larger error, or use a smaller window")
            : fmt::format("ask for at most {:.2g} %, which refinement {} reaches, or use a smaller window",
                100 * reached * 1.01, refinement));
      solveAll(finer, answers, false);
      refinement = finer;
      for (auto& a : answers)
        updateError(a);
      if (worst(answers) <= target)
        break;
    }
    if (sink_) // the fields of the last refinement: solved again, so that only one field is ever held
    {
      const PhaseImage refined = refine(image_, refinement);
      for (auto& a : answers)
      {
        solveOne(refined, refinement, a, false, true);
        a.steps.pop_back();
      }
    }
  }

  static void updateError(DiffusionAnswer& a)
  {
    const std::size_t n = a.steps.size();
    const double fine = a.steps[n - 1].value;
    const double coarse = a.steps[n - 2].value;
    if (n >= 3)
    {
      const double ratio = (coarse - a.steps[n - 3].value) / (fine - coarse);
      a.error.order = ratio > 2.0 ? std::min(std::log2(ratio), 2.0) : 1.0;
    }
    a.error.relative = richardsonError(coarse, fine, a.error.order, true);
    a.error.extrapolated = fine + (fine - coarse) / (std::exp2(a.error.order) - 1);
  }

  static double worst(const std::vector<DiffusionAnswer>& answers)
  {
    double e = 0;
    for (const auto& a : answers)
      e = std::max(e, a.error.relative);
    return e;
  }

  // The largest centred window, the same shape as the picture, whose refined lattice keeps to estimateNodes.
  [[nodiscard]] PhaseImage centredWindow(int n, int factor)
  {
    const int d = image_.lattice.dimension;
    const double allowed = static_cast<double>(options_.estimateNodes) / factor / std::pow(n, d);
    const double share = std::pow(allowed / static_cast<double>(image_.lattice.count()), 1.0 / d);
    Window w;
    for (int a = 0; a < d; ++a)
    {
      const auto full = image_.lattice.size[a];
      auto size = std::max<std::int64_t>(1, static_cast<std::int64_t>(share * static_cast<double>(full)));
      if (options_.steady.sides == Sides::Periodic)
        size = std::max<std::int64_t>(std::min<std::int64_t>(2, full), size / 2 * 2);
      w.size[a] = size;
      w.start[a] = (full - size) / 2;
    }
    first_ = firstNode(image_.lattice, w);
    return crop(image_, w);
  }

  const PhaseImage& image_;
  std::span<const double> diffusivity_;
  const StudyOptions& options_;
  MPI_Comm comm_;
  const FieldSink& sink_;
  std::array<std::int64_t, 3> first_{ 0, 0, 0 }; // node of the picture that is solved: of the window, once there is one
};

} // namespace

double richardsonError(double coarse, double fine, double order, bool ofFine)
{
  const double change = std::abs(fine - coarse);
  const double ofFineOne = change / (std::exp2(order) - 1);
  return (ofFine ? ofFineOne : ofFineOne + change) / std::abs(ofFine ? fine : coarse);
}

std::vector<std::uint8_t> blockOf(const PhaseImage& image, const Block& block)
{
  std::vector<std::uint8_t> part(static_cast<std::size_t>(block.count()));
  auto out = part.begin();
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      out =
        std::copy_n(image.phase.begin() + image.lattice.index(block.start[0], y + block.start[1], z + block.start[2]),
          block.size[0], out);
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
  if (options.directed && options.directed->axis.size() != image.phase.size())
    throw ParameterError(
      fmt::format("{} axes were given for a picture of {} nodes", options.directed->axis.size(), image.phase.size()),
      "give one for every node");
  return Study(image, diffusivity, options, comm, sink).run();
}

} // namespace lamella::lbm
