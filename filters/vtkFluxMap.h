/**
 * @class   vtkFluxMap
 * @brief   where the flux goes: magnitude, streamlines, effective numbers
 *
 * **Input**: vtkImageData from vtkSteadyDiffusion, or one like it: a scalar field at points (`temperature` or
 * `concentration`) and its `flux`, with the ending _x, _y, _z where several directions were solved. A flux that is
 * missing is computed from the field, the phases and their conductivities over the solver's own links. Other arrays
 * are chosen with SetInputArrayToProcess(0, ...) for the scalar and (1, ...) for the flux.
 *
 * **Output 0**: the input with `flux_magnitude` (and `flux`, where it was missing) of the direction shown.
 *
 * **Output 1**: vtkPolyData, streamlines. Each carries the same share of the flux through the inlet face, so they
 * crowd where much flows. They are followed from face to face by the closed form of Pollock (1988), without a step
 * size, and never enter what does not conduct. Points carry `flux_magnitude`, the field and `arc_length` [m]; lines
 * carry `line` (a number), `length` [m], `tortuosity` (length over the box's length) and `arrived`. On several ranks,
 * and at periodic sides, a line is several pieces with one number.
 *
 * **Field data** of both outputs, columns or entries NaN for directions that are not in the input:
 * - `mean_flux`: 9 numbers by rows, column j the mean flux vector of the solve along j
 * - `effective_from_flux`: 9 numbers, the effective tensor from it (mean flux times box length over the difference 1);
 *   also as `effective_conductivity` where the input has none
 * - `tortuosity`: 3 numbers, mean |flux| over mean flux along the direction: how much longer the flux's way is
 * - `tortuosity_factor`: 3 numbers, mean conductivity (parallel bound) over the effective one; 1 where all flows
 *   straight; with one conducting phase of share f and conductivity k it is f k / k_eff
 * - `streamline_tortuosity`: 3 numbers, mean of the lines' length over the box's length, of the direction shown
 * - `line_flux`: what each line carries: the inlet's flux over the number of lines
 *
 * **Parallel**: right on distributed images, with whatever pieces, shared points and ghost layers: every node counts
 * once, and lines do not depend on the number of ranks.
 *
 * @sa vtkSteadyDiffusion
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaFiltersModule.h"   // for export macro
#include "vtkMultiProcessController.h" // for the smart pointer
#include "vtkSetting.h"
#include "vtkSmartPointer.h"

class vtkPolyData;

class VTKLAMELLAFILTERS_EXPORT vtkFluxMap : public vtkImageAlgorithm
{
public:
  static vtkFluxMap* New();
  vtkTypeMacro(vtkFluxMap, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Directions
  {
    X = 0,
    Y = 1,
    Z = 2,
    AUTO = 3 ///< "The first that was solved"
  };
  /**
   * Which of the solved directions the magnitude and the streamlines show. Numbers are given for all of them.
   * @group Map
   * @choice Directions
   */
  vtkSettingMacro(Direction, int, AUTO);

  /**
   * Each carries the same share of the flux through the inlet. 0: none are computed.
   * @group Map
   * @word streamlines
   * @range [0, 1000000]
   */
  vtkSettingMacro(NumberOfStreamlines, int, 60);

  /** The streamlines, output 1. */
  vtkPolyData* GetStreamlines();

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkFluxMap();
  ~vtkFluxMap() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Work;

  vtkSmartPointer<vtkMultiProcessController> Controller = vtkMultiProcessController::GetGlobalController();
};
