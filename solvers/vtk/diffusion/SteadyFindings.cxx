#include "SteadyFindings.h"

#include "DiffusionScene.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella
{
namespace
{

constexpr double notFound = std::numeric_limits<double>::quiet_NaN();

/// By direction, NaN where that was not solved.
template <class Read>
std::array<double, 3> byDirection(const SteadyFindings& found, Read&& read)
{
  std::array<double, 3> numbers{ notFound, notFound, notFound };
  for (const lbm::DiffusionAnswer& answer : found.answers)
    numbers[static_cast<std::size_t>(answer.axis)] = static_cast<double>(read(answer));
  return numbers;
}

nlohmann::json conductivityJson(const SteadyFindings& found)
{
  nlohmann::json conductivity;
  for (std::size_t id = 0; id < found.conductivity.size(); ++id)
  {
    if (found.fractions[id] > 0)
    {
      auto& entry = conductivity[found.phases[id]];
      entry = found.conductivity[id];
      if (!found.across.empty() && found.across[id] != found.conductivity[id])
        entry = { found.conductivity[id], found.across[id] }; // along, across
      if (found.general(id))
        entry = found.tensors[id];
    }
  }
  return conductivity;
}

} // namespace

std::array<double, 9> SteadyFindings::tensor() const
{
  std::array<double, 9> tensor{};
  tensor.fill(notFound);
  for (const lbm::DiffusionAnswer& answer : answers)
    for (int row = 0; row < dimension; ++row)
      tensor[static_cast<std::size_t>(3 * row + answer.axis)] = answer.result.effective[static_cast<std::size_t>(row)];
  return tensor;
}

double SteadyFindings::error(double ErrorEstimate::*kind) const
{
  return lbm::worst(answers, kind);
}

double SteadyFindings::windowError() const
{
  double largest = notFound;
  for (const lbm::DiffusionAnswer& answer : answers)
    if (answer.window)
      largest = std::fmax(largest, answer.window->relative());
  return largest;
}

bool SteadyFindings::outlinesServe() const
{
  return dimension == 2 && across.empty() && tensors.empty() && !shares && !rounding && membranes.empty() &&
    std::ranges::count_if(
      fractions, [](double f) { return f > 0; }) == 2;
}

std::optional<std::size_t> SteadyFindings::conductingPhase() const
{
  std::optional<std::size_t> only;
  for (std::size_t id = 0; id < fractions.size(); ++id)
  {
    const bool conducts = fractions[id] > 0 && (conductivity[id] > 0 || (!across.empty() && across[id] > 0));
    if (conducts && (only || general(id) || (!across.empty() && across[id] != conductivity[id])))
      return std::nullopt;
    only = conducts ? id : only;
  }
  return only;
}

double SteadyFindings::relative(const lbm::DiffusionAnswer& answer) const
{
  const std::optional<std::size_t> phase = conductingPhase();
  return phase ? answer.result.effective[static_cast<std::size_t>(answer.axis)] / conductivity[*phase] : notFound;
}

double SteadyFindings::tortuosityFactor(const lbm::DiffusionAnswer& answer) const
{
  return bounds.parallel / answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

double SteadyFindings::inputError(const lbm::DiffusionAnswer& answer, std::size_t id, bool across) const
{
  const std::vector<double>& doubt = across ? acrossUncertainty : uncertainty;
  const std::vector<double>& by = across ? answer.derivatives.across : answer.derivatives.along;
  if (id >= doubt.size() || id >= by.size() || doubt[id] == 0)
    return 0;
  return std::abs(by[id]) * doubt[id] / answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

double SteadyFindings::membraneSensitivity(const lbm::DiffusionAnswer& answer, const FoundMembrane& membrane)
{
  if (answer.derivatives.along.empty())
    return notFound;
  return membrane.place ? answer.derivatives.membranes[*membrane.place] : 0;
}

double SteadyFindings::inputError(const lbm::DiffusionAnswer& answer) const
{
  if (uncertainty.empty() && acrossUncertainty.empty())
    return notFound;
  double sum = 0;
  for (const bool other : { false, true })
    for (std::size_t id = 0; id < conductivity.size(); ++id)
      sum += std::pow(inputError(answer, id, other), 2);
  return std::sqrt(sum);
}

double SteadyFindings::segmentationError(const lbm::DiffusionAnswer& answer) const
{
  if (std::isnan(surfaceDoubt))
    return notFound;
  double sum = 0;
  for (const double shift : answer.surfaces.shift)
    sum += shift * shift;
  return surfaceDoubt * std::sqrt(sum) / answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

std::vector<statistics::ErrorPart> SteadyFindings::errorParts(const lbm::DiffusionAnswer& answer) const
{
  std::vector<statistics::ErrorPart> parts;
  const auto add = [&](const char* name, double error)
  {
    if (std::isfinite(error))
      parts.push_back({ name, error });
  };
  add("lattice and picture", answer.error.relative);
  add("window", answer.window ? answer.window->relative() : notFound);
  add("segmentation", segmentationError(answer));
  add("conductivities", inputError(answer));
  return parts;
}

double SteadyFindings::totalError(const lbm::DiffusionAnswer& answer) const
{
  return statistics::totalError(errorParts(answer));
}

bool SteadyFindings::tellsParts() const noexcept
{
  return windows || !uncertainty.empty() || !acrossUncertainty.empty() || !std::isnan(surfaceDoubt);
}

SteadyFindings SteadyFindings::along(int axis) const
{
  SteadyFindings one = *this;
  std::erase_if(one.answers, [axis](const lbm::DiffusionAnswer& answer) { return answer.axis != axis; });
  one.direction = axisNames[static_cast<std::size_t>(axis)];
  return one;
}

void describe(vtkImageData* output, const SteadyFindings& found)
{
  setFieldNumbers(output, "effective_conductivity", found.tensor());
  for (const auto& [name, kind] : { std::pair{ "estimated_error", &ErrorEstimate::relative },
         std::pair{ "lattice_error", &ErrorEstimate::lattice }, std::pair{ "picture_error", &ErrorEstimate::picture } })
  {
    setFieldNumbers(output, name, std::array{ found.error(kind) });
    setFieldNumbers(output, (std::string(name) + "_by_direction").c_str(),
      byDirection(found, [kind = kind](const auto& answer) { return answer.error.*kind; }));
  }
  const auto write = [&](const char* name, auto&& read) { setFieldNumbers(output, name, byDirection(found, read)); };
  write(
    "extrapolated_conductivity", [](const auto& answer) { return answer.error.extrapolated; });
  write(
    "relative_conductivity", [&](const auto& answer) { return found.relative(answer); });
  write(
    "formation_factor", [&](const auto& answer) { return 1 / found.relative(answer); });
  write("tortuosity_factor", [&](const auto& answer) { return found.tortuosityFactor(answer); });
  setFieldNumbers(output, "bounds",
    std::array{ found.bounds.series, found.bounds.hashinShtrikmanLower, found.bounds.hashinShtrikmanUpper,
      found.bounds.parallel });
  write(
    "balance", [](const auto& answer) { return answer.result.balance; });
  write(
    "solver_error", [](const auto& answer) { return answer.result.solverError; });
  write(
    "iterations", [](const auto& answer) { return answer.result.iterations; });
  write(
    "stored_nodes", [](const auto& answer) { return answer.result.stored; });
  write(
    "skipped_nodes", [](const auto& answer) { return answer.result.skipped; });
  write("refinement", [](const auto& answer) { return answer.refinement; });
  const auto writeSensitivity = [&](const char* name, std::vector<double> lbm::ConductivityDerivatives::*of)
  {
    std::vector<double> numbers(3 * found.conductivity.size(), notFound);
    bool any = false;
    for (const lbm::DiffusionAnswer& answer : found.answers)
      for (std::size_t id = 0; id < (answer.derivatives.*of).size(); ++id, any = true)
        numbers[3 * id + static_cast<std::size_t>(answer.axis)] = (answer.derivatives.*of)[id];
    if (any)
      setFieldNumbers(output, name, numbers);
  };
  writeSensitivity("conductivity_sensitivity", &lbm::ConductivityDerivatives::along);
  writeSensitivity("conductivity_across_sensitivity", &lbm::ConductivityDerivatives::across);
  if (!found.membranes.empty())
  {
    std::vector<std::string> names;
    std::vector<double> resistance;
    std::vector<double> area;
    std::vector<double> sensitivity;
    for (const FoundMembrane& membrane : found.membranes)
    {
      names.push_back(membrane.name);
      resistance.push_back(membrane.resistance);
      area.push_back(membrane.area);
      for (const double by :
        byDirection(found, [&](const auto& answer) { return found.membraneSensitivity(answer, membrane); }))
        sensitivity.push_back(by);
    }
    setFieldTexts(output, "membrane_names", names);
    setFieldNumbers(output, "membrane_resistance", resistance);
    setFieldNumbers(output, "membrane_area", area);
    if (std::ranges::any_of(sensitivity, [](double by) { return std::isfinite(by); }))
      setFieldNumbers(output, "membrane_sensitivity", sensitivity);
  }
  if (!found.uncertainty.empty() || !found.acrossUncertainty.empty())
    write("input_error_by_direction", [&](const auto& answer) { return found.inputError(answer); });
  if (!std::isnan(found.surfaceDoubt))
  {
    setFieldNumbers(output, "surface_doubt", std::array{ found.surfaceDoubt });
    std::vector<double> numbers;
    const std::size_t ids = found.conductivity.size();
    for (std::size_t a = 0; a < ids; ++a)
      for (std::size_t b = a + 1; b < ids; ++b)
      {
        const std::size_t at = numbers.size();
        numbers.insert(numbers.end(), 3, notFound);
        for (const lbm::DiffusionAnswer& answer : found.answers)
          if (!answer.surfaces.shift.empty())
            numbers[at + static_cast<std::size_t>(answer.axis)] = answer.surfaces.shift[a * ids + b];
      }
    setFieldNumbers(output, "surface_sensitivity", numbers);
    write("segmentation_error_by_direction", [&](const auto& answer) { return found.segmentationError(answer); });
  }
  if (found.tellsParts())
    write("total_error_by_direction", [&](const auto& answer) { return found.totalError(answer); });
  if (found.windows)
  {
    using statistics::WindowError;
    const auto window = [&](const char* name, auto&& read)
    { write(name, [&](const auto& answer) { return answer.window ? read(*answer.window) : notFound; }); };
    setFieldNumbers(output, "window_error", std::array{ found.windowError() });
    window(
      "window_error_by_direction", [](const WindowError& w) { return w.relative(); });
    window(
      "window_low", [](const WindowError& w) { return w.low; });
    window(
      "window_high", [](const WindowError& w) { return w.high; });
    window(
      "window_deviation", [](const WindowError& w) { return w.deviation; });
    window(
      "window_freedom", [](const WindowError& w) { return w.freedom; });
    window(
      "window_bias", [](const WindowError& w) { return w.bias; });
    window(
      "window_gradient",
      [](const WindowError& w) { return w.gradient ? static_cast<double>(w.gradient->axis) : notFound; });
    window(
      "layered_conductivity", [](const WindowError& w) { return w.gradient ? w.gradient->layered : notFound; });
    window(
      "layered_low", [](const WindowError& w) { return w.gradient ? w.gradient->low : notFound; });
    window("layered_high", [](const WindowError& w) { return w.gradient ? w.gradient->high : notFound; });
  }
  setFieldNumbers(output, "phase_conductivity", found.conductivity);
  if (!found.across.empty())
    setFieldNumbers(output, "phase_conductivity_across", found.across);
  if (!found.tensors.empty())
  {
    std::vector<double> numbers;
    for (const lbm::SymmetricTensor<double>& tensor : found.tensors)
      numbers.insert(numbers.end(), tensor.begin(), tensor.end());
    setFieldNumbers(output, "phase_conductivity_tensor", numbers);
  }
  setFieldNumbers(output, "phase_fraction", found.fractions);
  if (!found.shares)
    setFieldTexts(output, "phase_names", found.phases);
  if (found.rounding)
    setFieldNumbers(output, "conductivity_rounding", std::array{ *found.rounding });
  setFieldText(output, "phase_array", found.shares ? "" : found.phaseArray); // greys are no phases
  setFieldText(output, "direction", found.direction);
  setFieldText(output, "sides", found.sides);
  setFieldText(output, "lattice", lbm::name(found.stencil));
  setFieldText(output, "quantity", found.quantity);
  if (found.targetError > 0)
    setFieldText(output, "target", lbm::name(found.answers.front().target));
  nlohmann::json settings{ { "conductivity", conductivityJson(found) }, { "direction", found.direction },
    { "quantity", found.quantity }, { "sides", found.sides }, { "lattice", lbm::name(found.stencil) },
    { "tolerance", found.tolerance } };
  for (const FoundMembrane& membrane : found.membranes)
    settings["membrane"][membrane.name] = membrane.resistance;
  continueProvenance(output, "steady_diffusion", settings);
}

} // namespace lamella
