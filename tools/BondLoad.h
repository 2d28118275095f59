#pragma once

#include <CLI/App.hpp>

#include <string>

/// How samples of bonded nodes are held, and how well their forces are balanced: options that commands share.
namespace lamella::cli
{

/// The platens that hold a sample.
struct PlatenOptions
{
  std::string axis;
  bool smooth = false;
  bool rigid = false;
  int layers = 0;
};
void addPlatenOptions(CLI::App& command, PlatenOptions& options);
/// @returns the axis, -1 for the last one
/// @throws ParameterError
[[nodiscard]] int platenAxis(const PlatenOptions& options);
/// @param filter vtkBondEquilibrium or vtkBondFracture
/// @throws ParameterError
template <class Filter>
void applyPlatens(const PlatenOptions& options, Filter* filter)
{
  filter->SetLoadAxis(platenAxis(options));
  filter->SetSmoothPlatens(options.smooth);
  filter->SetRigidPlatens(options.rigid);
  filter->SetPlatenLayers(options.layers);
}

/// How well and how long the forces are balanced.
struct BalanceOptions
{
  double tolerance = 1e-6;
  int maxIterations = 20000;
};
void addBalanceOptions(CLI::App& command, BalanceOptions& options);
void addToleranceOption(CLI::App& command, double& tolerance);
/// @throws ParameterError
void checkBalance(const BalanceOptions& options);
void checkTolerance(double tolerance);

} // namespace lamella::cli
