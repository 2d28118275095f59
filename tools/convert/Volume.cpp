#include "convert/Volume.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <algorithm>

namespace lamella::cli
{

namespace
{

constexpr double slabBytes = 16 * 1024 * 1024;

/// Layers [first, last] of an image that holds more of them; arrays are copied.
vtkSmartPointer<vtkImageData> cut(vtkImageData* image, int first, int last)
{
  std::array<int, 6> extent{};
  image->GetExtent(extent.data());
  auto part = vtkSmartPointer<vtkImageData>::New();
  part->ShallowCopy(image);
  if (first == extent[4] && last == extent[5])
    return part;
  extent[4] = first;
  extent[5] = last;
  part->Crop(extent.data());
  return part;
}

class Whole : public Volume
{
public:
  explicit Whole(vtkSmartPointer<vtkImageData> image)
    : image_(std::move(image))
  {
    image_->GetExtent(extent_.data());
  }
  vtkSmartPointer<vtkImageData> read(int first, int last) override { return cut(image_, first, last); }

private:
  vtkSmartPointer<vtkImageData> image_;
};

class Changed : public Volume
{
public:
  using Change = std::function<void(vtkImageData*)>;
  Changed(std::unique_ptr<Volume> volume, Change change)
    : volume_(std::move(volume))
    , change_(std::move(change))
  {
    extent_ = volume_->extent();
  }
  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->ShallowCopy(volume_->read(first, last));
    change_(image);
    return image;
  }

private:
  std::unique_ptr<Volume> volume_;
  Change change_;
};

class Centres : public Volume
{
public:
  explicit Centres(std::unique_ptr<Volume> volume)
    : volume_(std::move(volume))
  {
    extent_ = volume_->extent();
    for (std::size_t axis = 0; axis < 3; ++axis)
      extent_[2 * axis + 1] = std::max(extent_[2 * axis], extent_[2 * axis + 1] - 1);
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    const auto cells = volume_->read(first, std::min(last + 1, volume_->extent()[5]));
    auto points = vtkSmartPointer<vtkImageData>::New();
    setPlace(points, extent_, first, last);
    points->SetSpacing(cells->GetSpacing());
    points->SetDirectionMatrix(cells->GetDirectionMatrix());
    std::array<double, 3> half{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      half[axis] = volume_->extent()[2 * axis + 1] > volume_->extent()[2 * axis] ? 0.5 : 0.0;
    // Half a spacing along the image's own axes, whatever way they point.
    std::array<double, 3> origin{};
    points->SetOrigin(cells->GetOrigin());
    points->TransformContinuousIndexToPhysicalPoint(half.data(), origin.data());
    points->SetOrigin(origin.data());
    points->GetPointData()->ShallowCopy(cells->GetCellData());
    points->GetFieldData()->ShallowCopy(cells->GetFieldData());
    return points;
  }

private:
  std::unique_ptr<Volume> volume_;
};

} // namespace

vtkImageData* Volume::sample()
{
  if (sample_ == nullptr)
  {
    sample_ = this->read(extent_[4], extent_[4]);
    if (extent_[5] > extent_[4])
    {
      // Whether there are arrays in cells shows between two layers only.
      const auto two = this->read(extent_[4], extent_[4] + 1);
      sample_ = two->GetCellData()->GetNumberOfArrays() > 0 ? two : sample_;
    }
  }
  return sample_;
}

int Volume::slab()
{
  int held[6];
  this->sample()->GetExtent(held);
  const double layer = 1024.0 * static_cast<double>(this->sample()->GetActualMemorySize()) / (held[5] - held[4] + 1);
  return static_cast<int>(std::clamp(slabBytes / std::max(1.0, layer), 1.0, static_cast<double>(this->layers())));
}

std::unique_ptr<Volume> wholeVolume(vtkSmartPointer<vtkImageData> image)
{
  return std::make_unique<Whole>(std::move(image));
}

std::unique_ptr<Volume> changed(std::unique_ptr<Volume> volume, Changed::Change change)
{
  return std::make_unique<Changed>(std::move(volume), std::move(change));
}

std::unique_ptr<Volume> cellsAsPoints(std::unique_ptr<Volume> volume)
{
  return std::make_unique<Centres>(std::move(volume));
}

void setPlace(vtkImageData* slab, const std::array<int, 6>& extent, int first, int last)
{
  slab->SetExtent(extent[0], extent[1], extent[2], extent[3], first, last);
}

vtkSmartPointer<vtkImageData> readAll(Session& session, Volume& volume)
{
  int held[6];
  volume.sample()->GetExtent(held);
  const double bytes =
    1024.0 * static_cast<double>(volume.sample()->GetActualMemorySize()) / (held[5] - held[4] + 1) * volume.layers();
  if (const auto free = static_cast<double>(availableMemory()); bytes > free)
  {
    throw MemoryError(fmt::format("the image takes {}, and {} are free", bytesText(bytes), bytesText(free)),
      "convert it instead, which takes a slab at a time");
  }
  session.progress(0, "reading");
  const auto image = volume.read(volume.extent()[4], volume.extent()[5]);
  Session::checkInterrupt();
  return image;
}

void forSlabs(
  Session& session, Volume& volume, const std::function<void(vtkDataArray* values, int first, int last)>& take)
{
  const auto& extent = volume.extent();
  const int thick = volume.slab();
  for (int first = extent[4]; first <= extent[5]; first += thick)
  {
    const int last = std::min(extent[5], first + thick - 1);
    const auto slab = volume.read(first, last);
    take(onlyArray(slab), first, last);
    session.progress(static_cast<double>(last - extent[4] + 1) / volume.layers(), "converting");
    Session::checkInterrupt();
  }
  session.endProgress();
}

vtkDataArray* onlyArray(vtkImageData* image)
{
  vtkDataArray* const array = image->GetPointData()->GetArray(0);
  if (image->GetPointData()->GetNumberOfArrays() != 1 || array == nullptr)
    throw InputError("the image does not hold one array of numbers", "name one with --array");
  return array;
}

} // namespace lamella::cli
