#pragma once

#include "LatticeBoltzmann.h"
#include "core/Error.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

/// Odd pictures, what diffusion is on them, and how the solvers end there.
namespace lamella::test
{

struct OddPicture
{
  std::string name;
  PhaseImage image; ///< of phases 0 and 1
};

inline PhaseImage paint(std::int64_t nx, std::int64_t ny, std::int64_t nz,
  const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& second)
{
  PhaseImage image = noise(nx, ny, nz, -1.0, 1); // all of the first phase
  for (std::int64_t z = 0, i = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x, ++i)
        image.phase[static_cast<std::size_t>(i)] = second(x, y, z) ? 1 : 0;
  return image;
}

/// Along x, the direction of the flux.
inline std::vector<OddPicture> oddPictures(int dimension)
{
  const std::int64_t deep = dimension == 3 ? 3 : 1;
  // down at x = 2, back up at x = 6: every link of it counts
  const auto path = [](std::int64_t x, std::int64_t y, std::int64_t z)
  { return z == 0 && (x == 2 || x == 6 ? y >= 1 && y <= 4 : y == (x > 2 && x < 6 ? 4 : 1)); };
  const auto middle = [](std::int64_t x, std::int64_t, std::int64_t) { return x >= 4; };
  // a row that leads across, and squares that lead nowhere
  const auto pieces = [](std::int64_t x, std::int64_t y, std::int64_t z)
  { return z == 0 && (y == 0 || (x % 4 > 1 && y % 4 > 1)); };
  PhaseImage node = paint(1, 1, 1, [](auto...) { return true; });
  node.lattice = makeLattice(1, 1, 1, dimension, 1.0);
  return {
    { "one node", node },
    { "one wide", paint(1, 8, deep, [](std::int64_t, std::int64_t y, std::int64_t) { return y >= 4; }) },
    { "one high", paint(8, 1, deep, middle) },
    { "first alone", paint(8, 6, deep, [](auto...) { return false; }) },
    { "second alone", paint(8, 6, deep, [](auto...) { return true; }) },
    { "single path", paint(9, 6, deep, path) },
    { "prime sizes", noise(11, 7, dimension == 3 ? 5 : 1, 0.5, 5) },
    { "checkerboard",
      paint(8, 6, deep, [](std::int64_t x, std::int64_t y, std::int64_t z) { return (x + y + z) % 2 == 1; }) },
    { "line", paint(8, 6, deep, [](std::int64_t, std::int64_t y, std::int64_t z) { return y == 2 && z == 0; }) },
    { "isolated pieces", paint(9, 8, deep, pieces) },
    { "layers", paint(8, 3, deep, middle) },
  };
}

/// The picture and its mirror image in the planes of its outer nodes: in this cell of a medium the values on those
/// planes are given and nothing crosses those along the flux, as bgk has it.
inline PhaseImage mirrored(const PhaseImage& image)
{
  const auto& n = image.lattice.size;
  const auto cell = [&](std::size_t a) { return n[a] > 1 ? 2 * (n[a] - 1) : 1; };
  const auto fold = [&](std::int64_t p, std::size_t a) { return std::min(p, cell(a) - p); };
  return paint(cell(0), cell(1), cell(2),
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    { return image.phase[static_cast<std::size_t>(image.lattice.index(fold(x, 0), fold(y, 1), fold(z, 2)))] == 1; });
}

/// Conductivity along x by the definition: every link of two-relaxation-time lattice Boltzmann at rest, 6 w times the
/// harmonic mean (12 w times the one value to a face), in one dense system. 0 where nothing leads across.
inline double directValue(
  const PhaseImage& image, const std::vector<double>& d, bool diagonal, lbm::Sides sides = lbm::Sides::Insulated)
{
  using Real = long double; // the condition is the contrast times the square of the nodes across
  const auto& n = image.lattice.size;
  const bool space = image.lattice.dimension == 3;
  const bool periodic = sides == lbm::Sides::Periodic;
  const Real straight = !diagonal ? 1 : space ? 1 / Real(3) : 2 / Real(3);
  const Real slanted = diagonal ? 1 / Real(6) : 0;

  struct Link
  {
    std::int64_t from, to; ///< to: −1 the face of value 1, −2 that of value 0
    Real g;
    Real jump; ///< by how much the value beyond a periodic side is lower
  };
  std::vector<Link> links; // from each end
  const auto at = [&](std::int64_t i) { return static_cast<Real>(d[image.phase[static_cast<std::size_t>(i)]]); };
  for (std::int64_t z = 0, i = 0; z < n[2]; ++z)
    for (std::int64_t y = 0; y < n[1]; ++y)
      for (std::int64_t x = 0; x < n[0]; ++x, ++i)
        for (std::int64_t c = 0; c < 27; ++c)
        {
          const std::array<std::int64_t, 3> step{ c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1 };
          const auto length = std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]);
          if (length == 0 || length > 2 || (step[2] != 0 && !space) || at(i) == 0)
            continue;
          const Real weight = length == 1 ? straight : slanted;
          std::array<std::int64_t, 3> p{ x + step[0], y + step[1], z + step[2] };
          Real jump = 0;
          if (!periodic && (p[0] < 0 || p[0] >= n[0]))
          {
            links.push_back({ i, p[0] < 0 ? -1 : -2, 2 * weight * at(i), 0 });
            continue;
          }
          for (std::size_t a = 0; a < 3; ++a)
            if (p[a] < 0 || p[a] >= n[a])
            {
              jump += periodic && a == 0 ? Real(p[a] < 0 ? -1 : 1) : 0;
              p[a] = periodic ? (p[a] + n[a]) % n[a] : std::clamp<std::int64_t>(p[a], 0, n[a] - 1); // specular
            }
          const std::int64_t to = image.lattice.index(p[0], p[1], p[2]);
          if (at(to) > 0 && weight > 0 && (to != i || jump != 0))
            links.push_back({ i, to, weight * 2 / (1 / at(i) + 1 / at(to)), jump });
        }

  // nodes that hang on a face; of periodic pieces all but one, whose value is free
  const auto count = static_cast<std::size_t>(image.lattice.count());
  std::vector<bool> known(count, false);
  std::vector<std::int64_t> unknown(count, -1);
  std::int64_t size = 0;
  const auto spread = [&]
  {
    for (bool more = true; more;)
    {
      more = false;
      for (const Link& l : links)
        if (!known[static_cast<std::size_t>(l.from)] && (l.to < 0 || known[static_cast<std::size_t>(l.to)]))
        {
          known[static_cast<std::size_t>(l.from)] = more = true;
          unknown[static_cast<std::size_t>(l.from)] = size++;
        }
    }
  };
  spread();
  for (std::size_t i = 0; periodic && i < count; ++i)
    if (!known[i])
    {
      known[i] = true;
      spread();
    }
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  Matrix a = Matrix::Zero(size, size);
  Vector b = Vector::Zero(size);
  const auto place = [&](std::int64_t node) { return node < 0 ? -1 : unknown[static_cast<std::size_t>(node)]; };
  for (const Link& l : links)
    if (const std::int64_t row = place(l.from); row >= 0)
    {
      a(row, row) += l.g;
      b[row] += l.g * ((l.to == -1 ? 1 : 0) - l.jump);
      if (const std::int64_t column = place(l.to); column >= 0)
        a(row, column) -= l.g;
    }
  const Vector u = size > 0 ? Vector(a.ldlt().solve(b)) : Vector();
  const auto valueAt = [&](std::int64_t node) { return node == -1 ? 1 : place(node) >= 0 ? u[place(node)] : Real(0); };
  Real energy = 0;
  for (const Link& l : links)
    if (l.to < 0 || known[static_cast<std::size_t>(l.from)])
    {
      const Real fall = valueAt(l.from) - valueAt(l.to) + l.jump;
      energy += (l.to < 0 ? 1 : Real(0.5)) * l.g * fall * fall;
    }
  const double value = static_cast<double>(energy * n[0] / (n[1] * n[2]));
  const double largest = *std::max_element(d.begin(), d.end());
  return value > 1e-13 * largest ? value : 0; // what leads nowhere carries round-off; what does, 1e-6 over the nodes
}

