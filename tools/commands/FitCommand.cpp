#include "commands/DiffusionConductivity.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "files/GridFile.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "FitModel.h"
#include "SampleFit.h"
#include "SteadyFindings.h"
#include "core/Clock.h"
#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"
#include "vtkMaterialFit.h"
#include "vtkSteadyDiffusion.h"
#include "vtkVoxelStiffness.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

struct FitOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions solver, fit;
  std::vector<std::string> conductivity; ///< of diffusion
  std::vector<std::string> also;
  std::string output;
};

vtkSmartPointer<vtkAlgorithm> diffusionOf(const FitOptions& options)
{
  vtkNew<vtkSteadyDiffusion> solver;
  options.solver.give(solver);
  for (const GivenConductivity& one : parseConductivities(options.conductivity))
  {
    solver->SetConductivity(one.phase.c_str(), one.along);
    if (one.across != one.along)
      solver->SetConductivityAcross(one.phase.c_str(), one.across);
  }
  return solver;
}

vtkSmartPointer<vtkAlgorithm> stiffnessOf(const FitOptions& options)
{
  vtkNew<vtkVoxelStiffness> solver;
  options.solver.give(solver);
  return solver;
}

/// One fit, on rank 0.
class FitRun
{
public:
  FitRun(
    Session& session, FitOptions& options, vtkAlgorithm* solver, const std::string& of, const std::string& commandLine)
    : session_(session)
    , options_(options)
    , of_(of)
    , commandLine_(commandLine)
  {
    fit_->SetSolver(solver);
    options.fit.give(fit_);
    fit_->SetComputeFields(!options.output.empty());
  }

  void run()
  {
    load();
    runFilter(session_, fit_, "fit");
    const io::Provenance record = recordRun(session_, commandLine_, options_.picture.file, provenance_);
    for (std::size_t i = 0; i < files_.size(); ++i)
    {
      const vtkSmartPointer<vtkImageData> image = along(files_.size() == 1 ? -1 : static_cast<int>(i));
      setProvenance(image, io::toJson(record));
      writeGrid(image, files_[i]);
    }
    for (OutputFile& file : files_)
      file.commit();
    printReport(session_, options_.common, report(fit_->GetFindings()), record, [](const Json& j) { return words(j); });
  }

private:
  void load()
  {
    std::vector<std::string> files{ options_.picture.file };
    files.insert(files.end(), options_.also.begin(), options_.also.end());
    std::vector<std::string> phases; // of any sample
    for (const std::string& file : files)
    {
      options_.picture.file = file;
      Sample sample = loadSample(options_.picture);
      tellDoubts(session_, sample);
      if (file == files.front())
      {
        provenance_ = sample.provenance;
        open(sample.image.lattice.dimension);
      }
      const std::vector<std::string> names = sample.image.phases.names();
      phases.insert(phases.end(), names.begin(), names.end());
      fit_->AddInputDataObject(imageOf(sample));
    }
    options_.picture.file = files.front();
    options_.solver.checkNames(phases);
    requireNames("--conductivity", parseConductivities(options_.conductivity), phases);
  }

  /// One file, or as lamella diffusion one a direction.
  void open(int dimension)
  {
    if (options_.output.empty())
      return;
    auto* const diffusion = vtkSteadyDiffusion::SafeDownCast(fit_->GetSolver());
    const bool all = diffusion != nullptr && diffusion->GetDirection() == vtkSteadyDiffusion::ALL;
    for (int axis = 0; axis < (all ? dimension : 1); ++axis)
    {
      const std::string end = all ? std::string("_") + axisNames[static_cast<std::size_t>(axis)] : "";
      written_.push_back(withSuffix(options_.output, end).string());
      files_.emplace_back(written_.back(), options_.common.overwrite);
    }
  }

