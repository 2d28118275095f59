// Run time against error of steady diffusion: disk arrays beside the multipole values, and a tissue whose limit comes
// from the finest refinements by Richardson's rule with the observed order. CSV on standard output.
#include "generators/Generators.h"
#include "lattice/Error.h"
#include "lbm/SteadyDiffusion.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include <sys/resource.h>

namespace
{

using namespace lamella;

double userSeconds()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

struct Timed
{
  double value;
  double seconds;
};

Timed solve(const PhaseImage& image, const std::vector<double>& d, lbm::Stencil stencil, lbm::Sides sides)
{
  lbm::SteadyOptions options;
  options.stencil = stencil;
  options.sides = sides;
  const double start = userSeconds();
  lbm::SteadyDiffusion solver(image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, d, options);
  const double value = solver.solve(0).effective[0];
  return { value, userSeconds() - start };
}

void disks()
{
  struct Case
  {
    double fraction, s, exact;
  };
  // square array of disks, Perrins et al., Proc. R. Soc. A 369 (1979) 207, more digits by multipoles
  const Case cases[] = { { 0.3, 10, 1.65204 }, { 0.5, 0.1, 0.41400 }, { 0.5, 50, 2.91459 }, { 0.7, 10, 4.06171 } };
  for (const auto& c : cases)
    for (const auto stencil : { lbm::Stencil::D2Q5, lbm::Stencil::D2Q9 })
      for (const std::int64_t n : { 32, 64, 128, 256, 512, 1024 })
      {
        const auto image = generators::inclusionArray(2, { n, n, 1 }, 1.0, c.fraction, 1);
        const Timed t = solve(image, { 1.0, c.s }, stencil, lbm::Sides::Periodic);
        fmt::print("disks f={} s={},{},{},{:.8f},{:+.3e},{:.4f}\n", c.fraction, c.s, lbm::name(stencil), n, t.value,
          t.value / c.exact - 1, t.seconds);
        std::fflush(stdout);
      }
}

void tissue()
{
  generators::SoftwoodOptions o;
  o.solidFraction = 0.40;
  const auto image = generators::softwood(o);
  for (const bool heat : { true, false })
  {
    const std::vector<double> d = heat ? std::vector<double>{ 0.023, 1.0 } : std::vector<double>{ 1.0, 0.004 };
    for (const auto stencil : { lbm::Stencil::D2Q5, lbm::Stencil::D2Q9 })
    {
      std::vector<Timed> runs;
      for (const int n : { 1, 2, 4, 8 })
        runs.push_back(solve(refine(image, n), d, stencil, lbm::Sides::Insulated));
      const double ratio = (runs[2].value - runs[1].value) / (runs[3].value - runs[2].value);
      const double limit = runs[3].value + (runs[3].value - runs[2].value) / (ratio - 1);
      for (std::size_t i = 0; i < runs.size(); ++i)
        fmt::print("softwood 200^2 {},{},{},{:.8f},{:+.3e},{:.4f}\n", heat ? "heat" : "vapour", lbm::name(stencil),
          200 << i, runs[i].value, runs[i].value / limit - 1, runs[i].seconds);
      fmt::print("# observed order {:.2f}, limit {:.6f}\n", std::log2(ratio), limit);
      std::fflush(stdout);
    }
  }
}

} // namespace

int main()
try
{
  fmt::print("case,lattice,nodes a side,effective conductivity,relative error,user CPU [s]\n");
  disks();
  tissue();
  return 0;
}
catch (const lamella::Error& e)
{
  fmt::print(stderr, "error: {}\nhint: {}\n", e.what(), e.hint());
  return 1;
}
