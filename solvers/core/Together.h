#pragma once

#include "core/Communicator.h"

#include <functional>

namespace lamella
{

/// Runs f on every rank, and if it throws on any, throws on all: of the lowest such rank, an Error of the same class
/// with its message and hint. So that no rank waits for one that has given up. Nothing in f may be collective.
/// Collective.
void together(const Communicator& comm, const std::function<void()>& f);

} // namespace lamella
