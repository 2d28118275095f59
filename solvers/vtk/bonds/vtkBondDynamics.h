/**
 * @class   vtkBondDynamics
 * @brief   bonds in motion: waves and cracks that run in an image of phases, with every energy accounted for
 *
 * Moves all nodes by velocity Verlet with the nonlinear force, and breaks bonds as they reach their critical elongation
 * (peridynamics/fracture/DynamicsStudy.h). The bonds' materials are the settings of vtkBondAlgorithm; pairs without a
 * critical stretch, toughness or fracture energy never break.
 *
 * **Input**: an image of phases, as vtkBondEquilibrium. Each phase has a density (SetPhaseDensity, Density).
 *
 * **What moves the sample**: either two platens pull it apart (Pull, Load), from an equilibrium just short of the first
 * break and with the speeds that the pull would have given it; or, with Pull off, speeds and tractions of its sides
 * (SetSideVelocity, SetSideTraction), speeds of boxes of nodes (AddBoxVelocity), and velocities at the start
 * (InitialVelocity, UseInputVelocity). Imposed speeds may give way to what breaks (Relaxation): the second paper's
 * equations A1 and A2.
 *
 * **Output 0**: the input in one state (State) with `damage`, `broken`, `displacement` as vtkBondFracture, `velocity`
 * (3 doubles, [m/s]; 0 in voids), unless switched off, and `stress`, `strain_energy` on demand. Its time is that of the
 * motion [s].
 *
 * **Output 1**, broken bonds: as vtkBondFracture, with the point data `event` (from 1; bonds of one step share it),
 * `step`, `time` [s], `energy` (that the bond held, [J], [J/m] of a picture), `bond`, `phases`, `between_grains`.
 *
 * **Output 2**, curve: vtkTable with `time` [s], `strain`, `stress` [Pa], `rate`, `kinetic_energy`, `elastic_energy`,
 * `broken_energy`, `damped_energy`, `supplied_energy` [J], [J/m], `energy_defect`, `broken`, `step`. With Pull, strain
 * and stress are those of the platens; else strain is how far the two sides along LoadAxis have moved apart on the mean
 * over their distance, and stress the mean over the box along that axis. On several ranks the first holds outputs 1
 * and 2.
 *
 * **Field data**:
 * - `peak_stress` [Pa], `peak_strain`, `peak_time`, `peak_broken` (of the points of the history); `first_break_time`
 *   (NaN where nothing broke), `total_broken`; `end`: time, stress-fell, maximum-strain or maximum-broken;
 *   `end_reason`; `end_time`
 * - the energies of the table at the end, and `initial_energy`
 * - `steps`, `time_step`, `stable_step` [s], `viscosity` [kg/s], `mean_density` (over the box, voids included [kg/m³]),
 *   `reference_energy` (ω₀; 0 without regulation)
 * - of a pull, else NaN: `effective_modulus` [Pa], `small_strain_break` (strain of the first break in equilibrium),
 *   `strain_rate` [1/s], `travel_time` (of a wave from platen to platen [s])
 * - of the state: `time`, `strain`, `stress`, `broken_bonds`
 * - `seconds` (bonds; start; motion; fields); `continued_at`, `checkpoints`, `last_checkpoint` (steps),
 *   `states_before`; what vtkBondEquilibrium says of platens, pairs, phases, thickness, nodes and warnings; `load`
 *   (stretch, shear or sides), `compression`, `bond_model`, `provenance`.
 *
 * **Parallel**: as vtkBondEquilibrium; the same bonds break on any number of ranks.
 *
 * @warning A bond is looked at once a step and is stretched beyond its limit by then: cracks that run want smaller
 * steps (StepShare) than waves do.
 *
 * @default CheckpointEvery 1000
 *
 * @without LargeStrains Tolerance ComputeSensitivity YoungsModulusUncertainties FractureEnergyUncertainties
 * @without ToughnessUncertainties CriticalStretchUncertainties PressurePhases StraightSides
 * @sa vtkBondFracture, vtkBondEquilibrium
 */

#pragma once

