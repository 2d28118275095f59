#pragma once

#include <cstdint>

/// Internal: the phases of a lattice with a middle lamella.
namespace lamella::micrograph
{

constexpr std::uint8_t kVoid = 0;
constexpr std::uint8_t kSecondary = 1;
constexpr std::uint8_t kLamella = 2;

} // namespace lamella::micrograph
