#include "pictures/TiffFile.h"

#include "pictures/Probe.h"
#include "pictures/TiffEntries.h"

#include "core/Error.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <utility>

namespace lamella::micrograph
{
namespace
{

/// The most that libtiff may take for one thing: pixels are ours, so this is for a strip, a tile or a list of these.
constexpr tmsize_t mostOfOne = tmsize_t{ 1 } << 31;

/// What libtiff calls back with.
struct TiffTalk
{
  FileBytes* file = nullptr;
  std::uint64_t at = 0;
  bool beyond = false;             ///< something was to be read behind the end
  std::vector<std::uint8_t> all{}; ///< the file, where libtiff is to have it in memory
  std::string complaint;           ///< the last
};

int onError(TIFF*, void* data, const char*, const char* format, va_list values)
{
  char text[256];
  std::vsnprintf(text, sizeof text, format, values);
  static_cast<TiffTalk*>(data)->complaint = text;
  return 1;
}

int onWarning(TIFF*, void* data, const char*, const char* format, va_list values)
{
  // It would go on with sizes that it works out by itself.
  const bool guessed = std::strncmp(format, "Bogus", 5) == 0 || std::strncmp(format, "Improper", 8) == 0;
  return guessed ? onError(nullptr, data, nullptr, format, values) : 1;
}

tmsize_t onRead(thandle_t handle, void* to, tmsize_t count)
{
  TiffTalk& talk = *static_cast<TiffTalk*>(handle);
  const auto wanted = static_cast<std::uint64_t>(count);
  const std::uint64_t left = talk.file->size() - std::min(talk.at, talk.file->size());
  talk.beyond |= wanted > left;
  try
  {
    talk.file->read(talk.at, to, std::min(wanted, left));
  }
  catch (const std::exception&)
  {
    return -1; // no exception goes through libtiff
  }
  talk.at += std::min(wanted, left);
  return static_cast<tmsize_t>(std::min(wanted, left));
}

tmsize_t onWrite(thandle_t, void*, tmsize_t)
{
  return -1;
}

toff_t onSeek(thandle_t handle, toff_t to, int from)
{
  TiffTalk& talk = *static_cast<TiffTalk*>(handle);
  talk.at = to + (from == SEEK_CUR ? talk.at : from == SEEK_END ? talk.file->size() : 0);
  return talk.at;
}

int onClose(thandle_t)
{
  return 0;
}

toff_t onSize(thandle_t handle)
{
  return static_cast<TiffTalk*>(handle)->file->size();
}

int onMap(thandle_t handle, void** base, toff_t* size)
{
  TiffTalk& talk = *static_cast<TiffTalk*>(handle);
  *base = talk.all.data();
  *size = talk.all.size();
  return talk.all.empty() ? 0 : 1;
}

void onUnmap(thandle_t, void*, toff_t) {}

struct Options
{
  explicit Options(TiffTalk& talk)
    : options(TIFFOpenOptionsAlloc())
  {
    TIFFOpenOptionsSetErrorHandlerExtR(options, onError, &talk);
    TIFFOpenOptionsSetWarningHandlerExtR(options, onWarning, &talk);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, mostOfOne);
  }
  ~Options() { TIFFOpenOptionsFree(options); }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
  TIFFOpenOptions* options;
};

template <typename Value>
Value field(TIFF* tiff, std::uint32_t tag, Value otherwise)
{
  Value value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

bool isJpeg(int packing)
{
  return packing == COMPRESSION_JPEG || packing == COMPRESSION_OJPEG;
}

/// A file that libtiff has open, and what it says of it.
struct Opened
{
  Opened() = default;
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened()
  {
    if (tiff != nullptr)
      TIFFClose(tiff);
  }

  TiffTalk talk;
  TIFF* tiff = nullptr;
};

} // namespace

bool TiffPage::plain() const
{
  const bool shape =
    (photometric == PHOTOMETRIC_MINISBLACK && samples == 1) || (photometric == PHOTOMETRIC_RGB && samples == 3);
  const bool whole = bits == 8 || bits == 16 || bits == 32 || bits == 64;
  const bool known =
    numbers == SAMPLEFORMAT_UINT || numbers == SAMPLEFORMAT_INT || (numbers == SAMPLEFORMAT_IEEEFP && bits >= 32);
  return shape && whole && known && !isJpeg(packing);
}

struct TiffFile::Open : Opened
{
  /// The first page.
  void open(FileBytes& file)
  {
    talk.file = &file;
    const Options options(talk);
    tiff = TIFFClientOpenExt(file.name().c_str(), "rc", &talk, onRead, onWrite, onSeek, onClose, onSize, onMap, onUnmap,
      options.options); // c: strips stay as they are
  }
  [[noreturn]] void damaged(std::size_t page) const
  {
    if (talk.beyond)
      talk.file->truncated(fmt::format("page {} of the TIFF reaches beyond its end", page + 1));
    undecodable(*talk.file, Format::Tiff,
      fmt::format("page {}{}{}", page + 1, talk.complaint.empty() ? "" : ": ", talk.complaint));
  }
};

TiffFile::TiffFile(FileBytes& file)
  : open_(std::make_unique<Open>())
{
  open_->open(file);
  if (open_->tiff == nullptr)
    open_->damaged(0);
  this->look();
}

TiffFile::~TiffFile() = default;

bool TiffFile::next()
{
  ++number_;
  open_->talk.complaint.clear(); // of a page that nobody wanted
  open_->talk.beyond = false;
  if (TIFFReadDirectory(open_->tiff) == 1)
  {
    this->look();
    return true;
  }
  if (!open_->talk.complaint.empty() || open_->talk.beyond)
    open_->damaged(number_);
  return false;
}

void TiffFile::go(std::size_t page)
{
  if (page == number_)
    return;
  const bool there = page == number_ + 1 ? TIFFReadDirectory(open_->tiff) == 1
                                         : TIFFSetDirectory(open_->tiff, static_cast<tdir_t>(page)) == 1;
  number_ = page;
  if (!there)
    open_->damaged(page);
  this->look();
}

void TiffFile::look()
{
  TIFF* const tiff = open_->tiff;
  page_ = {};
  page_.width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  page_.height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  page_.bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  page_.samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  page_.numbers = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  std::uint16_t photometric = 0;
  if (TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric) == 1)
    page_.photometric = photometric;
  page_.packing = field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  page_.together =
    field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_CONTIG || page_.samples == 1;
  page_.smaller = (field<std::uint32_t>(tiff, TIFFTAG_SUBFILETYPE, 0) & FILETYPE_REDUCEDIMAGE) != 0;
  page_.orientation = field<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  const char* description = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description) == 1 && description != nullptr)
    page_.description = description;
  TiffSource source;
  FileBytes& file = *open_->talk.file;
  source.read = [&file](std::uint64_t at, std::uint64_t count) -> std::optional<std::vector<std::uint8_t>>
  { return file.holds(at, count) ? std::optional(file.read(at, count)) : std::nullopt; };
  (void)source.open();
  if (const auto entries = tiffEntries(source, TIFFCurrentDirOffset(tiff)))
  {
    page_.pixelSize = resolution(*entries);
    page_.perUnit = { entries->ratio(TiffEntries::xResolution), entries->ratio(TiffEntries::yResolution) };
    page_.perUnit[1] = entries->ratios.contains(TiffEntries::yResolution) ? page_.perUnit[1] : page_.perUnit[0];
  }
}

