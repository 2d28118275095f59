#pragma once

#include <cstdint>

namespace lamella
{

/// The finaliser of splitmix64 (Steele, Lea, Flood 2014): every bit of the result depends on every bit of the value.
[[nodiscard]] constexpr std::uint64_t mixed(std::uint64_t value) noexcept
{
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

} // namespace lamella
