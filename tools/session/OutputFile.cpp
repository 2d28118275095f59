#include "session/OutputFile.h"

#include "session/Workspace.h"

#include "core/Memory.h"
#include "core/PartFile.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <span>
#include <utility>

namespace lamella::cli
{

namespace fs = std::filesystem;

namespace
{

/// A result that is being made in this process.
struct Making
{
  std::string place; ///< which no other may have meanwhile
  PartFile part;
};
std::mutex guard;
std::map<fs::path, Making> making; ///< by the temporary file

Making& makingOf(const fs::path& temporary)
{
  const std::lock_guard<std::mutex> lock(guard);
  return making.at(temporary); // where it is does not change
}

std::string placeOf(const fs::path& path)
{
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path, ignored), ignored).string();
}

std::string quoted(const fs::path& path)
{
  return "'" + path.string() + "'";
}

std::atomic<bool> outputAllowed;
std::atomic<bool> outputUsed;

/// All of a file to standard output; the file goes. @returns 0 or errno
int sendOut(const fs::path& path)
{
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  ::unlink(path.c_str()); // nobody may read on: then the program is ended
  std::string block(std::size_t{ 1 } << 20, '\0');
  int error = file < 0 ? errno : 0;
  ssize_t count = 0;
  while (error == 0 && (count = ::read(file, block.data(), block.size())) > 0)
  {
    for (std::string_view left(block.data(), static_cast<std::size_t>(count)); error == 0 && !left.empty();)
    {
      const ssize_t written = ::write(STDOUT_FILENO, left.data(), left.size());
      left.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
      error = written < 0 && errno != EINTR ? errno : 0;
    }
  }
  error = error == 0 && count < 0 ? errno : error;
  if (file >= 0)
    ::close(file);
  return error;
}

std::string hintFor(int error)
{
  switch (error)
  {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "make room on the disk, or write to another one with -o; nothing was left behind";
    default:
      return "choose a folder that you can write to with -o";
  }
}

} // namespace

OutputFile::OutputFile(const fs::path& path, bool overwrite)
  : path_(path)
  , overwrite_(overwrite)
  , inMemory_(Workspace::holds(path))
{
  const bool sentOut = isStandardOutput(path);
  inMemory_ = inMemory_ || (sentOut && path.extension() == ".json" && path.stem().has_extension());
  if (inMemory_)
    return;
  if (sentOut && ::isatty(STDOUT_FILENO) == 1 && path.extension() != ".csv")
  {
    throw OutputError("standard output is a terminal, on which " + path.extension().string() + " cannot be read",
      "send it on: ... | lamella ... -, or > FILE");
  }
  std::error_code ignored;
  const fs::path folder = sentOut ? temporaryFolder() : folderOf(path);
  if (path.filename().empty() || fs::is_directory(path, ignored))
    throw OutputError(quoted(path) + " is a folder, not a file", "give the name of a file to -o");
  if (!fs::exists(folder, ignored))
    throw OutputError("there is no folder " + quoted(folder), "make it first: mkdir -p " + folder.string());
  if (!overwrite && !sentOut && fs::exists(fs::symlink_status(path, ignored)))
    throw OutputError(quoted(path) + " exists already", "choose another name, or add --overwrite to replace it");
  const std::lock_guard<std::mutex> lock(guard);
  const std::string place = sentOut ? "-" : placeOf(path);
  if (std::ranges::any_of(making, [&](const auto& one) { return one.second.place == place; }))
    throw ParameterError("two results are to be written to " + (sentOut ? "standard output" : quoted(path)),
      "give each of them a name of its own");
  PartFile part(folder / path.filename());
  if (PartFile::removedAll())
    throw Cancelled();
  if (const int error = part.error(); error != 0)
    throw OutputError("cannot write in the folder " + quoted(folder) + ": " + std::strerror(error), hintFor(error));
  temporary_ = part.path();
  making.emplace(temporary_, Making{ place, std::move(part) });
  if (sentOut)
    outputUsed = true;
}

OutputFile::~OutputFile()
{
  if (!temporary_.empty())
  {
    const std::lock_guard<std::mutex> lock(guard);
    making.erase(temporary_); // and with it the file
  }
}

