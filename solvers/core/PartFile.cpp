#include "core/PartFile.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <stdio.h> // NOLINT: renameat2 is declared here and not in <cstdio>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace lamella
{

namespace fs = std::filesystem;

/// Where a signal handler finds it: nothing of this list is ever freed, and a name is whole before it is in use.
struct PartFile::Name
{
  std::array<char, PATH_MAX> text{};
  std::atomic<bool> used{ true };
  Name* next = nullptr;
};

namespace
{

constexpr std::string_view mark = ".lamella-";

// Set before the files are removed: what is written from then on is written in vain.
std::atomic<bool> removed;
// Removing waits while somebody holds it.
std::atomic<int> holds;
std::atomic<bool> due;

/// Stands for where process numbers mean what they mean here: the machine, and in a container that.
std::string_view here()
{
  static const std::string known = []
  {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    std::error_code none;
    const std::string text = host.data() + fs::read_symlink("/proc/self/ns/pid", none).string();
    std::uint32_t hash = 2166136261U; // FNV-1a
    for (const char c : text)
      hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    return fmt::format("{:08x}", hash);
  }();
  return known;
}

/// The process of a name ".lamella-HERE-PROCESS-..."; 0 when it is none of this machine.
pid_t processOf(std::string_view name)
{
  if (!name.starts_with(mark))
    return 0;
  name.remove_prefix(mark.size());
  if (!name.starts_with(here()) || name.substr(here().size(), 1) != "-")
    return 0;
  name.remove_prefix(here().size() + 1);
  pid_t process = 0;
  const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), process);
  return fault == std::errc() && end != name.data() + name.size() && *end == '-' && process > 0 ? process : 0;
}

/// Whether a process has ended, also where nobody has asked for its exit code yet: orphans stay like that for a while,
/// and for ever in a container whose first process never asks.
bool ended(pid_t process)
{
  if (::kill(process, 0) != 0)
    return errno == ESRCH;
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  const std::string text{ std::istreambuf_iterator<char>(file), {} };
  const std::size_t name = text.rfind(')'); // it may hold anything
  return name != std::string::npos && text.compare(name, 3, ") Z") == 0;
}

/// What processes left that were killed. Once for a folder.
void removeLeft(const fs::path& folder)
{
  static std::mutex guard;
  static std::set<std::string> seen;
  const std::lock_guard<std::mutex> lock(guard);
  if (!seen.insert(folder.string()).second)
    return;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed))
  {
    const pid_t process = processOf(at->path().filename().string());
    if (process > 0 && ended(process))
      ::unlink(at->path().c_str());
  }
}

std::atomic<void*> names; ///< the first PartFile::Name

int renamed(const fs::path& from, const fs::path& to)
{
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

/// Not over a file that somebody else made in the meantime. Where the file system cannot do that in one step, a hard
/// link can: it fails when the name exists.
int renamedAnew(const fs::path& from, const fs::path& to)
{
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
    return 0;
  if (errno != EINVAL && errno != ENOSYS)
    return errno;
  if (::link(from.c_str(), to.c_str()) == 0)
  {
    ::unlink(from.c_str());
    return 0;
  }
  return errno == EEXIST ? EEXIST : renamed(from, to);
}

} // namespace

