#include "micrograph/JpegDecode.h"

#include <csetjmp>
#include <cstdio> // jpeglib.h needs FILE and does not include it

#include <jpeglib.h>

namespace lamella::micrograph
{
namespace
{

struct Complaints
{
  jpeg_error_mgr manager; // first, so that libjpeg's pointer to it is a pointer to this
  std::jmp_buf giveUp;
  char text[JMSG_LENGTH_MAX];
};

Complaints& complaintsOf(j_common_ptr decoder)
{
  return *reinterpret_cast<Complaints*>(decoder->err);
}

void onError(j_common_ptr decoder)
{
  Complaints& complaints = complaintsOf(decoder);
  (*decoder->err->format_message)(decoder, complaints.text);
  std::longjmp(complaints.giveUp, 1);
}

void onMessage(j_common_ptr decoder, int level)
{
  if (level < 0) // a warning: data are corrupt
  {
    Complaints& complaints = complaintsOf(decoder);
    if (decoder->err->num_warnings++ == 0)
    {
      (*decoder->err->format_message)(decoder, complaints.text);
    }
  }
}

/// libjpeg leaves with longjmp, so nothing here may need a destructor: all that does belongs to the caller.
void decodeTo(
  std::span<const std::uint8_t> file, JpegPixels& result, jpeg_decompress_struct& decoder, Complaints& complaints)
{
  if (setjmp(complaints.giveUp) != 0)
  {
    return;
  }
  jpeg_create_decompress(&decoder);
  jpeg_mem_src(&decoder, file.data(), file.size());
  jpeg_read_header(&decoder, TRUE);
  decoder.out_color_space = decoder.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_start_decompress(&decoder);
  result.width = decoder.output_width;
  result.height = decoder.output_height;
  result.channels = decoder.output_components;
  const std::size_t row = static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.channels);
  result.values.resize(row * static_cast<std::size_t>(result.height));
  while (decoder.output_scanline < decoder.output_height)
  {
    JSAMPROW line = result.values.data() + row * decoder.output_scanline;
    jpeg_read_scanlines(&decoder, &line, 1);
  }
  jpeg_finish_decompress(&decoder);
}

} // namespace

JpegPixels decodeJpeg(std::span<const std::uint8_t> file)
{
  JpegPixels result;
  jpeg_decompress_struct decoder{};
  Complaints complaints{};
  decoder.err = jpeg_std_error(&complaints.manager);
  complaints.manager.error_exit = onError;
  complaints.manager.emit_message = onMessage;
  decodeTo(file, result, decoder, complaints);
  jpeg_destroy_decompress(&decoder);
  result.complaint = complaints.text;
  return result;
}

} // namespace lamella::micrograph
