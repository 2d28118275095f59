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

#include "FieldNumbers.h"
#include "SteadyFindings.h"
#include "core/Clock.h"
#include "core/Error.h"
#include "lattice/AxisNames.h"
#include "lattice/PhaseNames.h"
#include "statistics/Fit.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"
#include "vtkSteadyDiffusion.h"
#include "vtkVoxelStiffness.h"

#include <vtkImageData.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

using statistics::FitEvaluation;
using statistics::FitMeasurement;
using statistics::FitParameter;
using statistics::FitResult;

struct FitOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions settings;
  std::vector<std::string> conductivity; ///< of diffusion
  std::vector<std::string> also, unknown, measured;
  std::string output;
};

/// A phase's property that is looked for.
struct Unknown
{
  std::string property;
  std::string phase;
  std::optional<double> start;

  [[nodiscard]] std::string name() const { return property + " of " + phase; }
};

/// One number that was measured, and the sample that it is of.
struct Measured
{
  std::size_t sample = 0;
  std::string quantity;
  FitMeasurement value;
};

/// What can be fitted: a filter, its unknowns, and what it gives.
class Model
{
public:
  virtual ~Model() = default;
  [[nodiscard]] virtual std::vector<std::string> properties() const = 0;
  [[nodiscard]] virtual std::string form() const = 0; ///< of --unknown
  virtual void set(const Unknown& unknown, double value) = 0;
  /// Where a search begins that nobody told to.
  [[nodiscard]] virtual double startOf(const Unknown& unknown, double measured) const = 0;
  /// Whether values are multiplied by what all such are multiplied by; a search then begins with that.
  [[nodiscard]] virtual bool scales(const Unknown&) const { return false; }
  /// Solves: a value by name of each quantity, and its derivatives by unknown.
  virtual void solve(Session& session, vtkImageData* image, const std::array<int, 6>& extent) = 0;
  [[nodiscard]] virtual std::vector<std::string> quantities() const = 0;
  [[nodiscard]] virtual double value(const std::string& quantity) const = 0;
  [[nodiscard]] virtual double derivative(const std::string& quantity, const Unknown& by) const = 0;
  /// From now on, or no more: the error against the material's value, and fields.
  virtual void finish(bool fields) = 0;
  [[nodiscard]] virtual double error(const std::string& quantity) const = 0; ///< of the value, absolute
  [[nodiscard]] virtual vtkImageData* output() const = 0;
};

class DiffusionModel final : public Model
{
public:
  explicit DiffusionModel(const FitOptions& options)
  {
    options.settings.give(filter_);
    estimate_ = filter_->GetEstimateError();
    for (const GivenConductivity& one : parseConductivities(options.conductivity))
    {
      filter_->SetConductivity(one.phase.c_str(), one.along);
      if (one.across != one.along)
        filter_->SetConductivityAcross(one.phase.c_str(), one.across);
    }
    filter_->SetEstimateError(false);
    filter_->SetComputeField(false);
    filter_->SetComputeFlux(false);
    filter_->SetComputeSensitivity(true);
  }
  std::vector<std::string> properties() const override { return { "conductivity", "conductivity-across" }; }
  std::string form() const override { return "PHASE, or conductivity-across:PHASE"; }
  void set(const Unknown& unknown, double value) override
  {
    unknown.property == "conductivity" ? filter_->SetConductivity(unknown.phase.c_str(), value)
                                       : filter_->SetConductivityAcross(unknown.phase.c_str(), value);
  }
  double startOf(const Unknown&, double measured) const override { return measured; }
  void solve(Session& session, vtkImageData* image, const std::array<int, 6>& extent) override
  {
    runFilterOnRanks(session, filter_.Get(), image, extent, "fit");
  }
  std::vector<std::string> quantities() const override
  {
    std::vector<std::string> names;
    for (const auto& answer : filter_->GetFindings().answers)
      names.emplace_back(axisNames[static_cast<std::size_t>(answer.axis)]);
    return names;
  }
  double value(const std::string& quantity) const override
  {
    const auto& answer = answerOf(quantity);
    return answer.result.effective[static_cast<std::size_t>(answer.axis)];
  }
  double derivative(const std::string& quantity, const Unknown& by) const override
  {
    const auto& answer = answerOf(quantity);
    const auto id = phaseMeant(filter_->GetFindings().phases, by.phase);
    const auto& list = by.property == "conductivity" ? answer.derivatives.along : answer.derivatives.across;
    if (!id || *id >= list.size())
      return 0.0;
    return list[*id];
  }
  void finish(bool fields) override
  {
    filter_->SetEstimateError(estimate_);
    filter_->SetComputeField(fields);
    filter_->SetComputeFlux(fields);
  }
  double error(const std::string& quantity) const override
  {
    return estimate_ ? answerOf(quantity).error.relative * value(quantity) : std::numeric_limits<double>::quiet_NaN();
  }
  vtkImageData* output() const override { return filter_->GetOutput(); }

private:
  [[nodiscard]] const lbm::DiffusionAnswer& answerOf(const std::string& quantity) const
  {
    const auto& answers = filter_->GetFindings().answers;
    return *std::ranges::find_if(
      answers, [&](const auto& a) { return quantity == axisNames[static_cast<std::size_t>(a.axis)]; });
  }

