// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines. Laws are instantiated
// with the lanes of this file only, or the linker could take another file's code for them.
#include "mpm/kernels/PointKernels.h"

#include "mpm/Hencky.h"
#include "mpm/Hill.h"
#include "mpm/Isotropic.h"
#include "mpm/NeoHookean.h"
#include "mpm/Orthotropic.h"
#include "mpm/kernels/CellPlanes.h"

namespace lamella::mpm
{
namespace
{

/// First columns of MaterialPoints.
template <int Dim>
struct Columns
{
  static constexpr int positions = 0;
  static constexpr int velocities = Dim;
  static constexpr int deformations = 2 * Dim;
  static constexpr int masses = deformations + Dim * Dim;
  static constexpr int volumes = masses + 1;
  static constexpr int axes = masses + 2;
  static constexpr int histories = axes + Dim;
};

/// Of a point's state, by precision.
template <int Dim, class T>
struct State : Columns<Dim>
{
};
template <int Dim>
struct State<Dim, float> : StateColumns<Dim>
{
};

/// A point outside its cell: from the nodes that it reaches, each of its own.
template <int Dim>
struct Stray
{
  std::int64_t node; ///< first
  double value[3][3];
  double gradient[3][3];
  double offset[3][3];

  Stray(const PointSweep& s, const double* coordinate)
  {
    node = 0;
    for (int a = 0; a < Dim; ++a)
    {
      const double base = __builtin_floor(coordinate[a] - 0.5);
      const double f = coordinate[a] - base;
      node += (static_cast<std::int64_t>(base) + 1) * s.axis[a].stride;
      value[a][0] = 0.5 * (1.5 - f) * (1.5 - f);
      value[a][1] = 0.75 - (f - 1) * (f - 1);
      value[a][2] = 0.5 * (f - 0.5) * (f - 0.5);
      gradient[a][0] = f - 1.5;
      gradient[a][1] = 2 - 2 * f;
      gradient[a][2] = f - 0.5;
      for (int i = 0; i < 3; ++i)
        offset[a][i] = i - f;
    }
  }
  /// f(values of the node, N, ∇N × spacing, offset in spacings)
  template <class F>
  void forEach(const PointSweep& s, F&& f) const
  {
    constexpr int z = Dim - 1; // where space ends
    for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k)
      for (int j = 0; j < 3; ++j)
      {
        const double across = Dim == 3 ? value[1][j] * value[z][k] : value[1][j];
        const double alongY = Dim == 3 ? gradient[1][j] * value[z][k] : gradient[1][j];
        const double alongZ = value[1][j] * gradient[z][k];
        const std::int64_t at = node + j * s.axis[1].stride + (Dim == 3 ? k * s.axis[z].stride : 0);
        for (int i = 0; i < 3; ++i)
        {
          double g[3] = { gradient[0][i] * across, value[0][i] * alongY, value[0][i] * alongZ };
          double d[3] = { offset[0][i], offset[1][j], offset[z][k] };
          f((at + i * s.axis[0].stride) * 4, value[0][i] * across, g, d);
        }
      }
  }
};

/// The points of some cells, N at a time: of `Cells` cells side by side, each of which has as many lanes.
template <int Dim, class Law, bool Whole, int N, int Cells, class T>
class Sweep
{
public:
  using R = Lanes<N, T>;
  using C = State<Dim, T>;
  using Kept = Columns<Dim>;         ///< of what is kept in double
  using Nodes = Lanes<4 * Cells, T>; ///< the values of a node of every cell
  static constexpr bool single = sizeof(T) == 4;
  static constexpr int nodes = cellNodes<Dim>;
  static constexpr int lines = cellLines<Dim>;
  static constexpr int own = N / Cells; ///< lanes of a cell
  /// Whether a cell's first points begin its moments: in a plane zeros cost less than as much code again.
  static constexpr bool fresh = Dim == 3;
  static constexpr bool yields = Law::history > 0;
  /// Whether the stress is found of two chunks at once: its operations wait for each other, and those of the other
  /// chunk fill the gaps. Short laws have none to fill, and twice as many lanes no registers, nor have walls that
  /// yield.
  static constexpr bool pairs = Dim == 3 && Whole && !single && Law::kind != LawKind::NeoHookean && !yields;
  static constexpr double mostFinite = 1e38; ///< in both precisions
  static_assert(!yields || !single);

