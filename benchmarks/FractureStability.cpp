// What quasi-static fracture stands: contrast of moduli and of critical elongations, horizons, porosity, notches,
// tolerances. Each sample is pulled apart by the strict events' method and by the accurate one; a line says how it
// ended, what the strengths differ by, and what is wrong with the curve, if anything is. A sample that cannot be pulled
// gives its one line of error. Without arguments all of it; study=contrast, elongation, horizon, porosity, notch or
// tolerance one of it.
#include "../tests/DiskPlate.h"
#include "FractureRuns.h"

#include <cmath>
#include <cstdio>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::breakable;
using namespace lamella::peridynamics;

constexpr double spacing = 1e-3;
constexpr double young = 2e9;
constexpr double stretch = 5e-3;

DiskPlate small(double porosity, bool singleNodes = false)
{
  return { .nx = 40, .ny = 60, .porosity = porosity, .singleNodes = singleNodes };
}

/// Stiff disks in a soft matrix, with holes and notches.
struct Trial
{
  double contrast = 4;   ///< of Young's moduli, disks over matrix
  double elongation = 1; ///< of critical elongations, disks over matrix
  double horizon = 3;
  DiskPlate plate = small(0.2);
  double notch = 0.2; ///< its length over the width
  int notches = 1;    ///< at even distances
  FractureOptions options{};
};

Sample sampleOf(const Trial& t)
{
  DiskPlate plate = t.plate;
  plate.platen = std::llround(std::ceil(t.horizon));
  Sample s{ makeLattice(plate.nx, plate.ny, 1, 2, spacing), phasesOf(plate), {}, {} };
  s.model.horizon = t.horizon;
  const BondMaterial soft{ .youngsModulus = young, .criticalStretch = stretch };
  s.model.pairs[{ 1, 1 }].material = soft;
  s.model.pairs[{ 1, 2 }].material = soft;
  s.model.pairs[{ 2, 2 }].material = { .youngsModulus = t.contrast * young, .criticalStretch = t.elongation * stretch };
  const double width = static_cast<double>(plate.nx) * spacing;
  const double height = static_cast<double>(plate.ny) * spacing;
  for (int i = 1; i <= t.notches && t.notch > 0; ++i)
    s.model.notches.push_back({ { 0, height * i / (t.notches + 1), 0 }, { t.notch * width, 0, 0 }, {} });
  return s;
}

/// What a curve under a rising strain cannot be; empty: nothing.
std::string wrongWith(const FractureRecord& r)
{
  if (!(std::isfinite(r.peak.stress) && r.peak.stress > 0 && r.modulus > 0))
    return "no strength";
  if (r.peak.stress < (1 - 1e-6) * r.first.stress)
    return "peak below the first break";
  double strain = 0;
  for (const CurvePoint& p : r.curve)
  {
    // In an avalanche events are corrected to a residual of 1e-4: a ligament that lets go may come out with as much.
    if (!std::isfinite(p.stress) || p.stress < -1e-3 * r.peak.stress)
      return fmt::format("stress {:.3g} at strain {:.3g} after {} bonds", p.stress, p.strain, p.broken);
    if (p.strain < (1 - 1e-9) * strain)
      return fmt::format("strain falls from {:.9g} to {:.9g}", strain, p.strain);
    if (p.stress > 1.001 * r.modulus * p.strain) // bonds only go: never stiffer than whole
      return "stiffer than the whole sample";
    strain = p.strain;
  }
  return {};
}

void line(const std::string& name, const Trial& t)
{
  fmt::print("{:<26}", name);
  try
  {
    const Sample s = sampleOf(t);
    const Run events = quasiStatic(s, t.options);
    FractureOptions o = t.options;
    o.method = FractureMethod::Accurate;
    const Run accurate = quasiStatic(s, o);
    const FractureRecord& e = events.record;
    const FractureRecord& a = accurate.record;
    const double share = common(bondsOf(a.broken), bondsOf(e.broken));
    std::string remark = wrongWith(e);
    if (remark.empty())
      remark = wrongWith(a);
    if (remark.empty() && e.end != FractureEnd::StressFell && e.end != FractureEnd::Severed)
      remark = describe(e.end); // which is an end, too
    fmt::print(" {:>6} {:>6} {:>11.4e} {:>+10.1e} {:>6.1f} % {:>7.2f} {:>7.2f}  {}\n", e.broken.size(), a.broken.size(),
      a.peak.stress, e.peak.stress / a.peak.stress - 1, 100 * share, events.seconds(), accurate.seconds(), remark);
  }
  catch (const Error& e)
  {
    fmt::print(" {}\n", e.what());
  }
  std::fflush(stdout);
}

void header(const char* what)
{
  fmt::print("\n{:<26} {:>6} {:>6} {:>11} {:>10} {:>8} {:>7} {:>7}\n", what, "events", "accur.", "peak [Pa]", "events'",
    "bonds", "CPU [s]", "accur.");
}

void contrast(const Keys&)
{
  header("contrast of moduli");
  for (const double c : { 1e-6, 1e-4, 1e-2, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6 })
    line(fmt::format("{:g}", c), { .contrast = c });
}

void elongation(const Keys&)
{
  header("contrast of elongations");
  for (const double e : { 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6 })
    line(fmt::format("{:g}", e), { .elongation = e });
  for (const double e : { 1e-3, 1e3 }) // one toughness
    line(fmt::format("{:g}, moduli 1 : {:g}", e, 1 / (e * e)), { .contrast = 1 / (e * e), .elongation = e });
}

void horizons(const Keys&)
{
  header("horizon");
  for (const double h : { 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0 })
    line(fmt::format("{}", h), { .horizon = h });
}

void porosity(const Keys&)
{
  header("porosity");
  for (const double p : { 0.0, 0.2, 0.4, 0.45, 0.5, 0.6 })
    line(fmt::format("{}, disks", p), { .plate = small(p) });
  for (const double horizon : { 2.0, 3.0 })
    for (const double p : { 0.2, 0.4, 0.6, 0.7, 0.8, 0.9 })
      line(fmt::format("{}, nodes, horizon {}", p, horizon), { .horizon = horizon, .plate = small(p, true) });
}

void notches(const Keys&)
{
  header("notches over the width");
  for (const double a : { 0.0, 0.5, 0.9, 0.95, 1.0, 1.5 })
    line(fmt::format("{}", a), { .plate = small(0), .notch = a });
  for (const int n : { 3, 9, 30 })
    line(fmt::format("{} of 0.5", n), { .plate = small(0), .notch = 0.5, .notches = n });
  line("3 of 1", { .plate = small(0), .notch = 1, .notches = 3 });
}

void tolerance(const Keys&)
{
  header("tolerance");
  for (const double t : { 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14 })
  {
    Trial trial;
    trial.options.tolerance = t;
    trial.options.events.riseTolerance = 2 * t;
    line(fmt::format("{:g}, before a rise {:g}", t, 2 * t), trial);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "contrast", contrast }, { "elongation", elongation }, { "horizon", horizons }, { "porosity", porosity },
      { "notch", notches }, { "tolerance", tolerance } });
}
