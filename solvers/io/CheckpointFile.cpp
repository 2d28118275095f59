#include "io/Checkpoint.h"

#include "core/Error.h"
#include "core/PartFile.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace lamella::io
{

namespace fs = std::filesystem;

namespace
{

std::string reason(int error)
{
  return std::generic_category().message(error);
}

} // namespace

void checkPlace(const fs::path& path)
{
  std::error_code ignored;
  const fs::path folder = folderOf(path);
  if (!fs::is_directory(folder, ignored))
    throw InputError(fmt::format("there is no folder '{}' for the checkpoint", folder.string()), "make it first");
  if (path.filename().empty() || fs::is_directory(path, ignored))
    throw InputError(
      fmt::format("'{}' is a folder, not a file for a checkpoint", path.string()), "give the name of a file");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("cannot write in the folder '{}': {}", folder.string(), reason(errno)),
      "choose a folder that you can write to for the checkpoint");
  constexpr std::string_view begin = "Lamella checkpoint\n";
  std::ifstream file(path, std::ios::binary);
  std::string text(begin.size(), '\0');
  if (file && !(file.read(text.data(), static_cast<std::streamsize>(text.size())) && text == begin))
    throw InputError(fmt::format("'{}' is there already and is no checkpoint", path.string()),
      "choose another name for the checkpoint");
}

bool sameFile(const fs::path& a, const fs::path& b)
{
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(a, ignored), ignored) ==
    fs::weakly_canonical(fs::absolute(b, ignored), ignored);
}

} // namespace lamella::io
