/**
 * @class   vtkBondLoadAlgorithm
 * @brief   how a bonded sample is held and loaded: the settings that equilibrium and fracture share
 *
 * Platens hold as many layers of nodes as a bond reaches at either end of the axis (PlatenLayers); strains count over
 * the distance between their inner layers. The low one never moves. Sides are free, or periodic. Under a pressure in
 * closed pores (peridynamics/PorePressure.h) there are no platens: strain is what the pores gain of their volume,
 * stress the pressure.
 *
 * @sa vtkBondEquilibrium, vtkBondFracture
 */

#pragma once

#include "vtkBondAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for a return value
#include <vector> // likewise

namespace lamella
{
class BondScene;
struct BondUncertainties;
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
    STRETCH = 0,  ///< "Stretch": the high platen moves along the axis
    SHEAR = 1,    ///< "Shear": it moves across: along x where the axis is the last one
    BIAXIAL = 2,  ///< "Biaxial": smooth platens on all sides
    TRACTION = 3, ///< "Traction": a force spread evenly over the high platen, which is not stiff
    PRESSURE = 4  ///< "Pressure": in pores that are closed, without platens
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

  ///@{
  /**
   * Pressure: the empty phases in which it acts, as lumen. None: all that are empty.
   *
   * A pore that reaches a free side, or touches another empty phase, is open and holds none. An empty name is ignored.
   * @word pressure-in
   * @title Phases under pressure
   * @group Load
   * @when Load PRESSURE
   * @advanced
   */
  void AddPressurePhase(const char* phase);
  void RemoveAllPressurePhases();
  ///@}
  /**
   * Pressure: the sides of the box are planes that do not move, as if the sample went on as its mirror image, and close
   * the pores that they cut. Off: sides are free, and pores that reach them open.
   * @group Load
   * @when Load PRESSURE
   */
  vtkSwitchMacro(StraightSides, false);

  /**
   * Largest residual force over the forces that hold the free nodes where they are.
   * @group Accuracy and cost
   * @range [1e-12, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-6);

  /**
   * Also tell how the stress of the first break changes with each value of the materials: exactly, by one more
   * equilibrium.
   * @word sensitivity
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(ComputeSensitivity, false);

  ///@{
  /**
   * How far a Young's modulus may be off, one pair a row [Pa]: half of the interval that holds it 19 times out of 20.
   * The output then tells what that leaves of the stress of the first break, and ComputeSensitivity is on. Independent
   * of each other.
   *
   * `pair` is the word that SetYoungsModulus() was given; the unit is that of its value.
   * @word young-uncertainty
   * @uncertainty young
   * @title Uncertainty of Young's moduli [Pa]
   * @group Materials
   * @columns Bonds, Plus or minus [Pa]
   * @advanced
   */
  void SetYoungsModulusUncertainty(const char* pair, double value);
  void RemoveAllYoungsModulusUncertainties();
  ///@}
  ///@{
  /**
   * The same of fracture energies [J/m^2].
   * @word fracture-energy-uncertainty
   * @uncertainty fracture-energy
   * @title Uncertainty of fracture energies [J/m²]
   * @group Materials
   * @columns Bonds, Plus or minus [J/m²]
   * @advanced
   */
  void SetFractureEnergyUncertainty(const char* pair, double value);
  void RemoveAllFractureEnergyUncertainties();
  ///@}
  ///@{
  /**
   * The same of toughnesses [Pa m^(1/2)].
   * @word toughness-uncertainty
   * @uncertainty toughness
   * @title Uncertainty of toughnesses [Pa √m]
   * @group Materials
   * @columns Bonds, Plus or minus [Pa √m]
   * @advanced
   */
  void SetToughnessUncertainty(const char* pair, double value);
  void RemoveAllToughnessUncertainties();
  ///@}
  ///@{
  /**
   * The same of critical stretches, which are strains.
   * @word critical-stretch-uncertainty
   * @uncertainty critical-stretch
   * @title Uncertainty of critical stretches
   * @group Materials
   * @columns Bonds, Plus or minus
   * @advanced
   */
  void SetCriticalStretchUncertainty(const char* pair, double value);
  void RemoveAllCriticalStretchUncertainties();
  ///@}

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
  vtkBondLoadAlgorithm();
  ~vtkBondLoadAlgorithm() override;

  /// The settings above but the amount of the load.
  /// @param scene whose phases those under pressure are of
  lamella::peridynamics::Loading Platens(const lamella::BondScene& scene) const;
  /// As AddPressurePhase() got them.
  const std::vector<std::string>& PressurePhases() const;
  /// As files and people call it.
  const char* LoadName() const;
  /// How far the materials may be off. @throws ParameterError where they are of nothing
  const lamella::BondUncertainties& Uncertainties() const;
  /// Whether the first break's sensitivity is wanted.
  bool WantsSensitivity() const;

  int Load = STRETCH; ///< subclasses set it: not every load is for all

private:
  struct Internals;
  std::unique_ptr<Internals> Given;
};
