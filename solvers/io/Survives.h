#pragma once

#include <functional>

namespace lamella::io
{

/// Whether a process does something without being killed by it, and within so long: a copy of this one tries, whatever
/// it throws. For libraries that do not survive every file. True where no process can be made.
[[nodiscard]] bool survives(const std::function<void()>& action, double seconds = 60);

} // namespace lamella::io
