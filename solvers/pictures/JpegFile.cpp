#include "pictures/JpegFile.h"

#include "pictures/TiffEntries.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <csetjmp>
#include <cstdio> // jpeglib.h needs FILE and does not include it
#include <cstdlib>
#include <cstring>
#include <memory>

#include <jerror.h>
#include <jpeglib.h>

namespace lamella::micrograph
{
namespace
{

struct Complaints
{
  jpeg_error_mgr manager; // first, so that libjpeg's pointer to it is a pointer to this
  std::jmp_buf giveUp;
  bool ended = false; ///< the file is too short
  char text[JMSG_LENGTH_MAX];
};

Complaints& complaintsOf(j_common_ptr jpeg)
{
  return *reinterpret_cast<Complaints*>(jpeg->err);
}

void onError(j_common_ptr jpeg)
{
  Complaints& complaints = complaintsOf(jpeg);
  (*jpeg->err->format_message)(jpeg, complaints.text);
  std::longjmp(complaints.giveUp, 1);
}

void onMessage(j_common_ptr jpeg, int level)
{
  if (level < 0) // a warning: data are corrupt
  {
    Complaints& complaints = complaintsOf(jpeg);
    complaints.ended |= jpeg->err->msg_code == JWRN_JPEG_EOF;
    if (jpeg->err->num_warnings++ == 0)
      (*jpeg->err->format_message)(jpeg, complaints.text);
  }
}

void listen(Complaints& complaints, jpeg_error_mgr*& to)
{
  to = jpeg_std_error(&complaints.manager);
  complaints.manager.error_exit = onError;
  complaints.manager.emit_message = onMessage;
}

/// A file that is being read. libjpeg leaves with longjmp, so nothing in the functions that say setjmp may need a
/// destructor.
class JpegReading
{
public:
  explicit JpegReading(FileBytes& file)
    : bytes_(file.read(0, file.size()))
  {
    listen(complaints_, jpeg.err);
    jpeg_create_decompress(&jpeg);
  }
  ~JpegReading() { jpeg_destroy_decompress(&jpeg); }
  JpegReading(const JpegReading&) = delete;
  JpegReading& operator=(const JpegReading&) = delete;

  [[nodiscard]] bool head()
  {
    if (setjmp(complaints_.giveUp) != 0)
      return false;
    jpeg_mem_src(&jpeg, bytes_.data(), bytes_.size());
    constexpr unsigned whole = 0xffff;
    jpeg_save_markers(&jpeg, JPEG_COM, whole);
    jpeg_save_markers(&jpeg, JPEG_APP0 + 1, whole);
    jpeg_read_header(&jpeg, TRUE);
    return true;
  }

  [[nodiscard]] bool pixels(Pixels& result)
  {
    if (setjmp(complaints_.giveUp) != 0)
      return false;
    jpeg.out_color_space = jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_start_decompress(&jpeg);
    result.width = jpeg.output_width;
    result.height = jpeg.output_height;
    result.channels = jpeg.output_components;
    const std::size_t row = static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.channels);
    result.values.resize(row * static_cast<std::size_t>(result.height));
    while (jpeg.output_scanline < jpeg.output_height)
    {
      JSAMPROW line = result.values.data() + row * jpeg.output_scanline;
      jpeg_read_scanlines(&jpeg, &line, 1);
    }
    jpeg_finish_decompress(&jpeg);
    return true;
  }

  [[nodiscard]] const char* complaint() const { return complaints_.text; }
  [[noreturn]] void refuse(const FileBytes& file) const
  {
    if (complaints_.ended)
      file.truncated("the JPEG ends before its pixels");
    undecodable(file, Format::Jpeg, complaints_.text);
  }

