#include "LongRun.h"

#include "vtkLatticeConversion.h"

#include "io/Checkpoint.h"

#include <filesystem>
#include <system_error>

namespace lamella
{

RunStart startOf(const std::string& continueFile, const std::string& checkpointFile, const char* beginning,
  vtkDataObject* input, const Team& team, io::CheckpointOptions& options)
{
  options.path = checkpointFile;
  options.provenance = fieldText(input, "provenance").value_or("");
  std::error_code ignored;
  const bool anew = !continueFile.empty() && io::sameFile(continueFile, checkpointFile) &&
    team.any(team.rank() == 0 && !std::filesystem::exists(continueFile, ignored));
  if (!anew)
  {
    return { continueFile, {} };
  }
  return { {}, "there was no checkpoint '" + continueFile + "' yet: the run began with " + beginning };
}

} // namespace lamella