  explicit Sweep(PointSweep& sweep)
    : s_(sweep)
    , taken_(sweep)
    , given_(sweep)
  {
    for (int a = 0; a < Dim; ++a)
    {
      for (int when = 0; when < 2; ++when)
        inverse_[when][a] = 1 / s_.axis[a].spacing[when];
      stretch_[a] = s_.axis[a].spacing[0] * inverse_[1][a] - 1;
    }
    for (int q = 0; q < Law::constants && s_.onePhase; ++q)
      constants_[q] = R(s_.constants[q]);
  }

  void run(std::int64_t first, std::int64_t last)
  {
    for (std::int64_t c = first; c < last; c += Cells)
      cells(c, static_cast<int>(last - c < Cells ? last - c : Cells));
    given_.finish();
    if (!Whole || !s_.look)
      return;
    for (int l = 0; l < N; ++l)
    {
      s_.kinetic += static_cast<double>(kinetic_.v[l]);
      s_.elastic += static_cast<double>(elastic_.v[l]);
      s_.stiffest =
        static_cast<double>(stiffest_.v[l]) > s_.stiffest ? static_cast<double>(stiffest_.v[l]) : s_.stiffest;
    }
  }

private:
  /// Where some lanes' points stand: those of one cell after another.
  struct Chunk
  {
    std::int64_t point[Cells];
    int count[Cells];
  };

  /// Their state between the two halves of a step.
  struct Moved
  {
    Chunk chunk;
    R x[Dim];
    R v[Dim];
    Matrix<Dim, R> affine;
    Matrix<Dim, R> F; ///< as it is stored
    Vector<Dim, R> axis;
    R history[yields ? Law::history : 1];
    Matrix<Dim, R> tau; ///< of a law that yields, which finds it on the way
  };

  /// @param present how many of the cells there are; of the others nothing is given to the grid
  void cells(std::int64_t first, int present)
  {
    std::int64_t most = 0; // points of a cell
    edge_ = false;
    T middle[Dim][Cells];
    T shift[Dim][Cells];
    for (int k = 0; k < Cells; ++k)
    {
      const PointCell& cell = cellOf(first, k, present);
      for (int a = 0; a < Dim; ++a)
      {
        const double at = cell.base[a] + 1;
        const SweepAxis& g = s_.axis[a];
        middle[a][k] = static_cast<T>(at);
        if constexpr (single)
          shift[a][k] = static_cast<T>((g.lower[0] - g.lower[1] + g.spacing[0] * at) * inverse_[1][a] - at);
        edge_ = edge_ || at - 0.5 < g.least || at + 0.5 > g.most;
      }
      if (k < present && s_.cells[first + k + 1].begin - cell.begin > most)
        most = s_.cells[first + k + 1].begin - cell.begin;
    }
    for (int a = 0; a < Dim; ++a)
    {
      middle_[a] = R::template eachGroup<Cells>(middle[a]);
      if constexpr (single)
        shift_[a] = R::template eachGroup<Cells>(shift[a]);
    }
    if constexpr (Whole)
      takeCells(first, present);
    if constexpr (!fresh)
      for (auto& component : moments_)
        for (R& m : component)
          m = R(0.0);
    if constexpr (pairs)
      for (std::int64_t done = 0; done < most; done += 2 * own)
        pointsOfTwo(first, present, done, most);
    else
      for (std::int64_t done = 0; done < most; done += own)
      {
        fetchAhead(s_.cells[first].begin + done * Cells);
        Moved p;
        begin(chunkAt(first, present, done), p);
        const Matrix<Dim, R> tau = stress(p);
        if (fresh && done == 0)
          end<fresh>(p, tau);
        else
          end<false>(p, tau);
      }
    giveCells(first, present);
  }

  Chunk chunkAt(std::int64_t first, int present, std::int64_t done) const
  {
    Chunk chunk;
    for (int k = 0; k < Cells; ++k)
    {
      const std::int64_t begin = s_.cells[first + (k < present ? k : 0)].begin;
      const std::int64_t left = k < present ? s_.cells[first + k + 1].begin - begin - done : 0;
      chunk.count[k] = static_cast<int>(left < 0 ? 0 : left < own ? left : own);
      chunk.point[k] = chunk.count[k] > 0 ? begin + done : begin; // somewhere there is memory
    }
    return chunk;
  }

