#pragma once

#include "session/OutputFile.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"
#include "pictures/Picture.h"

#include <cstdint>
#include <string>
#include <vector>

/// Samples as files: .vti (written with GridFile.h), .png, .tif and .raw.
namespace lamella::cli
{

/// @throws ParameterError for a name whose ending is none of these, or that of a picture where there is a volume
void checkSampleEnding(const std::string& output, int dimension, const std::string& option = "-o");

/// The value that stands for each phase in a file of this ending.
[[nodiscard]] std::vector<std::uint8_t> valuesInFile(const PhaseTable& phases, const std::string& ending);

/// Writes a picture, a stack or a raw volume with its record inside it or, for .raw, `beside` it.
/// @throws OutputError
void writeLabels(const PhaseImage& image, const OutputFile& file, OutputFile* beside, const io::Provenance& provenance);

/// Writes a picture that is no labels as PNG, with its record inside. @throws OutputError
void writeScan(const micrograph::Picture& picture, const OutputFile& file, const io::Provenance& provenance);

} // namespace lamella::cli
