#include "FractureCost.h"
#include "FractureRuns.h"

#include "peridynamics/Material.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>

namespace lamella::benchmark
{
namespace
{

using namespace peridynamics;

constexpr double young = 1e9;            ///< of matrix and plate [Pa]
constexpr double coarsest = 3.0 / 64;    ///< horizon over width at which s₀ is that of the samples
constexpr double coarsestStretch = 1e-3; ///< s₀ there; finer lattices have the same fracture energy

struct Study
{
  std::string name;
  std::function<Sample(double horizon, std::int64_t nodes)> sample;
  double stop = 0.05; ///< share of the peak at which runs end, where no key says so
};

/// One sample by one method.
struct Row
{
  std::string study;
  std::string method;
  double horizon = 3;
  std::int64_t nodes = 64;
  std::int64_t latticeNodes = 0;
  double solid = 1; ///< share of the lattice's nodes
  double seconds = 0;
  double startSeconds = 0;
  std::int64_t broken = 0;
  FractureStatistics statistics;     ///< none in motion
  std::int64_t steps = 0;            ///< in motion
  double strength = 0;               ///< over √(E Gc/W), W the width
  std::optional<double> byMethod{};  ///< relative error against the accurate method on this lattice
  std::optional<double> byLattice{}; ///< against the finest lattice with this horizon
  double nominal = 0;                ///< K over that of the continuum
  double lattice = 0;                ///< K over that of the lattice
};

double perEvent(double value, const FractureStatistics& t)
{
  return value / static_cast<double>(std::max<std::int64_t>(1, t.events));
}

/// √(E Gc/W) of the matrix, which is the same on all lattices.
double unitStress()
{
  const double energy = 9 * young * coarsest * coarsestStretch * coarsestStretch / (4 * std::numbers::pi);
  return std::sqrt(young * energy);
}

double stretchOn(double horizon, std::int64_t nodes)
{
  return coarsestStretch * std::sqrt(coarsest * static_cast<double>(nodes) / horizon);
}

FractureOptions optionsOf(const std::string& method, double stop)
{
  FractureOptions o;
  o.stopShare = stop;
  if (method == "accurate" || method == "batched")
    o.method = FractureMethod::Accurate;
  if (method == "batched")
    o.breaking = Breaking::Batched;
  if (method == "no rivals")
    o.events.rivals = 0;
  return o;
}

bool moves(const std::string& method)
{
  return method.starts_with("motion");
}

/// @param last record of a quasi-static run: made here, or what motion starts and ends with
Row measure(const Study& study, const Sample& s, const std::string& method, const Keys& keys, FractureRecord& last)
{
  const double stop = number(keys, "stop", study.stop);
  const auto repeat = static_cast<int>(number(keys, "repeat", 1));
  Row row;
  row.study = study.name;
  row.method = method;
  row.horizon = s.model.horizon;
  row.nodes = s.lattice.size[0];
  row.latticeNodes = s.lattice.count();
  row.solid = static_cast<double>(s.phase.size() - static_cast<std::size_t>(std::ranges::count(s.phase, 0))) /
    static_cast<double>(s.phase.size());
  if (moves(method))
  {
    const PullSettings settings{ .transits = std::atof(method.substr(7).c_str()), .stop = stop };
    const Motion m = median<Motion>(
      repeat, [&] { return damped(s, last, settings); }, [](const Motion& x) { return x.seconds; });
    row.seconds = m.seconds;
    row.broken = static_cast<std::int64_t>(m.record.broken.size());
    row.steps = m.record.steps;
    row.strength = m.record.peak.stress / unitStress();
    return row;
  }
  const FractureOptions o = optionsOf(method, stop);
  const Run r = median<Run>(
    repeat, [&] { return quasiStatic(s, o); }, [](const Run& x) { return x.seconds(); });
  row.seconds = r.seconds();
  row.startSeconds = r.startSeconds;
  row.broken = static_cast<std::int64_t>(r.record.broken.size());
  row.statistics = r.record.statistics;
  row.strength = r.record.peak.stress / unitStress();
  last = r.record;
  return row;
}

// An event: one bond, or one batch. Solves and iterations are of the whole lattice, for each event; local: nodes that
// local corrections visit, each time anew, over those of the lattice.
std::string percent(const std::optional<double>& share)
{
  return share ? fmt::format("{:+.4f} %", 100 * *share) : std::string();
}

void header(bool toughness)
{
  fmt::print("{:>4} {:>5} {:<11} {:>8} {:>7} {:>7} {:>9} {:>7} {:>8} {:>8} {:>9} {:>11} {:>11}{}\n", "h/dx", "nodes",
    "method", "CPU [s]", "broken", "events", "ms/event", "solves", "iter.", "local", "strength", "accurate", "finest",
    toughness ? "  nominal  lattice" : "");
}

void print(const Row& r)
{
  const FractureStatistics& t = r.statistics;
  fmt::print("{:>4g} {:>5} {:<11} {:>8.2f} {:>7}", r.horizon, r.nodes, r.method, r.seconds, r.broken);
  if (r.steps > 0)
    fmt::print(" {:>7} {:>9} {:>7} {:>8} {:>8}", r.steps, "steps", "", "", "");
  else
    fmt::print(" {:>7} {:>9.2f} {:>7.3f} {:>7.2f} {:>8.2f}", t.events, perEvent(1e3 * (r.seconds - r.startSeconds), t),
      perEvent(static_cast<double>(t.equilibria), t), perEvent(static_cast<double>(t.globalIterations), t),
      perEvent(static_cast<double>(t.nodesVisited), t) / static_cast<double>(r.latticeNodes));
  fmt::print(" {:>9.5f} {:>11} {:>11}", r.strength, percent(r.byMethod), percent(r.byLattice));
  if (r.nominal > 0)
    fmt::print(" {:>8.4f} {:>8.4f}", r.nominal, r.lattice);
  fmt::print("\n");
  std::fflush(stdout); // a line may take a minute
}

void write(const std::vector<Row>& rows, const Keys& keys)
{
  const std::filesystem::path folder = text(keys, "output", "results/bench-fracture");
  std::filesystem::create_directories(folder);
  const std::filesystem::path path = folder / ("fracture-" + rows.front().study + ".csv");
  std::ofstream file(path);
  file << "study,method,horizon,nodes,lattice_nodes,solid,cpu_seconds,start_seconds,broken,events,raises,equilibria,"
          "iterations,local_cycles,nodes_visited,steps,strength,error_method,error_lattice,nominal,lattice\n";
  const auto shown = [](const std::optional<double>& x) { return x ? fmt::format("{:.9g}", *x) : std::string(); };
  for (const Row& r : rows)
  {
    const FractureStatistics& t = r.statistics;
    file << fmt::format("{},{},{:g},{},{},{:.6g},{:.6g},{:.6g},{},{},{},{},{},{},{},{},{:.9g},{},{},{:.9g},{:.9g}\n",
      r.study, r.method, r.horizon, r.nodes, r.latticeNodes, r.solid, r.seconds, r.startSeconds, r.broken, t.events,
      t.raises, t.equilibria, t.globalIterations, t.localCycles, t.nodesVisited, r.steps, r.strength, shown(r.byMethod),
      shown(r.byLattice), r.nominal, r.lattice);
  }
  if (!file.flush())
    throw InputError(fmt::format("cannot write {}", path.string()), "give another folder: output=");
  fmt::print("  written: {}\n", path.string());
}

std::vector<Row> measureAll(const Study& study, const Keys& keys, const std::function<void(Row&)>& derive)
{
  const bool full = text(keys, "size", "quick") == "full";
  const double eventsUpTo = number(keys, "events", full ? 1e9 : 2400);
  const double slowUpTo = number(keys, "slow", full ? 5000 : 600);
  const Keys sizes{ { "horizons", text(keys, "horizons", "3,4,6") },
    { "nodes", text(keys, "nodes", full ? "512,256,128,64" : "256,128,64") } };
  std::vector<double> nodes = list(sizes, "nodes", 0);
  std::sort(nodes.begin(), nodes.end(), std::greater<>()); // the finest is what the others are measured by
  std::vector<Row> rows;
  for (const double horizon : list(sizes, "horizons", 0))
  {
    std::optional<double> finest;
    for (const double count : nodes)
    {
      const Sample s = study.sample(horizon, static_cast<std::int64_t>(count));
      const double size = horizon * horizon * count; // bonds in a cross-section, more or less
      std::optional<double> accurate;
      FractureRecord last;
      for (const std::string method : { "accurate", "batched", "events", "no rivals", "motion 30", "motion 100" })
      {
        if (size > (method == "events" || method == "no rivals" ? eventsUpTo : slowUpTo))
          continue;
        Row row = measure(study, s, method, keys, last);
        if (!finest)
          finest = row.strength;
        if (method == "accurate")
          accurate = row.strength;
        if (accurate)
          row.byMethod = row.strength / *accurate - 1;
        row.byLattice = row.strength / *finest - 1;
        derive(row);
        print(row);
        rows.push_back(row);
      }
    }
  }
  write(rows, keys);
  return rows;
}

} // namespace

void strengthCost(const Keys& keys)
{
  const double saturation = number(keys, "saturation", 0.5);
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 1));
  fmt::print("\nStrength of 24 cemented grains, S = {}, bridges to the platens, one fracture energy\n", saturation);
  header(false);
  const Study study{ "strength",
    [&](double horizon, std::int64_t nodes)
    {
      // Platens of one thickness, as thick as the longest horizon on the coarsest lattice; without bridges to them the
      // sample would part along points that touch, which is no strength.
      Sample s = cemented({ .nodes = nodes,
        .saturation = saturation,
        .seed = seed,
        .platen = 6.0 * static_cast<double>(nodes) / 64,
        .wallBridges = true });
      s.model.horizon = horizon;
      scaleStretch(s.model, stretchOn(horizon, nodes) / coarsestStretch);
      return s;
    },
    0.3 }; // strands that break one after another: stress may fall by a third before the peak
  measureAll(study, keys, [](Row&) {});
}

