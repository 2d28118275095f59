#include "peridynamics/fracture/FractureCheckpoint.h"

#include "core/Error.h"
#include "io/Provenance.h"
#include "lattice/AxisNames.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

std::string bytesOf(const void* data, std::size_t size)
{
  return { static_cast<const char*>(data), size };
}

} // namespace

std::string hashOfRows(const BondLattice& bonds, const std::function<std::string(std::int64_t, std::int64_t)>& row)
{
  const NodeLayout& l = bonds.layout();
  std::vector<std::int64_t> mine;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
    {
      const std::string bytes = row(y, z);
      io::Sha256 hash;
      hash.update(std::as_bytes(std::span(bytes)));
      mine.push_back(static_cast<std::int64_t>(std::stoull(hash.finish().substr(0, 15), nullptr, 16)));
    }
  const std::vector<std::int64_t> all = gather(bonds.communicator(), mine, 1);
  io::Sha256 hash;
  hash.update(std::as_bytes(std::span(all)));
  return hash.finish();
}

std::string sceneOf(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  std::string sides;
  for (std::size_t a = 0; a < 3; ++a)
    sides += bonds.periodic()[a] ? axisNames[a] : "";
  std::string text = fmt::format("nodes: {} x {} x {}\nspacing: {} m\nhorizon: {} spacings\nperiodic sides: {}\n"
                                 "surface correction: {}\nsolid nodes: {}\nbonds: {}\n",
    l.global[0], l.global[1], l.global[2], bonds.spacing(), bonds.stencil().horizon(), sides.empty() ? "none" : sides,
    bonds.corrected() ? "yes" : "no", bonds.solidNodes(), bonds.bonds());
  if (std::ranges::any_of(bonds.stencil().half(), [](const Offset& o) { return o.weight != 1; }))
    text += "micromodulus: isotropic\n";
  for (std::size_t k = 1; k < bonds.kinds().size(); ++k)
    text += fmt::format("bonds of kind {}: stiffness {}, critical stretch {}\n", k, bonds.kinds()[k].stiffness,
      bonds.kinds()[k].criticalStretch);
  const auto row = [&](std::int64_t y, std::int64_t z)
  {
    std::string bytes;
    const std::int64_t i = l.index(0, y, z);
    const auto n = static_cast<std::size_t>(l.size[0]);
    for (int p = 0; p < bonds.planes(); ++p)
      for (int w = 0; w < bonds.words(); ++w)
        bytes += bytesOf(bonds.plane(p, w) + i, n * sizeof(std::uint32_t));
    for (int a = 0; bonds.corrected() && a < l.dimension; ++a)
      bytes += bytesOf(bonds.shares(a) + i, n * sizeof(float));
    return bytes;
  };
  return text + "which bonds there are: " + hashOfRows(bonds, row).substr(0, 16) + "\n";
}

io::CheckpointArray gathered(
  const BondLattice& bonds, const NodeField<double>& field, std::string unit, std::string description)
{
  const NodeLayout& l = bonds.layout();
  std::vector<double> mine;
  mine.reserve(static_cast<std::size_t>(l.owned() * field.components()));
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        for (int c = 0; c < field.components(); ++c)
          mine.push_back(field.component(c)[i]);
  // slabs along the slowest axis: in the order of ranks they are in that of the lattice
  return { { l.global[2], l.global[1], l.global[0], field.components() }, bonds.communicator().gather(mine),
    std::move(unit), std::move(description) };
}

NodeField<double> scattered(const BondLattice& bonds, const io::Checkpoint& checkpoint, const std::string& name)
{
  const NodeLayout& l = bonds.layout();
  const std::vector<double>& values = checkpoint.reals(name);
  NodeField<double> field(l);
  if (checkpoint.arrays.at(name).shape !=
    std::vector<std::int64_t>{ l.global[2], l.global[1], l.global[0], field.components() })
    throw InputError(fmt::format("the checkpoint's '{}' is of another lattice", name), "start the run anew");
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
    {
      const std::int64_t first = l.start[0] + l.global[0] * (y + l.start[1] + l.global[1] * (z + l.start[2]));
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int c = 0; c < field.components(); ++c)
          field.at(c, x, y, z) = values[static_cast<std::size_t>((first + x) * field.components() + c)];
    }
  return field;
}

io::CheckpointArray arrayOf(const std::vector<Bond>& bonds)
{
  std::vector<std::int64_t> values;
  for (const Bond& b : bonds)
    values.insert(values.end(), { b.node[0], b.node[1], b.node[2], b.offset });
  return { { static_cast<std::int64_t>(bonds.size()), 4 }, std::move(values), "",
    "broken bonds in order: x, y, z of the first node, place in the half stencil" };
}

std::vector<Bond> bondsIn(const io::Checkpoint& checkpoint, const std::string& name, const BondLattice& bonds)
{
  const std::vector<std::int64_t>& values = checkpoint.integers(name);
  const auto& global = bonds.layout().global;
  std::vector<Bond> broken;
  for (std::size_t k = 0; k + 3 < values.size(); k += 4)
  {
    bool inside = values[k + 3] >= 0 && values[k + 3] < static_cast<std::int64_t>(bonds.stencil().half().size());
    for (std::size_t a = 0; a < 3; ++a)
      inside = inside && values[k + a] >= 0 && values[k + a] < global[a];
    if (!inside)
      throw InputError("the checkpoint's broken bonds are of another lattice", "start the run anew");
    broken.push_back({ { values[k], values[k + 1], values[k + 2] }, static_cast<int>(values[k + 3]) });
  }
  return broken;
}

} // namespace lamella::peridynamics
