#include "convert/TiffFile.h"

#include "pictures/TiffFile.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>

#include <algorithm>
#include <vector>

namespace lamella::cli
{

using micrograph::TiffNumbers;

int typeOf(const micrograph::TiffPage& page)
{
  const int bits = page.bits;
  if (page.numbers == static_cast<int>(TiffNumbers::Real))
    return bits == 32 ? VTK_FLOAT : VTK_DOUBLE;
  if (page.numbers == static_cast<int>(TiffNumbers::Signed))
    return bits == 8 ? VTK_SIGNED_CHAR : bits == 16 ? VTK_SHORT : bits == 32 ? VTK_INT : VTK_LONG;
  return bits == 8 ? VTK_UNSIGNED_CHAR
    : bits == 16   ? VTK_UNSIGNED_SHORT
    : bits == 32   ? VTK_UNSIGNED_INT
                   : VTK_UNSIGNED_LONG;
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
  vtkImageData* const sample = volume.sample();
  vtkDataArray* const array = onlyArray(sample);
  const int type = array->GetDataType();
  const double* const spacing = sample->GetSpacing();
  micrograph::TiffForm form{ extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, volume.layers() };
  form.samples = array->GetNumberOfComponents();
  form.bits = 8 * vtkDataArray::GetDataTypeSize(type);
  const bool positive = type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT || type == VTK_UNSIGNED_INT ||
    type == VTK_UNSIGNED_LONG || type == VTK_UNSIGNED_LONG_LONG;
  form.numbers = type == VTK_FLOAT || type == VTK_DOUBLE ? TiffNumbers::Real
    : positive                                           ? TiffNumbers::Unsigned
                                                         : TiffNumbers::Signed;
  if (fieldText(sample, "pixel_size_source") != "none")
    form.pixelSize = { spacing[0], spacing[1] };
  const auto row = static_cast<std::size_t>(form.width * form.samples * (form.bits / 8));
  const auto height = static_cast<std::size_t>(form.height);
  const bool flat = volume.layers() == 1;
  micrograph::TiffWriter tiff(file.temporary(), form);
  std::vector<unsigned char> turned(flat ? row * height : 0); // a picture is stored upright
  forSlabs(session, volume,
    [&](vtkDataArray* values, int first, int last)
    {
      auto* from = static_cast<unsigned char*>(values->GetVoidPointer(0));
      for (int page = first; page <= last; ++page, from += row * height)
      {
        for (std::size_t y = 0; flat && y < height; ++y)
          std::copy_n(from + row * (height - 1 - y), row, turned.data() + row * y);
        if (!tiff.add(flat ? turned.data() : from, page == extent[4] ? notes : ""))
          file.failed();
      }
    });
  if (!tiff.finish())
    file.failed();
}

} // namespace lamella::cli
