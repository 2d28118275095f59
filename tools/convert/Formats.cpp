#include "convert/Formats.h"

#include "convert/CheckpointTable.h"
#include "convert/Notes.h"
#include "convert/Pictures.h"
#include "convert/PointTable.h"
#include "convert/Surface.h"
#include "convert/TiffFile.h"
#include "convert/Types.h"
#include "files/GridFile.h"
#include "files/TableText.h"
#include "session/Text.h"

#include "CellConversion.h"
#include "GridReaders.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

const std::regex& numberFormat()
{
  static const std::regex format("%(0?)([0-9]*)d");
  return format;
}

bool anyNumbers(int type, int)
{
  return type != VTK_BIT && typeNamed(typeName(type)).has_value() && type != VTK_STRING;
}

bool anything(int, int)
{
  return true;
}

std::vector<std::string> itself(const std::string& output, Step&)
{
  return { output };
}

/// The phases of pictures are spread over the greys, so that they can be seen.
std::unique_ptr<Volume> spreadPhases(std::unique_ptr<Volume> volume, const std::vector<std::uint8_t>& greys)
{
  if (greys.empty())
    return volume;
  return changed(std::move(volume),
    [greys](vtkImageData* image)
    {
      auto* const ids = vtkUnsignedCharArray::SafeDownCast(onlyArray(image));
      vtkNew<vtkUnsignedCharArray> values;
      values->SetName(ids->GetName());
      values->SetNumberOfValues(ids->GetNumberOfValues());
      for (vtkIdType i = 0; i < ids->GetNumberOfValues(); ++i)
      {
        if (ids->GetValue(i) >= greys.size())
          throw InputError(fmt::format("'phase' holds {}, and {} phases have names", ids->GetValue(i), greys.size()),
            "write it as .raw, .mhd or .hdf, which keep the ids");
        values->SetValue(i, greys[ids->GetValue(i)]);
      }
      image->GetPointData()->Initialize();
      image->GetPointData()->SetScalars(values);
    });
}

std::string imageNotes(Step& step, const std::vector<std::uint8_t>& greys)
{
  vtkImageData* const sample = step.volume->sample();
  return notesOf(sample, step.volume->extent(), greys, onlyArray(sample)->GetDataType(), step.noted);
}

Step openPicture(const std::string& path, Reading& reading)
{
  PictureReading pictures{ reading.raw.read.pixelSize, reading.lossy };
  Step step{ openPictures(path, pictures) };
  reading.warnings.insert(reading.warnings.end(), pictures.warnings.begin(), pictures.warnings.end());
  return step;
}

std::vector<std::string> pngFiles(const std::string& output, Step& step)
{
  const int layers = step.volume->layers();
  if (layers == 1)
    return { numbered(output, 0) };
  if (!isPattern(output))
  {
    throw ParameterError(fmt::format("a PNG holds one picture, and this is a volume of {} layers", layers),
      fmt::format("give a pattern: -o {}, or end the name in .tif", withSuffix(output, "_%04d").string()));
  }
  std::vector<std::string> names;
  for (int layer = 0; layer < layers; ++layer)
    names.push_back(numbered(output, static_cast<std::size_t>(layer)));
  return names;
}

void writePicture(const Writing& w)
{
  const std::string ending = w.files.front().path().extension().string();
  const auto greys = greysFor(w.step.volume->sample(), ending);
  const std::string notes = imageNotes(w.step, greys);
  const auto volume = spreadPhases(std::move(w.step.volume), greys);
  if (lower(ending) == ".png")
    writePngs(w.session, *volume, w.files, notes);
  else
    writeTiff(w.session, *volume, w.files.front(), notes);
}

template <RawLayout (*Layout)(const fs::path&)>
Step openHeader(const std::string& path, Reading& reading)
{
  requireFile(path);
  RawLayout layout = Layout(path);
  requireFile(layout.file.string());
  if (const auto pixelSize = reading.raw.read.pixelSize)
  {
    layout.pixelSizeSource = "option"; // its value is set for all formats alike
    layout.spacing.fill(*pixelSize);
  }
  return { withNotes(openRaw(layout), notesBeside(path)) };
}

Step openRawFile(const std::string& path, Reading& reading)
{
  requireFile(path);
  return { withNotes(openRaw(rawLayout(path, reading.raw)), notesBeside(path)) };
}

std::vector<std::string> withNotesBeside(const std::string& output, Step&)
{
  return { output, output + ".json" };
}

bool hasData(const std::string& output)
{
  const std::string ending = endingOf(output.c_str());
  return ending == ".mhd" || ending == ".nhdr";
}

/// A header alone has its values beside it.
std::vector<std::string> headerFiles(const std::string& output, Step& step)
{
  auto names = withNotesBeside(output, step);
  if (hasData(output))
    names.push_back(fs::path(output).replace_extension(".raw").string());
  return names;
}

