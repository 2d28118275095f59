#pragma once

#include "MicrographPlan.h"

#include "lattice/Phases.h"

#include <cstdint>

/// A middle lamella from a picture's labels.
namespace lamella::cli
{

/// The lamella's phase among a picture's labels. @throws ParameterError, InputError
[[nodiscard]] std::uint8_t labelledLamella(const MicrographCommandOptions& o, const PhaseTable& phases);

} // namespace lamella::cli
