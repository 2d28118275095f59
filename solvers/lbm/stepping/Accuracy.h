#pragma once

#include <span>
#include <string>

namespace lamella::lbm
{

/// How long a line along x stays in nodes of one diffusivity.
struct Chord
{
  double diffusivity = 0; ///< over the largest
  double length = 0;      ///< mean, in spacings
};

/// What to say of one relaxation time when τ − ½ of the phase that conducts best is `relaxation`. `chords` are those of
/// all diffusivities that occur, 0 included, the best first. Interfaces are as they should be at τ = 1. Beyond, it is
/// as if every piece of the best phase had lost τ − 1 spacings: measured on generated softwood
/// (docs/solvers/lattice-boltzmann.md) the loss (τ − 1)/(chord + τ − 1) is met within a third of itself up to τ = 5.
/// Phases below it gain 1 − τ spacings, which is said where it is more than 3 % of their pieces. Empty: neither,
/// or one diffusivity everywhere.
[[nodiscard]] std::string singleRateWarning(double relaxation, std::span<const Chord> chords);

} // namespace lamella::lbm