std::string noHeader(vtkImageData*, const std::array<int, 6>&, const std::string&)
{
  return "";
}

/// Header, if any, and values into one file or two; the notes into the second.
template <std::string (*header)(vtkImageData*, const std::array<int, 6>&, const std::string&)>
void writeNumbers(const Writing& w)
{
  Volume& volume = *w.step.volume;
  const bool two = w.files.size() > 2;
  if (two)
    w.files[0].write(header(volume.sample(), volume.extent(), w.files[2].path().filename().string()));
  ByteStream stream(w.files[two ? 2 : 0]);
  if (!two)
    stream.write(header(volume.sample(), volume.extent(), ""));
  forSlabs(w.session, volume,
    [&](vtkDataArray* values, int, int)
    {
      stream.write(values->GetVoidPointer(0),
        static_cast<std::size_t>(values->GetNumberOfValues()) * static_cast<std::size_t>(values->GetDataTypeSize()));
    });
  stream.finish();
  w.files[1].write(imageNotes(w.step, greysFor(volume.sample(), ".raw")) + "\n");
}

Step openXmlFile(const std::string& path, Reading&)
{
  return openXml(path);
}

Step openHdfFile(const std::string& path, Reading& reading)
{
  requireFile(path);
  if (isCheckpoint(path))
    return { .table = checkpointTable(path, reading.arrays) };
  return openHdf(path);
}

void writeVti(const Writing& w)
{
  writeXmlImage(w.session, *w.step.volume, w.files.front());
}

/// Points as they are, or of the other kind.
template <class Other, auto Convert>
void writePoints(const Writing& w)
{
  vtkSmartPointer<vtkPointSet> points = w.step.points;
  if (auto* const other = Other::SafeDownCast(points))
    points = Convert(other);
  writeGrid(points, w.files.front());
}

void writeVtkHdf(const Writing& w)
{
  if (w.step.volume != nullptr)
    writeHdf(w.session, *w.step.volume, w.files.front());
  else
    writeHdf(w.session, w.step.points, w.files.front());
}

void writeStl(const Writing& w)
{
  writeSurface(w.step.points, w.files[0]);
  w.files[1].write(notesOf(w.step.points, {}, {}, VTK_FLOAT) + "\n");
}

Step openCsv(const std::string& path, Reading& reading)
{
  return openTable(path, reading.arrays);
}

void writeCsv(const Writing& w)
{
  std::string notes;
  if (w.step.table != nullptr)
  {
    w.files[0].write(toCsv(w.step.table));
    notes =
      "{\"provenance\": " + provenance(w.step.table) + ", \"columns\": " + unitsOf(w.step.table, true).dump() + "}";
  }
  else if (w.step.volume != nullptr)
  {
    Volume& volume = *w.step.volume;
    writeTable(w.session, volume, w.files[0]);
    notes = notesOf(volume.sample(), volume.extent(), {}, VTK_DOUBLE);
  }
  else
  {
    writeTable(w.session, w.step.points, w.files[0]);
    notes = notesOf(w.step.points, {}, {}, VTK_DOUBLE);
  }
  w.files[1].write(notes + "\n");
}

} // namespace

