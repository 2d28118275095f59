// Does the window error of `lamella diffusion` hold? Pictures cut out of much larger samples of random materials; the
// truth is the mean of the large samples. study=conductivity: one line a kind, size and pair of conductivities: how
// many of the intervals of 95 % hold the truth, half their median width, the median error of the pictures' own values,
// and what the windows cost over the solve. study=rings: how often the gradient of a growth ring is seen. Keys: seed=N
// of the first sample (1001), samples=N (5), pictures=N of each sample and size (8), kind=NAME. The rule's weights were
// found on other seeds, see docs/benchmarks/window.md.
#include "Keys.h"
#include "Table.h"
#include "Tissues.h"

#include "lbm/DiffusionStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

std::vector<lbm::DiffusionAnswer> solved(const PhaseImage& image, const std::vector<double>& conductivity, bool windows)
{
  lbm::StudyOptions options;
  options.axes = image.lattice.dimension == 3 ? std::vector{ 0, 1, 2 } : std::vector{ 0, 1 };
  options.estimateError = false;
  options.windowError = windows;
  options.steady.maxIterations = 2000;
  return lbm::studyDiffusion(image, conductivity, options, MPI_COMM_SELF);
}

double valueOf(const lbm::DiffusionAnswer& answer)
{
  return answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

double median(std::vector<double> values)
{
  std::ranges::sort(values);
  return values.empty() ? std::nan("") : values[values.size() / 2];
}

/// What one line of the table is made of.
struct Line
{
  int held = 0;
  int gradients = 0;
  std::vector<double> widths, errors; ///< relative to the truth
  double solve = 0, windows = 0;      ///< [s]
};

/// Pairs of conductivities, of the connected phase and the other one.
const std::vector<std::pair<std::string, std::array<double, 2>>> pairs{ { "1 : 0.023", { 1, 0.023 } },
  { "0.004 : 1", { 0.004, 1 } }, { "1 : 0", { 1, 0 } } };

void conductivity(const Keys& keys)
{
  const auto first = static_cast<std::uint64_t>(number(keys, "seed", 1001));
  const int samples = static_cast<int>(number(keys, "samples", 5));
  const int pictures = static_cast<int>(number(keys, "pictures", 8));
  const std::string wanted = text(keys, "kind", "");
  Table table(keys, "window-error", "conductivity",
    "kind,conductivities,nodes,cases,held,half_width,error,width_over_error,gradients,cost");
  fmt::print("{:<20} {:<10} {:>5} {:>6} {:>6}  {:>10} {:>8} {:>6} {:>6}\n", "kind", "pair", "nodes", "cases", "held",
    "half width", "error", "grad.", "cost");
  std::map<std::string, std::array<double, 2>> total;
  for (const Tissue& tissue : tissues())
  {
    if (!wanted.empty() && tissue.kind != wanted)
      continue;
    std::vector<PhaseImage> large;
    for (int s = 0; s < samples; ++s)
      large.push_back(tissue.make(tissue.large, first + static_cast<std::uint64_t>(s)));
    for (const auto& [name, of] : pairs)
    {
      const std::vector<double> k = tissue.connected == 1 ? std::vector{ of[1], of[0] } : std::vector{ of[0], of[1] };
      std::array<double, 3> truth{ 0, 0, 0 };
      for (const PhaseImage& image : large)
        for (const auto& answer : solved(image, k, false))
          truth[static_cast<std::size_t>(answer.axis)] += valueOf(answer) / samples;
      for (const std::int64_t edge : tissue.windows)
      {
        Line line;
        for (int s = 0; s < samples; ++s)
        {
          Random random(first + 7919 * static_cast<std::uint64_t>(s + 1)); // the same places for every pair
          for (int p = 0; p < pictures; ++p)
          {
            const PhaseImage picture = someWindow(large[static_cast<std::size_t>(s)], edge, random);
            std::vector<lbm::DiffusionAnswer> answers;
            try
            {
              answers = solved(picture, k, true);
            }
            catch (const NoPathError&)
            {
              continue; // nothing leads across: no value to speak of
            }
            for (const auto& answer : answers)
            {
              const double t = truth[static_cast<std::size_t>(answer.axis)];
              const statistics::WindowError& w = *answer.window;
              line.held += w.low <= t && t <= w.high ? 1 : 0;
              line.gradients += w.gradient ? 1 : 0;
              line.widths.push_back(0.5 * (w.high - w.low) / t);
              line.errors.push_back(std::abs(w.value - t) / t);
              for (const lbm::RefinementStep& step : answer.steps)
                (step.parts > 1 ? line.windows : line.solve) += step.seconds;
            }
          }
        }
        const double cases = static_cast<double>(line.widths.size());
        total[name][0] += line.held;
        total[name][1] += cases;
        fmt::print("{:<20} {:<10} {:>5} {:>6} {:>4.0f} %  {:>8.1f} % {:>6.1f} % {:>6} {:>6.2f}\n", tissue.kind, name,
          edge, cases, 100 * line.held / cases, 100 * median(line.widths), 100 * median(line.errors), line.gradients,
          line.windows / line.solve);
        std::fflush(stdout);
        table.line(tissue.kind, name, edge, cases, line.held / cases, median(line.widths), median(line.errors),
          median(line.widths) / median(line.errors), line.gradients, line.windows / line.solve);
      }
    }
  }
  for (const auto& [name, of] : total)
    fmt::print("all {:<10} {:.1f} % of {}\n", name, 100 * of[0] / of[1], of[1]);
}

/// From earlywood to latewood along x.
void rings(const Keys& keys)
{
  const auto first = static_cast<std::uint64_t>(number(keys, "seed", 1001));
  const int samples = static_cast<int>(number(keys, "samples", 20));
  for (const double end : { 0.3, 0.6, 1.0 })
  {
    int found = 0;
    int elsewhere = 0;
    for (int s = 0; s < samples; ++s)
    {
      generators::SoftwoodOptions o;
      o.size = { 400, 400, 1 };
      o.spacing = 1.5e-6;
      o.ringPosition1 = end;
      o.solidFraction = 0.45;
      o.seed = first + static_cast<std::uint64_t>(s);
      for (const auto& answer : solved(generators::softwood(o), { 0.023, 1 }, true))
        if (answer.window->gradient)
          (answer.window->gradient->axis == 0 ? found : elsewhere) += 1;
    }
    fmt::print(
      "ring 0 to {}: gradient along x in {} of {} values, along y in {}\n", end, found, 2 * samples, elsewhere);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv, { { "conductivity", conductivity }, { "rings", rings } });
}
