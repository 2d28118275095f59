#include "Commands.h"
namespace lamella::cli
{
Command fluxMapCommand(CLI::App& root)
{
  return { root.add_subcommand("tmpfluxMap", ""), [](Session&, const std::string&) {} };
}
} // namespace lamella::cli