PartFile::PartFile(const fs::path& place, OnSignal onSignal)
{
  static std::atomic<unsigned> count;
  const fs::path folder = folderOf(place);
  removeLeft(folder);
  constexpr std::size_t longest = 180; // of 255; the end of it tells the kind of file
  std::string name = place.filename().string();
  name.erase(0, name.size() > longest ? name.size() - longest : 0);
  for (int attempt = 0; path_.empty() && error_ == 0; ++attempt)
  {
    const fs::path path = folder / fmt::format("{}{}-{}-{}-{}", mark, here(), ::getpid(), count++, name);
    const int file = ::open(path.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0666);
    if (file >= 0)
    {
      ::close(file);
      path_ = path;
    }
    else if (errno != EEXIST || attempt == 99)
    {
      error_ = errno;
    }
  }
  if (error_ != 0 || onSignal == OnSignal::stays)
    return;
  const std::string text = path_.string();
  if (text.size() < PATH_MAX)
  {
    for (auto* one = static_cast<Name*>(names.load()); one != nullptr && name_ == nullptr; one = one->next)
    {
      bool used = false;
      if (one->used.load() || !one->used.compare_exchange_strong(used, true))
        continue;
      name_ = one;
      name_->text[0] = '\0'; // a signal here finds no name
      std::atomic_signal_fence(std::memory_order_seq_cst);
      std::memcpy(name_->text.data() + 1, text.c_str() + 1, text.size());
      std::atomic_signal_fence(std::memory_order_seq_cst);
      name_->text[0] = text[0];
    }
    if (name_ == nullptr)
    {
      name_ = new Name; // NOLINT: never freed
      std::memcpy(name_->text.data(), text.c_str(), text.size() + 1);
      void* before = names.load();
      do
      {
        name_->next = static_cast<Name*>(before);
      } while (!names.compare_exchange_weak(before, name_));
    }
  }
  if (removed.load()) // a signal came before it could see this file
  {
    ::unlink(path_.c_str());
    release();
    error_ = ECANCELED;
  }
}

PartFile::~PartFile()
{
  if (!path_.empty())
    ::unlink(path_.c_str());
  release();
}

PartFile::PartFile(PartFile&& other) noexcept
  : path_(std::exchange(other.path_, {}))
  , name_(std::exchange(other.name_, nullptr))
  , error_(other.error_)
{
}

PartFile& PartFile::operator=(PartFile&& other) noexcept
{
  std::swap(path_, other.path_);
  std::swap(name_, other.name_);
  std::swap(error_, other.error_);
  return *this;
}

int PartFile::write(std::initializer_list<std::span<const std::byte>> parts) const
{
  const int file = ::open(path_.c_str(), O_NOFOLLOW | O_WRONLY | O_TRUNC | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  for (std::span<const std::byte> bytes : parts)
    while (error == 0 && !bytes.empty())
    {
      const ssize_t written = ::write(file, bytes.data(), bytes.size());
      if (written > 0)
        bytes = bytes.subspan(static_cast<std::size_t>(written));
      else if (written == 0 || errno != EINTR)
        error = written == 0 ? ENOSPC : errno;
    }
  if (file >= 0 && ::close(file) != 0 && error == 0)
    error = errno;
  return error;
}

int PartFile::take(const fs::path& place, Existing existing)
{
  // Somebody else may have written it, by its name.
  const int file = ::open(path_.c_str(), O_NOFOLLOW | O_WRONLY | O_CLOEXEC);
  int error = file < 0 || ::fsync(file) != 0 ? errno : 0;
  if (file >= 0)
    ::close(file);
  if (error == 0)
    error = existing == Existing::goes ? renamed(path_, place) : renamedAnew(path_, place);
  if (error != 0)
    return error;
  release();
  // The name itself lives in the folder, which is on the disk only after this.
  if (const int folder = ::open(folderOf(place).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); folder >= 0)
  {
    ::fsync(folder);
    ::close(folder);
  }
  return 0;
}

void PartFile::release() noexcept
{
  path_.clear();
  if (name_ != nullptr)
  {
    name_->used.store(false);
    name_ = nullptr;
  }
}

PartFile::Hold::Hold() noexcept
{
  ++holds;
}

PartFile::Hold::~Hold()
{
  if (--holds == 0 && due.load())
    removeAll();
}

void PartFile::removeAll() noexcept
{
  if (holds.load() > 0)
  {
    due.store(true);
    return;
  }
  removed.store(true);
  for (auto* one = static_cast<Name*>(names.load()); one != nullptr; one = one->next)
    if (one->used.load() && one->text[0] != '\0')
      ::unlink(one->text.data());
}

bool PartFile::removedAll() noexcept
{
  return removed.load();
}

bool PartFile::isPart(const fs::path& path)
{
  return path.filename().string().starts_with(mark);
}

} // namespace lamella
