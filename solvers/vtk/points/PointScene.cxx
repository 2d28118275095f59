#include "PointScene.h"

#include "BondFields.h"
#include "BoxExchange.h"
#include "FieldNumbers.h"
#include "FractureData.h"

#include "core/Communicator.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/PhaseNames.h"
#include "peridynamics/PairTable.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella
{
namespace
{

constexpr std::array<const char*, 4> laws{ "isotropic", "orthotropic", "plastic", "orthotropic-plastic" };

/// Whether walls have an axis, and whether they yield.
bool hasAxis(WallLaw law)
{
  return law == WallLaw::Orthotropic || law == WallLaw::OrthotropicPlastic;
}
bool yields(WallLaw law)
{
  return law == WallLaw::Plastic || law == WallLaw::OrthotropicPlastic;
}

/// The constants that a law has.
bool belongs(WallConstant constant, WallLaw law)
{
  switch (constant)
  {
    case WallConstant::Transverse:
    case WallConstant::TransversePoisson:
    case WallConstant::Shear:
      return hasAxis(law);
    case WallConstant::Yield:
    case WallConstant::Hardening:
      return yields(law);
    case WallConstant::TransverseYield:
    case WallConstant::ShearYield:
      return law == WallLaw::OrthotropicPlastic;
    default:
      return true;
  }
}

const char* nameOf(WallConstant constant)
{
  return wallConstantNames[static_cast<std::size_t>(constant)];
}

constexpr std::array<bool, 3> notPeriodic{ false, false, false };

/// Directions along the wall at every node of a piece.
std::vector<std::array<float, 3>> directionsOf(const NodeVectors& vectors, const WholeImage& whole)
{
  vtkDataArray* const array = vectors.array;
  std::vector<std::array<float, 3>> directions(static_cast<std::size_t>(whole.held.count()));
  for (std::size_t i = 0; i < directions.size(); ++i)
  {
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      const double value = array->GetComponent(static_cast<vtkIdType>(i), c);
      if (!std::isfinite(value))
      {
        const Block& held = whole.held;
        const auto at = static_cast<std::int64_t>(i);
        throw InputError(
          fmt::format("array '{}' holds {} at node {}", vectors.name, value,
            whole.lattice.index(held.start[0] + at % held.size[0], held.start[1] + at / held.size[0] % held.size[1],
              held.start[2] + at / (held.size[0] * held.size[1]))),
          "directions are finite; 0, 0, 0 where there is none");
      }
      directions[i][static_cast<std::size_t>(c)] = static_cast<float>(value);
    }
  }
  return directions;
}

} // namespace

WallConstant wallConstant(const std::string& name)
{
  const auto found = std::find(wallConstantNames.begin(), wallConstantNames.end(), name);
  if (found == wallConstantNames.end())
  {
    throw ParameterError(
      "'" + name + "' is no constant of a wall", fmt::format("there are {}", fmt::join(wallConstantNames, ", ")));
  }
  return static_cast<WallConstant>(found - wallConstantNames.begin());
}

