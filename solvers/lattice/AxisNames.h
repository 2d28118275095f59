#pragma once

#include <array>

namespace lamella
{

/// What the axes are called, in results, files and messages.
inline constexpr std::array<const char*, 3> axisNames{ "x", "y", "z" };

} // namespace lamella
