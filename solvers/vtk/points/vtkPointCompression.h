/**
 * @class   vtkPointCompression
 * @brief   an image of phases pressed between platens by material points: stress-strain curve and deformed points
 *
 * Large strains, from the first touch to densification (mpm/PointCompression.h): points in motion, pressed so slowly
 * that the kinetic energy stays small beside the elastic one; how small is told. Walls, plane and grid are the settings
 * of vtkPointAlgorithm. Walls that meet feel each other through the grid, without slip; but for phases with friction
 * between them (SetFriction), which are separate bodies.
 *
 * **Output 0**: vtkPolyData, a vertex a point in one state (State), in the order of their numbers, with
 * - `id` (uint32): the point's number, the same in all states; `phase` (unsigned char)
 * - `displacement` (3 doubles, [m]) from the start, unless switched off
 * - on demand `velocity` (3 doubles, [m/s]); `stress` (6 doubles XX YY ZZ XY YZ XZ, [Pa]): Cauchy's, Kirchhoff's stress
 *   of the law over det F, tension positive; `deformation_gradient` (9 doubles by rows); `energy_density` (elastic,
 *   over the volume at the start [J/m³]); `plastic_strain` (equivalent, of walls that yield: all that has flowed).
 *
 * Of a picture YZ and XZ of the stress are 0; ZZ is 0 in plane stress, in plane strain what holds the third direction.
 * The third diagonal entry of the deformation gradient is 1. Of walls that yield the gradient is the elastic part, the
 * third entry too. The time of a state is its strain.
 *
 * **Output 1**, curve: vtkTable, a row at even strains: `strain` (1 − H/H₀), `stress` [Pa] (means over half a row
 * before and after), `imbalance` [Pa], `lateral_stress` [Pa], `lateral_strain`, `porosity`, `elastic_energy`,
 * `kinetic_energy`, `work`, `dissipated`, of that `plastic_work` ([J], [J/m] of a picture), `speed` (over the wave's),
 * `steps`, `time` [s].
 * Stresses and strains are positive in compression.
 *
 * **Field data** of both:
 * - of the state: `strain`, `stress` [Pa] (of the curve at that strain)
 * - `worst_energy_ratio` with `worst_energy_ratio_strain`, `worst_lateral`, `worst_imbalance` (over the axial stress):
 *   how quasi-static it was, beyond the strain CalmFrom; `slowdowns`; `first_touch_strain`; `wave_speed` [m/s]
 * - `box` (6 numbers [m], lower and upper end by axis), `load_axis`, `sides`, `phase_names`, `phase_fraction`,
 *   `phase_array`, `law`, `plane`, `grid_spacing` [m], `points_per_node`, `cells_across_walls` and `thin_wall_share`
 *   (mpm/WallCells.h), `spacing`, `lattice_size`, `lattice_origin`
 * - `points`, `bytes_per_point`, `steps`, `updates_per_second` (of points, wall time), `seconds` (points; run)
 * - `continued_at` (steps in the checkpoint that it went on from, or 0), `states_before` (asked for, but before it),
 *   `checkpoints` (written by this run), `last_checkpoint` (steps in it, or 0)
 * - `warnings`, `point_model`, `provenance`.
 *
 * **Parallel**: the ranks work together where each is asked for its own piece. Each gives out as large a share of the
 * points as its piece of the image has of the nodes that are not void, in the order of their numbers and the same ones
 * in every state; the first rank has the curve. Field data are the same on all. To round-off the curve does not depend
 * on the number of ranks.
 *
 * @sa vtkPointStiffness, vtkMicrographLattice
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPointAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for members

class vtkPolyData;
class vtkTable;

class VTKLAMELLASOLVERSVTK_EXPORT vtkPointCompression : public vtkPointAlgorithm
{
public:
  static vtkPointCompression* New();
  vtkTypeMacro(vtkPointCompression, vtkPointAlgorithm);

  /** As vtkBondLoadAlgorithm. */
  vtkSettingMacro(LoadAxis, int, LAST_AXIS);

  /**
   * Strain to end at, above 0 and below 1.
   * @group Load
   * @range (0, 1)
   */
  vtkSettingMacro(Strain, double, 0.48);

  enum SideKinds
  {
    STRAIGHT = 0, ///< "Straight, without force": walls that stay straight and move so that the force on them is nothing
    OPEN = 1,
    FIXED = 2,
    PERIODIC = 3 ///< "Periodic": a period that grows so that there is no mean stress
  };
  /**
   * Both ends of the axes across the load.
   * @group Load
   * @choice SideKinds
   */
  vtkSettingMacro(Sides, int, STRAIGHT);

  /**
   * Platens do not let slide.
   * @group Load
   * @advanced
   */
  vtkSwitchMacro(Grip, false);
  /**
   * Coulomb's coefficient of friction of both platens. 0: they let slide; not with Grip.
   * @group Load
   * @range [0, inf)
   */
  vtkSettingMacro(PlatenFriction, double, 0);

  ///@{
  /**
   * Coulomb's coefficient of friction between two phases, 0 or above: wall-grain. Phases of such a pair are not joined,
   * and slide and part; all others are. A phase is always joined to itself. An empty name is ignored (an empty row in a
   * panel).
   * @word friction
   * @title Friction between phases
   * @group Load
   * @columns Phases, Coefficient
   */
  void SetFriction(const char* pair, double value);
  void RemoveAllFrictions();
  ///@}

  /**
   * Kinetic over elastic energy that is allowed.
   * @group How slowly
   * @range [0, inf)
   */
  vtkSettingMacro(EnergyRatio, double, 0.01);
  /**
   * Strain from which the energy ratio is kept.
   * @group How slowly
   * @range [0, 1]
   * @advanced
   */
  vtkSettingMacro(CalmFrom, double, 0.05);
  /**
   * Speed of the platens towards each other at the start, over the fastest wave in the wall; between the least and the
   * most speed.
   * @group How slowly
   * @advanced
   * @range (0, 1)
   */
  vtkSettingMacro(FirstSpeed, double, 0.001);
  /**
   * Speed below which the control does not go.
   * @group How slowly
   * @advanced
   * @range (0, 1)
   */
  vtkSettingMacro(LeastSpeed, double, 5e-05);
  /**
   * Speed above which the control does not go.
   * @group How slowly
   * @advanced
   * @range (0, 1)
   */
  vtkSettingMacro(MostSpeed, double, 0.02);
  /**
   * Friction against a frame that deforms evenly, over the lowest frequency of a bar of wall as high as the specimen.
   * @group How slowly
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Damping, double, 0);
  /**
   * Rows of the curve.
   * @group State shown
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(Rows, int, 240);

  enum Shapes
  {
    LINEAR = 0, ///< "Linear": the first paper's
    GIMP = 1,   ///< "GIMP"
    SPLINE = 2  ///< "Quadratic splines": quadratic B-splines
  };
  /**
   * Shape functions.
   * @group Points and grid
   * @choice Shapes
   * @advanced
   */
  vtkSettingMacro(Shape, int, SPLINE);
  enum Transfers
  {
    FLIP = 0, ///< "FLIP"
    PIC = 1,  ///< "PIC"
    APIC = 2, ///< "APIC"
    XPIC = 3  ///< "XPIC(2)"
  };
  /**
   * How points get their velocities back from the grid.
   * @group Points and grid
   * @choice Transfers
   * @advanced
   */
  vtkSettingMacro(Transfer, int, APIC);
  /**
   * Consistent mass instead of lumped.
   * @group Points and grid
   * @advanced
   */
  vtkSwitchMacro(ConsistentMass, false);
  /**
   * Stress from the velocities that points give back to the grid (MUSL).
   * @group Points and grid
   * @advanced
   */
  vtkSwitchMacro(ModifiedUpdate, false);
  /**
   * Step in time [s]; 0: 0.9 of the largest stable one, followed as the points deform. One above that is refused with
   * it.
   * @group Points and grid
   * @unit s
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(TimeStep, double, 0);

  ///@{
  /**
   * States to keep on the way, at these strains. The end is always kept.
   * @word at-strain, at_strains
   * @title States to keep: strains
   * @group States
   * @columns Strain
   */
  void AddStateAtStrain(double strain);
  void RemoveAllStatesAtStrains();
  ///@}
  ///@{
  /** As vtkBondBreakAlgorithm. */
  vtkSwitchMacro(KeepStates, true);
  void SetState(int state);
  int GetState();
  vtkGetVector2Macro(StateRange, int);
  ///@}

  ///@{
  /**
   * Put the displacement of every point into the output.
   *
   * What is switched off after a run is left out, and comes back without another one; what the run was not to keep
   * needs another. The same holds for those below.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeDisplacement(bool on);
  vtkGetMacro(ComputeDisplacement, bool);
  vtkBooleanMacro(ComputeDisplacement, bool);
  /**
   * Put the velocity of every point into the output.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeVelocity(bool on);
  vtkGetMacro(ComputeVelocity, bool);
  vtkBooleanMacro(ComputeVelocity, bool);
  /**
   * Put Cauchy's stress of every point into the output.
   * @group State shown
   */
  virtual void SetComputeStress(bool on);
  vtkGetMacro(ComputeStress, bool);
  vtkBooleanMacro(ComputeStress, bool);
  /**
   * Put the deformation gradient of every point into the output.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeDeformationGradient(bool on);
  vtkGetMacro(ComputeDeformationGradient, bool);
  vtkBooleanMacro(ComputeDeformationGradient, bool);
  /**
   * Put the elastic energy of every point into the output.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeEnergyDensity(bool on);
  vtkGetMacro(ComputeEnergyDensity, bool);
  vtkBooleanMacro(ComputeEnergyDensity, bool);
  /**
   * Put the equivalent plastic strain of every point into the output: how much has flowed where walls yield.
   * @group State shown
   */
  virtual void SetComputePlasticStrain(bool on);
  vtkGetMacro(ComputePlasticStrain, bool);
  vtkBooleanMacro(ComputePlasticStrain, bool);
  ///@}

  /** As vtkBondBreakAlgorithm. */
  vtkSettingMacro(CheckpointFile, std::string, "");
  /** As vtkBondBreakAlgorithm. Steps between two checkpoints. Go on with the number that the run began with. */
  vtkSettingMacro(CheckpointEvery, vtkIdType, 2000);
  ///@{
  /** As vtkBondBreakAlgorithm. */
  vtkSettingMacro(CheckpointSeconds, double, 0);
  vtkSettingMacro(ContinueFile, std::string, "");
  vtkGetMacro(LastCheckpoint, vtkIdType);
  ///@}

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

  /** Output 0. */
  vtkPolyData* GetPoints();
  /** Output 1. */
  vtkTable* GetCurve();
  ///@{
  /** Of the last update, the points of this rank; null where there is none such. */
  int GetNumberOfStates();
  vtkPolyData* GetStatePoints(int state);
  ///@}

  /** Later than the last change of a setting, or of State. */
  vtkMTimeType GetMTime() override;

protected:
  vtkPointCompression();
  ~vtkPointCompression() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkImageData* input, vtkInformationVector* outputs, const lamella::Team& team) override;

private:
  struct Internals;
  std::unique_ptr<Internals> Kept;

  bool ComputeDisplacement = true;
  bool ComputeVelocity = false;
  bool ComputeStress = false;
  bool ComputeDeformationGradient = false;
  bool ComputeEnergyDensity = false;
  bool ComputePlasticStrain = false;
  int StateRange[2] = { -1, 0 }; // VTK's macros want an array
  vtkIdType LastCheckpoint = 0;
};