  jpeg_decompress_struct jpeg{};

private:
  std::vector<std::uint8_t> bytes_;
  Complaints complaints_{};
};

/// Resolution and orientation from the Exif block, which is a TIFF in memory; nothing where it is nonsense.
void readExif(const jpeg_marker_struct& marker, Probe& result)
{
  constexpr std::size_t name = 6;
  TiffSource source;
  source.read = [&](std::uint64_t at, std::uint64_t count) -> std::optional<std::vector<std::uint8_t>>
  {
    const std::uint64_t size = marker.data_length - name;
    if (at > size || count > size - at)
      return std::nullopt;
    const std::uint8_t* const from = marker.data + name + at;
    return std::vector<std::uint8_t>(from, from + count);
  };
  const auto first = source.open();
  const auto entries = first ? tiffEntries(source, *first) : std::nullopt;
  if (!entries)
    return;
  if (const auto size = resolution(*entries))
    result.size = MetadataSize{ (*size)[0], (*size)[1], std::nullopt, "Exif resolution" };
  if (const std::uint64_t turned = entries->number(TiffEntries::orientation, 1); turned != 1)
  {
    result.warnings.push_back(fmt::format(
      "the JPEG is to be shown turned or mirrored (Exif orientation {}); it is read as it is stored", turned));
  }
}

bool write(const Pixels& pixels, int quality, jpeg_compress_struct& jpeg, Complaints& complaints, unsigned char*& bytes,
  unsigned long& size)
{
  if (setjmp(complaints.giveUp) != 0)
    return false;
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(pixels.width);
  jpeg.image_height = static_cast<JDIMENSION>(pixels.height);
  jpeg.input_components = pixels.channels;
  jpeg.in_color_space = pixels.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t row = pixels.values.size() / static_cast<std::size_t>(pixels.height);
  while (jpeg.next_scanline < jpeg.image_height)
  {
    JSAMPROW line = const_cast<JSAMPROW>(pixels.values.data()) + row * jpeg.next_scanline; // NOLINT: it is only read
    jpeg_write_scanlines(&jpeg, &line, 1);
  }
  jpeg_finish_compress(&jpeg);
  return true;
}

} // namespace

Probe probeJpeg(FileBytes& file)
{
  JpegReading reading(file);
  const bool sound = reading.head();
  const jpeg_decompress_struct& jpeg = reading.jpeg;
  if (jpeg.num_components == 4)
  {
    throw InputError(fmt::format("'{}' is a CMYK JPEG, made for printing", file.name()),
      "convert it to grey or RGB first, for example: convert in.jpg -colorspace Gray out.png");
  }
  const bool usual = jpeg.data_precision == 8 && (jpeg.num_components == 1 || jpeg.num_components == 3);
  if (jpeg.num_components > 0 && !usual)
  {
    throw InputError(fmt::format("'{}' is a JPEG with {} components of {} bits", file.name(), jpeg.num_components,
                       jpeg.data_precision),
      "save it as an 8-bit grey or RGB picture");
  }
  if (!sound)
    reading.refuse(file);
  Probe result;
  result.format = Format::Jpeg;
  result.width = jpeg.image_width;
  result.height = jpeg.image_height;
  result.channels = jpeg.num_components;
  for (const jpeg_marker_struct* marker = jpeg.marker_list; marker != nullptr; marker = marker->next)
    if (marker->marker == JPEG_COM && result.description.empty())
      result.description.assign(reinterpret_cast<const char*>(marker->data), marker->data_length);
    else if (marker->marker == JPEG_APP0 + 1 && marker->data_length > 6 &&
      std::memcmp(marker->data, "Exif\0\0", 6) == 0)
      readExif(*marker, result);
  // Per inch, per centimetre, or only a ratio.
  const double unit = jpeg.density_unit == 1 ? 0.0254 : jpeg.density_unit == 2 ? 0.01 : 0;
  if (jpeg.saw_JFIF_marker != 0 && unit > 0 && jpeg.X_density > 0 && jpeg.Y_density > 0)
    result.size = MetadataSize{ unit / jpeg.X_density, unit / jpeg.Y_density, std::nullopt, "JFIF density" };
  checkBytes(file, result, file.size(), 5000); // even progressive scans of one grey stay below
  return result;
}

Pixels decodeJpeg(FileBytes& file)
{
  JpegReading reading(file);
  Pixels result;
  if (!reading.head() || !reading.pixels(result) || *reading.complaint() != '\0')
    reading.refuse(file);
  return result;
}

std::vector<std::uint8_t> encodeJpeg(const Pixels& pixels, int quality)
{
  jpeg_compress_struct jpeg{};
  Complaints complaints{};
  listen(complaints, jpeg.err);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool written = write(pixels, quality, jpeg, complaints, bytes, size);
  jpeg_destroy_compress(&jpeg);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owned(bytes, &std::free);
  if (!written)
  {
    throw ParameterError(fmt::format("a picture of {} × {} pixels cannot be written as JPEG: {}", pixels.width,
                           pixels.height, complaints.text),
      "write a PNG instead");
  }
  return { bytes, bytes + size };
}

} // namespace lamella::micrograph
