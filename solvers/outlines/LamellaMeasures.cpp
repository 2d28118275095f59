#include "outlines/LamellaPhases.h"
#include "outlines/MiddleLamella.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::micrograph
{

NodesAcross nodesAcross(
  const ContourLattice& lattice, const WallDirections& directions, std::span<const std::uint8_t> phase)
{
  constexpr double step = 1.0 / 8;
  const std::int64_t nx = lattice.image.lattice.size[0];
  const std::int64_t ny = lattice.image.lattice.size[1];
  NodesAcross across;
  const auto beside = [&](std::size_t node)
  { return static_cast<double>(directions.second[node]) - static_cast<double>(directions.nearest[node]); };
  const auto measure = [&](std::size_t a, std::size_t b)
  {
    // The middle lies between the two nodes; nodes are unit squares around whole numbers here.
    const double t = beside(a) / std::max(beside(a) + beside(b), 1e-300);
    const bool alongX = b == a + 1;
    const std::size_t column = a % static_cast<std::size_t>(nx);
    const std::size_t row = a / static_cast<std::size_t>(nx);
    const Point middle{ static_cast<double>(column) + (alongX ? t : 0), static_cast<double>(row) + (alongX ? 0 : t) };
    const std::array<float, 2>& axis = directions.axis[t < 0.5 ? a : b];
    std::int64_t steps = 0;
    for (const int side : { 1, -1 })
    {
      for (std::int64_t i = 0; i < 8 * (nx + ny); ++i)
      {
        const double way = side * (static_cast<double>(i) + 0.5) * step;
        const auto x = static_cast<std::int64_t>(std::floor(middle[0] - way * static_cast<double>(axis[1]) + 0.5));
        const auto y = static_cast<std::int64_t>(std::floor(middle[1] + way * static_cast<double>(axis[0]) + 0.5));
        if (x < 0 || y < 0 || x >= nx || y >= ny || phase[static_cast<std::size_t>(x + nx * y)] != kLamella)
        {
          break;
        }
        ++steps;
      }
    }
    across.all.push_back(static_cast<float>(step * static_cast<double>(steps)));
  };
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(x + nx * y);
      const auto isLink = [&](std::size_t next)
      {
        return directions.grain[node] != directions.grain[next] && lattice.image.phase[node] != 0 &&
          lattice.image.phase[next] != 0;
      };
      if (x + 1 < nx && isLink(node + 1))
        measure(node, node + 1);
      if (y + 1 < ny && isLink(node + static_cast<std::size_t>(nx)))
        measure(node, node + static_cast<std::size_t>(nx));
    }
  }
  if (!across.all.empty())
  {
    double sum = 0;
    for (const float value : across.all)
      sum += static_cast<double>(value);
    across.mean = sum / static_cast<double>(across.all.size());
    const auto low = across.all.begin() + static_cast<std::ptrdiff_t>(across.all.size() / 20);
    std::nth_element(across.all.begin(), low, across.all.end());
    across.low = static_cast<double>(*low);
  }
  return across;
}

PhaseImage lamellaFromLabels(const Lattice& lattice, std::span<const std::uint16_t> grey)
{
  const GreyMap map{ { { 0, "lumen" }, { 128, "middle lamella" }, { 255, "wall" } }, {} };
  PhaseImage image = map.apply(lattice, grey);
  const PhaseTable phases({ "lumen", "wall", "middle lamella" });
  std::array<std::uint8_t, 3> id{};
  for (std::size_t i = 0; i < image.phases.size(); ++i)
    id.at(i) = phases.find(image.phases.name(static_cast<std::uint8_t>(i))).value();
  for (std::uint8_t& phase : image.phase)
    phase = id.at(phase);
  image.phases = phases;
  return image;
}

double overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, std::uint8_t phase)
{
  std::int64_t both = 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    const bool left = a[i] == phase;
    const bool right = b[i] == phase;
    both += left && right;
    sum += static_cast<int>(left) + static_cast<int>(right);
  }
  return sum > 0 ? 2.0 * static_cast<double>(both) / static_cast<double>(sum) : 1.0;
}

} // namespace lamella::micrograph
