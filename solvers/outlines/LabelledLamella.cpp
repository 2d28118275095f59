#include "outlines/LabelledLamella.h"

#include "outlines/LamellaPhases.h"

#include <algorithm>

namespace lamella::micrograph
{

PhaseImage labelledLamella(
  const ContourLattice& lattice, const PhaseImage& labels, std::uint8_t lamella, double stretch)
{
  PhaseImage image = lattice.image;
  image.phases = PhaseTable({ "lumen", "wall", "middle lamella" });
  const Lattice& to = image.lattice;
  const Lattice& from = labels.lattice;
  const auto pixel = [&](std::int64_t i, int axis)
  {
    const double at = (static_cast<double>(i) + 0.5) * to.spacing / from.spacing / (axis == 1 ? stretch : 1);
    return std::min(static_cast<std::int64_t>(at), from.size[static_cast<std::size_t>(axis)] - 1);
  };
  for (std::int64_t y = 0; y < to.size[1]; ++y)
  {
    for (std::int64_t x = 0; x < to.size[0]; ++x)
    {
      auto& phase = image.phase[static_cast<std::size_t>(to.index(x, y))];
      if (phase != kVoid && labels.phase[static_cast<std::size_t>(from.index(pixel(x, 0), pixel(y, 1)))] == lamella)
        phase = kLamella;
    }
  }
  return image;
}

double lamellaShare(const PhaseImage& image)
{
  const auto wall = std::count_if(image.phase.begin(), image.phase.end(), [](std::uint8_t p) { return p != kVoid; });
  const auto lamella = std::count(image.phase.begin(), image.phase.end(), kLamella);
  return wall > 0 ? static_cast<double>(lamella) / static_cast<double>(wall) : 0;
}

} // namespace lamella::micrograph