enum class Verdict
{
  Right,   ///< as near to the right answer as was asked for
  Slow,    ///< it says that it needs more steps
  Warned,  ///< not so near, and it said that it would not be
  Refused, ///< by an exception of ours, which says why
  Wrong    ///< not so near, and nothing was said
};
inline const char* name(Verdict verdict)
{
  constexpr std::array<const char*, 5> names{ "right", "slow", "warned", "refused", "wrong" };
  return names.at(static_cast<std::size_t>(verdict));
}

struct Outcome
{
  Verdict verdict = Verdict::Wrong;
  double error = 0; ///< relative, of the effective value and the flux through each face the largest
  std::string what; ///< warning or message
};

/// Runs `f`, which fills the outcome; what it throws becomes the verdict.
template <class F>
Outcome judged(F&& f)
{
  Outcome out;
  try
  {
    f(out);
  }
  catch (const lbm::StepLimitError& e)
  {
    out = { Verdict::Slow, 0, e.what() };
  }
  catch (const Error& e)
  {
    out = { Verdict::Refused, 0, e.what() };
  }
  return out;
}

/// The largest relative error of these against the right value; a value where there should be none is wholly wrong.
inline double worstOf(double right, std::initializer_list<double> values)
{
  double worst = 0;
  for (const double v : values)
    worst = std::max(worst, right > 0 ? std::fabs(v / right - 1) : 1.0);
  return worst;
}