  vtkNew<vtkSteadyDiffusion> filter_;
  bool estimate_ = true;
};

class StiffnessModel final : public Model
{
public:
  explicit StiffnessModel(const FitOptions& options)
  {
    options.settings.give(filter_);
    estimate_ = filter_->GetEstimateError();
    filter_->SetEstimateError(false);
    filter_->SetComputeSensitivity(true);
  }
  std::vector<std::string> properties() const override
  {
    return { "young", "young-across", "shear", "poisson", "poisson-across" };
  }
  std::string form() const override { return "PROPERTY:PHASE, such as young:wall"; }
  void set(const Unknown& unknown, double value) override
  {
    const char* const phase = unknown.phase.c_str();
    if (unknown.property == "young")
      filter_->SetYoungsModulus(phase, value);
    else if (unknown.property == "young-across")
      filter_->SetYoungsModulusAcross(phase, value);
    else if (unknown.property == "shear")
      filter_->SetShearModulus(phase, value);
    else if (unknown.property == "poisson")
      filter_->SetPoissonsRatio(phase, value);
    else
      filter_->SetPoissonsRatioAcross(phase, value);
  }
  double startOf(const Unknown& unknown, double measured) const override
  {
    return unknown.property.starts_with("poisson") ? 0.3 : (unknown.property == "shear" ? 1 : 3) * measured;
  }
  bool scales(const Unknown& unknown) const override { return !unknown.property.starts_with("poisson"); }
  void solve(Session& session, vtkImageData* image, const std::array<int, 6>& extent) override
  {
    runFilterOnRanks(session, filter_.Get(), image, extent, "fit");
  }
  std::vector<std::string> quantities() const override { return fieldTexts(filter_->GetImage(), "constant_names"); }
  double value(const std::string& quantity) const override { return number("constants", quantity); }
  double derivative(const std::string& quantity, const Unknown& by) const override
  {
    const std::vector<std::string> phases = fieldTexts(filter_->GetImage(), "phase_names");
    const auto id = phaseMeant(phases, by.phase);
    const std::vector<std::string> numbers = fieldTexts(filter_->GetImage(), "material_numbers");
    const auto place = std::ranges::find(numbers, by.property + ":" + (id ? phases[*id] : ""));
    if (place == numbers.end())
      return 0; // none of its voxels is there
    return number("constants_sensitivity", quantity, static_cast<std::size_t>(place - numbers.begin()));
  }
  void finish(bool) override { filter_->SetEstimateError(estimate_); }
  double error(const std::string& quantity) const override { return number("constants_error", quantity); }
  vtkImageData* output() const override { return filter_->GetImage(); }

private:
  /// @param row of several numbers of each quantity
  [[nodiscard]] double number(const char* name, const std::string& quantity, std::size_t row = 0) const
  {
    const std::vector<std::string> names = quantities();
    const std::vector<double> values = fieldNumbers(filter_->GetImage(), name);
    const auto at = row * names.size() + static_cast<std::size_t>(std::ranges::find(names, quantity) - names.begin());
    return at < values.size() ? values[at] : std::numeric_limits<double>::quiet_NaN();
  }

  vtkNew<vtkVoxelStiffness> filter_;
  bool estimate_ = true;
};

double numberOf(const std::string& option, const std::string& text, const std::string& number, const std::string& form)
{
  const auto value = toNumber(number);
  if (!value || !std::isfinite(*value))
    throw ParameterError(fmt::format("{} '{}': '{}' is not a number", option, text, number), "write it as " + form);
  return *value;
}