OutputFile::OutputFile(OutputFile&& other) noexcept
  : path_(std::move(other.path_))
  , temporary_(std::exchange(other.temporary_, {}))
  , overwrite_(other.overwrite_)
  , inMemory_(other.inMemory_)
{
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept
{
  std::swap(path_, other.path_);
  std::swap(temporary_, other.temporary_);
  std::swap(overwrite_, other.overwrite_);
  std::swap(inMemory_, other.inMemory_);
  return *this;
}

void OutputFile::needs(std::uint64_t bytes) const
{
  struct statvfs disk = {};
  if (!inMemory_ && ::statvfs(folderOf(temporary_).c_str(), &disk) == 0)
  {
    const double room = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
    if (room < static_cast<double>(bytes))
    {
      throw OutputError(quoted(path_) + " can take up to " + bytesText(static_cast<double>(bytes)) +
          " and its disk has room for " + bytesText(room),
        hintFor(ENOSPC));
    }
  }
}

void OutputFile::failed(const std::string& why) const
{
  if (PartFile::removedAll())
    throw Cancelled();
  throw OutputError("cannot write " + quoted(path_) + ": " + why, hintFor(ENOSPC));
}

void OutputFile::failed() const
{
  const int file = ::open(temporary_.c_str(), O_CREAT | O_NOFOLLOW | O_WRONLY | O_APPEND | O_CLOEXEC, 0666);
  int error = file < 0 ? errno : 0;
  const std::string zeros(std::size_t{ 1 } << 20, '\0');
  std::size_t written = 0;
  while (error == 0 && written < zeros.size())
  {
    const ssize_t now = ::write(file, zeros.data() + written, zeros.size() - written);
    error = now < 0 ? errno : 0;
    written += now > 0 ? static_cast<std::size_t>(now) : 0;
  }
  if (file >= 0)
    ::close(file);
  failed(error != 0 ? std::strerror(error) : "the disk is full, or failed");
}

void OutputFile::rethrow(const Error& error) const
{
  if (PartFile::removedAll())
    throw Cancelled();
  std::string message = error.what();
  const std::size_t at = message.find(temporary_.string());
  if (at != std::string::npos)
  {
    message.replace(at, temporary_.string().size(), path_.string());
    throw OutputError(message, error.hint());
  }
}

void OutputFile::write(std::string_view bytes) const
{
  if (inMemory_)
    return;
  if (const int error = makingOf(temporary_).part.write(std::as_bytes(std::span(bytes))); error != 0)
    failed(std::strerror(error));
}

void OutputFile::commit()
{
  if (PartFile::removedAll()) // a writer that opens by name may have made the file anew
    throw Cancelled();
  if (inMemory_)
    return;
  const int error = isStandardOutput(path_)
    ? sendOut(temporary_)
    : makingOf(temporary_).part.take(path_, overwrite_ ? PartFile::Existing::goes : PartFile::Existing::stays);
  if (error == EEXIST && !overwrite_)
  {
    throw OutputError(quoted(path_) + " exists already: it was made while this ran",
      "choose another name, or add --overwrite to replace it");
  }
  if (error != 0)
    failed(std::strerror(error));
  const std::lock_guard<std::mutex> lock(guard);
  making.erase(temporary_);
  temporary_.clear();
}

bool OutputFile::isStandardOutput(const fs::path& path)
{
  return outputAllowed && path.native().starts_with("-.") && !path.has_parent_path();
}

void OutputFile::allowStandardOutput() noexcept
{
  outputAllowed = true;
}

bool OutputFile::usesStandardOutput() noexcept
{
  return outputUsed;
}

fs::path OutputFile::temporaryFolder()
{
  std::error_code missing;
  const fs::path folder = fs::temp_directory_path(missing);
  return missing ? fs::path("/tmp") : folder;
}

void OutputFile::removeAll() noexcept
{
  PartFile::removeAll();
}

fs::path withSuffix(const fs::path& path, const std::string& suffix)
{
  if (OutputFile::isStandardOutput(path))
    return path;
  return path.parent_path() / (path.stem().string() + suffix + path.extension().string());
}

} // namespace lamella::cli
