/**
 * @class   vtkSteadyDiffusion
 * @brief   steady heat or vapour diffusion on an image of phases
 *
 * Solves div(D grad u) = 0 on the lattice of the image's points with the solver of lbm/SteadyDiffusion.h, which is
 * exactly the steady state of two-relaxation-time lattice Boltzmann, and gives the effective conductivity, and on
 * demand the field and its flux.
 *
 * **Input**: that of vtkDiffusionAlgorithm. For phases that conduct differently along and across an axis also its
 * direction: `axis` unless another is chosen with SetInputArrayToProcess(1, ...), 2 or 3 components (of volumes 3) of
 * any length, as vtkMicrographLattice makes it (lbm/DirectedLinks.h, lbm/elements/ElementSystem.h). For phases whose
 * voxels have tensors of their own these: `tensor` unless another is chosen with SetInputArrayToProcess(2, ...).
 *
 * **Output**: the input with, as asked for,
 * - `temperature` or `concentration` (double, scaled 0 to 1; NaN where nothing conducts),
 * - `flux` (3 doubles, −D grad u with u per metre; 0 where nothing conducts),
 * each with `_x`, `_y`, `_z` after its name when all directions are solved. Field data:
 * - `effective_conductivity`: 9 numbers, the tensor K in data axes by rows; column j is mean flux over mean gradient
 *   of the solve along j; NaN in columns that were not solved. In the unit of the conductivities.
 * - `estimated_error`: relative error of the effective conductivity against the material's, the largest of the
 *   directions solved; NaN unless EstimateError is on. `lattice_error` and `picture_error`: its two parts, that of one
 *   node a pixel and that of the pixels' own steps (lattice/PictureError.h); they may cancel. Each `_by_direction`: 3
 *   numbers. `extrapolated_conductivity`: 3 numbers, the diagonal that the material is expected to have; NaN where that
 *   is not surely nearer.
 * - where EstimateWindowError is on: `window_error`, how far the material's value may be from the picture's, relative,
 *   the largest of the directions (95 %), and `window_error_by_direction`; `window_low`, `window_high` (the interval
 * that holds the material's value), `window_deviation` (standard deviation between such pictures), `window_freedom`
 * (degrees of freedom behind it), `window_bias` (what the picture's ends do), each 3 numbers in the unit of the
 * conductivities, by direction; `window_gradient`: the axis, 0 to 2, along which the values change steadily, NaN: none;
 *   `layered_conductivity`: then the value of its slabs as layers, in series or in parallel, and `layered_low`,
 *   `layered_high`, the interval of a material of such layers (statistics/WindowError.h)
 * - `tortuosity_factor`: 3 numbers, mean conductivity (the parallel bound) over the effective one. Where one phase
 * alone conducts also `relative_conductivity`, effective over that phase's (of pores D_eff / D_0), and
 * `formation_factor`, its inverse; the tortuosity factor then is the phase's fraction times the formation factor. NaN
 * where several conduct
 * - `bounds`: series, Hashin–Shtrikman of isotropic media (lower, upper), parallel; of a phase with two conductivities
 *   the lower ones are those of the smaller, the upper ones those of the larger; of tensors of the least and of the
 *   largest principal value
 * - `balance`, `solver_error`, `iterations`, `stored_nodes`, `skipped_nodes`, `refinement`: 3 numbers, by direction;
 * NaN where not solved
 * - `conductivity_rounding`, of interpolated conductivities: largest relative change by which bins of greys stand for
 *   their greys; 0: each grey has its own. By it at most the effective one is off
 * - `phase_conductivity`: by phase id; `phase_fraction` likewise; `phase_names`. Where one differs across the wall
 *   also `phase_conductivity_across`; where phases have tensors `phase_conductivity_tensor`, 6 numbers a phase (xx, yy,
 *   zz, xy, yz, xz), of voxels their mean, and `phase_conductivity` is the largest principal value
 * - with EstimateSegmentationError `surface_doubt` [pixels], `surface_sensitivity`: 3 numbers a pair of phases (0 and
 * 1, 0 and 2, … 1 and 2, …), how the effective conductivity along x, y, z changes where the first of the two grows into
 *   the other by a pixel, and `segmentation_error_by_direction`, relative: what the doubt leaves, levels between phases
 *   being independent
 * - with ComputeSensitivity `conductivity_sensitivity`: 3 numbers a phase, ∂K/∂k of the effective conductivity along x,
 *   y, z by that of the phase; of greys as shares by those of low and high. NaN where it does not conduct, or that
 *   direction was not solved. K = Σ k ∂K/∂k. Of phases with two conductivities that is the one along; also
 *   `conductivity_across_sensitivity`; of a phase with tensors that to their largest principal value, all in
 *   proportion
 * - with membranes `membrane_names`, `membrane_resistance`, `membrane_area` (surface over volume [1/m], of pictures
 *   length over area), and with ComputeSensitivity `membrane_sensitivity`: 3 numbers a membrane, ∂K/∂R. K = Σ k ∂K/∂k
 *   − Σ R ∂K/∂R. `bounds`: the series bound holds with them, Hashin and Shtrikman's lower one does not and is the
 * series bound then
 * - with uncertainties `input_error_by_direction`: 3 numbers, what they leave of the effective conductivity, relative;
 *   `total_error_by_direction`: the root of the squares of that, of the estimated error and of the window's, where two
 * are known
 * - `direction` ("x", "y", "z" or "all"), `sides`, `lattice`, `phase_array` (the array of the ids): strings
 * - `target`, where there is a target error: "reached", "picture too coarse", "memory short"
 * - `provenance`: one JSON string.
 * With pixels split, by Refinement or for a TargetError, and a field or flux asked for, the output's points are those
 * of the split pixels.
 *
 * **Sides**: INSULATED: values 1 and 0 on the two faces of the direction, half a spacing outside the outer nodes, no
 * flux through all others. MIXED: the same values, periodic across. PERIODIC: a cell of an infinite medium under a mean
 * gradient, all sides periodic.
 *
 * **Lattice**: D2Q5 and D3Q7 are the finite volume scheme with harmonic faces. Conductivities along and across a wall
 * want D2Q9, which AUTO_LATTICE takes for pictures up to a ratio of 5.82, or elements, Q1, which it takes for volumes
 * and beyond.
 *
 * **Parallel**: the numbers are those of one rank to round-off.
 *
 * @default Direction 3
 * @sa vtkLatticeBoltzmann, vtkFluxMap, vtkPictureReader, vtkMicrostructureSource
 */