std::vector<Unknown> parseUnknowns(const Model& model, const std::vector<std::string>& texts)
{
  std::vector<Unknown> unknowns;
  for (const std::string& text : texts)
  {
    Unknown u;
    std::string word = text;
    if (const std::size_t equals = text.find('='); equals != std::string::npos)
    {
      u.start = positive("--unknown " + text, text.substr(equals + 1), "a search starts from a positive number");
      word = text.substr(0, equals);
    }
    const std::vector<std::string> known = model.properties();
    const std::size_t colon = word.find(':');
    u.property = colon == std::string::npos ? known.front() : word.substr(0, colon);
    u.phase = colon == std::string::npos ? word : word.substr(colon + 1);
    (void)oneOf("--unknown", u.property, known);
    if (u.phase.empty())
      throw ParameterError("--unknown '" + text + "' names no phase", "write it as " + model.form());
    if (std::ranges::any_of(
          unknowns, [&](const Unknown& other) { return other.property == u.property && other.phase == u.phase; }))
      throw ParameterError("--unknown names the " + u.name() + " twice", "once is enough");
    unknowns.push_back(std::move(u));
  }
  return unknowns;
}

std::vector<Measured> parseMeasured(const std::vector<std::string>& texts, std::size_t samples)
{
  const std::string form = "QUANTITY=VALUE±HALF, of the second sample 2/QUANTITY=VALUE±HALF";
  std::vector<Measured> all;
  for (const std::string& text : listItems(texts))
  {
    const auto [name, number] = keyValue("--measured", text, form);
    Measured m;
    m.quantity = name;
    if (const std::size_t slash = name.find('/'); slash != std::string::npos)
    {
      const double which = numberOf("--measured", text, name.substr(0, slash), form);
      if (which < 1 || which > static_cast<double>(samples) || which != std::floor(which))
        throw ParameterError(fmt::format("--measured {}: there {} {} sample{}", text, samples == 1 ? "is" : "are",
                               samples, samples == 1 ? "" : "s"),
          "name others with --also");
      m.sample = static_cast<std::size_t>(which) - 1;
      m.quantity = name.substr(slash + 1);
    }
    const auto [value, half] = splitUncertainty(number);
    if (half.empty())
      throw ParameterError("--measured " + text + " does not say how far it may be off",
        "write half of the interval that holds it 19 times out of 20: --measured " + text + "±…");
    m.value = { name, numberOf("--measured", text, value, form), numberOf("--measured", text, half, form) };
    all.push_back(std::move(m));
  }
  return all;
}

/// One fit: samples, model, what is known of both.
class FitRun
{
public:
  FitRun(Session& session, FitOptions& options, std::unique_ptr<Model> model, const std::string& of,
    const std::string& commandLine)
    : session_(session)
    , options_(options)
    , model_(std::move(model))
    , of_(of)
    , commandLine_(commandLine)
    , unknowns_(parseUnknowns(*model_, options.unknown))
    , measured_(parseMeasured(options.measured, 1 + options.also.size()))
  {
    if (!options.output.empty())
      file_.emplace(options.output, options.common.overwrite);
  }

  void run()
  {
    load();
    std::vector<FitParameter> parameters;
    for (const Unknown& u : unknowns_)
      parameters.push_back({ u.name(), u.start.value_or(model_->startOf(u, meanMeasured())), model_->scales(u) });
    std::vector<FitMeasurement> measurements;
    for (const Measured& m : measured_)
      measurements.push_back(m.value);
    statistics::FitOptions how;
    FitResult result = statistics::fit(
      parameters, measurements, [&](std::span<const double> p) { return evaluate(p); }, how);
    byMeasurement_ = result.parameters;
    conclude(result, measurements);
    report(result);
  }

private:
  void load()
  {
    const std::string first = options_.picture.file;
    std::vector<std::string> files{ first };
    files.insert(files.end(), options_.also.begin(), options_.also.end());
    for (const std::string& file : files)
    {
      options_.picture.file = file;
      Sample sample = loadSample(options_.picture);
      tellDoubts(session_, sample);
      for (const Unknown& u : unknowns_)
        if (!phaseMeant(sample.image.phases.names(), u.phase) && samples_.empty())
          throw ParameterError("--unknown names '" + u.phase + "', which is no phase of this sample",
            suggestion(u.phase, sample.image.phases.names(),
              "its phases are " + quotedList(sample.image.phases.names(), "and")));
      auto& [image, extent] = samples_.emplace_back();
      image = imageOf(sample, 1);
      image->GetExtent(extent.data());
      if (samples_.size() == 1)
        provenance_ = sample.provenance;
    }
    options_.picture.file = first;
  }

