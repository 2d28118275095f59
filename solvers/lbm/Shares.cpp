#include "lbm/Shares.h"

#include "core/Error.h"
#include "lattice/LabelShares.h"
#include "lattice/SpacingError.h"
#include "lattice/SubWindows.h"
#include "lattice/Subsample.h"
#include "lbm/WindowAnswers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace lamella::lbm
{

namespace
{

constexpr double cornerPart = 1e-6; // of the phase that conducts, in a node that has none of it

} // namespace

AcrossSurface ruleFor(bool betterPercolates) noexcept
{
  return betterPercolates ? AcrossSurface::Parallel : AcrossSurface::Series;
}

PairTable shareLinks(std::span<const double> share, double first, double second, AcrossSurface rule, int corner)
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
  if (corner >= 0)
    table.link[static_cast<std::size_t>(corner) * (table.ids + 1)] = cornerPart * std::max(first, second);
  for (std::size_t i = 0; i < table.ids; ++i)
    if (!(table.link[i * table.ids + i] > 0))
      for (std::size_t j = 0; j < table.ids; ++j)
        table.link[i * table.ids + j] = table.link[j * table.ids + i] = 0;
  return table;
}

namespace
{

constexpr double relativeStep = 1e-5; // of a conductivity, for differences of what links conduct
constexpr std::int64_t fewestAcross = 3;
// Change of a rule that is taken instead of that of a phase that leads from face to face; the former where it does so
// by nodes that it fills.
constexpr double farLess = 0.25;
constexpr double someLess = 0.7;
constexpr double nearlyFull = 0.98;
// Of what labels of twice the spacing miss: held 58 of 60 (benchmark surface-shares, labels, seed 1), half of it 57.
constexpr double labelCertainty = 0.75;
constexpr double mostlyMixed = 0.3; // surfaces lie so close that coarser nodes hardly tell them apart

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
        half.phase.push_back(static_cast<std::uint8_t>(std::lround(weight * sum * (shareLevels - 1))));
      }
  return half;
}

struct Corners
{
  PhaseImage image;
  std::vector<double> share;
  int corner; // their id
};

// Nodes that hold nothing but the phase that insulates, and have nodes beside them that hold some of the other one:
// along two axes at least, and along none on both sides, or they would lead through a thin wall. They get an id of
// their own.
// @param insulating its share  @returns nothing where all ids are taken
std::optional<Corners> cornersOf(
  const PhaseImage& image, std::span<const double> share, double insulating, const std::array<bool, 3>& wraps)
{
  std::vector<std::uint8_t> full; // ids of such nodes
  for (std::size_t id = 0; id < share.size(); ++id)
    if (share[id] == insulating)
      full.push_back(static_cast<std::uint8_t>(id));
  if (full.empty() || (full.size() == 1 && share.size() > 255))
    return {};
  Corners found{ image, { share.begin(), share.end() }, 0 };
  found.corner = full.size() > 1 ? full.back() : static_cast<int>(share.size());
  if (full.size() == 1)
    found.share.push_back(insulating);
  const Lattice& lattice = image.lattice;
  const auto isFull = [&](const std::array<std::int64_t, 3>& p)
  { return share[image.phase[static_cast<std::size_t>(lattice.index(p[0], p[1], p[2]))]] == insulating; };
  std::size_t i = 0;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x, ++i)
      {
        const std::array<std::int64_t, 3> p{ x, y, z };
        if (!isFull(p))
          continue;
        int axes = 0;
        bool between = false;
        for (std::size_t a = 0; a < 3; ++a)
        {
          int sides = 0;
          for (const std::int64_t step : { -1, 1 })
          {
            auto q = p;
            q[a] += step;
            if (wraps[a])
              q[a] = (q[a] + lattice.size[a]) % lattice.size[a];
            sides += q[a] >= 0 && q[a] < lattice.size[a] && !isFull(q) ? 1 : 0;
          }
          axes += sides > 0 ? 1 : 0;
          between = between || sides == 2;
        }
        found.image.phase[i] = axes > 1 && !between ? static_cast<std::uint8_t>(found.corner) : full.front();
      }
  return found;
}

