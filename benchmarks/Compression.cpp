// Compression by material points: run time against error, in tables. study=
//   motion     a manufactured solution at strains of 6 and 31 %: shapes, transfers, spacing, points a cell
//   tissue     generated earlywood: first slope and plateau over spacing and points a cell; the finest is the reference
//   speed      the first slope and the plateau over the speed, from rest and from an even start, and over the energy
//              ratio that the control allows
//   precision  the points' state in double and in single: a bar that vibrates, and the tissue's slope and plateau
//   stiffness  implicit against explicit
//   stability  what is pressed to 90 %, thin walls, points a cell, contrast of two phases, points that leave an open
//   grid
// none: all. Keys: quick, output=FOLDER for CSV files (default results/bench-compression). Processor time of all
// threads.
#include "Keys.h"
#include "Table.h"

#include "../tests/verification/ManufacturedMotion.h"

#include "generators/Generators.h"
#include "mpm/PointCompression.h"
#include "mpm/PointStiffness.h"
#include "mpm/WallCells.h"
#include "mpm/WallMaterial.h"
#include "outlines/ContourLattice.h"
#include "outlines/PolygonFile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::mpm;

// ---------------------------------------------------------------------------------------------------------------------

void motion(const Keys& keys)
{
  using namespace samples;
  const bool quick = keys.contains("quick");
  Table table(keys, "compression", "motion", "amplitude,shape,transfer,cells,per_cell,error,cpu_seconds");
  fmt::print("Manufactured solution: root mean square error of the displacement at its largest, over its amplitude\n"
             "strain  shape    transfer  cells  a cell      error     CPU\n");
  const std::pair<const char*, Shape> shapes[] = { { "linear", Shape::Linear }, { "GIMP", Shape::Gimp },
    { "spline", Shape::QuadraticSpline } };
  const std::pair<const char*, Transfer> transfers[] = { { "APIC", Transfer::Apic }, { "FLIP", Transfer::Flip },
    { "XPIC", Transfer::Xpic } };
  for (const double amplitude : { 0.01, 0.05 })
    for (const auto& [shape, kind] : shapes)
      for (const auto& [transfer, way] : transfers)
        for (const int per : { 2, 3 })
          for (const int cells : { 16, 32, 64 })
          {
            if ((quick && cells > 32) || (way != Transfer::Apic && (per == 3 || kind != Shape::QuadraticSpline)))
              continue;
            const double from = cpu();
            double error = std::nan("");
            try
            {
              error = manufactured(cells, amplitude, { kind, way }, per);
            }
            catch (const DivergenceError&)
            {
            } // hats with lumped mass may: the table then says nan
            const double seconds = cpu() - from;
            fmt::print("{:4.0f} %  {:8} {:8} {:6} {:7} {:10.2e} {:7.2f} s\n", 200 * 3.14159265 * amplitude, shape,
              transfer, cells, per * per, error, seconds);
            std::fflush(stdout);
            table.line(amplitude, shape, transfer, cells, per * per, error, seconds);
          }
}

// ---------------------------------------------------------------------------------------------------------------------

std::shared_ptr<const PointLaw<2>> wall()
{
  return makeLaw<2, Isotropic>({ isotropicConstants<2>(IsotropicMaterial{}) });
}

/// Generated earlywood, 150 µm each way, at a spacing of so many nodes across.
PhaseImage earlywood(int nodes, double solid = 0.3)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = 150e-6 / nodes;
  o.solidFraction = solid;
  o.rayEvery = 0;
  return generators::softwood(o);
}

/// Earlywood of spruce, 60 µm each way of the outlines of Ferrara and Wittel.
PhaseImage spruce(const char* folder)
{
  micrograph::PolygonReadOptions part;
  part.window = { 100, 80, 160, 140 }; // [µm]
  const std::filesystem::path file = std::filesystem::path(folder) / "spruce_EW_polygons.json.gz";
  micrograph::ContourLatticeOptions o;
  o.spacing = 0.5e-6;
  return micrograph::contourLattice(micrograph::readPolygons(file, part).lumens, o).image;
}

