#include "pictures/FileBytes.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

namespace lamella::micrograph
{

FileBytes::FileBytes(const std::filesystem::path& path)
  : name_(path.string())
{
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found)
    throw InputError(fmt::format("there is no file '{}'", name_), "check the name and the folder");
  if (failure)
  {
    throw InputError(
      fmt::format("'{}' cannot be looked at: {}", name_, failure.message()), "check the permissions of its folder");
  }
  if (status.type() == std::filesystem::file_type::directory)
    throw InputError(fmt::format("'{}' is a folder, not a file", name_), "name a file in it");
  if (status.type() != std::filesystem::file_type::regular)
    throw InputError(fmt::format("'{}' is not a regular file", name_), "save it as a file first");
  size_ = std::filesystem::file_size(path, failure);
  if (failure || size_ == 0)
    throw InputError(fmt::format("'{}' is empty (0 bytes)", name_), "copy or export the picture again");
  errno = 0;
  stream_.open(path, std::ios::binary);
  if (!stream_)
  {
    throw InputError(fmt::format("'{}' cannot be opened: {}", name_, std::generic_category().message(errno)),
      "check that you may read it (ls -l shows its permissions)");
  }
}

void FileBytes::read(std::uint64_t at, void* to, std::uint64_t count)
{
  if (!holds(at, count))
    truncated(fmt::format("{} bytes at byte {} are missing", count, at));
  stream_.seekg(static_cast<std::streamoff>(at));
  stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
  if (!stream_)
  {
    throw InputError(
      fmt::format("'{}' cannot be read at byte {}", name_, at), "check the disk, or copy the file again");
  }
}

std::vector<std::uint8_t> FileBytes::read(std::uint64_t at, std::uint64_t count)
{
  if (!holds(at, count)) // before anything is allocated for a size that may be nonsense
    truncated(fmt::format("{} bytes at byte {} are missing", count, at));
  std::vector<std::uint8_t> bytes(count);
  read(at, bytes.data(), count);
  return bytes;
}

std::uint64_t FileBytes::number(std::uint64_t at, int bytes, bool bigEndian)
{
  std::uint8_t buffer[8];
  read(at, buffer, static_cast<std::uint64_t>(bytes));
  return numberFrom(buffer, bytes, bigEndian);
}

void FileBytes::truncated(const std::string& what) const
{
  throw InputError(
    fmt::format("'{}' is truncated: {} (it has {} bytes)", name_, what, size_), "copy, download or export it again");
}

void FileBytes::damaged(const std::string& what) const
{
  throw InputError(fmt::format("'{}' is damaged: {}", name_, what), "copy, download or export it again");
}

std::uint64_t numberFrom(const std::uint8_t* bytes, int count, bool bigEndian) noexcept
{
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i)
    value = value << 8 | bytes[bigEndian ? i : count - 1 - i];
  return value;
}

} // namespace lamella::micrograph
