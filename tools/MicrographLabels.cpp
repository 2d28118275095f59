#include "MicrographLabels.h"

#include "Text.h"

#include "lattice/Error.h"
#include "lattice/PhaseNames.h"

#include <algorithm>

namespace lamella::cli
{

std::uint8_t labelledLamella(const MicrographCommandOptions& o, const PhaseTable& phases)
{
  if (!o.lamellaPhase.empty())
  {
    if (const auto id = phaseMeant(phases.names(), o.lamellaPhase))
    {
      return static_cast<std::uint8_t>(*id);
    }
    throw ParameterError("--lamella-phase '" + o.lamellaPhase + "' is no phase of this picture",
      suggestion(o.lamellaPhase, phases.names(), "its phases are " + quotedList(phases.names(), "and")));
  }
  if (const auto id = phaseMeant(phases.names(), "middle lamella"))
  {
    return static_cast<std::uint8_t>(*id);
  }
  throw InputError(
    "which phase is the middle lamella? '" + o.input.picture.file + "' has " + quotedList(phases.names(), "and"),
    "add --lamella-phase NAME, or choose --lamella growth");
}

PhaseImage fromLabels(
  const micrograph::ContourLattice& lattice, const PhaseImage& labels, std::uint8_t lamella, double stretch)
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
      if (phase != 0 && labels.phase[static_cast<std::size_t>(from.index(pixel(x, 0), pixel(y, 1)))] == lamella)
      {
        phase = 2;
      }
    }
  }
  return image;
}

double lamellaShare(const PhaseImage& image)
{
  const auto wall = std::count_if(image.phase.begin(), image.phase.end(), [](std::uint8_t p) { return p != 0; });
  const auto lamella = std::count(image.phase.begin(), image.phase.end(), std::uint8_t{ 2 });
  return wall > 0 ? static_cast<double>(lamella) / static_cast<double>(wall) : 0;
}

} // namespace lamella::cli
