#include "lbm/Shares.h"

#include "core/Error.h"
#include "lattice/SpacingError.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella::lbm
{

AcrossSurface ruleFor(bool betterPercolates) noexcept
{
  return betterPercolates ? AcrossSurface::Parallel : AcrossSurface::Series;
}

PairTable shareLinks(std::span<const double> share, double first, double second, AcrossSurface rule)
{
  for (const double k : { first, second })
    if (!std::isfinite(k) || k < 0)
      throw ParameterError(fmt::format("conductivity {} is not a finite number of at least 0", k),
        "give a positive value, or 0 for a phase that does not conduct");
  PairTable table;
  table.ids = share.size();
  table.link.resize(table.ids * table.ids);
  for (std::size_t i = 0; i < table.ids; ++i)
  {
    if (!(share[i] >= 0 && share[i] <= 1))
      throw ParameterError(
        fmt::format("share {} of id {} is outside 0 to 1", share[i], i), "give the part of a node in the second phase");
    for (std::size_t j = 0; j <= i; ++j)
    {
      double g = 0;
      if (rule == AcrossSurface::Parallel)
      {
        const double s = 0.5 * (share[i] + share[j]);
        g = s * second + (1 - s) * first;
      }
      else
      {
        const double s = std::clamp(share[i] + share[j] - 0.5, 0.0, 1.0);
        const double resistance = (s > 0 ? s / second : 0) + (s < 1 ? (1 - s) / first : 0);
        g = std::isfinite(resistance) ? 1 / resistance : 0;
      }
      table.link[i * table.ids + j] = table.link[j * table.ids + i] = g;
    }
  }
  for (std::size_t i = 0; i < table.ids; ++i)
    if (!(table.link[i * table.ids + i] > 0))
      for (std::size_t j = 0; j < table.ids; ++j)
        table.link[i * table.ids + j] = table.link[j * table.ids + i] = 0;
  return table;
}

namespace
{

constexpr int levels = 255; // of mean shares
constexpr std::int64_t fewestAcross = 3;

std::vector<double> evenShares()
{
  std::vector<double> share;
  for (int i = 0; i < levels; ++i)
    share.push_back(i / static_cast<double>(levels - 1));
  return share;
}

// Nodes of twice the spacing, ids among evenShares(); of an odd side all but the last nodes.
PhaseImage halved(const PhaseImage& image, std::span<const double> share)
{
  PhaseImage half;
  half.lattice = image.lattice;
  half.lattice.spacing *= 2;
  std::array<std::int64_t, 3> step{ 1, 1, 1 };
  double weight = 1;
  for (int a = 0; a < image.lattice.dimension; ++a)
    if (image.lattice.size[a] > 1)
    {
      half.lattice.size[a] = image.lattice.size[a] / 2;
      step[static_cast<std::size_t>(a)] = 2;
      weight /= 2;
    }
  half.phase.reserve(static_cast<std::size_t>(half.lattice.count()));
  for (std::int64_t z = 0; z < half.lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < half.lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < half.lattice.size[0]; ++x)
      {
        double sum = 0;
        for (std::int64_t k = 0; k < step[2]; ++k)
          for (std::int64_t j = 0; j < step[1]; ++j)
            for (std::int64_t i = 0; i < step[0]; ++i)
              sum += share[image.phase[static_cast<std::size_t>(
                image.lattice.index(step[0] * x + i, step[1] * y + j, step[2] * z + k))]];
        half.phase.push_back(static_cast<std::uint8_t>(std::lround(weight * sum * (levels - 1))));
      }
  return half;
}

class ShareStudy
{
public:
  ShareStudy(double first, double second, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
    : first_(first)
    , second_(second)
    , options_(options)
    , comm_(comm)
    , sink_(sink)
  {
  }

  DiffusionAnswer along(int axis, const PhaseImage& image, std::span<const double> share)
  {
    DiffusionAnswer answer;
    answer.axis = axis;
    const AcrossSurface rule = ruleFor(betterPercolates(axis, image, share));
    answer.result = solve(answer, image, share, rule, 1, static_cast<bool>(sink_));
    if (!options_.estimateError)
      return answer;
    const double value = valueOf(answer.result, axis);
    double fine = value; // of what the coarse picture shows
    bool odd = false;
    Window even;
    for (int a = 0; a < image.lattice.dimension; ++a)
    {
      even.size[static_cast<std::size_t>(a)] = std::max<std::int64_t>(1, image.lattice.size[a] / 2 * 2);
      odd = odd || even.size[static_cast<std::size_t>(a)] != image.lattice.size[a];
      if (image.lattice.size[a] / 2 < fewestAcross && image.lattice.size[a] > 1)
        return answer; // too few nodes to tell
    }
    if (odd)
      fine = valueOf(solve(answer, crop(image, even), share, rule, 1, false), axis);
    const std::vector<double> shares = evenShares();
    PhaseImage half = halved(image, share);
    const double coarse = valueOf(solve(answer, half, shares, rule, 2, false), axis);
    std::optional<double> coarser;
    if (std::ranges::all_of(
          half.lattice.size, [](std::int64_t n) { return n == 1 || (n % 2 == 0 && n / 2 >= fewestAcross); }))
    {
      half = halved(half, shares);
      coarser = valueOf(solve(answer, half, shares, rule, 4, false), axis);
    }
    const SpacingError error = spacingError(fine, coarse, coarser);
    answer.error.relative = error.bar / fine + answer.result.solverError;
    answer.error.lattice = answer.error.relative;
    answer.error.picture = 0;
    answer.error.extrapolated = value / fine * error.extrapolated;
    return answer;
  }

private:
  static double valueOf(const SteadyResult& result, int axis)
  {
    return result.effective[static_cast<std::size_t>(axis)];
  }

  bool betterPercolates(int axis, const PhaseImage& image, std::span<const double> share) const
  {
    std::vector<double> open;
    for (const double s : share)
      open.push_back((s >= 0.5) == (second_ > first_) ? 1 : 0);
    SteadyOptions o = options_.steady;
    o.progress = {};
    try
    {
      return solverOf(image, open, o).percolates(axis);
    }
    catch (const NoPathError&)
    {
      return false; // there is none of it
    }
  }

  [[nodiscard]] MPI_Comm sharedBy(const Lattice& lattice) const
  {
    try
    {
      (void)Decomposition(lattice, Communicator(comm_));
      return comm_;
    }
    catch (const ParameterError&)
    {
      return MPI_COMM_SELF; // too few rows: every rank does it all
    }
  }

  [[nodiscard]] SteadyDiffusion solverOf(
    const PhaseImage& image, std::span<const double> diffusivity, const SteadyOptions& o) const
  {
    const MPI_Comm handle = sharedBy(image.lattice);
    const Block block = decompose(image.lattice, handle);
    return block.count() == image.lattice.count()
      ? SteadyDiffusion(image.lattice, block, image.phase, diffusivity, o, handle)
      : SteadyDiffusion(image.lattice, block, blockOf(image, block), diffusivity, o, handle);
  }

  SteadyResult solve(DiffusionAnswer& answer, const PhaseImage& image, std::span<const double> share,
    AcrossSurface rule, int every, bool fields) const
  {
    SteadyOptions o = options_.steady;
    auto pairs = std::make_shared<PairTable>(shareLinks(share, first_, second_, rule));
    std::vector<double> diffusivity;
    for (std::size_t i = 0; i < pairs->ids; ++i)
      diffusivity.push_back(pairs->link[i * pairs->ids + i]);
    o.pairs = std::move(pairs);
    if (!fields)
      o.fieldTolerance = std::numeric_limits<double>::infinity();
    SteadyDiffusion solver = solverOf(image, diffusivity, o);
    SteadyResult result = solver.solve(answer.axis);
    RefinementStep step;
    step.value = valueOf(result, answer.axis);
    step.nodes = image.lattice.count();
    step.iterations = result.iterations;
    step.seconds = Communicator(comm_).max(result.setupSeconds + result.solveSeconds);
    step.every = every;
    answer.steps.push_back(step);
    if (fields)
    {
      answer.result = result;
      sink_(solver, answer, image.lattice, decompose(image.lattice, comm_));
    }
    return result;
  }

  double first_;
  double second_;
  const StudyOptions& options_;
  MPI_Comm comm_;
  const FieldSink& sink_;
};

} // namespace

std::vector<DiffusionAnswer> studyShares(const PhaseImage& image, std::span<const double> share, double first,
  double second, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
{
  ShareStudy study(first, second, options, comm, sink);
  std::vector<DiffusionAnswer> answers;
  for (const int axis : options.axes)
    answers.push_back(study.along(axis, image, share));
  return answers;
}

} // namespace lamella::lbm
