/**
 * @class   vtkBondFracture
 * @brief   strength, stress-strain curve, broken bonds and damage of an image of phases that is pulled apart
 *
 * Quasi-static fracture of bonds in small strain (peridynamics/fracture/FractureStudy.h): the sample between two
 * platens is strained until a bond is critical; it breaks, forces balance again, and so on. The bonds' materials are
 * the settings of vtkBondAlgorithm; pairs without a critical stretch, toughness or fracture energy never break.
 *
 * **Input** and **load**: as vtkBondEquilibrium, and so is what vtkBondLoadAlgorithm sets; there is no load by a force,
 * which nothing could hold after the peak.
 * Strains and stresses count along the load: under Compression they are positive when the platens approach. Under a
 * pressure in pores strain is their gain in volume (under Suction their loss) over their volume, which rises as the
 * platens' movement does elsewhere, and stress the pressure: its peak is the pressure that the sample bears, whether
 * the water's volume or its pressure is held. With Contact cracks close: a sample in compression bears across them.
 *
 * **Output 0**: the input in one state (State) with
 * - `damage` (1 double, 0 to 1): share of the node's bonds that are broken; bonds that notches cut before loading do
 *   not count; NaN in voids, which have none
 * - `broken` (1 int): broken bonds of the node
 * - `displacement` (3 doubles, [m]; 0 in voids; what came loose moves as the mean strain has it), unless switched off
 * - `stress` (6 doubles, [Pa]), `strain_energy` (1 double, [J/m³]) on demand, as vtkBondEquilibrium.
 *
 * Its time is the imposed strain.
 *
 * **Output 1**, broken bonds: vtkPolyData, a vertex a bond at its middle [m], in the order of breaking, with the point
 * data `event` (from 1; bonds of a batch share it), `strain` (imposed when it broke), `critical_strain` (at which it
 * was just critical), `stress` [Pa] (imposed, just before), `bond` (3 doubles, from the first node to the second [m]),
 * `phases` (2, of both ends, the lesser first), `between_grains`. Field data: `spacing`, `lattice_size`,
 * `lattice_origin`, and all of output 0's.
 *
 * **Output 2**, curve: vtkTable with `strain`, `stress` [Pa], `broken`: the state just before each event, what each
 * avalanche left, turning points and passages of 0, and the end; without turning points the strain never falls.
 * `critical_strain` and `critical_stress` are the path that follows every snap-back. On several ranks the first holds
 * outputs 1 and 2.
 *
 * **Field data**:
 * - `peak_stress` [Pa], `peak_strain`, `peak_broken`; `first_break_strain`, `first_break_stress` (NaN where nothing
 *   broke); `effective_modulus` [Pa] of the unbroken sample; `total_broken`
 * - with ComputeSensitivity `material_numbers`, `material_values`, `material_uncertainty`, `first_break_sensitivity`
 * and `first_break_input_error` [Pa], as vtkBondEquilibrium: of `first_break_stress`, not of the peak
 * - `broken_energy` [J], [J/m] of a picture: Σ ½ k s₀² |ξ|, what the broken bonds held when they were just critical
 * - where EstimateWindowError is on and the sample can be cut: `window_of` (`strength`) and with it `window_errors`,
 *   `window_low`, `window_high` and what else vtkVoxelStiffness has of them: of the mean strength of samples of this
 *   size; `strength_exponent` (strength ∝ volume^exponent), `weibull_modulus` (by the windows' scatter)
 * - where EstimateSegmentationError is on or a SurfaceDoubt given `surface_doubt` [nodes], `strength_grown` and
 *   `strength_shrunk` [Pa] (peaks with the solid grown and shrunk by `surface_step` [nodes]) and
 *   `strength_segmentation_error` [Pa], what the doubt leaves of `peak_stress`; with EstimateWindowError too
 *   `strength_total_error` [Pa], the root of the squares of both
 * - under a pressure `pore_volume` [m³] (of a picture [m²]), of the pores that were closed, and `open_pore_nodes`,
 * which hold none
 * - with TurningPoints `trough_stress` [Pa], `trough_strain`, the largest stress against the load (negative, or 0), and
 *   of each branch, from one turning point to the next, `branch_from`, `branch_to` (strains), `branch_stress` [Pa] and
 *   `branch_modulus` [Pa] (stress over strain; NaN at 0) at its end, `branch_work` (of the platens; negative where the
 *   sample gives back), `branch_released` (what of it went with the breaks) [J/m³, over the box between the platens],
 *   `branch_broken` (bonds)
 * - `end`: last-turn (the last turning point was reached), stress-fell, severed, pores-open, nothing-breaks,
 * maximum-strain or maximum-broken; `end_reason`: the same as a sentence
 * - of the state: `strain`, `stress` [Pa], `broken_bonds`, `hinges`, `state_iterations`
 * - `load`, `compression`, `suction`, `contact` (0 or 1), `load_axis`, `method`, `breaking`, `section_area`,
 * `gauge_length`, `platen_layers`
 * - `events`, `raises` (of the load; each jumps the elastic ramp up to the next break), `equilibria` (of the whole
 *   sample) with their `iterations`, `local_cycles` with the `visited_nodes`, `searches` for loose pieces,
 *   `freed_pieces`, `freed_nodes`, `freed_bonds` (came loose on the way), `loose_pieces`, `loose_nodes` (were loose
 *   before), `solid_nodes`, `skipped_nodes`, `bonds`, `visited_strips`, `skipped_strips`, `bytes` (all ranks),
 * `seconds` (bonds; first equilibrium; equilibria, local corrections, searches, all of the run; fields; checkpoints)
 * - `continued_at` (events in the checkpoint that it went on from, or 0), `states_before` (asked for, but before it),
 *   `checkpoints` (written, by all parts of the run), `last_checkpoint` (events in it, or 0)
 * - what vtkBondEquilibrium says of pairs, phases, thickness and warnings; `bond_model`, `provenance`.
 *
 * **Parallel**: as vtkBondEquilibrium; the same bonds break on any number of ranks. With events every rank holds the
 * bonds of the whole sample.
 *
 * @warning Strains are small: nothing turns, and pieces that hang by a hinge never part, so a run ends at a share of
 * the peak (StopShare).
 *
 * @without LargeStrains
 * @sa vtkBondEquilibrium
 */

