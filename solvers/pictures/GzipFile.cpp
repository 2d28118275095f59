#include "pictures/GzipFile.h"

#include "core/Error.h"
#include "core/WholeFile.h"
#include "pictures/FileBytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace lamella::micrograph
{
namespace
{

constexpr int anyWindow = 15 + 16; // the largest window, gzip's header

struct InflateEnd
{
  void operator()(z_stream* s) const { inflateEnd(s); }
};
struct DeflateEnd
{
  void operator()(z_stream* s) const { deflateEnd(s); }
};

[[nodiscard]] std::string unpack(std::vector<std::uint8_t> bytes, const std::string& name, std::size_t most)
{
  z_stream stream{};
  if (inflateInit2(&stream, anyWindow) != Z_OK)
    throw MemoryError(fmt::format("'{}' cannot be unpacked: no memory", name), "close other programs");
  const std::unique_ptr<z_stream, InflateEnd> end(&stream);
  std::string text;
  std::array<char, 1 << 16> part{};
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  for (;;)
  {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    const int state = inflate(&stream, Z_NO_FLUSH);
    text.append(part.data(), part.size() - stream.avail_out);
    if (text.size() > most)
    {
      throw InputError(fmt::format("'{}' holds more than {} MiB when unpacked", name, most >> 20U),
        "split it, or leave out what is not needed");
    }
    if (state == Z_STREAM_END)
    {
      if (stream.avail_in == 0)
        return text;
      inflateReset(&stream); // gzip files may follow each other
    }
    else if (state != Z_OK)
    {
      throw InputError(fmt::format("'{}' is damaged: its gzip stream {}", name,
                         state == Z_BUF_ERROR ? "ends too early" : "cannot be unpacked"),
        "copy, download or pack it again (gzip -t tests it)");
    }
  }
}

} // namespace

std::string readText(const std::filesystem::path& path, std::size_t most)
{
  FileBytes file(path);
  if (file.size() > most)
  {
    throw InputError(fmt::format("'{}' has {} MiB; {} are taken", file.name(), file.size() >> 20U, most >> 20U),
      "split it, or leave out what is not needed");
  }
  std::vector<std::uint8_t> bytes = file.read(0, file.size());
  if (bytes.size() > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b)
    return unpack(std::move(bytes), file.name(), most);
  return { bytes.begin(), bytes.end() };
}

void writeText(const std::string& text, const std::filesystem::path& path)
{
  std::string packed;
  if (path.extension() == ".gz")
  {
    z_stream stream{};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, anyWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw MemoryError(fmt::format("'{}' cannot be packed: no memory", path.string()), "leave out .gz");
    const std::unique_ptr<z_stream, DeflateEnd> end(&stream);
    packed.resize(deflateBound(&stream, text.size()));
    std::string from = text; // zlib's interface wants it writable
    stream.next_in = reinterpret_cast<Bytef*>(from.data());
    stream.avail_in = static_cast<uInt>(from.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    if (deflate(&stream, Z_FINISH) != Z_STREAM_END)
      throw InputError(fmt::format("'{}' cannot be packed", path.string()), "leave out .gz");
    packed.resize(stream.total_out);
  }
  const std::string& bytes = path.extension() == ".gz" ? packed : text;
  writeWhole(path, std::as_bytes(std::span(bytes)));
}

} // namespace lamella::micrograph
