#pragma once

#include "MicrographInput.h"
#include "MicrographPlan.h"
#include "OutputFile.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"
#include "micrograph/ContourLattice.h"
#include "micrograph/WallDirection.h"

#include <optional>

namespace lamella::cli
{

/// The files, which are refused at once where they cannot be written.
struct Outputs
{
  std::optional<OutputFile> lattice, beside, contours, overlay;

  /// @throws ParameterError, OutputError
  explicit Outputs(const MicrographCommandOptions& o);

  void commit();
};

/// All that lives on the lattice's nodes.
struct OnLattice
{
  micrograph::ContourLattice lattice;
  micrograph::WallDirections directions;
  PhaseImage phases; ///< void, secondary wall, middle lamella; or lumen and wall
};

/// @throws OutputError
void writeLattice(const OnLattice& made, const Micrograph& source, Outputs& outputs, const io::Provenance& record);
void writeContours(const micrograph::ContourSet& contours, const OutputFile& file, const io::Provenance& record);

} // namespace lamella::cli
