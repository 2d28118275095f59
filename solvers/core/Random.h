#pragma once

#include "core/Mix.h"

#include <cstdint>

/// Random numbers without a state: each is a function of a seed and of what it is for. They need only whole-number and
/// basic floating-point arithmetic, so that they are the same on every machine (those of the standard library are not).
namespace lamella
{

/// What a random number is for, so that two uses never share one.
enum class RandomUse : std::uint64_t
{
  RayPlace = 1,
  FileWidth,
  FileOffset,
  FileDrift,
  CellPlace,
  CellShift,
  TipPlace,
  TipSize,
  Warp,
  TracheidLength,
  TracheidPhase,
  TracheidTaper,
  RayPhase,
  RayRow,
  RayCell,
  GrainPlace,
  GrainOrder,
  GrainSize,
  VesselGroup,
  VesselSize,
  VesselPlace,
  VesselGap,
  FibreRing,
  FibrePlace,
  FibreSize,
  Stain,
  Grime,
  Tear,
  Light,
  Noise
};

class Random
{
public:
  constexpr explicit Random(std::uint64_t seed) noexcept
    : seed_(mixed(seed))
  {
  }

  [[nodiscard]] constexpr std::uint64_t bits(
    RandomUse use, std::int64_t a, std::int64_t b = 0, std::int64_t c = 0) const noexcept
  {
    std::uint64_t value = mixed(seed_ ^ static_cast<std::uint64_t>(use));
    value = mixed(value ^ static_cast<std::uint64_t>(a));
    value = mixed(value ^ static_cast<std::uint64_t>(b));
    return mixed(value ^ static_cast<std::uint64_t>(c));
  }

  /// Evenly spread over [0, 1).
  [[nodiscard]] constexpr double uniform(
    RandomUse use, std::int64_t a, std::int64_t b = 0, std::int64_t c = 0) const noexcept
  {
    return static_cast<double>(bits(use, a, b, c) >> 11) * 0x1p-53;
  }

  /// Mean 0, standard deviation 1, within ±3.46: the sum of four uniform numbers (close to a normal distribution, with
  /// no far tails that would make a cell vanish).
  [[nodiscard]] constexpr double normal(
    RandomUse use, std::int64_t a, std::int64_t b = 0, std::int64_t c = 0) const noexcept
  {
    const std::uint64_t word = bits(use, a, b, c);
    double sum = 0;
    for (int part = 0; part < 4; ++part)
      sum += static_cast<double>((word >> (16 * part)) & 0xffffU) + 0.5;
    return (sum / 65536.0 - 2.0) * 1.7320508075688772;
  }

  /// Smooth noise along a line: values in about ±1.7 with standard deviation near 0.8, one independent value a unit of
  /// `at`.
  [[nodiscard]] constexpr double smooth(RandomUse use, std::int64_t line, double at) const noexcept
  {
    auto cell = static_cast<std::int64_t>(at);
    cell -= static_cast<double>(cell) > at; // round down
    const double part = at - static_cast<double>(cell);
    const double blend = part * part * (3 - 2 * part);
    return normal(use, line, cell) * (1 - blend) + normal(use, line, cell + 1) * blend;
  }

private:
  std::uint64_t seed_;
};

} // namespace lamella
