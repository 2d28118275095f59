/**
 * @class   vtkPictureReader
 * @brief   picture, volume or image file → phases on a lattice
 *
 * Reads PNG, JPEG, TIFF, multi-page TIFF and numbered pictures (volumes), raw volumes and VTK image files (.vti), and
 * turns grey values into named phases. Output: vtkImageData whose points are the pixels' centres, with the array
 * `phase` (unsigned char); field data `phase_names`, `pixel_size_source`, `provenance`. Two-dimensional pictures are
 * flipped, so that they stand upright in a view: the first row in memory is the bottom row of the picture.
 *
 * With no phase named every grey value is a phase of its own, named by its value. Once one is named, a grey that is in
 * no phase is an error, unless OtherPhase says what all other greys are. Phases are named by grey values or by ranges
 * of them.
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
#include "vtkSmartPointer.h"            // for the image that is kept

#include <map>    // for the grey map
#include <string> // for the grey map

class VTKLAMELLASOLVERSVTK_EXPORT vtkPictureReader : public vtkImageAlgorithm
{
public:
  static vtkPictureReader* New();
  vtkTypeMacro(vtkPictureReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The picture; or a folder, or a pattern such as slice_%03d.png or slice_*.png, of the slices of a volume. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Names the phase of a grey value (0 to 255, of 16-bit pictures to 65535), or of a range with both ends in it, as
   * "0..89", "..89" or "90.."; "..otsu" and "otsu.." part the greys at Otsu's level, "..otsu1", "otsu1..otsu2" and
   * "otsu2.." at those of three classes. Several greys may be one phase.
   */
  void SetPhase(const char* greys, const char* name);
  void SetPhase(int grey, const char* name);
  void RemoveAllPhases();
  int GetNumberOfPhases();
  ///@}

  ///@{
  /** Phase of all greys that are not listed. Default none: such a grey is an error once a phase is named. */
  vtkSetStringMacro(OtherPhase);
  vtkGetStringMacro(OtherPhase);
  ///@}

  ///@{
  /**
   * A raw scan: find the phases `lumen` and `wall` in a picture (micrograph::segment), `void` and `solid`, or the
   * phases named, in a volume (micrograph::segmentVolume). Field data `segmentation` says how, a line a step. Default
   * off.
   */
  vtkSetMacro(Segment, bool);
  vtkGetMacro(Segment, bool);
  vtkBooleanMacro(Segment, bool);
  ///@}

  enum LumenSides
  {
    AUTO_LUMEN = 0,
    BRIGHT = 1,
    DARK = 2
  };
  ///@{
  /** Segment: whether lumens are brighter or darker than walls, void than solid. Default AUTO_LUMEN; volumes: dark. */
  vtkSetClampMacro(Lumen, int, AUTO_LUMEN, DARK);
  vtkGetMacro(Lumen, int);
  ///@}

  ///@{
  /**
   * Segment: grey value between the two once the light is even, of pictures 0 to 255, of volumes as in the file;
   * negative (the default): found.
   */
  vtkSetMacro(Threshold, double);
  vtkGetMacro(Threshold, double);
  ///@}

  ///@{
  /**
   * Box to cut out: x, y, z of its first pixel and its width, height, depth. In a picture y counts from the top row,
   * in a volume every axis counts from the first voxel in the file; z and depth are not used for a picture. All three
   * sizes 0 (the default): everything.
   */
  vtkSetVector6Macro(Window, int);
  vtkGetVector6Macro(Window, int);
  ///@}

  ///@{
  /** Each pixel becomes n × n (× n) nodes of a finer lattice, the geometry stays. Default 1. */
  vtkSetClampMacro(Refinement, int, 1, 64);
  vtkGetMacro(Refinement, int);
  ///@}

  ///@{
  /** Size of a pixel in metres; 0 (the default): what the file says, or 1 where it says nothing. */
  vtkSetClampMacro(PixelSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(PixelSize, double);
  ///@}

  ///@{
  /** Raw volumes: voxels along x, y, z; all 0 (the default): from a name such as berea_200x200x200_u8.raw. */
  vtkSetVector3Macro(RawSize, int);
  vtkGetVector3Macro(RawSize, int);
  ///@}

  ///@{
  /** Raw volumes: bits of a voxel, 8 or 16; 0 (the default): from the name or the size of the file. */
  vtkSetClampMacro(RawBits, int, 0, 16);
  vtkGetMacro(RawBits, int);
  ///@}

  ///@{
  /** Raw volumes: bytes before the first voxel. Default 0. */
  vtkSetClampMacro(RawHeader, vtkIdType, 0, VTK_ID_MAX);
  vtkGetMacro(RawHeader, vtkIdType);
  ///@}

  ///@{
  /** .vti files: the array to read; empty (the default): `phase`, else the first array of whole numbers. */
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