PointScene::PointScene(vtkImageData* piece, vtkInformation* phaseChoice, vtkInformation* axisChoice,
  const PointSettings& settings, const Team& team)
  : settings_(settings)
  , team_(team)
  , whole_(uprightImage(piece, team))
  , lattice_(whole_.lattice)
  , own_{ { 0, 0, 0 }, lattice_.size }
  , phases_(phaseIds(piece, phaseChoice, team))
{
  if (!(std::isfinite(settings.cellsPerNode) && settings.cellsPerNode > 0))
    throw ParameterError(fmt::format("{} cells of the grid a node", settings.cellsPerNode), "above 0; 1 is usual");
  const auto last = static_cast<std::size_t>(lattice_.dimension) - 1;
  const std::int64_t rows = lattice_.size[last];
  own_.start[last] = rows * team.rank() / team.size();
  own_.size[last] = rows * (team.rank() + 1) / team.size() - own_.start[last];
  const BoxExchange inward(lattice_, whole_.held, own_, notPeriodic, team.comm(), team.size());
  phase_.resize(static_cast<std::size_t>(own_.count()));
  inward.run<std::uint8_t>(phases_.ids, phase_);
  nodes_.assign(std::max<std::size_t>(phases_.values.size(), 1), 0);
  for (const std::uint8_t id : phase_)
    ++nodes_[id];
  team.sum(nodes_);
  findVoids();
  const bool named = axisChoice != nullptr && axisChoice->Has(vtkDataObject::FIELD_NAME());
  const char* const axes = named ? axisChoice->Get(vtkDataObject::FIELD_NAME()) : "axis";
  const bool directed = team.any(piece->GetPointData()->HasArray(axes) != 0);
  law_ = settings.law.value_or(directed ? WallLaw::Orthotropic : WallLaw::Isotropic);
  if (hasAxis(law_))
  {
    const NodeVectors vectors = vectorsOf(piece, axisChoice, "axis",
      "give the directions along the walls, as MicrographLattice does, take the isotropic law", lattice_.dimension,
      team);
    std::vector<std::array<float, 3>> held;
    team.agree([&] { held = directionsOf(vectors, whole_); });
    directions_.resize(phase_.size());
    inward.run<std::array<float, 3>>(held, directions_);
  }
  plane_ = settings.plane.value_or(yields(law_) ? mpm::PlaneState::Strain : mpm::PlaneState::Stress);
  if (lattice_.dimension == 3 && settings.plane)
    throw ParameterError("plane stress or plane strain of a volume", "leave it out: volumes are solved in space");
  if (yields(law_) && lattice_.dimension == 2 && plane_ == mpm::PlaneState::Stress)
    throw ParameterError("walls that yield in plane stress", "take plane strain, or a volume");
  checkConstants();
  shareOut();
  measureWalls();
}

void PointScene::findVoids()
{
  requireVoids(phases_, settings_.voids);
  for (const auto& [name, constants] : settings_.ofPhase)
  {
    requirePhase(phases_, name,
      fmt::format("'{}' is given for '{}', which is no phase of this image", nameOf(constants.begin()->first), name));
  }
  const std::vector<std::string>& names = phases_.names;
  void_.assign(nodes_.size(), false);
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    const bool told = std::any_of(settings_.voids.begin(), settings_.voids.end(),
      [&](const std::string& name) { return phaseMeant(names, name) == id; });
    void_[id] = settings_.voids.empty()
      ? isVoidName(names[id]) && entryOf(settings_.ofPhase, names, id) == settings_.ofPhase.end()
      : told;
    const auto given = entryOf(settings_.ofPhase, names, id);
    if (void_[id] && given != settings_.ofPhase.end())
    {
      throw ParameterError(fmt::format("'{}' is given for '{}', which is void and has no points",
                             nameOf(given->second.begin()->first), names[id]),
        "take the constant out, or the phase from the voids");
    }
  }
  bool some = false;
  for (std::size_t id = 0; id < names.size(); ++id)
    some = some || solid(id);
  if (!some)
  {
    throw InputError(fmt::format("all {} nodes are void: there is nothing to press", lattice_.count()),
      "look at the phases' names, and at which of them are void");
  }
  // one phase stands for all that is void: 256 of them at most, so where none is void one may have to be free
  const auto first = std::find(void_.begin(), void_.end(), true);
  empty_ = static_cast<std::uint8_t>(first != void_.end() ? first - void_.begin() : 255);
  if (first == void_.end() && nodes_.size() == 256 && nodes_[255] > 0)
    throw InputError("256 phases, and none of them void", "one at least has to be without nodes, or void");
  for (std::uint8_t& id : phase_)
    id = void_[id] ? empty_ : id;
  for (std::size_t id = 0; id < nodes_.size(); ++id)
    solidNodes_ += void_[id] ? 0 : nodes_[id];
}

std::int64_t PointScene::eachNode() const noexcept
{
  std::int64_t each = 1;
  for (int a = 0; a < lattice_.dimension; ++a)
    each *= settings_.perNode;
  return each;
}

