#include "peridynamics/PairTable.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace lamella::peridynamics
{
namespace
{

std::string listed(std::span<const std::string> names)
{
  constexpr std::size_t most = 16;
  std::string text;
  for (const std::string& name : names.first(std::min(most, names.size())))
    text += (text.empty() ? "" : ", ") + name;
  return names.size() > most ? fmt::format("{} and {} more", text, names.size() - most) : text;
}

std::optional<std::uint8_t> findPhase(const std::string& name, std::span<const std::string> names)
{
  const auto found = phaseMeant(names, name);
  return found ? std::optional(static_cast<std::uint8_t>(*found)) : std::nullopt;
}

/// @param own only names that the phases themselves have, and no other words for the same
std::optional<PairKey> readPair(const std::string& text, std::span<const std::string> names, bool own)
{
  const auto find = [&](const std::string& name)
  { return own && std::find(names.begin(), names.end(), name) == names.end() ? std::nullopt : findPhase(name, names); };
  if (const auto id = find(text))
    return PairKey{ *id, *id, false };
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 1))
  {
    const auto a = find(text.substr(0, at));
    const auto b = find(text.substr(at + 1));
    if (a && b)
      return PairKey{ std::min(*a, *b), std::max(*a, *b), *a == *b };
  }
  return std::nullopt;
}

/// The tables by key instead of by name.
class Materials
{
public:
  Materials(const PairTable& table, std::span<const std::string> names)
    : table_(table)
    , names_(names)
    , young_(byKey(table.young, "Young's modulus"))
    , fracture_{ byKey(table.fractureEnergy, "the fracture energy"), byKey(table.toughness, "the toughness"),
      byKey(table.criticalStretch, "the critical stretch") }
  {
    for (const auto& [name, other] : table.like)
    {
      const auto key = findPair(name, names);
      const auto same = findPair(other, names);
      if (key && hasOwn(table.like, *key, name))
        continue;
      if (key && same)
        like_[*key] = *same;
      else if (key)
        throw ParameterError(fmt::format("bonds of '{}' are to be like '{}', which is no pair of phases", name, other),
          "its phases are " + listed(names));
    }
  }

  [[nodiscard]] std::set<PairKey> keys() const
  {
    std::set<PairKey> all;
    for (const auto* values : { &young_, &fracture_[0], &fracture_[1], &fracture_[2] })
      for (const auto& entry : *values)
        all.insert(entry.first);
    for (const auto& entry : like_)
      all.insert(entry.first);
    return all;
  }

  /// Nothing where no Young's modulus is known.
  [[nodiscard]] std::optional<BondMaterial> of(const PairKey& key) const
  {
    const auto young = follow(
      key, [&](const PairKey& k) { return young_.contains(k); });
    const auto breaks = follow(key,
      [&](const PairKey& k)
      { return std::any_of(fracture_.begin(), fracture_.end(), [&](const auto& t) { return t.contains(k); }); });
    if (!young)
    {
      if (breaks)
        throw ParameterError(
          fmt::format("it is said how {} breaks, but it has no Young's modulus", pairText(key, names_)),
          fmt::format("give the pair '{}' a Young's modulus, or make it like another", pairText(key, names_)));
      return std::nullopt;
    }
    BondMaterial material;
    material.youngsModulus = young_.at(*young);
    if (breaks)
    {
      const auto take = [&](std::size_t t) -> std::optional<double>
      {
        const auto entry = fracture_[t].find(*breaks);
        return entry == fracture_[t].end() ? std::nullopt : std::optional(entry->second);
      };
      material.fractureEnergy = take(0);
      material.toughness = take(1);
      material.criticalStretch = take(2);
    }
    return material;
  }

private:
  std::map<PairKey, double> byKey(const PairTable::Values& values, const char* what) const
  {
    std::map<PairKey, double> result;
    std::optional<double> base;
    if (!table_.relativeTo.empty() && !values.empty())
    {
      const auto key = findPair(table_.relativeTo, names_);
      for (const auto& [name, value] : values)
        if (key && findPair(name, names_) == key)
          base = value;
      if (!base)
        throw ParameterError(
          fmt::format("values are relative to '{}', which has no value for {}", table_.relativeTo, what),
          "give that pair its value in SI units");
    }
    for (const auto& [name, value] : values)
    {
      const auto key = findPair(name, names_);
      if (!key)
        continue;
      if (!(value > 0) || !std::isfinite(value))
        throw ParameterError(fmt::format("{} of {} is {}", what, name, value),
          base ? "it must be a positive number, a multiple of that of " + table_.relativeTo
               : "it must be a positive number, in SI units");
      if (!plausible(value))
        throw ParameterError(fmt::format("{} of {} is {:g}, which is not between 1e-30 and 1e30", what, name, value),
          "no material has it; ratios are far below that, too");
      if (hasOwn(values, *key, name))
        continue;
      const bool multiple = base && name != table_.relativeTo && findPair(table_.relativeTo, names_) != key;
      if (!result.emplace(*key, multiple ? value * *base : value).second)
        throw ParameterError(fmt::format("{} of {} is given twice", what, pairText(*key, names_)),
          "give each pair of phases once: the order of its names does not matter");
    }
    return result;
  }

