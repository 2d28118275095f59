#pragma once

#include "scenes/Plan.h"

#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

class vtkTable;

namespace lamella::cli
{

/// A sample of a sweep and what was found; no record where it failed.
struct SampleResult
{
  SamplePlan plan;
  std::optional<Json> record;
};

/// What a path such as "fracture.peak_stress" or "sample.phases.wall.fraction" leads to in the reports of stages; in a
/// list an item by its number, or by its `name`, `phase` or `axis`. Nothing where there is no such thing.
[[nodiscard]] std::optional<Json> findMeasure(const Json& stages, const std::string& path);

/// The same before anything has run, by what the commands can report (Contents.h). @throws ParameterError
void checkMeasuresAhead(const Scene& scene);

/// Refuses measures that lead nowhere. @throws ParameterError
void checkMeasures(const Scene& scene, const Json& stages);

/// One row a sample: `sample` (its key), swept keys, `status` ("done" or "failed"), measures. Without measures of the
/// scene: all numbers that stages report, but for times and memory.
[[nodiscard]] vtkSmartPointer<vtkTable> sampleTable(
  const Scene& scene, const Sweep& sweep, const std::vector<SampleResult>& samples);

/// One row a sample: how long it took, stage by stage, and how much memory.
[[nodiscard]] vtkSmartPointer<vtkTable> costTable(const std::vector<SampleResult>& samples);

/// One row a setting of the keys that are not averaged over: `n`, and of each measure mean, standard deviation and
/// standard error.
/// @param samples as sampleTable() gives them
[[nodiscard]] vtkSmartPointer<vtkTable> settingTable(const Scene& scene, const Sweep& sweep, vtkTable* samples);

/// One row a step of a sample, with the numbers of what ran on it.
[[nodiscard]] vtkSmartPointer<vtkTable> stepTable(
  const Sweep& sweep, const std::vector<SampleResult>& samples, const SceneEach& each);

/// Keys over which samples are averaged: those that the scene says, else every `seed`.
[[nodiscard]] std::vector<std::string> averagedOver(const Scene& scene, const Sweep& sweep);

} // namespace lamella::cli
