/**
 * @class   vtkCollapseMap
 * @brief   which cells of a tissue give way in compression, and when
 *
 * **Input 0**: vtkImageData with the phases at its points as they were at the start: whole numbers, `phase` unless
 * another is chosen with SetInputArrayToProcess(0, ...).
 *
 * **Input 1**: vtkPolyData, the material points that were made from this image, with the point arrays `id` (the place
 * of each in the order in which they were made) and `deformation_gradient` (9 components by rows or, of a picture, 4).
 * All time steps that this input offers are states; or, where there are several connections, each is one state. The
 * strain of a state is its field data `strain`; without one, its time. Strains rise, compression positive.
 *
 * **Output 0**: the image with `lumen` (int: label, 1 is the largest; 0 in walls), `lumen_ratio` (float: area, or
 * volume, in the last state over that at the start; NaN in walls) and `collapse_strain` (float: strain at which that
 * first fell below Share, linear between states; NaN in walls and where it never did).
 * **Output 1**, lumens: one row a lumen: `lumen`, what vtkPoreFloodFill tells of a pore (size, place, box, which sides
 * it touches), `cut` (1 where the sample's rim cuts it), `ratio`, `collapse_strain`.
 * **Output 2**, states: one row a state: `strain`, `collapsed`, `collapsed_share` (of the lumens), `ratio` (area of all
 * lumens over that at the start).
 *
 * **Field data** of all outputs: `lumen_count`, `lumen_cut`, `lumen_collapsed`, `lumen_ratio` (of all in the last
 * state), `first_collapse_strain` (NaN: none), `collapse_share`, `state_count`.
 *
 * **Areas** are sums over the edges of pixels (faces of voxels) between a lumen and the wall; their corners are carried
 * along by the nearest points of the nodes that share them, x = x_p + F_p (X − X_p). A lumen that the rim cuts is
 * closed by the straight line (plane) that fits best the wall on its side (compression/LumenAreas.h).
 *
 * **Parallel**: image and points are taken whole by every rank; the first one holds the tables.
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaFiltersModule.h" // for export macro
#include "vtkSetting.h"

#include <memory> // for the run
#include <string> // for the phase
#include <vector> // for the times

class vtkPolyData;
class vtkTable;

class VTKLAMELLAFILTERS_EXPORT vtkCollapseMap : public vtkImageAlgorithm
{
public:
  static vtkCollapseMap* New();
  vtkTypeMacro(vtkCollapseMap, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The phase that lumens are of: its name, or its number where phases have no names. Empty: the first that is called
   * void, pore, lumen or air.
   * @word lumen, phase
   * @group Lumens
   */
  vtkSettingMacro(Phase, std::string, "");

  /**
   * Share of its area at the start at which a lumen has collapsed.
   * @group Lumens
   * @range (0, 1)
   */
  vtkSettingMacro(Share, double, 0.5);

  /**
   * Lumens of fewer pixels or voxels are left out.
   * @group Lumens
   * @range [0, inf)
   */
  vtkSettingMacro(MinimumSize, int, 1);

  /** The points, input 1: where they come from, time steps and all; or one state more. */
  void SetPointsConnection(vtkAlgorithmOutput* points);
  void AddPointsData(vtkPolyData* points);
  void RemoveAllPoints();

  /** Outputs 1 and 2. */
  vtkTable* GetLumenTable();
  vtkTable* GetStateTable();

protected:
  vtkCollapseMap();
  ~vtkCollapseMap() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Work;

  std::vector<double> Times; ///< of the steps that input 1 offers
  std::size_t Step = 0;      ///< the one that is asked for
  std::unique_ptr<Work> Run; ///< from the first step to the last
};
