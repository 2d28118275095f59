#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro

#include "vtkIndent.h"

#include <nlohmann/json_fwd.hpp>

class vtkObject;

/// What the headers of the classes declare of their settings. Not installed.
namespace lamella
{

/// Looks at all numbers that were set. Nothing is silently made to fit: what is out of its range is refused, in the
/// same words whatever the numbers came through.
/// @throws ParameterError with the setting, its value, and what it can be; also where it is not finite
VTKLAMELLASOLVERSVTK_EXPORT void checkSettings(vtkObject* object);

/// Numbers, words and switches that were set and that count with each other, by the names of Python's keywords: what
/// provenance tells of a step. What is listed is not among them.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT nlohmann::json settingsAsJson(vtkObject* object);

/// A line each, as PrintSelf() of a class has them.
VTKLAMELLASOLVERSVTK_EXPORT void printSettings(vtkObject* object, ostream& os, vtkIndent indent);

} // namespace lamella
