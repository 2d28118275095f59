#include "commands/BondInput.h"

#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "session/Text.h"
#include "session/Units.h"

#include "core/Memory.h"
#include "peridynamics/ElasticStudy.h"
#include "vtkBondAlgorithm.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <fmt/format.h>

namespace lamella::cli
{

void addBondOptions(
  CLI::App& command, BondOptions& o, const std::string& className, const std::vector<std::string>& leave)
{
  std::vector<std::string> left{ "notch", "nodes-per-pixel", "keep-states", "state", "displacement", "velocity",
    "checkpoint", "checkpoint-every", "checkpoint-seconds", "continue" };
  left.insert(left.end(), leave.begin(), leave.end());
  o.settings.declare(command, className, left);
  o.settings.formerly(command, "void-bonds", "cut-void-bonds", "cut");
  addOption(command, "Bonds", "--notch", o.notches,
    "A cut from point to point, y upwards, in metres or with a unit; of a volume a corner and two edges", "X1,Y1,X2,Y2")
    ->allow_extra_args(false);
  addOption(command, "Bonds", "--refine", o.refine, "Split every pixel into N × N (× N)", "N")->capture_default_str();
}

void applyBonds(const BondOptions& o, vtkBondAlgorithm* filter)
{
  o.settings.give(filter);
  for (const std::string& text : o.notches)
  {
    std::vector<double> p;
    for (const std::string& part : split(text, ','))
      p.push_back(coordinate("--notch", part));
    if (p.size() == 4)
    {
      filter->AddNotch(p[0], p[1], p[2], p[3]);
    }
    else if (p.size() == 9)
    {
      filter->AddNotchInSpace(p.data(), p.data() + 3, p.data() + 6);
    }
    else
    {
      throw ParameterError("--notch '" + text + "' has " + std::to_string(p.size()) + " numbers",
        "a picture takes X1,Y1,X2,Y2, a volume a corner and two edges: 9 numbers");
    }
  }
  if (o.refine < 1)
    throw ParameterError(fmt::format("--refine {} is below 1", o.refine), "every pixel becomes N × N");
}

ImageSample loadBondSample(
  Session& session, const PictureOptions& picture, const BondOptions& o, vtkBondAlgorithm* filter)
{
  return loadImage(
    session, picture, o.settings,
    [&](const Lattice& lattice)
    {
      const double need = peridynamics::leastElasticBytes(lattice, filter->GetHorizon(), o.refine);
      if (const auto available = static_cast<double>(availableMemory()); need > available)
        throw MemoryError(fmt::format("the bonds and displacements of {} {} at refinement {} need {} of memory at "
                                      "least, and {} are free",
                            sizeText(lattice.size, lattice.dimension), lattice.dimension == 3 ? "voxels" : "pixels",
                            o.refine, bytesText(need), bytesText(available)),
          "take a smaller --window or --refine");
    },
    o.refine);
}

BondRun bondRun(Session& session, vtkBondAlgorithm* filter, const PictureOptions& picture, const BondOptions& options,
  const ImageSample& sample, const std::string& commandLine)
{
  (void)VtkMessages::takeWarnings(); // the same as in the field data
  BondRun run;
  run.image = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  options.settings.tellFormer(session);
  for (const std::string& warning : fieldTexts(run.image, "warnings"))
    session.warn(warning);
  run.file = picture.file;
  run.pixelSizeSource = sample.pixelSizeSource;
  run.provenance = recordRun(session, commandLine, picture.file, sample.provenance);
  run.refine = options.refine;
  run.threads = filter->GetThreads();
  run.ranks = session.ranks();
  return run;
}

void runBonds(Session& session, vtkBondAlgorithm* filter, const ImageSample& sample, const char* what)
{
  std::array<int, 6> extent = sample.extent;
  session.broadcast(extent);
  const auto image = sample.image ? sample.image : vtkSmartPointer<vtkImageData>::New();
  runFilterOnRanks(session, filter, image, extent, what);
}

} // namespace lamella::cli