#pragma once

#include "vtkDiffusionAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <functional> // for std::function
#include <memory>     // for std::unique_ptr

namespace lamella
{
struct DiffusionScene;
struct FieldLayers;
class GreyTable;
struct SteadyFindings;
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkSteadyDiffusion : public vtkDiffusionAlgorithm
{
public:
  static vtkSteadyDiffusion* New();
  vtkTypeMacro(vtkSteadyDiffusion, vtkDiffusionAlgorithm);

  ///@{
  /**
   * Conductivity of each phase, one a row: its name (or its number, where phases have no names) and the value, in any
   * unit; the effective conductivity comes in the same. 0: does not conduct. Wood: heat wall 1, lumen 0.023; vapour
   * wall 0.004, lumen 1. Names that the image does not know do no harm.
   *
   * Finite and not negative. Each phase that has nodes must have one; what does not conduct is neither stored nor
   * visited.
   * @title Conductivity of phases
   * @group Materials
   * @columns Phase, Conductivity
   */
  void SetConductivity(const char* phase, double value);
  void RemoveConductivity(const char* phase);
  void RemoveAllConductivities();
  int GetNumberOfConductivities();
  /** NaN when the phase has none. */
  double GetConductivity(const char* phase);
  ///@}

  ///@{
  /**
   * Of phases that conduct differently along an axis (the wall, the grain) and across it: the conductivity across, one
   * phase a row; that above is then the one along. The image says at every point where the axis leads, as Micrograph
   * Lattice does. Any ratio goes on elements, on the links of D2Q9 up to 5.82 in every direction.
   *
   * `phase` is the word that SetConductivity() was given.
   * @title Conductivity of phases across the wall
   * @group Materials
   * @columns Phase, Conductivity across
   * @advanced
   */
  void SetConductivityAcross(const char* phase, double value);
  void RemoveAllConductivitiesAcross();
  /** NaN when the phase has none. */
  double GetConductivityAcross(const char* phase);
  ///@}

  ///@{
  /**
   * Of phases that conduct differently in every direction: the tensor's numbers in the image's axes, with spaces
   * between them: xx yy zz, or xx yy zz xy yz xz, or all 9 by rows; of pictures also xx yy, or 4 by rows. Symmetric,
   * its principal values above 0 and within a ratio of 1e6. On elements, q1. Phases with neither a conductivity nor
   * this take the tensors of their voxels, where the image has a point array `tensor` of 6 components (xx, yy, zz, xy,
   * yz, xz) or 9.
   *
   * `phase` is a name or a number, as SetConductivity() takes it.
   * @title Conductivity of phases as a tensor
   * @group Materials
   * @columns Phase, Numbers
   * @advanced
   */
  void SetConductivityTensor(const char* phase, const char* numbers);
  void RemoveAllConductivityTensors();
  int GetNumberOfConductivityTensors();
  ///@}

  ///@{
  /**
   * How far a conductivity may be off, one phase a row, in any unit that the conductivities have: half of the interval
   * that holds it 19 times out of
   * 20. The output then tells what that leaves of the effective one, and ComputeSensitivity is on. Independent of each
   * other.
   *
   * `phase` is the word that SetConductivity() was given.
   * @title Uncertainty of conductivities
   * @group Materials
   * @columns Phase, Plus or minus
   * @advanced
   */
  void SetConductivityUncertainty(const char* phase, double value);
  void RemoveAllConductivityUncertainties();
  /** NaN when the phase has none. */
  double GetConductivityUncertainty(const char* phase);
  ///@}

  ///@{
  /**
   * The same of conductivities across the wall, in any unit that those have.
   * @title Uncertainty of conductivities across the wall
   * @group Materials
   * @columns Phase, Plus or minus
   * @advanced
   */
  void SetConductivityAcrossUncertainty(const char* phase, double value);
  void RemoveAllConductivityAcrossUncertainties();
  /** NaN when the phase has none. */
  double GetConductivityAcrossUncertainty(const char* phase);
  ///@}

  ///@{
  /**
   * Resistance of the surface between two phases, one pair a row, as lumen-wall, in any order: the value jumps there by
   * the resistance times the flux. Metres over the unit of the conductivities, of heat m² K/W (thermal boundary
   * resistance); finite and at least 0. On straight links, d2q5 and d3q7.
   * @word membrane
   * @title Membranes between phases
   * @group Materials
   * @columns Pair, Resistance
   * @advanced
   */
  void SetMembrane(const char* pair, double resistance);
  void RemoveAllMembranes();
  int GetNumberOfMembranes();
  /** NaN when the pair, as it was written, has none. */
  double GetMembrane(const char* pair);
  ///@}

  ///@{
  /**
   * The same by the inverse, what a membrane lets through: conductivity over metres, of heat W/(m² K), above 0.
   * @word permeance
   * @title Permeance of membranes
   * @group Materials
   * @columns Pair, Permeance
   * @advanced
   */
  void SetPermeance(const char* pair, double permeance);
  void RemoveAllPermeances();
  int GetNumberOfPermeances();
  /** NaN when the pair, as it was written, has none. */
  double GetPermeance(const char* pair);
  ///@}

  /**
   * The image is grey, not labels: the greys of nodes that hold nothing of the phase `high`, and that are all of it;
   * what is between holds a part, which tells where in a node the surface lies. The conductivities are then those of
   * `low` and `high`. Not given (both 0): the image holds phases. Where there
   * are more than 256 greys, or some are no whole numbers, they count as the nearest of 255 from none to all.
   * @title Greys of none and of all
   * @group Materials
   * @columns none, all
   */
  vtkSettingVector2Macro(Shares, double, 0, 0);

  /**
   * Draw a smooth surface through the staircase of voxels between two phases, of which the image must consist, and
   * solve by how much of each voxel either fills, as the greys of both would tell: far nearer to the material than
   * whole voxels. Volumes neither grow nor shrink; every voxel stays more than half of its own phase.
   * @group Materials
   */
  vtkSwitchMacro(SmoothLabels, false);

  /**
   * The image is grey, and conductivities are given of greys instead of phases, 0.1 of 40 and 1 of 220: between two of
   * them it is interpolated linearly, beyond the outermost it stays. Greys may be of any type; more than 256 are put
   * into bins that are told.
   * @group Materials
   */
  vtkSwitchMacro(Interpolate, false);

  enum AllDirections
  {
    ALL = 3
  };
  /**
   * From which face to which: the value is 1 on the first and 0 on the second. x: from left to right, y: in pictures
   * from top to bottom, z and all of a volume: from low to high coordinates. "All" solves once for each direction and
   * ends the arrays' names in _x, _y, _z.
   * @group Diffusion
   * @choice X Y Z ALL
   * @panel x
   */
  vtkSetMacro(Direction, int);

  enum Methods
  {
    AUTO_METHOD = 0,
    MULTIGRID = 1,
    ALGEBRAIC_MULTIGRID = 2,
    LEAN_MULTIGRID = 3,
    PIECE_MULTIGRID = 4
  };
  /**
   * How the system is solved. All give the same answer; automatic goes by what conducts, by memory and by whether
   * fields are wanted. Lean multigrid: 9 bytes a node, not where a phase insulates in thin walls; piece multigrid: 10
   * to 25, any phases.
   * @group Accuracy and cost
   * @choice Methods
   * @advanced
   */
  vtkSettingMacro(Method, int, AUTO_METHOD);

  /**
   * Largest relative error of the flux through either face.
   * @group Accuracy and cost
   * @range [1e-12, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-8);

  /**
   * Gives up after this many iterations.
   * @word max-iterations
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumIterations, int, 500);

  /**
   * Put the temperature or concentration (scaled 0 to 1) into the output. Off, it is neither computed nor stored.
   * @group Output
   */
  vtkSwitchMacro(ComputeField, true);

  /**
   * Split every pixel into N × N (× N).
   * @word refine, refinement
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(Refinement, int, 1);

  /**
   * Also solve the pictures that every second, third and fourth pixel gives, and every pixel split in 2 × 2 (× 2), on
   * a part of a large image, and estimate the error of the value against the material's. Costs several times the
   * solve itself.
   * @off no-error-estimate: Do not solve coarser and split pictures: no error is told.
   * @group Accuracy and cost
   * @panel off
   */
  vtkSwitchMacro(EstimateError, true);
  /** The largest relative error of the last update; NaN when it was not estimated. */
  vtkGetMacro(EstimatedError, double);

  /**
   * Also tell how the effective conductivity changes with each phase's: exactly, from the energy of the field that is
   * there anyway. Conductivities along and across then go on elements.
   * @word sensitivity
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(ComputeSensitivity, false);

  /**
   * Also solve the windows that the picture is cut into, halves and thirds of it along each axis, and tell how far the
   * picture speaks for the material that it was cut out of: an interval that holds the material's value with a
   * probability of 95 %, how many such pictures a given error takes, and whether the picture changes along an axis.
   * About twice the work of the solve itself.
   * @word window-error
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(EstimateWindowError, false);

  /**
   * Also tell how the value changes where the surfaces between phases lie elsewhere, as far as the picture's
   * segmentation leaves it open: from the field of the solve, no other one is made. Needs a picture that was segmented,
   * or the doubt in pixels. Conductivities along and across then go on elements.
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

  /**
   * Refine until the estimated error is below this share, as far as the picture's own pixels and memory allow; 0: no
   * target. What it will take is told beforehand, a target that is not reached is warned of.
   * @group Accuracy and cost
   * @range (0, 1)
   * @unset 0
   * @advanced
   */
  vtkSettingMacro(TargetError, double, 0);

  enum Events
  {
    /// What a target error, or an image of many nodes, will take is known, and about to be begun: the call data are the
    /// words, a const char*.
    PLAN_EVENT = 1101
  };

  /** The effective conductivity of the last update, 9 numbers by rows, NaN in columns that were not solved. */
  vtkGetVectorMacro(EffectiveConductivity, double, 9);

#ifndef __VTK_WRAP__
  /** All that the last update found, to tell of it. */
  const lamella::SteadyFindings& GetFindings() const;
  /** Hand the fields to this by layers instead of putting them into the output: of volumes whose pixels are not split.
   * The first rank has the whole image. */
  void SetFieldSink(std::function<void(const lamella::FieldLayers&)> sink);
#endif

protected:
  vtkSteadyDiffusion();
  ~vtkSteadyDiffusion() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Internals;
  class FieldStore;
  bool TellsSensitivity() const;
  bool TellsSurfaces() const;
  void TakeDoubt(vtkImageData* input, const lamella::Team& team);
  void Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team);
  /// What of the settings and the image the solver takes. @throws Error on every rank
  void TakeShares(const lamella::DiffusionScene& scene);
  void TakeLabels(const lamella::DiffusionScene& scene);
  void RefuseMembranes(bool shares) const;
  void TakeMembranes(const lamella::DiffusionScene& scene);
  void TakeDirections(vtkImageData* input, const lamella::DiffusionScene& scene, const lamella::Team& team);
  void TakeGreys(const lamella::DiffusionScene& scene, const lamella::GreyTable& table);
  void Prepare(vtkImageData* input, const lamella::DiffusionScene& scene, const lamella::Team& team);
  void SolveInBlocks(const lamella::DiffusionScene& scene, FieldStore& store, const lamella::Team& team);
  void SolveGathered(const lamella::DiffusionScene& scene, FieldStore& store, const lamella::Team& team);
  void Conclude();

  std::unique_ptr<Internals> Internal;

  double EffectiveConductivity[9];
  double EstimatedError;
};
