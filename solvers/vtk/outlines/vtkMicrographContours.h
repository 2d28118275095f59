/**
 * @class   vtkMicrographContours
 * @brief   outlines of lumens in a picture of phases
 *
 * Finds the outlines at a resolution finer than the pixels (outlines/ContourExtraction.h): each chain encloses as
 * much area as the pixels it goes around, chains never cross, and wall inside lumens is taken out.
 *
 * **Input**: vtkImageData of one layer with, at its points,
 * - phases: an array of whole numbers, `phase` unless another is chosen with SetInputArrayToProcess(0, ...); everything
 *   that is no lumen is wall;
 * - or, chosen with SetBasis, numbers in any array, `lumen_share` unless another is chosen with
 *   SetInputArrayToProcess(1, ...): lumens are where they pass a level, or they are lumen's shares of the pixels
 *   (outlines/ShareLevel.h). These outlines have areas of second order in the pixel, and are not smoothed.
 *
 * **Output**: vtkPolyData, a poly-line a chain with the lumen on its left, over the picture: closed ones end with the
 * id of their first point, open ones at the picture's border. Cell arrays `lumen` (number from 1), `closed`, and of the
 * whole lumen `area` [m^2], `solidity`, `equivalent_diameter` [m]. Field data: `size` (2) and `corner` (3) of the
 * picture [m], `wall_fraction`, `lumens`, `open_lumens`, `islands`, `nested_lumens`, `small_lumens`, `ragged_lumens`,
 * `area_missing` [pixels^2], `report` (strings), `extraction` (how they were found, JSON: vtkOutlineDiffusion finds
 * them in coarser pictures, too), `pixel_size_source`, `provenance`.
 *
 * On several ranks the first one has all outlines.
 *
 * @sa vtkMicrographPolygonReader vtkMicrographLattice vtkOutlineDiffusion vtkPictureReader
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSetting.h"

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
    LEVEL = 1, ///< "Level": numbers that vary smoothly; crossings of the level by linear interpolation
    SHARES = 2 ///< "Shares": lumen's share of each pixel, 0 to 1
  };
  /**
   * Outlines of a phase; where numbers that vary smoothly pass a level; or from lumen's share of each pixel, 0 to 1.
   * @group Lumens
   * @choice Bases
   */
  vtkSettingMacro(Basis, int, PHASES);

  /**
   * Level: outlines where numbers that vary smoothly pass this value, between lumens' and walls'; unsigned numbers of 8
   * and 16 bits count as parts of the largest one.
   * @group Lumens
   * @when Basis LEVEL
   */
  vtkSettingMacro(Level, double, 0.5);

  /**
   * Level: lumens are where values are below it. Shares: they are the wall's.
   * @group Lumens
   * @when Basis LEVEL SHARES
   */
  vtkSwitchMacro(LumenBelow, false);

  /**
   * The phase of the lumens: its name, or its number where phases have no names. Empty: the first that is called void,
   * pore, lumen or air. All others are wall.
   * @group Lumens
   * @when Basis PHASES
   */
  vtkSettingMacro(LumenPhase, std::string, "");

  /**
   * Smooth the steps of pixels away; each outline keeps its area.
   * @group Outlines
   * @off no-smooth: Keep the steps of the pixels.
   */
  vtkSwitchMacro(Smooth, true);

  /**
   * Waves along an outline that are shorter than so many pixels are damped.
   * @group Outlines
   * @unit pixels
   * @range [4, 200]
   * @when Smooth
   * @advanced
   */
  vtkSettingMacro(Wavelength, double, 20);

  /**
   * Points nearer than so many pixels to the line through their neighbours are left out. 0: all stay.
   * @group Outlines
   * @unit pixels
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 0.02);

  /**
   * Smaller lumens become wall, in square metres.
   * @group Which ones
   * @unit m²
   * @range [0, inf)
   */
  vtkSettingMacro(SmallestArea, double, 0);

  /**
   * Lumens smaller than a circle of this diameter become wall, in metres.
   * @group Which ones
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(LeastDiameter, double, 0);

  /**
   * Closed lumens that fill a smaller share of their convex hull become wall.
   * @group Which ones
   * @range [0, 1]
   */
  vtkSettingMacro(LeastSolidity, double, 0);

protected:
  vtkMicrographContours();
  ~vtkMicrographContours() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  void Extract(vtkImageData* image, vtkPolyData* outlines);
};
