#include "VoxelMaterials.h"

#include "Uncertainties.h"

#include "core/Error.h"
#include "core/Parse.h"
#include "elasticity/SharedVoxels.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella
{
namespace
{

namespace el = elasticity;

constexpr double usualRatio = 0.3;

/// The upper triangle of a tensor that is written as its numbers: 21 of space, also for pictures, or 6 of the plane.
el::PhaseStiffness tensorOf(const std::string& text, int dimension, const std::string& phase)
{
  auto [numbers, wrong] = toNumbers(text);
  if (wrong)
    throw ParameterError(fmt::format("'{}' of the stiffness of '{}' is no number", *wrong, phase),
      "give numbers [Pa] with spaces between them");
  if (dimension == 2 && numbers.size() == 4) // C11 C12 C22 C66
    return { numbers[0], numbers[1], 0, numbers[2], 0, numbers[3] };
  if (numbers.size() == 3) // cubic
    numbers = { numbers[0], numbers[1], numbers[1], numbers[0], numbers[1], numbers[0], numbers[2], numbers[2],
      numbers[2] };
  if (numbers.size() == 9)
    return { numbers[0], numbers[1], numbers[2], 0, 0, 0, numbers[3], numbers[4], 0, 0, 0, numbers[5], 0, 0, 0,
      numbers[6], 0, 0, numbers[7], 0, numbers[8] };
  if (numbers.size() != 21 && (dimension == 3 || numbers.size() != 6))
    throw ParameterError(fmt::format("{} numbers for the stiffness of '{}'", numbers.size(), phase),
      dimension == 3
        ? "give 21, the upper triangle by rows; 9 of an orthotropic one or 3 of a cubic one"
        : "give 6, the upper triangle by rows, or 4 of an orthotropic one, of the plane; or those of space, "
          "21, 9 or 3");
  return numbers;
}

} // namespace

VoxelMaterials::VoxelMaterials(const VoxelSettings& s, const PhaseIds& phases, std::span<const std::int64_t> nodes)
  : strain_(s.continuum == el::Continuum::PlaneStrain)
{
  const std::vector<std::string>& names = phases.names;
  requireVoids(phases, s.voids);
  for (const std::string& name : s.rigid)
    requirePhase(phases, name, fmt::format("'{}' is to be rigid, and is no phase of this image", name));
  requireUncertainties(s.young, s.youngUncertainty, "Young's modulus");
  requireUncertainties(s.poisson, s.poissonUncertainty, "Poisson's ratio");
  requireUncertainties(s.youngAcross, s.youngAcrossUncertainty, "Young's modulus across its axis");
  requireUncertainties(s.poissonAcross, s.poissonAcrossUncertainty, "Poisson's ratio across its axis");
  requireUncertainties(s.shear, s.shearUncertainty, "shear modulus");
  const auto listed = [&](const std::vector<std::string>& list, std::size_t id)
  { return std::ranges::any_of(list, [&](const std::string& name) { return phaseMeant(names, name) == id; }); };
  const int dimension = el::dimensionOf(s.continuum);
  bool allIsotropic = true;
  std::vector<std::string> lacking;
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    const auto of = [&](const VoxelSettings::Values& table) -> const double*
    {
      const auto found = entryOf(table, names, id);
      return found != table.end() ? &found->second : nullptr;
    };
    el::VoxelMaterial material;
    Phase phase;
    const double* const young = of(s.young);
    const auto components = entryOf(s.stiffness, names, id);
    const bool full = components != s.stiffness.end();
    const bool rigid = listed(s.rigid, id);
    bool isVoid = s.voids.empty() ? isVoidName(names[id]) && young == nullptr && !full && !rigid : listed(s.voids, id);
    isVoid = isVoid || (young != nullptr && *young == 0);
    const auto refuse = [&](const char* both)
    { throw ParameterError(fmt::format("'{}' {}", names[id], both), "say one thing of each phase"); };
    if (rigid && (isVoid || young != nullptr || full))
      refuse(isVoid ? "is to be void and rigid" : "is to be rigid and has a stiffness");
    if (full && young != nullptr)
      refuse("has components of its stiffness and a Young's modulus");
    if (isVoid && full)
      refuse("is to be void and has a stiffness");
    if (isVoid && young != nullptr && *young != 0)
      refuse("is to be void and has a Young's modulus");
    const double* const across = of(s.youngAcross);
    const double* const shear = of(s.shear);
    const double* const poisson = of(s.poisson);
    const double* const poissonAcross = of(s.poissonAcross);
    const double* const expansion = of(s.expansion);
    const double* const expansionAcross = of(s.expansionAcross);
    for (const auto& [value, what] : { std::pair{ shear, "shear modulus along an axis" },
           { poissonAcross, "Poisson's ratio across an axis" }, { expansionAcross, "expansion across an axis" } })
      if (value != nullptr && across == nullptr && nodes[id] > 0)
        throw ParameterError(fmt::format("'{}' has a {}, and no Young's modulus across it", names[id], what),
          "give its Young's modulus across the axis too, or leave that out");
    if (across != nullptr && young == nullptr && nodes[id] > 0)
      throw ParameterError(
        fmt::format("'{}' has a Young's modulus across its axis, and none along it", names[id]), "give both");
    material.stiffness = el::voidStiffness(s.continuum);
    phase.expansion = { expansion != nullptr ? *expansion : 0.0,
      expansionAcross != nullptr ? *expansionAcross
        : expansion != nullptr   ? *expansion
                                 : 0.0 };
    if (!std::isfinite(phase.expansion[0]) || !std::isfinite(phase.expansion[1]))
      throw ParameterError(fmt::format("an expansion of '{}' that is not finite", names[id]), "give a finite number");
    nlohmann::json& told = told_[names[id]];
    std::optional<el::TransverseMaterial> constants;
    std::optional<std::array<double, 3>> inPlane; // expansion of a tensor that is known in space
    if (rigid)
    {
      material.rigid = true;
      told["rigid"] = true;
      allIsotropic = allIsotropic && nodes[id] == 0;
    }
    else if (full)
    {
      el::PhaseStiffness tensor = tensorOf(components->second, dimension, names[id]);
      told["stiffness"] = tensor;
      const bool inSpace = tensor.size() == 21;
      el::requireStable(inSpace ? el::Continuum::Space : s.continuum, tensor, fmt::format("'{}'", names[id]).c_str());
      material.stiffness = inSpace ? el::inPlane(s.continuum, tensor) : tensor;
      if (inSpace && dimension == 2)
      {
        phase.across = el::acrossPlane(s.continuum, tensor, phase.expansion[0]);
        inPlane = el::planeExpansion(s.continuum, tensor, phase.expansion[0]);
      }
      allIsotropic = allIsotropic && nodes[id] == 0;
    }
    else if (!isVoid && young != nullptr && nodes[id] > 0)
    {
      el::TransverseMaterial m;
      m.youngAlong = m.youngAcross = *young;
      m.poissonAlong = m.poissonAcross = poisson != nullptr ? *poisson : usualRatio;
      told["young"] = *young;
      told["poisson"] = m.poissonAlong;
      const auto number = [&](const char* property, double value, const VoxelSettings::Values& uncertainty,
                            const std::array<double, 5>& by)
      {
        const double* const half = of(uncertainty);
        material.changes.push_back({ numbers_.size(), by });
        numbers_.push_back({ property, names[id], value, half != nullptr ? *half : 0.0 });
        std::string key = property;
        std::ranges::replace(key, '-', '_');
        if (half != nullptr)
          told[key + "_uncertainty"] = *half;
      };
      try
      {
        if (across == nullptr)
        {
          material.stiffness = el::isotropicStiffness(s.continuum, *young, m.poissonAlong);
          m.shearAlong = *young / (2 * (1 + m.poissonAlong));
          const auto by = el::isotropicChanges(s.continuum, *young, m.poissonAlong);
          number("young", *young, s.youngUncertainty, by[0]);
          number("poisson", m.poissonAlong, s.poissonUncertainty, by[1]);
        }
        else
        {
          phase.transverse = turn_ = true;
          allIsotropic = false;
          m.youngAcross = *across;
          m.poissonAcross = poissonAcross != nullptr ? *poissonAcross : usualRatio;
          m.shearAlong =
            shear != nullptr ? *shear : 1 / (1 / m.youngAlong + 1 / m.youngAcross + 2 * m.poissonAlong / m.youngAlong);
          material.stiffness = el::transverseStiffness(s.continuum, m, { 1, 0, 0 });
          material.axial = el::axialModuli(s.continuum, m);
          auto by = el::transverseChanges(s.continuum, m);
          if (shear == nullptr) // it changes with the others
          {
            const double square = m.shearAlong * m.shearAlong;
            const std::array<double, 3> change{ square * (1 + 2 * m.poissonAlong) / (*young * *young),
              square / (*across * *across), -2 * square / *young };
            for (std::size_t k = 0; k < change.size(); ++k)
              for (std::size_t c = 0; c < by[k].size(); ++c)
                by[k][c] += change[k] * by[4][c];
          }
          number("young", *young, s.youngUncertainty, by[0]);
          number("young-across", *across, s.youngAcrossUncertainty, by[1]);
          number("poisson", m.poissonAlong, s.poissonUncertainty, by[2]);
          number("poisson-across", m.poissonAcross, s.poissonAcrossUncertainty, by[3]);
          if (shear != nullptr)
            number("shear", *shear, s.shearUncertainty, by[4]);
          told["young_across"] = m.youngAcross;
          told["poisson_across"] = m.poissonAcross;
          told["shear"] = m.shearAlong;
        }
      }
      catch (const ParameterError& error)
      {
        throw ParameterError(fmt::format("{} of phase '{}'", error.what(), names[id]), error.hint());
      }
      constants = m;
      if (dimension == 2)
        phase.across = el::acrossPlane(s.continuum, m, phase.expansion);
    }
    else if (!isVoid && nodes[id] > 0)
      lacking.push_back(names[id]);
    if (isVoid)
      told["void"] = true;
    if (phase.expansion[0] != 0 || phase.expansion[1] != 0)
    {
      told["expansion"] = phase.expansion[0];
      if (phase.transverse)
        told["expansion_across"] = phase.expansion[1];
      const std::array<double, 2> plane =
        constants ? el::planeExpansion(s.continuum, *constants, phase.expansion) : phase.expansion;
      if (phase.transverse)
        material.expansion = { plane[0], plane[1] };
      else if (!isVoid && !rigid)
      {
        if (full && strain_ && !inPlane)
          throw ParameterError(
            fmt::format("the expansion of '{}' in plane strain, of a tensor of the plane alone", names[id]),
            "give it constants, or its tensor in space (21, 9 or 3 numbers), or take plane stress");
        material.expansion.assign(material.stiffness.size() == 21 ? 6 : 3, 0.0);
        std::fill_n(material.expansion.begin(), dimension, plane[1]);
        if (inPlane)
          material.expansion.assign(inPlane->begin(), inPlane->end());
      }
    }
    if (told.is_null() || nodes[id] == 0)
      told_.erase(names[id]);
    materials_.push_back(std::move(material));
    phases_.push_back(phase);
    void_.push_back(isVoid);
  }
  if (!lacking.empty())
    throw ParameterError(fmt::format("{} '{}' {} no Young's modulus", lacking.size() > 1 ? "phases" : "phase",
                           fmt::join(lacking, "', '"), lacking.size() > 1 ? "have" : "has"),
      "give each one, make it void or rigid, or give the components of its stiffness");
  if (!allIsotropic)
    return;
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    const auto& c = materials_[id].stiffness;
    const std::size_t last = c.size() - 1;
    const double lambda = c[1];
    const double mu = c[last];
    isotropic_.bulk.push_back(lambda + 2 * mu / dimension);
    isotropic_.shear.push_back(mu);
  }
}

