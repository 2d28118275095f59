#pragma once

#include <string>

namespace lamella::lbm
{

/// What to say of one relaxation time when that of the phase that conducts best is `tau` and a line through it stays in
/// it for `chord` spacings on average; empty up to τ = 1, where interfaces are as they should be. Beyond, it is as if
/// every piece of that phase had lost τ − 1 spacings: measured on generated softwood
/// (docs/solvers/lattice-boltzmann.md) the loss (τ − 1)/(chord + τ − 1) is met within a third of itself up to τ = 5.
[[nodiscard]] std::string singleRateWarning(double tau, double chord);

} // namespace lamella::lbm
