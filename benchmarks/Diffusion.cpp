// Run time against error of steady diffusion, in tables. study=
//   heat, vapour  the square array of disks beside its multipole values: disks 0.023 in a matrix of 1 (lumens in walls,
//                 for heat), and 1 in 0.004 (for vapour)
//   spheres       the simple cubic array of spheres, ten times the matrix, beside its multipole value
//   softwood-heat, softwood-vapour  200 x 200 pixels and their refinements, beside the limit that Richardson's rule
//                 gives with the observed order; and what the first paper's own method takes on it
// none: all. Keys: quick, slow (the paper's method on softwood for vapour too, and with tau = 1 for heat: many
// minutes), limit=SECONDS that no run shall be longer than (5; quick: 1), fraction=AREA of the disks (0.6),
// output=FOLDER for CSV files (default results/bench-diffusion). Processor time of set-up and solve on one thread,
// median of several where it is short; pictures are made beforehand, lattices of outlines within.
#include "Keys.h"
#include "Table.h"

#include "../tests/verification/DiskArray.h"

#include "generators/Generators.h"
#include "lbm/ContourDiffusion.h"
#include "lbm/SteadyDiffusion.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

struct Timed
{
  double value = 0;
  double seconds = 0;
  std::int64_t steps = 0; ///< of stepping
};

/// Median of the time over three runs and a tenth of a second; a second and more is measured once.
template <class Run>
Timed timed(Run&& run)
{
  Timed result;
  std::vector<double> seconds;
  double total = 0;
  do
  {
    const double start = cpu();
    run(result);
    seconds.push_back(cpu() - start);
    total += seconds.back();
  } while (total < 1 && (seconds.size() < 3 || total < 0.1));
  result.seconds = median(seconds);
  return result;
}

double value(const PhaseImage& image, const std::vector<double>& d, lbm::Stencil stencil,
  std::shared_ptr<const lbm::LinkTable> links = nullptr)
{
  lbm::SteadyOptions options;
  options.stencil = stencil;
  options.links = std::move(links);
  options.fieldTolerance = std::numeric_limits<double>::infinity(); // the value alone is wanted, by all methods
  lbm::SteadyDiffusion solver(image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, d, options);
  return solver.solve(0).effective[0];
}

Timed steady(const PhaseImage& image, const std::vector<double>& d, lbm::Stencil stencil)
{
  return timed([&](Timed& result) { result.value = value(image, d, stencil); });
}

/// @param relaxation τ − ½ of the phase that conducts best; 0: chosen
Timed stepping(const PhaseImage& image, const std::vector<double>& d, lbm::Stencil stencil, lbm::Collision collision,
  double relaxation)
{
  return timed(
    [&](Timed& result)
    {
      lbm::SteppingOptions options;
      options.stencil = stencil;
      options.collision = collision;
      options.relaxation = relaxation;
      options.steady = true;
      lbm::LatticeBoltzmann solver(
        image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, d, options, MPI_COMM_SELF);
      // an order below the error of the pixels, which is what a user would do
      const lbm::RestResult rest = solver.rest({ .tolerance = 1e-4, .maxSteps = 100'000'000 });
      result.value = rest.effective;
      result.steps = rest.steps;
    });
}

// ---------------------------------------------------------------------------------------------------------------------

/// An array whose effective value is known.
struct Scene
{
  const char* name;
  int dimension;
  double fraction;
  std::vector<double> d; ///< matrix, inclusion
  double exact;
};

class Study
{
public:
  Study(const Keys& keys, Scene scene)
    : scene_(std::move(scene))
    , limit_(number(keys, "limit", keys.contains("quick") ? 1 : 5))
    , table_(keys, "diffusion", scene_.name, "scene,method,stencil,nodes,value,error,cpu_seconds")
  {
    fmt::print("{}: exact {:.8g}\n{:22} {:6} {:>5}  {:>12} {:>10} {:>10}\n", scene_.name, scene_.exact, "method",
      "lattice", "nodes", "value", "error", "CPU [s]");
  }

  [[nodiscard]] PhaseImage picture(std::int64_t n) const
  {
    return generators::inclusionArray(
      scene_.dimension, { n, n, scene_.dimension == 3 ? n : 1 }, 1.0, scene_.fraction, 1);
  }

  /// Larger and larger pictures, until the next run would take longer than the limit.
  /// @param growth by how much at least the time grows with twice the nodes across
  void series(const char* method, lbm::Stencil stencil, double growth,
    const std::function<Timed(const PhaseImage&)>& run, bool extrapolated = false)
  {
    Timed last;
    for (std::int64_t n = 8; n <= (scene_.dimension == 3 ? 128 : 2048) && growth * last.seconds < limit_; n *= 2)
    {
      const Timed now = run(picture(n));
      line(method, stencil, n, now.value, now.seconds);
      if (extrapolated && n > 8)
        line("pixels extrapolated", stencil, n, 2 * now.value - last.value, now.seconds + last.seconds);
      last = now;
    }
  }

  void pictures(lbm::Stencil straight, lbm::Stencil diagonal)
  {
    const double cells = scene_.dimension == 3 ? 8 : 4;
    for (const auto stencil : { straight, diagonal })
    {
      series(
        "steady", stencil, cells, [&](const PhaseImage& i) { return steady(i, scene_.d, stencil); },
        stencil == straight);
      // steps grow with the nodes across where waves carry the field, and with their square where it diffuses
      series("TRT stepping", stencil, 2 * cells,
        [&](const PhaseImage& i) { return stepping(i, scene_.d, stencil, lbm::Collision::TRT, 0); });
    }
    for (const double tau : { 1.0, 5.0 })
      series(tau < 2 ? "BGK stepping tau 1" : "BGK stepping tau 5", diagonal, 4 * cells,
        [&](const PhaseImage& i) { return stepping(i, scene_.d, diagonal, lbm::Collision::BGK, tau - 0.5); });
  }

