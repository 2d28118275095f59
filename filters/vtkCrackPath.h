/**
 * @class   vtkCrackPath
 * @brief   cracks from broken bonds: lines, in volumes surfaces, with size, direction and phases; fragments
 *
 * **Input 0**: vtkPolyData, a point at the middle of every broken bond, with the point array `bond` (3 components: from
 * one node to the other [m]) and, where they are known, `event` (or `step`), `strain` or `time`, `phases` (2), and
 * `between_grains`. Field data: `spacing`, `lattice_size`, `lattice_origin` (3 each), `horizon`, `phase_names`.
 *
 * **Input 1**, optional: vtkImageData on the same lattice with the phases at its points, `phase` unless another is
 * chosen with SetInputArrayToProcess(0, ...). Only with it is known where voids are, and only with it fragments are
 * found. A field text `bond_model` of the image tells its notches and whether bonds cross voids; the array `grain`
 * (index 1) is needed where that model asks for it. With the array `displacement` (index 2) openings are told.
 *
 * **Passes** (pictures): (1) two neighbouring nodes are parted when, of the nodes that had a bond to both, more hold to
 * one of the two than to both; (2) the edges between such nodes make chains, from which spurs and crushed pieces are
 * taken; (3) each chain becomes the smoothest line that still passes between its nodes, so that stairs are not counted
 * as length; (4) every broken bond goes to the line that it crosses.
 *
 * **Output 0**: vtkPolyData, a poly-line a path, the longest first; paths end at tips, voids, sides and junctions,
 * where they share a point. Point data: `event` and `strain` (or `time`) at which half of the bonds there were broken,
 * `phases` (2) and `between_grains` of the two nodes that are parted there, `arc_length` [m], with displacements
 * `opening` and `sliding` [m]. Cell data: `path`, `crack` (the same for paths that hang together; 1 is the longest),
 * `length`, `chord` [m], `tortuosity`, `angle`, `angle_spread` [deg], `bonds`, `counted_length` [m], `first_event`,
 * `last_event`, `first_strain`, `last_strain`, `closed`, `through_x`, `through_y` (1: on the shortest way from side to
 * side along this axis, over paths, straight across voids in which they end, and through at most two horizons of
 * solid), with displacements `largest_opening` [m].
 * **Output 1**, paths: the same as a table, with `begins_at`, `ends_at`, the places of these ends (`begin_x`,
 * `begin_y`, `end_x`, `end_y` [m]), extents and, for every pair of phases, `share_<pair>` of the length.
 * **Output 2**, pairs: `pair`, `phase_low`, `phase_high`, `between_grains`, `length` [m], `share`, `bonds`,
 * `share_of_bonds`, `counted_length` [m] or `counted_area` [m²], `share_of_counted`.
 * **Output 3**, growth: `event`, `strain` (or `time`), `length`, `main_length` [m], with times `rate`, `main_rate`
 * [m/s].
 * **Output 4**: the image of input 1 with `fragment` (int: 1 is the largest, 0 in voids).
 * **Output 5**, fragments: `fragment`, `nodes`, `area` [m²] or `volume` [m³], `share`, `touches_x_min` ...
 *
 * **Field data** of output 0: `crack_count`, `path_count`, `crack_length`, `main_length` [m], `main_through` (2: the
 * longest crack leads from side to side along x, y), `main_start`, `main_tip` (x, y [m]: where the longest crack broke
 * first, and the end of it that is farthest from there along its paths; NaN where it has no end), `main_extension` [m]
 * (length from the one to the other), `through_length`, `through_in_voids`, `through_in_solid`, `through_chord` [m],
 * `through_tortuosity` (2 each: of the shortest way along x, y; NaN where there is none),
 * `crack_angle`, `crack_angle_spread` [deg], `broken_bonds`, `counted_size` (length [m], area [m²]),
 * `count_anisotropy`, `crack_normals` (9), `left_out_cracks`, `left_out_length` [m], `left_out_bonds`,
 * `left_out_spurs`, `crushed_pieces`; with an image `fragment_count`, `fragment_largest` (share of the solid),
 * `severed` (3: no fragment reaches from side to side along this axis).
 *
 * **Volumes**: output 0 holds triangles, two for each face of two voxels that are parted as in (1), on the smoothest
 * surface that still passes between them. Cell data: `crack` (faces that share an edge; 1 has most of them), `area`
 * [m²], `normal` (those of neighbours point alike), `event` and `strain` (or `time`) at which half of the bonds there
 * were broken, `phases` (2), `between_grains`. Output 1 has a row a crack: `crack`, `area` [m²], `normal_x` ... (axial
 * mean), `alignment` (mean of (n · that)²; 1 of a plane), `first_event` ..., extents, `share_<pair>` of the area.
 * Output 2 has `area` [m²] in place of `length`, output 3 `area`, `main_area` [m²]. Field data: `crack_count`,
 * `crack_area`, `main_area` [m²], `left_out_cracks`, `left_out_faces`, and what is counted.
 *
 * **Counted**: each broken bond stands for some length (area), by Cauchy and Crofton's formula (cracks/BondCount.h).
 * That needs no path and no smoothing, and is exact but for `count_anisotropy` where a smooth crack cut all bonds
 * across it; near sides and voids bonds are missing.
 *
 * **Parallel**: right on distributed data: however broken bonds are spread over the ranks, found twice or not, the
 * answer is that of one rank. Rank 0 holds paths and tables; those of other ranks are empty. Every rank keeps its piece
 * of the image.
 *
 * @warning Sides are taken as free, so paths end at periodic ones.
 */

