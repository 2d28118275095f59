#include "SampleFit.h"

#include "Columns.h"
#include "FieldNumbers.h"

#include "core/Error.h"
#include "core/Parse.h"
#include "core/Plausible.h"
#include "core/Suggestion.h"
#include "lattice/PhaseNames.h"

#include "vtkDataSetAttributes.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
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
    , solve_(solve)
    , partner_(found.unknowns.size())
  {
    findSlopes();
    for (std::size_t s = 0; s < samples; ++s)
      for (const FitMeasured& m : found_.measured)
        if (const Case one{ s, m.moisture };
            m.sample == s && std::find(cases_.begin(), cases_.end(), one) == cases_.end())
          cases_.push_back(one);
    measuredCases_ = cases_.size();
    if (cases_.empty() || cases_.front().sample != 0) // fields are wanted of it
      cases_.insert(cases_.begin(), { 0, varies() ? std::optional(least_) : std::nullopt });
  }

  void run(bool fields)
  {
    std::vector<FitMeasurement> measurements;
    for (const FitMeasured& m : found_.measured)
      measurements.push_back(m.value);
    found_.best = statistics::fit(parameters(), measurements, [&](std::span<const double> p) { return evaluate(p); });
    tell();
    found_.byMeasurement = found_.values;
    conclude(measurements, fields);
  }