  [[nodiscard]] double meanMeasured() const
  {
    double logs = 0;
    int count = 0;
    for (const Measured& m : measured_)
      if (m.value.value > 0)
      {
        logs += std::log(m.value.value);
        ++count;
      }
    return count > 0 ? std::exp(logs / count) : 1;
  }

  void set(std::span<const double> values)
  {
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
      model_->set(unknowns_[i], values[i]);
  }

  void solve(std::size_t sample)
  {
    model_->solve(session_, samples_[sample].first, samples_[sample].second);
    ++solves_;
    (void)VtkMessages::takeWarnings(); // the same each time
    const std::vector<std::string> names = model_->quantities();
    for (const Measured& m : measured_)
      if (m.sample == sample && std::ranges::find(names, m.quantity) == names.end())
        throw ParameterError("--measured " + m.value.name + ": '" + m.quantity + "' is not found of this sample",
          "what is found is " + quotedList(names, "and"));
  }

  FitEvaluation evaluate(std::span<const double> values)
  {
    set(values);
    FitEvaluation e;
    e.values.assign(measured_.size(), 0.0);
    e.derivatives.assign(measured_.size() * unknowns_.size(), 0.0);
    for (std::size_t s = 0; s < samples_.size(); ++s)
    {
      solve(s);
      for (std::size_t j = 0; j < measured_.size(); ++j)
      {
        if (measured_[j].sample != s)
          continue;
        e.values[j] = model_->value(measured_[j].quantity);
        for (std::size_t i = 0; i < unknowns_.size(); ++i)
          e.derivatives[j * unknowns_.size() + i] = model_->derivative(measured_[j].quantity, unknowns_[i]);
      }
    }
    return e;
  }

  /// Solves there once more, with the error of lattice and picture, and writes.
  void conclude(FitResult& result, std::vector<FitMeasurement> measurements)
  {
    std::vector<double> values;
    for (const auto& p : result.parameters)
      values.push_back(p.value);
    set(values);
    model_->finish(file_.has_value());
    bool known = true;
    for (std::size_t s = samples_.size(); s-- > 0;) // the first sample's fields last
    {
      solve(s);
      for (std::size_t j = 0; j < measured_.size(); ++j)
        if (measured_[j].sample == s)
        {
          const double error = model_->error(measured_[j].quantity);
          errors_.resize(measured_.size(), std::numeric_limits<double>::quiet_NaN());
          errors_[j] = error;
          known = known && std::isfinite(error);
          measurements[j].halfWidth = std::hypot(measurements[j].halfWidth, error);
        }
    }
    if (known)
    {
      widen(result, measurements);
      withLattice_ = true;
    }
    record_ = recordRun(session_, commandLine_, options_.picture.file, provenance_);
    if (!file_)
      return;
    setProvenance(model_->output(), io::toJson(record_));
    writeGrid(model_->output(), *file_);
    file_->commit();
  }

