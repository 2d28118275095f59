// Steady diffusion: user CPU of set-up and solve on generated softwood, heat and vapour, one direction, until each
// face's flux is within 1e-8 of its limit; beside Jacobi-preconditioned conjugate gradients on the same system in the
// same run, which is what PuMA does. Medians of several runs; peers' own figures are in docs/benchmarks/diffusion.md.
#include "Timing.h"

#include "generators/Generators.h"
#include "lbm/SteadyDiffusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

constexpr std::uint64_t seed = 1;

PhaseImage softwood(int dimension, std::int64_t n)
{
  generators::SoftwoodOptions o;
  o.dimension = dimension;
  o.size = { n, n, dimension == 3 ? n : 1 };
  o.solidFraction = 0.40;
  o.seed = seed;
  return generators::softwood(o);
}

// The straightforward way: 5- or 7-point links, double precision, Jacobi-preconditioned conjugate gradients, until the
// flux through both faces is within 1e-8 of `limit`.
struct Plain
{
  double seconds = 0;
  int iterations = 0;
};

Plain jacobiConjugateGradients(const PhaseImage& image, const std::vector<double>& d, double limit)
{
  const auto& l = image.lattice;
  const auto n = static_cast<std::size_t>(l.count());
  const std::array<std::size_t, 3> step{ 1, static_cast<std::size_t>(l.size[0]),
    static_cast<std::size_t>(l.size[0] * l.size[1]) };
  const double start = userSeconds();
  std::vector<std::vector<double>> link(static_cast<std::size_t>(l.dimension), std::vector<double>(n, 0.0));
  std::vector<double> diagonal(n, 0.0);
  std::vector<double> b(n, 0.0);
  const auto nx = static_cast<std::size_t>(l.size[0]);
  for (std::size_t i = 0; i < n; ++i)
  {
    const std::array<std::size_t, 3> p{ i % nx, i / step[1] % static_cast<std::size_t>(l.size[1]), i / step[2] };
    const double di = d[image.phase[i]];
    for (std::size_t a = 0; a < link.size(); ++a)
      if (p[a] + 1 < static_cast<std::size_t>(l.size[a]))
      {
        const double dj = d[image.phase[i + step[a]]];
        link[a][i] = 2 * di * dj / (di + dj);
        diagonal[i] += link[a][i];
        diagonal[i + step[a]] += link[a][i];
      }
    if (p[0] == 0)
    {
      diagonal[i] += 2 * di;
      b[i] = 2 * di;
    }
    if (p[0] + 1 == nx)
      diagonal[i] += 2 * di;
  }
  const auto multiply = [&](const std::vector<double>& u, std::vector<double>& out)
  {
    for (std::size_t i = 0; i < n; ++i)
      out[i] = diagonal[i] * u[i];
    for (std::size_t a = 0; a < link.size(); ++a)
      for (std::size_t i = 0; i + step[a] < n; ++i)
      {
        out[i] -= link[a][i] * u[i + step[a]];
        out[i + step[a]] -= link[a][i] * u[i];
      }
  };
  std::vector<double> u(n);
  std::vector<double> r(n);
  std::vector<double> p(n);
  std::vector<double> q(n);
  for (std::size_t i = 0; i < n; ++i)
    u[i] = 1 - (static_cast<double>(i % nx) + 0.5) / static_cast<double>(nx);
  multiply(u, q);
  double rz = 0;
  for (std::size_t i = 0; i < n; ++i)
  {
    r[i] = b[i] - q[i];
    p[i] = r[i] / diagonal[i];
    rz += r[i] * p[i];
  }
  Plain result;
  const double faces = static_cast<double>(n) / static_cast<double>(nx);
  for (; result.iterations < 100000; ++result.iterations)
  {
    double in = 0;
    double out = 0;
    for (std::size_t i = 0; i < n; i += nx)
    {
      in += 2 * d[image.phase[i]] * (1 - u[i]);
      out += 2 * d[image.phase[i + nx - 1]] * u[i + nx - 1];
    }
    const double scale = static_cast<double>(nx) / faces;
    if (std::max(std::abs(in * scale - limit), std::abs(out * scale - limit)) <= 1e-8 * limit)
      break;
    multiply(p, q);
    double pq = 0;
    for (std::size_t i = 0; i < n; ++i)
      pq += p[i] * q[i];
    const double alpha = rz / pq;
    double next = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      u[i] += alpha * p[i];
      r[i] -= alpha * q[i];
      next += r[i] * r[i] / diagonal[i];
    }
    const double beta = next / rz;
    rz = next;
    for (std::size_t i = 0; i < n; ++i)
      p[i] = r[i] / diagonal[i] + beta * p[i];
  }
  result.seconds = userSeconds() - start;
  return result;
}

// Effective value and both faces within 1e-8; then, too, the field within 1e-6 in the energy norm, as it is written to
// files.
void measure(const char* label, const PhaseImage& image, double lumen, double wall, int runs, bool plain)
{
  const std::vector<double> d{ lumen, wall };
  const Block block = decompose(image.lattice, MPI_COMM_SELF);
  std::string text;
  double user = 0;
  lbm::SteadyResult result;
  for (const double fieldTolerance : { std::numeric_limits<double>::infinity(), 1e-6 })
  {
    std::vector<double> seconds;
    for (int i = 0; i < runs; ++i)
    {
      lbm::SteadyOptions options;
      options.stencil = image.lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
      options.fieldTolerance = fieldTolerance;
      const double start = userSeconds();
      lbm::SteadyDiffusion solver(image.lattice, block, image.phase, d, options);
      result = solver.solve(0);
      seconds.push_back(userSeconds() - start);
    }
    if (text.empty())
      user = median(seconds);
    text += fmt::format("{:>9.4f} s {:>3} it {:.1e}", median(seconds), result.iterations, result.solverError);
  }
  std::string ratio = "-";
  if (plain)
  {
    const Plain p = jacobiConjugateGradients(image, d, result.effective[0]);
    ratio = fmt::format("{:.3g} s {} it, {:.0f} x", p.seconds, p.iterations, p.seconds / user);
  }
  fmt::print("{:<15}{}  {:>5.1f}  {}\n", label, text,
    static_cast<double>(result.bytes) / static_cast<double>(result.nodes), ratio);
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  return told(
    [&]
    {
      const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
      fmt::print("softwood, solid fraction 0.40, seed {}, along x; user CPU of set-up and solve, median\n", seed);
      fmt::print("{:<15}{:<29}{:<29}{}\n", "", "value and faces to 1e-8", "the field to 1e-6 as well",
        "B/node  Jacobi-CG, value and faces");
      const PhaseImage a = softwood(2, 200);
      measure("200^2 heat", a, 0.023, 1, 21, true);
      measure("200^2 vapour", a, 1, 0.004, 21, true);
      const PhaseImage b = softwood(2, 1024);
      measure("1024^2 heat", b, 0.023, 1, 5, !quick);
      measure("1024^2 vapour", b, 1, 0.004, 5, false);
      const PhaseImage c = softwood(3, 200);
      measure("200^3 heat", c, 0.023, 1, quick ? 1 : 5, false);
      measure("200^3 vapour", c, 1, 0.004, quick ? 1 : 5, false);
    });
}
