#pragma once

#include "session/Session.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <functional>
#include <memory>

class vtkDataArray;

/// Images that may be larger than memory.
namespace lamella::cli
{

/// An image that is read in slabs of layers along z, of which as many are in memory as are asked for.
class Volume
{
public:
  Volume() = default;
  virtual ~Volume() = default;
  Volume(const Volume&) = delete;
  Volume& operator=(const Volume&) = delete;

  /// Of its points: first and last along x, y and z.
  [[nodiscard]] const std::array<int, 6>& extent() const noexcept { return extent_; }
  [[nodiscard]] int layers() const noexcept { return extent_[5] - extent_[4] + 1; }

  /// The points of layers `first` to `last` (both counted as extent() does) with all arrays at them and in the cells
  /// between them, the place of the image, and its field data.
  /// @throws InputError
  [[nodiscard]] virtual vtkSmartPointer<vtkImageData> read(int first, int last) = 0;

  /// Its first layer: tells the arrays' types. (Of a volume with arrays in cells: the first two.) Read once.
  /// @throws InputError
  [[nodiscard]] vtkImageData* sample();

  /// How many layers make a slab of about 16 MiB.
  [[nodiscard]] int slab();

protected:
  std::array<int, 6> extent_{ 0, -1, 0, -1, 0, -1 };

private:
  vtkSmartPointer<vtkImageData> sample_;
};

/// One that is in memory.
[[nodiscard]] std::unique_ptr<Volume> wholeVolume(vtkSmartPointer<vtkImageData> image);

/// A volume whose slabs are changed as they are read.
/// @param change is given a slab that has arrays and field data of its own, and may change what there are
[[nodiscard]] std::unique_ptr<Volume> changed(
  std::unique_ptr<Volume> volume, std::function<void(vtkImageData*)> change);

/// Cells become points at their centres: what is a grid of pixels elsewhere. Arrays at points are left out.
[[nodiscard]] std::unique_ptr<Volume> cellsAsPoints(std::unique_ptr<Volume> volume);

/// An empty image of the volume's place, its extent in z from `first` to `last`: where a slab begins.
void setPlace(vtkImageData* slab, const std::array<int, 6>& extent, int first, int last);

/// All of a volume as one image. @throws MemoryError where it is larger than the memory that is free; Cancelled
[[nodiscard]] vtkSmartPointer<vtkImageData> readAll(Session& session, Volume& volume);

/// Reads a volume of one array slab by slab.
/// @param take the values of layers first to last, x fastest
/// @throws what `take` throws; Cancelled
void forSlabs(
  Session& session, Volume& volume, const std::function<void(vtkDataArray* values, int first, int last)>& take);

/// The only array at the points. @throws InputError where there is none or several
[[nodiscard]] vtkDataArray* onlyArray(vtkImageData* image);

} // namespace lamella::cli
