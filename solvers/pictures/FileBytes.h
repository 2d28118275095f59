#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// A regular file, read anywhere.
/// @throws InputError from the constructor: missing, a folder, not a regular file, empty, no permission
class FileBytes
{
public:
  explicit FileBytes(const std::filesystem::path& path);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// True when all of [at, at + count) is inside the file.
  [[nodiscard]] bool holds(std::uint64_t at, std::uint64_t count) const noexcept
  {
    return at <= size_ && count <= size_ - at;
  }
  /// @throws InputError (truncated) when it reaches beyond the end
  void read(std::uint64_t at, void* to, std::uint64_t count);
  [[nodiscard]] std::vector<std::uint8_t> read(std::uint64_t at, std::uint64_t count);
  /// A whole number of 1, 2, 4 or 8 bytes.
  [[nodiscard]] std::uint64_t number(std::uint64_t at, int bytes, bool bigEndian);

  /// The error for a file that ends before its contents do.
  [[noreturn]] void truncated(const std::string& what) const;
  /// The error for contents that contradict each other.
  [[noreturn]] void damaged(const std::string& what) const;

private:
  std::string name_;
  std::uint64_t size_ = 0;
  std::ifstream stream_;
};

/// A whole number from bytes in memory.
[[nodiscard]] std::uint64_t numberFrom(const std::uint8_t* bytes, int count, bool bigEndian) noexcept;

} // namespace lamella::micrograph
