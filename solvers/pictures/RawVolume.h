#pragma once

#include "pictures/FileBytes.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Volumes as plain numbers: raw files, and MetaImage (.mhd, .mha), NRRD (.nhdr, .nrrd), NumPy (.npy), NIfTI (.nii,
/// .nii.gz, .hdr) and VTK's legacy files (.vtk), which are such numbers with a header. They may be larger than memory.
namespace lamella::micrograph
{

/// A type of numbers.
struct NumberType
{
  char kind = 'u'; ///< u unsigned, i signed, f real
  int bytes = 1;   ///< 1, 2, 4 or 8; of real ones 4 or 8

  bool operator==(const NumberType&) const = default;
  [[nodiscard]] std::string name() const; ///< u8, i16, f32 …
};

/// Where the numbers of a volume lie and what they are.
struct RawLayout
{
  std::filesystem::path file;
  std::uint64_t offset = 0; ///< of the first value
  bool fromEnd = false;     ///< the values are the last bytes of the file
  std::uint64_t after = 0;  ///< bytes behind the last value, which are none
  bool packed = false;      ///< by zlib or gzip
  std::uint64_t skip = 0;   ///< unpacked bytes before the first value
  NumberType type;
  int components = 1; ///< values a voxel
  bool bigEndian = false;
  int axes = 3; ///< that the file speaks of: 1 to 3
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::array<double, 3> spacing{ 1, 1, 1 }; ///< [m]
  std::array<double, 3> origin{ 0, 0, 0 };  ///< of the first voxel's middle [m]
  std::array<double, 9> direction{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  bool unitTold = true; ///< false: a header that names no unit, whose numbers are taken as metres
  std::string pixelSizeSource = "none";
};

/// What somebody says of a raw file.
struct RawSaid
{
  std::optional<std::array<std::int64_t, 3>> size;
  std::optional<NumberType> type;
  std::optional<NumberType> otherwise; ///< the type where nothing tells it
  int components = 1;
  std::uint64_t offset = 0;
  bool bigEndian = false;
};

/// What is not said follows from the name, such as berea_200x200x200_u8.raw, and the type then from the file's size.
/// @throws InputError: the size or the type is not known
[[nodiscard]] RawLayout rawLayout(const std::filesystem::path& path, const RawSaid& said);

/// A header of this kind, by the ending of a name and by the first bytes of the file.
enum class RawHeader
{
  None,
  Meta,
  Nrrd,
  Numpy,
  Nifti,
  LegacyVtk
};
[[nodiscard]] RawHeader rawHeader(const std::filesystem::path& path);
[[nodiscard]] std::string name(RawHeader header); ///< "raw", "MetaImage", "NRRD", "NumPy", "NIfTI", "VTK legacy"

/// What MetaImage calls its types, and NRRD its own.
[[nodiscard]] std::string metaTypeName(NumberType type);
[[nodiscard]] std::string nrrdTypeName(NumberType type);

/// @throws InputError: a header that cannot be used
[[nodiscard]] RawLayout metaLayout(const std::filesystem::path& path);
[[nodiscard]] RawLayout nrrdLayout(const std::filesystem::path& path);
/// An array as numpy.save() writes it, [z, y, x] or [y, x]; a fourth axis holds the values of a voxel. True and False
/// are 1 and 0. No spacing.
[[nodiscard]] RawLayout numpyLayout(const std::filesystem::path& path);
/// NIfTI-1 and -2, in one file, packed by gzip or not, or .hdr with .img beside it. Place and direction from the sform,
/// else the qform.
[[nodiscard]] RawLayout niftiLayout(const std::filesystem::path& path);
/// STRUCTURED_POINTS with one array, binary. Values in cells are voxels at their middles. A spacing of 1 1 1 says
/// nothing.
[[nodiscard]] RawLayout legacyVtkLayout(const std::filesystem::path& path);
/// That of the header which it has. @param header not None
[[nodiscard]] RawLayout headerLayout(const std::filesystem::path& path, RawHeader header);
/// Whether a file begins as NIfTI does, packed or not.
[[nodiscard]] bool beginsAsNifti(const std::filesystem::path& path);

/// The numbers themselves.
class RawVolume
{
public:
  /// @throws InputError: no file; another size than the layout says (both in the message), or more than it can unpack
  /// to
  explicit RawVolume(const RawLayout& layout);
  ~RawVolume();
  RawVolume(const RawVolume&) = delete;
  RawVolume& operator=(const RawVolume&) = delete;

  [[nodiscard]] const RawLayout& layout() const noexcept { return layout_; }
  /// Of a layer.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return layer_; }

  /// Layers `first` to `last`, in the byte order of this machine. Packed values are unpacked from the beginning once,
  /// or again where layers lie before those that were read last.
  /// @param to (last − first + 1) × bytes() bytes
  void read(std::int64_t first, std::int64_t last, void* to);

  /// A part of the rows of a layer that is not packed, without reading the others: `count` values from x, y, z on, as
  /// they follow each other in the file.
  void readRun(const std::array<std::int64_t, 3>& from, std::uint64_t count, void* to);

private:
  class Unpacker;
  void unpack(std::uint8_t* to, std::int64_t first, std::int64_t last);
  void swap(void* values, std::uint64_t bytes) const;

  RawLayout layout_;
  FileBytes file_;
  std::uint64_t layer_ = 0;
  std::uint64_t begin_ = 0;
  std::unique_ptr<Unpacker> unpacker_;
  std::int64_t next_ = 0;          ///< the layer that comes next
  std::vector<std::uint8_t> kept_; ///< the last layer that was unpacked
};

} // namespace lamella::micrograph
