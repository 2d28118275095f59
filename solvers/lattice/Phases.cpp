#include "lattice/Phases.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/NodeText.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lamella
{
namespace
{

constexpr int greysOfMap = 65536;

std::string sizeText(const Lattice& lattice)
{
  return lattice.dimension == 3 ? fmt::format("{} × {} × {}", lattice.size[0], lattice.size[1], lattice.size[2])
                                : fmt::format("{} × {}", lattice.size[0], lattice.size[1]);
}

void requireCount(const Lattice& lattice, std::size_t values)
{
  if (lattice.count() < 1 || static_cast<std::size_t>(lattice.count()) != values)
  {
    throw ParameterError(fmt::format("{} values for a lattice of {} nodes", values, sizeText(lattice)),
      "give one value a node, x fastest, then y, then z");
  }
}

/// @throws InputError for the first grey that has no phase
[[noreturn]] void refuseGrey(
  const Lattice& lattice, std::span<const std::uint16_t> grey, const std::vector<int>& idOfGrey)
{
  const auto first = std::find_if(grey.begin(), grey.end(), [&](std::uint16_t value) { return idOfGrey[value] < 0; });
  std::vector<std::int64_t> missing(greysOfMap, 0);
  for (const std::uint16_t value : grey)
    missing[value] += idOfGrey[value] < 0;
  const std::int64_t nodes = missing[*first];
  const std::int64_t others = greysOfMap - 1 - std::count(missing.begin(), missing.end(), 0);
  const std::string more =
    others > 0 ? fmt::format("; {} more grey value{} likewise", others, others > 1 ? "s" : "") : "";
  throw InputError(fmt::format("grey value {} is in no phase: {} {} it, one is {}{}", *first, nodes,
                     nodes == 1 ? "node has" : "nodes have", nodeText(lattice, first - grey.begin()), more),
    fmt::format("name it with phase {}=NAME, or all greys that are not listed with other NAME", *first));
}

} // namespace

std::string nodeText(const Lattice& lattice, std::int64_t node)
{
  const std::int64_t x = node % lattice.size[0];
  const std::int64_t y = node / lattice.size[0] % lattice.size[1];
  const std::int64_t z = node / (lattice.size[0] * lattice.size[1]);
  return lattice.dimension == 3 ? fmt::format("voxel {}, {}, {}", x, y, z)
                                : fmt::format("pixel {}, {} from the top left", x, lattice.size[1] - 1 - y);
}

PhaseTable::PhaseTable(const std::vector<std::string>& names)
{
  for (const std::string& name : names)
  {
    if (find(name))
      throw ParameterError(fmt::format("two phases are called '{}'", name), "give every phase a name of its own");
    add(name);
  }
}

std::uint8_t PhaseTable::add(const std::string& name)
{
  if (name.empty())
    throw ParameterError("a phase has an empty name", "give it a name, such as wall");
  if (const auto id = find(name))
    return *id;
  if (names_.size() >= 256)
  {
    throw ParameterError(
      fmt::format("phase '{}' would be the 257th, and a lattice holds 256", name), "put several greys into one phase");
  }
  names_.push_back(name);
  return static_cast<std::uint8_t>(names_.size() - 1);
}

std::optional<std::uint8_t> PhaseTable::find(const std::string& name) const
{
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end())
    return std::nullopt;
  return static_cast<std::uint8_t>(found - names_.begin());
}

std::vector<double> PhaseImage::fractions() const
{
  std::array<std::int64_t, 256> nodes{};
  for (const std::uint8_t id : phase)
    ++nodes[id];
  std::vector<double> result(phases.size(), 0.0);
  for (std::size_t id = 0; id < result.size() && !phase.empty(); ++id)
    result[id] = static_cast<double>(nodes[id]) / static_cast<double>(phase.size());
  return result;
}

PhaseImage GreyMap::apply(const Lattice& lattice, std::span<const std::uint16_t> grey) const
{
  requireCount(lattice, grey.size());
  PhaseImage image{ lattice, {}, {} };
  const auto isVoid = [](const auto& entry) { return entry.second == "void"; };
  if (std::any_of(phaseOfGrey.begin(), phaseOfGrey.end(), isVoid) || other == "void")
    image.phases.add("void");
  std::vector<int> idOfGrey(greysOfMap, -1);
  for (const auto& [value, name] : phaseOfGrey)
  {
    if (value < 0 || value >= greysOfMap)
    {
      throw ParameterError(fmt::format("phase '{}' is given the grey value {}, which no picture has", name, value),
        "grey values run from 0 to 255 in 8-bit pictures and to 65535 in 16-bit ones");
    }
    idOfGrey[static_cast<std::size_t>(value)] = image.phases.add(name);
  }
  if (other)
  {
    const int id = image.phases.add(*other);
    std::replace(idOfGrey.begin(), idOfGrey.end(), -1, id);
  }

  image.phase.resize(grey.size());
  int lowest = 0; // −1 as soon as one grey has no phase; kept out of the loop so that it stays branch-free
  for (std::size_t node = 0; node < grey.size(); ++node)
  {
    const int id = idOfGrey[grey[node]];
    lowest = std::min(lowest, id);
    image.phase[node] = static_cast<std::uint8_t>(id);
  }
  if (lowest < 0)
    refuseGrey(lattice, grey, idOfGrey);
  return image;
}

