#include "micrograph/MicrographInput.h"

#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "micrograph/MicrographGrey.h"
#include "session/Session.h"
#include "session/Text.h"

#include "ContourData.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "core/Memory.h"
#include "lattice/PhaseNames.h"
#include "vtkLatticeConversion.h"
#include "vtkMicrographContours.h"
#include "vtkMicrographPolygonReader.h"
#include "vtkProvenance.h"

#include <vtkDataObject.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>

namespace lamella::cli
{

namespace
{

void refuse(const MicrographOptions& options, const std::vector<std::string>& words, const std::string& why)
{
  if (const std::string given = options.settings().firstGiven(words); !given.empty())
    throw ParameterError(given + " is for " + why, "leave it out: '" + options.picture.file + "' is something else");
}

const std::vector<std::string> ofLabels{ "phase", "other", "lumen-phase" };
const std::vector<std::string> ofPolygons{ "unit", "y-down" };
const std::vector<std::string> ofMasks{ "smooth", "wavelength" };

void requirePixelSize(const std::string& source, const std::string& file)
{
  if (source == "none")
    throw InputError("the pixel size of '" + file + "' is not known", "add --pixel-size, such as --pixel-size 0.5um");
}

Micrograph loadOutlines(Session& session, const MicrographOptions& options)
{
  const std::string& file = options.picture.file;
  refuse(options, scanWords(), "scans");
  refuse(options, { "lumen" }, "scans and grey pictures");
  refuse(options, ofLabels, "labels");
  refuse(options, { "array" }, "pictures in a .vti");
  refuse(options, ofMasks, "pictures");
  refuse(options, { "pixel-size", "tolerance" }, "pictures");
  if (options.grey())
    throw ParameterError(std::string(options.shares ? "--shares" : "--level") + " is for grey pictures",
      "leave it out: '" + file + "' is something else");
  requireFile(file);
  Micrograph found;
  found.kind = MicrographKind::Polygons;
  const bool outlines = endingOf(file) == ".vtp";
  if (outlines)
    refuse(options, ofPolygons, "polygons in .json or .json.gz");
  vtkNew<vtkMicrographPolygonReader> reader;
  options.settings().give(reader);
  reader->SetFileName(file.c_str());
  if (const std::string window = options.settings().text("window"); !window.empty())
    reader->SetWindow(polygonWindow(window).data());
  runFilter(session, reader, "outlines");
  found.warnings = VtkMessages::takeWarnings();
  found.outlines = reader->GetOutput();
  found.contours = contoursFrom(found.outlines);
  found.provenance = outlines ? provenance(found.outlines) : "";
  found.unit = outlines ? 1 : fieldNumbers(found.outlines, "unit").at(0);
  return found;
}

/// Finds the outlines in the picture.
void extract(Session& session, Micrograph& found, vtkMicrographContours* filter, const MicrographOptions& options)
{
  filter->SetInputData(found.picture);
  setFieldText(found.picture, "pixel_size_source", found.pixelSizeSource);
  options.settings().give(filter);
  runFilter(session, filter, "outlines");
  const std::vector<std::string> warnings = VtkMessages::takeWarnings();
  found.warnings.insert(found.warnings.end(), warnings.begin(), warnings.end());
  found.outlines = filter->GetOutput();
  found.contours = contoursFrom(found.outlines);
  const Lattice lattice = lamella::latticeOf(found.picture);
  found.pixel = lattice.spacing;
  found.size = lattice.size;
}

Micrograph loadGrey(Session& session, const MicrographOptions& options)
{
  const PictureOptions& picture = options.picture;
  refuse(options, scanWords(), "scans that are segmented");
  refuse(options, ofLabels, "labels");
  refuse(options, ofMasks, "labels and scans that are segmented");
  if (!isVtkImage(picture.file))
    refuse(options, { "array" }, "pictures in a .vti");
  GreyPicture grey = readGreyPicture(options);
  requirePixelSize(grey.pixelSizeSource, picture.file);
  Micrograph found;
  found.kind = MicrographKind::Grey;
  found.pixelSizeSource = std::move(grey.pixelSizeSource);
  found.provenance = std::move(grey.provenance);
  found.warnings = std::move(grey.warnings);
  found.picture = grey.image;
  vtkNew<vtkMicrographContours> filter;
  filter->SetBasis(options.shares ? vtkMicrographContours::SHARES : vtkMicrographContours::LEVEL);
  filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, grey.array.c_str());
  filter->SetLumenBelow(options.settings().text("lumen") == "dark");
  extract(session, found, filter, options);
  found.scan = std::move(grey.picture);
  return found;
}

Micrograph loadLabels(Session& session, const MicrographOptions& options)
{
  refuse(options, scanWords(), "scans");
  refuse(options, { "lumen" }, "scans and grey pictures");
  Sample sample = loadSample(options.picture, refuseVolume);
  refuseVolume(sample.image.lattice);
  requirePixelSize(sample.pixelSizeSource, options.picture.file);
  Micrograph found;
  found.kind = MicrographKind::Labels;
  found.pixelSizeSource = sample.pixelSizeSource;
  found.provenance = sample.provenance;
  found.warnings = sample.warnings;
  found.labels = std::make_shared<PhaseImage>(std::move(sample.image));
  found.picture = toImageData(*found.labels);
  vtkNew<vtkMicrographContours> filter;
  extract(session, found, filter, options);
  return found;
}

/// Marks as seen from a window of the picture; those outside it go.
std::vector<micrograph::Mark> marksIn(
  std::vector<micrograph::Mark> marks, const std::array<std::int64_t, 3>& first, const Lattice& lattice)
{
  const auto width = static_cast<int>(lattice.size[0]);
  const auto height = static_cast<int>(lattice.size[1]);
  for (micrograph::Mark& m : marks)
  {
    m.x0 = std::clamp(m.x0 - static_cast<int>(first[0]), 0, width);
    m.x1 = std::clamp(m.x1 - static_cast<int>(first[0]), 0, width);
    m.y0 = std::clamp(m.y0 - static_cast<int>(first[1]), 0, height);
    m.y1 = std::clamp(m.y1 - static_cast<int>(first[1]), 0, height);
  }
  std::erase_if(marks, [](const micrograph::Mark& m) { return m.x1 <= m.x0 || m.y1 <= m.y0; });
  return marks;
}

Micrograph segmentScan(Session& session, const MicrographOptions& options, PictureFile file)
{
  refuse(options, ofLabels, "labels");
  micrograph::Picture& picture = file.picture;
  refuseVolume(picture.lattice);
  const lamella::PictureOptions said = pictureOptions(options, true);
  const auto& window = said.window;
  requireWindowFits(picture.lattice, window);
  const auto first = window ? firstNode(picture.lattice, *window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  micrograph::SegmentOptions how = *said.segment;
  // The whole scan, for the light and the threshold; the window is cut afterwards.
  how.judged = window;
  micrograph::Segmentation parts = micrograph::segment(picture, how);
  Session::checkInterrupt();
  Micrograph found;
  found.pixelSizeSource = picture.pixelSizeSource;
  found.provenance = file.record ? file.record->provenance : "";
  found.warnings = picture.warnings;
  found.warnings.insert(found.warnings.end(), parts.warnings.begin(), parts.warnings.end());
  found.segmentation = parts.report;
  if (window)
  {
    parts.image = crop(parts.image, *window);
    micrograph::crop(picture, *window);
  }
  found.marks = marksIn(std::move(parts.marks), first, picture.lattice);
  found.picture = toImageData(std::move(parts.image));
  setFieldTexts(found.picture, "segmentation", parts.report.lines());
  setFieldNumbers(found.picture, "surface_doubt", std::array{ parts.report.surfaceDoubt });
  vtkNew<vtkMicrographContours> filter;
  extract(session, found, filter, options);
  found.scan = std::move(picture);
  return found;
}

/// Few greys: labels whose names are not known, rather than a scan.
bool looksLikeLabels(const micrograph::Picture& picture)
{
  if (!picture.colour.empty())
    return false;
  std::set<std::uint16_t> greys;
  for (const std::uint16_t grey : picture.grey)
  {
    greys.insert(grey);
    if (greys.size() > 8)
      return false;
  }
  return greys.size() > 1; // one grey: segment() says it best
}

} // namespace

bool isOutlineFile(const std::string& path)
{
  const std::string name = lower(path);
  return name.ends_with(".json") || name.ends_with(".json.gz") || name.ends_with(".vtp");
}

Micrograph loadMicrograph(Session& session, const MicrographOptions& options)
{
  const PictureOptions& picture = options.picture;
  if (isOutlineFile(picture.file))
  {
    if (options.settings().given("segment"))
      throw ParameterError("--segment is for scans, and '" + picture.file + "' holds outlines", "leave --segment out");
    return loadOutlines(session, options);
  }
  refuse(options, ofPolygons, "polygons");
  if (options.grey())
    return loadGrey(session, options);
  const bool segment = options.settings().given("segment");
  const bool named = !options.settings().firstGiven({ "phase", "other" }).empty();
  if (segment && named)
  {
    throw ParameterError("--segment and --phase contradict each other",
      "leave --phase and --other out: the phases of a segmented scan are 'lumen' and 'wall'");
  }
  if (!segment && (isVtkImage(picture.file) || named))
    return loadLabels(session, options);
  micrograph::ReadOptions read = pictureOptions(options, true).read;
  read.keepColour = true;
  read.sizeKnown = [&](const Lattice& whole)
  {
    refuseVolume(whole);
    // Greys and colours of 16 bits and what segmenting holds beside them.
    const double bytes = 40 * static_cast<double>(whole.count());
    if (const auto available = static_cast<double>(availableMemory()); bytes > available)
      throw MemoryError(fmt::format("segmenting {} pixels takes about {}, and {} are free", sizeText(whole.size, 2),
                          bytesText(bytes), bytesText(available)),
        "cut the scan into parts");
  };
  PictureFile file = readPictureFile(picture.file, read, options.settings().text("array"));
  if (!segment && ((file.record && !file.record->phases.empty()) || looksLikeLabels(file.picture)))
    return loadLabels(session, options);
  requirePixelSize(file.picture.pixelSizeSource, picture.file);
  return segmentScan(session, options, std::move(file));
}

} // namespace lamella::cli