void PointScene::shareOut()
{
  // layers that several pieces hold count for each of them
  std::vector<double> held(static_cast<std::size_t>(team_.size()));
  held[static_cast<std::size_t>(team_.rank())] = static_cast<double>(
    std::count_if(phases_.ids.begin(), phases_.ids.end(), [&](std::uint8_t id) { return !void_[id]; }));
  team_.sum(held);
  const double all = std::accumulate(held.begin(), held.end(), 0.0);
  double before = 0;
  for (const double share : held)
  {
    shares_.push_back(static_cast<std::int64_t>(std::round(static_cast<double>(pointCount()) * (before / all))));
    before += share;
  }
  shares_.push_back(pointCount());
}

void PointScene::measureWalls()
{
  const auto last = static_cast<std::size_t>(lattice_.dimension) - 1;
  std::vector<std::int32_t> least(phase_.size(), mpm::noRun);
  for (std::size_t a = 0; a < last; ++a)
    mpm::shortenRuns(own_.size, phase_, empty_, static_cast<int>(a), least);
  // runs along the last axis cross the ranks' rows: for these each rank takes a part of the lattice cut across x
  Block columns{ { 0, 0, 0 }, lattice_.size };
  columns.start[0] = lattice_.size[0] * team_.rank() / team_.size();
  columns.size[0] = lattice_.size[0] * (team_.rank() + 1) / team_.size() - columns.start[0];
  const BoxExchange across(lattice_, own_, columns, notPeriodic, team_.comm(), team_.size());
  std::vector<std::uint8_t> phases(static_cast<std::size_t>(columns.count()));
  across.run<std::uint8_t>(phase_, phases);
  std::vector<std::int32_t> runs(least.size());
  std::vector<std::int32_t> found(phases.size(), mpm::noRun);
  mpm::shortenRuns(columns.size, phases, empty_, static_cast<int>(last), found);
  const BoxExchange back(lattice_, columns, own_, notPeriodic, team_.comm(), team_.size());
  back.run<std::int32_t>(found, runs);
  std::vector<std::int64_t> nodes(
    static_cast<std::size_t>(*std::max_element(lattice_.size.begin(), lattice_.size.end())));
  for (std::size_t i = 0; i < least.size(); ++i)
    if (const std::int32_t run = std::min(least[i], runs[i]); run != mpm::noRun)
      ++nodes[static_cast<std::size_t>(run)];
  team_.sum(nodes);
  cells_ = mpm::wallCells(nodes, solidNodes_, lattice_.spacing / gridSpacing());
}

bool PointScene::solid(std::size_t id) const
{
  return nodes_[id] > 0 && !void_[id];
}

bool PointScene::held(std::size_t id, WallConstant constant) const
{
  if (id >= phases_.names.size())
    return false;
  const auto phase = entryOf(settings_.ofPhase, phases_.names, id);
  return phase != settings_.ofPhase.end() && phase->second.contains(constant);
}

double PointScene::value(std::size_t id, WallConstant constant) const
{
  const double v = held(id, constant) ? entryOf(settings_.ofPhase, phases_.names, id)->second.at(constant)
                                      : settings_.wall[static_cast<std::size_t>(constant)];
  return constant != WallConstant::Young || v != 0 || held(id, constant) ? v
    : hasAxis(law_)                                                      ? mpm::OrthotropicMaterial().along
                                                                         : mpm::IsotropicMaterial().youngsModulus;
}

void PointScene::checkConstants() const
{
  for (std::size_t id = 0; id < nodes_.size(); ++id)
  {
    for (std::size_t c = 0; c < wallConstants && solid(id); ++c)
    {
      const auto constant = static_cast<WallConstant>(c);
      if (held(id, constant) && !belongs(constant, law_))
      {
        throw ParameterError(fmt::format("'{}' of phase '{}' is no constant of the {} law", nameOf(constant),
                               phases_.names[id], laws[static_cast<std::size_t>(law_)]),
          "leave it out, or choose the law that has it");
      }
      const double v = value(id, constant);
      if (!std::isfinite(v) && !(constant == WallConstant::Yield && v > 0))
      {
        throw ParameterError(
          fmt::format("'{}' of phase '{}' is {}", nameOf(constant), phases_.names[id], v), "give a finite number");
      }
    }
  }
}