  /// Whether a pair is named by other words here, and elsewhere in the table by the phases' own: one table serves
  /// samples of both.
  [[nodiscard]] bool hasOwn(const auto& values, const PairKey& key, const std::string& name) const
  {
    return readPair(name, names_, true) != key &&
      std::any_of(
        values.begin(), values.end(), [&](const auto& entry) { return readPair(entry.first, names_, true) == key; });
  }

  template <class Has>
  [[nodiscard]] std::optional<PairKey> follow(PairKey key, const Has& has) const
  {
    for (std::size_t steps = 0; !has(key); ++steps)
    {
      const auto next = like_.find(key);
      if (next == like_.end())
        return std::nullopt;
      if (steps > like_.size())
        throw ParameterError(
          fmt::format("bonds of {} are like others that are like them in turn", pairText(key, names_)),
          "let the chain end at a pair that has a Young's modulus");
      key = next->second;
    }
    return key;
  }

  const PairTable& table_;
  std::span<const std::string> names_;
  std::map<PairKey, double> young_;
  std::array<std::map<PairKey, double>, 3> fracture_; ///< Gc, K, s₀
  std::map<PairKey, PairKey> like_;
};

BondMaterial mix(Mixing mixing, const BondMaterial& a, const BondMaterial& b, const Stencil& stencil, double spacing,
  const BondModel& model)
{
  const auto stretch = [&](const BondMaterial& m)
  { return bondConstants(m, stencil, spacing, model.continuum, model.micromodulus, "a phase").criticalStretch; };
  const double ea = a.youngsModulus;
  const double eb = b.youngsModulus;
  BondMaterial result;
  double s0 = 0;
  if (mixing == Mixing::Minimum)
  {
    result.youngsModulus = std::min(ea, eb);
    s0 = std::min(stretch(a), stretch(b));
  }
  else
  {
    result.youngsModulus = 2 / (1 / ea + 1 / eb);
    // of the bond's elongation s the half of a takes 2 s E_b/(E_a + E_b)
    s0 = std::min(stretch(a) * (ea + eb) / (2 * eb), stretch(b) * (ea + eb) / (2 * ea));
  }
  if (std::isfinite(s0))
    result.criticalStretch = s0;
  return result;
}

std::vector<std::uint8_t> findVoids(
  const PairTable& table, std::span<const std::string> names, const std::set<PairKey>& used)
{
  std::vector<std::uint8_t> voids;
  for (const std::string& name : table.voids)
    if (const auto id = findPhase(name, names))
      voids.push_back(*id);
  if (!table.voids.empty())
    return voids;
  for (std::size_t id = 0; id < names.size(); ++id)
    if (isVoidName(names[id]) &&
      std::none_of(used.begin(), used.end(), [&](const PairKey& k) { return k.first == id || k.second == id; }))
      voids.push_back(static_cast<std::uint8_t>(id));
  return voids;
}

using Table = PairTable::Values PairTable::*;
constexpr std::array<std::pair<const char*, Table>, 4> properties{ { { "young", &PairTable::young },
  { "fracture-energy", &PairTable::fractureEnergy }, { "toughness", &PairTable::toughness },
  { "critical-stretch", &PairTable::criticalStretch } } };

} // namespace

std::optional<PairKey> findPair(const std::string& text, std::span<const std::string> names)
{
  const auto own = readPair(text, names, true);
  return own ? own : readPair(text, names, false);
}

std::string pairText(const PairKey& key, std::span<const std::string> names)
{
  const auto name = [&](std::uint8_t id) { return id < names.size() ? names[id] : std::to_string(id); };
  return key.first == key.second && !key.betweenGrains ? name(key.first) : name(key.first) + "-" + name(key.second);
}

std::vector<std::string> PairTable::pairs() const
{
  std::vector<std::string> all;
  for (const Values* values : { &young, &fractureEnergy, &toughness, &criticalStretch })
    for (const auto& entry : *values)
      all.push_back(entry.first);
  for (const auto& [name, other] : like)
  {
    all.push_back(name);
    all.push_back(other);
  }
  if (!relativeTo.empty())
    all.push_back(relativeTo);
  return all;
}