VoxelMaterials::VoxelMaterials(const VoxelSettings& settings, std::span<const double> shares)
{
  PhaseIds two;
  two.names = two.known = { "low", "high" };
  const std::array<std::int64_t, 2> some{ 1, 1 };
  VoxelSettings named = settings;
  const auto given = [&](const char* name) { return named.young.contains(name) || named.stiffness.contains(name); };
  if (named.voids.empty()) // what has no modulus is void
    for (const char* const name : { "low", "high" })
      if (!given(name))
        named.voids.emplace_back(name);
  for (const auto& [name, value] : settings.young)
    if (name != "low" && name != "high")
      throw ParameterError("a Young's modulus of '" + name + "' where greys are shares of two phases",
        "give materials of low and high, the phases of the low and of the high greys");
  VoxelMaterials own(named, two, some);
  materials_ = el::sharedMaterials(settings.continuum, own.materials_[0], own.materials_[1], shares);
  layers_ = !own.turn_ && !own.isVoid(0) && !own.isVoid(1);
  turn_ = own.turn_ || layers_;
  strain_ = own.strain_;
  told_ = own.told_;
  numbers_ = own.numbers_;
  isotropic_ = own.isotropic_;
  for (std::size_t id = 0; id < materials_.size(); ++id)
  {
    const double share = shares[id];
    void_.push_back(std::ranges::all_of(materials_[id].stiffness, [](double c) { return c == 0; }));
    const bool hollow = own.isVoid(0) || own.isVoid(1);
    Phase phase = own.phases_[own.isVoid(0) || (!own.isVoid(1) && share >= 1) ? 1 : 0];
    const double held = !hollow ? 1 : own.isVoid(0) ? share : 1 - share; // of the solid
    if (!hollow && share > 0 && share < 1)
      phase.across.reset(); // layers, each with its own
    else if (phase.across && held > 0)
    {
      // the voxel's stress is the solid's times its share, in plane strain also across
      for (double& by : phase.across->byStress)
        by /= strain_ ? 1 : held;
      phase.across->byChange *= strain_ ? held : 1;
    }
    phases_.push_back(phase);
  }
}

