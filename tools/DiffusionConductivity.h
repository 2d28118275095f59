#pragma once

#include "Input.h"

#include <array>
#include <span>
#include <string>
#include <vector>

/// What --conductivity says, and the directions that it may want.
namespace lamella::cli
{

/// One word NAME=VALUE or NAME=ALONG:ACROSS.
struct GivenConductivity
{
  std::string phase;
  double along = 0;
  double across = 0;
};

/// @throws ParameterError
[[nodiscard]] std::vector<GivenConductivity> parseConductivities(const std::vector<std::string>& texts);

/// By phase id; NaN where a phase has none and no node either.
struct Conductivities
{
  std::vector<double> along;
  std::vector<double> across;

  /// Does a phase that has nodes conduct differently across?
  [[nodiscard]] bool directed(std::span<const double> fractions) const;
};

/// @throws ParameterError for a phase that the sample does not know, or one with nodes that was left out; NoPathError
/// where none conducts
[[nodiscard]] Conductivities conductivities(
  const std::vector<GivenConductivity>& given, const PhaseTable& phases, std::span<const double> fractions);

/// The directions along the walls, of the sample's nodes: the point array `axis` of a .vti.
/// @throws InputError for other files, and where there is none
[[nodiscard]] std::vector<std::array<float, 2>> readAxes(const PictureOptions& options, const Sample& sample);

} // namespace lamella::cli