  /// Two chunks, or the last one, the stress of both at once.
  void pointsOfTwo(std::int64_t first, int present, std::int64_t done, std::int64_t most)
  {
    const int chunks = most - done > own ? 2 : 1;
    Moved p[2];
    Two<R> constants[Law::constants];
#pragma GCC unroll 1
    for (int i = 0; i < chunks; ++i)
    {
      fetchAhead(s_.cells[first].begin + (done + i * own) * Cells);
      begin(chunkAt(first, present, done + i * own), p[i]);
      for (int q = 0; q < Law::constants; ++q)
        (i == 0 ? constants[q].first : constants[q].second) = constants_[q];
    }
    Matrix<Dim, R> tau[2];
    if (chunks == 2)
    {
      Matrix<Dim, Two<R>> F;
      Vector<Dim, Two<R>> axis;
      for (int i = 0; i < Dim * Dim; ++i)
        F.m[i] = { p[0].F.m[i], p[1].F.m[i] };
      for (int a = 0; a < Dim; ++a)
        axis[a] = { p[0].axis[a], p[1].axis[a] };
      addIdentity(F);
      const Matrix<Dim, Two<R>> both = Law::kirchhoff(constants, F, axis);
      for (int i = 0; i < Dim * Dim; ++i)
      {
        tau[0].m[i] = both.m[i].first;
        tau[1].m[i] = both.m[i].second;
      }
    }
    else
      tau[0] = stress(p[0]);
#pragma GCC unroll 1
    for (int i = 0; i < chunks; ++i)
      if (fresh && done + i == 0)
        end<fresh>(p[i], tau[i]);
      else
        end<false>(p[i], tau[i]);
  }

  const PointCell& cellOf(std::int64_t first, int k, int present) const
  {
    return s_.cells[first + (k < present ? k : 0)];
  }

  /// Coefficients of the velocities in some cells.
  void takeCells(std::int64_t first, int present)
  {
    const Node* planes[Cells][3];
    for (int k = 0; k < Cells; ++k)
      taken_.take(cellOf(first, k, present), planes[k]);
    constexpr int together = single && Cells > 1 ? Cells / 2 : Cells; // as many doubles as the processor has lanes
#pragma GCC unroll 9
    for (int line = 0; line < lines; ++line)
    {
      Lanes<4 * together> powers[Cells / together][3];
#pragma GCC unroll 2
      for (int g = 0; g < Cells / together; ++g)
      {
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
        {
          const double* at[together];
          for (int k = 0; k < together; ++k)
            at[k] = reinterpret_cast<const double*>(planes[g * together + k][i] + line);
          powers[g][i] = Lanes<4 * together>::template loadGroups<together>(at);
        }
        toPowers(powers[g][0], powers[g][1], powers[g][2]);
      }
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
      {
        T* const to = coefficients_ + 4 * Cells * (3 * line + i);
        if constexpr (Cells > together) // whole, as they will be read
          Nodes::joined(powers[0][i].template as<T>(), powers[1][i].template as<T>()).store(to);
        else
          powers[0][i].template as<T>().store(to);
      }
    }
  }

  /// Moments of some cells' points to the nodes.
  void giveCells(std::int64_t first, int present)
  {
    Nodes out[nodes];
#pragma GCC unroll 9
    for (int line = 0; line < lines; ++line)
    {
      Nodes* const o = out + 3 * line;
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
      {
        const int n = 3 * line + i;
        o[i] = sums<N, Cells>(moments_[0][n], moments_[1][n], moments_[2][n], Dim == 3 ? moments_[Dim][n] : R(0.0));
      }
      fromPowers(o[0], o[1], o[2]);
    }
    for (int k = 0; k < present; ++k)
    {
      Node* const* const planes = given_.of(s_.cells[first + k]);
#pragma GCC unroll 9
      for (int line = 0; line < lines; ++line)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
        {
          const Lanes<4, T> more = out[3 * line + i].template group<Cells>(k);
          Node& sum = planes[i][line];
          if constexpr (single)
            sum = sum + more.template as<double>() * s_.massScale;
          else
            sum = sum + more;
        }
    }
  }

