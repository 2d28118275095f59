#pragma once

#include "files/Input.h"
#include "program/SettingOptions.h"
#include "session/Session.h"

#include <vtkSmartPointer.h>

#include <string>

class vtkImageData;

/// The sample of a command on material points.
namespace lamella::cli
{

/// An image of phases, with the directions along the walls where its file has them.
struct PointSample
{
  vtkSmartPointer<vtkImageData> image;
  std::string pixelSizeSource;
  std::string provenance; ///< of the file
};

/// @param settings those of the command's class: what they say of phases is held against the sample
/// @throws ParameterError, InputError, MemoryError
[[nodiscard]] PointSample loadPointSample(
  Session& session, const PictureOptions& picture, const SettingOptions& settings);

} // namespace lamella::cli
