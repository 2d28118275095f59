/**
 * @class   vtkVTKHDFWriter
 * @brief   writes VTKHDF 1.0 files
 *
 * Writes images (vtkImageData) and unstructured grids in version 1.0 of the VTKHDF format, which vtkHDFReader of
 * VTK 9.1 and later reads; VTK 9.2 has no writer of its own. Poly data, for which that version has no place, are
 * written as an unstructured grid: vertices, lines, polygons and strips in that order, as their cell data are.
 *
 * Arrays of numbers at points and in cells are kept with all their bits, unit, description and creator as attributes of
 * the dataset; field data are numbers and texts. Those of an image stand in a group `FieldData` beside the format's
 * own: VTK 9.2 fails to read an image with field data. The active scalars, vectors, normals, texture coordinates,
 * tensors and global ids are named as the format says.
 *
 * The extent of an image begins at 0 in the file, and its origin is the place of the first point: VTK 9.2's reader
 * takes the extent for places in the dataset.
 *
 * Of an image that is flat along z or y, that axis comes first in the file, and the direction turns it back: VTK 9.2's
 * reader writes beyond its memory where the second or third axis has one point. The attribute `axes` tells which axis
 * of the image each of the file is. (That reader's own output has its places right in a copy only, such as
 * ShallowCopy().)
 *
 * An image is asked for in slabs of layers along z, so that a pipeline that can stream never holds all of it.
 *
 * A file appears under its name when it is whole; what had the name before stays where nothing comes of it. ErrorCode
 * then says why.
 *
 * @warning Version 1.0 has no time: a step is a file. Arrays of bits and of texts at points or in cells, names with a
 * slash, and what VTK 9.2's reader cannot read (arrays in cells of an image, a single line of points) are refused. One
 * process writes.
 *
 * Format: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html#vtkhdf-file-format
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkWriter.h"

#include <memory> // for what is kept between slabs

class VTKLAMELLASOLVERSVTK_EXPORT vtkVTKHDFWriter : public vtkWriter
{
public:
  static vtkVTKHDFWriter* New();
  vtkTypeMacro(vtkVTKHDFWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The file to write, by habit with the ending .hdf or .vtkhdf. What is there is replaced.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * How hard HDF5 packs (deflate, after shuffling bytes): 0, the fastest, not at all; to 9.
   * @range [0, 9]
   */
  vtkSettingMacro(CompressionLevel, int, 1);

  /**
   * Images: bytes of all arrays that a slab holds at most, if that is a layer at all.
   * @range [1, inf)
   */
  vtkSettingMacro(SlabBytes, vtkIdType, 16777216);

protected:
  vtkVTKHDFWriter();
  ~vtkVTKHDFWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector) override;
  void WriteData() override;

private:
  struct File;
  /** Runs what writes, and tells in ErrorCode what the format has no place for from a disk that is full. */
  template <typename Action>
  void Coded(const Action& action);
  /** Forgets the file, and removes what there is of it. */
  void Discard();

  char* FileName = nullptr;
  std::unique_ptr<File> Open; ///< while an image is written slab by slab
};
