#include "mpm/FusedStep.h"

#include "core/Error.h"
#include "mpm/GridWalls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace lamella::mpm
{
namespace
{

constexpr int tileRows = 8; // more than twice what a stray may be off, and the three rows of a spline
constexpr std::size_t worthThreads = 2000;
/// Strays since points were sorted last, one counted again in every step, over the points: when they are sorted again,
/// so that they have cost about what that does, however fast they come. Estimates from the times of runs.
template <int Dim>
constexpr double sortAt = Dim == 3 ? 0.1 : 0.2;
constexpr std::int64_t cellsAtOnce = 256; // whose points' C is found together
constexpr std::size_t clearedAtOnce = 4096;

/// From node 0, or from the last one inwards, to where a point counts as outside [spacings]: open ends with two cells
/// of room, cuts half a cell beyond this rank's rows; elsewhere a quarter of a cell beyond the last nodes, where
/// splines still reach no node too far.
double roomAt(const GridAxis& g, int side)
{
  return g.end(side) != Edge::Open ? -0.25 : g.isCut(side) ? 0 : 2;
}

/// How the rows of a grid's cells are shared out.
struct Tiles
{
  std::int64_t rows;   ///< of a tile
  std::int64_t along;  ///< side by side along y
  std::int64_t layers; ///< one after the other along z
  [[nodiscard]] std::int64_t count() const { return along * layers; }
};

template <int Dim>
Tiles tilesOf(const BackgroundGrid<Dim>& grid)
{
  const auto across = [&](int a) { return std::int64_t{ grid.axis(a).cells } / tileRows + 1; }; // of cells + 1 bases
  if constexpr (Dim == 2)
    return { tileRows, across(1), 1 };
  else
    return { std::int64_t{ tileRows } * tileRows, across(1), across(2) };
}

} // namespace

template <int Dim>
FusedStep<Dim>::FusedStep(
  MaterialPoints<Dim>& points, const PointLaw<Dim>& law, const Bodies& bodies, const Vector<Dim>& gravity, bool single)
  : points_(points)
  , kind_(law.kind())
  , bodies_(bodies)
  , gravity_(gravity)
  , single_(single)
{
  for (std::size_t phase = 0; phase < law.phases(); ++phase)
    constants_.insert(constants_.end(), law.constants(phase), law.constants(phase) + law.constantsCount());
  onePhase_ = law.phases() == 1;
}

template <int Dim>
Matrix<Dim> FusedStep<Dim>::affine(std::size_t p) const
{
  using Points = MaterialPoints<Dim>;
  if (!past_.known())
    return points_.affine(p);
  if (!aside_.empty())
  {
    const auto aside = std::lower_bound(aside_.begin(), aside_.end(), points_.id()[p],
      [](const auto& entry, std::uint32_t number) { return entry.first < number; });
    if (aside != aside_.end() && aside->first == points_.id()[p])
      return aside->second;
  }
  const std::size_t each = next_.size() / static_cast<std::size_t>(bodies_.count);
  return past_.affine(points_.vector(Points::positions, p), points_.vector(Points::velocities, p),
    next_.data() + bodies_.of(points_.phase()[p]) * each);
}

template <int Dim>
double FusedStep<Dim>::fastest() const
{
  if (fastest_ >= 0)
    return fastest_;
  double worst = 0;
#pragma omp parallel for schedule(static) reduction(max : worst) if (points_.count() > worthThreads)
  for (std::size_t p = 0; p < points_.count(); ++p)
    for (const double c : affine(p).m)
      worst = std::max(worst, std::fabs(c));
  return worst;
}

template <int Dim>
void FusedStep<Dim>::storeAffines()
{
  if (!past_.known())
    return;
  points_.storeAffines();
#pragma omp parallel for schedule(static) if (points_.count() > worthThreads)
  for (std::size_t p = 0; p < points_.count(); ++p)
    points_.setMatrix(points_.affines(), p, affine(p));
  past_.forget();
  aside_.clear();
}

template <int Dim>
void FusedStep<Dim>::setAside(std::span<const std::size_t> points)
{
  if (!past_.known())
    return;
  auto all = aside_; // what was set aside stays as it is
  for (const std::size_t p : points)
    all.emplace_back(points_.id()[p], affine(p));
  std::sort(
    all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  all.erase(
    std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; }), all.end());
  aside_.swap(all);
}