private:
  /// What is solved: a sample, at a moisture where properties change with it.
  struct Case
  {
    std::size_t sample = 0;
    std::optional<double> moisture;
    bool operator==(const Case&) const = default;
  };

  [[nodiscard]] bool varies() const { return most_ > least_; }
  /// Where a moisture lies between the least, 0, and the most, 1.
  [[nodiscard]] double share(double moisture) const { return (moisture - least_) / (most_ - least_); }

  /// Finds of each value its slope and the other way round. @throws ParameterError
  void findSlopes()
  {
    bool any = false;
    for (std::size_t i = 0; i < found_.unknowns.size(); ++i)
    {
      const FitUnknown& u = found_.unknowns[i];
      if (!u.slope)
        continue;
      any = true;
      for (std::size_t k = 0; k < found_.unknowns.size(); ++k)
        if (!found_.unknowns[k].slope && "slope:" + found_.unknowns[k].key() == u.key())
        {
          partner_[i] = k;
          partner_[k] = i;
        }
      if (!partner_[i])
        throw ParameterError("unknown " + u.key() + ": a slope is looked for together with the value at no moisture",
          "look for " + u.key().substr(std::string("slope:").size()) + ", too");
    }
    for (const FitMeasured& m : found_.measured)
    {
      if (any && !m.moisture)
        throw ParameterError("measured " + m.value.name + " does not say at which moisture, and a slope is looked for",
          "write the moisture behind the quantity: " + m.value.name + "@0.12=VALUE±HALF");
      if (!any && m.moisture && !found_.unknowns.empty())
        throw ParameterError(
          "measured " + m.value.name + " is at a moisture, and nothing that is looked for changes with it",
          "look for a slope as well, such as slope:" + found_.unknowns.front().key());
    }
    if (!any || found_.measured.empty())
      return;
    const auto [least, most] = std::minmax_element(found_.measured.begin(), found_.measured.end(),
      [](const FitMeasured& a, const FitMeasured& b) { return *a.moisture < *b.moisture; });
    if (least == most || *least->moisture == *most->moisture)
      throw ParameterError(
        fmt::format("all was measured at {:g}, and one moisture does not tell the slope", *least->moisture),
        "measure at another moisture as well, or leave out the slope");
    least_ = *least->moisture;
    most_ = *most->moisture;
  }

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

  [[nodiscard]] std::vector<FitParameter> parameters() const
  {
    std::vector<FitParameter> all;
    for (std::size_t i = 0; i < found_.unknowns.size(); ++i)
    {
      const FitUnknown& u = found_.unknowns[i];
      const FitUnknown& value = u.slope ? found_.unknowns[*partner_[i]] : u;
      FitParameter p{ value.name(), value.start.value_or(model_.startOf(value, meanMeasured())), model_.scales(value) };
      if (partner_[i])
      {
        const double moisture = u.slope ? most_ : least_;
        p.name += fmt::format(" at {:g}", moisture);
        p.start += found_.unknowns[u.slope ? i : *partner_[i]].start.value_or(0) * moisture;
      }
      all.push_back(std::move(p));
    }
    return all;
  }

  /// @param values of the search
  void set(std::span<const double> values, const std::optional<double>& moisture)
  {
    for (std::size_t i = 0; i < found_.unknowns.size(); ++i)
      if (!found_.unknowns[i].slope)
        model_.set(
          found_.unknowns[i], partner_[i] ? std::lerp(values[i], values[*partner_[i]], share(*moisture)) : values[i]);
  }

  void solve(const Case& one)
  {
    solve_(one.sample);
    ++found_.solves;
    const std::vector<std::string> names = model_.quantities();
    for (const FitMeasured& m : found_.measured)
      if (m.sample == one.sample && std::find(names.begin(), names.end(), m.quantity) == names.end())
        throw ParameterError("measured " + m.value.name + ": '" + m.quantity + "' is not found of this sample",
          suggestion(m.quantity, names, "what is found is " + quotedList(names, "and")));
  }

  /// By what of the search, as far as that unknown goes: of a slope and of its value each a part.
  [[nodiscard]] double derivative(const FitMeasured& m, std::size_t unknown) const
  {
    const FitUnknown& u = found_.unknowns[unknown];
    if (!partner_[unknown])
      return model_.derivative(m.quantity, u);
    const double part = share(*m.moisture);
    return model_.derivative(m.quantity, u.slope ? found_.unknowns[*partner_[unknown]] : u) *
      (u.slope ? part : 1 - part);
  }

  FitEvaluation evaluate(std::span<const double> values)
  {
    const std::size_t unknowns = found_.unknowns.size();
    FitEvaluation e;
    e.values.assign(found_.measured.size(), 0.0);
    e.derivatives.assign(found_.measured.size() * unknowns, 0.0);
    for (const Case& one : std::span(cases_).last(measuredCases_))
    {
      set(values, one.moisture);
      solve(one);
      for (std::size_t j = 0; j < found_.measured.size(); ++j)
      {
        const FitMeasured& m = found_.measured[j];
        if (Case{ m.sample, m.moisture } != one)
          continue;
        e.values[j] = model_.value(m.quantity);
        for (std::size_t i = 0; i < unknowns; ++i)
          e.derivatives[j * unknowns + i] = derivative(m, i);
      }
    }
    return e;
  }

  /// Solves there once more, with the error of lattice and picture.
  void conclude(const std::vector<FitMeasurement>& measurements, bool fields)
  {
    std::vector<double> values;
    for (const auto& p : found_.best.parameters)
      values.push_back(p.value);
    model_.finish(fields);
    found_.errors.assign(measurements.size(), unknown);
    for (std::size_t c = cases_.size(); c-- > 0;) // the first sample's fields last
    {
      set(values, cases_[c].moisture);
      solve(cases_[c]);
      for (std::size_t j = 0; j < measurements.size(); ++j)
        if (Case{ found_.measured[j].sample, found_.measured[j].moisture } == cases_[c])
          found_.errors[j] = model_.error(found_.measured[j].quantity);
    }
    found_.withLattice =
      std::all_of(found_.errors.begin(), found_.errors.end(), [](double error) { return std::isfinite(error); });
    if (found_.withLattice)
    {
      widen(found_.best, measurements, errors());
      tell();
    }
  }

  /// A picture errs the same way at all moistures: its quantities are causes of their own.
  [[nodiscard]] std::vector<statistics::FitError> errors() const
  {
    std::vector<std::pair<std::size_t, std::string>> causes;
    std::vector<statistics::FitError> all;
    for (std::size_t j = 0; j < found_.measured.size(); ++j)
    {
      const std::pair cause{ found_.measured[j].sample, found_.measured[j].quantity };
      const auto place = std::find(causes.begin(), causes.end(), cause);
      all.push_back({ std::abs(found_.errors[j]), static_cast<int>(place - causes.begin()) });
      if (place == causes.end())
        causes.push_back(cause);
    }
    return all;
  }

  /// What the search found as values and slopes, with their covariance.
  void tell()
  {
    const std::size_t m = found_.unknowns.size();
    const auto& best = found_.best;
    found_.values = best.parameters;
    std::vector<double> rows(m * m, 0.0); // derivatives of what is told by the logarithms of the search
    for (std::size_t i = 0; i < m; ++i)
    {
      rows[i * m + i] = 1;
      if (!partner_[i])
        continue;
      const bool slope = found_.unknowns[i].slope;
      const std::size_t low = slope ? *partner_[i] : i;
      const std::size_t high = slope ? i : *partner_[i];
      // as sums of the values at the least and the most moisture
      const double range = most_ - least_;
      const double ofLow = slope ? -1 / range : most_ / range;
      const double ofHigh = slope ? 1 / range : -least_ / range;
      rows[i * m + low] = ofLow * best.parameters[low].value;
      rows[i * m + high] = ofHigh * best.parameters[high].value;
    }
    found_.covariance.assign(m * m, 0.0);
    for (std::size_t a = 0; a < m; ++a)
      for (std::size_t b = 0; b < m; ++b)
        for (std::size_t k = 0; k < m; ++k)
          for (std::size_t l = 0; l < m; ++l)
            found_.covariance[a * m + b] += rows[a * m + k] * best.covariance[k * m + l] * rows[b * m + l];
    for (std::size_t i = 0; i < m; ++i)
    {
      if (!partner_[i] || (!found_.unknowns[i].slope && least_ == 0)) // is one of the search's own
        continue;
      double value = 0;
      for (std::size_t k = 0; k < m; ++k)
        value += rows[i * m + k];
      const double half = statistics::coverage95 * std::sqrt(found_.covariance[i * m + i]);
      found_.values[i] = { value, value - half, value + half };
    }
  }

  FitModel& model_;
  FoundFit& found_;
  const std::function<void(std::size_t)>& solve_;
  std::vector<std::optional<std::size_t>> partner_; ///< by unknown: of a value its slope, of a slope its value
  std::vector<Case> cases_;
  std::size_t measuredCases_ = 0; ///< the last ones
  double least_ = 0, most_ = 0;   ///< moisture
};

} // namespace

