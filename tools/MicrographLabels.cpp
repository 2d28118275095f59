#include "MicrographLabels.h"

#include "Text.h"

#include "lattice/Error.h"
#include "lattice/PhaseNames.h"

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

} // namespace lamella::cli
