#include "micrograph/PngDecode.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>

namespace lamella::micrograph
{
namespace
{

/// What libpng calls back with: the bytes that are left, and room for what it says.
struct Reading
{
  std::span<const std::uint8_t> left;
  std::vector<png_bytep> rows;
  PngPixels& result;
};

void onError(png_structp decoder, png_const_charp text)
{
  static_cast<Reading*>(png_get_error_ptr(decoder))->result.complaint = text;
  png_longjmp(decoder, 1);
}

void onWarning(png_structp, png_const_charp) {} // of what is not pixels; ProbePng.cpp looks at that

void onRead(png_structp decoder, png_bytep to, std::size_t count)
{
  auto& left = static_cast<Reading*>(png_get_io_ptr(decoder))->left;
  if (count > left.size())
  {
    png_error(decoder, "the file ends too early");
  }
  std::copy_n(left.begin(), count, to);
  left = left.subspan(count);
}

/// libpng leaves with longjmp, so nothing here may need a destructor: all that does belongs to the caller.
void decodeTo(Reading& reading, png_structp decoder, png_infop info)
{
  if (setjmp(png_jmpbuf(decoder)) != 0)
  {
    return;
  }
  png_set_user_limits(decoder, PNG_UINT_31_MAX, PNG_UINT_31_MAX); // the caller has its own
  png_set_read_fn(decoder, &reading, onRead);
  png_read_info(decoder, info);
  const int kind = png_get_color_type(decoder, info);
  if (kind == PNG_COLOR_TYPE_PALETTE)
  {
    png_set_palette_to_rgb(decoder);
    if (png_get_valid(decoder, info, PNG_INFO_tRNS) != 0)
    {
      png_set_tRNS_to_alpha(decoder);
    }
  }
  else if (kind == PNG_COLOR_TYPE_GRAY)
  {
    png_set_expand_gray_1_2_4_to_8(decoder);
  }
  if (std::endian::native == std::endian::little && png_get_bit_depth(decoder, info) == 16)
  {
    png_set_swap(decoder);
  }
  (void)png_set_interlace_handling(decoder);
  png_read_update_info(decoder, info);

  PngPixels& result = reading.result;
  result.width = png_get_image_width(decoder, info);
  result.height = png_get_image_height(decoder, info);
  result.channels = png_get_channels(decoder, info);
  result.bits = png_get_bit_depth(decoder, info);
  const std::size_t row = png_get_rowbytes(decoder, info);
  result.values.resize(row * static_cast<std::size_t>(result.height));
  reading.rows.resize(static_cast<std::size_t>(result.height));
  for (std::size_t i = 0; i < reading.rows.size(); ++i)
  {
    reading.rows[i] = result.values.data() + row * i;
  }
  png_read_image(decoder, reading.rows.data());
}

} // namespace

PngPixels decodePng(std::span<const std::uint8_t> file)
{
  PngPixels result;
  Reading reading{ file, {}, result };
  png_structp decoder = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, onError, onWarning);
  png_infop info = decoder == nullptr ? nullptr : png_create_info_struct(decoder);
  if (info == nullptr)
  {
    result.complaint = "libpng has no memory, or is of another version";
  }
  else
  {
    decodeTo(reading, decoder, info);
  }
  png_destroy_read_struct(&decoder, &info, nullptr);
  return result;
}

} // namespace lamella::micrograph
