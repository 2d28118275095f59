#include "BondLoad.h"

#include "Text.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <vector>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> axisNames{ "x", "y", "z" };

} // namespace

void addPlatenOptions(CLI::App& command, PlatenOptions& o)
{
  const auto load = [](CLI::Option* option) { return option->group("Load"); };
  load(command.add_option("--axis", o.axis, "Axis of loading; y of a picture, z of a volume when not given"))
    ->type_name("x|y|z");
  load(command.add_flag("--smooth-platens", o.smooth, "Platens let the sample slip across the axis"));
  load(command.add_flag("--rigid-platens", o.rigid, "All layers of a platen move alike, not as the mean strain"));
  load(command.add_option("--platen-layers", o.layers, "Layers that a platen holds; 0: as many as a bond reaches"))
    ->type_name("NUMBER")
    ->capture_default_str();
}

int platenAxis(const PlatenOptions& o)
{
  if (o.layers < 0)
  {
    throw ParameterError(fmt::format("--platen-layers {} is below 0", o.layers), "0 takes as many as a bond reaches");
  }
  return o.axis.empty() ? -1 : static_cast<int>(oneOf("--axis", o.axis, axisNames));
}

void addToleranceOption(CLI::App& command, double& tolerance)
{
  command.add_option("--tolerance", tolerance, "Largest relative residual force")
    ->type_name("SHARE")
    ->capture_default_str()
    ->group("Accuracy and cost");
}

void addBalanceOptions(CLI::App& command, BalanceOptions& o)
{
  addToleranceOption(command, o.tolerance);
  command.add_option("--max-iterations", o.maxIterations, "Give up after this many")
    ->type_name("NUMBER")
    ->capture_default_str()
    ->group("Accuracy and cost");
}

void checkTolerance(double tolerance)
{
  if (!(tolerance >= 1e-12 && tolerance <= 0.1))
  {
    throw ParameterError(fmt::format("--tolerance {:g} is not between 1e-12 and 0.1", tolerance),
      "it is the largest relative residual force, such as 1e-6");
  }
}

void checkBalance(const BalanceOptions& o)
{
  checkTolerance(o.tolerance);
  if (o.maxIterations < 1)
  {
    throw ParameterError(fmt::format("--max-iterations {} is below 1", o.maxIterations), "allow at least 1");
  }
}

} // namespace lamella::cli
