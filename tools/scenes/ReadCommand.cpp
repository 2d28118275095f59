#include "scenes/Scene.h"

#include "commands/SampleRun.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/Record.h"

#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <filesystem>

namespace lamella::cli
{

namespace
{

struct ReadOptions
{
  CommonOptions common;
  PictureOptions picture;
  std::string output;
};

/// Nothing said of it: the file as it is.
bool asItIs(const PictureOptions& o)
{
  return o.settings.firstGiven({ "phase", "other", "window", "pixel-size", "slice-distance", "array", "segment" })
    .empty();
}

void readSample(Session& session, const ReadOptions& o, const std::string& commandLine)
{
  Json json;
  json["file"] = o.picture.file;
  const std::string ending = std::filesystem::path(o.picture.file).extension().string();
  vtkSmartPointer<vtkDataObject> data;
  if (ending == ".vtp" || (ending == ".vti" && asItIs(o.picture)))
    data = readGrid(o.picture.file);
  if (auto* const image = vtkImageData::SafeDownCast(data))
    if (phaseNames(image).size() == 0 || !image->GetPointData()->HasArray("phase"))
      data = nullptr;
  if (data != nullptr)
  {
    setProvenance(data, io::toJson(recordRun(session, commandLine, o.picture.file, provenance(data))));
  }
  else
  {
    Sample sample = loadSample(o.picture);
    tellDoubts(session, sample);
    json["phases"] = phasesJson(sample.image.phases.names(), sample.image.fractions());
    const auto image = imageOf(sample);
    setProvenance(image, io::toJson(recordRun(session, commandLine, o.picture.file, sample.provenance)));
    data = image;
  }
  if (!o.output.empty()) // asked for its numbers alone where the next stage reads the file itself
    writeGrid(data, OutputFile(o.output, o.common.overwrite));
  session.print(dump(json));
}

} // namespace

Command readCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("read", "Takes a sample from a file");
  auto o = std::make_shared<ReadOptions>();
  addPictureOptions(*app, o->picture);
  addSliceDistance(*app, o->picture);
  std::vector<std::string> words = scanWords();
  std::erase(words, "threshold"); // is there
  o->picture.settings.declareSome(*app, "vtkPictureReader", words, "Scan");
  addOutputOptions(*app, o->output, o->common, "The sample in memory");
  addReportOptions(*app, o->common);
  return aloneCommand(app, o, readSample);
}

} // namespace lamella::cli