/// @param per points along each direction of a cell of the grid, whose cells are `cells` nodes wide
CompressionOptions<2> specimen(const Lattice& lattice, double cells)
{
  CompressionOptions<2> o;
  for (std::size_t a = 0; a < 2; ++a)
  {
    o.lower[a] = lattice.origin[a] - lattice.spacing / 2;
    o.upper[a] = o.lower[a] + lattice.spacing * static_cast<double>(lattice.size[a]);
  }
  o.axis = 0; // radial
  o.motion.spacing = cells * lattice.spacing;
  return o;
}

MaterialPoints<2> pointsOf(const PhaseImage& image, int perNode)
{
  PointOptions o;
  o.perNode = perNode;
  return pointsFromLattice<2>(image.lattice, image.phase, {}, o);
}

struct Pressed
{
  double slope = 0;   ///< by regression, 0.3 to 1.5 % [Pa]
  double plateau = 0; ///< mean stress, 5 to 15 % [Pa]
  double ratio = 0;
  double imbalance = 0;
  std::int64_t steps = 0;
  double seconds = 0;
  std::size_t points = 0;
};

Pressed press(const MaterialPoints<2>& points, const CompressionOptions<2>& options)
{
  const double from = cpu();
  PointCompression<2> c(points, wall(), options);
  c.run();
  Pressed p;
  p.seconds = cpu() - from;
  p.points = points.count();
  const CompressionSummary s = c.summary();
  p.ratio = s.worstRatio;
  p.imbalance = s.worstImbalance;
  p.steps = s.steps;
  double n = 0;
  double x = 0;
  double y = 0;
  double xx = 0;
  double xy = 0;
  double sum = 0;
  double count = 0;
  for (const CompressionRow& r : c.rows())
  {
    if (r.strain > 0.003 && r.strain < 0.0151)
    {
      n += 1;
      x += r.strain;
      y += r.stress;
      xx += r.strain * r.strain;
      xy += r.strain * r.stress;
    }
    if (r.strain > 0.05 && r.strain < 0.15)
    {
      sum += r.stress;
      count += 1;
    }
  }
  p.slope = (n * xy - x * y) / (n * xx - x * x);
  p.plateau = count > 0 ? sum / count : std::nan("");
  return p;
}

double implicitModulus(const MaterialPoints<2>& points, const CompressionOptions<2>& o, double& seconds)
{
  const double from = cpu();
  PointStiffnessOptions<2> s;
  s.lower = o.lower;
  s.upper = o.upper;
  s.spacing = o.motion.spacing;
  s.sides = { BoxSides::Walls, BoxSides::Walls };
  const double modulus = pointStiffness(points, *wall(), s).along(o.axis).modulus;
  seconds = cpu() - from;
  return modulus;
}

void tissue(const Keys& keys)
{
  const bool quick = keys.contains("quick");
  const int finest = quick ? 200 : 400;
  Table table(keys, "compression", "tissue", "spacing,per_cell,points,slope,plateau,steps,cpu_seconds");
  fmt::print("\nGenerated earlywood, 150 µm, pressed to 16 %: the picture at its finest; cells of the grid coarser\n"
             "spacing  a cell   points      slope    plateau    steps      CPU\n");
  const PhaseImage image = earlywood(finest);
  constexpr std::pair<double, int> grids[] = { { 1, 3 }, { 1, 2 }, { 1.5, 2 }, { 2, 2 }, { 2, 1 } };
  for (const auto& [cells, per] : grids)
  {
    CompressionOptions<2> o = specimen(image.lattice, cells);
    o.strain = 0.16;
    o.rows = 320;
    const Pressed p = press(pointsOf(image, per), o);
    const double each = per * per * cells * cells;
    fmt::print("{:5.2f} µm {:7.2g} {:8} {:6.1f} MPa {:6.2f} MPa {:8} {:6.1f} s\n", 1e6 * cells * image.lattice.spacing,
      each, p.points, p.slope / 1e6, p.plateau / 1e6, p.steps, p.seconds);
    std::fflush(stdout);
    table.line(cells * image.lattice.spacing, each, p.points, p.slope, p.plateau, p.steps, p.seconds);
  }
}

