#pragma once

#include <cstdint>
#include <string>

namespace lamella
{

/// Bytes that this process can still take without swapping: what the system calls available, or what is left under
/// the limit of its control group or of the process itself (ulimit -v, ulimit -d) where that is less. The largest value
/// there is when neither can be read.
[[nodiscard]] std::uint64_t availableMemory();

/// A number of bytes for people: "512 B", "56.0 MB", "1.2 TB" (powers of 1000).
[[nodiscard]] std::string bytesText(double bytes);

} // namespace lamella
