#pragma once

#include "Input.h"
#include "OutputFile.h"
#include "convert/Volume.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

/// Volumes as plain numbers: raw files, and MetaImage (.mhd, .mha) and NRRD (.nhdr, .nrrd), which are such numbers with
/// a header.
namespace lamella::cli
{

/// Where the numbers of a volume lie and what they are.
struct RawLayout
{
  std::filesystem::path file;
  std::uint64_t offset = 0; ///< of the first value
  bool fromEnd = false;     ///< the values are the last bytes of the file
  bool packed = false;      ///< by zlib or gzip
  int type = 0;             ///< VTK's number
  int components = 1;
  bool bigEndian = false;
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::array<double, 3> spacing{ 1, 1, 1 };
  std::array<double, 3> origin{ 0, 0, 0 };
  std::array<double, 9> direction{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  std::string pixelSizeSource = "none";
  std::string name = "grey";
};

/// What the command line says of a raw volume, with the words that all commands share for it.
struct RawOptions
{
  PictureOptions picture;
  std::string type;  ///< --raw-type
  std::string order; ///< --raw-order
};

/// Declares --raw-type and --raw-order; addRawOptions() the others.
void addRawTypeOptions(CLI::App& command, RawOptions& options);

/// @throws InputError, ParameterError
[[nodiscard]] RawLayout rawLayout(const std::string& path, const RawOptions& options);
[[nodiscard]] RawLayout metaLayout(const std::string& path);
[[nodiscard]] RawLayout nrrdLayout(const std::string& path);

/// Reads slabs of it. Packed values are unpacked from the beginning once, or again where a slab lies before the last.
/// @throws InputError: the file has another size than the layout says (both in the message)
[[nodiscard]] std::unique_ptr<Volume> openRaw(const RawLayout& layout);

/// Bytes that are written to an output file bit by bit. @throws OutputError
class ByteStream
{
public:
  explicit ByteStream(const OutputFile& file);
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  void write(const void* bytes, std::size_t count);
  void write(const std::string& text) { this->write(text.data(), text.size()); }
  /// What is still to be written reaches the file.
  void finish();

private:
  const OutputFile& file_;
  int number_ = -1;
};

/// The header of MetaImage or NRRD.
/// @param sample    a layer of the volume
/// @param data      name of the file with the values; empty: they follow
[[nodiscard]] std::string metaHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data);
[[nodiscard]] std::string nrrdHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data);

} // namespace lamella::cli
