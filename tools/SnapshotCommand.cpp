#include "Commands.h"
namespace lamella::cli
{
Command snapshotCommand(CLI::App& root)
{
  return { root.add_subcommand("tmpsnapshot", ""), [](Session&, const std::string&) {} };
}
} // namespace lamella::cli
