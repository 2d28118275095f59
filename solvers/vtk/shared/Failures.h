#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <exception>

/// What sources and filters ended with, as it was thrown: kind, words and remedy, which a message of VTK's mixes up.
/// Not installed.
namespace lamella
{

/// What kind of mistake it was: values of vtkSampleAlgorithm::Failures.
enum class Failure
{
  None,
  Input,
  Parameter,
  NoPath, ///< nothing carries the load, or conducts
  Memory,
  Divergence,
  Other
};

[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT Failure kindOf(const std::exception& error);

/// Keeps the error of this process that came first since it was taken: the cause of those that follow.
VTKLAMELLASOLVERSVTK_EXPORT void keepFailure(const std::exception_ptr& error);
/// Null where there is none. It is then forgotten.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::exception_ptr takeFailure();
/// The same, which stays.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::exception_ptr lastFailure();

} // namespace lamella
