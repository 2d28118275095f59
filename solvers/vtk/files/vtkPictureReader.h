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

#ifndef vtkPictureReader_h
#define vtkPictureReader_h

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
   * Which grey values are which phase, one a row: a grey (0 to 255, of 16-bit pictures to 65535) or a range with both
   * ends in it (0..89, ..89, 90..), and a name such as wall or lumen. ..otsu and otsu.. part the greys where the
   * picture says, ..otsu1, otsu1..otsu2 and otsu2.. into three. Several greys may have one name. Empty: what a file
   * that lamella wrote calls them, else every grey is a phase of its own; of a volume to be segmented, void and solid.
   * @word phase, phases
   * @title Phases: grey values, name
   * @group Phases
   * @columns Grey values, Phase
   */
  void SetPhase(const char* greys, const char* name);
  void SetPhase(int grey, const char* name);
  void RemoveAllPhases();
  int GetNumberOfPhases();
  ///@}

  ///@{
  /**
   * Phase of all greys that are not listed. Empty: such a grey is an error once a phase is named.
   * @word other
   * @group Phases
   */
  vtkSetStringMacro(OtherPhase);
  vtkGetStringMacro(OtherPhase);
  ///@}

  /**
   * A raw scan: find the phases lumen and wall in a picture (list no phases then), void and solid, or the phases
   * listed, in a volume.
   *
   * By micrograph::segment and segmentVolume; field data `segmentation` says how, a line a step.
   * @group Phases
   */
  vtkSwitchMacro(Segment);

  enum LumenSides
  {
    AUTO_LUMEN = 0, ///< "Found from the picture"
    BRIGHT = 1,     ///< "Brighter than walls, or solid"
    DARK = 2        ///< "Darker than walls, or solid"
  };
  /**
   * Segment: whether lumens are brighter or darker than walls, in volumes the void than the solid, which is taken for
   * dark where nothing is said.
   * @group Phases
   * @choice LumenSides
   * @when Segment
   */
  vtkSettingMacro(Lumen, int);

  /**
   * Segment: grey value between the two once the light is even, in pictures 0 to 255, in volumes as in the file.
   * Negative: found.
   * @group Phases
   * @when Segment
   * @advanced
   */
  vtkSettingMacro(Threshold, double);

  ///@{
  /**
   * Box to cut out: x, y, z of its first pixel and its width, height, depth. In a picture y counts from the top row,
   * in a volume every axis counts from the first voxel in the file; z and depth are not used for a picture. All three
   * sizes 0: everything.
   * @group Lattice
   * @columns x, y, z, width, height, depth
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
  vtkSettingMacro(Refinement, int);

  /**
   * Size of a pixel in metres, for instance 5e-7. 0: what the file says, and 1 where it says nothing.
   * @group Lattice
   * @unit m
   * @range [0.0, inf)
   */
  vtkSettingMacro(PixelSize, double);

  /**
   * Raw volumes: voxels along x, y and z. All 0: from a name such as berea_200x200x200_u8.raw.
   * @group Raw volumes
   * @columns x, y, z
   * @range [0, inf)
   * @advanced
   */
  vtkSettingVector3Macro(RawSize, int);

  /**
   * Raw volumes: bits of a voxel, 8 or 16; 0: from the name or the size of the file.
   * @group Raw volumes
   * @values 0 = From the name or the size; 8; 16
   * @advanced
   */
  vtkSettingMacro(RawBits, int);

  /**
   * Raw volumes: bytes before the first voxel.
   * @group Raw volumes
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(RawHeader, vtkIdType);

  ///@{
  /**
   * VTK image files: the array to read. Empty: "phase", else the first array of whole numbers.
   * @word array
   * @group VTK image files
   * @advanced
   */
  vtkSetStringMacro(ArrayName);
  vtkGetStringMacro(ArrayName);
  ///@}

protected:
  vtkPictureReader();
  ~vtkPictureReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPictureReader(const vtkPictureReader&) = delete;
  void operator=(const vtkPictureReader&) = delete;

  /** Reads the file unless it has been read with these settings. */
  bool Read();
  lamella::PictureOptions Options() const;
  void Load();

  char* FileName = nullptr;
  char* OtherPhase = nullptr;
  char* ArrayName = nullptr;
  std::map<std::string, std::string> PhaseOfGreys;
  bool Segment = false;
  int Lumen = AUTO_LUMEN;
  double Threshold = -1;
  int Window[6] = { 0, 0, 0, 0, 0, 0 };
  int Refinement = 1;
  double PixelSize = 0;
  int RawSize[3] = { 0, 0, 0 };
  int RawBits = 0;
  vtkIdType RawHeader = 0;

  vtkSmartPointer<vtkImageData> Image; ///< what was read
  vtkTimeStamp ReadTime;
};

#endif
