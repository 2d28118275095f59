#include "CrackSample.h"

#include "BoxExchange.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/Fragments.h"
#include "pores/PoreLabelling.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pd = lamella::peridynamics;

namespace lamella
{
namespace
{

/// A model by which all solid nodes within the horizon are joined.
BondSettings plainModel(const std::vector<std::string>& names, double horizon)
{
  BondSettings settings;
  settings.horizon = horizon;
  settings.materials.mixing = pd::Mixing::Minimum;
  for (const std::string& name : names)
    if (name != "0" && !pores::voidPhase(std::span(&name, 1)))
      settings.materials.young[name] = 1;
  return settings;
}

/// @throws InputError
void requireSameLattice(const Lattice& image, const Lattice& bonds)
{
  bool same = image.size == bonds.size && std::abs(image.spacing / bonds.spacing - 1) < 1e-4;
  for (std::size_t a = 0; same && a < static_cast<std::size_t>(bonds.dimension); ++a)
    same = std::abs(image.origin[a] - bonds.origin[a]) < 0.05 * bonds.spacing;
  if (!same)
  {
    const auto text = [](const Lattice& l)
    {
      return std::to_string(l.size[0]) + " by " + std::to_string(l.size[1]) + " by " + std::to_string(l.size[2]) +
        " nodes";
    };
    throw InputError("the image (" + text(image) + ") is not on the lattice of the broken bonds (" + text(bonds) + ")",
      "give the image that was broken, or the one that lamella fracture wrote with the bonds");
  }
}

Block whole(const Lattice& lattice)
{
  return { { 0, 0, 0 }, lattice.size };
}

} // namespace

std::int64_t CrackFragments::nodes() const
{
  return std::accumulate(
    list.begin(), list.end(), std::int64_t{ 0 },
    [](std::int64_t sum, const CrackFragment& f) { return sum + f.nodes; });
}

CrackSample::CrackSample(
  vtkImageData* piece, vtkInformation* phase, vtkInformation* grain, const CrackInput& input, const Team& team)
  : piece_(piece)
  , input_(input)
  , team_(team)
  , whole_(uprightImage(piece, team))
{
  team.agree([&] { requireSameLattice(whole_.lattice, input.lattice); });
  const std::string model =
    team.share(fieldText(piece, bondModelName).value_or(""), fieldText(piece, bondModelName).has_value());
  BondSettings settings;
  if (model.empty())
  {
    const PhaseIds ids = phaseIds(piece, phase, team);
    settings = plainModel(ids.names, input.horizon);
  }
  else
  {
    settings = bondSettingsFromJson(model);
    settings.surfaceCorrection = false;
    settings.horizon = input.horizon;
  }
  scene_.emplace(piece, phase, grain, settings, team);
}

std::vector<std::uint8_t> CrackSample::phases() const
{
  std::vector<std::uint8_t> all(static_cast<std::size_t>(whole_.lattice.count()));
  BoxExchange(whole_.lattice, whole_.held, whole(whole_.lattice), { false, false, false }, team_.comm(), team_.size())
    .run<std::uint8_t>(scene_->phases().ids, all);
  return all;
}

std::vector<std::uint8_t> CrackSample::solid(const std::vector<std::uint8_t>& phases) const
{
  std::array<std::uint8_t, 256> is{};
  is.fill(1);
  for (const std::uint8_t v : scene_->model().voids)
    is[v] = 0;
  std::vector<std::uint8_t> all(phases.size());
  std::transform(phases.begin(), phases.end(), all.begin(), [&](std::uint8_t id) { return is[id]; });
  return all;
}

std::vector<double> CrackSample::displacement(const std::string& name) const
{
  vtkDataArray* const array = piece_->GetPointData()->GetArray(name.c_str());
  if (!team_.any(array != nullptr))
    return {};
  std::vector<double> held(static_cast<std::size_t>(3 * whole_.held.count()), 0);
  team_.agree(
    [&]
    {
      if (array == nullptr)
        return;
      const int components = array->GetNumberOfComponents();
      if (components < whole_.lattice.dimension || components > 3)
        throw InputError("array '" + name + "' has " + std::to_string(components) + " components; displacements have " +
            (whole_.lattice.dimension == 2 ? "2 or 3" : "3"),
          "choose the array of displacements");
      for (std::size_t i = 0; i < held.size(); ++i)
      {
        if (const auto c = static_cast<int>(i % 3); c < components)
        {
          const double value = array->GetComponent(static_cast<vtkIdType>(i / 3), c);
          held[i] = std::isfinite(value) ? value : 0; // in voids
        }
      }
    });
  std::vector<double> all(static_cast<std::size_t>(3 * whole_.lattice.count()));
  BoxExchange(whole_.lattice, whole_.held, whole(whole_.lattice), { false, false, false }, team_.comm(), team_.size())
    .run<double>(held, all, 3);
  return all;
}

CrackFragments CrackSample::fragments() const
{
  const Communicator comm(team_.comm());
  pd::BondLattice bonds(scene_->model(), whole_.lattice, scene_->phase(), scene_->grain(), comm);
  std::vector<pd::Bond> broken;
  const auto& half = bonds.stencil().half();
  if (team_.rank() == 0) // every bond once
  {
    for (const cracks::CutBond& b : input_.bonds)
    {
      const auto at =
        std::find_if(half.begin(), half.end(), [&](const pd::Offset& o) { return o.step == b.step; }) - half.begin();
      pd::Bond bond{ b.node, static_cast<int>(at) };
      bool inside = at < static_cast<std::ptrdiff_t>(half.size());
      for (std::size_t a = 0; a < 3; ++a)
      {
        const std::int64_t n = whole_.lattice.size[a];
        bond.node[a] = bonds.periodic()[a] ? (bond.node[a] % n + n) % n : bond.node[a];
        inside = inside && bond.node[a] >= 0 && bond.node[a] < n;
      }
      if (inside)
        broken.push_back(bond);
    }
  }
  bonds.breakBonds(broken);
  const pd::Fragments found = pd::findFragments(bonds);

  // the largest first
  const std::size_t count = found.pieces.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return found.pieces[a].nodes > found.pieces[b].nodes; });
  std::vector<int> number(count);
  CrackFragments result;
  for (std::size_t k = 0; k < count; ++k)
  {
    number[order[k]] = static_cast<int>(k) + 1;
    result.list.push_back({ found.pieces[order[k]].nodes, {} });
  }
  const pd::NodeLayout& l = bonds.layout();
  pd::NodeField<double> labels(l, 1); // exact in it
  std::vector<std::int64_t> touches(6 * count, 0);
  for (std::int64_t z = 0; z < l.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < l.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::int32_t piece = found.piece[l.index(x, y, z)];
        if (piece < 0)
          continue;
        const auto label = static_cast<std::size_t>(number[static_cast<std::size_t>(piece)]);
        labels.at(0, x, y, z) = static_cast<double>(label);
        const std::array<std::int64_t, 3> node{ x + l.start[0], y + l.start[1], z + l.start[2] };
        for (std::size_t a = 0; a < 3; ++a)
        {
          touches[6 * (label - 1) + 2 * a] |= node[a] == 0 ? 1 : 0;
          touches[6 * (label - 1) + 2 * a + 1] |= node[a] == l.global[a] - 1 ? 1 : 0;
        }
      }
    }
  }
  team_.maximum(touches);
  for (std::size_t a = 0; a < static_cast<std::size_t>(whole_.lattice.dimension); ++a)
  {
    result.severed[a] = true;
    for (std::size_t f = 0; f < count; ++f)
    {
      result.list[f].touches[a] = { touches[6 * f + 2 * a] != 0, touches[6 * f + 2 * a + 1] != 0 };
      result.severed[a] = result.severed[a] && !(result.list[f].touches[a][0] && result.list[f].touches[a][1]);
    }
  }
  const auto piece = scene_->toPiece(labels, std::array<int, 1>{ 0 }, "fragment");
  for (vtkIdType i = 0; i < piece->GetNumberOfTuples(); ++i)
    result.ofPiece.push_back(static_cast<std::int32_t>(piece->GetValue(i)));
  return result;
}

} // namespace lamella