  T* column(int c, std::int64_t p) const
  {
    if constexpr (single)
      return s_.state + c * s_.statePitch + p;
    else
      return s_.columns + c * s_.pitch + p;
  }
  /// The processor does not follow so many streams; past the last point there is other memory, or nothing is fetched.
  void fetchAhead(std::int64_t p) const
  {
    constexpr std::int64_t ahead = 64; // points
    const auto fetch = [&](int c, int columns)
    {
      for (int i = 0; i < columns; ++i)
        __builtin_prefetch(column(c + i, p + ahead));
    };
    fetch(C::positions, Dim);
    fetch(C::deformations, Dim * Dim);
    fetch(C::masses, 2 + Dim + Law::history); // volumes, axes and what is remembered behind them
  }
  R load(int c, const Chunk& chunk) const
  {
    const T* at[Cells];
    const T* const first = column(c, chunk.point[0]);
    for (int k = 0; k < Cells; ++k)
      at[k] = first + (chunk.point[k] - chunk.point[0]);
    return R::template loadGroups<Cells>(at);
  }
  void store(int c, const Chunk& chunk, const R& value) const
  {
    T* const first = column(c, chunk.point[0]);
    for (int k = 0; k < Cells; ++k)
      value.template group<Cells>(k).storeFirst(first + (chunk.point[k] - chunk.point[0]), chunk.count[k]);
  }
  /// Of a column that is double in every precision, and begins with point `first`.
  static R loadDoubles(const double* column, const Chunk& chunk, std::int64_t first = 0)
  {
    if constexpr (single)
    {
      T values[N];
      for (int k = 0; k < Cells; ++k)
        Node::load(column + (chunk.point[k] - first)).template as<T>().store(values + own * k);
      return R::load(values);
    }
    else
    {
      const double* at[Cells];
      for (int k = 0; k < Cells; ++k)
        at[k] = column + (chunk.point[k] - first);
      return R::template loadGroups<Cells>(at);
    }
  }
  void storeKept(int c, const Chunk& chunk, const R& value) const
  {
    for (int k = 0; k < Cells; ++k)
      value.template group<Cells>(k).template as<double>().storeFirst(
        s_.columns + c * s_.pitch + chunk.point[k], chunk.count[k]);
  }
  /// Makes F of what is stored of it. In place: a copy would be made by bytes.
  template <class Real>
  [[gnu::always_inline]] static void addIdentity(Matrix<Dim, Real>& stored)
  {
    for (int a = 0; a < Dim && single; ++a)
      stored(a, a) = stored(a, a) + Real(1.0);
  }
  [[gnu::always_inline]] Matrix<Dim, R> stress(const Moved& p) const
  {
    if constexpr (single)
    {
      Matrix<Dim, R> F = p.F;
      addIdentity(F);
      return Law::kirchhoff(constants_, F, p.axis);
    }
    else if constexpr (yields && Whole)
      return p.tau;
    else if constexpr (yields)
      return Law::kirchhoff(constants_, p.F, p.axis, p.history);
    else
      return Law::kirchhoff(constants_, p.F, p.axis);
  }
  /// A bit for every lane that has a point.
  static unsigned present(const Chunk& chunk)
  {
    unsigned lanes = 0;
    for (int k = 0; k < Cells; ++k)
      lanes |= ((1U << chunk.count[k]) - 1) << (k * own);
    return lanes;
  }

