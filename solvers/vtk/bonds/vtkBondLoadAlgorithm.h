/**
 * @class   vtkBondLoadAlgorithm
 * @brief   how a bonded sample is held and loaded: the settings that equilibrium and fracture share
 *
 * Platens hold as many layers of nodes as a bond reaches at either end of the axis (PlatenLayers); strains count over
 * the distance between their inner layers. The low one never moves. Sides are free, or periodic.
 *
 * @sa vtkBondEquilibrium, vtkBondFracture
 */

#pragma once

#include "vtkBondAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

namespace lamella
{
namespace peridynamics // VTK's wrappers do not read lamella::peridynamics
{
struct Loading;
}
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondLoadAlgorithm : public vtkBondAlgorithm
{
public:
  vtkTypeMacro(vtkBondLoadAlgorithm, vtkBondAlgorithm);

  enum Loads
  {
    STRETCH = 0, ///< "Stretch": the high platen moves along the axis
    SHEAR = 1,   ///< "Shear": it moves across: along x where the axis is the last one
    BIAXIAL = 2, ///< "Biaxial": smooth platens on all sides
    TRACTION = 3 ///< "Traction": a force spread evenly over the high platen, which is not stiff
  };
  /** What is done to the sample. Default STRETCH. */
  vtkGetMacro(Load, int);

  /**
   * Axis of loading.
   * @word axis
   * @group Load
   * @choice Axes
   */
  vtkSettingMacro(LoadAxis, int, LAST_AXIS);

  /**
   * Stretch: the platens hold the component along the axis only and let the sample slip across it.
   * @group Load
   * @advanced
   */
  vtkSwitchMacro(SmoothPlatens, false);
  /**
   * All layers of a platen move alike. Off: they move as the mean strain has it, as if the sample went on, so that a
   * uniform sample is strained uniformly up to its ends; with rigid platens it breaks beside them first.
   * @group Load
   * @advanced
   */
  vtkSwitchMacro(RigidPlatens, false);
  /**
   * Layers of nodes that a platen holds. 0: as many as a bond reaches.
   * @group Load
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(PlatenLayers, int, 0);

  /**
   * Largest residual force over the forces that hold the free nodes where they are.
   * @group Accuracy and cost
   * @range [1e-12, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-6);

  /**
   * Put the stress tensor of every node into the output.
   * @group State shown
   */
  vtkSwitchMacro(ComputeStress, false);
  /**
   * Put the strain energy of every node into the output.
   * @group State shown
   */
  vtkSwitchMacro(ComputeStrainEnergy, false);

protected:
  vtkBondLoadAlgorithm() = default;
  ~vtkBondLoadAlgorithm() override = default;

  /// The settings above but the amount of the load.
  lamella::peridynamics::Loading Platens() const;
  /// As files and people call it.
  const char* LoadName() const;

  int Load = STRETCH; ///< subclasses set it: not every load is for all
};
