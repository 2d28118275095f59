/**
 * @class   vtkOutlineDiffusion
 * @brief   effective conductivity of what outlines enclose, with an error bar
 *
 * Steady diffusion on lattices made from outlines, whose links know where they cross from wall to lumen
 * (lbm/ContourDiffusion.h): on a lattice of the spacing, on one of twice and one of four times that, and what follows
 * for a spacing of zero. The error bar has two parts: that of the lattices, from their values, and that of the picture
 * which the outlines are from, whose pixels do not say exactly where a wall begins. For the latter outlines are found
 * in the pictures of every second and every third pixel as well, and solved.
 *
 * **Input** 0: outlines, as vtkMicrographContours and vtkMicrographPolygonReader give them. **Input** 1, optional: the
 * picture that they were found in, with the same array of phases or numbers; their field data `extraction` says how.
 * Without it the outlines are taken as they are, and the error bar is that of the lattices.
 *
 * **Output**: the outlines with the field data
 * - `effective_conductivity`: 9 numbers, the tensor in data axes by rows, of which the diagonal is solved; NaN
 * elsewhere
 * - `estimated_error`, `lattice_error`, `picture_error`: relative, the largest of the directions; each also
 *   `_by_direction`, 3 numbers, NaN where not solved or where nothing can be said
 * - `border_doubt`, `segmentation_doubt`: parts of the picture's error, 3 numbers; where there is a picture
 * - `lattices_x`, `lattices_y`: spacing [m] and conductivity on each lattice, the coarsest first
 * - `balance`, `iterations`, `nodes`: 3 numbers, of the finest lattice
 * - `phase_names`, `phase_conductivity`, `direction`, `provenance`; with a target error `target`: "reached", "picture
 * too coarse" or "memory short"
 *
 * How often the error bars hold: docs/benchmarks/contours.md. On several ranks the first one does all of it.
 *
 * @default Lamella GROWTH
 *
 * @sa vtkMicrographContours vtkMicrographPolygonReader vtkSteadyDiffusion
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkOutlineAlgorithm.h"

#include <memory> // for std::unique_ptr

class vtkPolyData;

namespace lamella
{
struct OutlineFindings;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkOutlineDiffusion : public vtkOutlineAlgorithm
{
public:
  static vtkOutlineDiffusion* New();
  vtkTypeMacro(vtkOutlineDiffusion, vtkOutlineAlgorithm);

  vtkPolyData* GetOutput();

  ///@{
  /**
   * Conductivity of each phase, one a row: lumen, wall and, where it has one of its own, middle lamella, in any unit;
   * the effective conductivity comes in the same. 0: does not conduct.
   *
   * Finite and not negative. Lumen and wall must have one; other words for the same go (lattice/PhaseNames.h), other
   * phases are refused.
   * @title Conductivity of phases
   * @group Diffusion
   * @columns Phase, Conductivity
   */
  void SetConductivity(const char* phase, double value);
  void RemoveAllConductivities();
  /** NaN when the phase has none. */
  double GetConductivity(const char* phase);
  ///@}

  enum Directions
  {
    X = 0,
    Y = 1,
    ALL = 3
  };
  /**
   * Across the picture from left to right, down it, or both, one after the other.
   * @group Diffusion
   * @choice Directions
   */
  vtkSettingMacro(Direction, int, ALL);

  /**
   * Distance of the nodes on the finer lattice in metres; it changes a little so that a whole number fits the picture.
   * 0: the picture's pixel, of outlines that are from no picture a quarter of the walls' median thickness.
   * @group Diffusion
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(Spacing, double, 0);

  /**
   * Halve the spacing until the error bar is below this share, as far as the picture's pixels and half of the free
   * memory allow; 0: no target. What it will take is told beforehand, a target that is not reached is warned of.
   * @group Diffusion
   * @range (0, 1)
   * @unset 0
   */
  vtkSettingMacro(TargetError, double, 0);

  /**
   * Threads of the solver. 0: one for each core.
   * @group Diffusion
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Threads, int, 1);

  enum Events
  {
    /// What a target error will take is known, and about to be begun: the call data are the words, a const char*.
    PLAN_EVENT = 1101
  };

#ifndef __VTK_WRAP__
  /** Refuses conductivities that no outlines could be solved with: so can what runs it before it has outlines.
   * @throws lamella::ParameterError, lamella::NoPathError */
  void RequireConductivities() const;
  /** All that the last update found, to tell of it. */
  const lamella::OutlineFindings& GetFindings() const;
#endif

protected:
  vtkOutlineDiffusion();
  ~vtkOutlineDiffusion() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Internals;
  void Solve(vtkPolyData* outlines, vtkImageData* picture, vtkPolyData* output);

  std::unique_ptr<Internals> Internal;
};
