#pragma once

#include "MicrographPlan.h"

#include "lattice/Phases.h"
#include "micrograph/ContourLattice.h"

#include <cstdint>

/// A middle lamella from a picture's labels.
namespace lamella::cli
{

/// The lamella's phase among a picture's labels. @throws ParameterError, InputError
[[nodiscard]] std::uint8_t labelledLamella(const MicrographCommandOptions& o, const PhaseTable& phases);

/// Wall nodes that lie in a pixel labelled lamella become that.
/// @param stretch of the lattice's lengths along y (micrograph::FittedContours)
[[nodiscard]] PhaseImage fromLabels(
  const micrograph::ContourLattice& lattice, const PhaseImage& labels, std::uint8_t lamella, double stretch = 1);

/// Share of the wall's nodes.
[[nodiscard]] double lamellaShare(const PhaseImage& image);

} // namespace lamella::cli
