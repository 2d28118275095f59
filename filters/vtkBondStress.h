/**
 * @class   vtkBondStress
 * @brief   stress tensor of every node from its displacement and its bonds
 *
 * The stress of node i is the sum over its bonds of f ⊗ (ξ + η) over twice the node's volume, with f the bond's force,
 * ξ its vector and η the difference of the displacements of its ends (f ⊗ ξ in small strains). The factor of two is
 * there because each bond is met from both its ends; so the mean over a section is the force through it (Frank et al.,
 * Phys. Rev. E 102 (2020) 022906, eq. 10, which lacks the factor).
 *
 * **Input**: vtkImageData with `phase` (SetInputArrayToProcess(0, ...)), where the model asks for it `grain` (index 1),
 * and `displacement` (index 2; 3 components, or 2 of a picture; finite wherever there are bonds) at its points. The
 * model comes with the field text `bond_model` that vtkBondEquilibrium writes, or with ModelFromInput off from the
 * settings of vtkBondAlgorithm.
 *
 * **Output**: the input with `stress` (6 doubles, VTK's order xx, yy, zz, xy, yz, xz, [Pa], tension positive; 0 in
 * voids; of a picture zz is 0 in plane stress and ν (xx + yy) in plane strain), with StrainEnergy also `strain_energy`
 * [J/m³], and the field data `mean_stress` (6 numbers, over the whole box) and `provenance`.
 *
 * **Parallel**: as vtkBondEquilibrium.
 *
 * @sa vtkBondEquilibrium
 */

#pragma once

#include "vtkBondAlgorithm.h"
#include "vtkLamellaFiltersModule.h" // for export macro

class VTKLAMELLAFILTERS_EXPORT vtkBondStress : public vtkBondAlgorithm
{
public:
  static vtkBondStress* New();
  vtkTypeMacro(vtkBondStress, vtkBondAlgorithm);

  /**
   * Take the model of the bonds from the input, which Bond Equilibrium wrote there (field text `bond_model`); it is an
   * error when there is none. Off: from the settings below.
   * @group Input
   */
  vtkSwitchMacro(ModelFromInput, true);

  /**
   * Also the strain energy of every node.
   * @group Input
   */
  vtkSwitchMacro(ComputeStrainEnergy, false);

protected:
  vtkBondStress();
  ~vtkBondStress() override = default;

  void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team) override;
};
