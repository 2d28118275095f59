#pragma once

#include "Input.h"
#include "Session.h"

#include <CLI/App.hpp>
#include <vtkSmartPointer.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkImageData;
class vtkPointAlgorithm;

/// What a command on material points takes: walls, plane, grid, and its sample.
namespace lamella::cli
{

struct PointOptions
{
  std::string law = "auto";
  std::string plane = "auto";
  /// VALUE of all walls, or PHASE=VALUE, by constant: in the order of lamella::wallConstantNames.
  std::array<std::vector<std::string>, 9> constants;
  std::vector<std::string> voids;
  std::optional<int> perNode; ///< none: two points a cell along each axis, and two at least
  double cellsPerNode = 1;
  bool fitPlatens = false;
  int threads = 1;
};

/// Declares them.
void addPointOptions(CLI::App& command, PointOptions& options);

/// Gives the filter what the options say. @throws ParameterError for what can be said without the sample
void applyPoints(const PointOptions& options, vtkPointAlgorithm* filter);

/// An image of phases, with the directions along the walls where its file has them.
struct PointSample
{
  vtkSmartPointer<vtkImageData> image;
  std::string pixelSizeSource;
  std::string provenance; ///< of the file
};

/// @throws ParameterError, InputError, MemoryError
[[nodiscard]] PointSample loadPointSample(Session& session, const PictureOptions& picture, const PointOptions& options);

} // namespace lamella::cli
