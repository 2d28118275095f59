#pragma once

#include <span>
#include <string>
#include <vector>

/// What commands take and give as data: how a scene joins them. Which options there are, and what they mean, the
/// commands alone know; here stands only which of them names data.
namespace lamella::cli
{

struct Port
{
  const char* option; ///< long name, or that of a positional: "output", "FILE"
  const char* kind;   ///< of data: "sample", "fields", "points", "broken", "curve", ...; of an input all that fit
  const char* ending; ///< of outputs
};

struct Ports
{
  const char* command;
  std::vector<Port> takes;   ///< without those the command cannot run
  std::vector<Port> accepts; ///< options that may name data: a scene gives them the name of a stage
  std::vector<Port> gives;   ///< the first is what `write = true` writes
  bool solver = false;       ///< takes what [material] says
  bool steps = false;        ///< comes to states on the way, for [[each]]
};

/// Those of a command, or null where it has no place in a scene.
[[nodiscard]] const Ports* portsOf(const std::string& command);
[[nodiscard]] std::span<const Ports> allPorts();

/// The output of this option, or null.
[[nodiscard]] const Port* output(const Ports& ports, const std::string& option);

/// "fields|points" fits "points".
[[nodiscard]] bool fits(const Port& input, const std::string& kind);

} // namespace lamella::cli
