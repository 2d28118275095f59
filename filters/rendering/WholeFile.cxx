#include "WholeFile.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace lamella::rendering
{
namespace
{

bool WriteAll(int file, const unsigned char* bytes, std::size_t count)
{
  while (count > 0)
  {
    const ssize_t written = ::write(file, bytes, count);
    if (written < 0 && errno == EINTR)
    {
      continue;
    }
    if (written <= 0)
    {
      return false;
    }
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return fsync(file) == 0;
}

bool Rename(const std::string& from, const std::string& to, bool overwrite)
{
  if (overwrite)
  {
    return rename(from.c_str(), to.c_str()) == 0;
  }
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
  {
    return true;
  }
  // Some network file systems know no such rename; a second name and then one less does the same.
  return errno == EINVAL && link(from.c_str(), to.c_str()) == 0 && unlink(from.c_str()) == 0;
}

} // namespace

bool WriteWholeFile(const std::filesystem::path& target, const unsigned char* bytes, std::size_t count, bool overwrite,
  std::string& whyNot)
{
  const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  std::string name(".");
  name.append(target.filename().string()).append(".").append(std::to_string(getpid())).append(".part");
  const std::string beside = (folder / name).string();
  const int file = open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0)
  {
    whyNot = std::generic_category().message(errno);
    return false;
  }
  bool done = WriteAll(file, bytes, count);
  int failure = errno;
  if (close(file) != 0 && done)
  {
    done = false;
    failure = errno;
  }
  if (done && !Rename(beside, target.string(), overwrite))
  {
    done = false;
    failure = errno;
  }
  if (!done)
  {
    unlink(beside.c_str());
    whyNot = std::generic_category().message(failure);
  }
  return done;
}

} // namespace lamella::rendering
