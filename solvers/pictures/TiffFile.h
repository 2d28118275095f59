#pragma once

#include "pictures/FileBytes.h"
#include "pictures/Pixels.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

/// TIFF, by libtiff: a page at a time, of any numbers.
namespace lamella::micrograph
{

/// Types of numbers, as TIFF counts them.
enum class TiffNumbers
{
  Unsigned = 1,
  Signed = 2,
  Real = 3
};

/// What a page says of itself.
struct TiffPage
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  int bits = 1;
  int samples = 1;                  ///< a pixel
  int numbers = 1;                  ///< TiffNumbers, or what else the file says
  std::optional<int> photometric{}; ///< what the samples mean
  int packing = 1;
  bool together = true; ///< the samples of a pixel
  bool smaller = false; ///< a copy of another page
  std::string description{};
  std::optional<std::array<double, 2>> pixelSize{}; ///< [m], x and y, where the unit is a length
  std::array<double, 2> perUnit{};                  ///< pixels, whatever the unit; 0 where none is told
  int orientation = 1;

  /// Grey values, or red, green and blue, as they stand in the file.
  [[nodiscard]] bool plain() const;
};

/// A file that is being read. What libtiff calls an error, and a few of its warnings, which it goes on after with sizes
/// that it guessed, are errors here; it writes nothing to standard error.
class TiffFile
{
public:
  /// The first page. @throws InputError
  explicit TiffFile(FileBytes& file);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  /// @returns false behind the last page @throws InputError
  [[nodiscard]] bool next();
  /// @throws InputError
  void go(std::size_t page);
  [[nodiscard]] const TiffPage& page() const noexcept { return page_; }

  /// Do all strips or tiles lie inside the file, and can they hold the page? @throws InputError
  void check() const;

  /// The samples of a page as they are: width × height × samples numbers from the top row, in this machine's byte
  /// order. For those of 8 bits and more. @throws InputError
  void readSamples(void* to);

  /// Any page as 8-bit or 16-bit pixels: greys of fewer bits are stretched, palettes and other colours turned into red,
  /// green and blue; black is zero. @throws InputError
  [[nodiscard]] Pixels pixels();

private:
  struct Open;
  void look();
  [[nodiscard]] Pixels colours();
  std::unique_ptr<Open> open_;
  TiffPage page_;
  std::size_t number_ = 0;
};

/// What is written.
struct TiffForm
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t pages = 1;
  int bits = 8;
  int samples = 1; ///< 1 grey, 3 red, green, blue
  TiffNumbers numbers = TiffNumbers::Unsigned;
  std::optional<std::array<double, 2>> pixelSize{}; ///< [m]
};

/// Pages, packed without loss; a BigTIFF where they may pass 4 GiB.
class TiffWriter
{
public:
  /// Writes into the file, which may be there. Look at good().
  TiffWriter(const std::filesystem::path& path, const TiffForm& form);
  ~TiffWriter();
  TiffWriter(const TiffWriter&) = delete;
  TiffWriter& operator=(const TiffWriter&) = delete;

  [[nodiscard]] bool good() const noexcept { return good_; }
  /// The next page. @param rows from the top, in this machine's byte order @returns good()
  bool add(const void* rows, const std::string& description = {});
  /// All is written. @returns good()
  bool finish();

private:
  struct Open;
  std::unique_ptr<Open> open_;
  TiffForm form_;
  bool good_ = true;
};

} // namespace lamella::micrograph
