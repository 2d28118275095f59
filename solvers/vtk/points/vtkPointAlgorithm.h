/**
 * @class   vtkPointAlgorithm
 * @brief   an image of phases as material points: walls, plane and grid; what the solvers on points share
 *
 * Every node of the image that is not void becomes PointsPerNode points along each axis (mpm/MaterialPoints.h), on a
 * grid of CellsPerNode cells a node.
 *
 * **Input**: vtkImageData, whole, with phases at its points (array `phase` unless SetInputArrayToProcess(0, ...) names
 * another) and, for orthotropic walls, the direction along the wall (array `axis`, 2 or 3 components of any length, as
 * vtkMicrographLattice gives it; index 1). An image of one layer along z is two-dimensional.
 *
 * **Walls**: what is set here holds for all phases, but for what SetPhaseConstant() says of one. The defaults are the
 * first paper's 8 GPa along and 6.4 GPa across the wall; docs/solvers/point-stiffness.md says what it leaves open.
 *
 * **Voids** carry no points: the phases of AddVoid(), or without any those called void, pore, lumen, air or 0 that have
 * no constants of their own.
 *
 * **Parallel**: where the ranks of a controller do not work together, the first piece has all that comes out; the
 * others are empty.
 *
 * @sa vtkPointCompression, vtkPointStiffness
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSampleAlgorithm.h"

#include <memory> // for std::unique_ptr

class vtkImageData;

namespace lamella
{
struct PointSettings;
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkPointAlgorithm : public vtkSampleAlgorithm
{
public:
  vtkTypeMacro(vtkPointAlgorithm, vtkSampleAlgorithm);

  enum Laws
  {
    AUTO_LAW = 0, ///< "Automatic: orthotropic where the image has directions": orthotropic where the image has
                  ///< directions along the walls, else isotropic
    ISOTROPIC = 1,
    ORTHOTROPIC = 2,
    PLASTIC = 3,            ///< "Plastic": isotropic, yields (J2, linear hardening); in plane strain and in space
    ORTHOTROPIC_PLASTIC = 4 ///< "Orthotropic, plastic": orthotropic, yields by Hill's criterion on the wall's axes
                            ///< (linear hardening); in plane strain and in space
  };
  /**
   * Law of all walls, for large rotations. Plastic walls yield, in plane strain and in space.
   * @group Walls
   * @choice Laws
   */
  vtkSettingMacro(Law, int, AUTO_LAW);

  enum Planes
  {
    AUTO_PLANE = 0, ///< "Automatic: plane stress, plane strain where walls yield": plane stress; plane strain where
                    ///< walls yield; space for volumes
    PLANE_STRESS = 1,
    PLANE_STRAIN = 2
  };
  /**
   * What a picture takes the third direction for. Volumes are solved in space.
   * @group Walls
   * @choice Planes
   * @advanced
   */
  vtkSettingMacro(Plane, int, AUTO_PLANE);

  /**
   * Young's modulus of the walls [Pa], along the axis where there is one. 0: 8e9 with an axis, 7.2e9 without.
   * @word young
   * @group Walls
   * @unit Pa
   * @range (0, inf)
   * @unset 0
   */
  vtkSettingMacro(YoungsModulus, double, 0);
  /**
   * Orthotropic: Young's modulus across the axis [Pa].
   * @word transverse
   * @group Walls
   * @unit Pa
   * @when Law AUTO_LAW ORTHOTROPIC ORTHOTROPIC_PLASTIC
   * @range (0, inf)
   */
  vtkSettingMacro(TransverseModulus, double, 6.4e9);
  /**
   * Poisson's ratio; with an axis contraction across it, pulled along it.
   * @word poisson
   * @group Walls
   * @range (-1, 1)
   */
  vtkSettingMacro(PoissonsRatio, double, 0.3);
  /**
   * Orthotropic: Poisson's ratio among the directions across the axis.
   * @word transverse-poisson
   * @group Walls
   * @when Law AUTO_LAW ORTHOTROPIC ORTHOTROPIC_PLASTIC
   * @advanced
   * @range (-1, 1)
   */
  vtkSettingMacro(TransversePoissonsRatio, double, 0.3);
  /**
   * Orthotropic: shear modulus along the axis [Pa]. 0: from the others.
   * @word shear
   * @group Walls
   * @unit Pa
   * @range (0, inf)
   * @unset 0
   * @when Law AUTO_LAW ORTHOTROPIC ORTHOTROPIC_PLASTIC
   * @advanced
   */
  vtkSettingMacro(ShearModulus, double, 0);
  /**
   * What keeps points from being crushed to nothing, over the greatest stiffness of the wall.
   * @group Walls
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Barrier, double, 1);
  /**
   * Plastic: stress at which walls yield [Pa], along the axis where there is one.
   * @word yield, yield_stress
   * @group Walls
   * @unit Pa
   * @when Law PLASTIC ORTHOTROPIC_PLASTIC
   * @range (0, inf]
   */
  vtkSettingMacro(YieldStress, double, 1e8);
  /**
   * Orthotropic, plastic: stress at which walls yield across the axis [Pa], below twice that along it. 0: as along it.
   * @word transverse-yield
   * @group Walls
   * @unit Pa
   * @when Law ORTHOTROPIC_PLASTIC
   * @range (0, inf)
   * @unset 0
   */
  vtkSettingMacro(TransverseYieldStress, double, 0);
  /**
   * Orthotropic, plastic: shear stress along the axis at which walls yield [Pa]. 0: from the others.
   * @word shear-yield
   * @group Walls
   * @unit Pa
   * @when Law ORTHOTROPIC_PLASTIC
   * @range (0, inf)
   * @unset 0
   * @advanced
   */
  vtkSettingMacro(ShearYieldStress, double, 0);
  /**
   * Plastic: slope of the yield stress over the plastic strain [Pa], along the axis where there is one.
   * @group Walls
   * @unit Pa
   * @range [0, inf)
   * @when Law PLASTIC ORTHOTROPIC_PLASTIC
   */
  vtkSettingMacro(Hardening, double, 0);
  /**
   * Density of the walls [kg/m^3].
   * @group Walls
   * @unit kg/m³
   * @advanced
   * @range (0, inf)
   */
  vtkSettingMacro(Density, double, 1500);

  ///@{
  /**
   * A constant of one phase: young, transverse, poisson, transverse-poisson, shear, barrier, yield, transverse-yield,
   * shear-yield, hardening or density. An empty name is ignored (an empty row in a panel). The update fails for another
   * constant, and for a phase that the image does not know.
   * @title Constants of single phases [SI]: phase, constant, value
   * @group Walls
   * @columns Phase, Constant, Value [SI]
   * @advanced
   */
  void SetPhaseConstant(const char* phase, const char* constant, double value);
  void RemoveAllPhaseConstants();
  ///@}

  /**
   * Points along each axis in a node of the image. 0: two a cell of the grid, and two at least.
   * @group Points and grid
   * @range [0, 16]
   */
  vtkSettingMacro(PointsPerNode, int, 0);
  /**
   * Cells of the grid along each axis in a node of the image. Walls want two cells across at least.
   *
   * Cells of the grid along each axis in a node's cell, above 0; 0.5: a cell over two nodes.
   * @group Points and grid
   * @range (0, inf)
   */
  vtkSettingMacro(CellsPerNode, double, 1);

  /**
   * Platens stand where the tissue begins and ends, not at the image's ends.
   * @group Load
   */
  vtkSwitchMacro(FitPlatens, false);

protected:
  vtkPointAlgorithm();
  ~vtkPointAlgorithm() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Fills the outputs; RequestData() makes errors of VTK of what it throws. Collective over the team.
  virtual void Run(vtkImageData* input, vtkInformationVector* outputs, const lamella::Team& team) = 0;

  /// Tells observers that it sets up. @throws Cancelled where one of any rank stopped it. Collective
  void LetStop(const lamella::Team& team);

  /// All of the settings above.
  lamella::PointSettings Settings() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;

protected:
};
