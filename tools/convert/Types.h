#pragma once

#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

class vtkDataArray;

/// Types of numbers by short names that do not depend on the machine: u8, i16, f32 …
namespace lamella::cli
{

/// Empty for a type that has none.
[[nodiscard]] std::string typeName(int vtkType);
/// VTK's number of a type. Nothing for a name that is none.
[[nodiscard]] std::optional<int> typeNamed(const std::string& name);
/// What --type and --raw-type take.
[[nodiscard]] const std::vector<std::string>& numberTypes();

[[nodiscard]] bool isReal(int vtkType);

/// An array as another type.
/// @param exact refuses to change a value @throws InputError: the first value that does not fit, and where
[[nodiscard]] vtkSmartPointer<vtkDataArray> cast(vtkDataArray* array, int type, bool exact);

/// Values from `low` to `high` spread over all of u8 or u16, those outside at its ends, NaN at 0.
[[nodiscard]] vtkSmartPointer<vtkDataArray> spread(vtkDataArray* array, int type, double low, double high);

} // namespace lamella::cli
