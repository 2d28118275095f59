// Point updates a second of the explicit steps: fused kernels by law, precision, points a cell and dimension, and the
// plain path; a full block and one with two thirds of its cells empty, as tissue has. Processor time of all threads;
// median of seven.
//   quick      smaller blocks, fewer repetitions
#include "Keys.h"
#include "MaterialPointBlock.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "mpm/Isotropic.h"
#include "mpm/NeoHookean.h"
#include "mpm/WallMaterial.h"
#include "mpm/kernels/PointKernels.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::mpm;

struct Rates
{
  double processor = 0; ///< millions of updates a second of processor time
  double wall = 0;
  std::size_t points = 0;
  std::size_t bytes = 0; ///< a point
};

template <int Dim>
Rates measure(std::shared_ptr<const PointLaw<Dim>> law, double stiffness, int cells, int perCell, bool porous,
  bool fused, int steps, int repeats, Precision precision = Precision::Double)
{
  const auto body = block<Dim>(std::move(law), stiffness, cells, perCell, porous, fused, Communicator(), precision);
  Rates rates;
  rates.points = body->points().count();
  rates.bytes = body->points().bytes() / rates.points;
  body->advance(steps);
  std::vector<double> processor;
  std::vector<double> wall;
  for (int r = 0; r < repeats; ++r)
  {
    const auto from = Clock::now();
    const double t = cpu();
    body->advance(steps);
    const double updates = static_cast<double>(rates.points) * steps / 1e6;
    processor.push_back(updates / (cpu() - t));
    wall.push_back(updates / secondsSince(from));
  }
  rates.processor = median(processor);
  rates.wall = median(wall);
  return rates;
}

void print(const std::string& what, const Rates& r)
{
  fmt::print("{:52} {:8}  {:9.1f} {:9.1f}  {:5}\n", what, r.points, r.processor, r.wall, r.bytes);
}

} // namespace

int main(int argc, char** argv)
{
  return told(
    [&]
    {
      const bool quick = keysOf(argc, argv).count("quick") != 0;
      const int repeats = quick ? 3 : 7;
      const int cells = quick ? 112 : 224;
      const double young = OrthotropicMaterial{}.along;
      const PointKernels& kernels = pointKernels();
      fmt::print("Quadratic splines, lumped mass, APIC, double unless said; kernels {} with {} lanes for {} cell(s) at "
                 "once; {} thread(s)\n"
                 "millions of point updates a second                     points  processor      wall  bytes\n",
        kernels.name, kernels.lanes, kernels.cells, omp_get_max_threads());
      for (const int perCell : { 2, 3, 4 })
      {
        const int side = cells * 2 / perCell;
        const int steps = quick ? 10 : 20;
        for (const bool porous : { false, true })
          for (const Precision precision : { Precision::Double, Precision::Single })
            print(fmt::format("orthotropic, {}, {} a cell{}", porous ? "porous" : "full", perCell * perCell,
                    precision == Precision::Single ? ", single" : ""),
              measure<2>(wood<2>(), young, side, perCell, porous, true, steps, repeats, precision));
      }
      const auto isotropic = makeLaw<2, Isotropic>({ isotropicConstants<2>(IsotropicMaterial{}) });
      const auto rubber = makeLaw<2, NeoHookean>({ { young / 2, young / 3 } });
      print("isotropic, full, 4 a cell", measure<2>(isotropic, young, cells, 2, false, true, 20, repeats));
      print("neo-Hookean, full, 4 a cell", measure<2>(rubber, young, cells, 2, false, true, 20, repeats));
      const double yields = 1e-3 * young;
      const PlasticMaterial ductile{ { .youngsModulus = young }, yields, 0 };
      const OrthotropicPlasticMaterial wall{ .yieldStress = yields, .yieldAcross = 0.4 * yields };
      const auto ductileInPlane = makeLaw<2, Hencky>({ henckyConstants(ductile) });
      const auto wallInPlane = makeLaw<2, Hill>({ hillConstants(wall) });
      for (const bool porous : { false, true })
      {
        const char* const how = porous ? "porous" : "full";
        print(fmt::format("isotropic, yielding, {}, 4 a cell", how),
          measure<2>(ductileInPlane, young, cells, 2, porous, true, 20, repeats));
        print(fmt::format("orthotropic, yielding, {}, 4 a cell", how),
          measure<2>(wallInPlane, young, cells, 2, porous, true, 20, repeats));
      }
      print("orthotropic, yielding, full, 4 a cell, plain path",
        measure<2>(wallInPlane, young, cells / 4, 2, false, false, 5, 3));
      print("orthotropic, full, 4 a cell, plain path", measure<2>(wood<2>(), young, cells / 4, 2, false, false, 5, 3));
      const int edge = quick ? 16 : 28;
      const auto inSpace = [&](const std::string& what, const std::shared_ptr<const PointLaw<3>>& law, bool porous,
                             Precision precision = Precision::Double)
      {
        print(fmt::format("{}, in space, {}, 8 a cell{}", what, porous ? "porous" : "full",
                precision == Precision::Single ? ", single" : ""),
          measure<3>(law, young, porous ? edge * 11 / 7 : edge, 2, porous, true, 10, repeats, precision));
      };
      for (const bool porous : { false, true })
      {
        for (const Precision precision : { Precision::Double, Precision::Single })
          inSpace("orthotropic", wood<3>(), porous, precision);
        for (const Precision precision : { Precision::Double, Precision::Single })
          inSpace(
            "isotropic", makeLaw<3, Isotropic>({ isotropicConstants<3>(IsotropicMaterial{}) }), porous, precision);
        inSpace("neo-Hookean", makeLaw<3, NeoHookean>({ { young / 2, young / 3 } }), porous);
        inSpace("isotropic, yielding", makeLaw<3, Hencky>({ henckyConstants(ductile) }), porous);
        inSpace("orthotropic, yielding", makeLaw<3, Hill>({ hillConstants(wall) }), porous);
      }
    });
}
