#include "convert/TiffFile.h"

#include "lattice/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

namespace lamella::cli
{

namespace
{

/// Keeps what libtiff complains of.
int keep(TIFF*, void* data, const char*, const char* format, va_list values)
{
  char text[256];
  std::vsnprintf(text, sizeof text, format, values);
  *static_cast<std::string*>(data) = text;
  return 1;
}

int ignore(TIFF*, void*, const char*, const char*, va_list)
{
  return 1;
}

struct Options
{
  explicit Options(std::string& complaint)
    : options(TIFFOpenOptionsAlloc())
  {
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep, &complaint);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore, nullptr);
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

int typeOf(int bits, int format)
{
  switch (format)
  {
    case SAMPLEFORMAT_UINT:
      return bits == 8 ? VTK_UNSIGNED_CHAR
        : bits == 16   ? VTK_UNSIGNED_SHORT
        : bits == 32   ? VTK_UNSIGNED_INT
        : bits == 64   ? VTK_UNSIGNED_LONG
                       : 0;
    case SAMPLEFORMAT_INT:
      return bits == 8 ? VTK_SIGNED_CHAR : bits == 16 ? VTK_SHORT : bits == 32 ? VTK_INT : bits == 64 ? VTK_LONG : 0;
    case SAMPLEFORMAT_IEEEFP:
      return bits == 32 ? VTK_FLOAT : bits == 64 ? VTK_DOUBLE : 0;
    default:
      return 0;
  }
}

} // namespace

struct TiffReader::Open
{
  std::string name;
  std::string complaint;
  TIFF* tiff = nullptr;
  ~Open()
  {
    if (tiff != nullptr)
    {
      TIFFClose(tiff);
    }
  }
  [[noreturn]] void damaged(std::size_t page) const
  {
    throw InputError(
      fmt::format("page {} of '{}' cannot be decoded{}", page + 1, name, complaint.empty() ? "" : ": " + complaint),
      "make or copy the file again");
  }
  void go(std::size_t page)
  {
    if (TIFFCurrentDirectory(tiff) + 1 == page ? TIFFReadDirectory(tiff) != 1
                                               : TIFFSetDirectory(tiff, static_cast<tdir_t>(page)) != 1)
    {
      this->damaged(page);
    }
  }
};

TiffReader::TiffReader(const std::filesystem::path& path)
  : open_(std::make_unique<Open>())
{
  open_->name = path.string();
  const Options options(open_->complaint);
  open_->tiff = TIFFOpenExt(path.c_str(), "rm", options.options);
  if (open_->tiff == nullptr)
  {
    throw InputError(
      fmt::format("'{}' cannot be read as TIFF: {}", path.string(), open_->complaint), "make or copy the file again");
  }
}

TiffReader::~TiffReader() = default;

bool TiffReader::plain(std::size_t page)
{
  TIFF* const tiff = open_->tiff;
  open_->go(page);
  const auto photometric = field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, 99);
  const auto packing = field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  const auto samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  type_ =
    typeOf(field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1), field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, 1));
  components_ = samples;
  const bool shape =
    (photometric == PHOTOMETRIC_MINISBLACK && samples == 1) || (photometric == PHOTOMETRIC_RGB && samples == 3);
  return shape && type_ != 0 && packing != COMPRESSION_JPEG && packing != COMPRESSION_OJPEG &&
    field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_CONTIG;
}

void TiffReader::read(std::size_t page, void* to)
{
  if (!this->plain(page))
  {
    open_->damaged(page);
  }
  TIFF* const tiff = open_->tiff;
  auto* const bytes = static_cast<unsigned char*>(to);
  const auto height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  const auto row = static_cast<std::size_t>(TIFFScanlineSize64(tiff));
  if (TIFFIsTiled(tiff) == 0)
  {
    const auto rows = std::min(field<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP, height), height);
    for (std::uint32_t first = 0, strip = 0; first < height; first += rows, ++strip)
    {
      const auto size = static_cast<tmsize_t>(row * std::min(rows, height - first));
      if (TIFFReadEncodedStrip(tiff, strip, bytes + row * first, size) != size)
      {
        open_->damaged(page);
      }
    }
    return;
  }
  const auto tileWidth = field<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 1);
  const auto tileHeight = field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 1);
  const auto width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  const auto pixel = static_cast<std::size_t>(vtkDataArray::GetDataTypeSize(type_) * components_);
  std::vector<unsigned char> tile(static_cast<std::size_t>(TIFFTileSize64(tiff)));
  for (std::uint32_t y = 0; y < height; y += tileHeight)
  {
    for (std::uint32_t x = 0; x < width; x += tileWidth)
    {
      if (TIFFReadTile(tiff, tile.data(), x, y, 0, 0) < 0)
      {
        open_->damaged(page);
      }
      for (std::uint32_t line = 0; line < std::min(tileHeight, height - y); ++line)
      {
        std::copy_n(tile.data() + pixel * tileWidth * line, pixel * std::min(tileWidth, width - x),
          bytes + row * (y + line) + pixel * x);
      }
    }
  }
}

