#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace lamella
{

/// What a user can cause and can mend. `what()` says what is wrong with the value that was seen, in one line;
/// `hint()` says what to do about it. The command line prints them as "error: ..." and "hint: ..."; filters hand
/// them to vtkErrorMacro.
class Error : public std::runtime_error
{
public:
  Error(const std::string& message, std::string hint)
    : std::runtime_error(message)
    , hint_(std::move(hint))
  {
  }
  [[nodiscard]] const std::string& hint() const noexcept { return hint_; }

private:
  std::string hint_;
};

/// A file, picture or table that cannot be used as it is.
class InputError : public Error
{
  using Error::Error;
};

/// A parameter outside its range, or parameters that contradict each other.
class ParameterError : public Error
{
  using Error::Error;
};

/// The problem has no answer: no conducting path, no path for the load.
class NoPathError : public Error
{
  using Error::Error;
};

/// More memory is needed than there is; the message says how much.
class MemoryError : public Error
{
  using Error::Error;
};

/// An iteration that diverged or stagnated; the message names the step and the quantity.
class DivergenceError : public Error
{
  using Error::Error;
};

/// The user interrupted; nothing was written.
class Cancelled : public Error
{
public:
  Cancelled()
    : Error("interrupted", "nothing was written; run it again to start afresh")
  {
  }
};

} // namespace lamella
