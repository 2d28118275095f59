#include "StressTables.h"

#include "TableColumns.h"
#include "vtkLatticeConversion.h"

#include "vtkStringArray.h"
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

void addTails(const Columns& columns, const std::vector<ExponentialTail>& tails)
{
  columns.counts(
    "tail_count", "stresses beyond the threshold", [&](std::size_t i) { return tails[i].count; });
  columns.numbers(
    "tail_share", "1", "their share of all tensile ones", [&](std::size_t i) { return tails[i].share; });
  columns.numbers(
    "theta", "1", "rate of the exponential tail, by maximum likelihood", [&](std::size_t i) { return tails[i].theta; });
  columns.numbers("theta_error", "1", "standard error of theta if stresses were independent",
    [&](std::size_t i) { return tails[i].standardError; });
}

} // namespace

void fillDensity(vtkTable* table, const StressDistribution& d, std::span<const std::string> phases)
{
  const Columns columns{ table, d.all.bins.size(), stressCreator };
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
  const Columns columns{ table, groups.size(), stressCreator };
  vtkNew<vtkStringArray> name;
  name->SetName("phase");
  for (const std::string& text : names)
    name->InsertNextValue(text);
  table->AddColumn(name);
  const auto stress = [&](const char* column, const char* description, double StressGroup::*member)
  {
    columns.numbers(
      column, "Pa", description, [&](std::size_t i) { return groups[i]->*member; });
  };
  const auto share = [&](const char* column, const char* description, std::int64_t StressGroup::*member)
  {
    columns.numbers(
      column, "1", description,
      [&](std::size_t i)
      { return over(static_cast<double>(groups[i]->*member), static_cast<double>(groups[i]->count)); });
  };
  columns.counts("count", "points or cells", [&](std::size_t i) { return groups[i]->count; });
  stress("mean", "mean stress", &StressGroup::mean);
  stress("deviation", "standard deviation", &StressGroup::deviation);
  stress("mean_tensile", "mean of the stresses above 0", &StressGroup::meanTensile);
  stress("mean_compressive", "mean of the stresses below 0", &StressGroup::meanCompressive);
  stress("smallest", "smallest stress", &StressGroup::smallest);
  stress("largest", "largest stress", &StressGroup::largest);
  share("tensile_share", "share of points above 0", &StressGroup::tensile);
  share("compressive_share", "share of points below 0", &StressGroup::compressive);
  if (d.reference > 0)
  {
    columns.numbers(
      "mean_tensile_over_reference", "1", "mean tensile stress over the reference stress",
      [&](std::size_t i) { return groups[i]->meanTensile / d.reference; });
    columns.numbers("mean_compressive_over_reference", "1", "mean compressive stress over the reference stress",
      [&](std::size_t i) { return groups[i]->meanCompressive / d.reference; });
  }
  addTails(columns, tails);
}

void fillThresholds(vtkTable* table, const StressDistribution& d)
{
  const Columns columns{ table, d.tails.size(), stressCreator };
  columns.numbers("threshold", means, "where the tail begins", [&](std::size_t i) { return d.tails[i].threshold; });
  addTails(columns, d.tails);
  columns.numbers("distance", "1", "largest difference between the cumulative shares of stresses and law",
    [&](std::size_t i) { return d.tails[i].distance; });
}

} // namespace lamella