#pragma once

#include "vtkBondBreakAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr

namespace lamella
{
namespace peridynamics // VTK's wrappers do not read lamella::peridynamics
{
struct FractureResult;
struct FractureStudyOptions;
}
} // namespace lamella

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondFracture : public vtkBondBreakAlgorithm
{
public:
  static vtkBondFracture* New();
  vtkTypeMacro(vtkBondFracture, vtkBondBreakAlgorithm);

  /**
   * The low platen never moves. Stretch: the high one moves along the axis. Shear: it moves across. Biaxial: smooth
   * platens on all sides. Pressure: no platens, but a pressure in pores that are closed, which makes them larger.
   * @group Load
   * @choice STRETCH SHEAR BIAXIAL PRESSURE
   */
  vtkSetMacro(Load, int);

  /**
   * Pressure: below that outside, as of water under tension. Pressures and what the pores lose of their volume are
   * positive then too.
   * @group Load
   * @when Load PRESSURE
   */
  vtkSwitchMacro(Suction, false);

  /**
   * Biaxial: strain along the other axes over that along the axis.
   * @group Load
   * @range [-1, 1]
   * @when Load BIAXIAL
   * @advanced
   */
  vtkSettingMacro(LateralRatio, double, 0);

  enum Methods
  {
    AUTO = 0,    ///< "Automatic": events where they can be had, else accurate
    EVENTS = 1,  ///< corrections around each break; sides not periodic, strict breaking, no contact, a load that rises
    ACCURATE = 2 ///< "Accurate: all after each break": the whole sample after each break: slow, to check against
  };
  /**
   * How forces are balanced between breaks. Automatic: events in strict breaking without periodic sides, contact and
   * turning points; else accurate, which takes far longer.
   * @group Accuracy and cost
   * @choice Methods
   * @advanced
   */
  vtkSettingMacro(Method, int, AUTO);

  enum Breakings
  {
    STRICT = 0, ///< "Strict: one bond at a time": one bond at a time, the most critical
    BATCHED = 1 ///< "Batched: all that are critical": all that are critical at once
  };
  /**
   * Which bonds break at once. Batched is solved by the accurate method.
   * @group Breaking
   * @choice Breakings
   * @advanced
   */
  vtkSettingMacro(Breaking, int, STRICT);

  /**
   * Cracks close: a bond that broke, or that a notch cut, carries compression as before where its ends are nearer to
   * each other than at first (unilateral contact, no friction), and pieces that come loose stay. Off: it carries
   * nothing any more, and cracks under pressure pass through themselves. By the accurate method.
   * @group Breaking
   */
  vtkSwitchMacro(Contact, false);

  ///@{
  /**
   * Strains at which the load turns round, along it positive, the other way negative: from 0 to the first, on to the
   * next and so on; the last is the end, and the share of the peak is of no account. None: the strain rises only.
   *
   * By the accurate method. States are asked for at numbers of broken bonds then.
   * @word turning-points, turning_points
   * @title Turning points of the load
   * @group Load
   * @columns Strain
   */
  void AddTurningPoint(double strain);
  void RemoveAllTurningPoints();
  ///@}
  /**
   * How often the turning points are gone through.
   * @group Load
   * @range [1, 100000]
   */
  vtkSettingMacro(Cycles, int, 1);

  /**
   * Events: look closer where two bonds are nearly as critical as each other. Off is sooner by a third to a half; the
   * strength is the same, the crack may take another way after the peak.
   * @group Accuracy and cost
   * @when Method AUTO EVENTS
   * @advanced
   * @off no-rivals: Do not look closer where two bonds are nearly as critical as each other.
   */
  vtkSwitchMacro(Rivals, true);

  /**
   * The strain is raised to multiples of this, each time to the first at which a bond is critical: batches are larger
   * and fewer, and a run sooner at its end, while the peak may lie up to one step higher. 0: to where the next bond
   * just is critical.
   * @group Breaking
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(StrainStep, double, 0);

  /**
   * Also pull the windows that the sample is cut into, halves and thirds of it along each axis, to their peaks, and
   * tell how far the mean strength of samples of this size may be from this one's (95 %), and roughly how strength
   * falls with size. About as much work as the sample itself.
   * @word window-error
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(EstimateWindowError, false);

  /**
   * Also tell how the strength changes where the surfaces between solid and void lie elsewhere, as far as the picture's
   * segmentation leaves it open: by pulling the sample twice more to its peak, its solid grown and shrunk. Rough. Needs
   * a picture that was segmented, or the doubt in pixels.
   * @word segmentation-error
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(EstimateSegmentationError, false);

  /**
   * How far surfaces between phases may lie from where the picture has them [pixels], for the segmentation error; 0:
   * what the picture's segmentation told of itself.
   * @group Accuracy and cost
   * @range [0, 10]
   * @unset 0
   * @advanced
   */
  vtkSettingMacro(SurfaceDoubt, double, 0);

  ///@{
  /**
   * States to keep on the way, by the imposed strain. The end is always kept. They change nothing that breaks.
   * @word at-strain, at_strains
   * @title States to keep: strains
   * @group States
   * @columns Strain
   * @advanced
   */
  void AddStateAtStrain(double strain);
  void RemoveAllStatesAtStrains();
  ///@}

protected:
  vtkBondFracture();
  ~vtkBondFracture() override;

  void Solve(vtkImageData* input, const lamella::Team& team, vtkPolyData* broken, vtkTable* curve) override;
  bool CracksClose() const override { return this->Contact; }

private:
  void SetOptions(const lamella::BondScene& scene, lamella::peridynamics::FractureStudyOptions& options) const;
  void CheckPressure() const;
  void CheckCycles(const lamella::BondSettings& settings) const;
  /// What was found and how, in a state's field data.
  void Describe(vtkImageData* image, const lamella::BondScene& scene, const lamella::BondSettings& settings,
    const lamella::peridynamics::FractureResult& result) const;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};
