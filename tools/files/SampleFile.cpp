#include "files/SampleFile.h"

#include "files/GridFile.h"
#include "files/Record.h"
#include "session/Text.h"

#include "core/Error.h"
#include "pictures/WritePicture.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace lamella::cli
{

std::vector<std::uint8_t> valuesInFile(const PhaseTable& phases, const std::string& ending)
{
  std::vector<std::uint8_t> values = greysOfPhases(phases);
  if (ending == ".vti" || ending == ".raw")
    std::iota(values.begin(), values.end(), std::uint8_t{ 0 });
  return values;
}

SampleOutput::SampleOutput(const std::string& name, bool overwrite)
  : file_(name, overwrite)
{
  if (ending() == ".raw")
    beside_.emplace(micrograph::recordBeside(file_.path()), overwrite);
}

void SampleOutput::commit()
{
  file_.commit();
  if (beside_)
    beside_->commit();
}

void SampleOutput::write(vtkImageData* grid, const io::Provenance& provenance) const
{
  if (ending() == ".vti")
  {
    setProvenance(grid, io::toJson(provenance));
    writeGrid(grid, file_);
    return;
  }
  const PhaseImage image = toPhaseImage(grid);
  const std::vector<std::uint8_t> values = valuesInFile(image.phases, ending());
  micrograph::PictureRecord record;
  record.provenance = io::toJson(provenance);
  record.pixelSize = image.lattice.spacing;
  for (std::size_t id = 0; id < values.size(); ++id)
    record.phases[values[id]] = image.phases.names()[id];
  if (beside_)
  {
    record.size = image.lattice.size;
    file_.write({ reinterpret_cast<const char*>(image.phase.data()), image.phase.size() });
    beside_->write(toJson(record) + "\n");
    return;
  }
  try
  {
    micrograph::writeLabels(image, file_.temporary(), values, toJson(record));
  }
  catch (const Error& error)
  {
    file_.rethrow(error);
    throw;
  }
}

void writeScan(const micrograph::Picture& picture, const OutputFile& file, const io::Provenance& provenance)
{
  micrograph::PictureRecord record;
  record.provenance = io::toJson(provenance);
  record.pixelSize = picture.lattice.spacing;
  try
  {
    micrograph::writePicture(picture, file.temporary(), toJson(record));
  }
  catch (const Error& error)
  {
    file.rethrow(error);
    throw;
  }
}

void checkSampleEnding(const std::string& output, int dimension, const std::string& option)
{
  const std::string ending = std::filesystem::path(output).extension().string();
  const std::vector<std::string> known{ ".png", ".tif", ".tiff", ".vti", ".raw" };
  if (std::find(known.begin(), known.end(), ending) == known.end())
  {
    throw ParameterError(option + " '" + output + "' has no ending that can be written",
      ending == ".jpg" || ending == ".jpeg" ? "JPEG would blur the phases: use .png"
                                            : suggestion(ending, known, "end it in .png, .tif, .vti or .raw"));
  }
  if (ending == ".png" && dimension == 3)
  {
    throw ParameterError(
      "a PNG holds one picture, and this sample is a volume", "end the name in .vti, .tif (a stack) or .raw");
  }
}

} // namespace lamella::cli
