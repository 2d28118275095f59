#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "statistics/WindowError.h"

#include <span>
#include <vector>

class vtkDataObject;

/// Window errors of several properties as field data. Not installed.
namespace lamella
{

/// `window_of` (names), and in their order `window_errors` (relative), `window_low`, `window_high`, `window_deviation`,
/// `window_freedom`, `window_bias`, `window_doubt`, `window_gradient` (0 to 2, NaN: none),
/// `window_layered`, `window_layered_low`, `window_layered_high`. None of them: what a data
/// set has of them goes.
VTKLAMELLASOLVERSVTK_EXPORT void setWindowFields(vtkDataObject* data, std::span<const statistics::WindowError> errors);

/// What setWindowFields() wrote; without slabs, and of gradients only axis and layers.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::vector<statistics::WindowError> windowFields(vtkDataObject* data);

} // namespace lamella
