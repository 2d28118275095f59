/**
 * @class   vtkMaterialFit
 * @brief   what the phases of samples must be for these to have what was measured, as `lamella fit` finds it
 *
 * A solver of effective values, vtkSteadyDiffusion or vtkVoxelStiffness, with all that is known set (SetSolver), one or
 * several samples (AddSample), properties of phases that are looked for and quantities that were measured: least
 * squares in the properties' logarithms on the solver's exact derivatives, with intervals (statistics/Fit.h).
 *
 * Update() fits, each time it is called; it has no part in a pipeline. The samples are solved once more at the fit, the
 * first one last: its solve is what the solver then holds. GetOutput() is the solver's image, and its field data tells
 * - `fit_unknown`: names PROPERTY:PHASE, and in their order `fit_value` and the interval that holds it 19 times out of
 *   20, `fit_low` and `fit_high`, by the measurements and, where these are known, by the errors of lattice and picture;
 *   `fit_low_by_measurement`, `fit_high_by_measurement`; `fit_correlation`: of their logarithms, by rows
 * - `fit_interval`: what the interval holds, in words
 * - `fit_measured`: names as they were given, and in their order `fit_measured_value`, `fit_measured_half_width`,
 *   `fit_fitted` (the value at the fit) and `fit_lattice_and_picture` (what these leave of that; NaN: not known), in
 *   their units
 * - `fit_misfit`: sum of squared differences over their standard deviations; `fit_freedom`: measurements less unknowns;
 *   `fit_chance`: how often chance alone makes the misfit as large, NaN without freedom; `fit_solves`
 *
 * An error is reported with vtkErrorMacro, its remedy on a second line after `hint: `, and sets ErrorCode; the solver's
 * own errors are among them. Progress is that of solves, whose number only the fit knows; AbortExecute stops it.
 *
 * @warning The solver keeps the properties at the fit, and tells its derivatives.
 */

#pragma once

#include "vtkAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for the solver and its samples

#include <memory> // for what was found
#include <string> // for words
#include <vector> // for words

class vtkImageData;
class vtkStringArray;

#ifndef __VTK_WRAP__
namespace lamella
{
struct FoundFit;
}
#endif

class VTKLAMELLASOLVERSVTK_EXPORT vtkMaterialFit : public vtkAlgorithm
{
public:
  static vtkMaterialFit* New();
  vtkTypeMacro(vtkMaterialFit, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** What solves: a vtkSteadyDiffusion or a vtkVoxelStiffness, with all that is known set. */
  void SetSolver(vtkAlgorithm* solver);
  vtkAlgorithm* GetSolver();
  ///@}

  ///@{
  /** Samples of the same materials, each with measurements of its own; none of them is changed. */
  void AddSample(vtkImageData* image);
  void RemoveAllSamples();
  ///@}

  ///@{
  /**
   * What is looked for, and where the search begins: wall=0.4, of stiffness young:wall=1e10; without a start it finds
   * its own.
   * @group Fit
   * @columns Unknown
   */
  void AddUnknown(const std::string& unknown);
  void RemoveAllUnknowns();
  ///@}

  ///@{
  /**
   * What was measured, and half of the interval that holds it 19 times out of 20 (± or +-): x=VALUE±HALF,
   * E_x=VALUE±HALF; of a second sample with 2/ before it.
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

  using vtkAlgorithm::Update;
  void Update() override;

  /** The first sample with what its solve and the fit tell; null before there is a fit. */
  vtkImageData* GetOutput();

  /** Words of a solver's settings, by its class, that a fit sees to itself or has no use for. */
  static void GetSettingsLeftOut(const std::string& className, vtkStringArray* words);

#ifndef __VTK_WRAP__
  /** All that the last update found, to tell of it. */
  const lamella::FoundFit& GetFindings() const;
#endif

protected:
  vtkMaterialFit();
  ~vtkMaterialFit() override;

private:
  void Fit();
  void Solve(vtkImageData* sample);
  void TakeProgress();
  void Ignore() {}

  vtkSmartPointer<vtkAlgorithm> Solver;
  std::vector<vtkSmartPointer<vtkImageData>> Samples;
  std::vector<std::string> Unknowns;
  std::vector<std::string> Measurements;
  vtkSmartPointer<vtkImageData> Output;
  std::unique_ptr<lamella::FoundFit> Findings;
};