const std::vector<Format>& formats()
{
  const char* const inside = "in the file";
  const char* const besideIt = "NAME.json beside it";
  static const std::vector<Format> table{
    { "PNG", { ".png" }, Image, Image, "u8, u16; 1 or 3 values a pixel", false, true, true, inside, pngHolds,
      openPicture, pngFiles, writePicture },
    { "TIFF", { ".tif", ".tiff" }, Image, Image, "all; 3 values a pixel of u8, u16", false, true, false, inside,
      tiffHolds, openPicture, itself, writePicture },
    { "JPEG", { ".jpg", ".jpeg" }, Image, 0, "u8; 1 or 3 values a pixel", false, true, false, "not written", anything,
      openPicture, itself, nullptr },
    { "PGM, PPM", { ".pgm", ".ppm", ".pnm" }, Image, 0, "u8, u16; 1 or 3 values a pixel", false, true, false,
      "not written", anything, openPicture, itself, nullptr },
    { "BMP", { ".bmp" }, Image, 0, "u8; 1 or 3 values a pixel", false, true, false, "not written", anything,
      openPicture, itself, nullptr },
    { "raw", { ".raw", ".bin" }, Image, Image, "all", false, true, false, besideIt, anyNumbers, openRawFile,
      withNotesBeside, writeNumbers<noHeader> },
    { "MetaImage", { ".mhd", ".mha" }, Image, Image, "all", false, true, false, besideIt, anyNumbers,
      openHeader<micrograph::metaLayout>, headerFiles, writeNumbers<metaHeader> },
    { "NRRD", { ".nhdr", ".nrrd" }, Image, Image, "all", false, true, false, besideIt, anyNumbers,
      openHeader<micrograph::nrrdLayout>, headerFiles, writeNumbers<nrrdHeader> },
    { "NumPy", { ".npy" }, Image, Image, "all", false, true, false, besideIt, anyNumbers,
      openHeader<micrograph::numpyLayout>, withNotesBeside, writeNumbers<numpyHeader> },
    { "NIfTI", { ".nii", ".nii.gz", ".hdr" }, Image, 0, "all", false, true, false, "not written", anyNumbers,
      openHeader<micrograph::niftiLayout>, itself, nullptr },
    { "VTK legacy", { ".vtk" }, Image, 0, "all", false, true, false, "not written", anyNumbers,
      openHeader<micrograph::legacyVtkLayout>, itself, nullptr },
    { "VTK image", { ".vti" }, Image, Image, "all", true, true, false, inside, anything, openXmlFile, itself,
      writeVti },
    { "VTK poly data", { ".vtp" }, Poly, Points, "all", true, false, false, inside, anything, openXmlFile, itself,
      writePoints<vtkUnstructuredGrid, toPolyData> },
    { "VTK unstructured grid", { ".vtu" }, Mesh, Points, "all", true, false, false, inside, anything, openXmlFile,
      itself, writePoints<vtkPolyData, toUnstructuredGrid> },
    { "VTKHDF 1.0", { ".hdf", ".vtkhdf", ".h5", ".hdf5" }, Image | Mesh | Numbers, Image | Points,
      "all but bits and texts", true, true, false, inside, anyNumbers, openHdfFile, itself, writeVtkHdf },
    { "CSV", { ".csv" }, Image | Poly, Image | Points | Numbers, "all; whole numbers to 2^53", true, true, false,
      besideIt, anyNumbers, openCsv, withNotesBeside, writeCsv },
    { "XDMF 3", { ".xdmf", ".xmf" }, 0, Image, "all; u64 below 2^63", true, true, false, "NAME.h5 beside it",
      anyNumbers, nullptr, itself, writeVtkHdf },
    { "STL, PLY", { ".stl", ".ply" }, 0, Surface, "none", true, false, false, besideIt, anyNumbers, nullptr,
      withNotesBeside, writeStl },
  };
  return table;
}

const Format& formatOf(const std::string& option, const std::string& path)
{
  const std::string ending = endingOf(path.c_str());
  std::vector<std::string> known{ ".pvd" };
  for (const Format& format : formats())
  {
    if (std::ranges::find(format.endings, ending) != format.endings.end())
      return format;
    known.insert(known.end(), format.endings.begin(), format.endings.end());
  }
  throw ParameterError(fmt::format("{} '{}' has no ending of a format that is known", option, path),
    suggestion(ending, known, "lamella convert --formats lists them"));
}

std::string formatsText()
{
  std::string text =
    "| format | endings | read | written | values | arrays | slabs | names, units, place, provenance |\n"
    "|---|---|---|---|---|---|---|---|\n";
  const auto kinds = [](unsigned mask)
  {
    std::string words;
    for (const auto& [bits, word] : { std::pair<unsigned, const char*>{ Picture2D, "2D" }, { Volume3D, "3D" },
           { Points, "points" }, { Numbers, "numbers" }, { Surface, "surfaces" } })
    {
      words += (mask & bits) != 0 ? std::string(words.empty() ? "" : ", ") + word : "";
    }
    return words;
  };
  for (const Format& format : formats())
  {
    std::string endings;
    for (const std::string& ending : format.endings)
      endings += fmt::format("{}`{}`", endings.empty() ? "" : ", ", ending);
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", format.name, endings, kinds(format.reads),
      kinds(format.writes), format.values,
      format.writes == Surface ? "none"
        : format.manyArrays    ? "many"
                               : "one",
      format.slabs ? "yes" : "", format.where);
  }
  return text + "| series | `.pvd` | steps of the VTK formats | the same | | | | times, too |\n";
}

bool isPattern(const std::string& name)
{
  return std::regex_search(fs::path(name).filename().string(), numberFormat());
}

std::string numbered(const std::string& pattern, std::size_t number)
{
  const fs::path path(pattern);
  const std::string name = path.filename().string();
  std::smatch match;
  if (!std::regex_search(name, match, numberFormat()))
    return pattern;
  const std::size_t width = match[2].length() > 0 ? std::min(18UL, std::stoul(match[2])) : 0;
  return (path.parent_path() / (match.prefix().str() + fmt::format("{:0{}}", number, width) + match.suffix().str()))
    .string();
}

} // namespace lamella::cli