void toughnessCost(const Keys& keys)
{
  const double crack = number(keys, "crack", 0.1);
  // A square plate pulled at its ends: the stress intensity over that in an endless plate (finite elements, 0.5 %).
  const double plate = 1 + 0.014 * (crack / 0.1) * (crack / 0.1);
  fmt::print("\nToughness by a square plate with a central crack of half length {}\n", crack);
  header(true);
  const auto half = [&](std::int64_t nodes)
  { return std::round(crack * static_cast<double>(nodes)) / static_cast<double>(nodes); };
  const Study study{ "toughness",
    [&](double horizon, std::int64_t nodes)
    {
      Sample s{ makeLattice(nodes, nodes, 1, 2, 1.0 / static_cast<double>(nodes)), {}, {}, {} };
      s.phase.assign(static_cast<std::size_t>(s.lattice.count()), 1);
      s.model.horizon = horizon;
      s.model.pairs[{ 1, 1 }].material = { .youngsModulus = young, .criticalStretch = stretchOn(horizon, nodes) };
      s.model.notches.push_back({ { 0.5 - half(nodes), 0.5, 0 }, { 2 * half(nodes), 0, 0 }, {} });
      return s;
    },
    0.8 }; // a crack that grows at a held strain only sheds load
  const std::vector<Row> rows = measureAll(study, keys,
    [&](Row& r)
    {
      r.nominal = plate * r.strength * std::sqrt(std::numbers::pi * half(r.nodes));
      r.lattice = r.nominal / latticeModuli(Stencil(2, r.horizon), Continuum::PlaneStress).toughness;
    });
  // 1/σ² = π (a + β h)/(F K)²: least squares over the lattices of one horizon, strict events.
  fmt::print("  process zone: 1/strength^2 linear in h, strict events\n");
  for (const double horizon : { 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0 })
  {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const Row& r : rows)
      if (r.horizon == horizon && r.method == "events")
      {
        const double zone = horizon / (static_cast<double>(r.nodes) * half(r.nodes)); // h/a
        const double inverse = 1 / (r.lattice * r.lattice);
        n += 1;
        x += zone;
        y += inverse;
        xx += zone * zone;
        xy += zone * inverse;
      }
    if (n < 2)
      continue;
    const double slope = (n * xy - x * y) / (n * xx - x * x);
    const double start = (y - slope * x) / n;
    fmt::print("  h/dx {}: K over the lattice's {:.4f}, zone {:.2f} h\n", horizon, 1 / std::sqrt(start), slope / start);
  }
}

} // namespace lamella::benchmark