void TiffFile::check() const
{
  TIFF* const tiff = open_->tiff;
  FileBytes& file = *open_->talk.file;
  if (!open_->talk.complaint.empty() || open_->talk.beyond)
    open_->damaged(number_);
  const bool tiled = TIFFIsTiled(tiff) != 0;
  const std::uint64_t* offsets = nullptr;
  const std::uint64_t* counts = nullptr;
  const std::uint32_t pieces = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  const bool found = TIFFGetField(tiff, tiled ? TIFFTAG_TILEOFFSETS : TIFFTAG_STRIPOFFSETS, &offsets) == 1 &&
    TIFFGetField(tiff, tiled ? TIFFTAG_TILEBYTECOUNTS : TIFFTAG_STRIPBYTECOUNTS, &counts) == 1;
  if (!found || offsets == nullptr || counts == nullptr || pieces == 0)
    file.damaged(fmt::format("page {} of the TIFF holds no pixels", number_ + 1));
  double held = 0;
  for (std::uint32_t i = 0; i < pieces; ++i)
  {
    if (!file.holds(offsets[i], counts[i]))
      file.truncated(fmt::format("pixels of page {} of the TIFF lie beyond its end", number_ + 1));
    if (counts[i] == 0)
      file.damaged(fmt::format("a strip of page {} of the TIFF is empty", number_ + 1));
    held += static_cast<double>(counts[i]);
  }
  const double wanted =
    std::ceil(static_cast<double>(page_.width) * page_.samples * page_.bits / 8) * static_cast<double>(page_.height);
  const auto piece = static_cast<double>(tiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff));
  if (piece > 4 * wanted + static_cast<double>(1 << 26))
  {
    file.damaged(fmt::format(
      "the pieces of page {} of the TIFF are of {:.0f} bytes, all of it takes {:.0f}", number_ + 1, piece, wanted));
  }
  // Fax codes pack any blank line into a bit; LZW at most 2730 bytes into one.
  const double ratio = page_.packing == COMPRESSION_NONE           ? 1
    : page_.packing >= 2 && page_.packing <= COMPRESSION_CCITTFAX4 ? 1e5
                                                                   : 3000;
  if (held * ratio + 4096 * (page_.packing != COMPRESSION_NONE ? 1 : 0) < wanted)
  {
    file.truncated(fmt::format("the {:.0f} bytes of page {} of the TIFF cannot hold {} × {} pixels", held, number_ + 1,
      page_.width, page_.height));
  }
}