double FoundFit::correlation(std::size_t a, std::size_t b) const
{
  const std::size_t m = unknowns.size();
  return covariance[a * m + b] / std::sqrt(covariance[a * m + a] * covariance[b * m + b]);
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
    if (text.empty()) // a row of a panel
      continue;
    FitUnknown u;
    std::string word = text;
    const std::string before = "slope:";
    u.slope = word.starts_with(before);
    if (const std::size_t equals = text.find('='); equals != std::string::npos)
    {
      const auto start = toNumber(text.substr(equals + 1));
      if (!start || !(u.slope ? std::isfinite(*start) : *start > 0 && plausible(*start)))
        throw ParameterError(fmt::format("unknown {}: '{}' is not a number{}", text, text.substr(equals + 1),
                               u.slope ? "" : " between 1e-30 and 1e30"),
          u.slope ? "a slope starts from what the property changes by where moisture changes by 1"
                  : "a search starts from a positive number");
      u.start = *start;
      word = text.substr(0, equals);
    }
    if (u.slope)
      word = word.substr(before.size());
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
  const std::string form =
    "QUANTITY=VALUE±HALF, of the second sample 2/QUANTITY=VALUE±HALF, at a moisture QUANTITY@MOISTURE=VALUE±HALF";
  std::vector<FitMeasured> all;
  for (const std::string& text : texts)
  {
    if (text.empty()) // a row of a panel
      continue;
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
    if (const std::size_t at = m.quantity.find('@'); at != std::string::npos)
    {
      m.moisture = numberIn("measured", text, m.quantity.substr(at + 1), form);
      m.quantity = m.quantity.substr(0, at);
    }
    const auto [value, half] = splitUncertainty(text.substr(equals + 1));
    if (half.empty())
      throw ParameterError("measured " + text + " does not say how far it may be off",
        "write half of the interval that holds it 19 times out of 20: " + text + "±…");
    m.value = { name, numberIn("measured", text, value, form), numberIn("measured", text, half, form) };
    if (std::any_of(all.begin(), all.end(),
          [&](const FitMeasured& other) {
            return std::tie(other.sample, other.quantity, other.moisture) == std::tie(m.sample, m.quantity, m.moisture);
          }))
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
    "fit_value", m, [&](std::size_t i) { return found.values[i].value; });
  numbers(
    "fit_low", m, [&](std::size_t i) { return found.values[i].low; });
  numbers(
    "fit_high", m, [&](std::size_t i) { return found.values[i].high; });
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

void fillTables(vtkTable* unknowns, vtkTable* measured, const FoundFit& found)
{
  const Columns sought{ unknowns->GetRowData(), found.unknowns, "vtkMaterialFit" };
  sought.words("unknown", &FitUnknown::key);
  sought.numbers(
    "value", "", "what fits best, in the unit of the property", [&](std::size_t i) { return found.values[i].value; });
  sought.numbers(
    "low", "", "interval that holds it 19 times out of 20", [&](std::size_t i) { return found.values[i].low; });
  sought.numbers(
    "high", "", "its other end", [&](std::size_t i) { return found.values[i].high; });
  sought.numbers(
    "low_by_measurement", "", "interval by the measurements alone",
    [&](std::size_t i) { return found.byMeasurement[i].low; });
  sought.numbers(
    "high_by_measurement", "", "its other end", [&](std::size_t i) { return found.byMeasurement[i].high; });
  const Columns told{ measured->GetRowData(), found.measured, "vtkMaterialFit" };
  told.words(
    "measured", [&](std::size_t j) { return found.measured[j].value.name; });
  told.numbers(
    "value", "", "what was measured", [&](std::size_t j) { return found.measured[j].value.value; });
  told.numbers(
    "half_width", "", "half of the interval that holds it 19 times out of 20",
    [&](std::size_t j) { return found.measured[j].value.halfWidth; });
  told.numbers(
    "fitted", "", "the same at the fit", [&](std::size_t j) { return found.best.values[j]; });
  told.numbers("lattice_and_picture", "", "what these leave of that; NaN where it is not known",
    [&](std::size_t j) { return found.errors[j]; });
}

} // namespace lamella
