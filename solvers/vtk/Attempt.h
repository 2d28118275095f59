#pragma once

#include "lattice/Error.h"

#include "vtkObject.h"

#include <exception>

/// Helper of the sources and filters; not installed.
namespace lamella
{

enum class Outcome
{
  Done,
  Cancelled, ///< by CheckAbort(): nothing is said
  Failed     ///< what was wrong has been said, with its hint
};

/// Runs what a source or filter does; exceptions become its errors (vtkErrorMacro), as VTK's callers expect.
template <typename Action>
[[nodiscard]] Outcome attempt(vtkObject* self, const Action& action)
{
  try
  {
    action();
    return Outcome::Done;
  }
  catch (const Cancelled&)
  {
    return Outcome::Cancelled;
  }
  catch (const Error& error)
  {
    vtkErrorWithObjectMacro(self, << error.what() << "\nhint: " << error.hint());
  }
  catch (const std::exception& error)
  {
    vtkErrorWithObjectMacro(self, << error.what());
  }
  return Outcome::Failed;
}

} // namespace lamella
