#include "convert/Pictures.h"

#include "convert/Notes.h"
#include "convert/TiffFile.h"

#include "core/Error.h"
#include "pictures/Decode.h"
#include "pictures/Picture.h"
#include "pictures/Slices.h"
#include "pictures/TiffFile.h"
#include "pictures/WritePicture.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <algorithm>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;
using micrograph::Probe;

struct Slice
{
  fs::path file;
  std::size_t page = 0;
};

/// Is it what the rest of the stack is?
void requireAlike(const Probe& probe, const Probe& first, const std::string& name)
{
  if (probe.width != first.width || probe.height != first.height || probe.bits != first.bits ||
    probe.sampleFormat != first.sampleFormat)
  {
    throw InputError(fmt::format("'{}' is {} × {} pixels of {} bits, the first slice is {} × {} of {}", name,
                       probe.width, probe.height, probe.bits, first.width, first.height, first.bits),
      "a volume's slices are all alike: leave out what does not belong to it");
  }
}

class Pictures final : public Volume
{
public:
  Pictures(const std::string& path, PictureReading& reading)
    : lossy_(reading.lossy)
  {
    std::error_code ignored;
    stack_ = fs::is_directory(path, ignored) || micrograph::isSlicePattern(path);
    std::vector<fs::path> files{ path };
    if (stack_)
    {
      const micrograph::Slices slices = micrograph::listSlices(path);
      if (!slices.warnings.empty() && !lossy_)
      {
        throw InputError(slices.warnings.front().substr(0, slices.warnings.front().find(';')),
          "add them, or close the gap with --lossy");
      }
      reading.warnings.insert(reading.warnings.end(), slices.warnings.begin(), slices.warnings.end());
      files = slices.files;
    }
    micrograph::FileBytes file(files.front());
    first_ = micrograph::probe(file, true);
    reading.warnings.insert(reading.warnings.end(), first_.warnings.begin(), first_.warnings.end());
    for (const fs::path& one : files)
      slices_.push_back({ one, first_.slices.empty() ? 0 : first_.slices.front() });
    if (!stack_ && first_.slices.size() > 1)
    {
      slices_.clear();
      for (const std::size_t page : first_.slices)
        slices_.push_back({ path, page });
    }
    const auto count = static_cast<int>(slices_.size());
    flat_ = count == 1 && !stack_;
    extent_ = { 0, static_cast<int>(first_.width - 1), 0, static_cast<int>(first_.height - 1), 0, count - 1 };
    this->setSpacing(reading);
    // The first slice tells whether there are colours.
    colour_ = first_.channels > 1;
    seen_ = this->read(0, 0);
    if (colour_ && !sawColour_)
    {
      colour_ = false;
      seen_ = nullptr;
      seen_ = this->read(0, 0);
    }
  }

  [[nodiscard]] const std::string& description() const { return first_.description; }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    if (seen_ != nullptr && first == 0 && last == 0)
      return seen_;
    auto image = vtkSmartPointer<vtkImageData>::New();
    setPlace(image, extent_, first, last);
    image->SetSpacing(spacing_.data());
    image->SetOrigin(spacing_[0] / 2, spacing_[1] / 2, flat_ ? 0 : spacing_[2] / 2);
    vtkSmartPointer<vtkDataArray> values;
    for (int z = first; z <= last; ++z)
    {
      this->open(static_cast<std::size_t>(z));
      if (values == nullptr)
      {
        values.TakeReference(vtkDataArray::CreateDataArray(this->type()));
        values->SetName(colour_ ? "colour" : "grey");
        values->SetNumberOfComponents(colour_ ? 3 : 1);
        values->SetNumberOfTuples(image->GetNumberOfPoints());
      }
      const vtkIdType pixels = first_.width * first_.height;
      this->readSlice(static_cast<std::size_t>(z), values->GetVoidPointer((z - first) * pixels * (colour_ ? 3 : 1)));
    }
    image->GetPointData()->SetScalars(values);
    setFieldText(image, "pixel_size_source", source_);
    return image;
  }

