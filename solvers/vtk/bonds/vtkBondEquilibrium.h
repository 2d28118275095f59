/**
 * @class   vtkBondEquilibrium
 * @brief   displacement, stress, stiffness and first break of an image of phases under load
 *
 * Bond-based peridynamics on the lattice of the image's points (peridynamics/ElasticStudy.h): every node is bonded to
 * all nodes within the horizon, and the displacements are found at which all forces vanish, by conjugate gradients
 * preconditioned with multigrid. The bonds' materials are the settings of vtkBondAlgorithm.
 *
 * **Input**: vtkImageData with phases at its points: an array of whole numbers, `phase` unless another is chosen with
 * SetInputArrayToProcess(0, ...), and where bonds between grains have a material of their own the number of each node's
 * grain, `grain` (index 1). Nodes are pixel centres; an image of one layer along z is two-dimensional.
 *
 * **Load**: as many layers of nodes as a bond reaches are held at either end of the axis (PlatenLayers), and the strain
 * counts over the distance between their inner layers, of which the low one never moves. Sides are free.
 *
 * **Output**: the input with
 * - `displacement` (3 doubles, [m]; 0 in voids),
 * - `stress` on demand (6 doubles, VTK's order xx, yy, zz, xy, yz, xz, [Pa], tension positive; 0 in voids; of a picture
 *   zz is 0 in plane stress and ν (xx + yy) in plane strain),
 * - `strain_energy` on demand (1 double, [J/m³]).
 *
 * Field data, forces of a picture being per metre of thickness:
 * - `effective_modulus` [Pa]: `effective_stress` over `strain`; a shear modulus where the load is shear
 * - `effective_stress` [Pa]: force on the platen along the load over the section of the box, voids included
 * - `strain`: applied; of a traction the one that it causes; of a pressure what the pores gain of their volume, so that
 *   `effective_stress` is the pressure and `effective_modulus` the volumetric elastic modulus of the pores (cells)
 * - under a pressure `pore_volume` [m³] (of a picture [m²]), of the pores under it, and `open_pore_nodes`, which hold
 * none
 * - `mean_stress` [Pa]: 6 numbers, over the whole box, platens and voids included
 * - `reaction_low`, `reaction_high` [N]: 3 numbers, forces that the sample exerts on the platens
 * - `elastic_energy` [J]
 * - `first_break_strain`, `first_break_stress`, `first_break_position` (3 numbers [m]), `first_break_phases`: where and
 *   when the first bond breaks as this load grows from nothing; NaN and empty where none does and in large strains.
 *   `largest_stretch_ratio`: the largest s/s0 at this load
 * - with ComputeSensitivity, where a bond breaks, `material_numbers`: names PROPERTY:PAIR of the values that pairs hang
 *   on ("young:wall"; as the words of their settings), `material_values`, `material_uncertainty` (0: none), and by
 * these in turn `first_break_sensitivity`, the derivative of `first_break_stress` [Pa over the value's unit]; with
 *   uncertainties `first_break_input_error` [Pa], what they leave of it
 * - `load`, `load_axis`, `platen_layers` (first and last layer of the low and of the high platen, counted from 0),
 *   `continuum`, `horizon`, `poissons_ratio`
 * - `pair_names`, `pair_youngs_modulus`, `pair_critical_stretch`, `pair_fracture_energy`, `pair_toughness`: what each
 *   pair of phases was given
 * - `phase_fraction`, `phase_names`, `phase_array`
 * - `loose_pieces`, `loose_nodes`, `hinges`, `iterations`, `newton_steps`, `residual`, `solid_nodes`, `skipped_nodes`,
 *   `bonds`, `visited_strips` (uniform and mixed runs of 16 nodes), `skipped_strips`, `bytes` (all ranks)
 * - `warnings`: strings, each also given to vtkWarningMacro
 * - `bond_model`: the settings, for vtkBondStress; `provenance`: one JSON string.
 *
 * **Parallel**: with a vtkMPIController and as many pieces as processes all ranks solve together, whatever pieces the
 * pipeline gave them; the numbers are those of one rank to the tolerance.
 *
 * @warning Before the first break the response is linear: the strain given matters for SetLargeStrains() only, all else
 * scales with it.
 *
 * @sa vtkBondStress, vtkPictureReader, vtkMatrixBridges
 */

#pragma once

#include "vtkBondLoadAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondEquilibrium : public vtkBondLoadAlgorithm
{
public:
  static vtkBondEquilibrium* New();
  vtkTypeMacro(vtkBondEquilibrium, vtkBondLoadAlgorithm);

  /**
   * The low platen never moves. Stretch: the high one moves along the axis. Shear: it moves across. Biaxial: smooth
   * platens on all sides. Traction: a force spread evenly over the high end. Pressure: no platens, but a pressure in
   * pores that are closed.
   * @group Load
   * @choice STRETCH SHEAR BIAXIAL TRACTION PRESSURE
   */
  vtkSetMacro(Load, int);

  /**
   * Movement of the high platen over the distance between the platens; tension is positive. Everything scales with it,
   * but for large strains.
   * @group Load
   * @range (-1, 1)
   * @when Load STRETCH SHEAR BIAXIAL
   */
  vtkSettingMacro(Strain, double, 1e-3);
  /**
   * Biaxial: strain along the other axes.
   * @group Load
   * @range (-1, 1)
   * @when Load BIAXIAL
   * @advanced
   */
  vtkSettingMacro(LateralStrain, double, 0);
  /**
   * Traction: in Pa, tension is positive.
   * @group Load
   * @unit Pa
   * @when Load TRACTION
   * @advanced
   */
  vtkSettingMacro(Traction, double, 0);
  /**
   * Pressure: above that outside, in Pa; negative: suction, as of water under tension. Everything scales with it.
   * @group Load
   * @unit Pa
   * @when Load PRESSURE
   */
  vtkSettingMacro(Pressure, double, 1e5);

  enum Solvers
  {
    MULTIGRID = 0,
    JACOBI = 1,            ///< "Jacobi": conjugate gradients with the nodes' blocks
    DIRECT = 2,            ///< "Direct (small images)": sparse Cholesky; one rank, small images
    DYNAMIC_RELAXATION = 3 ///< "Dynamic relaxation": for comparison
  };
  /**
   * How forces are balanced. All give the same answer.
   * @group Accuracy and cost
   * @choice Solvers
   * @advanced
   */
  vtkSettingMacro(Solver, int, MULTIGRID);
  /**
   * Gives up after this many.
   * @word max-iterations
   * @group Accuracy and cost
   * @range [1, inf)
   * @when Solver MULTIGRID JACOBI DYNAMIC_RELAXATION
   * @advanced
   */
  vtkSettingMacro(MaximumIterations, int, 20000);

  ///@{
  /** As vtkBondLoadAlgorithm; a change solves nothing again. */
  void SetComputeStress(bool on) override;
  void SetComputeStrainEnergy(bool on) override;
  ///@}

  /** Later than the last change of a setting, or of what is shown. */
  vtkMTimeType GetMTime() override;

  /** Of the last update [Pa]; NaN before it. */
  vtkGetMacro(EffectiveModulus, double);
  /** Of the last update; NaN where no bond breaks. */
  vtkGetMacro(FirstBreakStrain, double);

protected:
  vtkBondEquilibrium();
  ~vtkBondEquilibrium() override;

  void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team) override;

private:
  void Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team);

  struct Internals;
  std::unique_ptr<Internals> Kept;

  void CheckLoad() const;

  double EffectiveModulus;
  double FirstBreakStrain;
};
