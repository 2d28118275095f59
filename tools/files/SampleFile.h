#pragma once

#include "session/OutputFile.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"
#include "pictures/Picture.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

class vtkImageData;

/// Samples as files: .vti, .png, .tif and .raw.
namespace lamella::cli
{

/// @throws ParameterError for a name whose ending is none of these, or that of a picture where there is a volume
void checkSampleEnding(const std::string& output, int dimension, const std::string& option = "-o");

/// The value that stands for each phase in a file of this ending.
[[nodiscard]] std::vector<std::uint8_t> valuesInFile(const PhaseTable& phases, const std::string& ending);

/// A sample that is to be written: .vti, or its phases as a picture, a stack or a raw volume, with the record inside it
/// or, for .raw, beside it.
class SampleOutput
{
public:
  /// @throws ParameterError, OutputError
  SampleOutput(const std::string& name, bool overwrite);
  [[nodiscard]] std::string ending() const { return file_.path().extension().string(); }
  /// @throws OutputError
  void write(vtkImageData* image, const io::Provenance& provenance) const;
  /// @throws OutputError; Cancelled
  void commit();

private:
  OutputFile file_;
  std::optional<OutputFile> beside_;
};

/// Writes a picture that is no labels as PNG, with its record inside. @throws OutputError
void writeScan(const micrograph::Picture& picture, const OutputFile& file, const io::Provenance& provenance);

} // namespace lamella::cli
