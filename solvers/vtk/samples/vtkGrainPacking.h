/**
 * @class   vtkGrainPacking
 * @brief   dense packings of disks and spheres by discrete elements
 *
 * Polydisperse grains, pressed together isotropically and weakly until they are at rest (packing/Packing.h says how).
 * The same settings and seed give the same grains everywhere.
 *
 * **Output 0**: vtkPolyData, a vertex at the centre of each grain (z = 0 in 2D) with the point arrays `radius` [m],
 * `diameter` [m], `grain` (from 1), `contacts` (how many it has), `rattler` (1: nothing holds it), `net_force` (3
 * components) and `normal_force` (sum over its contacts) [N; in 2D N/m]. Field data: `box` [m] (3 numbers; the third is
 * 0 in 2D), `periodic` (3), `packing_fraction`, `aspect`, `rattlers`, `contacts`, `wall_contacts`, `coordination`,
 * `fabric` (9, by rows), `stress` (9) [Pa], `fabric_anisotropy`, `stress_anisotropy`, `unbalanced_force`, `pressure`
 * [Pa], `relaxation_steps`, `stage`, `state_number`, `seed`, `provenance`.
 *
 * **Output 1**: vtkPolyData, a line for each contact, from centre to centre or to the point on the wall, with the cell
 * arrays `force` [N; in 2D N/m], `normal_force`, `overlap` [m], `first`, `second` (grain numbers; −1 … −6: the walls at
 * low x, high x, low y …) and `wall`. Points carry `normal_force` too, so that tubes can be drawn as wide as the force.
 *
 * **States** on the way, each so many steps of relaxation (StateEvery), and always the end (stage `at rest`). Those who
 * observe vtkSampleAlgorithm::STEP_EVENT get the grains of each as call data while it runs. The time of a state is its
 * number of steps.
 *
 * On several ranks the first one has all grains.
 *
 * @sa vtkPackingReader vtkMatrixBridges
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSetting.h"

#include <memory> // for std::unique_ptr

class VTKLAMELLASOLVERSVTK_EXPORT vtkGrainPacking : public vtkPolyDataAlgorithm
{
public:
  static vtkGrainPacking* New();
  vtkTypeMacro(vtkGrainPacking, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Disks in a plane or spheres in space.
   * @group Grains
   * @values 2 = 2: disks; 3 = 3: spheres
   */
  vtkSettingMacro(Dimension, int, 2);

  /**
   * How many grains: at least 10 disks or 30 spheres. 400 disks take about a second.
   * @group Grains
   * @range [1, inf)
   */
  vtkSettingMacro(Count, vtkIdType, 400);

  /**
   * Mean of the grains' diameters in metres.
   * @group Grains
   * @unit m
   * @range (0, inf)
   */
  vtkSettingMacro(MeanDiameter, double, 1e-3);

  /**
   * Largest diameter over the smallest.
   * @group Grains
   * @range [1, 10]
   */
  vtkSettingMacro(DiameterRatio, double, 2);

  enum SizeDistributions
  {
    VOLUME = 0,       ///< "Areas or volumes evenly": areas (3D: volumes) spread evenly
    VOLUME_SHARE = 1, ///< "Every diameter fills the same share": every diameter fills the same share of the volume
    DIAMETER = 2      ///< "Diameters evenly": diameters spread evenly
  };
  /**
   * How sizes are spread between the smallest grain and the largest. Every diameter fills the same share: many small
   * grains and few large ones.
   * @group Grains
   * @choice SizeDistributions
   */
  vtkSettingMacro(Sizes, int, VOLUME);

  /**
   * Edge of the box along its last axis (y of disks, z of spheres) over the other edges.
   * @group Grains
   * @range [0.2, 5]
   */
  vtkSettingMacro(Aspect, double, 2);

  /**
   * The box is one cell of an endless packing, periodic along all axes. Otherwise it has smooth walls.
   * @group Grains
   */
  vtkSwitchMacro(Periodic, false);

  /**
   * Coulomb's friction coefficient between grains and with walls. More friction, looser packings.
   * @group Compaction
   * @range [0, 2]
   */
  vtkSettingMacro(Friction, double, 0);

  /**
   * What the walls press with, in pascals. Forces are in proportion to it.
   * @group Compaction
   * @unit Pa
   * @range (0, inf)
   */
  vtkSettingMacro(Pressure, double, 1000);

  /**
   * Pressure over the contacts' stiffness: about the mean overlap of two grains over the diameter.
   * @group Compaction
   * @range [1e-7, 1e-2]
   * @advanced
   */
  vtkSettingMacro(Softness, double, 1e-6);

  /**
   * Ends the compaction at this share of the box, before the grains jam and touch. 0: they jam.
   * @group Compaction
   * @range [0, 1)
   */
  vtkSettingMacro(PackingFraction, double, 0);

  /**
   * Another seed gives another packing of the same grains.
   * @group Grains
   * @range [0, inf)
   */
  vtkSettingMacro(Seed, vtkIdType, 1);

  ///@{
  /**
   * Several packings, one of each of these seeds, instead of that of Seed: they are the states, in this order, and the
   * same as one by one.
   * @word seeds
   * @group Grains
   * @columns Seed
   * @advanced
   */
  void AddSeed(vtkIdType seed);
  void RemoveAllSeeds();
  ///@}

  /**
   * Of several packings: how many at once. 0: one for each core. One packing runs on one thread.
   * @group Grains
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Threads, int, 1);

  /**
   * At rest, the mean net force on a grain is below this share of the mean contact force.
   * @group Compaction
   * @range [1e-8, 1e-2]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-4);

  /**
   * Steps of relaxation from one state that is kept on the way to the next. 0: the end alone. The packing at the end
   * does not depend on it.
   * @word every
   * @group States
   * @range [0, inf)
   */
  vtkSettingMacro(StateEvery, vtkIdType, 0);

  /** As vtkBondBreakAlgorithm. */
  vtkSwitchMacro(KeepStates, true);
  ///@{
  /**
   * As vtkBondBreakAlgorithm.
   * @group States
   */
  void SetState(int state);
  int GetState();
  vtkGetVector2Macro(StateRange, int);
  ///@}

  /** The contacts, output 1. */
  vtkPolyData* GetContacts();
  ///@{
  /** Of the last update; null where there is none such. */
  int GetNumberOfStates();
  vtkPolyData* GetStateGrains(int state);
  vtkPolyData* GetStateContacts(int state);
  ///@}
  /** What kind of mistake the last update ended with: vtkSampleAlgorithm::Failures. */
  vtkGetMacro(Failure, int);

  /** Later than the last change of a setting, or of State. */
  vtkMTimeType GetMTime() override;

protected:
  vtkGrainPacking();
  ~vtkGrainPacking() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Internals;
  std::unique_ptr<Internals> Kept;

  void Pack();

  int StateRange[2] = { -1, 0 }; // VTK's macros want an array
  int Failure = 0;
};