  /// Finds constants_ too.
  [[gnu::always_inline]] void begin(const Chunk& chunk, Moved& p)
  {
    for (int q = 0; q < Law::constants && !s_.onePhase; ++q)
      for (int l = 0; l < N; ++l)
        constants_[q].v[l] =
          static_cast<T>(s_.constants[s_.phase[chunk.point[l / own] + l % own] * Law::constants + q]);
    p.chunk = chunk;
    for (int a = 0; a < Dim; ++a)
    {
      p.x[a] = load(C::positions + a, chunk);
      p.axis[a] = load(C::axes + a, chunk);
    }
    for (int i = 0; i < Dim * Dim; ++i)
      p.F.m[i] = load(C::deformations + i, chunk);
    if constexpr (yields)
      for (int i = 0; i < Law::history; ++i)
        p.history[i] = load(C::histories + i, chunk);
    if constexpr (Whole)
    {
      take(chunk, p.x, p.v, p.affine, p.F);
      if constexpr (yields)
        flow(p);
      for (int i = 0; i < Dim * Dim; ++i)
        store(C::deformations + i, chunk, p.F.m[i]);
      if (s_.look)
      {
        const Moved copy = p; // whose address is known elsewhere: p itself may stay in registers
        look(copy);
      }
    }
    else
    {
      for (int a = 0; a < Dim; ++a)
        p.v[a] = s_.forcesOnly ? R(0.0) : loadDoubles(s_.columns + (Kept::velocities + a) * s_.pitch, chunk);
      for (int i = 0; i < Dim * Dim; ++i)
        p.affine.m[i] = s_.forcesOnly ? R(0.0) : loadDoubles(s_.affines + i * s_.affinesPitch, chunk, s_.affinesFirst);
    }
  }

  /// @tparam Fresh whether they are the first of their cells
  template <bool Fresh>
  [[gnu::always_inline]] void end(const Moved& p, const Matrix<Dim, R>& tau)
  {
    give<Fresh>(p.chunk, p.x, p.v, p.affine, tau);
  }

  /// Velocities from the grid; moves and strains the points.
  /// @param F as it is stored
  [[gnu::always_inline]] void take(const Chunk& chunk, R* x, R* v, Matrix<Dim, R>& affine, Matrix<Dim, R>& F)
  {
    CellPlace<R> at[3] = { place(0, 0, x[0]), place(0, 1, x[1]), place(0, Dim - 1, x[Dim - 1]) };
    const unsigned here = present(chunk);
    // lanes without one have points of other cells, which velocities far from them would tear
    if (here != (1U << N) - 1)
      for (int a = 0; a < 3; ++a)
        at[a] = CellPlace<R>(select(R::where(here), at[a].e, R(0.0)));
    Matrix<Dim, R> L;
#pragma GCC unroll 3
    for (int c = 0; c < Dim; ++c)
    {
      const Evaluated<Dim, R> r =
        evaluate<Dim, R>([&](int n) { return spread<N, Cells>(coefficients_ + 4 * Cells * n, 1 + c); }, at);
      v[c] = r.value;
      for (int b = 0; b < Dim; ++b)
      {
        L(c, b) = r.gradient[b] * inverse_[0][b];
        affine(c, b) = r.affine[b] * inverse_[0][b];
      }
    }
    if (const unsigned strays = outsideCell(at) & here; strays != 0)
    {
      Taken t{ {}, {}, affine, L };
      for (int a = 0; a < Dim; ++a)
      {
        t.x[a] = x[a];
        t.v[a] = v[a];
      }
      takeStrays(strays, t);
      for (int a = 0; a < Dim; ++a)
        v[a] = t.v[a];
      affine = t.affine;
      L = t.L;
    }

    for (int a = 0; a < Dim; ++a)
    {
      if constexpr (single)
        x[a] = x[a] + (x[a] * R(stretch_[a]) + (shift_[a] + v[a] * R(s_.dt * inverse_[1][a])));
      else
        x[a] = x[a] + s_.dt * v[a];
      store(C::positions + a, chunk, x[a]);
    }
    if (s_.keep)
    {
      for (int a = 0; a < Dim; ++a)
        storeKept(Kept::velocities + a, chunk, v[a]);
      R most = abs(affine.m[0]);
      for (int i = 1; i < Dim * Dim; ++i)
        most = max(most, abs(affine.m[i]));
      for (int l = 0; l < N; ++l)
        if ((here >> l & 1U) != 0 && static_cast<double>(most.v[l]) > s_.fastest)
          s_.fastest = static_cast<double>(most.v[l]);
    }
    Matrix<Dim, R> before = F;
    addIdentity(before);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j)
      {
        R sum = L(i, 0) * before(0, j);
        for (int k = 1; k < Dim; ++k)
          sum = sum + L(i, k) * before(k, j);
        F(i, j) = F(i, j) + s_.dt * sum;
      }
  }

