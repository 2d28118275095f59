#pragma once

#include "files/Input.h"

#include <string>
#include <vector>

/// What --conductivity says, and the directions that it may want.
namespace lamella::cli
{

/// One word NAME=VALUE or NAME=ALONG:ACROSS, each value with ±HALF_WIDTH behind it or without.
struct GivenConductivity
{
  std::string phase;
  double along = 0;
  double across = 0;
  double alongUncertainty = 0;
  double acrossUncertainty = 0;
};

/// @throws ParameterError
[[nodiscard]] std::vector<GivenConductivity> parseConductivities(const std::vector<std::string>& texts);

/// @throws ParameterError for a name that none of the phases has
void requireNames(
  const std::string& option, const std::vector<GivenConductivity>& given, const std::vector<std::string>& phases);

/// @throws InputError where an image does not say which way the walls run: it has no point array `axis`
void requireAxes(const PictureOptions& options, vtkImageData* image);

} // namespace lamella::cli
