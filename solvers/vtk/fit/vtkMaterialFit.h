/**
 * @class   vtkMaterialFit
 * @brief   what the phases of samples must be for these to have what was measured, as `lamella fit` finds it
 *
 * A solver of effective values, vtkSteadyDiffusion or vtkVoxelStiffness, with all that is known set (SetSolver),
 * properties of phases that are looked for and quantities that were measured: least squares in the properties'
 * logarithms on the solver's exact derivatives, with intervals (statistics/Fit.h).
 *
 * **Input**: one or several vtkImageData (AddInputConnection, AddInputDataObject), samples of the same materials, each
 * with measurements of its own, in this order. The solver's own input is left alone until then and is the fit's from
 * then on. SetInputArrayToProcess(0, ...), (1, ...), (2, ...) name arrays as they do of the solver, which they are
 * handed to; without them the solver's own count.
 *
 * **Output**: 0, the first sample as the solver gives it at the fit, which is its last solve, at the moisture of its
 * first measurement; 1, a table of what was looked for, a row an unknown, with the columns `unknown`, `value`, `low`,
 * `high`, `low_by_measurement`, `high_by_measurement`; 2, a table of what was measured, with `measured`, `value`,
 * `half_width`, `fitted`, `lattice_and_picture`. The image's field data tells
 * - `fit_unknown`: names PROPERTY:PHASE, and in their order `fit_value` and the interval that holds it 19 times out of
 *   20, `fit_low` and `fit_high`, by the measurements and, where these are known, by the errors of lattice and picture;
 *   `fit_low_by_measurement`, `fit_high_by_measurement`; `fit_correlation`: of them, by rows
 * - `fit_interval`: what the interval holds, in words
 * - `fit_measured`: names as they were given, and in their order `fit_measured_value`, `fit_measured_half_width`,
 *   `fit_fitted` (the value at the fit) and `fit_lattice_and_picture` (what these leave of that; NaN: not known), in
 *   their units
 * - `fit_misfit`: sum of squared differences over their standard deviations; `fit_freedom`: measurements less unknowns;
 *   `fit_chance`: how often chance alone makes the misfit as large, NaN without freedom; `fit_solves`
 *
 * Errors are reported with vtkErrorMacro, their remedy on a second line after `hint: `; the solver's own are among
 * them. Progress is that of solves, whose number nobody knows before; AbortExecute stops it.
 *
 * **Parallel**: every rank fits all of the samples by itself, and gives its piece of the image, the first one the
 * tables.
 *
 * @warning The solver is left without what was looked for, which is no more known than before: its output is that of
 * the fit, and another update of its own would be refused. It tells its derivatives from then on.
 */

#pragma once

#include "vtkDataObjectAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for the solver

#include <memory> // for what was found
#include <string> // for words
#include <vector> // for words

class vtkImageData;
class vtkStringArray;
class vtkTable;

#ifndef __VTK_WRAP__
namespace lamella
{
struct FitUnknown;
struct FoundFit;
}
#endif

class VTKLAMELLASOLVERSVTK_EXPORT vtkMaterialFit : public vtkDataObjectAlgorithm
{
public:
  static vtkMaterialFit* New();
  vtkTypeMacro(vtkMaterialFit, vtkDataObjectAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** What solves: a vtkSteadyDiffusion or a vtkVoxelStiffness, with all that is known set. */
  void SetSolver(vtkAlgorithm* solver);
  vtkAlgorithm* GetSolver();
  ///@}

  ///@{
  /**
   * What is looked for, and where the search begins: wall=0.4, of stiffness young:wall=1e10; without a start it finds
   * its own. slope:wall besides wall: how much it changes by where moisture, or whatever is told, changes by 1; wall
   * is then its value at 0.
   * @group Fit
   * @columns Unknown
   */
  void AddUnknown(const std::string& unknown);
  void RemoveAllUnknowns();
  ///@}

  ///@{
  /**
   * What was measured, and half of the interval that holds it 19 times out of 20 (± or +-): x=VALUE±HALF,
   * E_x=VALUE±HALF; of a second sample with 2/ before it, and for slopes the moisture behind it: 2/x@0.12=VALUE±HALF.
   * @word measured
   * @group Fit
   * @columns Measurement
   */
  void AddMeasurement(const std::string& measured);
  void RemoveAllMeasurements();
  ///@}

  /**
   * Let the solver give its fields at the fit, too.
   * @word fields
   * @group Output
   */
  vtkSwitchMacro(ComputeFields, true);

  /** Of the solver, too, but for what the fit itself sets of it. */
  vtkMTimeType GetMTime() override;

  /** Output 0. */
  vtkImageData* GetImage();
  /** Output 1. */
  vtkTable* GetFound();
  /** Output 2. */
  vtkTable* GetMeasured();

  /** Words of a solver's settings, by its class, that a fit sees to itself or has no use for. */
  static void GetSettingsLeftOut(const std::string& className, vtkStringArray* words);

#ifndef __VTK_WRAP__
  /** All that the last update found, to tell of it. */
  const lamella::FoundFit& GetFindings() const;
#endif

protected:
  vtkMaterialFit();
  ~vtkMaterialFit() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  void Fit(const std::vector<vtkSmartPointer<vtkImageData>>& samples, vtkImageData* output);
  void RequireKnown(const std::vector<lamella::FitUnknown>& unknowns) const;
  void Solve(vtkImageData* sample);
  void TakeProgress();
  void Ignore() {}

  vtkSmartPointer<vtkAlgorithm> Solver;
  vtkMTimeType SolverTime = 0;    ///< of the solver as the last update left it
  vtkMTimeType SolverChanged = 0; ///< by others since, or before that
  std::vector<std::string> Unknowns;
  std::vector<std::string> Measurements;
  std::unique_ptr<lamella::FoundFit> Findings;
};
