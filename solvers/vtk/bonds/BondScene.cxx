#include "BondScene.h"

#include "BoxExchange.h"
#include "FieldNumbers.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "peridynamics/BondLattice.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd = lamella::peridynamics;
using nlohmann::json;

namespace lamella
{
namespace
{

constexpr std::array<const char*, 3> continua{ "plane-stress", "plane-strain", "space" };
constexpr std::array<const char*, 3> micromoduli{ "continuum", "lattice", "isotropic" };
constexpr std::array<const char*, 3> mixings{ "none", "harmonic", "minimum" };

template <class Words>
std::size_t wordOf(const Words& words, const std::string& text)
{
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), text) - words.begin());
}

/// Grain numbers of a piece.
std::vector<std::int32_t> grainsOf(vtkImageData* piece, vtkInformation* choice)
{
  const std::string name =
    choice != nullptr && choice->Has(vtkDataObject::FIELD_NAME()) ? choice->Get(vtkDataObject::FIELD_NAME()) : "grain";
  vtkDataArray* const array = piece->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
  {
    throw InputError(
      "bonds between grains have a material of their own, but the image has no point array '" + name + "'",
      "take those pairs (as grain-grain) out, or give the number of each node's grain, 0 for none");
  }
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("array '" + name + "' has " + std::to_string(array->GetNumberOfComponents()) +
        " components; grains are one whole number a node",
      "choose the array of grains");
  }
  std::vector<std::int32_t> grains(static_cast<std::size_t>(array->GetNumberOfTuples()));
  if (auto* const ints = vtkIntArray::SafeDownCast(array))
  {
    std::copy_n(ints->GetPointer(0), grains.size(), grains.begin());
    return grains;
  }
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  for (std::size_t i = 0; i < grains.size(); ++i)
  {
    const double value = array->GetComponent(static_cast<vtkIdType>(i), 0);
    if (!(std::abs(value) <= most) || value != std::floor(value))
    {
      throw InputError("array '" + name + "' holds " + std::to_string(value) + "; grains are whole numbers",
        "choose the array of grains");
    }
    grains[i] = static_cast<std::int32_t>(value);
  }
  return grains;
}

pd::BondModel modelFrom(const BondSettings& settings, int dimension)
{
  pd::BondModel model;
  model.continuum = settings.continuum.value_or(dimension == 3 ? pd::Continuum::Space : pd::Continuum::PlaneStress);
  if ((model.continuum == pd::Continuum::Space) != (dimension == 3))
  {
    throw ParameterError(dimension == 3 ? "plane stress or plane strain of a volume" : "space is asked of a picture",
      dimension == 3 ? "leave it out: volumes are solved in space" : "choose plane stress or plane strain");
  }
  model.horizon = settings.horizon;
  model.micromodulus =
    settings.micromodulus.value_or(dimension == 3 ? pd::Micromodulus::Isotropic : pd::Micromodulus::Continuum);
  model.voidBonds = settings.voidBonds;
  model.surfaceCorrection = settings.surfaceCorrection;
  model.notches = settings.notches;
  model.periodic = settings.periodic;
  return model;
}

} // namespace

json toJson(const BondSettings& s)
{
  json notches = json::array();
  for (const pd::Notch& n : s.notches)
    notches.push_back({ n.corner, n.along, n.across });
  return { { "young", s.materials.young }, { "fracture_energy", s.materials.fractureEnergy },
    { "toughness", s.materials.toughness }, { "critical_stretch", s.materials.criticalStretch },
    { "like", s.materials.like }, { "relative_to", s.materials.relativeTo },
    { "mixing", mixings[static_cast<std::size_t>(s.materials.mixing)] }, { "void", s.materials.voids },
    { "continuum", s.continuum ? continua[static_cast<std::size_t>(*s.continuum)] : "auto" }, { "horizon", s.horizon },
    { "micromodulus", s.micromodulus ? micromoduli[static_cast<std::size_t>(*s.micromodulus)] : "auto" },
    { "void_bonds", s.voidBonds == pd::VoidBonds::Cut ? "cut" : "keep" }, { "surface_correction", s.surfaceCorrection },
    { "large_strains", s.largeStrains }, { "notches", notches }, { "periodic", s.periodic } };
}

BondSettings bondSettingsFromJson(const std::string& text)
{
  try
  {
    const json j = json::parse(text);
    BondSettings s;
    j.at("young").get_to(s.materials.young);
    j.at("fracture_energy").get_to(s.materials.fractureEnergy);
    j.at("toughness").get_to(s.materials.toughness);
    j.at("critical_stretch").get_to(s.materials.criticalStretch);
    j.at("like").get_to(s.materials.like);
    j.at("relative_to").get_to(s.materials.relativeTo);
    s.materials.mixing = static_cast<pd::Mixing>(wordOf(mixings, j.at("mixing")) % mixings.size());
    j.at("void").get_to(s.materials.voids);
    if (const std::size_t c = wordOf(continua, j.at("continuum")); c < continua.size())
      s.continuum = static_cast<pd::Continuum>(c);
    j.at("horizon").get_to(s.horizon);
    if (const std::size_t m = wordOf(micromoduli, j.at("micromodulus")); m < micromoduli.size())
      s.micromodulus = static_cast<pd::Micromodulus>(m);
    s.voidBonds = j.at("void_bonds") == "cut" ? pd::VoidBonds::Cut : pd::VoidBonds::Keep;
    j.at("surface_correction").get_to(s.surfaceCorrection);
    j.at("large_strains").get_to(s.largeStrains);
    for (const json& n : j.at("notches"))
      s.notches.push_back({ n.at(0), n.at(1), n.at(2) });
    j.at("periodic").get_to(s.periodic);
    return s;
  }
  catch (const json::exception&)
  {
    throw InputError(std::string("the field text '") + bondModelName + "' is not what lamella wrote",
      "solve again, or switch ModelFromInput off and give the model");
  }
}