template <int Dim>
void FusedStep<Dim>::change(double keep, int axis, double rate, double still)
{
  if (past_.known())
    past_.change(keep, axis, rate, still, next_);
  else
    points_.changeAffines(keep, axis, rate);
  for (auto& entry : aside_)
  {
    for (double& c : entry.second.m)
      c *= keep;
    entry.second(axis, axis) += rate;
  }
  fastest_ = -1;
  if (!held_)
    return;
  // what points give of a velocity that is linear in space is, with its C, mass times that velocity at the node
  const GridAxis& g = grid_.axis(axis);
  const auto count = static_cast<std::int64_t>(nodes_.size()) / nodeValues;
  for (std::int64_t i = 0; i < count; ++i)
  {
    double* const node = &nodes_[static_cast<std::size_t>(i * nodeValues)];
    for (int a = 0; a < Dim; ++a)
      node[1 + a] *= keep;
    const std::int64_t at = i % grid_.count() / grid_.stride(axis) % grid_.nodes(axis) - 1;
    node[1 + axis] += node[0] * rate * (g.lower + g.spacing * static_cast<double>(at) - still);
  }
  kick_ *= keep;
}

template <int Dim>
void FusedStep<Dim>::throwOutside(const BackgroundGrid<Dim>& grid, std::size_t p) const
{
  for (int a = 0; a < Dim; ++a)
  {
    const GridAxis& g = grid.axis(a);
    const double x = points_.column(a)[p];
    if (!(std::floor(g.coordinate(x) - 0.5) >= -1 && g.coordinate(x) - 0.5 < g.cells))
      throw DivergenceError(fmt::format("a point at {} m along axis {} is outside the grid, which goes from {} to {} m",
                              x, a, g.lower, g.upper()),
        "take a smaller step or slower walls");
  }
}

template <int Dim>
void FusedStep<Dim>::sort(const BackgroundGrid<Dim>& grid)
{
  const std::size_t count = points_.count();
  std::array<std::int64_t, 3> bases{ 1, 1, 1 }; // cells along each axis, by their first node
  for (int a = 0; a < Dim; ++a)
    bases[static_cast<std::size_t>(a)] = grid.axis(a).cells + 1;
  std::vector<std::uint32_t> cellOf(count);
  const Tiles tiles = tilesOf(grid);
  const std::int64_t perTile = tiles.rows * bases[0];
  const std::int64_t each = tiles.count() * perTile; // cells of a body, tile by tile, whose last may be beyond the grid
  std::vector<std::uint32_t> first(static_cast<std::size_t>(bodies_.count * each) + 1);
  std::size_t outside = count; // the first one outside the grid
#pragma omp parallel for schedule(static) reduction(min : outside) if (count > worthThreads)
  for (std::size_t p = 0; p < count; ++p)
  {
    std::array<std::int64_t, 3> at{};
    for (int a = 0; a < Dim; ++a)
    {
      const auto axis = static_cast<std::size_t>(a);
      const double base = std::floor(grid.axis(a).coordinate(points_.column(a)[p]) - 0.5) + 1;
      if (base >= 0 && base < static_cast<double>(bases[axis]))
        at[axis] = static_cast<std::int64_t>(base);
      else
        outside = std::min(outside, p);
    }
    const auto body = static_cast<std::int64_t>(bodies_.of(points_.phase()[p]));
    const std::int64_t tile = at[2] / tileRows * tiles.along + at[1] / tileRows;
    const std::int64_t row = at[2] % tileRows * tileRows + at[1] % tileRows;
    cellOf[p] = static_cast<std::uint32_t>(body * each + tile * perTile + row * bases[0] + at[0]);
  }
  if (outside < count)
    throwOutside(grid, outside);
  for (const std::uint32_t cell : cellOf)
    ++first[cell + 1U];
  cells_.clear();
  tiles_.assign(1, 0);
  for (std::size_t c = 0; c + 1 < first.size(); ++c)
  {
    const auto number = static_cast<std::int64_t>(c);
    if (c > 0 && number % perTile == 0)
      tiles_.push_back(static_cast<std::int64_t>(cells_.size()));
    const std::uint32_t inside = first[c + 1];
    first[c + 1] += first[c];
    if (inside == 0)
      continue;
    const std::int64_t tile = number % each / perTile;
    const std::int64_t row = number % perTile / bases[0];
    const std::array<std::int64_t, 3> at{ number % bases[0], tile % tiles.along * tileRows + row % tileRows,
      tile / tiles.along * tileRows + row / tileRows };
    PointCell cell{ {}, first[c] };
    for (int a = 0; a < Dim; ++a)
      cell.base[a] = static_cast<std::int32_t>(at[static_cast<std::size_t>(a)]) - 1;
    cells_.push_back(cell);
  }
  tiles_.push_back(static_cast<std::int64_t>(cells_.size()));
  cells_.push_back({ {}, static_cast<std::uint32_t>(count) });

  std::vector<std::uint32_t> order(count);
  for (std::size_t p = 0; p < count; ++p)
    order[first[cellOf[p]]++] = static_cast<std::uint32_t>(p);
  points_.reorder(order);
  strays_ = 0;
  if (single_)
    pack(grid);
}