// All but the last nodes of odd sides.
Window evenPart(const Lattice& lattice)
{
  Window even;
  if (lattice.dimension == 2)
    even.start[1] = lattice.size[1] % 2; // from the top row, which is the last one
  for (std::size_t a = 0; a < 3; ++a)
    even.size[a] = std::max<std::int64_t>(1, lattice.size[a] / 2 * 2);
  return even;
}

std::array<bool, 3> wrapsOf(Sides sides, int axis)
{
  std::array<bool, 3> wraps{};
  for (int a = 0; a < 3; ++a)
    wraps[static_cast<std::size_t>(a)] = sides == Sides::Periodic || (sides == Sides::Mixed && a != axis);
  return wraps;
}

// Shares from labels, ids among evenShares().
PhaseImage smoothed(const PhaseImage& labels, std::uint8_t second, Sides sides, int axis, int threads)
{
  return { labels.lattice, labelShares(labels.lattice, labels.phase, second, wrapsOf(sides, axis), threads), {} };
}

class ShareStudy
{
public:
  struct Found
  {
    DiffusionAnswer answer;
    AcrossSurface rule = AcrossSurface::Series;
  };

  ShareStudy(double first, double second, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
    : first_(first)
    , second_(second)
    , options_(options)
    , comm_(comm)
    , sink_(sink)
  {
  }

  /// @param seen  what labels of twice the spacing, each from other nodes, make of the same; ids among evenShares()
  Found along(int axis, const PhaseImage& image, std::span<const double> share, std::span<const PhaseImage> seen = {})
  {
    Found found;
    DiffusionAnswer& answer = found.answer;
    answer.axis = axis;
    AcrossSurface& rule = found.rule;
    rule = ruleFor(betterPercolates(axis, image, share, 0.5));
    // What leads from face to face by nodes that it fills in part may do so nowhere in the material (grains that
    // touch): both rules are tried on coarser nodes, and the other one is taken if it changes less.
    const bool sure = rule == AcrossSurface::Series;
    const std::vector<double> shares = evenShares();
    std::optional<PhaseImage> half;
    std::optional<PhaseImage> quarter;
    if ((options_.estimateError || !sure) && canHalve(image.lattice, false))
      half = halved(image, share);
    if (half && canHalve(half->lattice, false))
      quarter = halved(*half, shares);
    const bool whole = half && canHalve(half->lattice, true);
    double doubt = 0;
    std::array<std::optional<double>, 2> coarse; // by rule
    std::array<std::optional<double>, 2> coarser;
    const auto at = [](AcrossSurface r) { return r == AcrossSurface::Series ? 0U : 1U; };
    const auto solveCoarse = [&](AcrossSurface r)
    {
      if (half && !coarse[at(r)])
        coarse[at(r)] = valueOf(solve(answer, *half, shares, r, 2, false), axis);
      if (quarter && !coarser[at(r)] && (whole || !sure))
        coarser[at(r)] = valueOf(solve(answer, *quarter, shares, r, 4, false), axis);
    };
    if (!sure && quarter)
    {
      std::array<double, 2> change{};
      for (const AcrossSurface r : { AcrossSurface::Series, AcrossSurface::Parallel })
        try
        {
          solveCoarse(r);
          change[at(r)] = std::abs(1 - *coarser[at(r)] / *coarse[at(r)]);
        }
        catch (const NoPathError&) // where one phase insulates
        {
          coarse[at(r)] = 0;
          change[at(r)] = std::numeric_limits<double>::infinity();
        }
      const double between = std::abs(*coarse[0] - *coarse[1]);
      const bool filled = betterPercolates(axis, image, share, nearlyFull);
      if (change[at(AcrossSurface::Series)] < (filled ? farLess : someLess) * change[at(AcrossSurface::Parallel)])
        rule = AcrossSurface::Series;
      if (rule == AcrossSurface::Series || !filled)
        doubt = 0.75 * between; // it halves with the spacing, about
      if (mixedPart(image.phase, share) > mostlyMixed)
        doubt = 1.5 * between;
    }
    const auto before = std::exchange(answer.steps, {});
    own_ = &image;
    answer.result = solve(answer, image, share, rule, 1, static_cast<bool>(sink_));
    answer.steps.insert(answer.steps.end(), before.begin(), before.end());
    if (!options_.estimateError || !half)
      return found; // or too few nodes to tell
    const double value = valueOf(answer.result, axis);
    double fine = value; // of what the coarse picture shows
    const Window even = evenPart(image.lattice);
    if (even.size != image.lattice.size)
      fine = valueOf(solve(answer, crop(image, even), share, rule, 1, false), axis);
    solveCoarse(rule);
    const SpacingError error = spacingError(fine, *coarse[at(rule)], whole ? coarser[at(rule)] : std::nullopt);
    answer.error.relative = std::max(error.bar, doubt) / fine + answer.result.solverError;
    answer.error.lattice = answer.error.relative;
    answer.error.picture = 0;
    const double mean = *coarse[at(rule)]; // of all labels; 0: nothing leads from face to face
    double squares = 0;
    for (const PhaseImage& labels : seen)
      squares += std::pow((valueOrNone(answer, labels, shares, rule, 2) - mean) / (mean > 0 ? mean : fine), 2);
    if (!seen.empty())
    {
      answer.error.picture = labelCertainty * std::sqrt(squares / static_cast<double>(seen.size()));
      answer.error.relative = answer.error.lattice + answer.error.picture;
    }
    answer.error.extrapolated = value / fine * error.extrapolated;
    return found;
  }

  /// Value of a part of the picture by itself, added to the step; 0 where nothing leads across.
  double part(
    int axis, const PhaseImage& image, std::span<const double> share, AcrossSurface rule, RefinementStep& step)
  {
    DiffusionAnswer answer;
    answer.axis = axis;
    const double value = valueOrNone(answer, image, share, rule, 1);
    for (const RefinementStep& solve : answer.steps)
    {
      step.iterations += solve.iterations;
      step.seconds += solve.seconds;
    }
    step.nodes += image.lattice.count();
    return value;
  }

  // Without a rest, or leaving the last nodes of odd sides out; half of them have to tell something.
  static bool canHalve(const Lattice& lattice, bool whole)
  {
    return std::ranges::all_of(
      lattice.size, [whole](std::int64_t n) { return n == 1 || (n / 2 >= fewestAcross && (!whole || n % 2 == 0)); });
  }

private:
  static double valueOf(const SteadyResult& result, int axis)
  {
    return result.effective[static_cast<std::size_t>(axis)];
  }

  // 0 where nothing leads from face to face.
  double valueOrNone(DiffusionAnswer& answer, const PhaseImage& image, std::span<const double> share,
    AcrossSurface rule, int every) const
  {
    try
    {
      return valueOf(solve(answer, image, share, rule, every, false), answer.axis);
    }
    catch (const NoPathError&)
    {
      return 0;
    }
  }

  // By nodes of which it has at least so much.
  bool betterPercolates(int axis, const PhaseImage& image, std::span<const double> share, double least) const
  {
    std::vector<double> open;
    for (const double s : share)
      open.push_back((second_ > first_ ? s : 1 - s) >= least ? 1 : 0);
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
    if (rule == AcrossSurface::Parallel && std::min(first_, second_) == 0)
      if (const auto found = cornersOf(image, share, first_ == 0 ? 0 : 1, wrapsOf(options_.steady.sides, answer.axis)))
        return solve(answer, found->image, found->share, rule, found->corner, every, fields, &image == own_);
    return solve(answer, image, share, rule, -1, every, fields, &image == own_);
  }

  SteadyResult solve(DiffusionAnswer& answer, const PhaseImage& image, std::span<const double> share,
    AcrossSurface rule, int corner, int every, bool fields, bool own) const
  {
    SteadyOptions o = options_.steady;
    auto pairs = std::make_shared<PairTable>(shareLinks(share, first_, second_, rule, corner));
    std::vector<double> diffusivity;
    for (std::size_t i = 0; i < pairs->ids; ++i)
      diffusivity.push_back(pairs->link[i * pairs->ids + i]);
    o.pairs = std::move(pairs);
    if (!fields)
      o.fieldTolerance = std::numeric_limits<double>::infinity();
    SteadyDiffusion solver = solverOf(image, diffusivity, o);
    SteadyResult result = solver.solve(answer.axis);
    if (every == 1 && options_.derivatives && own)
      answer.derivatives = derivatives(solver, share, rule, corner);
    if (every == 1 && options_.surfaces && own)
      answer.surfaces = surfaces(solver, image, share, rule, corner);
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

  // By the links' own change with either conductivity.
  [[nodiscard]] ConductivityDerivatives derivatives(
    const SteadyDiffusion& solver, std::span<const double> share, AcrossSurface rule, int corner) const
  {
    const std::vector<double> energy = solver.pairDerivatives();
    ConductivityDerivatives d;
    for (const bool second : { false, true })
    {
      const double k = second ? second_ : first_;
      d.along.push_back(k > 0 ? 0.0 : std::numeric_limits<double>::quiet_NaN());
      const double step = relativeStep * k;
      const auto linksAt = [&](double value)
      { return shareLinks(share, second ? first_ : value, second ? value : second_, rule, corner).link; };
      if (!(k > 0))
        continue;
      const std::vector<double> more = linksAt(k + step);
      const std::vector<double> less = linksAt(k - step);
      for (std::size_t a = 0; a < share.size(); ++a)
        for (std::size_t b = a; b < share.size(); ++b)
          if (const std::size_t i = a * share.size() + b; energy[i] > 0)
            d.along.back() += energy[i] * (more[i] - less[i]) / (step * (more[i] + less[i]));
    }
    return d;
  }

  // The first phase grows by as much of every node that holds some of both as makes a shift of the surface by one
  // spacing, whose area is the sum of the shares' gradients; by the links' own change.
  [[nodiscard]] SurfaceDerivatives surfaces(const SteadyDiffusion& solver, const PhaseImage& image,
    std::span<const double> share, AcrossSurface rule, int corner) const
  {
    const auto mixed = [&](std::size_t id) { return share[id] > 0 && share[id] < 1; };
    const auto nodes = static_cast<double>(image.phase.size());
    double partly = 0;
    for (const std::uint8_t id : image.phase)
      partly += mixed(id) ? 1 : 0;
    SurfaceDerivatives d{ std::vector<double>(4, 0.0), std::vector<double>(4, 0.0) };
    d.area[1] = surfaceArea(image, share);
    if (!(partly > 0))
      return d;
    const double part = d.area[1] * nodes / partly; // of a node's share, per spacing
    const auto linksAt = [&](double change)
    {
      std::vector<double> changed(share.begin(), share.end());
      for (std::size_t id = 0; id < share.size(); ++id)
        if (mixed(id))
          changed[id] = std::clamp(share[id] - change, 0.0, 1.0);
      return shareLinks(changed, first_, second_, rule, corner).link;
    };
    const std::vector<double> energy = solver.pairDerivatives();
    const std::vector<double> more = linksAt(shareStep);
    const std::vector<double> less = linksAt(-shareStep);
    for (std::size_t a = 0; a < share.size(); ++a)
      for (std::size_t b = a; b < share.size(); ++b)
        if (const std::size_t i = a * share.size() + b; energy[i] > 0 && more[i] + less[i] > 0)
          d.shift[1] += energy[i] * (more[i] - less[i]) / (shareStep * (more[i] + less[i])) * part;
    return d;
  }

  // Per node: the mean length of the shares' gradient.
  [[nodiscard]] static double surfaceArea(const PhaseImage& image, std::span<const double> share)
  {
    const Lattice& lattice = image.lattice;
    const auto& size = lattice.size;
    double sum = 0;
    for (std::int64_t z = 0; z < size[2]; ++z)
      for (std::int64_t y = 0; y < size[1]; ++y)
        for (std::int64_t x = 0; x < size[0]; ++x)
        {
          const std::array<std::int64_t, 3> at{ x, y, z };
          double square = 0;
          for (std::size_t a = 0; a < 3; ++a)
          {
            auto low = at;
            auto high = at;
            low[a] = std::max<std::int64_t>(at[a] - 1, 0);
            high[a] = std::min(at[a] + 1, size[a] - 1);
            if (high[a] == low[a])
              continue;
            const auto of = [&](const auto& p) { return share[image.phase[lattice.index(p[0], p[1], p[2])]]; };
            const double slope = (of(high) - of(low)) / (static_cast<double>(high[a] - low[a]) * lattice.aspect[a]);
            square += slope * slope;
          }
          sum += std::sqrt(square);
        }
    return sum / static_cast<double>(lattice.count());
  }

  static constexpr double shareStep = 1e-3;

  double first_;
  double second_;
  const PhaseImage* own_ = nullptr; ///< the picture itself
  const StudyOptions& options_;
  MPI_Comm comm_;
  const FieldSink& sink_;
};

/// A direction with the picture that was solved along it.
struct Solved
{
  AcrossSurface rule = AcrossSurface::Series;
  std::shared_ptr<const PhaseImage> image;
};

/// The windows of the pictures, by the picture's own rules, with insulated sides. @param solved by answer
void addWindows(std::vector<DiffusionAnswer>& answers, std::span<const Solved> solved, std::span<const double> share,
  double first, double second, const StudyOptions& options, MPI_Comm comm)
{
  StudyOptions own;
  own.steady = options.steady;
  own.steady.sides = Sides::Insulated;
  own.steady.tolerance = std::max(own.steady.tolerance, windowTolerance);
  own.steady.rough = true;
  own.steady.method = Method::Auto; // what suits the picture need not suit a part of it
  const FieldSink none;
  ShareStudy study(first, second, own, comm, none);
  addWindowErrors(answers, solved.front().image->lattice, options,
    [&](const SubWindow& window, std::span<RefinementStep> steps)
    {
      std::vector<double> values;
      PhaseImage part;
      const PhaseImage* of = nullptr; // of the part
      for (std::size_t i = 0; i < solved.size(); ++i)
      {
        if (solved[i].image.get() != of)
          part = cut(*(of = solved[i].image.get()), window);
        values.push_back(study.part(answers[i].axis, part, share, solved[i].rule, steps[i]));
      }
      return values;
    });
}

} // namespace

std::vector<DiffusionAnswer> studyShares(const PhaseImage& image, std::span<const double> share, double first,
  double second, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
{
  ShareStudy study(first, second, options, comm, sink);
  std::vector<DiffusionAnswer> answers;
  std::vector<Solved> solved;
  for (const int axis : options.axes)
  {
    ShareStudy::Found found = study.along(axis, image, share);
    answers.push_back(std::move(found.answer));
    solved.push_back({ found.rule, { std::shared_ptr<void>(), &image } });
  }
  if (options.windowError)
    addWindows(answers, solved, share, first, second, options, comm);
  return answers;
}

LabelAnswers studyLabels(const PhaseImage& labels, std::uint8_t second, const std::array<double, 2>& conductivity,
  const StudyOptions& options, MPI_Comm comm, const FieldSink& sink)
{
  ShareStudy study(conductivity[0], conductivity[1], options, comm, sink);
  const std::vector<double> share = evenShares();
  const Sides sides = options.steady.sides;
  LabelAnswers found;
  std::shared_ptr<const PhaseImage> image;
  std::vector<PhaseImage> seen;
  std::vector<Solved> solved;
  for (const int axis : options.axes)
  {
    if (!image || sides == Sides::Mixed) // which goes on elsewhere along each axis
    {
      image = std::make_shared<PhaseImage>(smoothed(labels, second, sides, axis, options.steady.threads));
      seen.clear();
      if (options.estimateError && ShareStudy::canHalve(labels.lattice, false))
      {
        const PhaseImage even = crop(labels, evenPart(labels.lattice));
        for (const std::int64_t first : { 0, 1 })
        {
          std::array<std::int64_t, 3> start{};
          for (std::size_t a = 0; a < 3; ++a)
            start[a] = even.lattice.size[a] > 1 ? first : 0;
          seen.push_back(smoothed(subsample(even, start, 2), second, sides, axis, options.steady.threads));
        }
      }
    }
    ShareStudy::Found along = study.along(axis, *image, share, seen);
    found.answers.push_back(std::move(along.answer));
    if (options.windowError)
      solved.push_back({ along.rule, image });
    if (found.answers.size() == 1)
    {
      std::int64_t sum = 0;
      for (const std::uint8_t id : image->phase)
        sum += id;
      found.second = static_cast<double>(sum) / ((shareLevels - 1) * static_cast<double>(image->phase.size()));
    }
  }
  if (options.windowError)
    addWindows(found.answers, solved, share, conductivity[0], conductivity[1], options, comm);
  return found;
}

} // namespace lamella::lbm
