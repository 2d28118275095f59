#include "micrograph/MicrographOptions.h"

#include "program/Commands.h"
#include "session/Text.h"

#include "core/Error.h"
#include "vtkPictureReader.h"

#include <vtkNew.h>

#include <cmath>

namespace lamella::cli
{

lamella::PictureOptions pictureOptions(const MicrographOptions& options, bool scan)
{
  vtkNew<vtkPictureReader> said;
  said->SetSegment(scan);
  options.settings().give(said);
  return said->GetOptions();
}

std::array<double, 4> polygonWindow(const std::string& text)
{
  std::array<double, 4> box{};
  const auto parts = split(text, ',');
  for (std::size_t i = 0; i < 4; ++i)
  {
    const auto value = parts.size() == 4 ? toNumber(parts[i]) : std::nullopt;
    if (!value || !std::isfinite(*value) || (i > 1 && *value <= 0))
    {
      throw ParameterError("--window '" + text + "' is no window of polygons",
        "write it as --window X,Y,WIDTH,HEIGHT in the file's own coordinates, from the lower left");
    }
    box[i] = *value;
  }
  return { box[0], box[1], box[0] + box[2], box[1] + box[3] };
}

void addMicrographInput(CLI::App& command, MicrographOptions& o)
{
  command
    .add_option("FILE", o.picture.file,
      "A scan (PNG, JPEG, TIFF, PGM, PPM, BMP), a label picture, a .vti with phases, or outlines: .json, .json.gz, "
      ".vtp")
    ->required();
  SettingOptions& settings = o.picture.settings;
  settings.declareSome(command, "vtkPictureReader", { "pixel-size" }, "Sample");
  settings.declareSome(
    command, "vtkPictureReader", { "window" }, "Sample", false); // of polygons it is no whole numbers
  settings.declareSome(command, "vtkPictureReader", { "phase", "other", "array" }, "Labels");
  settings.declareSome(command, "vtkMicrographContours", { "lumen-phase" }, "Labels");
  settings.declareSome(command, "vtkMicrographContours", { "level" }, "Grey");
  command.add_flag("--shares", o.shares, "FILE's greys are lumen's share of each pixel")->group("Grey");
  settings.declareSome(command, "vtkPictureReader", { "segment", "lumen" }, "Scan");
  settings.declareSome(command, "vtkPictureReader", scanWords(), "Scan");
  settings.declare(command, "vtkMicrographContours", { "basis", "lumen-below", "smallest-area" });
  settings.declare(command, "vtkMicrographPolygonReader", { "file", "file-name", "window" });
}

} // namespace lamella::cli
