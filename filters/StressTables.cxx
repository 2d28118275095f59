#include "StressTables.h"

#include "Columns.h"

#include "vtkDataSetAttributes.h"
#include "vtkTable.h"

#include <cmath>
#include <limits>
#include <vector>

namespace lamella
{
namespace
{

using statistics::ExponentialTail;
using statistics::StressDistribution;
using statistics::StressGroup;

constexpr const char* stressCreator = "vtkStressPDF";
constexpr const char* means = "mean tensile stress";

double over(double a, double b)
{
  return b != 0 ? a / b : 0;
}

void addTails(vtkTable* table, const std::vector<ExponentialTail>& tails)
{
  const Columns columns{ table->GetRowData(), tails, stressCreator };
  columns.counts("tail_count", "stresses beyond the threshold", &ExponentialTail::count);
  columns.numbers("tail_share", "1", "their share of all tensile ones", &ExponentialTail::share);
  columns.numbers("theta", "1", "rate of the exponential tail, by maximum likelihood", &ExponentialTail::theta);
  columns.numbers(
    "theta_error", "1", "standard error of theta if stresses were independent", &ExponentialTail::standardError);
}

} // namespace

void fillDensity(vtkTable* table, const StressDistribution& d, std::span<const std::string> phases)
{
  const Columns columns{ table->GetRowData(), d.all.bins, stressCreator };
  const auto edge = [&](std::size_t bin)
  { return (static_cast<double>(d.firstBin) + static_cast<double>(bin)) * d.binWidth; };
  const auto middle = [&](std::size_t bin) { return edge(bin) + d.binWidth / 2; };
  columns.numbers("stress", means, "middle of the bin", middle);
  columns.numbers("stress_low", means, "lower end of the bin", edge);
  columns.numbers(
    "stress_high", means, "upper end of the bin", [&](std::size_t bin) { return edge(bin + 1); });
  columns.counts(
    "count", "stresses in the bin", [&](std::size_t bin) { return d.all.bins[bin]; });
  columns.numbers(
    "density", "1 / (mean tensile stress)", "probability density", [&](std::size_t bin) { return d.all.density[bin]; });
  const ExponentialTail& tail = d.all.tail;
  const double weight = over(static_cast<double>(tail.count), static_cast<double>(d.all.count)) * tail.theta;
  columns.numbers("tail", "1 / (mean tensile stress)", "the exponential law that was fitted; NaN below the threshold",
    [&](std::size_t bin)
    {
      const double x = middle(bin);
      return x >= tail.threshold ? weight * std::exp(-tail.theta * (x - tail.threshold))
                                 : std::numeric_limits<double>::quiet_NaN();
    });
  for (std::size_t g = 0; g < phases.size(); ++g)
  {
    const StressGroup& group = d.groups[g];
    if (group.count == 0)
      continue;
    columns.counts(
      "count_" + phases[g], "stresses of the phase in the bin", [&](std::size_t bin) { return group.bins[bin]; });
    columns.numbers("density_" + phases[g], "1 / (mean tensile stress)", "probability density within the phase",
      [&](std::size_t bin) { return group.density[bin]; });
  }
}

void fillPhases(vtkTable* table, const StressDistribution& d, std::span<const std::string> phases)
{
  std::vector<const StressGroup*> groups{ &d.all };
  std::vector<std::string> names{ "all" };
  std::vector<ExponentialTail> tails{ d.all.tail };
  for (std::size_t g = 0; g < phases.size(); ++g)
  {
    groups.push_back(&d.groups[g]);
    names.push_back(phases[g]);
    tails.push_back(d.groups[g].tail);
  }
  const Columns columns{ table->GetRowData(), groups, stressCreator };
  columns.words(
    "phase", [&](std::size_t i) { return names[i]; });
  const auto share = [&](const char* column, const char* description, std::int64_t StressGroup::*member)
  {
    columns.numbers(column, "1", description,
      [&](const StressGroup* group)
      { return over(static_cast<double>(group->*member), static_cast<double>(group->count)); });
  };
  columns.counts("count", "points or cells", &StressGroup::count);
  columns.numbers("mean", "Pa", "mean stress", &StressGroup::mean);
  columns.numbers("deviation", "Pa", "standard deviation", &StressGroup::deviation);
  columns.numbers("mean_tensile", "Pa", "mean of the stresses above 0", &StressGroup::meanTensile);
  columns.numbers("mean_compressive", "Pa", "mean of the stresses below 0", &StressGroup::meanCompressive);
  columns.numbers("smallest", "Pa", "smallest stress", &StressGroup::smallest);
  columns.numbers("largest", "Pa", "largest stress", &StressGroup::largest);
  share("tensile_share", "share of points above 0", &StressGroup::tensile);
  share("compressive_share", "share of points below 0", &StressGroup::compressive);
  if (d.reference > 0)
  {
    columns.numbers(
      "mean_tensile_over_reference", "1", "mean tensile stress over the reference stress",
      [&](const StressGroup* group) { return group->meanTensile / d.reference; });
    columns.numbers("mean_compressive_over_reference", "1", "mean compressive stress over the reference stress",
      [&](const StressGroup* group) { return group->meanCompressive / d.reference; });
  }
  addTails(table, tails);
}

void fillThresholds(vtkTable* table, const StressDistribution& d)
{
  const Columns columns{ table->GetRowData(), d.tails, stressCreator };
  columns.numbers("threshold", means, "where the tail begins", &ExponentialTail::threshold);
  addTails(table, d.tails);
  columns.numbers("distance", "1", "largest difference between the cumulative shares of stresses and law",
    &ExponentialTail::distance);
}

} // namespace lamella
