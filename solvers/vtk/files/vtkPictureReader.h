/**
 * @class   vtkPictureReader
 * @brief   picture, volume or image file → phases on a lattice
 *
 * Reads PNG, JPEG, TIFF, PGM, PPM, BMP, multi-page TIFF and numbered pictures (volumes), raw volumes, MetaImage,
 * NRRD, NumPy, NIfTI, legacy and XML VTK image files, and turns grey values into named phases. Output: vtkImageData
 * whose points are the pixels' centres, with the array `phase` (unsigned char); field data `phase_names`,
 * `pixel_size_source`, `provenance`. Two-dimensional pictures are flipped, so that they stand upright in a view: the
 * first row in memory is the bottom row of the picture.
 *
 * With no phase named they are what a file that lamella wrote calls them, else every grey value is a phase of its own,
 * named by its value. Once one is named, a grey that is in no phase is an error, unless OtherPhase says what all other
 * greys are. Phases are named by grey values or by ranges of them.
 *
 * Of a .vti the other point arrays come along, cut out with the window (with Refinement only `grain` and `axis`), and
 * its field data where there is no window, no Refinement and no PixelSize.
 *
 * The pixel size is never guessed: PixelSize, or what the file says; without either the spacing is 1 and
 * `pixel_size_source` is "none".
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for the image that is kept

#include <map>    // for the grey map
#include <string> // for the grey map

namespace lamella
{
struct PictureOptions;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkPictureReader : public vtkImageAlgorithm
{
public:
  static vtkPictureReader* New();
  vtkTypeMacro(vtkPictureReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The picture or volume. Slices of a volume: a pattern such as slice_%03d.png or slice_*.png.
   * @group File
   * @files Pictures and volumes (*)
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * These grey values are this phase: one (0 to 255, of 16-bit pictures to 65535), or a range with both ends in it, as
   * 90..255, 90.. or ..89; ..otsu and otsu.. part the greys where the picture says, ..otsu1, otsu1..otsu2 and otsu2..
   * into three. Several greys may have one name. None: what a file that lamella wrote calls them, else every grey is a
   * phase of its own (a command asks); of a volume to be segmented, void and solid.
   * @word phase, phases
   * @title Phases: grey values, name
   * @group Phases
   * @columns Grey, Name
   */
  void SetPhase(const char* greys, const char* name);
  void SetPhase(int grey, const char* name);
  void RemoveAllPhases();
  int GetNumberOfPhases();
  ///@}

  ///@{
  /**
   * All grey values that are not listed are this phase. Empty: such a grey is an error once a phase is named.
   * @word other
   * @group Phases
   */
  vtkSetStringMacro(OtherPhase);
  vtkGetStringMacro(OtherPhase);
  ///@}

  /**
   * A raw scan, not labels: find the phases lumen and wall in a picture (name no phases then), void and solid, or the
   * phases named, in a volume.
   *
   * By micrograph::segment and segmentVolume; field data `segmentation` says how, a line a step.
   * @group Phases
   */
  vtkSwitchMacro(Segment, false);

  enum LumenSides
  {
    AUTO_LUMEN = 0, ///< "Found from the picture"
    BRIGHT = 1,     ///< "Brighter than walls, or solid"
    DARK = 2        ///< "Darker than walls, or solid"
  };
  /**
   * Of a scan: whether lumens are brighter or darker than walls, in volumes the void than the solid, where auto is
   * dark.
   * @group Phases
   * @choice LumenSides
   * @when Segment
   */
  vtkSettingMacro(Lumen, int, AUTO_LUMEN);

  /**
   * Of a scan: grey value between the two once the light is even, in pictures 0 to 255, in volumes as in the file.
   * Not given (-1): found.
   * @group Phases
   * @range (0, 65535)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Threshold, double, -1);

  enum Channels
  {
    AUTO_CHANNEL = 0, ///< "Found from the picture"
    GREY = 1,
    RED = 2,
    GREEN = 3,
    BLUE = 4,
    STAIN = 5
  };
  /**
   * Of a coloured scan: where to look; stain: the mixture that separates best.
   * @group Scan
   * @choice Channels
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Channel, int, AUTO_CHANNEL);

  /**
   * Of a scan: scale over which the stain may vary. 0: no flattening. Not given (-1): found.
   * @group Scan
   * @unit pixels
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Background, double, -1);

  /**
   * Of a scan: Gaussian before the threshold. 0: none. Not given (-1): found.
   * @group Scan
   * @unit pixels
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Smoothing, double, -1);

  /**
   * Of a scan: specks of lumen of fewer pixels become wall. Not given (-1): found.
   * @group Scan
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(SmallestLumen, vtkIdType, -1);

  /**
   * Of a scan: specks of wall in lumens of fewer pixels become lumen. Not given (-1): found.
   * @group Scan
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(SmallestWall, vtkIdType, -1);

  /**
   * Of a scan: radius of the disk that closes necks between lumens. 0: none. Not given (-1): found.
   * @group Scan
   * @unit pixels
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Opening, double, -1);

  /**
   * Of a scan: how far outlines move outwards, onto a dark rim. 0: not at all. Not given (-1): found.
   * @group Scan
   * @unit pixels
   * @range [0, inf)
   * @unset -1
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Rim, double, -1);

  /**
   * Of a scan: gaps in rays whose length over their width (a ratio) is larger become wall. 0: none.
   * @group Scan
   * @range [0, inf)
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(RaySlenderness, double, 3);

  /**
   * Of a scan: outlines move outwards by so much besides; inwards if negative.
   * @group Scan
   * @unit pixels
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Grow, double, 0);

  /**
   * Of a scan: margins, scale bars and text are not painted over.
   * @group Scan
   * @when Segment
   * @advanced
   */
  vtkSwitchMacro(KeepGraphics, false);

  ///@{
  /**
   * Use this part only: its first pixel and its size. In a picture y counts from the top row, in a volume every axis
   * counts from the first voxel in the file; z and depth are not used for a picture, and of polygons (micrograph) it is
   * in the file's coordinates from the lower left. Not given (all 0): everything.
   * @group Lattice
   * @columns x, y, z, width, height, depth
   * @flat z, depth
   * @unset 0
   */
  vtkSetVector6Macro(Window, int);
  vtkGetVector6Macro(Window, int);
  ///@}

  /**
   * Splits each pixel into n x n nodes (voxel into n x n x n) of a finer lattice. The geometry stays the same.
   * @word refine
   * @group Lattice
   * @range [1, 64]
   */
  vtkSettingMacro(Refinement, int, 1);

  /**
   * Edge of a pixel in metres, as 5e-7 (or 0.5um in a command); wins over what the file says. Not given (0): what the
   * file says, and 1 where it says nothing.
   * @group Lattice
   * @unit m
   * @range (0, inf)
   * @unset 0
   */
  vtkSettingMacro(PixelSize, double, 0);

  /**
   * Distance of two slices of a volume in metres, where voxels are not cubes; wins over what the file says. Not given
   * (0): what the file says, else the pixel size. Steady diffusion takes such voxels, all other solvers want cubes.
   * @group Lattice
   * @unit m
   * @range (0, inf)
   * @unset 0
   * @advanced
   */
  vtkSettingMacro(SliceDistance, double, 0);

  /**
   * Raw volumes: voxels along x, y and z. Not given (0): from a name such as berea_200x200x200_u8.raw.
   * @group Raw volumes
   * @columns nx, ny, nz
   * @range [1, inf)
   * @unset 0
   * @advanced
   */
  vtkSettingVector3Macro(RawSize, int, 0, 0, 0);

  /**
   * Raw volumes: bits of a voxel, 8 or 16; 0: from the name or the size of the file.
   * @group Raw volumes
   * @values 0 = From the name or the size; 8; 16
   * @advanced
   */
  vtkSettingMacro(RawBits, int, 0);

  /**
   * Raw volumes: bytes before the first voxel.
   * @group Raw volumes
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(RawHeader, vtkIdType, 0);

  ///@{
  /**
   * VTK image files: the array of whole numbers, at points or in cells, to take for grey values. Empty: phase, else
   * the first one.
   * @word array
   * @group VTK image files
   * @advanced
   */
  vtkSetStringMacro(ArrayName);
  vtkGetStringMacro(ArrayName);
  ///@}

#ifndef __VTK_WRAP__
  /** All of them but the file's name, as readPhases() takes them. */
  lamella::PictureOptions GetOptions() const;
#endif

protected:
  vtkPictureReader();
  ~vtkPictureReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  /** Reads the file unless it has been read with these settings. */
  bool Read();
  void Load();

  char* FileName = nullptr;
  char* OtherPhase = nullptr;
  char* ArrayName = nullptr;
  std::map<std::string, std::string> PhaseOfGreys;
  int Window[6] = { 0, 0, 0, 0, 0, 0 };

  vtkSmartPointer<vtkImageData> Image; ///< what was read
  vtkTimeStamp ReadTime;
};
