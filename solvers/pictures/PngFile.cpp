#include "pictures/PngFile.h"

#include "core/Error.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

namespace lamella::micrograph
{
namespace
{

/// What libpng calls back with.
struct PngTalk
{
  FileBytes* file = nullptr;               ///< that is read
  std::uint64_t at = 0;                    ///< and where
  std::vector<std::uint8_t>* to = nullptr; ///< what is written
  bool ended = false;                      ///< the file is too short
  std::string complaint;                   ///< what went wrong
  std::vector<std::string> wrong;          ///< chunks that were left out for their checksums
};

void onError(png_structp png, png_const_charp text)
{
  static_cast<PngTalk*>(png_get_error_ptr(png))->complaint = text;
  png_longjmp(png, 1);
}

void onWarning(png_structp png, png_const_charp text)
{
  // Of a chunk that is too large memory would be taken; that of the end holds nothing, and libpng 1.6.48 only warns of
  // it.
  if (std::strstr(text, "too large") != nullptr || std::strcmp(text, "IEND: CRC error") == 0)
    onError(png, text);
  auto& wrong = static_cast<PngTalk*>(png_get_error_ptr(png))->wrong;
  constexpr std::size_t most = 20; // of what a file can hold thousands of
  if (std::strstr(text, "CRC error") != nullptr && wrong.size() < most)
    wrong.emplace_back(text, std::strcspn(text, ":"));
}

void onRead(png_structp png, png_bytep to, std::size_t count)
{
  PngTalk& talk = *static_cast<PngTalk*>(png_get_io_ptr(png));
  talk.ended = !talk.file->holds(talk.at, count);
  bool read = !talk.ended;
  try
  {
    if (read)
      talk.file->read(talk.at, to, count);
  }
  catch (const std::exception&)
  {
    read = false; // no exception goes through libpng
  }
  if (!read)
    png_error(png, talk.ended ? "the file ends too early" : "the file cannot be read");
  talk.at += count;
}

void onWrite(png_structp png, png_bytep from, std::size_t count)
{
  PngTalk& talk = *static_cast<PngTalk*>(png_get_io_ptr(png));
  bool written = true;
  try
  {
    talk.to->insert(talk.to->end(), from, from + count);
  }
  catch (const std::exception&)
  {
    written = false;
  }
  if (!written)
    png_error(png, "no memory");
}

void onFlush(png_structp) {}

/// A file that is being read. libpng leaves with longjmp, so nothing in the functions that say setjmp may need a
/// destructor.
class PngReading
{
public:
  explicit PngReading(FileBytes& file)
  {
    talk.file = &file;
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &talk, onError, onWarning);
    info = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    end = info == nullptr ? nullptr : png_create_info_struct(png_);
    if (end == nullptr)
    {
      png_destroy_read_struct(&png_, &info, nullptr);
      throw MemoryError("libpng has no memory, or is of another version", "close other programs");
    }
  }
  ~PngReading() { png_destroy_read_struct(&png_, &info, &end); }
  PngReading(const PngReading&) = delete;
  PngReading& operator=(const PngReading&) = delete;

  [[nodiscard]] bool head()
  {
    if (setjmp(png_jmpbuf(png_)) != 0)
      return false;
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX); // the caller has its own
    // No chunk is larger than the file; a packed text may be.
    png_set_chunk_malloc_max(png_, std::max<png_alloc_size_t>(talk.file->size(), 8000000));
    png_set_read_fn(png_, &talk, onRead);
    png_read_info(png_, info);
    return true;
  }

  [[nodiscard]] bool pixels(Pixels& result)
  {
    if (setjmp(png_jmpbuf(png_)) != 0)
      return false;
    const int kind = png_get_color_type(png_, info);
    if (kind == PNG_COLOR_TYPE_PALETTE)
    {
      png_set_palette_to_rgb(png_);
      if (png_get_valid(png_, info, PNG_INFO_tRNS) != 0)
        png_set_tRNS_to_alpha(png_);
    }
    else if (kind == PNG_COLOR_TYPE_GRAY)
    {
      png_set_expand_gray_1_2_4_to_8(png_);
    }
    if (std::endian::native == std::endian::little && png_get_bit_depth(png_, info) == 16)
      png_set_swap(png_);
    (void)png_set_interlace_handling(png_);
    png_read_update_info(png_, info);
    result.width = png_get_image_width(png_, info);
    result.height = png_get_image_height(png_, info);
    result.channels = png_get_channels(png_, info);
    result.bits = png_get_bit_depth(png_, info);
    const std::size_t row = png_get_rowbytes(png_, info);
    result.values.resize(row * static_cast<std::size_t>(result.height));
    rows_.resize(static_cast<std::size_t>(result.height));
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_[i] = result.values.data() + row * i;
    png_read_image(png_, rows_.data());
    png_read_end(png_, end);
    return true;
  }

