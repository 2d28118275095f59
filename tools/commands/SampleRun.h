#pragma once

#include "files/Input.h"
#include "program/SettingOptions.h"
#include "session/Session.h"

#include <array>
#include <string>
#include <vector>

/// What commands share that work on a sample and on what else its file holds of every node.
namespace lamella::cli
{

/// Says what is doubtful about the sample itself.
void tellDoubts(Session& session, const Sample& sample);

/// The sample as an image, each pixel split in so many along each axis, with what solvers ask of it beside phases where
/// its file is a .vti that has it: point arrays `grain` and `axis`, and `more`. Lattice and names of phases stay in the
/// sample, the nodes are moved out.
[[nodiscard]] vtkSmartPointer<vtkImageData> imageOf(
  Sample& sample, int refine = 1, const std::vector<std::string>& more = {});

/// A sample as filters take it.
struct ImageSample
{
  vtkSmartPointer<vtkImageData> image; ///< window cut out, refined
  std::string pixelSizeSource;         ///< as Sample
  std::string provenance;              ///< of the file
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
};

/// Reads it on rank 0, and says what is doubtful about it.
/// @param settings those of the command's class: what they say of phases is held against the sample
/// @throws as loadSample(); ParameterError for a phase, or a pair, that the sample does not have
[[nodiscard]] ImageSample loadImage(Session& session, const PictureOptions& picture, const SettingOptions& settings,
  const SampleCheck& check = {}, int refine = 1, const std::vector<std::string>& more = {});

/// The same of greys that nobody names, in these bins.
[[nodiscard]] ImageSample loadGreys(
  Session& session, const PictureOptions& picture, const GreyBins& bins, const std::vector<std::string>& more = {});

} // namespace lamella::cli
