#pragma once

#include "files/SampleFile.h"
#include "micrograph/MicrographInput.h"
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
  std::optional<SampleOutput> lattice;
  std::optional<OutputFile> contours, overlay;

  /// @throws ParameterError, OutputError
  explicit Outputs(const MicrographCommandOptions& o);

  void commit();
};

/// @throws OutputError
void writeContours(const Micrograph& source, const OutputFile& file, const io::Provenance& record);

} // namespace lamella::cli
