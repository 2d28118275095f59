#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Bytes in which TIFF directories lie: a file, or the Exif block of a JPEG.
struct TiffSource
{
  std::function<std::vector<std::uint8_t>(std::uint64_t at, std::uint64_t count)> read; ///< throws beyond the end
  bool bigEndian = false;
  bool big = false; ///< BigTIFF: 64-bit offsets

  [[nodiscard]] std::uint64_t number(std::uint64_t at, int bytes) const;
  /// Reads the byte order and version; gives the place of the first directory, or nothing where this is no TIFF.
  [[nodiscard]] std::optional<std::uint64_t> open();
};

/// One directory: tag → values.
class TiffDirectory
{
public:
  /// @throws what the source throws; std::length_error for an entry of more than `mostValues` values
  TiffDirectory(const TiffSource& source, std::uint64_t at);

  [[nodiscard]] std::uint64_t next() const noexcept { return next_; }
  [[nodiscard]] bool has(int tag) const { return entries_.count(tag) != 0; }
  [[nodiscard]] std::uint64_t value(int tag, std::uint64_t otherwise) const;
  [[nodiscard]] std::vector<std::uint64_t> values(int tag) const;
  [[nodiscard]] double ratio(int tag) const; ///< a RATIONAL; 0 where there is none
  [[nodiscard]] std::string text(int tag) const;

private:
  struct Entry
  {
    int type = 0;
    std::uint64_t count = 0;
    std::uint64_t at = 0; ///< of the values
  };
  const TiffSource* source_;
  std::map<int, Entry> entries_;
  std::uint64_t next_ = 0;
};

} // namespace lamella::micrograph