  /// What was found, with the fields of one direction of a diffusion along all; below 0: with all that there are.
  [[nodiscard]] vtkSmartPointer<vtkImageData> along(int axis) const
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->ShallowCopy(fit_->GetImage());
    if (axis < 0)
      return image;
    vtkPointData* const points = image->GetPointData();
    for (const char* const name : { "temperature", "concentration", "flux" })
      for (std::size_t other = 0; other < axisNames.size(); ++other)
      {
        const std::string full = std::string(name) + "_" + axisNames[other];
        vtkDataArray* const array = points->GetArray(full.c_str());
        if (array != nullptr && static_cast<int>(other) == axis)
        {
          const auto alone = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
          alone->ShallowCopy(array);
          alone->SetName(name);
          const auto [unit, text, creator] = description(array);
          lamella::describe(alone, unit, text, creator);
          points->AddArray(alone);
        }
        points->RemoveArray(full.c_str());
      }
    describe(image, vtkSteadyDiffusion::SafeDownCast(fit_->GetSolver())->GetFindings().along(axis));
    return image;
  }

  [[nodiscard]] Json report(const FoundFit& found) const
  {
    Json json;
    json["of"] = of_;
    json["file"] = options_.picture.file;
    json["also"] = options_.also;
    json["unknown"] = Json::object();
    const std::size_t m = found.unknowns.size();
    for (std::size_t i = 0; i < m; ++i)
    {
      const auto& p = found.values[i];
      const auto& alone = found.byMeasurement[i];
      json["unknown"][found.unknowns[i].key()] = { { "value", p.value }, { "low", p.low }, { "high", p.high },
        { "low_by_measurement", alone.low }, { "high_by_measurement", alone.high } };
    }
    json["interval"] = found.interval();
    json["measured"] = Json::object();
    for (std::size_t j = 0; j < found.measured.size(); ++j)
    {
      const statistics::FitMeasurement& one = found.measured[j].value;
      json["measured"][one.name] = { { "value", one.value }, { "half_width", one.halfWidth },
        { "fitted", jsonNumber(found.best.values[j]) }, { "lattice_and_picture", jsonNumber(found.errors[j]) } };
    }
    json["correlation"] = Json::array();
    for (std::size_t a = 0; a < m; ++a)
    {
      Json row = Json::array();
      for (std::size_t b = 0; b < m; ++b)
        row.push_back(jsonNumber(found.correlation(a, b)));
      json["correlation"].push_back(row);
    }
    json["misfit"] = found.best.misfit;
    json["freedom"] = found.best.freedom;
    json["chance"] = found.best.freedom > 0 ? Json(found.best.chance) : Json(nullptr);
    json["solves"] = found.solves;
    json["output"] = written_;
    json["seconds"] = secondsSince(start_);
    return json;
  }

  static std::string words(const Json& json)
  {
    std::string text = json["file"].get<std::string>() + "\n\n  what fits best, and the interval that holds it " +
      json["interval"].get<std::string>() + "\n";
    for (const auto& [name, p] : json["unknown"].items())
      text += fmt::format("    {:<24} {:<12.5g} {:.4g} to {:.4g}\n", name, p["value"].get<double>(),
        p["low"].get<double>(), p["high"].get<double>());
    text += "  measured, and there\n";
    for (const auto& [name, m] : json["measured"].items())
    {
      text += fmt::format("    {:<24} {:.5g} ± {:.2g}   {:.5g}", name, m["value"].get<double>(),
        m["half_width"].get<double>(), m["fitted"].get<double>());
      if (m["lattice_and_picture"].is_number())
        text += fmt::format(" ± {:.2g} by lattice and picture", m["lattice_and_picture"].get<double>());
      text += "\n";
    }
    if (json["freedom"].get<int>() > 0)
    {
      const double chance = json["chance"].get<double>();
      text +=
        fmt::format("  {} more than unknowns: misfit {:.3g}, as large or larger by chance in {:.2g} % of cases{}\n",
          json["freedom"].get<int>(), json["misfit"].get<double>(), 100 * chance,
          chance < 0.01 ? "; the model does not fit: other phases' values, the picture, or the measurements are off"
                        : "");
    }
    for (std::size_t a = 0; a + 1 < json["correlation"].size(); ++a)
      for (std::size_t b = a + 1; b < json["correlation"].size(); ++b)
        if (const Json& c = json["correlation"][a][b]; c.is_number() && std::abs(c.get<double>()) > 0.9)
          text += fmt::format(
            "  unknowns {} and {} are told nearly together: correlation {:.2f}\n", a + 1, b + 1, c.get<double>());
    text += fmt::format("\n  {} solves, {:.2f} s\n", json["solves"].get<int>(), json["seconds"].get<double>());
    return text + wroteText(json["output"].get<std::vector<std::string>>());
  }

  Session& session_;
  FitOptions& options_;
  std::string of_;
  const std::string& commandLine_;
  Clock::time_point start_ = Clock::now();
  vtkNew<vtkMaterialFit> fit_;
  std::vector<OutputFile> files_;
  std::vector<std::string> written_; ///< their names
  std::string provenance_;
};