private:
  void setSpacing(PictureReading& reading)
  {
    if (reading.pixelSize)
    {
      spacing_.fill(*reading.pixelSize);
      source_ = "option";
    }
    else if (const auto size = micrograph::trustedSize(first_.size, slices_.front().file.string(), reading.warnings))
    {
      spacing_ = { size->x, size->y, size->z.value_or(size->x) };
      source_ = size->source;
    }
  }

  [[nodiscard]] int type() const
  {
    if (plain_)
      return typeOf(tiff_->page());
    return first_.bits == 16 ? VTK_UNSIGNED_SHORT : VTK_UNSIGNED_CHAR;
  }

  /// Makes ready the file that holds a slice.
  void open(std::size_t number)
  {
    const Slice& slice = slices_[number];
    if (file_ == nullptr || slice.file != slices_[slice_].file)
    {
      file_ = std::make_unique<micrograph::FileBytes>(slice.file);
      probe_ = micrograph::probe(*file_, true);
      requireAlike(probe_, first_, file_->name());
      if (stack_ && probe_.slices.size() > 1)
      {
        throw InputError(
          fmt::format("'{}' holds {} pages, but is one of several slices", file_->name(), probe_.slices.size()),
          "name the file itself to read its pages as a volume");
      }
      tiff_ = probe_.format == micrograph::Format::Tiff ? std::make_unique<micrograph::TiffFile>(*file_) : nullptr;
    }
    if (tiff_ != nullptr)
      tiff_->go(slice.page);
    slice_ = number;
    // What libtiff gives as it is: not colours that may turn out to be greys.
    plain_ = tiff_ != nullptr && tiff_->page().plain() && tiff_->page().samples == 1 && !colour_;
    if (!plain_ && (probe_.sampleFormat != 1 || probe_.bits > 16))
    {
      throw InputError(fmt::format("'{}' holds {} values of {} bits in an arrangement that cannot be read",
                         file_->name(), probe_.channels, probe_.bits),
        "save it as grey values, all values of a page together");
    }
  }

  void readSlice(std::size_t number, void* to)
  {
    const auto pixels = static_cast<std::size_t>(first_.width * first_.height);
    const std::size_t row =
      static_cast<std::size_t>(first_.width) * static_cast<std::size_t>(vtkDataArray::GetDataTypeSize(this->type()));
    if (plain_)
    {
      auto* const bytes = static_cast<unsigned char*>(to);
      tiff_->readSamples(bytes);
      for (std::size_t y = 0; flat_ && y < static_cast<std::size_t>(first_.height) / 2; ++y)
      {
        const std::size_t mirror = static_cast<std::size_t>(first_.height) - 1 - y;
        std::swap_ranges(bytes + row * y, bytes + row * (y + 1), bytes + row * mirror);
      }
      return;
    }
    std::vector<std::uint16_t> grey(pixels);
    std::vector<std::uint16_t> colour(colour_ ? 3 * pixels : 0);
    micrograph::Decoded seen;
    if (tiff_ != nullptr)
    {
      micrograph::convert(tiff_->pixels(), flat_, grey.data(), colour_ ? colour.data() : nullptr, seen);
    }
    else
    {
      seen = micrograph::decode(*file_, probe_, flat_, grey.data(), colour_ ? colour.data() : nullptr);
      first_.description = number == 0 ? probe_.description : first_.description; // it may stand behind the pixels
    }
    sawColour_ = seen.colour;
    if (seen.colour && !colour_)
    {
      throw InputError(fmt::format("'{}' is a colour picture, and the first slice is grey", file_->name()),
        "a volume's slices are all alike: leave out what does not belong to it");
    }
    if (seen.transparent && !lossy_)
    {
      throw InputError(fmt::format("'{}' has transparent parts, which would be lost", file_->name()),
        "read the colours that it holds there with --lossy");
    }
    const std::vector<std::uint16_t>& from = colour_ ? colour : grey;
    if (this->type() == VTK_UNSIGNED_SHORT)
    {
      std::copy(from.begin(), from.end(), static_cast<std::uint16_t*>(to));
    }
    else
    {
      std::transform(
        from.begin(), from.end(), static_cast<std::uint8_t*>(to),
        [](std::uint16_t value) { return static_cast<std::uint8_t>(value); });
    }
  }

  bool lossy_;
  bool stack_ = false;
  bool flat_ = false; ///< a picture, which is turned upright
  bool colour_ = false;
  bool sawColour_ = false;
  Probe first_;
  std::vector<Slice> slices_;
  std::array<double, 3> spacing_{ 1, 1, 1 };
  std::string source_ = "none";
  vtkSmartPointer<vtkImageData> seen_; ///< the first slice
  // The file of the slice that was read last.
  std::size_t slice_ = 0;
  std::unique_ptr<micrograph::FileBytes> file_;
  Probe probe_;
  std::unique_ptr<micrograph::TiffFile> tiff_;
  bool plain_ = false;
};

} // namespace