void speed(const Keys& keys)
{
  const int nodes = keys.contains("quick") ? 150 : 250;
  Table table(keys, "compression", "speed",
    "start,speed,energy_ratio,slope,plateau,worst_ratio,worst_imbalance,steps,cpu_seconds");
  fmt::print("\nSpeed: over the wall's waves, or as the energy ratio allows; slope over the implicit one\n"
             "start   speed      slope    plateau  kinetic/elastic  platens differ    steps      CPU\n");
  const PhaseImage image = earlywood(nodes);
  const MaterialPoints<2> points = pointsOf(image, 2);
  CompressionOptions<2> o = specimen(image.lattice, 1);
  o.strain = 0.16;
  o.rows = 320;
  double seconds = 0;
  const double modulus = implicitModulus(points, o, seconds);
  fmt::print("implicit solve: {:.2f} MPa, {:.2f} s\n", modulus / 1e6, seconds);
  table.line("implicit", "", "", modulus, "", "", "", "", seconds);
  const auto show = [&](const std::string& start, const std::string& how, double share, double ratio, const Pressed& p)
  {
    fmt::print("{:6} {:>8} {:8.4f} {:8.2f} MPa {:14.2e} {:14.1f} % {:9} {:6.1f} s\n", start, how, p.slope / modulus,
      p.plateau / 1e6, p.ratio, 100 * p.imbalance, p.steps, p.seconds);
    std::fflush(stdout);
    table.line(start, share, ratio, p.slope, p.plateau, p.ratio, p.imbalance, p.steps, p.seconds);
  };
  for (const bool even : { false, true })
    for (const double share : { 0.01, 0.003, 0.001 })
    {
      CompressionOptions<2> given = o;
      given.affineStart = even;
      given.firstSpeed = given.leastSpeed = given.mostSpeed = share;
      show(even ? "even" : "rest", fmt::format("{:.2g} %", 100 * share), share, 0, press(points, given));
    }
  for (const double ratio : { 0.1, 0.01, 0.001 })
  {
    CompressionOptions<2> given = o;
    given.energyRatio = ratio;
    show("even", fmt::format("r {:g}", ratio), 0, ratio, press(points, given));
  }
}

void precision(const Keys& keys)
{
  const bool quick = keys.contains("quick");
  const std::pair<const char*, Precision> precisions[] = { { "double", Precision::Double },
    { "single", Precision::Single } };
  Table bars(keys, "compression", "precision-bar", "precision,cells,error,energy,cpu_seconds");
  fmt::print("\nA bar that vibrates, strain 1e-4, splines, APIC, 4 points a cell: root mean square error of its mean\n"
             "velocity over two periods, over its amplitude; energy at the end over that at the start\n"
             "precision  cells      error    energy     CPU\n");
  for (const int cells : { 8, 16, 32, 64 })
    for (const auto& [name, kind] : precisions)
    {
      samples::Method method;
      method.precision = kind;
      const double from = cpu();
      const samples::BarResult r = samples::vibrate(cells, method);
      const double seconds = cpu() - from;
      fmt::print("{:9} {:6} {:10.5f} {:9.5f} {:7.2f} s\n", name, cells, r.error, r.energy, seconds);
      std::fflush(stdout);
      bars.line(name, cells, r.error, r.energy, seconds);
    }
  Table table(keys, "compression", "precision",
    "tissue,precision,per_cell,points,slope,plateau,worst_ratio,worst_imbalance,steps,cpu_seconds");
  fmt::print("\nEarlywood pressed to 16 %: generated, 150 µm; of spruce, 60 µm\n"
             "tissue     precision  a cell   points      slope    plateau  kinetic/elastic    steps      CPU\n");
  const auto compare = [&](const char* tissue, const PhaseImage& image, int axis, int per)
  {
    for (const auto& [name, kind] : precisions)
    {
      CompressionOptions<2> o = specimen(image.lattice, 1);
      o.axis = axis;
      o.strain = 0.16;
      o.rows = 320;
      o.motion.precision = kind;
      const Pressed p = press(pointsOf(image, per), o);
      fmt::print("{:10} {:9} {:7} {:8} {:6.2f} MPa {:6.3f} MPa {:16.2e} {:8} {:6.1f} s\n", tissue, name, per * per,
        p.points, p.slope / 1e6, p.plateau / 1e6, p.ratio, p.steps, p.seconds);
      std::fflush(stdout);
      table.line(tissue, name, per * per, p.points, p.slope, p.plateau, p.ratio, p.imbalance, p.steps, p.seconds);
    }
  };
  if (const char* const folder = std::getenv("LAMELLA_REAL_DATA"))
    compare("spruce", spruce(folder), 1, 3);
  else
    fmt::print("(no tissue of spruce: LAMELLA_REAL_DATA is not set)\n");
  for (const int per : { 2, 3, 4 })
    compare("generated", earlywood(quick ? 150 : 250), 0, per);
}

