#pragma once

#include "convert/Volume.h"
#include "files/Input.h"
#include "session/OutputFile.h"

#include "pictures/RawVolume.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>

/// Volumes as plain numbers (pictures/RawVolume.h) for `lamella convert`: read in slabs, and written.
namespace lamella::cli
{

using micrograph::RawLayout;

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
