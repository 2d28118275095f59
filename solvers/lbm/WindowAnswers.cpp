#include "lbm/WindowAnswers.h"

#include <cmath>
#include <cstddef>
#include <numeric>

namespace lamella::lbm
{

void summarise(RefinementStep& step, std::span<const double> values)
{
  const double count = static_cast<double>(values.size());
  step.pictures = static_cast<int>(values.size());
  step.value = std::accumulate(values.begin(), values.end(), 0.0) / count;
  for (const double v : values)
    step.scatter += (v - step.value) * (v - step.value);
  step.scatter = count > 1 ? std::sqrt(step.scatter / (count - 1)) : 0;
}

void addWindowErrors(
  std::vector<DiffusionAnswer>& answers, const Lattice& lattice, const StudyOptions& options, const WindowSolve& solve)
{
  std::vector<statistics::WindowProperty> properties(answers.size());
  for (std::size_t i = 0; i < answers.size(); ++i)
  {
    const auto axis = static_cast<std::size_t>(answers[i].axis);
    properties[i].value = answers[i].result.effective[axis];
    properties[i].seriesAxis = axis;
  }
  for (const int parts : windowParts)
  {
    const SubWindows cuts = subWindows(lattice, parts);
    if (cuts.windows.size() < 2)
      continue;
    std::vector<RefinementStep> steps(answers.size());
    for (std::size_t i = 0; i < answers.size(); ++i)
    {
      steps[i].parts = parts;
      steps[i].refinement = options.refinement;
      properties[i].tilings.push_back({ cuts.counts, {} });
    }
    for (const SubWindow& window : cuts.windows)
    {
      const std::vector<double> values = solve(window, steps);
      for (std::size_t i = 0; i < answers.size(); ++i)
        properties[i].tilings.back().values.push_back(values[i]);
    }
    for (std::size_t i = 0; i < answers.size(); ++i)
    {
      summarise(steps[i], properties[i].tilings.back().values);
      answers[i].steps.push_back(steps[i]);
    }
  }
  if (properties.empty() || properties.front().tilings.empty())
    return;
  const std::vector<statistics::WindowError> errors =
    statistics::windowErrors(properties, { .sameSides = options.steady.sides == Sides::Insulated });
  for (std::size_t i = 0; i < answers.size(); ++i)
    answers[i].window = errors[i];
}

} // namespace lamella::lbm