void TiffFile::readSamples(void* to)
{
  TIFF* const tiff = open_->tiff;
  auto* const bytes = static_cast<std::uint8_t*>(to);
  const auto width = static_cast<std::size_t>(page_.width);
  const auto height = static_cast<std::size_t>(page_.height);
  const auto each = static_cast<std::size_t>(page_.bits / 8);
  const auto samples = static_cast<std::size_t>(page_.samples);
  const std::size_t inPiece = page_.together ? samples : 1; // samples of a pixel
  const bool tiled = TIFFIsTiled(tiff) != 0;
  const std::size_t across = tiled ? field<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0) : width;
  const std::size_t down = tiled
    ? field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0)
    : std::min<std::size_t>(field<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP, 0xffffffffU), height);
  const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  const std::size_t line = across * inPiece * each;
  if (size <= 0 || size > mostOfOne || across == 0 || down == 0 || static_cast<std::size_t>(size) != line * down)
    open_->damaged(number_);
  const bool straight = !tiled && page_.together; // a strip is what is wanted
  std::vector<std::uint8_t> piece(straight ? 0 : static_cast<std::size_t>(size));
  for (std::size_t plane = 0; plane < samples / inPiece; ++plane)
  {
    const auto part = static_cast<std::uint16_t>(plane);
    for (std::size_t y = 0; y < height; y += down)
    {
      const std::size_t rows = std::min(down, height - y);
      for (std::size_t x = 0; x < width; x += across)
      {
        const auto wanted = static_cast<tmsize_t>(tiled ? line * down : line * rows);
        std::uint8_t* const from = straight ? bytes + line * y : piece.data();
        const auto row = static_cast<std::uint32_t>(y);
        const tmsize_t read = tiled ? TIFFReadTile(tiff, from, static_cast<std::uint32_t>(x), row, 0, part)
                                    : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, row, part), from, wanted);
        if (read != wanted || !open_->talk.complaint.empty())
          open_->damaged(number_);
        const std::size_t columns = std::min(across, width - x);
        for (std::size_t r = 0; r < rows && !straight; ++r)
        {
          std::uint8_t* target = bytes + ((y + r) * width + x) * samples * each;
          if (inPiece == samples)
          {
            std::copy_n(from + line * r, columns * samples * each, target);
            continue;
          }
          for (std::size_t c = 0; c < columns; ++c)
            std::copy_n(from + line * r + c * each, each, target + (c * samples + plane) * each);
        }
      }
    }
  }
}

