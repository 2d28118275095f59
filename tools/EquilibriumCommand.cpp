#include "BondInput.h"
#include "Commands.h"
#include "EquilibriumReport.h"
#include "GridFile.h"
#include "OutputFile.h"
#include "Text.h"
#include "Units.h"

#include "lattice/Clock.h"
#include "vtkBondEquilibrium.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <cmath>
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
  std::string load = "stretch";
  PlatenOptions platens;
  double strain = 1e-3;
  double lateralStrain = 0;
  double traction = 0;
  std::string solver = "multigrid";
  BalanceOptions balance;
  bool stress = false;
  bool strainEnergy = false;
  std::string output;
};

const std::vector<std::string> loads{ "stretch", "shear", "biaxial", "traction" };
const std::vector<std::string> solvers{ "multigrid", "jacobi", "direct", "dynamic-relaxation" };

/// What can be said without the sample. @throws ParameterError
void applyLoad(const EquilibriumOptions& o, vtkBondEquilibrium* filter)
{
  const auto load = static_cast<int>(oneOf("--load", o.load, loads));
  filter->SetLoad(load);
  if (load != vtkBondEquilibrium::BIAXIAL && o.lateralStrain != 0)
  {
    throw ParameterError("--lateral-strain is for --load biaxial", "leave it out, or add --load biaxial");
  }
  if ((load == vtkBondEquilibrium::TRACTION) != (o.traction != 0))
  {
    throw ParameterError(load == vtkBondEquilibrium::TRACTION ? "--load traction without a --traction"
                                                              : "--traction is for --load traction",
      "write --load traction --traction 1e6; tension is positive");
  }
  if (load != vtkBondEquilibrium::TRACTION && (o.strain == 0 || !std::isfinite(o.strain)))
  {
    throw ParameterError(
      fmt::format("--strain {} loads nothing", o.strain), "give a number such as 1e-3; tension is positive");
  }
  for (const auto& [option, strain] : { std::pair{ "--strain", o.strain }, { "--lateral-strain", o.lateralStrain } })
  {
    if (!(std::fabs(strain) < 1) || (strain != 0 && !plausible(strain)))
    {
      throw ParameterError(fmt::format("{} {} is no strain", option, strain),
        "it lies between -1 and 1, at which nothing of the length is left: 1e-3 is usual");
    }
  }
  if (load == vtkBondEquilibrium::TRACTION && !plausible(o.traction))
  {
    throw ParameterError(fmt::format("--traction {} is not between 1e-30 and 1e30 Pa", o.traction), "1e6 is usual");
  }
  checkBalance(o.balance);
  applyPlatens(o.platens, filter);
  filter->SetStrain(o.strain);
  filter->SetLateralStrain(o.lateralStrain);
  filter->SetTraction(o.traction);
  filter->SetSolver(static_cast<int>(oneOf("--solver", o.solver, solvers)));
  filter->SetTolerance(o.balance.tolerance);
  filter->SetMaximumIterations(o.balance.maxIterations);
  if (o.output.empty() && (o.stress || o.strainEnergy))
  {
    throw ParameterError(
      fmt::format("{} without a file to write it to", o.stress ? "--stress" : "--strain-energy"), "add -o FILE.vti");
  }
  filter->SetComputeStress(o.stress);
  filter->SetComputeStrainEnergy(o.strainEnergy);
}

void equilibrium(Session& session, const EquilibriumOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkBondEquilibrium> filter;
  applyBonds(options.bonds, filter);
  applyLoad(options, filter);
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
      sample = loadBondSample(session, options.picture, options.bonds);
      if (!options.output.empty())
      {
        file.emplace(options.output, options.common.overwrite);
        const int perNode = 1 + 24 + (options.stress ? 48 : 0) + (options.strainEnergy ? 8 : 0);
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
  addBondOptions(*app, o->bonds, BondUse::Load);
  const auto load = [](CLI::Option* option) { return option->group("Load"); };
  load(app->add_option("--load", o->load, "The low platen stays; the high one moves along the axis, across it, ..."))
    ->type_name("stretch|shear|biaxial|traction")
    ->capture_default_str();
  addPlatenOptions(*app, o->platens);
  load(takesShares(app->add_option(
         "--strain", o->strain, "Movement of the platen over the distance between the platens; tension positive")))
    ->type_name("NUMBER")
    ->capture_default_str();
  load(takesShares(app->add_option("--lateral-strain", o->lateralStrain, "Of --load biaxial: along the other axes")))
    ->type_name("NUMBER")
    ->capture_default_str();
  load(takesPascals(app->add_option("--traction", o->traction, "Of --load traction [Pa]; tension positive")))
    ->type_name("PASCAL");
  const auto numerics = [](CLI::Option* option) { return option->group("Accuracy and cost"); };
  numerics(app->add_option("--solver", o->solver, "How forces are balanced"))
    ->type_name("multigrid|jacobi|direct|dynamic-relaxation")
    ->capture_default_str();
  addBalanceOptions(*app, o->balance);
  addOutputOptions(*app, o->output, o->common, "Write phases and displacement as .vti, for ParaView");
  app->add_flag("--stress", o->stress, "Write the stress of every node too")->group("Output");
  app->add_flag("--strain-energy", o->strainEnergy, "Write the strain energy of every node too")->group("Output");
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