  void report(const FitResult& result)
  {
    Json json;
    json["of"] = of_;
    json["file"] = options_.picture.file;
    json["also"] = options_.also;
    json["unknown"] = Json::object();
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
    {
      const auto& p = result.parameters[i];
      const auto& alone = byMeasurement_[i];
      json["unknown"][unknowns_[i].property + ":" + unknowns_[i].phase] = { { "value", p.value }, { "low", p.low },
        { "high", p.high }, { "low_by_measurement", alone.low }, { "high_by_measurement", alone.high } };
    }
    json["interval"] = withLattice_ ? "19 of 20, by the measurements and the error of lattice and picture"
                                    : "19 of 20, by the measurements alone";
    json["measured"] = Json::object();
    for (std::size_t j = 0; j < measured_.size(); ++j)
    {
      const FitMeasurement& m = measured_[j].value;
      json["measured"][m.name] = { { "value", m.value }, { "half_width", m.halfWidth },
        { "fitted", jsonNumber(result.values[j]) }, { "lattice_and_picture", jsonNumber(errors_[j]) } };
    }
    const std::size_t m = unknowns_.size();
    json["correlation"] = Json::array();
    for (std::size_t a = 0; a < m; ++a)
    {
      Json row = Json::array();
      for (std::size_t b = 0; b < m; ++b)
        row.push_back(jsonNumber(
          result.covariance[a * m + b] / std::sqrt(result.covariance[a * m + a] * result.covariance[b * m + b])));
      json["correlation"].push_back(row);
    }
    json["misfit"] = result.misfit;
    json["freedom"] = result.freedom;
    json["chance"] = result.freedom > 0 ? Json(result.chance) : Json(nullptr);
    json["solves"] = solves_;
    json["output"] = options_.output.empty() ? Json(nullptr) : Json(options_.output);
    json["seconds"] = secondsSince(start_);
    printReport(session_, options_.common, std::move(json), record_, [](const Json& j) { return words(j); });
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
    return text +
      wroteText(
        json["output"].is_null() ? std::vector<std::string>{} : std::vector{ json["output"].get<std::string>() });
  }

  Session& session_;
  FitOptions& options_;
  std::unique_ptr<Model> model_;
  std::string of_;
  const std::string& commandLine_;
  Clock::time_point start_ = Clock::now();
  std::vector<Unknown> unknowns_;
  std::vector<Measured> measured_;
  std::optional<OutputFile> file_;
  std::vector<std::pair<vtkSmartPointer<vtkImageData>, std::array<int, 6>>> samples_;
  std::string provenance_;
  io::Provenance record_;
  std::vector<statistics::FittedParameter> byMeasurement_;
  std::vector<double> errors_; ///< by measurement
  bool withLattice_ = false;
  int solves_ = 0;
};

void addFitOptions(CLI::App& app, FitOptions& o, const char* form, const char* measured)
{
  addOption(app, "Fit", "--unknown", o.unknown, "What is looked for, and where the search begins", form)->required();
  addOption(app, "Fit", "--measured", o.measured,
    "What was measured, and half of the interval that holds it 19 times out of 20 (± or +-); of a second sample with "
    "2/ "
    "before it",
    measured)
    ->required();
  addOption(app, "Fit", "--also", o.also, "Another sample of the same materials, with measurements of its own", "FILE");
  addOutputOptions(app, o.output, o.common, "Write the first sample with its fields at the fit as .vti");
  addReportOptions(app, o.common);
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
  addFitOptions(*byDiffusion, *diffusion, "PHASE[=START]", "x|y|z=VALUE±HALF");
  diffusion->settings.declare(*byDiffusion, "vtkSteadyDiffusion",
    { "conductivity", "conductivity-across", "conductivity-uncertainty", "conductivity-across-uncertainty",
      "sensitivity", "target-error", "window-error", "segmentation-error", "surface-doubt", "membrane", "permeance",
      "shares", "interpolate", "field", "flux" });
  auto stiffness = std::make_shared<FitOptions>();
  CLI::App* const byStiffness = fit->add_subcommand("stiffness", "Moduli of phases from effective ones");
  addPictureOptions(*byStiffness, stiffness->picture);
  addFitOptions(*byStiffness, *stiffness, "PROPERTY:PHASE[=START]", "E_x|G_xy|…=VALUE±HALF");
  stiffness->settings.declare(*byStiffness, "vtkVoxelStiffness",
    { "young-uncertainty", "poisson-uncertainty", "young-across-uncertainty", "poisson-across-uncertainty",
      "shear-uncertainty", "sensitivity", "nodes-per-pixel", "window-error", "segmentation-error", "surface-doubt",
      "shares", "mean-strain", "mean-stress", "change", "change-array", "tensor", "displacement", "strain", "stress",
      "expansion", "expansion-across" });
  return { fit,
    [=](Session& session, const std::string& line)
    {
      const bool first = byDiffusion->parsed();
      FitOptions& o = first ? *diffusion : *stiffness;
      session.setQuiet(o.common.quiet);
      session.onRoot(
        [&]
        {
          std::unique_ptr<Model> model;
          if (first)
            model = std::make_unique<DiffusionModel>(o);
          else
            model = std::make_unique<StiffnessModel>(o);
          FitRun(session, o, std::move(model), first ? "diffusion" : "stiffness", line).run();
        });
    } };
}

} // namespace lamella::cli