std::unique_ptr<Volume> openPictures(const std::string& path, PictureReading& reading)
{
  auto pictures = std::make_unique<Pictures>(path, reading);
  const std::string notes = pictures->description();
  if (isNotes(notes)) // they tell the size to all digits: what is doubtful in the picture's own does not matter
    std::erase_if(reading.warnings, [](const std::string& w) { return w.find(": left out") != std::string::npos; });
  return withNotes(std::move(pictures), notes);
}

bool pngHolds(int type, int components)
{
  return (type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT) && (components == 1 || components == 3);
}

void writePngs(Session& session, Volume& volume, std::vector<OutputFile>& files, const std::string& notes)
{
  const auto& extent = volume.extent();
  vtkImageData* const sample = volume.sample();
  micrograph::Picture picture;
  const bool flat = volume.layers() == 1;
  const std::int64_t width = extent[1] - extent[0] + 1;
  const std::int64_t height = extent[3] - extent[2] + 1;
  const double* const spacing = sample->GetSpacing();
  picture.lattice = makeLattice(width, height, 1, 2, spacing[0]);
  const bool square = spacing[0] == spacing[1];
  picture.pixelSizeSource = square ? fieldText(sample, "pixel_size_source").value_or("spacing") : "none";
  const int components = onlyArray(sample)->GetNumberOfComponents();
  picture.bits = onlyArray(sample)->GetDataType() == VTK_UNSIGNED_SHORT ? 16 : 8;
  std::vector<std::uint16_t>& pixels = components == 3 ? picture.colour : picture.grey;
  pixels.resize(static_cast<std::size_t>(width * height * components));
  const auto row = static_cast<std::ptrdiff_t>(width * components);
  const auto fill = [&](const auto* from)
  {
    for (std::int64_t y = 0; y < height; ++y)
    {
      // The writer puts the last row on top, as pictures are kept; a slice of a volume has its first row there.
      const std::int64_t line = flat ? y : height - 1 - y;
      std::copy_n(from + row * y, row, pixels.begin() + row * line);
    }
  };
  forSlabs(session, volume,
    [&](vtkDataArray* values, int first, int last)
    {
      for (int z = first; z <= last; ++z)
      {
        void* const from = values->GetVoidPointer((z - first) * row * height);
        if (picture.bits == 16)
        {
          fill(static_cast<const std::uint16_t*>(from));
        }
        else
        {
          fill(static_cast<const std::uint8_t*>(from));
        }
        const OutputFile& file = files.at(static_cast<std::size_t>(z - extent[4]));
        try
        {
          micrograph::writePicture(picture, file.temporary(), z == extent[4] ? notes : "", 4);
        }
        catch (const Error& error)
        {
          file.rethrow(error);
          throw;
        }
      }
    });
}

} // namespace lamella::cli
