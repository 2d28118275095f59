#include "peridynamics/BondModel.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{

std::string pairName(const BondModel& model, std::uint8_t a, std::uint8_t b)
{
  const auto name = [&](std::uint8_t id)
  { return id < model.phaseNames.size() ? model.phaseNames[id] : fmt::format("phase {}", id); };
  return a == b ? name(a) : fmt::format("{} and {}", name(a), name(b));
}

Stencil bondStencil(const BondModel& model)
{
  const Stencil stencil(model.continuum == Continuum::Space ? 3 : 2, model.horizon);
  return model.micromodulus == Micromodulus::Isotropic ? isotropicStencil(stencil).value_or(stencil) : stencil;
}

BondKinds::BondKinds(const BondModel& model, const Stencil& stencil, double spacing)
  : kinds_(1)
  , within_(256 * 256, -1)
  , between_(256 * 256, -1)
{
  if (model.pairs.empty())
    throw ParameterError("no material is given for any pair of phases", "give Young's modulus of each phase's bonds");
  for (const std::uint8_t id : model.voids)
  {
    void_[id] = true;
    for (int other = 0; other < 256; ++other)
      for (auto* table : { &within_, &between_ })
        (*table)[position(id, static_cast<std::uint8_t>(other))] =
          (*table)[position(static_cast<std::uint8_t>(other), id)] = 0;
  }
  std::vector<int> groups{ 0 }; // of the kinds
  const auto number = [&](const BondMaterial& material, const std::string& name)
  {
    const BondConstants c = bondConstants(material, stencil, spacing, model.continuum, model.micromodulus, name);
    const BondKind kind{ c.micromodulus * std::pow(spacing, 2 * stencil.dimension()), c.criticalStretch };
    const int group = model.pairGroups.empty() ? 0 : model.pairGroups.at(ofPairs_.size());
    std::size_t known = 1;
    while (known < kinds_.size() && !(kinds_[known] == kind && groups[known] == group))
      ++known;
    if (known == kinds_.size())
    {
      if (kinds_.size() > 255)
        throw ParameterError(
          "more than 255 different kinds of bonds", "give the same material to some pairs of phases");
      kinds_.push_back(kind);
      groups.push_back(group);
    }
    ofPairs_.push_back(static_cast<int>(known));
    return static_cast<std::int16_t>(known);
  };
  bool anyBetween = false;
  for (const auto& [ids, pair] : model.pairs)
  {
    const auto [a, b] = ids;
    const std::string name = pairName(model, a, b);
    if (void_[a] || void_[b])
      throw ParameterError(fmt::format("a material is given for {}, but {} carries no bonds", name,
                             pairName(model, void_[a] ? a : b, void_[a] ? a : b)),
        "take the pair out, or the phase from the voids");
    if (a > b && model.pairs.contains({ b, a }))
      throw ParameterError(fmt::format("the material of {} is given twice", name), "give each pair of phases once");
    const std::int16_t inside = number(pair.material, name);
    std::int16_t between = inside;
    if (pair.betweenGrains)
    {
      anyBetween = true;
      const std::int16_t other = number(*pair.betweenGrains, fmt::format("{} between grains", name));
      between = model.pairByGrain ? other : inside;
    }
    within_[position(a, b)] = within_[position(b, a)] = inside;
    between_[position(a, b)] = between_[position(b, a)] = between;
  }
  if (model.pairByGrain && !anyBetween)
    throw ParameterError("bonds between grains are to differ, but no pair of phases says how",
      "give at least one pair a material between grains");
}

} // namespace lamella::peridynamics