  [[gnu::always_inline]] void flow(Moved& p) const
  {
    const Flow<Dim, R> flown = Law::flow(constants_, p.F, p.axis, p.history);
    p.tau = flown.stress;
    for (int i = 0; i < Law::history && flown.any; ++i)
      store(C::histories + i, p.chunk, p.history[i]);
  }

  /// Adds to the sums what these points have.
  [[gnu::noinline]] void look(const Moved& p)
  {
    const R none(0.0);
    const R mass = load(C::masses, p.chunk);
    const R volume = load(C::volumes, p.chunk);
    Matrix<Dim, R> F = p.F;
    addIdentity(F);
    const typename R::I here = R::where(present(p.chunk));
    R stiffness;
    if constexpr (yields)
      stiffness = Law::stiffness(constants_, F, p.axis, p.history) * volume / mass;
    else
      stiffness = Law::stiffness(constants_, F, p.axis) * volume / mass;
    const typename R::I sound = (stiffness <= R(mostFinite)) & (determinant(F) > none); // false of what is no number
    const R finite = select(sound, stiffness, R(__builtin_inf()));
    stiffest_ = max(stiffest_, select(here, finite, none));
    if (!s_.sums)
      return;
    R squares = none;
    for (int a = 0; a < Dim; ++a)
    {
      R own = p.v[a] * p.v[a];
      for (int b = 0; b < Dim; ++b)
      {
        const R c = p.affine(a, b) * R(0.5 * s_.axis[b].spacing[1]);
        own = own + c * c;
      }
      squares = squares + own;
    }
    kinetic_ = kinetic_ + select(here, 0.5 * (mass * squares), none);
    R energy;
    if constexpr (yields)
      energy = Law::energy(constants_, F, p.axis, p.history);
    else
      energy = Law::energy(constants_, F, p.axis);
    elastic_ = elastic_ + select(here, volume * energy, none);
  }

  /// Momentum and forces to the grid.
  template <bool Fresh>
  [[gnu::always_inline]] void give(
    const Chunk& chunk, const R* x, const R* v, const Matrix<Dim, R>& affine, const Matrix<Dim, R>& tau)
  {
    CellPlace<R> at[3] = { place(1, 0, x[0]), place(1, 1, x[1]), place(1, Dim - 1, x[Dim - 1]) };
    const R mass = load(C::masses, chunk);
    const R impulse = load(C::volumes, chunk) * R(-s_.kick);
    const unsigned here = present(chunk);
    const unsigned strays = outsideCell(at) & here;
    const typename R::I inside = R::where(here & ~strays);
    if (strays != 0 || edge_)
    {
      const CellPlace<R> places[3] = { at[0], at[1], at[2] };
      report(places, here);
    }
    if (strays != 0)
    {
      Given g{ {}, {}, affine, tau, mass, impulse };
      for (int a = 0; a < Dim; ++a)
      {
        g.x[a] = x[a];
        g.v[a] = v[a];
      }
      giveStrays(strays, g);
    }
    const R none(0.0);
    if (strays != 0 || here != (1U << N) - 1)
      for (int a = 0; a < 3; ++a)
        at[a] = CellPlace<R>(select(inside, at[a].e, none));
    const R m = select(inside, mass, none);
    addMoments<Dim, Fresh>(moments_[0], at, !Whole && s_.forcesOnly ? none : m);
#pragma GCC unroll 3
    for (int c = 0; c < Dim; ++c)
    {
      R gradient[Dim];
      R spread[Dim];
      for (int b = 0; b < Dim; ++b)
      {
        gradient[b] = select(inside, impulse * tau(c, b), none) * inverse_[1][b];
        spread[b] = m * affine(c, b) * R(0.25 * s_.axis[b].spacing[1]);
      }
      addMoments<Dim, Fresh>(moments_[1 + c], at, m * (v[c] + R(s_.kick * s_.gravity[c])), gradient, spread);
    }
  }

  /// @param when before (0) or after (1) the step
  CellPlace<R> place(int when, int a, R x) const
  {
    if constexpr (single)
      return CellPlace<R>(x);
    else
      return CellPlace<R>((x - R(s_.axis[a].lower[when])) * inverse_[when][a] - middle_[a]);
  }