  /// Lattices from the outline, with the links' conductivities; and both lattices of a study, extrapolated.
  void outlines()
  {
    const micrograph::ContourSet disk = test::squareOfDisk(scene_.fraction, 1.0);
    const std::vector<double> d{ scene_.d[1], scene_.d[0] }; // the disk is the lumen
    Timed last;
    for (std::int64_t n = 8; n <= 2048 && 4 * last.seconds < limit_; n *= 2)
    {
      const Timed now = timed(
        [&](Timed& result)
        {
          micrograph::ContourLatticeOptions make;
          make.spacing = 1.0 / static_cast<double>(n);
          make.lines = 1;
          make.across = true;
          make.grain = false;
          const micrograph::ContourLattice lattice = micrograph::contourLattice(disk, make);
          result.value =
            value(lattice.image, d, lbm::Stencil::D2Q5, std::make_shared<lbm::LinkTable>(lbm::linksOf(lattice, d, 0)));
        });
      line("outlines", lbm::Stencil::D2Q5, n, now.value, now.seconds);
      if (n > 8)
        line("outlines extrapolated", lbm::Stencil::D2Q5, n, 2 * now.value - last.value, now.seconds + last.seconds);
      last = now;
    }
  }

private:
  void line(const char* method, lbm::Stencil stencil, std::int64_t n, double value, double seconds)
  {
    const double error = value / scene_.exact - 1;
    table_.line(scene_.name, method, lbm::name(stencil), n, value, error, seconds);
    fmt::print("{:22} {:6} {:5}  {:12.8f} {:+10.2e} {:10.4g}\n", method, lbm::name(stencil), n, value, error, seconds);
    std::fflush(stdout);
  }

  Scene scene_;
  double limit_;
  Table table_;
};

void disks(const Keys& keys, bool heat)
{
  const double f = number(keys, "fraction", 0.6);
  const double matrix = heat ? 1 : 0.004;
  const double disk = heat ? 0.023 : 1;
  Study study(
    keys, { heat ? "heat" : "vapour", 2, f, { matrix, disk }, matrix * test::squareArrayOfDisks(f, disk / matrix) });
  study.pictures(lbm::Stencil::D2Q5, lbm::Stencil::D2Q9);
  study.outlines();
}

void spheres(const Keys& keys)
{
  // volume fraction 0.3: 1.8877 by multipoles, five digits
  Study study(keys, { "spheres", 3, 0.3, { 1, 10 }, 1.8877 });
  study.pictures(lbm::Stencil::D3Q7, lbm::Stencil::D3Q19);
}

// ---------------------------------------------------------------------------------------------------------------------

void softwood(const Keys& keys, bool heat)
{
  const bool quick = keys.contains("quick");
  generators::SoftwoodOptions o;
  o.solidFraction = 0.40;
  const PhaseImage image = generators::softwood(o);
  const std::string scene = heat ? "softwood-heat" : "softwood-vapour";
  const std::vector<double> d = heat ? std::vector<double>{ 0.023, 1.0 } : std::vector<double>{ 1.0, 0.004 };
  Table table(keys, "diffusion", scene, "scene,method,stencil,nodes,value,error,cpu_seconds,steps");
  double limit = 0;
  const auto line = [&](const char* method, lbm::Stencil stencil, std::int64_t n, const Timed& t)
  {
    table.line(scene, method, lbm::name(stencil), n, t.value, t.value / limit - 1, t.seconds, t.steps);
    fmt::print("{:15} {:18} {} {:5}  {:.8f} {:+.2e} {:10.4g} s {:9} steps\n", scene, method, lbm::name(stencil), n,
      t.value, t.value / limit - 1, t.seconds, t.steps);
    std::fflush(stdout);
  };
  for (const auto stencil : { lbm::Stencil::D2Q9, lbm::Stencil::D2Q5 })
  {
    std::vector<Timed> runs;
    for (const int n : quick ? std::vector<int>{ 1, 2, 4 } : std::vector<int>{ 1, 2, 4, 8 })
      runs.push_back(steady(refine(image, n), d, stencil));
    const std::size_t last = runs.size() - 1;
    const double change = runs[last].value - runs[last - 1].value;
    const double ratio = (runs[last - 1].value - runs[last - 2].value) / change;
    limit = runs[last].value + change / (ratio - 1);
    for (std::size_t i = 0; i < runs.size(); ++i)
      line("steady", stencil, 200 << i, runs[i]);
    fmt::print("observed order {:.2f}, limit {:.6f}\n", std::log2(ratio), limit);
  }
  // beside D2Q5's limit, all of them
  for (const auto stencil : { lbm::Stencil::D2Q5, lbm::Stencil::D2Q9 })
    line("TRT stepping", stencil, 200, stepping(image, d, stencil, lbm::Collision::TRT, 0));
  const auto single = [&](const char* method, double tau)
  { line(method, lbm::Stencil::D2Q9, 200, stepping(image, d, lbm::Stencil::D2Q9, lbm::Collision::BGK, tau - 0.5)); };
  const bool slow = keys.contains("slow");
  if (!quick && (heat || slow))
    single("BGK stepping tau 5", 5);
  if (heat && slow)
    single("BGK stepping tau 1", 1);
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "heat", [](const Keys& keys) { disks(keys, true); } },
      { "vapour", [](const Keys& keys) { disks(keys, false); } }, { "spheres", spheres },
      { "softwood-heat", [](const Keys& keys) { softwood(keys, true); } },
      { "softwood-vapour", [](const Keys& keys) { softwood(keys, false); } } });
}
