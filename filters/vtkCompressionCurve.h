/**
 * @class   vtkCompressionCurve
 * @brief   what a stress–strain curve in compression tells: stiffness, collapse, plateau, densification, energy
 *
 * **Input**: vtkTable with a column of strains and one of stresses [Pa], compression positive, strains rising from row
 * to row and below 1: `strain` and `stress` unless others are chosen with SetInputArrayToProcess(0, ...) and (1, ...).
 *
 * **Output**: the table with `absorbed_energy` (W = ∫ σ dε [J/m³]), `efficiency` (W/σ, of the smoothed stress; NaN
 * where that is not above 0) and `smooth_stress` [Pa].
 *
 * **Field data**, NaN where the curve does not hold it: `curve_stiffness`, `curve_stiffness_error`, `curve_intercept`
 * [Pa], `curve_r2`, `curve_toe` (strain at which the fitted line begins), `curve_fit_range` (2), `curve_fit_rows`;
 * `curve_yield_strain`, `curve_yield_stress` [Pa] (where the curve meets the line moved by Offset);
 * `curve_peak_strain`, `curve_peak_stress` [Pa] (first maximum); `curve_plateau_stress` [Pa], `curve_plateau_range`
 * (2), `curve_plateau_end_strain` (the stress is 1.3 times the plateau's); `curve_densification_strain`, `_stress`
 * [Pa],
 * `_energy` [J/m³], `_efficiency`; `curve_energy` [J/m³] of all the curve; `curve_missing` (texts: what was not found,
 * and why).
 *
 * Definitions are those of ISO 13314:2011; densification begins where the efficiency is largest (Li, Magkiriadis and
 * Harrigan, J. Cell. Plast. 42 (2006) 371–392; Tan, Reid, Harrigan, Zou and Li, J. Mech. Phys. Solids 53 (2005)
 * 2174–2205). See compression/CompressionCurve.h.
 *
 * **Parallel**: where ranks work together the first one takes its piece of the table, which holds all that
 * vtkPointCompression gives; else the table is taken whole. The first piece holds the result.
 */

#pragma once

#include "vtkLamellaFiltersModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkTableAlgorithm.h"

class VTKLAMELLAFILTERS_EXPORT vtkCompressionCurve : public vtkTableAlgorithm
{
public:
  static vtkCompressionCurve* New();
  vtkTypeMacro(vtkCompressionCurve, vtkTableAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Strains between which the stiffness is fitted.
   * @group Curve
   * @columns from, to
   */
  vtkSettingVector2Macro(StiffnessRange, double, 0, 0.03);

  /**
   * Width in strain of the steepest window within that range that is fitted instead, for curves that begin with a toe.
   * 0: all of the range.
   * @group Curve
   * @range [0, inf)
   */
  vtkSettingMacro(Window, double, 0);

  /**
   * Plastic strain at the yield stress.
   * @group Curve
   * @range [0, 1)
   */
  vtkSettingMacro(Offset, double, 0.002);

  /**
   * Strains between which the plateau's mean is taken, such as 0.2 and 0.4. 0 and 0: from collapse to densification.
   * @group Curve
   * @columns from, to
   */
  vtkSettingVector2Macro(PlateauRange, double, 0, 0);

  /**
   * Width in strain over which stresses are smoothed before maxima and crossings are looked for. 0: not at all.
   * @group Curve
   * @range [0, 1]
   */
  vtkSettingMacro(Smoothing, double, 0.01);

  /**
   * Share that the curve falls by beyond a maximum that counts.
   * @group Curve
   * @advanced
   * @range [0, 1)
   */
  vtkSettingMacro(Prominence, double, 0.05);

protected:
  vtkCompressionCurve();
  ~vtkCompressionCurve() override = default;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  void Run(vtkTable* input, vtkTable* output);
};
