#pragma once

#include "OutputFile.h"
#include "convert/Volume.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

/// TIFF files of any numbers, a page at a time, by libtiff.
namespace lamella::cli
{

/// Reads pages of grey values or of red, green and blue; all types of numbers.
class TiffReader
{
public:
  /// @throws InputError
  explicit TiffReader(const std::filesystem::path& path);
  ~TiffReader();
  TiffReader(const TiffReader&) = delete;
  TiffReader& operator=(const TiffReader&) = delete;

  /// Can this class read the page: black is zero or red, green and blue, all values of a pixel together, not packed
  /// with JPEG? (Palettes, white as zero and the rest are left to others.)
  [[nodiscard]] bool plain(std::size_t page);
  /// VTK's type of the values of the page that was asked for last, and values a pixel.
  [[nodiscard]] int type() const noexcept { return type_; }
  [[nodiscard]] int components() const noexcept { return components_; }
  /// @param to width × height × components values, the top row first
  /// @throws InputError
  void read(std::size_t page, void* to);

private:
  struct Open;
  std::unique_ptr<Open> open_;
  int type_ = 0;
  int components_ = 1;
};

/// Can TIFF hold values of this type, and so many a pixel?
[[nodiscard]] bool tiffHolds(int type, int components);

/// Writes a picture, or a volume with a page a layer; packed without loss, BigTIFF where it may pass 4 GiB.
/// @throws OutputError; Cancelled
void writeTiff(Session& session, Volume& volume, const OutputFile& file, const std::string& notes);

} // namespace lamella::cli