struct Trial
{
  lbm::Stencil stencil = lbm::Stencil::D2Q5;
  Collision collision = Collision::TRT;
  double relaxation = 0.5;
  std::vector<double> diffusivity;
  double tolerance = 1e-6; ///< of the flux: RestOptions
  double accuracy = 1e-5;  ///< of the effective value, to be right
  std::int64_t maxSteps = 2000;
};

/// Steps to rest along x between faces of value 1 and 0 and insulated sides, against the steady solver.
inline Outcome attempt(const PhaseImage& image, const Trial& t)
{
  const bool diagonal = t.stencil == lbm::Stencil::D2Q9 || t.stencil == lbm::Stencil::D3Q19;
  return judged(
    [&](Outcome& out)
    {
      SteppingOptions o;
      o.stencil = t.stencil;
      o.collision = t.collision;
      o.relaxation = t.relaxation;
      o.steady = true;
      auto solver = stepper(image, t.diffusivity, o);
      out.what = solver.warning();
      const auto r = solver.rest({ .tolerance = t.tolerance, .maxSteps = t.maxSteps });
      const double k = t.collision == Collision::BGK
        ? solve(mirrored(image), t.diffusivity, { .sides = lbm::Sides::Periodic, .diagonal = diagonal }).effective[0]
        : solve(image, t.diffusivity, { .diagonal = diagonal }).effective[0];
      out.error = worstOf(k, { r.effective, r.inletFlux, r.outletFlux });
      out.verdict = out.error <= t.accuracy ? Verdict::Right : out.what.empty() ? Verdict::Wrong : Verdict::Warned;
    });
}

/// The steady solver along x, against the dense system.
inline Outcome attemptSteady(const PhaseImage& image, const std::vector<double>& d, Case c, double accuracy)
{
  return judged(
    [&](Outcome& out)
    {
      const lbm::SteadyResult r = solve(image, d, c);
      const double k = directValue(image, d, c.diagonal, c.sides);
      out.error = worstOf(k, { r.effective[0], r.inletFlux, r.outletFlux });
      out.verdict = out.error <= accuracy ? Verdict::Right : Verdict::Wrong;
    });
}

} // namespace lamella::test