BondScene::BondScene(vtkImageData* piece, vtkInformation* phaseChoice, vtkInformation* grainChoice,
  const BondSettings& settings, const Team& team)
  : team_(team)
  , whole_(uprightImage(piece, team))
  , phases_(phaseIds(piece, phaseChoice, team))
{
  team.agree(
    [&]
    {
      const bool energies = !settings.materials.fractureEnergy.empty() || !settings.materials.toughness.empty();
      if (energies && fieldText(piece, "pixel_size_source") == "none")
        throw ParameterError(fmt::format("a {} needs the size of a pixel, which is not known",
                               settings.materials.toughness.empty() ? "fracture energy" : "toughness"),
          "give it where the picture is read: pixel size; or give critical stretches");
      requireVoids(phases_, settings.materials.voids);
      model_ = modelFrom(settings, lattice().dimension);
      slab_ = pd::slab(lattice(), pd::Stencil(lattice().dimension, model_.horizon), Communicator(team.comm()));
    });
  const BoxExchange inward(lattice(), whole_.held, slab_, { false, false, false }, team.comm(), team.size());
  phase_.resize(static_cast<std::size_t>(slab_.count()));
  inward.run<std::uint8_t>(phases_.ids, phase_);

  nodes_.assign(std::max<std::size_t>(phases_.values.size(), 1), 0);
  for (const std::uint8_t id : phase_)
    ++nodes_[id];
  team.sum(nodes_);
  std::vector<std::int32_t> held;
  team.agree(
    [&]
    {
      pd::applyMaterials(settings.materials, phases_.names, nodes_, lattice().spacing, model_);
      if (model_.pairByGrain && piece->GetNumberOfPoints() > 0)
        held = grainsOf(piece, grainChoice);
    });
  if (model_.pairByGrain)
  {
    grain_.resize(phase_.size());
    inward.run<std::int32_t>(held, grain_);
  }
}

BondScene::Whole BondScene::whole() const
{
  const BoxExchange outward(
    lattice(), slab_, Block{ { 0, 0, 0 }, lattice().size }, { false, false, false }, team_.comm(), team_.size());
  Whole w;
  w.phase.resize(static_cast<std::size_t>(lattice().count()));
  outward.run<std::uint8_t>(phase_, w.phase);
  if (model_.pairByGrain)
  {
    w.grain.resize(w.phase.size());
    outward.run<std::int32_t>(grain_, w.grain);
  }
  return w;
}

std::vector<std::string> unitDoubts(const pd::PairTable& materials)
{
  constexpr double least = 1e3; // Pa √m, far below glue (1e5); gels lie here
  std::vector<std::string> doubts;
  for (const auto& [pair, value] : materials.toughness)
  {
    if (materials.relativeTo.empty() && value < least)
    {
      doubts.push_back(fmt::format(
        "the toughness of {0} is {1:g} Pa √m: glass has 7e5, wood 1e5 to 1e6; was {1:g} MPa √m meant?", pair, value));
    }
  }
  return doubts;
}

bool BondScene::isVoid(std::size_t node) const
{
  return std::find(model_.voids.begin(), model_.voids.end(), phase_[node]) != model_.voids.end();
}

vtkSmartPointer<vtkDoubleArray> BondScene::toPiece(
  const pd::NodeField<double>& field, std::span<const int> from, const char* name, double inVoids) const
{
  const pd::NodeLayout& l = field.layout();
  const std::size_t components = from.size();
  const auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(components));
  array->SetNumberOfTuples(whole_.held.count());
  const std::span<double> piece(array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()));
  const BoxExchange outward(lattice(), slab_, whole_.held, { false, false, false }, team_.comm(), team_.size());
  std::vector<double> moved(outward.identity() ? 0 : static_cast<std::size_t>(slab_.count()) * components);
  const std::span<double> own = outward.identity() ? piece : std::span<double>(moved);
  std::size_t at = 0;
  std::size_t node = 0;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < l.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < l.size[0]; ++x, ++node)
      {
        const bool skip = isVoid(node);
        for (const int c : from)
          own[at++] = skip ? inVoids : c >= 0 ? field.at(c, x, y, z) : 0;
      }
    }
  }
  if (!outward.identity())
    outward.run<double>(own, piece, static_cast<int>(components));
  return array;
}