std::vector<std::string> PointScene::warnings() const
{
  std::vector<std::string> found;
  if (std::string thin = mpm::wallWarning(cells_); !thin.empty())
    found.push_back(std::move(thin));
  if (const double each = settings_.perNode / settings_.cellsPerNode; each < 2)
  {
    found.push_back(
      fmt::format("{:.3g} points along each axis of a cell: two want {} points a node; fewer are too soft, "
                  "and tear",
        each, static_cast<int>(std::ceil(2 * settings_.cellsPerNode))));
  }
  const mpm::OrthotropicMaterial own;
  const std::array<std::pair<WallConstant, double>, 5> across{ { { WallConstant::Transverse, own.across },
    { WallConstant::TransversePoisson, own.acrossRatio }, { WallConstant::Shear, 0 },
    { WallConstant::TransverseYield, 0 }, { WallConstant::ShearYield, 0 } } };
  for (const auto& [constant, usual] : across)
  {
    if (const double given = settings_.wall[static_cast<std::size_t>(constant)];
        !belongs(constant, law_) && given != usual)
    {
      found.push_back(fmt::format("'{}' ({:g}) is of no account: it is no constant of the {} law", nameOf(constant),
        given, laws[static_cast<std::size_t>(law_)]));
    }
  }
  return found;
}

int PointScene::axis(int chosen) const
{
  if (chosen >= lattice_.dimension)
    throw ParameterError("a load along z of a picture", "take x or y");
  return chosen < 0 ? lattice_.dimension - 1 : chosen;
}