void stiffness(const Keys& keys)
{
  Table table(keys, "compression", "stiffness", "nodes,points,implicit,implicit_seconds,explicit,explicit_seconds");
  fmt::print("\nStiffness: implicit, and the slope up to 0.3 % of slow explicit runs (energy ratio 1e-4)\n"
             "nodes    points   implicit      CPU   explicit      CPU   over\n");
  for (const int nodes : { 100, 150, 200 })
  {
    if (nodes > 150 && keys.contains("quick"))
      continue;
    const PhaseImage image = earlywood(nodes);
    const MaterialPoints<2> points = pointsOf(image, 2);
    CompressionOptions<2> o = specimen(image.lattice, 1);
    double seconds = 0;
    const double modulus = implicitModulus(points, o, seconds);
    o.strain = 0.003;
    o.rows = 30;
    o.energyRatio = 1e-4;
    const double from = cpu();
    PointCompression<2> c(points, wall(), o);
    c.run();
    double xy = 0;
    double xx = 0;
    for (const CompressionRow& r : c.rows())
    {
      xy += r.strain * r.stress;
      xx += r.strain * r.strain;
    }
    const double spent = cpu() - from;
    fmt::print("{:5} {:9} {:6.2f} MPa {:6.2f} s {:6.2f} MPa {:6.1f} s {:8.4f}\n", nodes, points.count(), modulus / 1e6,
      seconds, xy / xx / 1e6, spent, xy / xx / modulus);
    std::fflush(stdout);
    table.line(nodes, points.count(), modulus, seconds, xy / xx, spent);
  }
}

// ---------------------------------------------------------------------------------------------------------------------

/// Runs what may fail, and says how it ended.
void attempt(const std::string& what, const std::function<std::string()>& run)
{
  std::string end;
  try
  {
    end = run();
  }
  catch (const Error& e)
  {
    end = fmt::format("refused or ended: {}", e.what());
  }
  fmt::print("{:44} {}\n", what, end);
  std::fflush(stdout);
}

std::string howItWent(const PointCompression<2>& c)
{
  const CompressionSummary s = c.summary();
  const CompressionRow& r = c.rows().back();
  return fmt::format("to {:.0f} %: {:.3g} MPa, kinetic/elastic {:.1e}, energy lost {:.1f} %, {} steps", 100 * s.strain,
    r.stress / 1e6, s.worstRatio, 100 * r.dissipated / r.work, s.steps);
}