  /// A bit a lane: is it outside the cell? What is not a number is.
  unsigned outsideCell(const CellPlace<R>* at) const
  {
    typename R::I in = abs(at[0].e) <= R(0.5);
    for (int a = 1; a < Dim; ++a)
      in &= abs(at[a].e) <= R(0.5);
    return bits<N, T>(~in);
  }

  /// Coordinates of a lane's point. @return whether all nodes that it reaches are there
  bool coordinates(int when, int lane, const R* x, double* coordinate) const
  {
    bool there = true;
    for (int a = 0; a < Dim; ++a)
    {
      if constexpr (single)
        coordinate[a] = static_cast<double>(x[a].v[lane]) + static_cast<double>(middle_[a].v[lane]);
      else
        coordinate[a] = (x[a].v[lane] - s_.axis[a].lower[when]) / s_.axis[a].spacing[when];
      there = there && coordinate[a] >= -0.5 && coordinate[a] < s_.axis[a].end;
    }
    return there;
  }

  // What strays take and give, as copies: a lane is a place in memory, and all else is to stay in registers.
  struct Taken
  {
    R x[Dim];
    R v[Dim];
    Matrix<Dim, R> affine;
    Matrix<Dim, R> L;
  };
  struct Given
  {
    R x[Dim];
    R v[Dim];
    Matrix<Dim, R> affine;
    Matrix<Dim, R> tau;
    R mass;
    R impulse;
  };

  [[gnu::noinline]] void takeStrays(unsigned strays, Taken& t) const
  {
    for (int l = 0; l < N; ++l)
      if (strays >> l & 1U)
        takeStray(l, t.x, t.v, t.affine, t.L);
  }
  [[gnu::noinline]] void giveStrays(unsigned strays, const Given& g)
  {
    for (int l = 0; l < N; ++l)
      if (strays >> l & 1U)
        giveStray(l, g.x, g.v, g.affine, g.tau, g.mass, g.impulse);
  }

  void takeStray(int lane, const R* x, R* v, Matrix<Dim, R>& affine, Matrix<Dim, R>& L) const
  {
    double coordinate[Dim];
    if (!coordinates(0, lane, x, coordinate))
      return; // it was reported when it went there
    const Stray<Dim> stray(s_, coordinate);
    const Node none(0.0);
    Node value = none; // by component, the first unused
    Node gradients[3] = { none, none, none };
    Node spread[3] = { none, none, none };
    stray.forEach(s_,
      [&](std::int64_t node, double weight, const double* g, const double* d)
      {
        const Node u = Node::load(s_.velocity + node);
        const Node part = weight * u;
        value = value + part;
        for (int b = 0; b < Dim; ++b)
        {
          gradients[b] = gradients[b] + g[b] * u;
          spread[b] = spread[b] + (4 * d[b]) * part;
        }
      });
    for (int c = 0; c < Dim; ++c)
    {
      v[c].v[lane] = static_cast<T>(value.v[1 + c]);
      for (int b = 0; b < Dim; ++b)
      {
        L(c, b).v[lane] = static_cast<T>(gradients[b].v[1 + c] / s_.axis[b].spacing[0]);
        affine(c, b).v[lane] = static_cast<T>(spread[b].v[1 + c] / s_.axis[b].spacing[0]);
      }
    }
  }

  void giveStray(
    int lane, const R* x, const R* v, const Matrix<Dim, R>& affine, const Matrix<Dim, R>& tau, R mass, R impulse)
  {
    ++s_.strays;
    double coordinate[Dim];
    if (!coordinates(1, lane, x, coordinate))
    {
      s_.outside = true;
      return;
    }
    const Stray<Dim> stray(s_, coordinate);
    const double scale = single ? s_.massScale : 1;
    const double bulk = scale * static_cast<double>(mass.v[lane]);
    const double push = scale * static_cast<double>(impulse.v[lane]);
    // what a node gets as its mass and momentum, and more by how far it is and by the spline's slope
    Node given(0.0);
    Node further[3] = { given, given, given };
    Node slope[3] = { given, given, given };
    given.v[0] = !Whole && s_.forcesOnly ? 0 : bulk;
    for (int c = 0; c < Dim; ++c)
    {
      given.v[1 + c] = bulk * (static_cast<double>(v[c].v[lane]) + s_.kick * s_.gravity[c]);
      for (int b = 0; b < Dim; ++b)
      {
        further[b].v[1 + c] = bulk * static_cast<double>(affine(c, b).v[lane]) * s_.axis[b].spacing[1];
        slope[b].v[1 + c] = push * static_cast<double>(tau(c, b).v[lane]) / s_.axis[b].spacing[1];
      }
    }
    stray.forEach(s_,
      [&](std::int64_t node, double weight, const double* g, const double* d)
      {
        Node whole = given;
        for (int b = 0; b < Dim; ++b)
          whole = whole + d[b] * further[b];
        whole = weight * whole;
        for (int b = 0; b < Dim; ++b)
          whole = whole + g[b] * slope[b];
        (Node::load(s_.momentum + node) + whole).store(s_.momentum + node);
      });
  }

