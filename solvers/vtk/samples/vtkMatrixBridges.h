/**
 * @class   vtkMatrixBridges
 * @brief   cements grains with a matrix, on a lattice
 *
 * Between the centres of each pair of grains that touch or nearly do, a bridge of matrix: in 2D a trapezoid, in 3D a
 * truncated cone, whose width at each end is a share of that grain's diameter (packing/Bridges.h). Where grain and
 * bridge overlap there is grain.
 *
 * **Input**: particles, as vtkGrainPacking and vtkPackingReader give them: points with the array `radius`.
 *
 * **Output**: vtkImageData, x across and the last axis along the packing's; point arrays `phase` (0 void, 1 matrix,
 * 2 grain) and `grain` (number from 1; 0: none, −1: platen), with Shares `grain_share` and `solid_share`. Field data:
 * `phase_names`, `pixel_size_source`, `width`, `reach`, `bridges`, `grain_fraction`, `matrix_fraction`, `void_fraction`
 * and `saturation` of the geometry, `saturation_on_lattice` of the nodes (all without platens), `provenance`.
 *
 * The image's size follows from the packing, so the input is brought up to date when information is asked for. On
 * several ranks each computes the whole.
 *
 * @sa vtkGrainPacking vtkPackingReader vtkSteadyDiffusion
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for the image that is kept

class vtkPolyData;

class VTKLAMELLASOLVERSVTK_EXPORT vtkMatrixBridges : public vtkImageAlgorithm
{
public:
  static vtkMatrixBridges* New();
  vtkTypeMacro(vtkMatrixBridges, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Width of a bridge at a grain's centre over the grain's diameter. Not used where Filled is on or a Saturation is
   * given.
   * @group Matrix
   * @when Filled 0
   * @range [0, 2]
   */
  vtkSettingMacro(Width, double, 0.5);

  /**
   * Grains whose centres are nearer than this times the sum of their radii get a bridge.
   * @group Matrix
   * @range [1, 2]
   */
  vtkSettingMacro(Reach, double, 1.1);

  /**
   * All of the space between the grains is matrix.
   * @group Matrix
   */
  vtkSwitchMacro(Filled, false);

  /**
   * Share of the space between the grains that is to be matrix: the width is found for it. 0: Width is used.
   * @group Matrix
   * @range [0, 1]
   * @when Filled 0
   */
  vtkSettingMacro(Saturation, double, 0);

  /**
   * Bridges to the walls below and above too, as to the grains' mirror images beyond them. Without, a platen only
   * touches grains.
   * @group Matrix
   */
  vtkSwitchMacro(WallBridges, false);

  /**
   * Nodes of the lattice along x; the spacing is the box's first edge over them. Spheres: 100 are enough for a first
   * look.
   * @word nodes, nodes_across
   * @group Lattice
   * @range [2, inf)
   */
  vtkSettingMacro(NodesAcross, vtkIdType, 400);
  /**
   * Distance of the nodes in metres, instead: the nearest that divides the box. 0: by their number.
   * @group Lattice
   * @unit m
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Spacing, double, 0);

  /**
   * Thickness in metres of a plate of grain material below and above. 0: none.
   * @group Lattice
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(Platen, double, 0);

  /**
   * Also how much of each voxel is grain (array grain_share) and grain or matrix (solid_share), for solvers that take
   * shares of two phases: far nearer to the geometry than whole voxels.
   * @group Lattice
   */
  vtkSwitchMacro(Shares, false);

protected:
  vtkMatrixBridges();
  ~vtkMatrixBridges() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  bool Cement(vtkPolyData* particles); ///< makes Image, unless it is up to date; says what is wrong

  vtkSmartPointer<vtkImageData> Image; ///< what was made
  vtkTimeStamp MadeTime;
};
