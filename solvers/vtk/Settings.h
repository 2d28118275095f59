#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro

class vtkObject;

/// What the headers of the classes declare of their settings. Not installed.
namespace lamella
{

/// Looks at all numbers that were set. Nothing is silently made to fit: what is out of its range is refused, in the
/// same words whatever the numbers came through.
/// @throws ParameterError with the setting, its value, and what it can be; also where it is not finite
VTKLAMELLASOLVERSVTK_EXPORT void checkSettings(vtkObject* object);

} // namespace lamella
