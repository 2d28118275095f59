#include "SampleFit.h"

#include "FieldNumbers.h"

#include "core/Error.h"
#include "core/Parse.h"
#include "core/Plausible.h"
#include "core/Suggestion.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace lamella
{

using statistics::FitEvaluation;
using statistics::FitMeasurement;
using statistics::FitParameter;

namespace
{

/// A number that can be of a sample. @param text all that was given @param form how it is written
double numberIn(const std::string& setting, const std::string& text, const std::string& number, const std::string& form)
{
  const auto value = toNumber(number);
  if (!value || !std::isfinite(*value))
    throw ParameterError(fmt::format("{} {}: '{}' is not a number", setting, text, number), "write it as " + form);
  return *value;
}

/// One fit.
class SampleFit
{
public:
  SampleFit(FitModel& model, FoundFit& found, std::size_t samples, const std::function<void(std::size_t)>& solve)
    : model_(model)
    , found_(found)
    , samples_(samples)
    , solve_(solve)
  {
  }

  void run(bool fields)
  {
    std::vector<FitParameter> parameters;
    for (const FitUnknown& u : found_.unknowns)
      parameters.push_back({ u.name(), u.start.value_or(model_.startOf(u, meanMeasured())), model_.scales(u) });
    std::vector<FitMeasurement> measurements;
    for (const FitMeasured& m : found_.measured)
      measurements.push_back(m.value);
    found_.best = statistics::fit(parameters, measurements, [&](std::span<const double> p) { return evaluate(p); });
    found_.byMeasurement = found_.best.parameters;
    conclude(std::move(measurements), fields);
  }

private:
  [[nodiscard]] double meanMeasured() const
  {
    double logs = 0;
    int count = 0;
    for (const FitMeasured& m : found_.measured)
      if (m.value.value > 0)
      {
        logs += std::log(m.value.value);
        ++count;
      }
    return count > 0 ? std::exp(logs / count) : 1;
  }

  void set(std::span<const double> values)
  {
    for (std::size_t i = 0; i < found_.unknowns.size(); ++i)
      model_.set(found_.unknowns[i], values[i]);
  }

  void solve(std::size_t sample)
  {
    solve_(sample);
    ++found_.solves;
    const std::vector<std::string> names = model_.quantities();
    for (const FitMeasured& m : found_.measured)
      if (m.sample == sample && std::find(names.begin(), names.end(), m.quantity) == names.end())
        throw ParameterError("measured " + m.value.name + ": '" + m.quantity + "' is not found of this sample",
          suggestion(m.quantity, names, "what is found is " + quotedList(names, "and")));
  }

  FitEvaluation evaluate(std::span<const double> values)
  {
    set(values);
    const std::size_t unknowns = found_.unknowns.size();
    FitEvaluation e;
    e.values.assign(found_.measured.size(), 0.0);
    e.derivatives.assign(found_.measured.size() * unknowns, 0.0);
    for (std::size_t s = 0; s < samples_; ++s)
    {
      solve(s);
      for (std::size_t j = 0; j < found_.measured.size(); ++j)
      {
        const FitMeasured& m = found_.measured[j];
        if (m.sample != s)
          continue;
        e.values[j] = model_.value(m.quantity);
        for (std::size_t i = 0; i < unknowns; ++i)
          e.derivatives[j * unknowns + i] = model_.derivative(m.quantity, found_.unknowns[i]);
      }
    }
    return e;
  }

  /// Solves there once more, with the error of lattice and picture.
  void conclude(std::vector<FitMeasurement> measurements, bool fields)
  {
    std::vector<double> values;
    for (const auto& p : found_.best.parameters)
      values.push_back(p.value);
    set(values);
    model_.finish(fields);
    found_.errors.assign(measurements.size(), unknown);
    for (std::size_t s = samples_; s-- > 0;) // the first sample's fields last
    {
      solve(s);
      for (std::size_t j = 0; j < measurements.size(); ++j)
        if (found_.measured[j].sample == s)
        {
          found_.errors[j] = model_.error(found_.measured[j].quantity);
          measurements[j].halfWidth = std::hypot(measurements[j].halfWidth, found_.errors[j]);
        }
    }
    found_.withLattice =
      std::all_of(found_.errors.begin(), found_.errors.end(), [](double error) { return std::isfinite(error); });
    if (found_.withLattice)
      widen(found_.best, measurements);
  }

  FitModel& model_;
  FoundFit& found_;
  std::size_t samples_;
  const std::function<void(std::size_t)>& solve_;
};

} // namespace

double FoundFit::correlation(std::size_t a, std::size_t b) const
{
  const std::size_t m = unknowns.size();
  const auto& c = best.covariance;
  return c[a * m + b] / std::sqrt(c[a * m + a] * c[b * m + b]);
}

std::string FoundFit::interval() const
{
  return withLattice ? "19 of 20, by the measurements and the error of lattice and picture"
                     : "19 of 20, by the measurements alone";
}

std::vector<FitUnknown> fitUnknowns(const FitModel& model, const std::vector<std::string>& texts)
{
  std::vector<FitUnknown> unknowns;
  for (const std::string& text : texts)
  {
    FitUnknown u;
    std::string word = text;
    if (const std::size_t equals = text.find('='); equals != std::string::npos)
    {
      const auto start = toNumber(text.substr(equals + 1));
      if (!start || !(*start > 0) || !plausible(*start))
        throw ParameterError(
          fmt::format("unknown {}: '{}' is not a number between 1e-30 and 1e30", text, text.substr(equals + 1)),
          "a search starts from a positive number");
      u.start = *start;
      word = text.substr(0, equals);
    }
    const std::vector<std::string> known = model.properties();
    const std::size_t colon = word.find(':');
    u.property = colon == std::string::npos ? known.front() : word.substr(0, colon);
    u.phase = colon == std::string::npos ? word : word.substr(colon + 1);
    if (std::find(known.begin(), known.end(), u.property) == known.end())
      throw ParameterError("unknown '" + word + "': '" + u.property + "' is nothing that can be looked for",
        suggestion(u.property, known, "it can be " + quotedList(known)));
    if (u.phase.empty())
      throw ParameterError("unknown '" + text + "' names no phase", "write it as " + model.form());
    if (std::any_of(unknowns.begin(), unknowns.end(), [&](const FitUnknown& other) { return other.key() == u.key(); }))
      throw ParameterError("unknown names the " + u.name() + " twice", "once is enough");
    unknowns.push_back(std::move(u));
  }
  return unknowns;
}

std::vector<FitMeasured> fitMeasured(const std::vector<std::string>& texts, std::size_t samples)
{
  const std::string form = "QUANTITY=VALUE±HALF, of the second sample 2/QUANTITY=VALUE±HALF";
  std::vector<FitMeasured> all;
  for (const std::string& text : texts)
  {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw ParameterError("measured '" + text + "' is no quantity with its value", "write it as " + form);
    const std::string name = text.substr(0, equals);
    FitMeasured m;
    m.quantity = name;
    if (const std::size_t slash = name.find('/'); slash != std::string::npos)
    {
      const auto which = toInteger(name.substr(0, slash));
      if (!which || *which < 1 || static_cast<std::size_t>(*which) > samples)
        throw ParameterError(fmt::format("measured {}: there {} {} sample{}", text, samples == 1 ? "is" : "are",
                               samples, samples == 1 ? "" : "s"),
          "name others with also");
      m.sample = static_cast<std::size_t>(*which) - 1;
      m.quantity = name.substr(slash + 1);
    }
    const auto [value, half] = splitUncertainty(text.substr(equals + 1));
    if (half.empty())
      throw ParameterError("measured " + text + " does not say how far it may be off",
        "write half of the interval that holds it 19 times out of 20: " + text + "±…");
    m.value = { name, numberIn("measured", text, value, form), numberIn("measured", text, half, form) };
    if (std::any_of(all.begin(), all.end(), [&](const FitMeasured& other) { return other.value.name == name; }))
      throw ParameterError("measured has " + name + " twice", "give the mean of both, and how far that may be off");
    all.push_back(std::move(m));
  }
  return all;
}

FoundFit fitSamples(FitModel& model, std::vector<FitUnknown> unknowns, std::vector<FitMeasured> measured,
  std::size_t samples, const std::vector<std::string>& phases, const std::function<void(std::size_t sample)>& solve,
  bool fields)
{
  for (const FitUnknown& u : unknowns)
    if (!phaseMeant(phases, u.phase))
      throw ParameterError("unknown names '" + u.phase + "', which is no phase of this sample",
        suggestion(u.phase, phases, "its phases are " + quotedList(phases, "and")));
  FoundFit found;
  found.unknowns = std::move(unknowns);
  found.measured = std::move(measured);
  SampleFit(model, found, samples, solve).run(fields);
  return found;
}

void describe(vtkDataObject* output, const FoundFit& found)
{
  const auto numbers = [&](const char* name, std::size_t count, const auto& of)
  {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(of(i));
    setFieldNumbers(output, name, values);
  };
  const auto texts = [&](const char* name, std::size_t count, const auto& of)
  {
    std::vector<std::string> values;
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(of(i));
    setFieldTexts(output, name, values);
  };
  const std::size_t m = found.unknowns.size();
  texts(
    "fit_unknown", m, [&](std::size_t i) { return found.unknowns[i].key(); });
  numbers(
    "fit_value", m, [&](std::size_t i) { return found.best.parameters[i].value; });
  numbers(
    "fit_low", m, [&](std::size_t i) { return found.best.parameters[i].low; });
  numbers(
    "fit_high", m, [&](std::size_t i) { return found.best.parameters[i].high; });
  numbers(
    "fit_low_by_measurement", m, [&](std::size_t i) { return found.byMeasurement[i].low; });
  numbers(
    "fit_high_by_measurement", m, [&](std::size_t i) { return found.byMeasurement[i].high; });
  numbers("fit_correlation", m * m, [&](std::size_t i) { return found.correlation(i / m, i % m); });
  const std::size_t n = found.measured.size();
  texts(
    "fit_measured", n, [&](std::size_t j) { return found.measured[j].value.name; });
  numbers(
    "fit_measured_value", n, [&](std::size_t j) { return found.measured[j].value.value; });
  numbers(
    "fit_measured_half_width", n, [&](std::size_t j) { return found.measured[j].value.halfWidth; });
  numbers(
    "fit_fitted", n, [&](std::size_t j) { return found.best.values[j]; });
  numbers("fit_lattice_and_picture", n, [&](std::size_t j) { return found.errors[j]; });
  setFieldText(output, "fit_interval", found.interval());
  setFieldNumber(output, "fit_misfit", found.best.misfit);
  setFieldNumber(output, "fit_freedom", found.best.freedom);
  setFieldNumber(output, "fit_chance", found.best.freedom > 0 ? found.best.chance : unknown);
  setFieldNumber(output, "fit_solves", found.solves);
}

} // namespace lamella
