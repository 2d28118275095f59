/**
 * @class   vtkLatticeBoltzmann
 * @brief   heat or vapour that diffuses through an image of phases, in time
 *
 * Steps lattice Boltzmann for ∂u/∂t = div(D grad u) on the lattice of the image's points
 * (lbm/stepping/LatticeBoltzmann.h): two relaxation times, whose state at rest is that of vtkSteadyDiffusion, or one,
 * as in Perré, Almeida, Ayouz & Frank, Annals of Forest Science 73 (2016) 147, section 3.1. Two faces keep their
 * values, the field starts at a constant.
 *
 * **Input**: that of vtkDiffusionAlgorithm.
 *
 * **Output**: the input at one of the times that are kept, which the pipeline knows as time steps [s], with
 * - `temperature` or `concentration` (double; NaN where nothing conducts),
 * - `flux` (3 doubles, −D grad u [m/s]; 0 where nothing conducts), on demand.
 * Field data: `time` [s], `inlet_flux` and `outlet_flux` (means over the faces of the direction [m/s]), `mean_value`
 * (over the box, 0 where nothing conducts); `time_step` [s], `steps` (to this time), `relaxation` (τ − ½ of the phase
 * that conducts best), `stored_nodes`, `skipped_nodes`, `updates_per_second`, `bytes`; `continued_at` (steps in the
 * checkpoint that it went on from, or 0), `states_before` (asked for, but before it), `checkpoints` (written by this
 * run), `last_checkpoint` (steps in it, or 0); `collision`, `lattice`, `direction`, `sides`, `warning` (empty, or where
 * one relaxation time is inaccurate) and `provenance`.
 *
 * All times are stepped through at the first request and kept: 8 bytes a node and time (32 with the flux).
 *
 * **Parallel**: the field is the same to the bit.
 *
 * @warning The answer of one relaxation time (BGK) depends on the time step; it is there to compare with.
 *
 * @default ComputeFlux false
 *
 * @sa vtkSteadyDiffusion
 */

#pragma once

#include "vtkDiffusionAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for members

class vtkImageData;
class vtkTable;

namespace lamella
{
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkLatticeBoltzmann : public vtkDiffusionAlgorithm
{
public:
  static vtkLatticeBoltzmann* New();
  vtkTypeMacro(vtkLatticeBoltzmann, vtkDiffusionAlgorithm);

  ///@{
  /**
   * Diffusivity of each phase in m²/s, one a row: its name (or its number, where phases have no names) and the value.
   * 0: does not conduct. Names that the image does not know do no harm.
   *
   * Finite and not negative. Each phase that has nodes must have one; what does not conduct is neither stored nor
   * visited.
   * @title Diffusivity of phases [m²/s]
   * @group Materials
   * @columns Phase, Diffusivity [m²/s]
   */
  void SetDiffusivity(const char* phase, double value);
  void RemoveAllDiffusivities();
  ///@}

  /**
   * From which face to which. x: from left to right, y: in pictures from top to bottom, z and all of a volume: from low
   * to high coordinates.
   * @group Diffusion
   * @choice X Y Z
   */
  vtkSetMacro(Direction, int);
  /**
   * Value on the face where the direction begins.
   * @group Diffusion
   */
  vtkSettingMacro(InletValue, double, 1);
  /**
   * Value on the face where it ends.
   * @group Diffusion
   */
  vtkSettingMacro(OutletValue, double, 0);
  /**
   * Value inside at time 0.
   * @group Diffusion
   */
  vtkSettingMacro(InitialValue, double, 0);

  enum Collisions
  {
    AUTO_COLLISION = 0, ///< "Automatic": TRT
    BGK = 1,            ///< "One relaxation time (BGK)": one relaxation time; faces and mirrors on the outer nodes
    TRT = 2             ///< "Two relaxation times (TRT)": two; faces half a spacing outside the outer nodes
  };
  /**
   * Automatic: two. The answer of one depends on the time step; it is there to compare with, and has its faces on the
   * outer nodes.
   * @word stepping
   * @group Accuracy and cost
   * @choice Collisions
   * @advanced
   */
  vtkSettingMacro(Collision, int, AUTO_COLLISION);

  /**
   * The last time, in seconds. 0: none is given, and the states to keep must tell it.
   * @group Time
   * @unit s
   * @range [0, inf)
   */
  vtkSettingMacro(EndTime, double, 0);
  /**
   * Times after 0 that are kept, evenly until the end: 8 bytes a node each.
   * @word frames
   * @group Time
   * @range [1, 100000]
   */
  vtkSettingMacro(NumberOfSteps, int, 10);
  ///@{
  /**
   * States at these times in seconds are kept instead of evenly spaced ones. The last one is the end.
   * @word at-time, at_times
   * @title States to keep: times [s]
   * @group States
   * @columns Time [s]
   */
  void AddStateAtTime(double time);
  void RemoveAllStatesAtTimes();
  /**
   * States at the end of these numbers of steps, even ones, are kept instead of evenly spaced times. Times are known
   * beforehand where the time step is given.
   * @word at-step, at_steps
   * @title States to keep: steps
   * @group States
   * @advanced
   */
  void AddStateAtStep(vtkIdType step);
  void RemoveAllStatesAtSteps();
  ///@}
  /**
   * Time step in seconds. 0: a relaxation of ½ at most, and such that evenly spaced times, or the last of given ones,
   * are met.
   *
   * Other times are met as nearly as pairs of steps do; the output says the time that it has.
   * @group Accuracy and cost
   * @unit s
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(TimeStep, double, 0);

  /** As vtkBondBreakAlgorithm. */
  vtkSettingMacro(CheckpointFile, std::string, "");
  /** As vtkBondBreakAlgorithm. Steps between two checkpoints. */
  vtkSettingMacro(CheckpointEvery, vtkIdType, 10000);
  /** As vtkBondBreakAlgorithm. */
  vtkSettingMacro(CheckpointSeconds, double, 0);
  /**
   * As vtkBondBreakAlgorithm.
   *
   * To the same bits; the curve has the states before it. The times asked for may differ, the time step may not.
   */
  vtkSettingMacro(ContinueFile, std::string, "");
  ///@{
  /** As vtkBondBreakAlgorithm. */
  vtkGetMacro(LastCheckpoint, vtkIdType);
  vtkSwitchMacro(KeepStates, true);
  ///@}
  ///@{
  /** The times that the last update has kept and the image of each; null where there is none such. */
  int GetNumberOfStates();
  vtkImageData* GetStateImage(int state);
  ///@}
  /**
   * A row a time that the run kept, also of those before the checkpoint that it went on from: `time` [s],
   * `inlet_flux`, `outlet_flux` [m/s], `mean_value`, `steps`.
   */
  vtkTable* GetCurve();

protected:
  vtkLatticeBoltzmann();
  ~vtkLatticeBoltzmann() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Internals;
  void Run(vtkImageData* input, const lamella::Team& team);

  std::unique_ptr<Internals> Internal;

  vtkIdType LastCheckpoint = 0;
};
