#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

/// How often what costs much and is not always wanted was computed in this process: for `lamella run --stats`, and for
/// tests that prove that nobody computes what nobody asked for. Nothing depends on these numbers.
namespace lamella
{

enum class Pass
{
  NodalStress,
  EnergyDensity,
  Flux,
  Labels
};
inline constexpr std::size_t passKinds = 4;
inline constexpr std::array<std::string_view, passKinds> passNames{ "nodal_stress", "strain_energy", "flux", "labels" };

using PassCounts = std::array<std::int64_t, passKinds>;

/// One more. Safe in threads.
void countPass(Pass pass) noexcept;

/// All so far, in the order of Pass.
[[nodiscard]] PassCounts passCounts() noexcept;

/// By name, what came since.
[[nodiscard]] std::array<std::pair<std::string_view, std::int64_t>, passKinds> passesSince(
  const PassCounts& before) noexcept;

} // namespace lamella
