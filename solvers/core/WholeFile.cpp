#include "core/WholeFile.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

namespace lamella
{

namespace fs = std::filesystem;

void writeWhole(const fs::path& path, const std::function<int(const PartFile&)>& write)
{
  const auto reason = [](int error) { return std::generic_category().message(error); };
  PartFile part(path);
  const int begun = part.error();
  if (begun == ECANCELED)
    throw Cancelled();
  if (begun != 0)
  {
    throw Error(fmt::format("'{}' cannot be written: {}", path.string(), reason(begun)),
      "choose a folder that exists and that you may write to, and another name");
  }
  int error = write(part);
  error = error == 0 ? part.take(path) : error;
  if (error != 0 && PartFile::removedAll())
    throw Cancelled();
  if (error != 0)
  {
    throw Error(fmt::format("'{}' cannot be written whole: {}", path.string(), reason(error)),
      "make room on the disk or choose another folder; nothing was left behind");
  }
}

void writeWhole(const fs::path& path, std::span<const std::byte> bytes)
{
  writeWhole(
    path, [bytes](const PartFile& part) { return part.write(bytes); });
}

} // namespace lamella
