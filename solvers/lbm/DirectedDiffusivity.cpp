#include "lbm/DirectedDiffusivity.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace lamella::lbm
{
namespace
{

/// In a picture the third axis is on its own.
SymmetricTensor<double> ofThisSpace(SymmetricTensor<double> tensor, int dimension)
{
  if (dimension == 2)
    tensor[2] = 0.5 * (tensor[0] + tensor[1]);
  return tensor;
}

} // namespace

std::array<double, 3> requireTensor(
  const SymmetricTensor<double>& given, int dimension, const std::function<std::string()>& of)
{
  const SymmetricTensor<double> tensor = ofThisSpace(given, dimension);
  const auto refuse = [&](const std::string& why, const char* hint)
  {
    throw ParameterError(fmt::format("the conductivity {} {} (xx {:g}, yy {:g}, zz {:g}, xy {:g}, yz {:g}, xz {:g})",
                           of(), why, given[0], given[1], given[2], given[3], given[4], given[5]),
      hint);
  };
  if (!std::ranges::all_of(tensor, [](double value) { return std::isfinite(value); }))
    refuse("is no finite tensor", "give finite numbers");
  if (dimension == 2 && (tensor[4] != 0 || tensor[5] != 0))
    refuse("couples the third axis with a picture's plane", "give yz and xz of 0, or a volume");
  const std::array<double, 3> principal = principalValues(tensor);
  if (!(principal[0] > 0))
    refuse(fmt::format("is not positive definite: its least principal value is {:g}", principal[0]),
      "give a tensor whose principal values are all above 0, as those of a material are; of a phase that does not "
      "conduct the conductivity 0");
  if (!plausible(principal[0]) || !plausible(principal[2]))
    refuse(
      fmt::format("has principal values from {:g} to {:g}, not between 1e-30 and 1e30", principal[0], principal[2]),
      "no material has these; of a phase that does not conduct give the conductivity 0");
  if (principal[2] > mostPrincipal * principal[0])
    refuse(fmt::format("has principal values from {:g} to {:g}", principal[0], principal[2]),
      "keep them within a ratio of 1e6, which single precision carries");
  return principal;
}

std::array<double, 3> principalValues(const SymmetricTensor<double>& tensor)
{
  Eigen::Matrix3d m;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      m(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = tensor[tensorPlace(a, b)];
  // by rotations: the closed form loses a least value that is far below the largest
  const Eigen::Vector3d values =
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues();
  return { values(0), values(1), values(2) };
}

bool DirectedDiffusivity::hasTensors() const noexcept
{
  return std::ranges::any_of(
    source, [](Source s) { return s != Source::Axial; });
}

bool DirectedDiffusivity::hasAxes() const noexcept
{
  return along != across; // of tensors both are the same
}

std::vector<double> DirectedDiffusivity::larger() const
{
  std::vector<double> values(along);
  for (std::size_t id = 0; id < values.size(); ++id)
    values[id] = std::max(along[id], across[id]);
  return values;
}

std::vector<double> DirectedDiffusivity::smaller() const
{
  std::vector<double> values(along);
  for (std::size_t id = 0; id < values.size(); ++id)
    values[id] = sourceOf(id) == Source::Axial ? std::min(along[id], across[id]) : least[id];
  return values;
}

std::vector<SymmetricTensor<double>> DirectedDiffusivity::means(std::span<const std::uint8_t> phase) const
{
  SymmetricTensor<double> none{};
  none.fill(std::numeric_limits<double>::quiet_NaN());
  std::vector<SymmetricTensor<double>> result(along.size(), none);
  std::vector<std::int64_t> nodes(along.size(), 0);
  for (std::size_t id = 0; id < along.size(); ++id)
    if (sourceOf(id) != Source::Axial)
      result[id] = sourceOf(id) == Source::Phase ? ofPhase[id] : SymmetricTensor<double>{};
  for (std::size_t i = 0; i < ofNode.size(); ++i)
    if (const std::uint8_t id = phase[i]; sourceOf(id) == Source::Node)
    {
      ++nodes[id];
      for (std::size_t c = 0; c < 6; ++c)
        result[id][c] += ofNode[i][c];
    }
  for (std::size_t id = 0; id < along.size(); ++id)
    if (nodes[id] > 0)
      for (double& value : result[id])
        value /= static_cast<double>(nodes[id]);
  return result;
}

void DirectedDiffusivity::takeTensors(const Lattice& lattice, std::span<const std::uint8_t> phase)
{
  const std::size_t ids = along.size();
  if (source.empty())
    return;
  const bool byPhase = std::ranges::find(source, Source::Phase) != source.end();
  const bool byNode = std::ranges::find(source, Source::Node) != source.end();
  if (source.size() != ids || across.size() != ids || (byPhase && ofPhase.size() != ids) ||
    (byNode && ofNode.size() != phase.size()))
    throw ParameterError(fmt::format("{} sources and {} tensors of phases and {} of nodes for {} phases and {} nodes",
                           source.size(), ofPhase.size(), ofNode.size(), ids, phase.size()),
      "give one for each");
  least = across;
  const auto take = [this](std::size_t id, const std::array<double, 3>& principal)
  {
    least[id] = std::min(least[id], principal[0]);
    along[id] = across[id] = std::max(along[id], principal[2]);
  };
  for (std::size_t id = 0; id < ids; ++id)
  {
    if (source[id] == Source::Axial)
      continue;
    along[id] = across[id] = 0;
    least[id] = std::numeric_limits<double>::infinity();
    if (source[id] == Source::Phase)
      take(id, requireTensor(ofPhase[id], lattice.dimension, [id] { return fmt::format("of phase {}", id); }));
  }
  for (std::size_t i = 0; byNode && i < phase.size(); ++i)
  {
    if (source[phase[i]] != Source::Node)
      continue;
    SymmetricTensor<double> tensor{};
    std::ranges::copy(ofNode[i], tensor.begin());
    take(phase[i],
      requireTensor(tensor, lattice.dimension,
        [&]
        {
          const auto at = static_cast<std::int64_t>(i);
          const std::int64_t x = at % lattice.size[0];
          const std::int64_t y = at / lattice.size[0] % lattice.size[1];
          return lattice.dimension == 2
            ? fmt::format("at pixel ({}, {})", x, y)
            : fmt::format("at voxel ({}, {}, {})", x, y, at / (lattice.size[0] * lattice.size[1]));
        }));
  }
  for (double& value : least) // of what no node has
    value = std::isfinite(value) ? value : 0;
}

} // namespace lamella::lbm
