/**
 * @class   vtkMicrographContours
 * @brief   outlines of lumens in a picture of phases
 *
 * Finds the outlines at a resolution finer than the pixels (micrograph/ContourExtraction.h): each chain encloses as
 * much area as the pixels it goes around, chains never cross, and wall inside lumens is taken out.
 *
 * **Input**: vtkImageData of one layer with, at its points,
 * - phases: an array of whole numbers, `phase` unless another is chosen with SetInputArrayToProcess(0, ...); everything
 *   that is no lumen is wall;
 * - or, chosen with SetBasis, numbers in any array, `lumen_share` unless another is chosen with
 *   SetInputArrayToProcess(1, ...): lumens are where they pass a level, or they are lumen's shares of the pixels
 *   (micrograph/ShareLevel.h). These outlines have areas of second order in the pixel, and are not smoothed.
 *
 * **Output**: vtkPolyData, a poly-line a chain with the lumen on its left, over the picture: closed ones end with the
 * id of their first point, open ones at the picture's border. Cell arrays `lumen` (number from 1), `closed`, and of the
 * whole lumen `area` [m^2], `solidity`, `equivalent_diameter` [m]. Field data: `size` (2) and `corner` (3) of the
 * picture [m], `wall_fraction`, `lumens`, `open_lumens`, `islands`, `nested_lumens`, `small_lumens`, `ragged_lumens`,
 * `area_missing` [pixels^2], `report` (strings), `pixel_size_source`, `provenance`.
 *
 * On several ranks the first one has all outlines.
 *
 * @sa vtkMicrographPolygonReader vtkMicrographLattice vtkPictureReader
 */

#ifndef vtkMicrographContours_h
#define vtkMicrographContours_h

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // for the phase

class vtkImageData;

class VTKLAMELLASOLVERSVTK_EXPORT vtkMicrographContours : public vtkPolyDataAlgorithm
{
public:
  static vtkMicrographContours* New();
  vtkTypeMacro(vtkMicrographContours, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Bases
  {
    PHASES = 0,
    LEVEL = 1, ///< numbers that vary smoothly; crossings of the level by linear interpolation
    SHARES = 2 ///< lumen's share of each pixel, 0 to 1
  };
  ///@{
  /** What outlines are found in. Default PHASES. */
  vtkSetClampMacro(Basis, int, PHASES, SHARES);
  vtkGetMacro(Basis, int);
  ///@}

  ///@{
  /**
   * LEVEL: the value between lumens and walls; of unsigned numbers of 8 and 16 bits as a part of the largest one.
   * Default 0.5.
   */
  vtkSetMacro(Level, double);
  vtkGetMacro(Level, double);
  ///@}

  ///@{
  /** LEVEL: lumens are where values are below it; SHARES: they are the wall's. Default off. */
  vtkSetMacro(LumenBelow, bool);
  vtkGetMacro(LumenBelow, bool);
  vtkBooleanMacro(LumenBelow, bool);
  ///@}

  ///@{
  /**
   * The phase of the lumens: its name, or its number where phases have no names. Empty (default): the first that is
   * called void, pore, lumen or air.
   */
  vtkSetMacro(LumenPhase, std::string);
  vtkGetMacro(LumenPhase, std::string);
  ///@}

  ///@{
  /** The steps of pixels are smoothed away, each chain's area kept. Default on. */
  vtkSetMacro(Smooth, bool);
  vtkGetMacro(Smooth, bool);
  vtkBooleanMacro(Smooth, bool);
  ///@}

  ///@{
  /** Waves along an outline that are shorter are damped, in pixels: 4 to 200. Default 20. */
  vtkSetMacro(Wavelength, double);
  vtkGetMacro(Wavelength, double);
  ///@}

  ///@{
  /** Points that far from the line through their neighbours are left out, in pixels; 0: all stay. Default 0.02. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /** Smaller lumens become wall, in square metres. Default 0. */
  vtkSetMacro(SmallestArea, double);
  vtkGetMacro(SmallestArea, double);
  ///@}

  ///@{
  /** Closed lumens that fill a smaller share of their convex hull become wall, 0 to 1. Default 0. */
  vtkSetMacro(LeastSolidity, double);
  vtkGetMacro(LeastSolidity, double);
  ///@}

protected:
  vtkMicrographContours();
  ~vtkMicrographContours() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMicrographContours(const vtkMicrographContours&) = delete;
  void operator=(const vtkMicrographContours&) = delete;

  void Extract(vtkImageData* image, vtkPolyData* outlines);

  int Basis = PHASES;
  double Level = 0.5;
  bool LumenBelow = false;
  std::string LumenPhase;
  bool Smooth;
  double Wavelength;
  double Tolerance;
  double SmallestArea;
  double LeastSolidity;
};

#endif