Pixels TiffFile::pixels()
{
  Pixels result;
  result.width = page_.width;
  result.height = page_.height;
  const bool grey = page_.photometric == PHOTOMETRIC_MINISWHITE || page_.photometric == PHOTOMETRIC_MINISBLACK;
  const int first = grey ? 1 : 3;
  const bool shape = (grey || page_.photometric == PHOTOMETRIC_RGB) &&
    (page_.samples == first || (page_.bits == 16 && page_.samples == first + 1));
  if (page_.numbers != SAMPLEFORMAT_UINT || (page_.bits != 8 && page_.bits != 16) || !shape || isJpeg(page_.packing))
    return this->colours();
  result.channels = page_.samples;
  result.bits = page_.bits;
  result.values.resize(static_cast<std::size_t>(page_.width * page_.height * page_.samples * (page_.bits / 8)));
  this->readSamples(result.values.data());
  if (page_.photometric == PHOTOMETRIC_MINISWHITE)
  {
    const std::size_t each = static_cast<std::size_t>(page_.bits / 8);
    const std::size_t step = each * static_cast<std::size_t>(page_.samples); // alpha stays
    for (std::size_t i = 0; i < result.values.size(); ++i)
      result.values[i] = static_cast<std::uint8_t>(i % step < each ? ~result.values[i] : result.values[i]);
  }
  return result;
}

/// Whatever libtiff can turn into 8 bits of red, green, blue and alpha, a strip or a row of tiles at a time.
Pixels TiffFile::colours()
{
  if (TIFFIsTiled(open_->tiff) != 0 && page_.packing == COMPRESSION_NONE && open_->talk.all.empty())
  {
    // libtiff 4.5 refuses such tiles of fewer bytes than it has room for, unless they are in memory.
    FileBytes& file = *open_->talk.file;
    auto again = std::make_unique<Open>();
    again->talk.all = file.read(0, file.size());
    again->open(file);
    open_ = std::move(again);
    if (open_->tiff == nullptr || TIFFSetDirectory(open_->tiff, static_cast<tdir_t>(number_)) != 1)
      open_->damaged(number_);
  }
  TIFF* const tiff = open_->tiff;
  TIFFRGBAImage image;
  char why[1024] = "";
  if (TIFFRGBAImageOK(tiff, why) == 0 || TIFFRGBAImageBegin(&image, tiff, 1, why) == 0)
  {
    open_->talk.complaint = open_->talk.complaint.empty() ? why : open_->talk.complaint;
    open_->damaged(number_);
  }
  struct End
  {
    TIFFRGBAImage& image;
    ~End() { TIFFRGBAImageEnd(&image); }
  } const end{ image };
  image.req_orientation = image.orientation; // as it is stored
  const bool grey = page_.photometric == PHOTOMETRIC_MINISWHITE || page_.photometric == PHOTOMETRIC_MINISBLACK;
  Pixels result;
  result.width = page_.width;
  result.height = page_.height;
  result.channels = (grey ? 1 : 3) + (image.alpha != 0 ? 1 : 0);
  result.values.resize(static_cast<std::size_t>(page_.width * page_.height * result.channels));
  const auto height = static_cast<std::uint32_t>(page_.height);
  const auto down = TIFFIsTiled(tiff) != 0 ? field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, height)
                                           : field<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP, height);
  const std::uint32_t rows = std::clamp<std::uint32_t>(down, 1, height);
  std::vector<std::uint32_t> raster(static_cast<std::size_t>(page_.width) * rows);
  std::uint8_t* to = result.values.data();
  for (std::uint32_t y = 0; y < height; y += rows)
  {
    const std::uint32_t now = std::min(rows, height - y);
    image.row_offset = static_cast<int>(y);
    if (TIFFRGBAImageGet(&image, raster.data(), image.width, now) == 0 || !open_->talk.complaint.empty())
      open_->damaged(number_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(page_.width) * now; ++i)
    {
      const std::uint32_t value = raster[i];
      *to++ = static_cast<std::uint8_t>(TIFFGetR(value));
      if (!grey)
      {
        *to++ = static_cast<std::uint8_t>(TIFFGetG(value));
        *to++ = static_cast<std::uint8_t>(TIFFGetB(value));
      }
      if (image.alpha != 0)
        *to++ = static_cast<std::uint8_t>(TIFFGetA(value));
    }
  }
  return result;
}

