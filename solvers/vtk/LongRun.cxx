#include "LongRun.h"

#include "io/Checkpoint.h"

#include <filesystem>
#include <system_error>

namespace lamella
{

bool beginsAnew(const std::string& continueFile, const std::string& checkpointFile, const Team& team)
{
  std::error_code ignored;
  return !continueFile.empty() && io::sameFile(continueFile, checkpointFile) &&
    team.any(team.rank() == 0 && !std::filesystem::exists(continueFile, ignored));
}

std::string anewWarning(const std::string& continueFile, const char* from)
{
  return "there was no checkpoint '" + continueFile + "' yet: the run began with " + from;
}

} // namespace lamella
