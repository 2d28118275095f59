#pragma once

#include "micrograph/MicrographInput.h"
#include "micrograph/MicrographPlan.h"
#include "session/OutputFile.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"
#include "outlines/ContourLattice.h"

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

/// @param lattice of vtkMicrographLattice
/// @throws OutputError
void writeLattice(vtkImageData* lattice, Outputs& outputs, const io::Provenance& record);
void writeContours(const Micrograph& source, const OutputFile& file, const io::Provenance& record);

} // namespace lamella::cli