std::array<std::array<double, 3>, 2> PointScene::box(const std::array<bool, 3>& fitted) const
{
  std::array<std::array<double, 3>, 2> ends{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
  {
    std::int64_t first = 0;
    std::int64_t last = lattice_.size[a] - 1;
    if (fitted[a])
    {
      std::swap(first, last);
      for (std::int64_t i = 0; i < own_.count(); ++i)
      {
        if (phase_[static_cast<std::size_t>(i)] != empty_)
        {
          const std::array<std::int64_t, 3> at{ i % own_.size[0], i / own_.size[0] % own_.size[1],
            i / (own_.size[0] * own_.size[1]) };
          first = std::min(first, own_.start[a] + at[a]);
          last = std::max(last, own_.start[a] + at[a]);
        }
      }
      std::array<std::int64_t, 2> found{ -first, last };
      team_.maximum(found);
      first = -found[0];
      last = found[1];
    }
    ends[0][a] = lattice_.origin[a] + lattice_.spacing * (static_cast<double>(first) - 0.5);
    ends[1][a] = lattice_.origin[a] + lattice_.spacing * (static_cast<double>(last) + 0.5);
  }
  return ends;
}

template <int Dim>
mpm::MaterialPoints<Dim> PointScene::points() const
{
  mpm::PointOptions options;
  options.perNode = settings_.perNode;
  options.empty = empty_;
  options.history = law_ == WallLaw::Plastic ? mpm::Hencky::history
    : law_ == WallLaw::OrthotropicPlastic    ? mpm::Hill::history
                                             : 0;
  options.density.clear();
  for (std::size_t id = 0; id < nodes_.size(); ++id)
    options.density.push_back(value(id, WallConstant::Density));
  const std::int64_t mine =
    eachNode() * (own_.count() - std::count(phase_.begin(), phase_.end(), empty_)); // points of own nodes
  const std::int64_t first = Communicator(team_.comm()).sumBefore(mine);
  mpm::MaterialPoints<Dim> points;
  team_.agree(
    [&]
    {
      // the points themselves, with C where they yield; sorting them anew takes a column, a solve and the grid about as
      // much again
      const int affine = options.history > 0 ? Dim * Dim : 0;
      const double bytes =
        static_cast<double>(mine) * (8.0 * (mpm::MaterialPoints<Dim>::histories + options.history + affine) + 5);
      if (const auto available = static_cast<double>(availableMemory()); 2 * bytes > available)
        throw MemoryError(fmt::format("material points and their grid need {} of memory at least, and {} are free",
                            bytesText(2 * bytes), bytesText(available)),
          "take a part of the image, or fewer points a node");
      std::vector<std::array<float, Dim>> axis(directions_.size());
      for (std::size_t i = 0; i < axis.size(); ++i)
        std::copy_n(directions_[i].begin(), Dim, axis[i].begin());
      points = mpm::pointsFromLattice<Dim>(lattice_, own_, phase_, axis, options, first);
    });
  return points;
}

template <int Dim>
std::shared_ptr<const mpm::PointLaw<Dim>> PointScene::law() const
{
  std::vector<std::array<double, mpm::Isotropic::constants>> isotropic;
  std::vector<std::array<double, mpm::Orthotropic::constants>> orthotropic;
  std::vector<std::array<double, mpm::Hencky::constants>> plastic;
  std::vector<std::array<double, mpm::Hill::constants>> both;
  std::size_t some = 0; // phase of points: those without points are like it
  while (!solid(some))
    ++some;
  for (std::size_t phase = 0; phase < nodes_.size(); ++phase)
  {
    const std::size_t id = solid(phase) ? phase : some;
    const auto of = [&](WallConstant constant) { return value(id, constant); };
    const std::string& name = phases_.names.at(id);
    const double young = of(WallConstant::Young);
    mpm::IsotropicMaterial wall;
    wall.youngsModulus = young;
    wall.poissonsRatio = of(WallConstant::Poisson);
    wall.barrier = of(WallConstant::Barrier);
    if (law_ == WallLaw::Isotropic)
    {
      isotropic.push_back(mpm::isotropicConstants<Dim>(wall, plane_, name));
    }
    else if (law_ == WallLaw::Plastic)
    {
      plastic.push_back(mpm::henckyConstants({ wall, of(WallConstant::Yield), of(WallConstant::Hardening) }, name));
    }
    else
    {
      mpm::OrthotropicMaterial m;
      m.along = young;
      m.across = of(WallConstant::Transverse);
      m.poissonsRatio = wall.poissonsRatio;
      m.acrossRatio = of(WallConstant::TransversePoisson);
      if (const double shear = of(WallConstant::Shear); shear != 0 || held(id, WallConstant::Shear))
        m.shearModulus = shear;
      m.barrier = wall.barrier;
      if (law_ == WallLaw::Orthotropic)
      {
        orthotropic.push_back(mpm::orthotropicConstants<Dim>(m, plane_, name));
        continue;
      }
      const auto given = [&](WallConstant constant) -> std::optional<double>
      {
        const double v = of(constant);
        return v != 0 || held(id, constant) ? std::optional(v) : std::nullopt;
      };
      both.push_back(mpm::hillConstants({ m, of(WallConstant::Yield), given(WallConstant::TransverseYield),
                                          given(WallConstant::ShearYield), of(WallConstant::Hardening) },
        name));
    }
  }
  switch (law_)
  {
    case WallLaw::Isotropic:
      return mpm::makeLaw<Dim, mpm::Isotropic>(isotropic, plane_);
    case WallLaw::Plastic:
      return mpm::makeLaw<Dim, mpm::Hencky>(plastic);
    case WallLaw::OrthotropicPlastic:
      return mpm::makeLaw<Dim, mpm::Hill>(both);
    default:
      return mpm::makeLaw<Dim, mpm::Orthotropic>(orthotropic, plane_);
  }
}

mpm::Bodies PointScene::bodies(const std::map<std::string, double>& frictions) const
{
  mpm::Bodies found;
  if (frictions.empty())
    return found;
  const std::vector<std::string>& names = phases_.names;
  std::map<std::pair<std::size_t, std::size_t>, double> apart;
  for (const auto& [name, value] : frictions)
  {
    const auto key = peridynamics::findPair(name, names);
    if (!key)
    {
      throw ParameterError(fmt::format("friction of '{}', which is no pair of phases", name),
        fmt::format("its phases are {}; write two of them as A-B", fmt::join(names, ", ")));
    }
    if (key->first == key->second)
    {
      throw ParameterError(fmt::format("friction of '{}' with itself", names[key->first]),
        "a phase is joined to itself; give a part of it another phase");
    }
    for (const std::size_t id : { key->first, key->second })
      if (!solid(id))
        throw ParameterError(fmt::format("friction of '{}', which has no points", names[id]), "leave the pair out");
    if (!(std::isfinite(value) && value >= 0))
      throw ParameterError(fmt::format("friction of '{}' is {}", name, value), "it is finite, 0 or above");
    if (!apart.emplace(std::pair<std::size_t, std::size_t>{ key->first, key->second }, value).second)
      throw ParameterError(fmt::format("friction of '{}' is given twice", name), "give each pair once");
  }
  // all that is not apart is joined
  constexpr std::uint8_t none = 255;
  found.ofPhase.assign(names.size(), none);
  found.count = 0;
  for (std::size_t seed = 0; seed < names.size(); ++seed)
  {
    if (!solid(seed) || found.ofPhase[seed] != none)
      continue;
    const auto body = static_cast<std::uint8_t>(found.count++);
    std::vector<std::size_t> joined{ seed };
    found.ofPhase[seed] = body;
    while (!joined.empty())
    {
      const std::size_t one = joined.back();
      joined.pop_back();
      for (std::size_t other = 0; other < names.size(); ++other)
        if (solid(other) && found.ofPhase[other] == none && !apart.contains(std::minmax({ one, other })))
        {
          found.ofPhase[other] = body;
          joined.push_back(other);
        }
    }
  }
  const auto count = static_cast<std::size_t>(found.count);
  found.friction.assign(count * count, -1);
  for (const auto& [pair, value] : apart)
  {
    const std::size_t a = found.ofPhase[pair.first];
    const std::size_t b = found.ofPhase[pair.second];
    const std::string text = fmt::format("{}-{}", names[pair.first], names[pair.second]);
    if (a == b)
    {
      throw ParameterError(fmt::format("friction of '{}', which are both joined to another phase", text),
        "give the friction of one of the two with that phase too");
    }
    double& friction = found.friction[a * count + b];
    if (friction >= 0 && friction != value)
    {
      throw ParameterError(
        fmt::format("friction of '{}' is {}, and {} between other phases of the same bodies", text, value, friction),
        "give joined phases the same friction");
    }
    friction = found.friction[b * count + a] = value;
  }
  for (std::size_t a = 0; a < count; ++a)
    found.friction[a * count + a] = 0;
  for (std::uint8_t& body : found.ofPhase)
    body = body == none ? 0 : body; // of voids
  return found;
}

nlohmann::json PointScene::describe(vtkDataObject* output) const
{
  nlohmann::json walls;
  std::vector<double> fractions;
  for (std::size_t id = 0; id < phases_.names.size(); ++id)
  {
    fractions.push_back(static_cast<double>(nodes_[id]) / static_cast<double>(lattice_.count()));
    for (std::size_t c = 0; c < wallConstants && solid(id); ++c)
    {
      const auto constant = static_cast<WallConstant>(c);
      const double v = value(id, constant);
      if (belongs(constant, law_) && !(v == 0 && constant == WallConstant::Shear))
        walls[phases_.names[id]][nameOf(constant)] = v;
    }
  }
  setFieldTexts(output, "phase_names", phases_.names);
  setFieldText(output, "phase_array", phases_.array);
  setFieldNumbers(output, "phase_fraction", fractions);
  setFieldText(output, "law", laws[static_cast<std::size_t>(law_)]);
  const char* const plane = lattice_.dimension == 3 ? "space"
    : plane_ == mpm::PlaneState::Stress             ? "plane-stress"
                                                    : "plane-strain";
  setFieldText(output, "plane", plane);
  setFieldNumber(output, "grid_spacing", gridSpacing());
  setFieldNumber(output, "points_per_node", settings_.perNode);
  setFieldNumber(output, "cells_across_walls", cells_.median);
  setFieldNumber(output, "thin_wall_share", cells_.thinShare);
  setLatticeNumbers(output, lattice_);
  nlohmann::json model{ { "law", laws[static_cast<std::size_t>(law_)] }, { "plane", plane }, { "walls", walls },
    { "void", settings_.voids }, { "points_per_node", settings_.perNode },
    { "cells_per_node", settings_.cellsPerNode } };
  setFieldText(output, "point_model", model.dump());
  return model;
}

template mpm::MaterialPoints<2> PointScene::points<2>() const;
template mpm::MaterialPoints<3> PointScene::points<3>() const;
template std::shared_ptr<const mpm::PointLaw<2>> PointScene::law<2>() const;
template std::shared_ptr<const mpm::PointLaw<3>> PointScene::law<3>() const;

} // namespace lamella