  /// Size, kind, pixel size and texts so far.
  void tell(const FileBytes& file, png_infop from, Probe& probe)
  {
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(png_, from, &texts, &count);
    for (int i = 0; i < count; ++i)
    {
      for (auto [keyword, text] :
        { std::pair{ "Description", &probe.description }, { "provenance", &probe.provenance } })
        if (text->empty() && std::strcmp(texts[i].key, keyword) == 0 && texts[i].text != nullptr)
          *text = texts[i].text;
    }
    png_uint_32 x = 0;
    png_uint_32 y = 0;
    int unit = 0;
    if (png_get_pHYs(png_, from, &x, &y, &unit) != 0 && x > 0 && y > 0)
    {
      if (unit == PNG_RESOLUTION_METER)
      {
        probe.size = MetadataSize{ 1.0 / x, 1.0 / y, std::nullopt, "PNG pHYs" };
      }
      else if (x != y)
      {
        probe.warnings.push_back(
          fmt::format("the PNG says that its pixels are not square ({} to {}); they are taken as square", x, y));
      }
    }
    for (const std::string& chunk : talk.wrong)
    {
      probe.warnings.push_back(
        fmt::format("'{}' is damaged: the checksum of its {} chunk is wrong; left out", file.name(), chunk));
    }
    talk.wrong.clear();
  }

  /// Number of channels as they are decoded.
  [[nodiscard]] int channels() const
  {
    const int kind = png_get_color_type(png_, info);
    const bool seeThrough =
      (kind & PNG_COLOR_MASK_ALPHA) != 0 || (kind != 0 && png_get_valid(png_, info, PNG_INFO_tRNS) != 0);
    return kind == PNG_COLOR_TYPE_GRAY ? 1 : seeThrough ? 4 : 3;
  }
  [[nodiscard]] int bits() const
  {
    const bool palette = png_get_color_type(png_, info) == PNG_COLOR_TYPE_PALETTE;
    return palette ? 8 : std::max<int>(8, png_get_bit_depth(png_, info));
  }
  [[nodiscard]] std::int64_t width() const { return png_get_image_width(png_, info); }
  [[nodiscard]] std::int64_t height() const { return png_get_image_height(png_, info); }

  [[noreturn]] void refuse(const FileBytes& file) const
  {
    if (talk.ended)
      file.truncated("the PNG ends before its IEND chunk");
    undecodable(file, Format::Png, talk.complaint);
  }

  PngTalk talk;
  png_infop info = nullptr;
  png_infop end = nullptr;

private:
  png_structp png_ = nullptr;
  std::vector<png_bytep> rows_;
};

bool write(png_structp png, png_infop info, const Pixels& pixels, png_uint_32 perMetre, png_textp text, int effort,
  PngTalk& talk)
{
  if (setjmp(png_jmpbuf(png)) != 0)
    return false;
  constexpr int kinds[] = { PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
    PNG_COLOR_TYPE_RGB_ALPHA };
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_write_fn(png, &talk, onWrite, onFlush);
  png_set_compression_level(png, effort);
  png_set_IHDR(png, info, static_cast<png_uint_32>(pixels.width), static_cast<png_uint_32>(pixels.height), pixels.bits,
    kinds[pixels.channels - 1], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (perMetre > 0)
    png_set_pHYs(png, info, perMetre, perMetre, PNG_RESOLUTION_METER);
  if (text->text_length > 0 || text->itxt_length > 0)
    png_set_text(png, info, text, 1);
  png_write_info(png, info);
  if (std::endian::native == std::endian::little && pixels.bits == 16)
    png_set_swap(png);
  const std::size_t row = pixels.values.size() / static_cast<std::size_t>(pixels.height);
  for (std::size_t y = 0; y < static_cast<std::size_t>(pixels.height); ++y)
    png_write_row(png, pixels.values.data() + row * y);
  png_write_end(png, info);
  return true;
}

} // namespace

Probe probePng(FileBytes& file)
{
  PngReading reading(file);
  if (!reading.head())
    reading.refuse(file);
  Probe result;
  result.format = Format::Png;
  result.width = reading.width();
  result.height = reading.height();
  result.bits = reading.bits();
  result.channels = reading.channels();
  reading.tell(file, reading.info, result);
  checkBytes(file, result, file.size(), 1100); // deflate packs at most 1032 bytes into one
  return result;
}

Pixels decodePng(FileBytes& file, Probe& probe)
{
  PngReading reading(file);
  Pixels result;
  if (!reading.head() || reading.width() != probe.width || reading.height() != probe.height || !reading.pixels(result))
    reading.refuse(file);
  std::vector<std::string> warnings = std::move(probe.warnings); // those of the head are told already
  reading.tell(file, reading.end, probe);
  for (std::string& warning : probe.warnings)
    if (std::ranges::find(warnings, warning) == warnings.end())
      warnings.push_back(std::move(warning));
  probe.warnings = std::move(warnings);
  return result;
}

std::vector<std::uint8_t> encodePng(const Pixels& pixels, double perMetre, std::string_view description, int effort)
{
  std::vector<std::uint8_t> bytes;
  std::string words(description);
  char keyword[] = "Description";
  char none[] = "";
  png_text text{};
  text.compression = PNG_ITXT_COMPRESSION_NONE;
  text.key = keyword;
  text.text = words.data();
  text.itxt_length = words.size();
  text.lang = none;
  text.lang_key = none;
  PngTalk talk;
  talk.to = &bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &talk, onError, onWarning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const bool told = perMetre >= 1 && perMetre < 2147483648.0;
  const bool written = info != nullptr &&
    write(png, info, pixels, told ? static_cast<png_uint_32>(perMetre) : 0, &text, std::clamp(effort, 0, 9), talk);
  png_destroy_write_struct(&png, &info);
  if (!written)
  {
    throw ParameterError(fmt::format("a picture of {} × {} pixels cannot be written as PNG{}", pixels.width,
                           pixels.height, talk.complaint.empty() ? "" : ": " + talk.complaint),
      "write a TIFF instead");
  }
  return bytes;
}

} // namespace lamella::micrograph