std::array<std::int64_t, 3> firstNode(const Lattice& from, const Window& window)
{
  std::array<std::int64_t, 3> start = window.start;
  std::array<std::int64_t, 3> size = window.size;
  if (from.dimension == 2)
  {
    start[2] = 0;
    size[2] = 1;
  }
  for (int axis = 0; axis < from.dimension; ++axis)
  {
    // Compared without start + size, which can overflow.
    if (start[axis] < 0 || size[axis] < 1 || start[axis] >= from.size[axis] ||
      size[axis] > from.size[axis] - start[axis])
    {
      const bool flat = from.dimension == 2;
      const std::string seen = flat
        ? fmt::format("{},{},{},{}", start[0], start[1], size[0], size[1])
        : fmt::format("{},{},{},{},{},{}", start[0], start[1], start[2], size[0], size[1], size[2]);
      throw ParameterError(fmt::format("the window {} {} {} {}, which is {} {}", seen,
                             size[axis] < 1 ? "is empty along" : "reaches outside along", "xyz"[axis],
                             flat ? "in the picture" : "in the volume", sizeText(from), flat ? "pixels" : "voxels"),
        flat ? "give X,Y,WIDTH,HEIGHT in pixels from the top left, inside the picture"
             : "give X,Y,Z,WIDTH,HEIGHT,DEPTH in voxels from the first one in the file, inside the volume");
    }
  }
  if (from.dimension == 2)
    start[1] = from.size[1] - start[1] - size[1]; // memory counts rows from the bottom
  return start;
}

PhaseImage crop(const PhaseImage& image, const Window& window)
{
  const Lattice& from = image.lattice;
  requireCount(from, image.phase.size());
  const std::array<std::int64_t, 3> start = firstNode(from, window);
  const std::array<std::int64_t, 3> size{ window.size[0], window.size[1], from.dimension == 2 ? 1 : window.size[2] };

  PhaseImage result{ makeLattice(size[0], size[1], size[2], from.dimension, from.spacing, from.aspect), {},
    image.phases };
  result.phase.resize(static_cast<std::size_t>(result.lattice.count()));
  std::uint8_t* to = result.phase.data();
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      to = std::copy_n(image.phase.data() + from.index(start[0], start[1] + y, start[2] + z), size[0], to);
  return result;
}

PhaseImage refine(const PhaseImage& image, int n)
{
  const Lattice& from = image.lattice;
  requireCount(from, image.phase.size());
  if (n < 1)
    throw ParameterError(fmt::format("a refinement of {}", n), "refine by a whole number from 1 up");
  const std::int64_t nz = from.dimension == 3 ? n : 1;
  const double bytes = static_cast<double>(from.count()) * std::pow(static_cast<double>(n), from.dimension);
  const std::uint64_t available = availableMemory();
  if (bytes > static_cast<double>(available))
  {
    throw MemoryError(fmt::format("a picture of {} nodes refined by {} needs {} for its phases alone, and {} are free",
                        sizeText(from), n, bytesText(bytes), bytesText(static_cast<double>(available))),
      "refine less, or cut out a smaller window");
  }

  PhaseImage result{ makeLattice(from.size[0] * n, from.size[1] * n, from.size[2] * nz, from.dimension,
                       from.spacing / n, from.aspect),
    {}, image.phases };
  result.phase.resize(static_cast<std::size_t>(result.lattice.count()));
  const std::int64_t row = result.lattice.size[0];
  const std::int64_t slab = row * result.lattice.size[1];
  for (std::int64_t z = 0; z < from.size[2]; ++z)
  {
    std::uint8_t* const firstSlab = result.phase.data() + z * nz * slab;
    for (std::int64_t y = 0; y < from.size[1]; ++y)
    {
      const std::uint8_t* const source = image.phase.data() + from.index(0, y, z);
      std::uint8_t* const firstRow = firstSlab + y * n * row;
      for (std::int64_t x = 0; x < from.size[0]; ++x)
        std::fill_n(firstRow + x * n, n, source[x]);
      for (int copy = 1; copy < n; ++copy)
        std::copy_n(firstRow, row, firstRow + copy * row);
    }
    for (std::int64_t copy = 1; copy < nz; ++copy)
      std::copy_n(firstSlab, slab, firstSlab + copy * slab);
  }
  return result;
}

} // namespace lamella