void applyMaterials(const PairTable& table, std::span<const std::string> names, std::span<const std::int64_t> nodes,
  double spacing, BondModel& model)
{
  const Materials materials(table, names);
  const std::set<PairKey> keys = materials.keys();
  model.phaseNames.assign(names.begin(), names.end());
  model.voids = findVoids(table, names, keys);
  model.pairs.clear();
  model.pairByGrain = false;
  for (const PairKey& key : keys)
  {
    const auto material = materials.of(key);
    if (!material)
      throw ParameterError(fmt::format("bonds of {} are like others that have no material", pairText(key, names)),
        "let the chain end at a pair that has a Young's modulus");
    if (!key.betweenGrains)
      model.pairs[{ key.first, key.second }].material = *material;
  }
  const auto isVoid = [&](std::size_t id)
  { return std::find(model.voids.begin(), model.voids.end(), id) != model.voids.end(); };
  std::vector<std::uint8_t> solids;
  for (std::size_t id = 0; id < names.size(); ++id)
    if (!isVoid(id) && nodes[id] > 0)
      solids.push_back(static_cast<std::uint8_t>(id));
  for (const std::uint8_t id : solids)
    if (!model.pairs.contains({ id, id }))
      throw ParameterError(fmt::format("phase '{}' has no Young's modulus ({} nodes)", names[id], nodes[id]),
        fmt::format("give one to each phase that carries bonds, or call it void; the phases are {}", listed(names)));
  for (const PairKey& key : keys)
    if (key.betweenGrains && model.pairs.contains({ key.first, key.second }))
    {
      model.pairs[{ key.first, key.second }].betweenGrains = materials.of(key);
      model.pairByGrain = true;
    }
  if (table.mixing == Mixing::None)
    return;
  const Stencil stencil(model.continuum == Continuum::Space ? 3 : 2, model.horizon);
  for (const std::uint8_t a : solids)
    for (const std::uint8_t b : solids)
      if (a < b && !model.pairs.contains({ a, b }))
        model.pairs[{ a, b }].material =
          mix(table.mixing, model.pairs[{ a, a }].material, model.pairs[{ b, b }].material, stencil, spacing, model);
}

std::vector<PairData> describePairs(const BondModel& model, double spacing)
{
  const Stencil stencil(model.continuum == Continuum::Space ? 3 : 2, model.horizon);
  const double nu = poissonsRatio(model.continuum);
  const double constraint = model.continuum == Continuum::PlaneStress ? 1 : 1 - nu * nu;
  std::vector<PairData> all;
  const auto add = [&](const PairKey& key, const BondMaterial& material)
  {
    PairData data{ key, pairText(key, model.phaseNames), material.youngsModulus };
    data.criticalStretch =
      bondConstants(material, stencil, spacing, model.continuum, model.micromodulus, data.name).criticalStretch;
    // s₀ of a unit fracture energy tells the factor between Gc and s₀²
    BondMaterial unit;
    unit.youngsModulus = material.youngsModulus;
    unit.fractureEnergy = 1;
    const double s1 =
      bondConstants(unit, stencil, spacing, model.continuum, model.micromodulus, data.name).criticalStretch;
    data.fractureEnergy = data.criticalStretch * data.criticalStretch / (s1 * s1);
    data.toughness = std::sqrt(data.fractureEnergy * material.youngsModulus / constraint);
    all.push_back(data);
  };
  for (const auto& [ids, pair] : model.pairs)
  {
    add({ ids.first, ids.second, false }, pair.material);
    if (pair.betweenGrains)
      add({ ids.first, ids.second, true }, *pair.betweenGrains);
  }
  return all;
}

std::vector<PairNumber> pairNumbers(const PairTable& table, std::span<const std::string> names,
  std::span<const std::int64_t> nodes, double spacing, const BondModel& model)
{
  constexpr double step = 1e-4; // of the logarithm: what is left of its third derivative is 1e-9 of it
  std::vector<PairNumber> all;
  for (const auto& [property, values] : properties)
    for (const auto& [pair, value] : table.*values)
    {
      if (!findPair(pair, names))
        continue;
      const auto pairs = [&](double change)
      {
        PairTable other = table;
        (other.*values)[pair] = value * std::exp(change);
        BondModel changed = model;
        applyMaterials(other, names, nodes, spacing, changed);
        return describePairs(changed, spacing);
      };
      const std::vector<PairData> less = pairs(-step);
      const std::vector<PairData> more = pairs(step);
      PairNumber number{ property, pair, value, {}, {} };
      bool some = false;
      for (std::size_t i = 0; i < less.size(); ++i)
      {
        const auto slope = [](double low, double high)
        { return std::isfinite(low) && std::isfinite(high) ? std::log(high / low) / (2 * step) : 0; };
        number.young.push_back(slope(less[i].youngsModulus, more[i].youngsModulus));
        number.stretch.push_back(slope(less[i].criticalStretch, more[i].criticalStretch));
        some = some || number.young.back() != 0 || number.stretch.back() != 0;
      }
      if (some)
        all.push_back(std::move(number));
    }
  return all;
}

std::vector<int> pairGroups(std::span<const PairNumber> numbers)
{
  std::vector<int> groups(numbers.empty() ? 0 : numbers.front().young.size());
  for (std::size_t i = 0; i < groups.size(); ++i)
  {
    // `like` and relativeTo go through the same arithmetic: alike is equal to the last bit
    const auto alike = [&](std::size_t j)
    {
      return std::ranges::all_of(
        numbers, [&](const PairNumber& n) { return n.young[i] == n.young[j] && n.stretch[i] == n.stretch[j]; });
    };
    groups[i] = static_cast<int>(i);
    for (std::size_t j = 0; j < i && groups[i] == static_cast<int>(i); ++j)
      if (alike(j))
        groups[i] = groups[j];
  }
  return groups;
}

} // namespace lamella::peridynamics