template <int Dim>
void FusedStep<Dim>::pack(const BackgroundGrid<Dim>& grid)
{
  using Points = MaterialPoints<Dim>;
  using State = StateColumns<Dim>;
  const std::size_t pitch = points_.pitch();
  state_.resize(pitch * static_cast<std::size_t>(State::count));
  const auto masses = points_.column(Points::masses);
  massScale_ = masses.empty() ? 1 : *std::max_element(masses.begin(), masses.end());
  const auto fill = [&](int to, int from, auto&& of)
  {
    const auto values = points_.column(from);
    float* state = state_.data() + static_cast<std::size_t>(to) * pitch;
    for (std::size_t p = 0; p < values.size(); ++p)
      state[p] = static_cast<float>(of(values[p]));
  };
  for (int i = 0; i < Dim * Dim; ++i)
    fill(
      State::deformations + i, Points::deformations + i,
      [one = i % (Dim + 1) == 0 ? 1 : 0](double F) { return F - one; });
  fill(
    State::masses, Points::masses, [this](double m) { return m / massScale_; });
  fill(State::volumes, Points::volumes, [this](double v) { return v / massScale_; });
  for (int a = 0; a < Dim; ++a)
  {
    fill(State::axes + a, Points::axes + a, [](double n) { return n; });
    const auto x = points_.column(a);
    float* state = state_.data() + static_cast<std::size_t>(State::positions + a) * pitch;
    for (std::size_t c = 0; c + 1 < cells_.size(); ++c)
      for (std::size_t p = cells_[c].begin; p < cells_[c + 1].begin; ++p)
        state[p] = static_cast<float>(grid.axis(a).coordinate(x[p]) - (cells_[c].base[a] + 1));
  }
}

template <int Dim>
void FusedStep<Dim>::unpack(const BackgroundGrid<Dim>& grid)
{
  using Points = MaterialPoints<Dim>;
  using State = StateColumns<Dim>;
  const std::size_t pitch = points_.pitch();
  for (int i = 0; i < Dim * Dim; ++i)
  {
    const auto F = points_.column(Points::deformations + i);
    const float* state = state_.data() + static_cast<std::size_t>(State::deformations + i) * pitch;
    for (std::size_t p = 0; p < F.size(); ++p)
      F[p] = static_cast<double>(state[p]) + (i % (Dim + 1) == 0 ? 1 : 0);
  }
  for (int a = 0; a < Dim; ++a)
  {
    const GridAxis& g = grid.axis(a);
    const auto x = points_.column(a);
    const float* state = state_.data() + static_cast<std::size_t>(State::positions + a) * pitch;
    for (std::size_t c = 0; c + 1 < cells_.size(); ++c)
      for (std::size_t p = cells_[c].begin; p < cells_[c + 1].begin; ++p)
        x[p] = g.lower + g.spacing * (cells_[c].base[a] + 1 + static_cast<double>(state[p]));
  }
}

