/**
 * @class   vtkMicrostructureSource
 * @brief   seeded samples whose geometry is known
 *
 * Softwood and hardwood tissue, honeycomb, checkerboard, arrays of disks or spheres, laminates, on a lattice of any
 * size: what solvers/generators makes, as vtkImageData with the array `phase` (unsigned char) at points; field data
 * `phase_names`, `pixel_size_source` ("option") and `provenance`. The same settings and seed give the same bytes
 * everywhere.
 *
 * Phases are `lumen` and `wall` for softwood, hardwood and honeycomb, `matrix` and `inclusion` for the others, as ids 0
 * and 1.
 */

#ifndef vtkMicrostructureSource_h
#define vtkMicrostructureSource_h

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSmartPointer.h"            // for the image that is kept

class VTKLAMELLASOLVERSVTK_EXPORT vtkMicrostructureSource : public vtkImageAlgorithm
{
public:
  static vtkMicrostructureSource* New();
  vtkTypeMacro(vtkMicrostructureSource, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Kinds
  {
    SOFTWOOD = 0,
    HONEYCOMB = 1,
    CHECKERBOARD = 2,
    INCLUSIONS = 3, ///< disks in two dimensions, spheres in three
    LAMINATE = 4,
    HARDWOOD = 5 ///< two dimensions alone
  };
  ///@{
  /** What to make. Default SOFTWOOD. */
  vtkSetClampMacro(Kind, int, SOFTWOOD, HARDWOOD);
  vtkGetMacro(Kind, int);
  ///@}

  ///@{
  /** Nodes along x, y, z; one along z makes the sample two-dimensional. Default 200, 200, 1. */
  vtkSetVector3Macro(Size, int);
  vtkGetVector3Macro(Size, int);
  ///@}

  ///@{
  /** Distance of neighbouring nodes in metres. Default 1e-6. */
  vtkSetMacro(Spacing, double);
  vtkGetMacro(Spacing, double);
  ///@}

  ///@{
  /**
   * Share of the walls (softwood, hardwood, honeycomb) or of the inclusions (disks, spheres, laminate), between 0
   * and 1. Default 0.4. A checkerboard has one half.
   */
  vtkSetMacro(SolidFraction, double);
  vtkGetMacro(SolidFraction, double);
  ///@}

  ///@{
  /** Softwood, hardwood: another seed, another sample. Default 1. */
  vtkSetMacro(Seed, vtkIdType);
  vtkGetMacro(Seed, vtkIdType);
  ///@}

  ///@{
  /** Softwood: mean tracheid diameter across the radial files, in metres. Default 30e-6. */
  vtkSetMacro(TangentialDiameter, double);
  vtkGetMacro(TangentialDiameter, double);
  ///@}

  ///@{
  /** Softwood: mean diameter along the files at the start and at the end of the ring, in metres. 36e-6 and 15e-6. */
  vtkSetVector2Macro(RadialDiameter, double);
  vtkGetVector2Macro(RadialDiameter, double);
  ///@}

  ///@{
  /** Softwood, hardwood: place in the ring of the left and the right edge, 0 earlywood to 1 latewood. Default 0 and 0.
   */
  vtkSetVector2Macro(RingPosition, double);
  vtkGetVector2Macro(RingPosition, double);
  ///@}

  ///@{
  /**
   * Softwood: mean distance between rays in metres; 0: no rays. Default 240e-6. Hardwood has its own,
   * HardwoodRayDistance.
   */
  vtkSetMacro(RayDistance, double);
  vtkGetMacro(RayDistance, double);
  ///@}

  ///@{
  /** Softwood in three dimensions: mean length of a tracheid along z in metres, closed at both ends. 200e-6. */
  vtkSetMacro(TracheidLength, double);
  vtkGetMacro(TracheidLength, double);
  ///@}

  ///@{
  /** Softwood, hardwood: relative standard deviation of the tracheids' or fibres' diameters. Default 0.12. */
  vtkSetMacro(Scatter, double);
  vtkGetMacro(Scatter, double);
  ///@}

  ///@{
  /** Hardwood: mean diameter of a fibre, between the middles of its walls, in metres. Default 16e-6. */
  vtkSetMacro(FibreDiameter, double);
  vtkGetMacro(FibreDiameter, double);
  ///@}

  ///@{
  /** Hardwood: mean tangential diameter of the vessels at the start and at the end of the ring. 64e-6 and 40e-6. */
  vtkSetVector2Macro(VesselDiameter, double);
  vtkGetVector2Macro(VesselDiameter, double);
  ///@}

  ///@{
  /** Hardwood: share of the picture in vessels at the start and at the end of the ring, to 0.5. 0.32 and 0.15. */
  vtkSetVector2Macro(VesselShare, double);
  vtkGetVector2Macro(VesselShare, double);
  ///@}

  ///@{
  /** Hardwood: position in the ring where late vessels begin. Default 0.6; ring-porous wood has about 0.25. */
  vtkSetMacro(EarlyEnd, double);
  vtkGetMacro(EarlyEnd, double);
  ///@}

  ///@{
  /** Hardwood: share of the groups of vessels that are radial files of two to four. Default 0.45. */
  vtkSetMacro(Multiples, double);
  vtkGetMacro(Multiples, double);
  ///@}

  ///@{
  /** Hardwood: mean distance between rays in metres; 0: no rays. Default 95e-6. */
  vtkSetMacro(HardwoodRayDistance, double);
  vtkGetMacro(HardwoodRayDistance, double);
  ///@}

  ///@{
  /** Cells along x (honeycomb), along each axis (checkerboard, disks, spheres), or pairs of layers. Default 4. */
  vtkSetClampMacro(Cells, int, 1, VTK_INT_MAX);
  vtkGetMacro(Cells, int);
  ///@}

  ///@{
  /** Laminate: the axis across the layers, 0, 1 or 2. Default 0. */
  vtkSetClampMacro(Axis, int, 0, 2);
  vtkGetMacro(Axis, int);
  ///@}

protected:
  vtkMicrostructureSource();
  ~vtkMicrostructureSource() override = default;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMicrostructureSource(const vtkMicrostructureSource&) = delete;
  void operator=(const vtkMicrostructureSource&) = delete;

  void Generate();

  int Kind = SOFTWOOD;
  int Size[3];
  double Spacing;
  double SolidFraction;
  vtkIdType Seed;
  double TangentialDiameter;
  double RadialDiameter[2];
  double RingPosition[2];
  double RayDistance;
  double TracheidLength;
  double Scatter;
  double FibreDiameter;
  double VesselDiameter[2];
  double VesselShare[2];
  double EarlyEnd;
  double Multiples;
  double HardwoodRayDistance;
  int Cells = 4;
  int Axis = 0;

  vtkSmartPointer<vtkImageData> Image; ///< what was made
  vtkTimeStamp MadeTime;
};

#endif
