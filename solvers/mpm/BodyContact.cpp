#include "mpm/BodyContact.h"

#include "mpm/GridWalls.h"
#include "mpm/ShapeFunctions.h"
#include "mpm/SharedRows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::mpm
{
namespace
{

constexpr double slack = 0.05; // of a cell, that bodies may be apart and touch: else they would rattle

/// Whether its nodes beyond the ends are images of others, a period away; on several ranks those are the neighbours'.
bool wraps(const GridAxis& g)
{
  return g.end(0) == Edge::Periodic && !g.isCut(0);
}

/// First and last node of an axis that is no image of another.
std::array<int, 2> ownNodes(const GridAxis& g)
{
  if (wraps(g))
    return { 0, g.cells - 1 };
  return { g.end(0) == Edge::Wall ? 0 : -1, g.end(1) == Edge::Wall ? g.cells : g.cells + 1 };
}

bool onWall(const GridAxis& g, int node)
{
  return (node == 0 && g.end(0) == Edge::Wall) || (node == g.cells && g.end(1) == Edge::Wall);
}

/// The impulse of one pair at a node, from `a` to `b`.
template <int Dim>
void collide(double* a, double* b, const Vector<Dim>& normal, const std::array<bool, Dim>& held, double friction)
{
  Vector<Dim> slip; // at first all of the relative velocity
  double approach = 0;
  for (int c = 0; c < Dim; ++c)
  {
    slip[c] = held[static_cast<std::size_t>(c)] ? 0 : a[1 + c] / a[0] - b[1 + c] / b[0];
    approach += slip[c] * normal[c];
  }
  if (!(approach > 0))
    return;
  double square = 0;
  for (int c = 0; c < Dim; ++c)
  {
    slip[c] -= approach * normal[c];
    square += slip[c] * slip[c];
  }
  const double reduced = a[0] * b[0] / (a[0] + b[0]);
  const double speed = std::sqrt(square);
  const double along = speed > 0 ? reduced * std::min(friction * approach / speed, 1.0) : 0;
  for (int c = 0; c < Dim; ++c)
  {
    const double impulse = reduced * approach * normal[c] + along * slip[c];
    a[1 + c] -= impulse;
    b[1 + c] += impulse;
  }
}

/// Two bodies at a node.
template <int Dim>
struct Meeting
{
  static constexpr int candidates = 3;
  std::array<int, Dim> node;
  int a;
  int b;
  std::array<Vector<Dim>, candidates> normal{}; ///< from a to b; 0: none
  /// How far a reaches along each, and from where on b does [m, from the node].
  std::array<double, candidates> end;
  std::array<double, candidates> begin;
};

template <int Dim>
class Meetings
{
public:
  Meetings(const BackgroundGrid<Dim>& grid, const Bodies& bodies, std::span<double> nodes, double least,
    const SharedRows<Dim>* rows)
    : rows_(rows)
    , grid_(grid)
    , bodies_(bodies)
    , nodes_(nodes)
    , least_(least)
    , first_(static_cast<std::size_t>(grid.count()), none)
  {
    std::array<std::array<int, 2>, 3> own{};
    for (int a = 0; a < Dim; ++a)
      own[static_cast<std::size_t>(a)] = ownNodes(grid.axis(a));
    for (int k = own[2][0]; k <= own[2][1]; ++k)
      for (int j = own[1][0]; j <= own[1][1]; ++j)
        for (int i = own[0][0]; i <= own[0][1]; ++i)
          if constexpr (Dim == 3)
            find({ i, j, k });
          else
            find({ i, j });
    if (rows_)
      share();
  }

  /// Normals, and where the bodies' points are along them.
  void measure(const MaterialPoints<Dim>& points)
  {
    if (all_.empty())
      return;
    markReaches();
    forEachNear(
      points, [this](std::size_t, const Seen& seen, Meeting<Dim>& pair, int body) { slope(seen, pair, body); });
    addSlopes();
    smooth();
    takeOuterSlopes();
    for (Meeting<Dim>& pair : all_)
    {
      for (int c = 0; c < Dim; ++c)
        pair.normal[2][c] = pair.normal[0][c] + pair.normal[1][c];
      for (std::size_t c = 0; c < Meeting<Dim>::candidates; ++c)
        if (!normalise(pair.normal[c]))
          pair.end[c] = std::numeric_limits<double>::infinity();
    }
    forEachNear(points,
      [&points](std::size_t p, const Seen& seen, Meeting<Dim>& pair, int body)
      { extend(points, p, seen, pair, body); });
    joinReaches();
  }

  /// Impulses of those that touch.
  void collide() const
  {
    const std::int64_t pitch = grid_.count() * nodeValues;
    for (std::size_t begin = 0, end = 0; begin < all_.size(); begin = end)
    {
      while (end < all_.size() && all_[end].node == all_[begin].node)
        ++end;
      std::array<bool, Dim> held{};
      for (std::size_t c = 0; c < Dim; ++c)
        held[c] = onWall(grid_.axis(static_cast<int>(c)), all_[begin].node[c]);
      double* const at = nodes_.data() + grid_.index(all_[begin].node) * nodeValues;
      for (int pass = 0; pass < (end - begin == 1 ? 1 : 3); ++pass)
        for (std::size_t m = begin; m < end; ++m)
        {
          const Meeting<Dim>& pair = all_[m];
          std::size_t best = 0;
          for (std::size_t c = 1; c < Meeting<Dim>::candidates; ++c)
            if (pair.begin[c] - pair.end[c] > pair.begin[best] - pair.end[best])
              best = c;
          if (pair.begin[best] - pair.end[best] <= slack * grid_.smallestSpacing())
            mpm::collide<Dim>(
              at + pair.a * pitch, at + pair.b * pitch, pair.normal[best], held, bodies_.frictionOf(pair.a, pair.b));
        }
    }
  }

private:
  static constexpr std::int32_t none = -1;
  static constexpr int splines = Dim == 3 ? 27 : 9;

  void find(const std::array<int, Dim>& node)
  {
    const std::int64_t pitch = grid_.count() * nodeValues;
    const double* const at = nodes_.data() + grid_.index(node) * nodeValues;
    for (int a = 0; a < bodies_.count; ++a)
      for (int b = a + 1; b < bodies_.count && at[a * pitch] > least_; ++b)
      {
        if (!(at[b * pitch] > least_))
          continue;
        Meeting<Dim> pair{ node, a, b, {}, {}, {} };
        pair.end.fill(-std::numeric_limits<double>::infinity());
        pair.begin.fill(std::numeric_limits<double>::infinity());
        std::int32_t& first = first_[static_cast<std::size_t>(grid_.index(node))];
        if (first == none)
          first = static_cast<std::int32_t>(all_.size());
        all_.push_back(pair);
      }
  }

  /// Notes the meetings on rows that neighbours have too. They know of the same ones in the same order, as masses there
  /// are the same.
  void share()
  {
    for (std::size_t side : { 0U, 1U })
      if (grid_.axis(rows_->axis()).isCut(static_cast<int>(side)))
      {
        const auto [first, last] = rows_->span(grid_, static_cast<int>(side));
        for (std::size_t m = 0; m < all_.size(); ++m)
          if (const int row = rowOf(all_[m]); row >= first && row <= last)
            shared_[side].push_back(m);
      }
  }

  [[nodiscard]] int rowOf(const Meeting<Dim>& pair) const { return pair.node[static_cast<std::size_t>(rows_->axis())]; }

  /// Calls give(shared meeting, its values), swaps with the neighbours, and calls take(meeting, theirs, side).
  template <int Count, class Give, class Take>
  void exchange(Give&& give, Take&& take)
  {
    if (!rows_)
      return;
    std::array<std::vector<double>, 2> out;
    std::array<std::vector<double>, 2> in;
    for (std::size_t side : { 0U, 1U })
    {
      out[side].resize(shared_[side].size() * Count);
      for (std::size_t i = 0; i < shared_[side].size(); ++i)
        give(all_[shared_[side][i]], &out[side][i * Count]);
    }
    rows_->swap(out, in);
    for (std::size_t side : { 0U, 1U })
      for (std::size_t i = 0; i < shared_[side].size(); ++i)
        take(all_[shared_[side][i]], &in[side][i * Count], side);
  }

  static void giveSlopes(const Meeting<Dim>& pair, double* values)
  {
    for (std::size_t side : { 0U, 1U })
      for (int c = 0; c < Dim; ++c)
        *values++ = pair.normal[side][c];
  }

  /// Of the neighbours' points.
  void addSlopes()
  {
    exchange<2 * Dim>(
      giveSlopes,
      [](Meeting<Dim>& pair, const double* values, std::size_t)
      {
        for (std::size_t side : { 0U, 1U })
          for (int c = 0; c < Dim; ++c)
            pair.normal[side][c] += *values++;
      });
  }

  /// Means on the outermost row want those of a row beyond, which only the neighbour has.
  void takeOuterSlopes()
  {
    exchange<2 * Dim>(
      giveSlopes,
      [this](Meeting<Dim>& pair, const double* values, std::size_t end)
      {
        if (rowOf(pair) != (end == 0 ? -1 : grid_.axis(rows_->axis()).cells + 1))
          return;
        for (std::size_t side : { 0U, 1U })
          for (int c = 0; c < Dim; ++c)
            pair.normal[side][c] = *values++;
      });
  }

  /// How far the neighbours' points reach, too.
  void joinReaches()
  {
    constexpr int candidates = Meeting<Dim>::candidates;
    exchange<2 * candidates>(
      [](const Meeting<Dim>& pair, double* values)
      {
        std::copy(pair.end.begin(), pair.end.end(), values);
        std::copy(pair.begin.begin(), pair.begin.end(), values + candidates);
      },
      [](Meeting<Dim>& pair, const double* values, std::size_t)
      {
        for (std::size_t c = 0; c < candidates; ++c)
        {
          pair.end[c] = std::max(pair.end[c], values[c]);
          pair.begin[c] = std::min(pair.begin[c], values[candidates + c]);
        }
      });
  }

  /// Slopes become means over the meetings of the same bodies at nodes beside, weighed 1 : 2 : 1 along every axis:
  /// points along planes that cross the grid are steps.
  void smooth()
  {
    std::vector<std::array<Vector<Dim>, 2>> means(all_.size());
    for (std::size_t m = 0; m < all_.size(); ++m)
    {
      for (int n = 0; n < splines; ++n)
      {
        std::array<int, Dim> node = all_[m].node;
        double share = 1;
        for (std::size_t a = 0, rest = static_cast<std::size_t>(n); a < Dim; ++a, rest /= 3)
        {
          node[a] += static_cast<int>(rest % 3) - 1;
          share *= rest % 3 == 1 ? 2 : 1;
        }
        const Vector<Dim> turn = turned(node);
        if (!there(node))
          continue;
        const std::int32_t first = first_[static_cast<std::size_t>(grid_.index(node))];
        for (auto k = static_cast<std::size_t>(first); first != none && k < all_.size() && all_[k].node == node; ++k)
          if (all_[k].a == all_[m].a && all_[k].b == all_[m].b)
            for (std::size_t side : { 0U, 1U })
              for (int c = 0; c < Dim; ++c)
                means[m][side][c] += share * turn[c] * all_[k].normal[side][c];
      }
    }
    for (std::size_t m = 0; m < all_.size(); ++m)
      for (std::size_t side : { 0U, 1U })
        all_[m].normal[side] = means[m][side];
  }

  [[nodiscard]] bool there(const std::array<int, Dim>& node) const
  {
    bool inside = true;
    for (std::size_t a = 0; a < Dim; ++a)
      inside = inside && node[a] >= -1 && node[a] <= grid_.axis(static_cast<int>(a)).cells + 1;
    return inside;
  }

  /// A point as a node sees it.
  struct Seen
  {
    Vector<Dim> offset;   ///< from the node [m]
    Vector<Dim> gradient; ///< of the node's spline, times the point's share of space
    Vector<Dim> turn;     ///< −1 along axes across which it is a mirror image
  };

  /// f(point, as it is seen, meeting, body) for all points that reach a meeting's node, or an image of one.
  template <class F>
  void forEachNear(const MaterialPoints<Dim>& points, F&& f)
  {
    using Points = MaterialPoints<Dim>;
    for (std::size_t p = 0; p < points.count(); ++p)
    {
      std::int64_t base = 0;
      bool inside = true;
      for (int a = 0; a < Dim; ++a)
      {
        const GridAxis& g = grid_.axis(a);
        const double at = std::floor(g.coordinate(points.column(a)[p]) - 0.5);
        inside = inside && at >= -1 && at <= g.cells - 1;
        base += inside ? (static_cast<std::int64_t>(at) + 1) * grid_.stride(a) : 0;
      }
      if (!inside || near_[static_cast<std::size_t>(base)] == 0)
        continue;
      std::array<AxisShape<3>, Dim> shape;
      for (std::size_t a = 0; a < Dim; ++a)
        shape[a] =
          QuadraticSpline::at(grid_.axis(static_cast<int>(a)).coordinate(points.column(static_cast<int>(a))[p]), 0);
      const int body = static_cast<int>(bodies_.of(points.phase()[p]));
      for (int n = 0; n < splines; ++n)
      {
        std::array<int, Dim> node;
        std::array<std::size_t, Dim> part;
        for (std::size_t a = 0, rest = static_cast<std::size_t>(n); a < Dim; ++a, rest /= 3)
        {
          part[a] = rest % 3;
          node[a] = shape[a].base + static_cast<int>(part[a]);
        }
        const std::array<int, Dim> image = node;
        Seen seen{ {}, {}, turned(node) };
        const std::int32_t first = first_[static_cast<std::size_t>(grid_.index(node))];
        if (first == none)
          continue;
        const double share = points.column(Points::masses)[p] / bodies_.density[static_cast<std::size_t>(body)];
        for (int a = 0; a < Dim; ++a)
        {
          const auto at = static_cast<std::size_t>(a);
          const GridAxis& g = grid_.axis(a);
          seen.offset[a] = points.column(a)[p] - (g.lower + g.spacing * image[at]);
          seen.gradient[a] = share / g.spacing;
          for (std::size_t b = 0; b < Dim; ++b)
            seen.gradient[a] *= b == at ? shape[b].gradient[part[b]] : shape[b].value[part[b]];
        }
        for (auto m = static_cast<std::size_t>(first); m < all_.size() && all_[m].node == node; ++m)
          if (all_[m].a == body || all_[m].b == body)
            f(p, seen, all_[m], body);
      }
    }
  }

  /// Marks the first nodes of all points that reach a meeting, or an image of its node.
  void markReaches()
  {
    near_.assign(first_.size(), 0);
    std::array<int, 3> node{};
    for (node[2] = -1; node[2] < (Dim == 3 ? grid_.nodes(Dim - 1) - 1 : 0); ++node[2])
      for (node[1] = -1; node[1] < grid_.nodes(1) - 1; ++node[1])
        for (node[0] = -1; node[0] < grid_.nodes(0) - 1; ++node[0])
        {
          std::array<int, Dim> at;
          std::copy_n(node.begin(), Dim, at.begin());
          const std::int64_t here = grid_.index(at);
          (void)turned(at);
          if (first_[static_cast<std::size_t>(grid_.index(at))] == none)
            continue;
          for (int n = 0; n < splines; ++n)
          {
            std::int64_t back = 0;
            bool inside = true;
            for (int a = 0, rest = n; a < Dim; ++a, rest /= 3)
            {
              back += rest % 3 * grid_.stride(a);
              inside = inside && node[static_cast<std::size_t>(a)] - rest % 3 >= -1;
            }
            if (inside)
              near_[static_cast<std::size_t>(here - back)] = 1;
          }
        }
  }

  /// The node of which this is an image, in its place. @return −1 along axes across which it is mirrored, else 1
  Vector<Dim> turned(std::array<int, Dim>& node) const
  {
    Vector<Dim> turn;
    for (int a = 0; a < Dim; ++a)
    {
      const GridAxis& g = grid_.axis(a);
      int& i = node[static_cast<std::size_t>(a)];
      turn[a] = 1;
      if (wraps(g))
        i = (i + g.cells) % g.cells;
      else if ((i < 0 && g.end(0) == Edge::Wall) || (i > g.cells && g.end(1) == Edge::Wall))
      {
        i = i < 0 ? -i : 2 * g.cells - i;
        turn[a] = -1;
      }
    }
    return turn;
  }

  /// Adds to the slope of a body's share of space; a falls towards b, b rises away from a.
  static void slope(const Seen& seen, Meeting<Dim>& pair, int body)
  {
    // by the point's place a spline rises towards its node: out of the body
    const bool isFirst = pair.a == body;
    for (int c = 0; c < Dim; ++c)
      pair.normal[isFirst ? 0 : 1][c] += (isFirst ? 1 : -1) * seen.turn[c] * seen.gradient[c];
  }

  static void extend(const MaterialPoints<Dim>& points, std::size_t p, const Seen& seen, Meeting<Dim>& pair, int body)
  {
    using Points = MaterialPoints<Dim>;
    const Matrix<Dim> F = points.matrix(Points::deformations, p);
    const double volume = points.column(Points::volumes)[p];
    const double half = (Dim == 2 ? std::sqrt(volume) : std::cbrt(volume)) / 2;
    for (std::size_t c = 0; c < Meeting<Dim>::candidates; ++c)
    {
      double middle = 0;
      double reach = 0; // of the parallelepiped
      for (int j = 0; j < Dim; ++j)
      {
        double edge = 0;
        for (int i = 0; i < Dim; ++i)
          edge += pair.normal[c][i] * seen.turn[i] * F(i, j);
        reach += half * std::fabs(edge);
        middle += pair.normal[c][j] * seen.turn[j] * seen.offset[j];
      }
      if (pair.a == body)
        pair.end[c] = std::max(pair.end[c], middle + reach);
      else
        pair.begin[c] = std::min(pair.begin[c], middle - reach);
    }
  }

  /// @return whether it has a direction
  static bool normalise(Vector<Dim>& v)
  {
    double square = 0;
    for (int c = 0; c < Dim; ++c)
      square += v[c] * v[c];
    for (int c = 0; c < Dim && square > 0; ++c)
      v[c] /= std::sqrt(square);
    return square > 0;
  }

  const SharedRows<Dim>* rows_; ///< none: all is on this rank
  const BackgroundGrid<Dim>& grid_;
  const Bodies& bodies_;
  std::span<double> nodes_;
  double least_;
  std::vector<std::int32_t> first_; ///< by node: its first meeting; those of a node follow each other
  std::vector<std::uint8_t> near_;  ///< by a point's first node: whether it reaches one of them
  std::vector<Meeting<Dim>> all_;
  std::array<std::vector<std::size_t>, 2> shared_; ///< by side, of all_
};

} // namespace

template <int Dim>
void meet(const BackgroundGrid<Dim>& grid, const Bodies& bodies, const MaterialPoints<Dim>& points,
  std::span<double> nodes, double least, const SharedRows<Dim>* rows)
{
  Meetings<Dim> meetings(grid, bodies, nodes, least, rows);
  meetings.measure(points);
  meetings.collide();
}

template void meet(
  const BackgroundGrid<2>&, const Bodies&, const MaterialPoints<2>&, std::span<double>, double, const SharedRows<2>*);
template void meet(
  const BackgroundGrid<3>&, const Bodies&, const MaterialPoints<3>&, std::span<double>, double, const SharedRows<3>*);

} // namespace lamella::mpm
