#pragma once

#include "files/Input.h"
#include "session/Session.h"

#include <string>
#include <vector>

/// What commands share that work on a sample and on what else its file holds of every node.
namespace lamella::cli
{

/// Says what is doubtful about the sample itself.
void tellDoubts(Session& session, const Sample& sample);

/// The sample as an image, each pixel split in so many along each axis, with what solvers ask of it beside phases where
/// its file is a .vti that has it: point arrays `grain` and `axis`. Lattice and names of phases stay in the sample, the
/// nodes are moved out.
[[nodiscard]] vtkSmartPointer<vtkImageData> imageOf(Sample& sample, int refine = 1);

} // namespace lamella::cli
