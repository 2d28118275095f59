#pragma once

#include "Failures.h"
#include "Settings.h"
#include "core/Error.h"

#include "vtkDataObject.h"
#include "vtkInformationVector.h"
#include "vtkObject.h"

#include <exception>
#include <new>

/// Helper of the sources and filters; not installed.
namespace lamella
{

enum class Outcome
{
  Done,
  Cancelled, ///< by CheckAbort(): nothing is said
  Failed     ///< what was wrong has been said, with its hint
};

/// Runs what a source or filter does, if its settings are in their ranges; exceptions become its errors
/// (vtkErrorMacro), as VTK's callers expect.
/// @param failure what kind it was; not changed where there was none
template <typename Action>
[[nodiscard]] Outcome attempt(vtkObject* self, const Action& action, Failure* failure = nullptr)
{
  const auto keep = [failure](const std::exception& error)
  {
    keepFailure(std::current_exception());
    if (failure != nullptr)
      *failure = kindOf(error);
  };
  try
  {
    checkSettings(self);
    action();
    return Outcome::Done;
  }
  catch (const Cancelled&)
  {
    return Outcome::Cancelled;
  }
  catch (const Error& error)
  {
    keep(error);
    vtkErrorWithObjectMacro(self, << error.what() << "\nhint: " << error.hint());
  }
  catch (const std::bad_alloc& error)
  {
    keep(error);
    vtkErrorWithObjectMacro(self, << "there is not enough memory\nhint: take a smaller part or a coarser lattice");
  }
  catch (const std::exception& error)
  {
    keep(error);
    vtkErrorWithObjectMacro(self, << error.what());
  }
  return Outcome::Failed;
}

inline void emptyAll(vtkInformationVector* outputs)
{
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
    vtkDataObject::GetData(outputs, port)->Initialize();
}

/// Ends RequestData: empties all outputs where it was cancelled or failed.
/// @returns what RequestData returns
template <typename Algorithm>
[[nodiscard]] int concluded(Algorithm* self, Outcome outcome, vtkInformationVector* outputs)
{
  if (outcome != Outcome::Done)
    emptyAll(outputs);
  if (outcome == Outcome::Cancelled)
    self->SetAbortOutput(true);
  return outcome == Outcome::Failed ? 0 : 1;
}

} // namespace lamella
