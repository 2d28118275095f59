#pragma once

#include "scenes/Plan.h"

#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What a stage is expected to take. Memory holds to a factor of two (tests/cli/test_scenes.py); work and time
/// are an order of magnitude, as how much breaks, and how soon, is what is to be found out.
struct Cost
{
  std::string stage;
  double bytes = 0; ///< besides what the program takes anyway
  double work = 0;  ///< counted in `unit`
  const char* unit = "";
  double seconds = 0; ///< on one core
};

/// What a sample takes.
struct SampleCost
{
  double nodes = 0;
  int dimension = 2;
  std::vector<Cost> stages;
  double seconds = 0;
  double bytes = 0; ///< of the process: the program, the sample, and the stage that takes most
};

class Rehearsal;

/// Expects by the numbers of nodes of the samples.
class Estimator
{
public:
  /// @param first the sample of which the size is known
  Estimator(const Scene& scene, const Rehearsal& first);

  [[nodiscard]] SampleCost operator()(const SamplePlan& plan) const;

private:
  std::optional<double> checkpoint_; ///< of the scene
  double nodes_ = 0;                 ///< of the first sample
  double solid_ = 1;                 ///< share that is no void
  double spacing_ = 1;
  int dimension_ = 2;
  double scaleOfFirst_ = 1;
  double base_ = 0; ///< bytes of the program
};

} // namespace lamella::cli