template <int Dim>
PointSweep FusedStep<Dim>::jobOf(const BackgroundGrid<Dim>& from, const BackgroundGrid<Dim>& to, double dt, double kick)
{
  PointSweep job{};
  job.columns = points_.column(0).data();
  job.pitch = static_cast<std::int64_t>(points_.pitch());
  job.state = state_.data();
  job.statePitch = job.pitch;
  job.massScale = massScale_;
  job.phase = points_.phase().data();
  job.cells = cells_.data();
  for (int a = 0; a < Dim; ++a)
  {
    const GridAxis& g = to.axis(a);
    SweepAxis& axis = job.axis[a];
    axis.lower[0] = from.axis(a).lower;
    axis.lower[1] = g.lower;
    axis.spacing[0] = from.axis(a).spacing;
    axis.spacing[1] = g.spacing;
    axis.least = roomAt(g, 0);
    axis.most = g.cells - roomAt(g, 1);
    axis.end = g.cells + 0.5;
    axis.stride = to.stride(a);
    job.gravity[a] = gravity_[a];
  }
  job.velocity = nodes_.data();
  job.momentum = nodes_.data();
  job.dt = dt;
  job.kick = kick;
  job.constants = constants_.data();
  job.onePhase = onePhase_;
  return job;
}

template <int Dim>
void FusedStep<Dim>::giveCells(SweepCells kernel, PointSweep& job, std::int64_t first, std::int64_t last) const
{
  if (job.forcesOnly)
  {
    kernel(job, first, last);
    return;
  }
  std::vector<double> affines;
  for (std::int64_t begin = first; begin < last; begin += cellsAtOnce)
  {
    const std::int64_t end = std::min(begin + cellsAtOnce, last);
    const std::size_t from = cells_[static_cast<std::size_t>(begin)].begin;
    const std::size_t count = cells_[static_cast<std::size_t>(end)].begin - from;
    const std::size_t pitch = count + MaterialPoints<Dim>::padding;
    affines.resize(pitch * Dim * Dim);
    for (std::size_t p = 0; p < count; ++p)
    {
      const Matrix<Dim> c = affine(from + p);
      for (std::size_t i = 0; i < Dim * Dim; ++i)
        affines[i * pitch + p] = c.m[i];
    }
    job.affines = affines.data();
    job.affinesPitch = static_cast<std::int64_t>(pitch);
    job.affinesFirst = static_cast<std::int64_t>(from);
    kernel(job, begin, end);
  }
}

template <int Dim>
void FusedStep<Dim>::sweep(const PointSweep& job, const BackgroundGrid<Dim>& to, bool whole)
{
  const SweepCells kernel = pointKernels().sweep[single_ ? 1 : 0][Dim - 2][static_cast<int>(kind_)][whole ? 1 : 0];
  const std::size_t tiles = tiles_.size() - 1;
  const std::int64_t along = tilesOf(to).along;
  const std::size_t each = tiles / static_cast<std::size_t>(bodies_.count);
  std::array<std::vector<std::size_t>, 4> byColour; // those with points
  for (std::size_t t = 0; t < tiles; ++t)
    if (tiles_[t] < tiles_[t + 1])
    {
      const auto in = static_cast<std::int64_t>(t % each);
      byColour[static_cast<std::size_t>(in / along % 2 * 2 + in % along % 2)].push_back(t);
    }
  std::vector<PointSweep> sweeps(tiles, job);
  const bool worthIt = points_.count() > worthThreads;
  for (const std::vector<std::size_t>& turn : byColour)
#pragma omp parallel for schedule(dynamic, 1) if (worthIt)
    for (std::size_t i = 0; i < turn.size(); ++i)
    {
      const std::size_t t = turn[i];
      PointSweep& mine = sweeps[t];
      const std::int64_t offset = static_cast<std::int64_t>(t / each) * to.count() * nodeValues;
      mine.velocity += offset;
      mine.momentum += offset;
      if (whole)
        kernel(mine, tiles_[t], tiles_[t + 1]);
      else
        giveCells(kernel, mine, tiles_[t], tiles_[t + 1]);
    }
  seen_ = {};
  looked_ = {};
  double fastest = 0;
  for (const PointSweep& s : sweeps)
  {
    seen_.strays += s.strays;
    seen_.far = seen_.far || s.far;
    seen_.outside = seen_.outside || s.outside;
    fastest = std::max(fastest, s.fastest);
    looked_.kinetic += s.kinetic;
    looked_.elastic += s.elastic;
    looked_.stiffest = std::max(looked_.stiffest, s.stiffest);
  }
  if (whole)
    fastest_ = job.keep ? fastest : -1;
}

