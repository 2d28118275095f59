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
 * @sa vtkBondFracture, vtkBondEquilibrium
 */

#ifndef vtkBondDynamics_h
#define vtkBondDynamics_h

#include "vtkBondBreakAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr

namespace lamella
{
class BondScene;
namespace peridynamics // VTK's wrappers do not read lamella::peridynamics
{
struct DynamicsStudyOptions;
}
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondDynamics : public vtkBondBreakAlgorithm
{
public:
  static vtkBondDynamics* New();
  vtkTypeMacro(vtkBondDynamics, vtkBondBreakAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Of phases without a density of their own [kg/m³], above 0. Default 1000. */
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}
  ///@{
  /** Density of a phase [kg/m³]. An empty name is ignored, and so are phases that the image does not have. */
  void SetPhaseDensity(const char* phase, double value);
  void RemoveAllPhaseDensities();
  ///@}

  ///@{
  /** Two platens pull the sample (default on), else what is said of its sides moves it. */
  vtkSetMacro(Pull, bool);
  vtkGetMacro(Pull, bool);
  vtkBooleanMacro(Pull, bool);
  ///@}
  /** Of a pull: STRETCH or SHEAR; default STRETCH. */
  vtkSetClampMacro(Load, int, STRETCH, SHEAR);
  ///@{
  /** Of a pull: Γ₀ [1/s]; 0 (default): such that the strain of the first break takes TravelTimes. */
  vtkSetMacro(StrainRate, double);
  vtkGetMacro(StrainRate, double);
  ///@}
  ///@{
  /** Travel times of a wave from platen to platen until the strain of the first break. Default 30. */
  vtkSetMacro(TravelTimes, double);
  vtkGetMacro(TravelTimes, double);
  ///@}
  ///@{
  /** Of a pull: share of the strain of the first break at which motion starts, in equilibrium, 0 to 1. Default 0.98. */
  vtkSetMacro(StartShare, double);
  vtkGetMacro(StartShare, double);
  ///@}

  ///@{
  /**
   * The nodes of a side keep this speed along a component [m/s]; components without one are free. PlatenLayers says how
   * many layers. An empty name is ignored.
   * @param side "x-", "x+", "y-", "y+" (the top of a picture), "z-" or "z+"
   * @param component "x", "y" or "z"
   */
  void SetSideVelocity(const char* side, const char* component, double speed);
  void RemoveAllSideVelocities();
  ///@}
  ///@{
  /** Force on the area of a side [Pa] along a component, whichever the side is, spread over its layers. */
  void SetSideTraction(const char* side, const char* component, double traction);
  void RemoveAllSideTractions();
  ///@}
  ///@{
  /** The nodes between two corners [m] keep this speed along a component [m/s]. */
  void AddBoxVelocity(
    double x1, double y1, double z1, double x2, double y2, double z2, const char* component, double speed);
  void RemoveAllBoxVelocities();
  ///@}
  ///@{
  /** Of all that is free, at the start [m/s]. Default none. */
  vtkSetVector3Macro(InitialVelocity, double);
  vtkGetVector3Macro(InitialVelocity, double);
  ///@}
  ///@{
  /** Adds the point array `velocity` of the input (SetInputArrayToProcess(2, ...)) to that. Default off. */
  vtkSetMacro(UseInputVelocity, bool);
  vtkGetMacro(UseInputVelocity, bool);
  vtkBooleanMacro(UseInputVelocity, bool);
  ///@}

  ///@{
  /** The imposed speeds give way to what breaks, and come back: relaxation time τ [s]. 0 (default): they do not. */
  vtkSetMacro(Relaxation, double);
  vtkGetMacro(Relaxation, double);
  ///@}
  ///@{
  /** ω₀ [J], of a picture [J/m]; 0 (default): the energy of a crack of ReferenceCrack. */
  vtkSetMacro(ReferenceEnergy, double);
  vtkGetMacro(ReferenceEnergy, double);
  ///@}
  ///@{
  /** Δℓ [m]: a crack of that length (of a volume that square) in the pair with the least fracture energy. 0 (default):
   * a hundredth of the sample's shortest side. */
  vtkSetMacro(ReferenceCrack, double);
  vtkGetMacro(ReferenceCrack, double);
  ///@}
  ///@{
  /** Share of the imposed speeds at first, 0 to 1; below 1 only with a Relaxation. Default 1. */
  vtkSetMacro(StartRate, double);
  vtkGetMacro(StartRate, double);
  ///@}

  ///@{
  /** Viscous force on every node, as a share of the least critical viscosity √(2 m k/|ξ|) of all bonds, 0 to 1. Default
   * 0: none. */
  vtkSetMacro(Damping, double);
  vtkGetMacro(Damping, double);
  ///@}
  ///@{
  /** Step [s]; 0 (default): StepShare of the largest stable one. One above that is refused. */
  vtkSetMacro(TimeStep, double);
  vtkGetMacro(TimeStep, double);
  ///@}
  ///@{
  /** Step over the largest stable one, 1e-5 to 1. Default 0.8. */
  vtkSetMacro(StepShare, double);
  vtkGetMacro(StepShare, double);
  ///@}
  ///@{
  /** Ends there [s]; 0 (default): no limit. Without Pull some end must be told. */
  vtkSetMacro(EndTime, double);
  vtkGetMacro(EndTime, double);
  ///@}
  ///@{
  /** Steps between two points of the history; 0 (default): 500 points until EndTime, at least 20 steps apart; with
   * Pull or without a time every 10 steps. */
  vtkSetClampMacro(HistoryEvery, vtkIdType, 0, VTK_ID_MAX);
  vtkGetMacro(HistoryEvery, vtkIdType);
  ///@}
  ///@{
  /** States to keep on the way, at the step nearest to these times [s]. */
  void AddStateAtTime(double time);
  void RemoveAllStatesAtTimes();
  ///@}
  ///@{
  /** Whether the states carry velocities. Default on. Off and on again runs nothing. */
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
  vtkBondDynamics(const vtkBondDynamics&) = delete;
  void operator=(const vtkBondDynamics&) = delete;

  /// What moves the sample. @throws lamella::ParameterError
  void SetMovement(const lamella::BondScene& scene, lamella::peridynamics::DynamicsStudyOptions& options) const;

  struct Internals;
  std::unique_ptr<Internals> Internal;

  double Density = 1000;
  bool Pull = true;
  double StrainRate = 0;
  double TravelTimes = 30;
  double StartShare = 0.98;
  double InitialVelocity[3] = { 0, 0, 0 };
  bool UseInputVelocity = false;
  double Relaxation = 0;
  double ReferenceEnergy = 0;
  double ReferenceCrack = 0;
  double StartRate = 1;
  double Damping = 0;
  double TimeStep = 0;
  double StepShare = 0.8;
  double EndTime = 0;
  vtkIdType HistoryEvery = 0;
  bool ComputeVelocity = true;
};

#endif
