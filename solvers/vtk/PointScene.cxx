#include "PointScene.h"

#include "BondFields.h"
#include "FieldNumbers.h"
#include "FractureData.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "lattice/VoidNames.h"
#include "mpm/WallCells.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella
{
namespace
{

constexpr std::array<const char*, 3> laws{ "isotropic", "orthotropic", "plastic" };

/// The constants that a law has.
bool belongs(WallConstant constant, WallLaw law)
{
  switch (constant)
  {
    case WallConstant::Transverse:
    case WallConstant::TransversePoisson:
    case WallConstant::Shear:
      return law == WallLaw::Orthotropic;
    case WallConstant::Yield:
    case WallConstant::Hardening:
      return law == WallLaw::Plastic;
    default:
      return true;
  }
}

const char* nameOf(WallConstant constant)
{
  return wallConstantNames[static_cast<std::size_t>(constant)];
}

/// Directions along the wall at every node.
std::vector<std::array<float, 3>> directionsOf(const NodeVectors& vectors)
{
  vtkDataArray* const array = vectors.array;
  std::vector<std::array<float, 3>> directions(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < directions.size(); ++i)
  {
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      const double value = array->GetComponent(static_cast<vtkIdType>(i), c);
      if (!std::isfinite(value))
      {
        throw InputError(fmt::format("array '{}' holds {} at node {}", vectors.name, value, i),
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

PointScene::PointScene(vtkImageData* image, vtkInformation* phaseChoice, vtkInformation* axisChoice,
  const PointSettings& settings, const Team& alone)
  : settings_(settings)
  , lattice_(wholeImage(image, alone).lattice)
  , phases_(phaseIds(image, phaseChoice, alone))
{
  if (!(std::isfinite(settings.cellsPerNode) && settings.cellsPerNode > 0))
  {
    throw ParameterError(fmt::format("{} cells of the grid a node", settings.cellsPerNode), "above 0; 1 is usual");
  }
  nodes_.assign(std::max<std::size_t>(phases_.values.size(), 1), 0);
  for (const std::uint8_t id : phases_.ids)
  {
    ++nodes_[id];
  }
  findVoids();
  const bool named = axisChoice != nullptr && axisChoice->Has(vtkDataObject::FIELD_NAME());
  const char* const axes = named ? axisChoice->Get(vtkDataObject::FIELD_NAME()) : "axis";
  const bool directed = image->GetPointData()->HasArray(axes) != 0;
  law_ = settings.law.value_or(directed ? WallLaw::Orthotropic : WallLaw::Isotropic);
  if (law_ == WallLaw::Orthotropic)
  {
    directions_ = directionsOf(vectorsOf(image, axisChoice, "axis",
      "give the directions along the walls, as MicrographLattice does, take the isotropic law", lattice_.dimension,
      alone));
  }
  const bool yields = law_ == WallLaw::Plastic;
  plane_ = settings.plane.value_or(yields ? mpm::PlaneState::Strain : mpm::PlaneState::Stress);
  if (lattice_.dimension == 3 && settings.plane)
  {
    throw ParameterError("plane stress or plane strain of a volume", "leave it out: volumes are solved in space");
  }
  if (yields && lattice_.dimension == 2 && plane_ == mpm::PlaneState::Stress)
  {
    throw ParameterError("walls that yield in plane stress", "take plane strain, or a volume");
  }
  checkConstants();
}

void PointScene::findVoids()
{
  const std::vector<std::string>& names = phases_.names;
  void_.assign(nodes_.size(), false);
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    const bool told = std::find(settings_.voids.begin(), settings_.voids.end(), names[id]) != settings_.voids.end();
    void_[id] = settings_.voids.empty() ? isVoidName(names[id]) && !settings_.ofPhase.contains(names[id]) : told;
  }
  bool some = false;
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    some = some || solid(id);
  }
  if (!some)
  {
    throw InputError(fmt::format("all {} nodes are void: there is nothing to press", lattice_.count()),
      "look at the phases' names, and at which of them are void");
  }
  // one phase stands for all that is void: 256 of them at most, so where none is void one may have to be free
  const auto first = std::find(void_.begin(), void_.end(), true);
  empty_ = static_cast<std::uint8_t>(first != void_.end() ? first - void_.begin() : 255);
  if (first == void_.end() && nodes_.size() == 256 && nodes_[255] > 0)
  {
    throw InputError("256 phases, and none of them void", "one at least has to be without nodes, or void");
  }
  phase_.assign(phases_.ids.begin(), phases_.ids.end());
  for (std::uint8_t& id : phase_)
  {
    id = void_[id] ? empty_ : id;
  }
}

bool PointScene::solid(std::size_t id) const
{
  return nodes_[id] > 0 && !void_[id];
}

bool PointScene::held(std::size_t id, WallConstant constant) const
{
  const auto phase = settings_.ofPhase.find(id < phases_.names.size() ? phases_.names[id] : "");
  return phase != settings_.ofPhase.end() && phase->second.contains(constant);
}

double PointScene::value(std::size_t id, WallConstant constant) const
{
  const double v = held(id, constant) ? settings_.ofPhase.at(phases_.names[id]).at(constant)
                                      : settings_.wall[static_cast<std::size_t>(constant)];
  return constant != WallConstant::Young || v != 0 ? v
    : law_ == WallLaw::Orthotropic                 ? mpm::OrthotropicMaterial().along
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

int PointScene::axis(int chosen) const
{
  if (chosen >= lattice_.dimension)
  {
    throw ParameterError("a load along z of a picture", "take x or y");
  }
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
      for (std::int64_t i = 0; i < lattice_.count(); ++i)
      {
        if (phase_[static_cast<std::size_t>(i)] != empty_)
        {
          const std::array<std::int64_t, 3> at{ i % lattice_.size[0], i / lattice_.size[0] % lattice_.size[1],
            i / (lattice_.size[0] * lattice_.size[1]) };
          first = std::min(first, at[a]);
          last = std::max(last, at[a]);
        }
      }
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
  options.history = law_ == WallLaw::Plastic ? mpm::Hencky::history : 0;
  options.density.clear();
  std::int64_t solid = 0;
  for (std::size_t id = 0; id < nodes_.size(); ++id)
  {
    options.density.push_back(value(id, WallConstant::Density));
    solid += void_[id] ? 0 : nodes_[id];
  }
  // the points themselves; sorting them anew takes a column, a solve and the grid about as much again
  const double bytes = static_cast<double>(solid) * std::pow(std::max(options.perNode, 1), Dim) *
    (8.0 * (mpm::MaterialPoints<Dim>::histories + options.history) + 5);
  if (const auto available = static_cast<double>(availableMemory()); 2 * bytes > available)
  {
    throw MemoryError(fmt::format("material points and their grid need {} of memory at least, and {} are free",
                        bytesText(2 * bytes), bytesText(available)),
      "take a part of the image, or fewer points a node");
  }
  std::vector<std::array<float, Dim>> axis(directions_.size());
  for (std::size_t i = 0; i < axis.size(); ++i)
  {
    std::copy_n(directions_[i].begin(), Dim, axis[i].begin());
  }
  return mpm::pointsFromLattice<Dim>(lattice_, phase_, axis, options);
}

template <int Dim>
std::shared_ptr<const mpm::PointLaw<Dim>> PointScene::law() const
{
  std::vector<std::array<double, mpm::Isotropic::constants>> isotropic;
  std::vector<std::array<double, mpm::Orthotropic::constants>> orthotropic;
  std::vector<std::array<double, mpm::Hencky::constants>> plastic;
  std::size_t some = 0; // phase of points: those without points are like it
  while (!solid(some))
  {
    ++some;
  }
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
      if (const double shear = of(WallConstant::Shear); shear != 0)
      {
        m.shearModulus = shear;
      }
      m.barrier = wall.barrier;
      orthotropic.push_back(mpm::orthotropicConstants<Dim>(m, plane_, name));
    }
  }
  return law_ == WallLaw::Isotropic ? mpm::makeLaw<Dim, mpm::Isotropic>(isotropic)
    : law_ == WallLaw::Plastic      ? mpm::makeLaw<Dim, mpm::Hencky>(plastic)
                                    : mpm::makeLaw<Dim, mpm::Orthotropic>(orthotropic);
}

std::string PointScene::wallWarning() const
{
  return mpm::wallWarning(mpm::wallCells(lattice_, phase_, empty_, gridSpacing()));
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
      {
        walls[phases_.names[id]][nameOf(constant)] = v;
      }
    }
  }
  const mpm::WallCells cells = mpm::wallCells(lattice_, phase_, empty_, gridSpacing());
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
  setFieldNumber(output, "cells_across_walls", cells.median);
  setFieldNumber(output, "thin_wall_share", cells.thinShare);
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
