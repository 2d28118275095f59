#pragma once

#include "convert/Volume.h"
#include "session/OutputFile.h"

#include "pictures/Picture.h"
#include "pictures/RawVolume.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>

/// Volumes as plain numbers (pictures/RawVolume.h) for `lamella convert`: read in slabs, and written.
namespace lamella::cli
{

using micrograph::RawLayout;

/// What is said of a file that is read, raw volumes and pixel sizes.
struct RawOptions
{
  std::string file;
  micrograph::ReadOptions read;
  std::string type;  ///< of raw numbers; empty: from the name or the notes
  std::string order; ///< little or big; empty: little
};

/// @throws InputError, ParameterError
[[nodiscard]] RawLayout rawLayout(const std::string& path, const RawOptions& options);

/// Reads slabs of it (pictures/RawVolume.h), as `grey`.
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

/// The header of MetaImage, NRRD or NumPy.
/// @param sample    a layer of the volume
/// @param data      name of the file with the values; empty: they follow
[[nodiscard]] std::string metaHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data);
[[nodiscard]] std::string nrrdHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data);
[[nodiscard]] std::string numpyHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data);

} // namespace lamella::cli