void stability(const Keys& keys)
{
  const bool quick = keys.contains("quick");
  fmt::print("\nStability\n");
  const PhaseImage image = earlywood(quick ? 80 : 120);
  for (const double strain : { 0.5, 0.7, 0.9 })
    attempt(fmt::format("pressed to {:.0f} %", 100 * strain),
      [&]
      {
        CompressionOptions<2> o = specimen(image.lattice, 1);
        o.strain = strain;
        PointCompression<2> c(pointsOf(image, 2), wall(), o);
        c.run();
        return howItWent(c);
      });
  for (const int per : { 1, 3, 4 })
    attempt(fmt::format("{} points a cell, to 30 %", per * per),
      [&]
      {
        CompressionOptions<2> o = specimen(image.lattice, 1);
        o.strain = 0.3;
        o.leastSpeed = 5e-4; // one point a cell comes apart, and then waits for an elastic energy that is not there
        PointCompression<2> c(pointsOf(image, per), wall(), o);
        c.run();
        return howItWent(c);
      });
  for (const double cells : { 2.0, 4.0 })
    attempt(fmt::format("cells {} nodes wide, to 30 %", cells),
      [&]
      {
        CompressionOptions<2> o = specimen(image.lattice, cells);
        o.strain = 0.3;
        PointCompression<2> c(pointsOf(image, 1), wall(), o);
        c.run();
        const std::string warning =
          wallWarning(wallCells(image.lattice, image.phase, 0, cells * image.lattice.spacing));
        return howItWent(c) + (warning.empty() ? "" : "; warned: " + warning);
      });
  for (const double contrast : { 10.0, 1e3, 1e5 })
    attempt(fmt::format("a second phase {:g} times as soft, to 30 %", contrast),
      [&]
      {
        PhaseImage two = image; // lumens filled
        for (auto& phase : two.phase)
          phase = phase == 0 ? 2 : 1;
        CompressionOptions<2> o = specimen(two.lattice, 1);
        o.strain = 0.3;
        const auto stiff = isotropicConstants<2>(IsotropicMaterial{});
        IsotropicMaterial soft;
        soft.youngsModulus /= contrast;
        PointCompression<2> c(
          pointsOf(two, 2), makeLaw<2, Isotropic>({ stiff, stiff, isotropicConstants<2>(soft) }), o);
        c.run();
        return howItWent(c);
      });
  for (const double share : { 0.05, 0.2 })
    attempt(fmt::format("platens at {:.0f} % of the wave's speed", 100 * share),
      [&]
      {
        CompressionOptions<2> o = specimen(image.lattice, 1);
        o.strain = 0.3;
        o.firstSpeed = o.leastSpeed = o.mostSpeed = share;
        PointCompression<2> c(pointsOf(image, 2), wall(), o);
        c.run();
        return howItWent(c);
      });
  attempt("a step 1.01 times the stable one",
    [&]
    {
      CompressionOptions<2> o = specimen(image.lattice, 1);
      PointCompression<2> c(pointsOf(image, 2), wall(), o);
      o.motion.step = 1.01 * c.body().stableStep();
      PointCompression<2> d(pointsOf(image, 2), wall(), o);
      return std::string("ran");
    });
  attempt("points that leave an open grid",
    [&]
    {
      PointDynamicsOptions<2> o;
      o.spacing = image.lattice.spacing;
      MaterialPoints<2> points = pointsOf(image, 2);
      for (std::size_t p = 0; p < points.count(); ++p)
        points.column(MaterialPoints<2>::velocities)[p] = p % 2 == 0 ? 1e4 : -1e4;
      PointDynamics<2> body(std::move(points), wall(), o);
      body.advance(2000);
      return fmt::format("{} steps", body.steps());
    });
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      const std::pair<const char*, void (*)(const Keys&)> studies[] = { { "motion", motion }, { "tissue", tissue },
        { "speed", speed }, { "precision", precision }, { "stiffness", stiffness }, { "stability", stability } };
      const std::string wanted = text(keys, "study", "");
      bool found = wanted.empty();
      for (const auto& [name, study] : studies)
        if (wanted.empty() || wanted == name)
        {
          study(keys);
          found = true;
        }
      if (!found)
        throw ParameterError("no study '" + wanted + "'", "motion, tissue, speed, precision, stiffness or stability");
    });
}
