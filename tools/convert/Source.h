#pragma once

#include "convert/Formats.h"

#include <string>
#include <vector>

/// What is converted: a file, a stack of pictures, or a series of steps.
namespace lamella::cli
{

struct Source
{
  const Format* format = nullptr; ///< of the steps
  std::vector<std::string> files; ///< one a step
  std::vector<double> times;      ///< as many where the source tells times, else none
  bool series = false;            ///< a .pvd or a numbered series, even where it has one step

  [[nodiscard]] Step open(std::size_t step, Reading& reading) const;
};

/// @throws InputError: missing; a .pvd that names files that are not there, a series with a gap (both closed where
///         `reading.lossy`, with a warning); ParameterError for an ending that is not known
[[nodiscard]] Source findSource(const std::string& path, Reading& reading);

} // namespace lamella::cli
