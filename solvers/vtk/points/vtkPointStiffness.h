/**
 * @class   vtkPointStiffness
 * @brief   stiffness of an image of phases by material points, without time
 *
 * Small strains of a whole box by an implicit solve (mpm/PointStiffness.h) of the discretisation that
 * vtkPointCompression moves: the slope at which its curve begins, exactly quasi-static, in seconds. A filter of its
 * own, because it has no states, no time and nothing to go on from, and tells every axis at once. Walls, plane and grid
 * are the settings of vtkPointAlgorithm.
 *
 * **Output 0**, constants: vtkTable, a row each: `constant`, `value`, `unit` (Pa or 1). By Sides:
 * - STRAIGHT: E_x, nu_xy, … under a load along each axis between platens, the other sides straight and without force
 * - OPEN: E_x, … with free sides
 * - FIXED: E_x, … with the other sides held
 * - PERIODIC, STICKY: E_x, nu_xy, G_xy … from the inverse of the tensor.
 *
 * **Output 1**, tensor: vtkTable, a row a stress: `stress` (its name), then a column a strain, `xx`, `yy`, `xy`; xx,
 * yy, zz, yz, xz, xy of a volume [Pa], shear strains as angles. Without shear for STRAIGHT and FIXED; no rows for OPEN.
 *
 * FitPlatens here makes the box that of the tissue along every axis, and stresses count over its sections; of no
 * account for PERIODIC and STICKY.
 *
 * **Field data** of both: `constant_names`, `constants`, `stiffness` (by rows) and `stiffness_components`; `points`,
 * `nodes`, `iterations` (of conjugate gradients, all loads), `residual`, `seconds` (points, matrix and factors; loads);
 * `sides`, what vtkPointCompression says of phases, law, grid and thickness of walls; `warnings`, `point_model`,
 * `provenance`.
 *
 * @sa vtkPointCompression, vtkBondStiffness
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPointAlgorithm.h"

class vtkTable;

namespace lamella
{
class PointScene;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkPointStiffness : public vtkPointAlgorithm
{
public:
  static vtkPointStiffness* New();
  vtkTypeMacro(vtkPointStiffness, vtkPointAlgorithm);

  enum SideKinds
  {
    STRAIGHT = 0, ///< "Straight, without force": straight, without force
    OPEN = 1,
    FIXED = 2,
    PERIODIC = 3, ///< "Periodic: the whole tensor": all round: the whole tensor
    STICKY = 4 ///< "Sticky: an upper bound": walls that hold what touches them, all round: an upper bound of the tensor
  };
  /**
   * Sides across the load; periodic and sticky: all of them.
   * @group Load
   * @choice SideKinds
   */
  vtkSettingMacro(Sides, int, STRAIGHT);

  /**
   * Largest residual.
   * @group Accuracy and cost
   * @range [1e-12, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-6);
  /**
   * Gives up after this many iterations for one strain.
   * @word max-iterations
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumIterations, int, 20000);

  enum PlanEvents
  {
    /// What the solve will take is known: the call data are four numbers (double): nodes of the grid, bytes of memory,
    /// and seconds of processor time from and to, all about.
    PLAN_EVENT = 1110
  };

  /** Output 0. */
  vtkTable* GetConstants();
  /** Output 1. */
  vtkTable* GetTensor();

protected:
  vtkPointStiffness();
  ~vtkPointStiffness() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkImageData* input, vtkInformationVector* outputs, const lamella::Team& alone) override;

private:
  struct Answer;
  template <int Dim>
  Answer Solve(const lamella::PointScene& scene);
};