  /// Notes points that have gone further than a cell, or near an end of the grid.
  [[gnu::noinline, gnu::cold]] void report(const CellPlace<R>* at, unsigned here)
  {
    for (int a = 0; a < Dim; ++a)
    {
      const R coordinate = at[a].e + middle_[a];
      const auto in = (coordinate >= R(s_.axis[a].least)) & (coordinate <= R(s_.axis[a].most));
      const auto near = abs(at[a].e) <= R(1.5);
      s_.outside = s_.outside || (bits<N, T>(~in) & here) != 0;
      s_.far = s_.far || (bits<N, T>(~near) & here) != 0;
    }
  }

  PointSweep& s_;
  double inverse_[2][3] = {}; ///< of the spacings, before and after
  double stretch_[3] = {};    ///< of the spacings in the step
  R middle_[3];               ///< node in the middle of the cells' splines
  R shift_[3];                ///< of the cells' middles in the step, in single precision [spacings]
  bool edge_ = false;         ///< a cell reaches where points are to be reported
  R constants_[Law::constants];
  T coefficients_[4 * Cells * nodes];
  R moments_[1 + Dim][nodes];
  R kinetic_{ 0.0 };
  R elastic_{ 0.0 };
  R stiffest_{ 0.0 };
  TakenPlanes<Dim, Cells> taken_;
  GivenPlanes<Dim> given_;
};

template <int Dim, class Law, bool Whole, int N, int Cells, class T>
void sweepCells(PointSweep& sweep, std::int64_t first, std::int64_t last)
{
  Sweep<Dim, Law, Whole, N, Cells, T>(sweep).run(first, last);
}

// Cells of four points, and outlines of tissue, where cells are half empty, fill eight lanes by two.
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
constexpr int lanes = 8;
constexpr int cellsAtOnce = 2;
#elif defined(__AVX2__)
constexpr int lanes = 4;
constexpr int cellsAtOnce = 1;
#else
constexpr int lanes = 2;
constexpr int cellsAtOnce = 1;
#endif
constexpr int singleCells = lanes / 2; // of four lanes each

} // namespace

#define LAMELLA_LAW(Dim, Law, N, Cells, T)                                                                             \
  {                                                                                                                    \
    sweepCells<Dim, Law, false, N, Cells, T>, sweepCells<Dim, Law, true, N, Cells, T>                                  \
  }
#define LAMELLA_ELASTIC(Dim, N, Cells, T)                                                                              \
  LAMELLA_LAW(Dim, NeoHookean, N, Cells, T), LAMELLA_LAW(Dim, Isotropic, N, Cells, T),                                 \
    LAMELLA_LAW(Dim, Orthotropic, N, Cells, T)
#define LAMELLA_ALL(Dim, N, Cells, T)                                                                                  \
  LAMELLA_ELASTIC(Dim, N, Cells, T), LAMELLA_LAW(Dim, Hencky, N, Cells, T), LAMELLA_LAW(Dim, Hill, N, Cells, T)
extern const PointKernels LAMELLA_KERNELS;
const PointKernels LAMELLA_KERNELS = {
  LAMELLA_KERNELS_NAME, lanes, cellsAtOnce,
  { { { LAMELLA_ALL(2, lanes, cellsAtOnce, double) }, { LAMELLA_ALL(3, lanes, cellsAtOnce, double) } },
    { { LAMELLA_ELASTIC(2, 2 * lanes, singleCells, float) }, { LAMELLA_ELASTIC(3, 2 * lanes, singleCells, float) } } }
};

} // namespace lamella::mpm
