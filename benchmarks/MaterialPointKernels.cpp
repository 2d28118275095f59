// Point updates a second of the explicit steps: fused kernels by law, points a cell and dimension, and the plain path;
// a full block and one with two thirds of its cells empty, as tissue has. Processor time of all threads; median of
// seven.
//   quick      smaller blocks, fewer repetitions
#include "Keys.h"

#include "lattice/Error.h"
#include "mpm/Isotropic.h"
#include "mpm/NeoHookean.h"
#include "mpm/Orthotropic.h"
#include "mpm/PointDynamics.h"
#include "mpm/WallMaterial.h"
#include "mpm/kernels/PointKernels.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::mpm;

struct Rates
{
  double processor = 0; ///< millions of updates a second of processor time
  double wall = 0;
  std::size_t points = 0;
  std::size_t bytes = 0; ///< a point
};

/// A block of unit cells between platens that close slowly; of `porous` ones, walls two cells thick around lumens of 9
/// × 4.
template <int Dim>
Rates measure(std::shared_ptr<const PointLaw<Dim>> law, double stiffness, int cells, int perCell, bool porous,
  bool fused, int steps, int repeats)
{
  const Lattice lattice = makeLattice(cells, cells, Dim == 3 ? cells : 1, Dim, 1);
  std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()), 1);
  std::vector<std::array<float, Dim>> axis(phase.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
  {
    const auto n = static_cast<std::int64_t>(i);
    const std::int64_t x = n % cells;
    const std::int64_t y = n / cells % cells;
    if (porous && x % 11 >= 2 && y % 6 >= 2)
      phase[i] = 0;
    axis[i] = {};
    axis[i][0] = std::cos(0.3F * std::sin(0.1F * static_cast<float>(x)));
    axis[i][1] = std::sin(0.3F * std::sin(0.1F * static_cast<float>(x)));
  }
  PointOptions made;
  made.perNode = perCell;
  made.density = { 1 };
  MaterialPoints<Dim> points = pointsFromLattice<Dim>(lattice, phase, axis, made);
  Rates rates;
  rates.points = points.count();
  rates.bytes = points.bytes() / points.count();

  PointDynamicsOptions<Dim> options;
  options.spacing = 1;
  options.fused = fused;
  const double speed = 0.01 * std::sqrt(stiffness); // of the wave's
  for (auto& side : options.sides)
    side = { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, static_cast<double>(cells) } };
  options.sides[0] = { Side{ Edge::Wall, 0, 0, true }, Side{ Edge::Wall, static_cast<double>(cells), 0, true } };
  options.sides[1][1].velocity = -speed;
  PointDynamics<Dim> body(std::move(points), std::move(law), options);
  body.advance(steps);
  std::vector<double> processor;
  std::vector<double> wall;
  for (int r = 0; r < repeats; ++r)
  {
    const auto from = std::chrono::steady_clock::now();
    const double t = benchmark::cpu();
    body.advance(steps);
    const double updates = static_cast<double>(rates.points) * steps / 1e6;
    processor.push_back(updates / (benchmark::cpu() - t));
    wall.push_back(updates / std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count());
  }
  const auto median = [](std::vector<double>& v)
  {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  rates.processor = median(processor);
  rates.wall = median(wall);
  return rates;
}

template <int Dim>
std::shared_ptr<const PointLaw<Dim>> wood()
{
  return makeLaw<Dim, Orthotropic>({ orthotropicConstants<Dim>(OrthotropicMaterial{}) });
}

void print(const std::string& what, const Rates& r)
{
  fmt::print("{:52} {:8}  {:9.1f} {:9.1f}  {:5}\n", what, r.points, r.processor, r.wall, r.bytes);
}

} // namespace

int main(int argc, char** argv)
{
  try
  {
    const bool quick = benchmark::keysOf(argc, argv).count("quick") != 0;
    const int repeats = quick ? 3 : 7;
    const int cells = quick ? 112 : 224;
    const double young = OrthotropicMaterial{}.along;
    const PointKernels& kernels = pointKernels();
    fmt::print("Quadratic splines, lumped mass, APIC, double; kernels {} with {} or {} lanes; {} thread(s)\n"
               "millions of point updates a second                     points  processor      wall  bytes\n",
      kernels.name, kernels.lanes[0], kernels.lanes[1], omp_get_max_threads());
    for (const int perCell : { 2, 3, 4 })
    {
      const int side = cells * 2 / perCell;
      const int steps = quick ? 10 : 20;
      const std::string each = fmt::format(", {} a cell", perCell * perCell);
      print("orthotropic, full" + each, measure<2>(wood<2>(), young, side, perCell, false, true, steps, repeats));
      print("orthotropic, porous" + each, measure<2>(wood<2>(), young, side, perCell, true, true, steps, repeats));
    }
    const auto isotropic = makeLaw<2, Isotropic>({ isotropicConstants<2>(IsotropicMaterial{}) });
    const auto rubber = makeLaw<2, NeoHookean>({ { young / 2, young / 3 } });
    print("isotropic, full, 4 a cell", measure<2>(isotropic, young, cells, 2, false, true, 20, repeats));
    print("neo-Hookean, full, 4 a cell", measure<2>(rubber, young, cells, 2, false, true, 20, repeats));
    print("orthotropic, full, 4 a cell, plain path", measure<2>(wood<2>(), young, cells / 4, 2, false, false, 5, 3));
    print("orthotropic, in space, full, 8 a cell",
      measure<3>(wood<3>(), young, quick ? 16 : 28, 2, false, true, 10, repeats));
    print("neo-Hookean, in space, full, 8 a cell",
      measure<3>(
        makeLaw<3, NeoHookean>({ { young / 2, young / 3 } }), young, quick ? 16 : 28, 2, false, true, 10, repeats));
  }
  catch (const Error& e)
  {
    fmt::print(stderr, "error: {}\nhint: {}\n", e.what(), e.hint());
    return 1;
  }
  return 0;
}
