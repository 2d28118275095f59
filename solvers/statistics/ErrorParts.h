#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace lamella::statistics
{

/// Where a value's error comes from; parts are independent of each other.
struct ErrorPart
{
  std::string name;
  double relative = 0; ///< to the value
};

/// The root of the sum of their squares; NaN where there are no two.
[[nodiscard]] double totalError(std::span<const ErrorPart> parts) noexcept;

/// What halves the total: the largest part, to this share of itself.
struct Halving
{
  std::size_t part = 0;
  double factor = 0; ///< 0 … 1
};

/// @return none where the others are more than half of it, or there are no two
[[nodiscard]] std::optional<Halving> halving(std::span<const ErrorPart> parts) noexcept;

} // namespace lamella::statistics
