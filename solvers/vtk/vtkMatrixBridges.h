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
 * 2 grain) and `grain` (number from 1; 0: none, −1: platen). Field data: `phase_names`, `pixel_size_source`, `width`,
 * `reach`, `bridges`, `grain_fraction`, `matrix_fraction`, `void_fraction` and `saturation` of the geometry,
 * `saturation_on_lattice` of the nodes (all without platens), `provenance`.
 *
 * The image's size follows from the packing, so the input is brought up to date when information is asked for. On
 * several ranks each computes the whole.
 *
 * @sa vtkGrainPacking vtkPackingReader vtkSteadyDiffusion
 */

#ifndef vtkMatrixBridges_h
#define vtkMatrixBridges_h

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSmartPointer.h"            // for the image that is kept

class vtkPolyData;

class VTKLAMELLASOLVERSVTK_EXPORT vtkMatrixBridges : public vtkImageAlgorithm
{
public:
  static vtkMatrixBridges* New();
  vtkTypeMacro(vtkMatrixBridges, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Width of a bridge at a grain's centre over the grain's diameter, α: 0 (none) to 2. Default 0.5. */
  vtkSetMacro(Width, double);
  vtkGetMacro(Width, double);
  ///@}

  ///@{
  /** Grains whose centres are nearer than this times the sum of their radii get a bridge, β: 1 to 2. Default 1.1. */
  vtkSetMacro(Reach, double);
  vtkGetMacro(Reach, double);
  ///@}

  ///@{
  /** All of the space between the grains is matrix; Width is not used. Default off. */
  vtkSetMacro(Filled, bool);
  vtkGetMacro(Filled, bool);
  vtkBooleanMacro(Filled, bool);
  ///@}

  ///@{
  /**
   * Share of the space between the grains, over the whole box, that is to be matrix: the width is solved for.
   * 0 (default): Width is used.
   */
  vtkSetMacro(Saturation, double);
  vtkGetMacro(Saturation, double);
  ///@}

  ///@{
  /**
   * Bridges to the walls along the last axis too, as to the grains' mirror images beyond them. Default off: a platen
   * then only touches grains.
   */
  vtkSetMacro(WallBridges, bool);
  vtkGetMacro(WallBridges, bool);
  vtkBooleanMacro(WallBridges, bool);
  ///@}

  ///@{
  /** Nodes along x; the spacing is the box's first edge over them. Default 400. */
  vtkSetMacro(NodesAcross, vtkIdType);
  vtkGetMacro(NodesAcross, vtkIdType);
  ///@}

  ///@{
  /** Thickness in metres of a plate of grain material below and above, along the last axis. Default 0. */
  vtkSetMacro(Platen, double);
  vtkGetMacro(Platen, double);
  ///@}

protected:
  vtkMatrixBridges();
  ~vtkMatrixBridges() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMatrixBridges(const vtkMatrixBridges&) = delete;
  void operator=(const vtkMatrixBridges&) = delete;

  bool Cement(vtkPolyData* particles); ///< makes Image, unless it is up to date; says what is wrong

  double Width;
  double Reach;
  bool Filled;
  bool WallBridges;
  double Saturation = 0;
  vtkIdType NodesAcross;
  double Platen;

  vtkSmartPointer<vtkImageData> Image; ///< what was made
  vtkTimeStamp MadeTime;
};

#endif
