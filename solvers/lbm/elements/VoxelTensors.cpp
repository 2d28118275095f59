#include "lbm/elements/VoxelTensors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr std::array<std::array<std::size_t, 2>, 6> axes{ { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 },
  { 1, 2 } } };

} // namespace

bool hasDirections(const Problem& problem)
{
  const DirectedDiffusivity* const directed = problem.options.directed.get();
  return directed != nullptr && directed->hasAxes();
}

bool hasOwnTensors(const Problem& problem)
{
  const DirectedDiffusivity* const directed = problem.options.directed.get();
  return directed != nullptr &&
    std::ranges::find(directed->source, DirectedDiffusivity::Source::Node) != directed->source.end();
}

VoxelTensors::VoxelTensors(const Problem& problem, double scale, const ElementShare& share, const Block& block,
  std::span<const std::uint8_t> phase, std::vector<std::array<float, 3>>&& axis,
  std::vector<SymmetricTensor<float>>&& own)
  : nx_(block.size[0])
  , phase_(phase)
  , axis_(std::move(axis))
  , own_(std::move(own))
{
  using Source = DirectedDiffusivity::Source;
  const std::array<std::int64_t, 3> strides = share.turned(std::array<std::int64_t, 3>{ 1, nx_, nx_ * block.size[1] });
  strideY_ = strides[1];
  strideZ_ = strides[2];
  const bool volume = problem.lattice.dimension == 3;
  // of the lattice's axes to those of the elements
  const auto turned = [&](const auto& tensor)
  {
    std::array<float, 6> result{};
    for (std::size_t c = 0; c < 6; ++c)
    {
      const auto a = static_cast<std::size_t>(share.order()[axes[c][0]]);
      const auto b = static_cast<std::size_t>(share.order()[axes[c][1]]);
      // across a picture nothing flows: what it conducts there only has to be positive
      result[c] = volume || (a != 2 && b != 2) ? static_cast<float>(tensor[tensorPlace(a, b)] / scale)
        : a == b                               ? static_cast<float>(0.5 * (tensor[0] + tensor[1]) / scale)
                                               : 0.0F;
    }
    return result;
  };
  const DirectedDiffusivity* const directed = problem.options.directed.get();
  for (std::size_t id = 0; id < problem.diffusivity.size(); ++id)
  {
    along_.push_back(static_cast<float>((directed ? directed->along[id] : problem.diffusivity[id]) / scale));
    across_.push_back(static_cast<float>((directed ? directed->across[id] : problem.diffusivity[id]) / scale));
    const Source source = directed ? directed->sourceOf(id) : Source::Axial;
    general_.push_back(source == Source::Axial ? 0 : source == Source::Phase ? 1 : 2);
    base_.push_back(source == Source::Phase ? turned(directed->ofPhase[id])
                                            : std::array<float, 6>{ across_[id], across_[id], across_[id], 0, 0, 0 });
  }
  const std::array<double, 3> aspect = share.turned(problem.lattice.aspect);
  for (std::size_t c = 0; c < 6; ++c)
    factor_[c] = static_cast<float>(aspect[0] * aspect[0] / (aspect[axes[c][0]] * aspect[axes[c][1]]));
  for (std::array<float, 3>& a : axis_)
  {
    if (!volume)
      a[2] = 0;
    const double length = std::hypot(a[0], a[1], a[2]);
    const bool none = !(length > 0) || !std::isfinite(length);
    for (float& component : a)
      component = none ? 0.0F : static_cast<float>(component / length);
    a = share.turned(a);
  }
  for (std::array<float, 6>& tensor : own_)
    tensor = turned(tensor);
}

std::array<float, 6> VoxelTensors::tensor(std::size_t voxel) const
{
  const std::uint8_t id = phase_[voxel];
  if (general_[id] == 2)
    return own_[voxel];
  std::array<float, 6> tensor = base_[id];
  const float more = along_[id] - across_[id];
  if (more != 0)
    for (std::size_t c = 0; c < 6; ++c)
      tensor[c] += more * axis_[voxel][axes[c][0]] * axis_[voxel][axes[c][1]];
  return tensor;
}

void VoxelTensors::row(std::int64_t y, std::int64_t z, float* const tensor[6]) const
{
  const std::size_t begin = first(y, z);
  for (std::size_t x = 0; x < static_cast<std::size_t>(nx_); ++x)
  {
    const std::uint8_t id = phase_[begin + x];
    const std::array<float, 6>& of = general_[id] == 2 ? own_[begin + x] : base_[id];
    for (std::size_t c = 0; c < 6; ++c)
      tensor[c][x] = factor_[c] * of[c];
  }
  if (axis_.empty())
    return;
  for (std::size_t x = 0; x < static_cast<std::size_t>(nx_); ++x)
  {
    const std::uint8_t id = phase_[begin + x];
    const float more = along_[id] - across_[id];
    const std::array<float, 3>& a = axis_[begin + x];
    for (std::size_t c = 0; c < 6; ++c)
      tensor[c][x] += factor_[c] * more * a[axes[c][0]] * a[axes[c][1]];
  }
}

} // namespace lamella::lbm