bool tiffHolds(int type, int components)
{
  const int size = vtkDataArray::GetDataTypeSize(type);
  return (components == 1 && type != VTK_BIT) ||
    (components == 3 && (type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT) && size <= 2);
}

void writeTiff(Session& session, Volume& volume, const OutputFile& file, const std::string& notes)
{
  const auto& extent = volume.extent();
  const auto width = static_cast<std::uint32_t>(extent[1] - extent[0] + 1);
  const auto height = static_cast<std::uint32_t>(extent[3] - extent[2] + 1);
  vtkImageData* const sample = volume.sample();
  vtkDataArray* const array = onlyArray(sample);
  const int type = array->GetDataType();
  const int components = array->GetNumberOfComponents();
  const int size = vtkDataArray::GetDataTypeSize(type);
  const bool real = type == VTK_FLOAT || type == VTK_DOUBLE;
  const bool positive = type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT || type == VTK_UNSIGNED_INT ||
    type == VTK_UNSIGNED_LONG || type == VTK_UNSIGNED_LONG_LONG;
  const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(components * size);
  const double bytes = static_cast<double>(row) * height * volume.layers();
  const bool flat = volume.layers() == 1;
  const double* const spacing = sample->GetSpacing();
  const bool known = fieldText(sample, "pixel_size_source") != "none";

  std::string complaint;
  const Options options(complaint);
  TIFF* tiff = TIFFOpenExt(file.temporary().c_str(), bytes > 3.5e9 ? "w8" : "w", options.options);
  if (tiff == nullptr)
  {
    file.failed();
  }
  const struct Close
  {
    TIFF*& tiff;
    ~Close()
    {
      if (tiff != nullptr)
      {
        TIFFClose(tiff);
      }
    }
  } close{ tiff };

  forSlabs(session, volume,
    [&](vtkDataArray* values, int first, int last)
    {
      auto* from = static_cast<unsigned char*>(values->GetVoidPointer(0));
      for (int page = first; page <= last; ++page, from += row * height)
      {
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8 * size);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, components);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT,
          real         ? SAMPLEFORMAT_IEEEFP
            : positive ? SAMPLEFORMAT_UINT
                       : SAMPLEFORMAT_INT);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, components == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        TIFFSetField(tiff, TIFFTAG_ZIPQUALITY, 3);
        if (size < 8)
        {
          TIFFSetField(tiff, TIFFTAG_PREDICTOR, real ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
        }
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP,
          std::clamp<std::uint32_t>(static_cast<std::uint32_t>((1 << 20) / row), 1, height));
        TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
        if (known)
        {
          TIFFSetField(tiff, TIFFTAG_XRESOLUTION, static_cast<float>(0.01 / spacing[0]));
          TIFFSetField(tiff, TIFFTAG_YRESOLUTION, static_cast<float>(0.01 / spacing[1]));
          TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
        }
        if (!flat)
        {
          TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_PAGE);
        }
        if (page == extent[4])
        {
          TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, notes.c_str());
        }
        std::vector<unsigned char> line(row); // libtiff's predictor works in place
        for (std::uint32_t y = 0; y < height; ++y)
        {
          std::copy_n(from + row * (flat ? height - 1 - y : y), row, line.data());
          if (TIFFWriteScanline(tiff, line.data(), y, 0) != 1)
          {
            file.failed();
          }
        }
        if (TIFFWriteDirectory(tiff) != 1)
        {
          file.failed();
        }
      }
    });
  complaint.clear();
  TIFFClose(std::exchange(tiff, nullptr));
  if (!complaint.empty())
  {
    file.failed();
  }
}

} // namespace lamella::cli