void BondScene::toSlab(vtkDataArray* array, const std::string& name, pd::NodeField<double>& field) const
{
  const pd::NodeLayout& l = field.layout();
  const int components = field.components();
  const auto count = static_cast<std::size_t>(components);
  std::vector<double> held(static_cast<std::size_t>(whole_.held.count()) * count);
  for (std::size_t i = 0; i < held.size(); ++i)
    held[i] = array->GetComponent(static_cast<vtkIdType>(i / count), static_cast<int>(i % count));
  std::vector<double> own(static_cast<std::size_t>(slab_.count()) * count);
  BoxExchange(lattice(), whole_.held, slab_, { false, false, false }, team_.comm(), team_.size())
    .run<double>(held, own, components);
  team_.agree(
    [&]
    {
      std::size_t node = 0;
      for (std::int64_t z = 0; z < l.size[2]; ++z)
      {
        for (std::int64_t y = 0; y < l.size[1]; ++y)
        {
          for (std::int64_t x = 0; x < l.size[0]; ++x, ++node)
          {
            const bool skip = isVoid(node);
            for (int c = 0; c < components; ++c)
            {
              const double value = own[node * count + static_cast<std::size_t>(c)];
              if (!skip && !std::isfinite(value))
              {
                throw InputError("array '" + name + "' holds a value that is not finite at node " +
                    std::to_string(x + slab_.start[0]) + ", " + std::to_string(y + slab_.start[1]) + ", " +
                    std::to_string(z + slab_.start[2]),
                  "look at how it was made");
              }
              field.at(c, x, y, z) = skip ? 0 : value;
            }
          }
        }
      }
    });
}

vtkSmartPointer<vtkDoubleArray> stressArray(
  const BondScene& scene, const pd::NodeField<double>& stress, const char* creator)
{
  constexpr std::array<int, 6> flat{ 0, 1, -1, 2, -1, -1 };
  constexpr std::array<int, 6> full{ 0, 1, 2, 3, 4, 5 };
  const auto array = scene.toPiece(stress, stress.components() == 3 ? flat : full, "stress");
  if (scene.model().continuum == pd::Continuum::PlaneStrain)
  {
    const double nu = pd::poissonsRatio(pd::Continuum::PlaneStrain);
    double* s = array->GetPointer(0);
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i, s += 6)
      s[2] = nu * (s[0] + s[1]);
  }
  constexpr std::array<const char*, 6> names{ "XX", "YY", "ZZ", "XY", "YZ", "XZ" };
  for (int c = 0; c < 6; ++c)
    array->SetComponentName(c, names[static_cast<std::size_t>(c)]);
  describe(array, "Pa", "stress of the node from its bonds, tension positive; 0 in voids", creator);
  return array;
}

json describeModel(vtkImageData* output, const BondScene& scene, const BondSettings& settings)
{
  const pd::BondModel& model = scene.model();
  std::vector<std::string> names;
  std::array<std::vector<double>, 4> values;
  for (const pd::PairData& pair : pd::describePairs(model, scene.lattice().spacing))
  {
    names.push_back(pair.name);
    values[0].push_back(pair.youngsModulus);
    values[1].push_back(pair.criticalStretch);
    values[2].push_back(pair.fractureEnergy);
    values[3].push_back(pair.toughness);
  }
  setFieldTexts(output, "pair_names", names);
  setFieldNumbers(output, "pair_youngs_modulus", values[0]);
  setFieldNumbers(output, "pair_critical_stretch", values[1]);
  setFieldNumbers(output, "pair_fracture_energy", values[2]);
  setFieldNumbers(output, "pair_toughness", values[3]);
  setFieldText(output, "continuum", continua[static_cast<std::size_t>(model.continuum)]);
  setFieldNumber(output, "horizon", model.horizon);
  setFieldNumber(output, "poissons_ratio", pd::poissonsRatio(model.continuum));
  std::vector<double> fractions(scene.nodes().begin(), scene.nodes().end());
  for (double& fraction : fractions)
    fraction /= static_cast<double>(scene.lattice().count());
  setFieldNumbers(output, "phase_fraction", fractions);
  setFieldTexts(output, "phase_names", scene.phases().names);
  setFieldText(output, "phase_array", scene.phases().array);
  BondSettings resolved = settings;
  resolved.micromodulus = model.micromodulus;
  json text = toJson(resolved);
  setFieldText(output, bondModelName, text.dump());
  return text;
}

void describeThickness(vtkImageData* output, const BondScene& scene, std::span<const pd::PhaseThickness> thickness)
{
  std::vector<std::string> names;
  std::vector<double> median;
  std::vector<double> thin;
  for (const pd::PhaseThickness& t : thickness)
  {
    names.push_back(scene.phases().names.at(t.phase));
    median.push_back(t.median);
    thin.push_back(t.thinShare);
  }
  setFieldTexts(output, "thickness_phases", names);
  setFieldNumbers(output, "thickness_median", median);
  setFieldNumbers(output, "thickness_thin_share", thin);
}

} // namespace lamella