struct TiffWriter::Open : Opened
{
};

TiffWriter::TiffWriter(const std::filesystem::path& path, const TiffForm& form)
  : open_(std::make_unique<Open>())
  , form_(form)
{
  const double bytes = static_cast<double>(form.width) * static_cast<double>(form.height) *
    static_cast<double>(form.pages) * form.samples * form.bits / 8;
  const Options options(open_->talk);
  open_->tiff = TIFFOpenExt(path.c_str(), bytes > 3.5e9 ? "w8" : "w", options.options);
  good_ = open_->tiff != nullptr;
}

TiffWriter::~TiffWriter() = default;

bool TiffWriter::add(const void* rows, const std::string& description)
{
  if (!good_)
    return false;
  TIFF* const tiff = open_->tiff;
  const auto height = static_cast<std::uint32_t>(form_.height);
  const auto row = static_cast<std::size_t>(form_.width * form_.samples * (form_.bits / 8));
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(form_.width));
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, form_.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, form_.samples);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, static_cast<int>(form_.numbers));
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, form_.samples == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff, TIFFTAG_ZIPQUALITY, 3);
  if (form_.bits < 64)
  {
    TIFFSetField(
      tiff, TIFFTAG_PREDICTOR, form_.numbers == TiffNumbers::Real ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
  }
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP,
    std::clamp<std::uint32_t>(static_cast<std::uint32_t>((std::size_t{ 1 } << 20) / row), 1, height));
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (form_.pixelSize)
  {
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, static_cast<float>(0.01 / (*form_.pixelSize)[0]));
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, static_cast<float>(0.01 / (*form_.pixelSize)[1]));
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  }
  if (form_.pages > 1)
    TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_PAGE);
  if (!description.empty())
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, description.c_str());
  const auto* from = static_cast<const std::uint8_t*>(rows);
  std::vector<std::uint8_t> line(row); // libtiff's predictor works in place
  for (std::uint32_t y = 0; y < height && good_; ++y, from += row)
  {
    std::copy_n(from, row, line.data());
    good_ = TIFFWriteScanline(tiff, line.data(), y, 0) == 1;
  }
  good_ = good_ && TIFFWriteDirectory(tiff) == 1;
  return good_;
}

bool TiffWriter::finish()
{
  if (open_->tiff != nullptr)
  {
    open_->talk.complaint.clear();
    TIFFClose(std::exchange(open_->tiff, nullptr));
    good_ = good_ && open_->talk.complaint.empty();
  }
  return good_;
}

} // namespace lamella::micrograph
