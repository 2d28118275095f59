#pragma once

#include "core/Error.h"

#include <string>

namespace lamella::cli
{

/// An interruption after which something is left.
class Stopped : public Cancelled
{
public:
  /// @param hint what is left, and how to go on
  explicit Stopped(const std::string& hint) { static_cast<Error&>(*this) = Error(what(), hint); }
};

} // namespace lamella::cli