template <int Dim>
void FusedStep<Dim>::settle(const BackgroundGrid<Dim>& to, double kick, bool whole, bool keep)
{
  leaving_ = false;
  lost_ = false;
  bool outside = seen_.outside;
  strays_ += seen_.strays;
  const bool astray = seen_.far || static_cast<double>(strays_) > sortAt<Dim> * static_cast<double>(points_.count());
  if (single_ && whole && (keep || outside || astray))
    unpack(to);
  bool cut = false;
  for (int a = 0; a < Dim; ++a)
    cut = cut || to.axis(a).isCut(0) || to.axis(a).isCut(1);
  if (outside && cut)
    outside = beyondEnds(to, keep);
  grid_ = to;
  kick_ = kick;
  held_ = !outside; // else to be wrapped, or given to a larger grid
  if (!outside && !lost_ && astray)
    sort(to);
}

template <int Dim>
bool FusedStep<Dim>::beyondEnds(const BackgroundGrid<Dim>& grid, bool kept)
{
  bool ends = false;
  bool across = false;
  bool lost = false;
  for (int a = 0; a < Dim; ++a)
  {
    const GridAxis& g = grid.axis(a);
    for (const double x : points_.column(a))
    {
      const double at = g.coordinate(x);
      lost = lost || !(at >= -0.5 && at < g.cells + 0.5);
      for (const int side : { 0, 1 })
        if ((side == 0 ? at : g.cells - at) < roomAt(g, side))
          (g.isCut(side) && g.end(side) == Edge::Open ? across : ends) = true;
    }
  }
  lost_ = lost && !kept;
  ends = ends || lost;
  leaving_ = across && !ends;
  return ends && !lost_;
}

template <int Dim>
void FusedStep<Dim>::prepare(const BackgroundGrid<Dim>& grid, double kick)
{
  sort(grid);
  nodes_.assign(static_cast<std::size_t>(bodies_.count * grid.count()) * nodeValues, 0);
  sweep(jobOf(grid, grid, 0, kick), grid, false);
  settle(grid, kick, false, false);
}

template <int Dim>
void FusedStep<Dim>::adjust(double kick)
{
  if (std::fabs(kick - kick_) <= 1e-12 * kick)
    return;
  PointSweep job = jobOf(grid_, grid_, 0, kick - kick_);
  job.forcesOnly = true;
  sweep(job, grid_, false);
  kick_ = kick;
}

template <int Dim>
bool FusedStep<Dim>::run(
  const BackgroundGrid<Dim>& from, const BackgroundGrid<Dim>& to, double dt, double kick, bool keep, Look look)
{
  points_.setAffines({}); // from here on the nodes' velocities tell it
  aside_.clear();
  next_.resize(nodes_.size());
  // as blocks of bytes: a loop over numbers is not vectorised here, and a twentieth of a sparse plane's time
  const auto blocks = static_cast<std::int64_t>((next_.size() + clearedAtOnce - 1) / clearedAtOnce);
#pragma omp parallel for schedule(static) if (points_.count() > worthThreads)
  for (std::int64_t b = 0; b < blocks; ++b)
  {
    const std::size_t first = static_cast<std::size_t>(b) * clearedAtOnce;
    std::memset(next_.data() + first, 0, std::min(clearedAtOnce, next_.size() - first) * sizeof(double));
  }
  PointSweep job = jobOf(from, to, dt, kick);
  job.keep = keep;
  job.look = look != Look::No && !single_; // whose sums are too coarse
  job.sums = look == Look::Sums;
  job.momentum = next_.data();
  sweep(job, to, true);
  nodes_.swap(next_);
  past_.set(from, dt);
  settle(to, kick, true, keep);
  return job.look;
}

template <int Dim>
void FusedStep<Dim>::startAnew() noexcept
{
  forget();
  past_.forget();
  aside_.clear();
  fastest_ = -1;
}