#pragma once

#include "vtkLamellaFiltersModule.h"   // for export macro
#include "vtkMultiProcessController.h" // for the smart pointer
#include "vtkPolyDataAlgorithm.h"
#include "vtkSetting.h"
#include "vtkSmartPointer.h"

class vtkImageData;
class vtkTable;

class VTKLAMELLAFILTERS_EXPORT vtkCrackPath : public vtkPolyDataAlgorithm
{
public:
  static vtkCrackPath* New();
  vtkTypeMacro(vtkCrackPath, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Shorter cracks are left out and counted [spacings], unless they part a wall between voids or sides; in volumes
   * those of fewer faces of voxels than its square. 0 keeps all; -1: the horizon.
   * @range [-1, inf)
   * @group Cracks
   * @unit spacings
   */
  vtkSettingMacro(MinimumLength, double, -1);

  /**
   * Branches that end in solid after no more than this are taken away [spacings]. -1: twice the horizon.
   * @range [-1, inf)
   * @group Cracks
   * @unit spacings
   * @advanced
   */
  vtkSettingMacro(SpurLength, double, -1);

  /**
   * Length of the longest bonds [spacings]. 0: as the broken bonds tell.
   * @group Cracks
   * @unit spacings
   * @range [0, 8]
   * @advanced
   */
  vtkSettingMacro(Horizon, double, 0);

  /**
   * Where there is an image, find the pieces that no unbroken bond joins.
   * @group Cracks
   * @off no-fragments: Do not look for the pieces that no unbroken bond joins.
   */
  vtkSwitchMacro(ComputeFragments, true);

  /** The image of phases, input 1. */
  void SetImageData(vtkImageData* image);
  void SetImageConnection(vtkAlgorithmOutput* image);

  /** Outputs 1 to 5. */
  vtkTable* GetPathTable();
  vtkTable* GetPairTable();
  vtkTable* GetGrowthTable();
  vtkImageData* GetImage();
  vtkTable* GetFragmentTable();

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkCrackPath();
  ~vtkCrackPath() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Work;

  vtkSmartPointer<vtkMultiProcessController> Controller = vtkMultiProcessController::GetGlobalController();
};
