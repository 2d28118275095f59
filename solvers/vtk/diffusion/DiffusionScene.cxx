#include "DiffusionScene.h"

#include "WallConductivity.h"
#include "vtkDiffusionAlgorithm.h"

#include "core/Error.h"

namespace lamella
{
namespace
{

Block blockOf(const Lattice& lattice, const Team& team)
{
  Block block{ { 0, 0, 0 }, lattice.size };
  if (team.size() > 1)
    team.agree([&] { block = decompose(lattice, team.comm()); });
  return block;
}

} // namespace

DiffusionScene::DiffusionScene(vtkImageData* input, vtkInformation* choice, int direction, const Team& team,
  bool gathered, Voxels voxels, const std::optional<GreyBins>& levels)
  : whole(uprightImage(input, team, voxels))
  , phases(phaseIds(input, choice, team, levels))
  , nodes(phases.values.size(), 0)
{
  if (direction == 2 && whole.lattice.dimension == 2)
    throw ParameterError("direction z of a two-dimensional image", "choose x or y");
  if (gathered)
  {
    image = gatherPhases(whole.lattice, whole.held, phases, team);
    for (const std::uint8_t id : image.phase)
      ++nodes[id];
    return;
  }
  block = blockOf(whole.lattice, team);
  outward.emplace(whole.lattice, block, whole.held, std::array{ false, false, false }, team.comm(), team.size());
  ids = phases.ids;
  const BoxExchange inward(whole.lattice, whole.held, block, { false, false, false }, team.comm(), team.size());
  if (!inward.identity())
  {
    moved_.resize(static_cast<std::size_t>(block.count()));
    inward.run<std::uint8_t>(phases.ids, moved_);
    ids = moved_;
  }
  for (const std::uint8_t id : ids)
    ++nodes[id];
  team.sum(nodes);
}

lbm::Stencil DiffusionScene::stencil(int choice) const noexcept
{
  if (choice == vtkDiffusionAlgorithm::AUTO_LATTICE)
    return whole.lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
  static_assert(vtkDiffusionAlgorithm::Q1 - vtkDiffusionAlgorithm::D2Q5 == static_cast<int>(lbm::Stencil::Q1));
  return static_cast<lbm::Stencil>(choice - vtkDiffusionAlgorithm::D2Q5);
}

} // namespace lamella
