#pragma once

#include "lattice/GreyBins.h"
#include "lattice/Phases.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Grey values of a picture or volume in lattice order (2D: first row in memory = bottom row of the picture; volumes:
/// the order of the file).
struct Picture
{
  Lattice lattice;                        ///< spacing from the option or the metadata, 1 where neither says
  std::array<std::int64_t, 3> fileSize{}; ///< nodes in the file, before the window
  std::vector<std::uint16_t> grey;        ///< one value a node; 8-bit values stay 0 … 255
  std::optional<GreyBins> levels;         ///< of which `grey` holds the numbers
  std::vector<std::uint16_t> colour; ///< red, green, blue of every node; empty unless asked for and there is colour
  int bits = 8;                      ///< 8 or 16
  std::string format;                ///< "PNG", "JPEG", "TIFF", "PGM", "PPM", "BMP", or as name(RawHeader) has it
  std::string pixelSizeSource;       ///< "option", "PNG pHYs", "TIFF resolution", "ImageJ", "OME-XML", … or "none"
  std::string description;           ///< the text that the file carries, provenance for our own; may be empty
  std::string provenance;            ///< of a PNG that lamella drew; JSON text, or empty
  std::vector<std::string> warnings; ///< what a user should know, each one line
};

/// How a file is read. Pixel size is never guessed: without metadata or option the lattice has spacing 1 and
/// `pixelSizeSource` is "none"; effective conductivities do not depend on it, pictures then show pixels, not µm.
struct ReadOptions
{
  std::optional<double> pixelSize;     ///< [m]; wins over metadata
  std::optional<double> sliceDistance; ///< [m], of volumes whose voxels are not cubes; wins over metadata
  /// Greys are no phases, but lie between these two: numbers that are no greys of 16 bits are read, too, and become
  /// levels.
  std::optional<GreyBins> levels;
  bool keepColour = false;                            ///< colour pictures are read, not refused (for segment())
  std::optional<std::array<std::int64_t, 3>> rawSize; ///< raw volumes: nx, ny, nz
  std::optional<int> rawBits;                         ///< raw volumes: 8 or 16; else from the name or the file's size
  std::uint64_t rawHeader = 0;                        ///< raw volumes: bytes before the data
  bool rawBigEndian = false;                          ///< raw volumes of 16 bits: high byte first
  std::optional<Window> window; ///< keep this part only; of raw volumes and of slices in files of their own no more of
                                ///< the file is read
  /// Told the size of the whole file before memory is taken for its values; throws to refuse it.
  std::function<void(const Lattice& whole)> sizeKnown;
};

/// Reads a picture or a volume. What a file is follows from its first bytes, not from its name:
/// - PNG, JPEG, TIFF, PGM, PPM, BMP: a picture. Several pages in a TIFF: a volume, one slice a page (reduced copies are
/// left out).
/// - A folder of such files, or a name with `*`, `?` or one `%d` (`%04d`): a volume, slices in the order of the numbers
/// in
///   their names. With `%d` a missing number is an error, otherwise a warning.
/// - .raw or .bin: a volume; size from `rawSize` or from a name such as berea_200x200x200_u8.raw.
/// - MetaImage (.mhd, .mha), NRRD and NIfTI, packed or not, arrays of NumPy (.npy), VTK's legacy files (.vtk): a
///   volume, or a picture where they have two axes.
///
/// Numbers of volumes that are not unsigned ones of 8 or 16 bits have to be whole ones from 0 to 65535.
///
/// Palette, RGB and transparent pictures whose channels are all equal become grey; other colour pictures are refused
/// with the remedy (convert to grey, or segment with --segment) unless `keepColour`, where grey is 0.299 R + 0.587 G +
/// 0.114 B. One-bit pictures have greys 0 and 255.
///
/// Pixel size comes from PNG pHYs, JFIF or Exif density, TIFF resolution, and from what ImageJ and OME write into TIFF.
/// A size above 20 µm is what printers' resolutions (72, 96, 300 dpi …) come to: it is left out, with a warning.
///
/// @throws InputError for a missing, empty, truncated, damaged, unreadable, CMYK or colour file, for slices of
/// different
///         sizes and for pixels that are not square; MemoryError; ParameterError for an option outside its range
[[nodiscard]] Picture readPicture(const std::filesystem::path& path, const ReadOptions& options = {});

/// Cuts off all but the window, so that greys outside it need no phase.
/// @throws ParameterError as firstNode()
void crop(Picture& picture, const Window& window);

} // namespace lamella::micrograph
