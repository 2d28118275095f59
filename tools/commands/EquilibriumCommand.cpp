#include "commands/BondInput.h"
#include "commands/EquilibriumReport.h"
#include "files/GridFile.h"
#include "program/Commands.h"
#include "session/OutputFile.h"

#include "core/Clock.h"
#include "vtkBondEquilibrium.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct EquilibriumOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  std::string output;
};

void equilibrium(Session& session, const EquilibriumOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkBondEquilibrium> filter;
  applyBonds(options.bonds, filter);
  for (const char* const word : { "stress", "strain-energy" })
    if (options.output.empty() && options.bonds.settings.given(word))
      throw ParameterError(fmt::format("--{} without a file to write it to", word), "add -o FILE.vti");
  if (!options.output.empty() && !isVtkImage(options.output))
  {
    throw ParameterError("-o '" + options.output + "': the fields are written as .vti",
      "end the name in .vti; numbers go to standard output, as JSON with --json");
  }
  BondSample sample;
  std::optional<OutputFile> file; // rank 0
  session.onRoot(
    [&]
    {
      sample = loadBondSample(session, options.picture, options.bonds, filter);
      if (!options.output.empty())
      {
        file.emplace(options.output, options.common.overwrite);
        const int perNode = 1 + 24 + (filter->GetComputeStress() ? 48 : 0) + (filter->GetComputeStrainEnergy() ? 8 : 0);
        file->needs(
          static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * static_cast<std::uint64_t>(perNode));
      }
    });
  runBonds(session, filter, sample, "equilibrium");
  session.onRoot(
    [&]
    {
      BondRun report = bondRun(session, filter, options.picture, options.bonds, sample, commandLine);
      vtkImageData* const image = report.image;
      if (file)
      {
        setProvenance(image, io::toJson(report.provenance));
        writeGrid(image, *file);
        Session::checkInterrupt();
        file->commit();
        report.written.push_back(options.output);
      }
      report.seconds = secondsSince(start);
      session.print(options.common.json ? equilibriumJson(report)
          : options.common.quiet        ? ""
                                        : equilibriumTable(report));
    });
}

} // namespace

Command equilibriumCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "equilibrium", "Stiffness of a picture or volume, stress, and the load at which its first bond breaks");
  auto o = std::make_shared<EquilibriumOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondEquilibrium");
  addOutputOptions(*app, o->output, o->common, "Write phases and displacement as .vti, for ParaView");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella equilibrium tissue.png --phase 0=lumen --other wall --young wall=10e9 --critical-stretch wall=0.01",
      "lamella equilibrium grains.vti --young matrix=1e9 --young grain=4e9 --toughness matrix=1e5 --toughness "
      "grain=4e5 --like matrix-grain=matrix --like grain-grain=matrix --stress -o stretched.vti",
      "lamella equilibrium grains.vti --young matrix=1e9 --young grain=4 --relative-to matrix --mixing harmonic --json",
      "mpirun -n 2 lamella equilibrium rock_200x200x200_u8.raw --phase 1=pore --other grain --young grain=7e10",
      "lamella snapshot stretched.vti --preset stress -o stress.png" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      equilibrium(session, *o, line);
    } };
}

} // namespace lamella::cli
