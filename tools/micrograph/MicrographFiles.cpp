#include "micrograph/MicrographFiles.h"

#include "files/GridFile.h"
#include "files/SampleFile.h"
#include "session/Text.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "outlines/PolygonFile.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>

namespace lamella::cli
{

Outputs::Outputs(const MicrographCommandOptions& o)
{
  if (!o.output.empty())
    checkSampleEnding(o.output, 2);
  if (!o.contours.empty())
  {
    const std::vector<std::string> known{ ".vtp", ".json", ".json.gz" };
    if (std::find(known.begin(), known.end(), endingOf(o.contours)) == known.end())
    {
      throw ParameterError("--contours '" + o.contours + "' has no ending that can be written",
        suggestion(endingOf(o.contours), known, "end it in .vtp, .json or .json.gz"));
    }
  }
  if (!o.overlay.empty() && endingOf(o.overlay) != ".png")
    throw ParameterError("--overlay '" + o.overlay + "' has no ending that can be written", "end it in .png");
  if (o.overlayWidth != 0 && (o.overlayWidth < 100 || o.overlayWidth > 20000))
  {
    throw ParameterError(
      fmt::format("--overlay-width {} is outside 100 to 20000", o.overlayWidth), "leave it out to have it chosen");
  }
  std::vector<std::string> names;
  for (const std::string& name : { o.output, o.contours, o.overlay })
  {
    if (!name.empty() && std::find(names.begin(), names.end(), name) != names.end())
      throw ParameterError("'" + name + "' is to be written twice", "give every output a name of its own");
    names.push_back(name);
  }
  const auto open = [&](auto& file, const std::string& name)
  {
    if (!name.empty())
      file.emplace(name, o.common.overwrite);
  };
  open(lattice, o.output);
  open(contours, o.contours);
  open(overlay, o.overlay);
}

void Outputs::commit()
{
  if (lattice)
    lattice->commit();
  for (auto* const file : { &contours, &overlay })
    if (*file)
      (*file)->commit();
}

void writeContours(const Micrograph& source, const OutputFile& file, const io::Provenance& record)
{
  if (file.path().extension() == ".vtp")
  {
    setProvenance(source.outlines, io::toJson(record));
    writeGrid(source.outlines, file);
    return;
  }
  try
  {
    micrograph::writePolygons(source.contours, file.temporary());
  }
  catch (const Error& error)
  {
    file.rethrow(error);
    throw;
  }
}

} // namespace lamella::cli