#include "vtkBondBreakAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <array>  // for std::array
#include <memory> // for std::unique_ptr
#include <string> // for std::string

namespace lamella
{
namespace peridynamics // VTK's wrappers do not read lamella::peridynamics
{
struct DynamicsResult;
struct DynamicsStudyOptions;
}
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondDynamics : public vtkBondBreakAlgorithm
{
public:
  static vtkBondDynamics* New();
  vtkTypeMacro(vtkBondDynamics, vtkBondBreakAlgorithm);

  /**
   * Density of phases without one of their own [kg/m^3].
   * @group Materials
   * @unit kg/m³
   * @range (0, inf)
   */
  vtkSettingMacro(Density, double, 1000);
  ///@{
  /**
   * Density of a phase [kg/m³]. An empty name is ignored, and so are phases that the image does not have.
   * @title Density of phases [kg/m³]
   * @group Materials
   * @columns Phase, Density [kg/m³]
   */
  void SetPhaseDensity(const char* phase, double value);
  void RemoveAllPhaseDensities();
  ///@}

  /**
   * Two platens pull the sample. Off: what is said of its sides, of boxes and of velocities moves it.
   * @group Load
   * @off no-pull: No platens: what is said of its sides, of boxes and of velocities moves the sample.
   */
  vtkSwitchMacro(Pull, true);
  /**
   * Of a pull. Stretch: the platens move apart along the axis. Shear: they move across.
   * @group Load
   * @choice STRETCH SHEAR
   * @when Pull
   */
  vtkSetMacro(Load, int);
  /**
   * Of a pull [1/s]. 0: such that the strain of the first break takes Travel Times.
   * @group Load
   * @unit 1/s
   * @range [0, inf)
   * @when Pull
   */
  vtkSettingMacro(StrainRate, double, 0);
  /**
   * Travel times of a wave from platen to platen until the strain of the first break. 30 is quick, 100 slow.
   * @group Load
   * @when Pull
   * @advanced
   * @range (0, inf)
   */
  vtkSettingMacro(TravelTimes, double, 30);
  /**
   * A pull begins in equilibrium at this share of the strain of the first break, with the speeds that it would have
   * given.
   * @word start
   * @group Load
   * @range [0, 1]
   * @when Pull
   * @advanced
   */
  vtkSettingMacro(StartShare, double, 0.98);

  ///@{
  /**
   * Nodes of a side (x-, x+, y-, y+, z-, z+; y+ is the top of a picture) keep this speed along x, y or z [m/s], as many
   * layers as platens have. Components without one are free. Needs Pull off.
   * @title Speed of sides [m/s]: side, component, speed
   * @group Load
   * @columns Side, Component, Speed [m/s]
   * @when Pull 0
   */
  void SetSideVelocity(const char* side, const char* component, double speed);
  void RemoveAllSideVelocities();
  ///@}
  ///@{
  /**
   * Force on the area of a side along x, y or z [Pa], whichever the side is, spread over its layers, from the start on.
   * Needs Pull off.
   * @title Traction on sides [Pa]: side, component, traction
   * @group Load
   * @columns Side, Component, Traction [Pa]
   * @when Pull 0
   */
  void SetSideTraction(const char* side, const char* component, double traction);
  void RemoveAllSideTractions();
  ///@}
  ///@{
  /**
   * Nodes between two corners [m] keep this speed along x, y or z [m/s]. Needs Pull off.
   * @title Speed of boxes: two corners [m], component, speed [m/s]
   * @group Load
   * @columns x1 [m], y1 [m], z1 [m], x2 [m], y2 [m], z2 [m], Component, Speed [m/s]
   * @when Pull 0
   * @advanced
   */
  void AddBoxVelocity(
    double x1, double y1, double z1, double x2, double y2, double z2, const char* component, double speed);
  void RemoveAllBoxVelocities();
  ///@}
  /**
   * Of all that is free, at the start [m/s]. Needs Pull off.
   * @group Start
   * @columns x [m/s], y [m/s], z [m/s]
   * @when Pull 0
   * @advanced
   */
  vtkSettingVector3Macro(InitialVelocity, double, 0, 0, 0);
  /**
   * Add an array of the input to that. Needs Pull off.
   * @group Start
   * @when Pull 0
   * @advanced
   */
  vtkSwitchMacro(UseInputVelocity, false);

  /**
   * Imposed speeds give way to what breaks, and come back within this time [s]. 0: they do not.
   * @word tau
   * @group Loading rate
   * @unit s
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Relaxation, double, 0);
  /**
   * Reference energy of that [J/m], of a volume [J]. 0: the energy of Reference Crack.
   * @word omega0
   * @group Loading rate
   * @unit J/m, volumes J
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(ReferenceEnergy, double, 0);
  /**
   * Δℓ [m]: a crack of that length (of a volume that square) in the pair with the least fracture energy. 0: a
   * hundredth of the sample's shortest side.
   * @word delta-l
   * @group Loading rate
   * @unit m
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(ReferenceCrack, double, 0);
  /**
   * Share of the imposed speeds at first, 0 to 1; below 1 only with a Relaxation.
   * @group Loading rate
   * @range [0, 1]
   * @advanced
   */
  vtkSettingMacro(StartRate, double, 1);

  /**
   * Viscous force on every node, as a share of the least critical viscosity of the bonds. For strength by a slow pull:
   * 0.1.
   * @group Accuracy and cost
   * @range [0, 1]
   */
  vtkSettingMacro(Damping, double, 0);
  /**
   * Step [s]. 0: Step Share of the largest stable one, above which it is refused.
   * @group Accuracy and cost
   * @unit s
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(TimeStep, double, 0);
  /**
   * Step over the largest stable one. Cracks that run want 0.2 to 0.4.
   * @group Accuracy and cost
   * @range [1e-5, 1]
   */
  vtkSettingMacro(StepShare, double, 0.8);
  /**
   * Ends at this time [s]. 0: no limit; without Pull some end is needed.
   * @group Breaking
   * @unit s
   * @range [0, inf)
   */
  vtkSettingMacro(EndTime, double, 0);
  /**
   * Steps between two points of the history. 0: 500 points until the end's time, at least 20 steps apart; with platens
   * or without a time every 10 steps.
   * @group State shown
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(HistoryEvery, vtkIdType, 0);
  ///@{
  /**
   * States to keep on the way, at these times [s]. The end is always kept.
   * @word at-time, at_times
   * @title States to keep: times [s]
   * @group States
   * @columns Time [s]
   */
  void AddStateAtTime(double time);
  void RemoveAllStatesAtTimes();
  ///@}
  ///@{
  /**
   * Put the velocity of every node into the output.
   *
   * Off and on again runs nothing.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeVelocity(bool on);
  vtkGetMacro(ComputeVelocity, bool);
  vtkBooleanMacro(ComputeVelocity, bool);
  ///@}

protected:
  vtkBondDynamics();
  ~vtkBondDynamics() override;

  void Solve(vtkImageData* input, const lamella::Team& team, vtkPolyData* broken, vtkTable* curve) override;
  bool Moves() const override { return true; }
  std::vector<std::pair<std::string, bool>> MadeFields() const override;

private:
  /// What moves the sample. @throws lamella::ParameterError
  void CheckRate() const; ///< what is told of the loading rate
  void SetMovement(const lamella::BondScene& scene, lamella::peridynamics::DynamicsStudyOptions& options) const;
  void SetDensities(const lamella::BondScene& scene, lamella::peridynamics::DynamicsStudyOptions& options) const;
  void SetOptions(const lamella::BondScene& scene, lamella::peridynamics::DynamicsStudyOptions& options) const;
  /// What was found and how, in a state's field data.
  void Describe(vtkImageData* image, const lamella::BondScene& scene, const lamella::BondSettings& settings,
    const lamella::peridynamics::DynamicsResult& result, const std::array<double, 3>& velocity,
    const std::string& inputVelocity) const;

  struct Internals;
  std::unique_ptr<Internals> Internal;

  bool ComputeVelocity = true;
};