template <int Dim>
void FusedStep<Dim>::keep(io::Checkpoint& checkpoint) const
{
  if (!held_)
    return;
  std::vector<std::int64_t> cells;
  for (const PointCell& cell : cells_)
  {
    cells.insert(cells.end(), std::begin(cell.base), std::begin(cell.base) + Dim);
    cells.push_back(cell.begin);
  }
  checkpoint.arrays["point cells"] = { { static_cast<std::int64_t>(cells_.size()), Dim + 1 }, std::move(cells), "",
    "first node of each cell along each axis, and its first point; one more behind the last" };
  checkpoint.arrays["stripes"] = { { static_cast<std::int64_t>(tiles_.size()) }, tiles_, "",
    "first cell of each tile of rows" };
  checkpoint.arrays["nodes"] = { { static_cast<std::int64_t>(nodes_.size()) / nodeValues, nodeValues }, nodes_, "SI",
    "mass and momentum of each node, as the points gave them" };
  checkpoint.numbers["kick"] = kick_;
  checkpoint.numbers["strays"] = static_cast<double>(strays_);
  if (!past_.known())
    return;
  checkpoint.arrays["past nodes"] = { { static_cast<std::int64_t>(next_.size()) / nodeValues, nodeValues }, next_, "SI",
    "nothing and the velocity of each node, which moved the points last" };
  checkpoint.arrays["past grid"] = { { static_cast<std::int64_t>(past_.numbers().size()) }, past_.numbers(), "SI",
    "of each axis lower end, spacing, cells, and rate and offset of what velocities were given since; then the step" };
}

template <int Dim>
void FusedStep<Dim>::takeBack(const io::Checkpoint& checkpoint, const BackgroundGrid<Dim>& grid)
{
  startAnew();
  if (single_ || !checkpoint.arrays.contains("nodes"))
    return;
  const std::vector<std::int64_t>& cells = checkpoint.integers("point cells");
  const std::vector<std::int64_t>& tiles = checkpoint.integers("stripes");
  const std::vector<double>& nodes = checkpoint.reals("nodes");
  const auto count = static_cast<std::int64_t>(cells.size()) / (Dim + 1) - 1; // of cells
  bool fits = count >= 1 && static_cast<std::int64_t>(nodes.size()) == bodies_.count * grid.count() * nodeValues &&
    tiles.size() >= 2 && tiles.front() == 0 && tiles.back() == count && std::is_sorted(tiles.begin(), tiles.end()) &&
    cells[Dim] == 0 && cells.back() == static_cast<std::int64_t>(points_.count());
  for (std::int64_t c = 0; fits && c < count; ++c)
  {
    const std::int64_t* cell = &cells[static_cast<std::size_t>(c * (Dim + 1))];
    fits = cell[Dim] < cell[2 * Dim + 1];
    for (int a = 0; a < Dim; ++a)
      fits = fits && cell[a] >= -1 && cell[a] < grid.axis(a).cells;
  }
  if (!fits)
    throw InputError("the checkpoint's cells are not those of its points", "start the run anew");
  cells_.assign(static_cast<std::size_t>(count) + 1, {});
  for (std::size_t c = 0; c < cells_.size(); ++c)
  {
    const std::int64_t* cell = &cells[c * (Dim + 1)];
    for (int a = 0; a < Dim; ++a)
      cells_[c].base[a] = static_cast<std::int32_t>(cell[a]);
    cells_[c].begin = static_cast<std::uint32_t>(cell[Dim]);
  }
  tiles_ = tiles;
  nodes_ = nodes;
  kick_ = checkpoint.number("kick");
  strays_ = checkpoint.numbers.contains("strays") ? checkpoint.count("strays") : 0;
  grid_ = grid;
  held_ = true;
  const auto expected = static_cast<std::size_t>(bodies_.count * tilesOf(grid).count()) + 1;
  const bool laid = tiles.size() == expected;    // earlier versions had tiles as wide as the grid
  if (!checkpoint.arrays.contains("past nodes")) // or none of these: the points have C
  {
    if (!laid)
      sort(grid);
    return;
  }
  const std::vector<double>& past = checkpoint.reals("past nodes");
  checkpoint.expectFinite("past nodes");
  checkpoint.expectFinite("past grid");
  const auto each = static_cast<std::int64_t>(past.size()) / (bodies_.count * nodeValues);
  if (static_cast<std::int64_t>(past.size()) != each * bodies_.count * nodeValues ||
    !past_.take(checkpoint.reals("past grid"), each))
    throw InputError("the checkpoint's velocities are not those of its grid", "start the run anew");
  next_ = past;
  points_.setAffines({});
  if (!laid)
    sort(grid);
}

template class FusedStep<2>;
template class FusedStep<3>;

} // namespace lamella::mpm
