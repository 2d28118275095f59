/**
 * @class   vtkStressPDF
 * @brief   how stresses are distributed: probability density, mean tensile and compressive stress, exponential tail
 *
 * **Input**: any vtkDataSet with stresses at its points or cells: tensors of 6 components (xx, yy, zz, xy, yz, xz, as
 * VTK has them) or 9 (by rows; the symmetric part counts), or numbers of one component. The array is `stress` at points
 * unless another is chosen with SetInputArrayToProcess(0, ...). Phases are whole numbers there as well: `phase`, or
 * what SetInputArrayToProcess(1, ...) chooses; without such an array all is one phase.
 *
 * Every point (cell) counts once, whatever its size. Points of the void, which carry no stress, are left out, and so
 * are the layers that platens hold, where bonds are missing (vtkBondEquilibrium tells which in `platen_layers` and
 * `load_axis`).
 *
 * **Output 0**, density: one row a bin. `stress`, `stress_low`, `stress_high` (in mean tensile stresses ⟨σ⁺⟩ of all
 * that is counted), `count`, `density`, `tail` (the law that was fitted, NaN below the threshold); for each phase
 * `count_<phase>` and `density_<phase>`, which is 1 when summed over the phase.
 *
 * **Output 1**, phases: one row for `all`, then one a phase: `phase`, `count`, `mean`, `deviation`, `mean_tensile`,
 * `mean_compressive`, `smallest`, `largest` [Pa], `tensile_share`, `compressive_share`; with a reference stress
 * `mean_tensile_over_reference`, `mean_compressive_over_reference`; `tail_count`, `theta`, `theta_error`.
 *
 * **Output 2**, thresholds: the fit beyond thresholds that leave 50 % … 0.5 % of the tensile values: `threshold`,
 * `tail_count`, `tail_share`, `theta`, `theta_error`, `distance`.
 *
 * **Field data** of all outputs: `stress_mean`, `stress_mean_tensile`, `stress_mean_compressive` [Pa],
 * `stress_tensile_share`, `stress_compressive_share`, `stress_theta`, `stress_theta_error`, `stress_tail_threshold`,
 * `stress_tail_count`, `stress_tail_distance`, `stress_reference`, `stress_component` and `stress_array`.
 *
 * **Tail**: P(σ) ∝ exp(−θ σ/⟨σ⁺⟩) beyond a threshold t, eq. 13 of Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E
 * 102 (2020) 022906. The likelihood of the n values beyond t is largest at θ = n / Σ (σ/⟨σ⁺⟩ − t), with standard error
 * θ/√n if they are independent. `distance` is the largest difference between the cumulative shares of values and law.
 *
 * **Parallel**: right on distributed data: points that several pieces of an image share count once, ghost points and
 * cells do not count. Counts depend neither on ranks nor on threads (vtkSMPTools), sums to round-off. Rank 0 holds the
 * tables; those of other ranks are empty.
 *
 * @warning Neighbouring points have similar stresses; the scatter of θ between samples is larger than its standard
 * error. Pieces of an unstructured grid share points; without ghost arrays, which mark them, count cells instead.
 */

#pragma once

#include "vtkLamellaFiltersModule.h"   // for export macro
#include "vtkMultiProcessController.h" // for the smart pointer
#include "vtkSetting.h"
#include "vtkSmartPointer.h"
#include "vtkTableAlgorithm.h"

#include <string> // for the phases
#include <vector> // for the phases

class VTKLAMELLAFILTERS_EXPORT vtkStressPDF : public vtkTableAlgorithm
{
public:
  static vtkStressPDF* New();
  vtkTypeMacro(vtkStressPDF, vtkTableAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Components
  {
    XX = 0,          ///< "xx"
    YY = 1,          ///< "yy"
    ZZ = 2,          ///< "zz"
    XY = 3,          ///< "xy"
    YZ = 4,          ///< "yz"
    XZ = 5,          ///< "xz"
    MEAN = 6,        ///< "Mean": a third of the trace
    VON_MISES = 7,   ///< "Von Mises": always positive
    PRINCIPAL_1 = 8, ///< "Largest principal": the largest principal stress
    PRINCIPAL_2 = 9, ///< "Middle principal"
    PRINCIPAL_3 = 10 ///< "Smallest principal": the smallest
  };
  /**
   * Which number of the tensor. An array of one component is taken as it is.
   * @group Stresses
   * @choice Components
   */
  vtkSettingMacro(Component, int, YY);

  ///@{
  /**
   * Phases to count, one a row, by name or, where no phase has that name, by number. None: all but the void.
   * @word phase, phases
   * @title Phases to count
   * @group Stresses
   */
  void AddPhase(const char* phase);
  void ClearPhases();
  int GetNumberOfPhases();
  const char* GetPhase(int i);
  ///@}

  /**
   * Leave out the layers of an image that the platens of Bond Equilibrium hold, where bonds are missing.
   * @group Stresses
   * @advanced
   * @off keep-platens: Take the layers of an image that the platens hold along, where bonds are missing.
   */
  vtkSwitchMacro(LeaveOutPlatens, true);

  /**
   * Width of a bin of the density, in mean tensile stresses.
   * @group Tail and density
   * @range (0, inf)
   */
  vtkSettingMacro(BinWidth, double, 0.05);

  /**
   * Where the density begins and ends, in mean tensile stresses. 0 and 0: wherever stresses are.
   * @group Tail and density
   * @columns from, to
   * @advanced
   */
  vtkSettingVector2Macro(Range, double, 0, 0);

  /**
   * Where the tail begins, in mean tensile stresses. 0: by the tail's share.
   * @group Tail and density
   * @range [0, inf)
   */
  vtkSettingMacro(Threshold, double, 0);

  /**
   * Where the threshold is 0: the largest tensile stresses that are the tail, as a share of all tensile ones.
   * @group Tail and density
   * @range (0, 1]
   */
  vtkSettingMacro(TailShare, double, 0.1);

  /**
   * A stress to compare the means with [Pa], such as the pure matrix's at the same strain. 0: none.
   * @group Stresses
   * @word reference
   * @unit Pa
   * @range [0, inf)
   */
  vtkSettingMacro(ReferenceStress, double, 0);

  /** Outputs 1 and 2. */
  vtkTable* GetPhaseTable();
  vtkTable* GetThresholdTable();

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkStressPDF();
  ~vtkStressPDF() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Work;

  std::vector<std::string> Phases;
  vtkSmartPointer<vtkMultiProcessController> Controller = vtkMultiProcessController::GetGlobalController();
};
