#include "scenes/Ports.h"

#include "session/Text.h"

#include <algorithm>

namespace lamella::cli
{

namespace
{

const std::vector<Ports>& table()
{
  static const std::vector<Ports> all{
    // samples
    { "read", {}, {}, { { "output", "sample", ".vti" } } },
    { "generate", {}, {}, { { "output", "sample", ".vti" } } },
    { "micrograph", {}, {}, { { "output", "sample", ".vti" }, { "contours", "outlines", ".vtp" } } },
    { "packing", {}, {}, { { "output", "grains", ".vtp" }, { "contacts", "contacts", ".vtp" } }, false, true },
    { "bridges", { { "FILE", "grains", "" } }, {}, { { "output", "sample", ".vti" } } },
    // solvers
    { "diffusion", { { "FILE", "sample", "" } }, {}, { { "output", "fields", ".vti" } }, true },
    { "fit", { { "FILE", "sample", "" } }, {}, { { "output", "fields", ".vti" } }, true },
    { "transient", { { "FILE", "sample", "" } }, {}, { { "output", "fields", ".vti" }, { "curve", "curve", ".csv" } },
      true, true },
    { "equilibrium", { { "FILE", "sample", "" } }, {}, { { "output", "fields", ".vti" } }, true },
    { "fracture", { { "FILE", "sample", "" } }, {},
      { { "output", "fields", ".vti" }, { "broken", "broken", ".vtp" }, { "curve", "curve", ".csv" } }, true, true },
    { "dynamics", { { "FILE", "sample", "" } }, {},
      { { "output", "fields", ".vti" }, { "broken", "broken", ".vtp" }, { "curve", "curve", ".csv" } }, true, true },
    { "compression", { { "FILE", "sample", "" } }, {},
      { { "output", "points", ".vtp" }, { "curve", "curve", ".csv" }, { "constants", "constants", ".csv" } }, true,
      true },
    { "stiffness", { { "FILE", "sample|fields", "" } }, {},
      { { "output", "fields", ".vti" }, { "tensor", "tensor", ".csv" }, { "constants", "constants", ".csv" },
        { "directions", "paths", ".vtp" } },
      true },
    { "bond-stiffness", { { "FILE", "sample", "" } }, {},
      { { "output", "tensor", ".csv" }, { "constants", "constants", ".csv" } }, true },
    // filters
    { "flux-map", { { "FILE", "fields", "" } }, {},
      { { "output", "fields", ".vti" }, { "lines", "streamlines", ".vtp" } } },
    { "pore-flood-fill", { { "FILE", "sample", "" } }, {},
      { { "output", "fields", ".vti" }, { "distribution", "distribution", ".csv" } } },
    { "stress-pdf", { { "FILE", "fields|points", "" } }, {},
      { { "output", "density", ".csv" }, { "phases", "phases", ".csv" }, { "thresholds", "thresholds", ".csv" } } },
    { "crack-path", { { "FILE", "broken", "" } }, { { "phases", "sample|fields", "" } },
      { { "output", "paths", ".vtp" }, { "image", "fields", ".vti" }, { "table", "table", ".csv" },
        { "pairs", "pairs", ".csv" }, { "growth", "growth", ".csv" }, { "fragments", "fragments", ".csv" } } },
    { "compression-curve", { { "FILE", "curve", "" } }, {}, { { "output", "energy", ".csv" } } },
    { "collapse-map", { { "IMAGE", "sample", "" }, { "POINTS", "points", "" } }, {},
      { { "output", "fields", ".vti" }, { "table", "table", ".csv" }, { "states", "states", ".csv" } } },
    { "snapshot", { { "FILE", "fields|points|paths|sample|grains", "" } },
      { { "lines", "paths|contacts|streamlines", "" } }, { { "output", "picture", ".png" } } },
  };
  return all;
}

} // namespace

std::span<const Ports> allPorts()
{
  return table();
}

const Ports* portsOf(const std::string& command)
{
  const auto found = std::ranges::find(table(), command, &Ports::command);
  return found == table().end() ? nullptr : &*found;
}

const Port* output(const Ports& ports, const std::string& option)
{
  const auto found = std::ranges::find(ports.gives, option, &Port::option);
  return found == ports.gives.end() ? nullptr : &*found;
}

bool fits(const Port& input, const std::string& kind)
{
  const std::vector<std::string> kinds = split(input.kind, '|');
  return std::ranges::find(kinds, kind) != kinds.end();
}

} // namespace lamella::cli
