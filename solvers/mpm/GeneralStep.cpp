#include "mpm/GeneralStep.h"

#include "core/Error.h"
#include "core/Together.h"
#include "mpm/ShapeFunctions.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace lamella::mpm
{
namespace
{

/// A point seen from the grid: the nodes that it reaches, one after the other.
template <int Dim, class Shape>
class Reach
{
public:
  static constexpr int nodes = Dim == 2 ? Shape::nodes * Shape::nodes : Shape::nodes * Shape::nodes * Shape::nodes;

  /// @param first node of the point's body
  Reach(const BackgroundGrid<Dim>& grid, const Vector<Dim>& x, const Vector<Dim>& width, std::int64_t first)
    : first_(first)
  {
    for (int a = 0; a < Dim; ++a)
    {
      const GridAxis& g = grid.axis(a);
      const double at = g.coordinate(x[a]);
      if (!(at > -2 && at < g.cells + 2)) // also what is not a number
        throw DivergenceError(fmt::format("a point at {} along axis {} is outside the grid, which goes from {} to {} m",
                                x[a], a, g.lower, g.upper()),
          "take a smaller step or slower walls");
      const AxisShape<Shape::nodes> shape = Shape::at(at, width[a]);
      moment_[a] = Shape::moment(shape, at) * g.spacing * g.spacing;
      if (shape.base < -1 || shape.base + Shape::nodes - 1 > g.cells + 1)
        throw DivergenceError(
          fmt::format("a point at {} m along axis {} has passed the grid's end", x[a], a), "take a smaller step");
      for (int k = 0; k < Shape::nodes; ++k)
        axes_[a][static_cast<std::size_t>(k)] = { shape.value[k], shape.gradient[k] / g.spacing,
          g.lower + g.spacing * (shape.base + k) - x[a], (shape.base + k + 1) * grid.stride(a) };
    }
  }

  /// Calls f(value in memory, N, ∇N [1/m], x_i − x [m]) for every node.
  template <class F>
  void forEach(F&& f) const
  {
#pragma GCC unroll 27
    for (int n = 0; n < nodes; ++n)
    {
      std::array<const Node*, Dim> part;
      std::int64_t at = first_;
      Vector<Dim> gradient;
      Vector<Dim> offset;
      double value = 1;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= Shape::nodes)
      {
        part[a] = &axes_[a][static_cast<std::size_t>(rest % Shape::nodes)];
        at += part[a]->at;
        value *= part[a]->value;
        offset[a] = part[a]->offset;
      }
      for (int a = 0; a < Dim; ++a)
      {
        gradient[a] = part[a]->gradient;
        for (int b = 0; b < Dim; ++b)
          if (b != a)
            gradient[a] *= part[b]->value;
      }
      f(static_cast<std::size_t>(at) * nodeValues, value, gradient, offset);
    }
  }
  /// Σ N (x_i − x)² along an axis [m²].
  [[nodiscard]] double moment(int a) const noexcept
  {
    return moment_[a];
  }

private:
  /// A node along an axis.
  struct Node
  {
    double value = 0;
    double gradient = 0; // [1/m]
    double offset = 0;   // from the point [m]
    std::int64_t at = 0; // in the grid
  };

  std::int64_t first_;
  std::array<std::array<Node, Shape::nodes>, Dim> axes_;
  std::array<double, Dim> moment_;
};

template <int Dim, class Shape>
class Step
{
public:
  using Points = MaterialPoints<Dim>;
  using Values = std::vector<double>;

  explicit Step(const GeneralStep<Dim>& given)
    : s_(given)
    , points_(given.points)
    , affine_(given.options.transfer == Transfer::Apic)
  {
    reach_.reserve(points_.count());
    together(given.options.comm,
      [this]
      {
        for (std::size_t p = 0; p < points_.count(); ++p)
          reach_.push_back(reachOf(p));
      });
  }

  double run()
  {
    Values old = zero();
    Values velocity = zero();
    scatter(old, velocity);
    constrain(s_.grid, s_.walls, std::span<double>(velocity), s_.kick, true, s_.rows, &points_);
    if (s_.options.mass == MassMatrix::Consistent)
    {
      solveConsistent(velocity, momentum_, s_.kick, true);
      solveConsistent(old, oldMomentum_, 0, false);
    }
    else
      velocities(old);

    gather(velocity, old);
    const Values* strains = &velocity;
    Values again;
    if (s_.options.update == StressUpdate::ModifiedLast)
    {
      again = zero();
      scatterVelocity(again, true);
      constrain(s_.grid, s_.walls, std::span<double>(again), 1, false, s_.rows);
      strains = &again;
    }
    deform(*strains);
    for (std::size_t p = 0; p < points_.count(); ++p)
      points_.setVector(Points::positions, p, position_[p]);
    return work_;
  }

private:
  using Nodes = Reach<Dim, Shape>;
  static constexpr std::int64_t worth = 2048; // fewer points are done sooner than a second thread wakes up

  [[nodiscard]] Values zero() const
  {
    return Values(static_cast<std::size_t>(s_.walls.bodies.count * s_.grid.count()) * nodeValues);
  }

  [[nodiscard]] Nodes reachOf(std::size_t p) const
  {
    Vector<Dim> width{};
    if constexpr (std::is_same_v<Shape, Gimp>)
    {
      // keeps its share of a cell when the grid follows the walls
      const double volume = points_.column(Points::volumes)[p];
      const double share = (Dim == 2 ? std::sqrt(volume) : std::cbrt(volume)) / s_.options.spacing;
      for (int a = 0; a < Dim; ++a)
        width[a] = std::fmin(1.0, share);
    }
    const auto body = static_cast<std::int64_t>(s_.walls.bodies.of(points_.phase()[p]));
    return Nodes(s_.grid, points_.vector(Points::positions, p), width, body * s_.grid.count());
  }

  /// Calls f(p) for every point, over the threads: of each point alone, so that their number changes nothing.
  template <class F>
  void forPoints(F&& f) const
  {
    const auto count = static_cast<std::int64_t>(points_.count());
#pragma omp parallel for schedule(static) if (count >= worth)
    for (std::int64_t p = 0; p < count; ++p)
      f(static_cast<std::size_t>(p));
  }

  /// Momentum of the points, and with what forces add to it.
  void scatter(Values& old, Values& loaded)
  {
    std::vector<Matrix<Dim>> stress(points_.count());
    forPoints(
      [&](std::size_t p)
      {
        stress[p] = s_.law.kirchhoff(points_.phase()[p], points_.matrix(Points::deformations, p),
          points_.vector(Points::axes, p), points_.memory(p).data());
      });
    const auto mass = points_.column(Points::masses);
    const auto volume = points_.column(Points::volumes);
    for (std::size_t p = 0; p < points_.count(); ++p)
    {
      const Vector<Dim> v = points_.vector(Points::velocities, p);
      const Matrix<Dim> c = points_.affine(p);
      const Matrix<Dim>& tau = stress[p];
      Vector<Dim> body{};
      if (s_.options.acceleration)
        body = s_.options.acceleration(points_.id()[p], s_.time);
      body_.push_back(body);
      for (int a = 0; a < Dim; ++a)
      {
        work_ += mass[p] * body[a] * v[a] * s_.kick / 2;
        body[a] += s_.options.gravity[a];
      }
      reach_[p].forEach(
        [&](std::size_t at, double n, const Vector<Dim>& gradient, const Vector<Dim>& offset)
        {
          old[at] += n * mass[p];
          for (int a = 0; a < Dim; ++a)
          {
            double speed = v[a];
            double force = n * mass[p] * body[a];
            for (int b = 0; b < Dim; ++b)
            {
              if (affine_)
                speed += c(a, b) * offset[b];
              force -= volume[p] * tau(a, b) * gradient[b];
            }
            old[at + 1 + a] += n * mass[p] * speed;
            loaded[at + 1 + a] += s_.kick * force;
          }
        });
    }
    for (std::size_t i = 0; i < old.size(); ++i)
      loaded[i] += old[i];
    if (s_.options.mass == MassMatrix::Consistent)
    {
      momentum_ = loaded;
      oldMomentum_ = old;
    }
  }

  /// Lumped mass and momentum of the points' velocities.
  void scatterVelocity(Values& nodes, bool withAffine) const
  {
    const auto mass = points_.column(Points::masses);
    for (std::size_t p = 0; p < points_.count(); ++p)
    {
      const Vector<Dim> v = points_.vector(Points::velocities, p);
      const Matrix<Dim> c = points_.affine(p);
      reach_[p].forEach(
        [&](std::size_t at, double n, const Vector<Dim>&, const Vector<Dim>& offset)
        {
          nodes[at] += n * mass[p];
          for (int a = 0; a < Dim; ++a)
          {
            double speed = v[a];
            for (int b = 0; b < Dim && affine_ && withAffine; ++b)
              speed += c(a, b) * offset[b];
            nodes[at + 1 + a] += n * mass[p] * speed;
          }
        });
    }
  }

  /// Momentum over mass, no walls: what the points bring.
  static void velocities(Values& nodes)
  {
    for (std::size_t i = 0; i < nodes.size(); i += nodeValues)
      for (int a = 0; a < Dim; ++a)
        nodes[i + 1 + a] = nodes[i] > 0 ? nodes[i + 1 + a] / nodes[i] : 0;
  }

  /// v ← M_L⁻¹ (p − (M − M_L) v), so often.
  void solveConsistent(Values& nodes, const Values& momentum, double kick, bool walls)
  {
    if (!walls)
      velocities(nodes);
    for (int term = 1; term < s_.options.massTerms; ++term)
    {
      Values next = momentum;
      for (std::size_t p = 0; p < points_.count(); ++p)
      {
        const Vector<Dim> v = valueAt(nodes, p);
        const double mass = points_.column(Points::masses)[p];
        reach_[p].forEach(
          [&](std::size_t at, double n, const Vector<Dim>&, const Vector<Dim>&)
          {
            for (int a = 0; a < Dim; ++a)
              next[at + 1 + a] += n * mass * (nodes[at + 1 + a] - v[a]);
          });
      }
      if (walls)
        constrain(s_.grid, s_.walls, std::span<double>(next), kick, true);
      else
        velocities(next);
      nodes = std::move(next);
    }
  }

  [[nodiscard]] Vector<Dim> valueAt(const Values& nodes, std::size_t p) const
  {
    Vector<Dim> v{};
    reach_[p].forEach(
      [&](std::size_t at, double n, const Vector<Dim>&, const Vector<Dim>&)
      {
        for (int a = 0; a < Dim; ++a)
          v[a] += n * nodes[at + 1 + a];
      });
    return v;
  }

  /// What of the points' velocities the grid does not see: (1 − S S⁺)ᵐ v.
  void removeUnseen()
  {
    Points& points = points_;
    std::vector<Vector<Dim>> given(points.count());
    for (std::size_t p = 0; p < points.count(); ++p)
      given[p] = points.vector(Points::velocities, p);
    Walls<Dim> walls = s_.walls;
    for (int m = 0; m < s_.options.xpicOrder; ++m)
    {
      Values nodes = zero();
      scatterVelocity(nodes, false);
      constrain(s_.grid, walls, std::span<double>(nodes), 1, false);
      for (std::size_t p = 0; p < points.count(); ++p)
      {
        Vector<Dim> v = points.vector(Points::velocities, p);
        const Vector<Dim> seen = valueAt(nodes, p);
        for (int a = 0; a < Dim; ++a)
          v[a] -= seen[a];
        points.setVector(Points::velocities, p, v);
      }
      for (int axis = 0; axis < Dim; ++axis) // what is left vanishes at walls
        for (int side = 0; side < 2; ++side)
          walls(axis, side).velocity = 0;
    }
    for (std::size_t p = 0; p < points.count(); ++p)
    {
      const Vector<Dim> unseen = points.vector(Points::velocities, p);
      for (int a = 0; a < Dim; ++a)
        given[p][a] -= unseen[a];
      points.setVector(Points::velocities, p, given[p]);
    }
  }

  /// Velocities of the points from the grid, and where they go.
  void gather(const Values& velocity, const Values& old)
  {
    const Transfer transfer = s_.options.transfer;
    if (transfer == Transfer::Xpic)
      removeUnseen();
    position_.resize(points_.count());
    if (affine_)
      points_.storeAffines();
    forPoints(
      [&](std::size_t p)
      {
        Vector<Dim> v = points_.vector(Points::velocities, p);
        const Vector<Dim> seen = valueAt(velocity, p);
        if (transfer == Transfer::Flip || transfer == Transfer::Xpic)
        {
          const Vector<Dim> before = valueAt(old, p);
          for (int a = 0; a < Dim; ++a)
            v[a] += seen[a] - before[a];
        }
        else
          v = seen;
        if (affine_)
          points_.setAffine(p, affineOf(velocity, p));
        position_[p] = points_.vector(Points::positions, p);
        for (int a = 0; a < Dim; ++a)
          position_[p][a] += s_.dt * seen[a];
        points_.setVector(Points::velocities, p, v);
      });
    for (std::size_t p = 0; p < points_.count() && s_.options.acceleration; ++p)
      for (int a = 0; a < Dim; ++a)
        work_ +=
          points_.column(Points::masses)[p] * body_[p][a] * points_.column(Points::velocities + a)[p] * s_.kick / 2;
  }

  /// Σ v_i ⊗ N (x_i − x) / moments. Hat functions: its limit, the gradient, since their moments can vanish.
  [[nodiscard]] Matrix<Dim> affineOf(const Values& nodes, std::size_t p) const
  {
    Matrix<Dim> c{};
    reach_[p].forEach(
      [&](std::size_t at, double n, const Vector<Dim>& gradient, const Vector<Dim>& offset)
      {
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b)
            c(a, b) += nodes[at + 1 + a] * (Shape::nodes == 2 ? gradient[b] : n * offset[b] / reach_[p].moment(b));
      });
    return c;
  }

  void deform(const Values& velocity)
  {
    forPoints(
      [&](std::size_t p)
      {
        Matrix<Dim> update{};
        reach_[p].forEach(
          [&](std::size_t at, double, const Vector<Dim>& gradient, const Vector<Dim>&)
          {
            for (int a = 0; a < Dim; ++a)
              for (int b = 0; b < Dim; ++b)
                update(a, b) += s_.dt * velocity[at + 1 + a] * gradient[b];
          });
        const Matrix<Dim> before = points_.matrix(Points::deformations, p);
        Matrix<Dim> F = product(update, before);
        for (int i = 0; i < Dim * Dim; ++i)
          F.m[i] += before.m[i];
        auto memory = points_.memory(p);
        s_.law.flow(points_.phase()[p], F, points_.vector(Points::axes, p), memory.data());
        for (int h = 0; h < points_.history(); ++h)
          points_.column(Points::histories + h)[p] = memory[static_cast<std::size_t>(h)];
        points_.setMatrix(Points::deformations, p, F);
      });
  }

  const GeneralStep<Dim>& s_;
  Points& points_;
  bool affine_;
  std::vector<Nodes> reach_;
  std::vector<Vector<Dim>> position_;
  std::vector<Vector<Dim>> body_; // accelerations other than gravity
  double work_ = 0;               // of theirs, with the mean of the velocities before and after
  Values momentum_;
  Values oldMomentum_;
};

} // namespace

template <int Dim>
double GeneralStep<Dim>::run() const
{
  switch (options.shape)
  {
    case Shape::Linear:
      return Step<Dim, Linear>(*this).run();
    case Shape::Gimp:
      return Step<Dim, Gimp>(*this).run();
    case Shape::QuadraticSpline:
      return Step<Dim, QuadraticSpline>(*this).run();
  }
  return 0;
}

template struct GeneralStep<2>;
template struct GeneralStep<3>;

} // namespace lamella::mpm
