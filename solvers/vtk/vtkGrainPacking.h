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

#ifndef vtkGrainPacking_h
#define vtkGrainPacking_h

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKLAMELLASOLVERSVTK_EXPORT vtkGrainPacking : public vtkPolyDataAlgorithm
{
public:
  static vtkGrainPacking* New();
  vtkTypeMacro(vtkGrainPacking, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** 2: disks, 3: spheres. Default 2. */
  vtkSetMacro(Dimension, int);
  vtkGetMacro(Dimension, int);
  ///@}

  ///@{
  /** How many grains, at least 10 disks or 30 spheres. Default 400. */
  vtkSetMacro(Count, vtkIdType);
  vtkGetMacro(Count, vtkIdType);
  ///@}

  ///@{
  /** Mean of the grains' diameters in metres. Default 1e-3. */
  vtkSetMacro(MeanDiameter, double);
  vtkGetMacro(MeanDiameter, double);
  ///@}

  ///@{
  /** Largest diameter over the smallest, from 1 to 10. Default 2. */
  vtkSetMacro(DiameterRatio, double);
  vtkGetMacro(DiameterRatio, double);
  ///@}

  enum SizeDistributions
  {
    VOLUME = 0,       ///< areas (3D: volumes) spread evenly
    VOLUME_SHARE = 1, ///< every diameter fills the same share of the volume
    DIAMETER = 2      ///< diameters spread evenly
  };
  ///@{
  /** How sizes are spread between the smallest and the largest grain. Default VOLUME. */
  vtkSetClampMacro(Sizes, int, VOLUME, DIAMETER);
  vtkGetMacro(Sizes, int);
  ///@}

  ///@{
  /** Edge of the box along its last axis (y of disks, z of spheres) over the other edges, 0.2 to 5. Default 2. */
  vtkSetMacro(Aspect, double);
  vtkGetMacro(Aspect, double);
  ///@}

  ///@{
  /** Periodic along all axes, or between smooth walls. Default off. */
  vtkSetMacro(Periodic, bool);
  vtkGetMacro(Periodic, bool);
  vtkBooleanMacro(Periodic, bool);
  ///@}

  ///@{
  /** Coulomb's friction coefficient between grains and with walls, 0 to 2. Default 0. */
  vtkSetMacro(Friction, double);
  vtkGetMacro(Friction, double);
  ///@}

  ///@{
  /** On the walls, in pascals. Default 1000. */
  vtkSetMacro(Pressure, double);
  vtkGetMacro(Pressure, double);
  ///@}

  ///@{
  /** Pressure over the contacts' stiffness: about the mean overlap over the diameter, 1e-7 to 1e-2. Default 1e-6. */
  vtkSetMacro(Softness, double);
  vtkGetMacro(Softness, double);
  ///@}

  ///@{
  /** Ends the compaction at this share of the box, before grains jam and touch. 0 (default): they jam. */
  vtkSetMacro(PackingFraction, double);
  vtkGetMacro(PackingFraction, double);
  ///@}

  ///@{
  /** Another seed, another sample. Default 1. */
  vtkSetMacro(Seed, vtkIdType);
  vtkGetMacro(Seed, vtkIdType);
  ///@}

  ///@{
  /** Mean net force on a grain over the mean contact force at rest, 1e-8 to 1e-2. Default 1e-4. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /** Steps of relaxation from one state that is kept on the way to the next; 0 (default): the end alone. The packing at
   * the end does not depend on it. */
  vtkSetClampMacro(StateEvery, vtkIdType, 0, VTK_ID_MAX);
  vtkGetMacro(StateEvery, vtkIdType);
  ///@}

  ///@{
  /** Whether all states stay, or only the last one. Off, memory holds one at a time: those who observe
   * vtkSampleAlgorithm::STEP_EVENT have seen each. Default on. */
  vtkSetMacro(KeepStates, bool);
  vtkGetMacro(KeepStates, bool);
  vtkBooleanMacro(KeepStates, bool);
  ///@}

  ///@{
  /** The state that the outputs show, from 0, in the order of the run; -1 (default): the end. A change runs nothing
   * again. Beyond the last it is the end. */
  void SetState(int state);
  int GetState();
  ///@}

  /** The contacts, output 1. */
  vtkPolyData* GetContacts();
  ///@{
  /** Of the last update; null where there is none such. */
  int GetNumberOfStates();
  vtkPolyData* GetStateGrains(int state);
  vtkPolyData* GetStateContacts(int state);
  ///@}
  ///@{
  /** -1 and the number of the last state, for a slider; 0 before the first update. */
  vtkGetVector2Macro(StateRange, int);
  ///@}
  ///@{
  /** What kind of mistake the last update ended with: vtkSampleAlgorithm::Failures. */
  vtkGetMacro(Failure, int);
  ///@}

  /** Later than the last change of a setting, or of State. */
  vtkMTimeType GetMTime() override;

protected:
  vtkGrainPacking();
  ~vtkGrainPacking() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkGrainPacking(const vtkGrainPacking&) = delete;
  void operator=(const vtkGrainPacking&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Kept;

  void Pack();

  int Dimension;
  vtkIdType Count;
  double MeanDiameter;
  double DiameterRatio;
  int Sizes;
  double Aspect;
  bool Periodic;
  double Friction;
  double Pressure;
  double Softness;
  double PackingFraction = 0;
  vtkIdType Seed;
  double Tolerance;
  vtkIdType StateEvery = 0;
  bool KeepStates = true;
  int StateRange[2] = { -1, 0 }; // VTK's macros want an array
  int Failure = 0;
};

#endif