/// @param unknown and @param measured how they are written @param fields what is written
void addFitOptions(CLI::App& app, FitOptions& o, const std::string& className, const char* unknown,
  const char* measured, const char* fields)
{
  o.fit.declare(app, "vtkMaterialFit", { "fields" });
  app.get_option("--unknown")->type_name(unknown)->required();
  app.get_option("--measured")->type_name(measured)->required();
  addOption(app, "Fit", "--also", o.also, "Another sample of the same materials, with measurements of its own", "FILE");
  addOutputOptions(app, o.output, o.common, fields);
  addReportOptions(app, o.common);
  std::vector<std::string> leave = settingsLeftOut(className);
  leave.insert(leave.end(),
    { "conductivity", "conductivity-across", "nodes-per-pixel" }); // the first two in one; pixels stay whole
  o.solver.declare(app, className, leave);
}

} // namespace

Command fitCommand(CLI::App& root)
{
  CLI::App* const fit = root.add_subcommand(
    "fit", "What the phases must be for the sample to have what was measured: conductivities, moduli");
  fit->require_subcommand(1);
  addExamples(*fit,
    { "lamella fit diffusion tissue.png --conductivity lumen=0.026 --unknown wall --measured y=0.11±0.003",
      "lamella fit diffusion early.vti --also late.vti --conductivity lumen=0.026 --unknown wall --measured "
      "y=0.08±0.002 --measured 2/y=0.21±0.005",
      "lamella fit stiffness tissue.vti --unknown young:wall --unknown young-across:wall --measured E_x=0.9e9±2e7 "
      "--measured E_y=0.6e9±2e7" });
  auto diffusion = std::make_shared<FitOptions>();
  CLI::App* const byDiffusion = fit->add_subcommand("diffusion", "Conductivities of phases from effective ones");
  addPictureOptions(*byDiffusion, diffusion->picture);
  addOption(*byDiffusion, "Materials", "--conductivity", diffusion->conductivity,
    "Conductivity of a phase that is known; ALONG:ACROSS where it differs along the walls",
    "NAME=VALUE|NAME=ALONG:ACROSS");
  addFitOptions(*byDiffusion, *diffusion, "vtkSteadyDiffusion", "[slope:]PHASE[=START]", "x|y|z[@MOISTURE]=VALUE±HALF",
    "Write the first sample with its fields at the fit as .vti; several directions: FILE_x.vti, FILE_y.vti");
  auto stiffness = std::make_shared<FitOptions>();
  CLI::App* const byStiffness = fit->add_subcommand("stiffness", "Moduli of phases from effective ones");
  addPictureOptions(*byStiffness, stiffness->picture);
  addFitOptions(*byStiffness, *stiffness, "vtkVoxelStiffness", "[slope:]PROPERTY:PHASE[=START]",
    "E_x|G_xy|…[@MOISTURE]=VALUE±HALF", "Write the first sample at the fit as .vti");
  return { fit,
    [=](Session& session, const std::string& line)
    {
      const bool first = byDiffusion->parsed();
      FitOptions& o = first ? *diffusion : *stiffness;
      session.setQuiet(o.common.quiet);
      session.onRoot(
        [&] {
          FitRun(session, o, first ? diffusionOf(o) : stiffnessOf(o), first ? "diffusion" : "stiffness", line).run();
        });
    } };
}

} // namespace lamella::cli
