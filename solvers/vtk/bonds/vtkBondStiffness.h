/**
 * @class   vtkBondStiffness
 * @brief   effective stiffness tensor of an image of phases, with its error
 *
 * The image is taken as one cell of an endless medium: every side goes on at the opposite one. Its nodes are bonded as
 * vtkBondAlgorithm says, and under each unit mean strain in turn (3 of a picture, 6 of a volume) the displacements are
 * found at which all forces vanish (peridynamics/PeriodicCell.h); the mean stresses are the tensor's columns.
 *
 * **Voigt's notation**: stresses and strains xx, yy, xy of a picture; xx, yy, zz, yz, xz, xy of a volume; shear strains
 * are angles, 2ε.
 *
 * **Input**: vtkImageData with phases at its points, and where bonds between grains have a material of their own the
 * number of each node's grain; as vtkBondEquilibrium.
 *
 * **Output 0**: the input, with the numbers as field data.
 * **Output 1**, tensor: one row a stress: `stress` (its name), then for each strain `xx` … [Pa], `extrapolated_xx` …,
 * `error_xx` … (NaN where they are not known).
 * **Output 2**, constants: one row each: `constant` (E_x, …, nu_xy, …, G_xy: those under stress along one direction,
 * from the inverse), `value`, `extrapolated`, `error`, `unit` (Pa or 1). On several ranks the first holds the tables.
 *
 * **Error** (EstimateError): coarser pictures of the same cell, of every second, third and fourth pixel, are solved,
 * which takes at most four times the work (elasticity/StiffnessError.h). It is the error against the material: of the
 * lattice and of the picture. Not in it: another Poisson's ratio than the bonds', what no pixel shows, how far the cell
 * speaks for more of its material.
 *
 * **Field data**:
 * - `stiffness`, `stiffness_extrapolated`, `stiffness_error`, `stiffness_voigt`, `stiffness_reuss`: 9 or 36 numbers by
 *   rows [Pa]. The last two are bounds of the lattice's own stiffness, all nodes following the mean strain, and all
 * bonds in a uniform stress; the lower one is 0 where bonds are missing
 * - `stiffness_components`: the names xx, …; `stiffness_asymmetry`: of the tensor as solved, relative
 * - `estimated_error`: the largest relative error on the diagonal; NaN when not known
 * - `constant_names`, `constants`, `constants_extrapolated`, `constants_error`; a modulus of a direction that nothing
 *   resists is 0, Poisson's ratios there are NaN
 * - `eigenvalues` [Pa]: stiffnesses of the tensor's own strains (Kelvin's), rising; `resisting`: how many are above
 * zero
 * - `crosses`: 3 flags, whether some piece of the solid goes on into the next cell along an axis; `pieces`,
 *   `loose_pieces`, `loose_nodes` (taken out: they carry nothing)
 * - `seam_mismatch`, `layer_mismatch`: 3 numbers each, share of nodes whose neighbour across the seam is of another
 *   phase, and the largest such share between two layers within
 * - `step_every`, `step_pictures`, `step_nodes`, `step_iterations`, `step_seconds`: the image's solve, then those of
 * the pictures of about every second, third and fourth pixel; `iterations`: of each unit strain of the image;
 * `residual`, `levels`, `products`, `hinges`, `solid_nodes`, `skipped_nodes`, `bonds`, `visited_strips`,
 * `skipped_strips`, `bytes`, `seconds` (bonds, set-up, solve, the rest, the error)
 * - what vtkBondEquilibrium says of pairs, phases, thickness and warnings; `bond_model`, `provenance`.
 *
 * **Parallel**: as vtkBondEquilibrium; the numbers are those of one rank to the tolerance.
 *
 * @warning In plane strain the constants are those of the plane: E/(1 − ν²), ν/(1 − ν). The image repeats whether it
 * fits together at its sides or not; `seam_mismatch` tells how well it does.
 *
 * @without FractureEnergies Toughnesses CriticalStretches LargeStrains Periodic
 * @sa vtkBondEquilibrium, vtkMicrostructureSource, vtkPictureReader
 */

#pragma once

#include "vtkBondAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

class vtkTable;

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondStiffness : public vtkBondAlgorithm
{
public:
  static vtkBondStiffness* New();
  vtkTypeMacro(vtkBondStiffness, vtkBondAlgorithm);

  /**
   * Solve coarser pictures of the cell as well, and tell the error. At most four times the work.
   * @off no-error-estimate: Do not solve coarser pictures of the cell: no error is told.
   * @group Accuracy and cost
   */
  vtkSwitchMacro(EstimateError, true);

  /**
   * Nodes along each axis that a pixel was split in before it came here: what is a picture, for the error.
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(NodesPerPixel, int, 1);

  /**
   * Largest residual force over the forces that hold all nodes in the mean strain.
   * @group Accuracy and cost
   * @range [1e-12, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-6);
  /**
   * Gives up after this many.
   * @word max-iterations
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumIterations, int, 20000);

  /** Output 1. */
  vtkTable* GetTensor();
  /** Output 2. */
  vtkTable* GetConstants();

  /** Of the last update; NaN when it was not estimated. */
  vtkGetMacro(EstimatedError, double);

protected:
  vtkBondStiffness();
  ~vtkBondStiffness() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;

  void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team) override;

private:
  double EstimatedError;
};