std::vector<double> sharesOf(const PhaseIds& phases, double none, double all)
{
  std::vector<double> shares;
  for (const std::string& text : phases.names)
  {
    const std::optional<double> grey = toNumber(text);
    if (!grey)
      throw ParameterError("shares of greys were given for an image whose phases have names, as '" + text + "'",
        "give the grey image itself, and no names of phases");
    shares.push_back(std::clamp((*grey - none) / (all - none), 0.0, 1.0));
  }
  return shares;
}

bool VoxelMaterials::uncertain() const
{
  return std::ranges::any_of(
    numbers_, [](const MaterialNumber& number) { return number.uncertainty > 0; });
}

double VoxelMaterials::acrossPlane(
  std::uint8_t id, double xx, double yy, double xy, const std::array<float, 3>& axis, double change) const
{
  const Phase& phase = phases_[id];
  if (void_[id] || materials_[id].rigid)
    return 0.0;
  if (!phase.across)
    return std::numeric_limits<double>::quiet_NaN();
  const auto& by = phase.across->byStress;
  const double value = phase.across->byChange * change;
  if (!phase.transverse)
    return value + by[0] * xx + by[1] * yy + by[2] * xy;
  const auto x = static_cast<double>(axis[0]);
  const auto y = static_cast<double>(axis[1]);
  const double along = (xx * x * x + yy * y * y + 2 * xy * x * y) / (x * x + y * y);
  return value + by[0] * along + by[1] * (xx + yy - along);
}

std::vector<double> voigtVector(const std::map<std::string, double>& components, int dimension, const char* what)
{
  if (components.empty())
    return {};
  const std::vector<std::string> names = el::voigtNames(dimension);
  std::vector<double> values(names.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [name, value] : components)
  {
    const auto place = std::ranges::find(names, name);
    if (place == names.end())
      throw ParameterError(fmt::format("a {} '{}' of a {}", what, name, dimension == 3 ? "volume" : "picture"),
        fmt::format("there are {}", fmt::join(names, ", ")));
    if (!std::isfinite(value))
      throw ParameterError(fmt::format("a {} {} of {}", what, name, value), "give a finite number");
    values[static_cast<std::size_t>(place - names.begin())] = value;
  }
  return values;
}

} // namespace lamella
