/**
 * @class   vtkLatticeBoltzmann
 * @brief   heat or vapour that diffuses through an image of phases, in time
 *
 * Steps lattice Boltzmann for ∂u/∂t = div(D grad u) on the lattice of the image's points
 * (lbm/stepping/LatticeBoltzmann.h): two relaxation times, whose state at rest is that of vtkSteadyDiffusion, or one,
 * as in Perré, Almeida, Ayouz & Frank, Annals of Forest Science 73 (2016) 147, section 3.1. Two faces keep their
 * values, the field starts at a constant.
 *
 * **Input**: an image of phases, as vtkSteadyDiffusion.
 *
 * **Output**: the input at one of NumberOfSteps + 1 evenly spaced times from 0 to EndTime, which the pipeline knows as
 * time steps [s], with
 * - `temperature` or `concentration` (double; NaN where nothing conducts),
 * - `flux` (3 doubles, −D grad u [m/s]; 0 where nothing conducts), on demand.
 * Field data: `time` [s], `inlet_flux` and `outlet_flux` (means over the faces of the direction [m/s]), `mean_value`
 * (over the box, 0 where nothing conducts); `time_step` [s], `steps` (to this time), `relaxation` (τ − ½ of the phase
 * that conducts best), `stored_nodes`, `skipped_nodes`, `updates_per_second`, `bytes`; `collision`, `lattice`,
 * `direction`, `sides`, `warning` (empty, or where one relaxation time is inaccurate) and `provenance`.
 *
 * All times are stepped through at the first request and kept: 8 bytes a node and time (32 with the flux).
 *
 * **Parallel**: as vtkSteadyDiffusion; the field is the same to the bit.
 *
 * @warning The answer of one relaxation time (BGK) depends on the time step; it is there to compare with.
 *
 * @sa vtkSteadyDiffusion
 */

#ifndef vtkLatticeBoltzmann_h
#define vtkLatticeBoltzmann_h

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <memory> // for std::unique_ptr

class vtkMultiProcessController;

namespace lamella
{
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkLatticeBoltzmann : public vtkImageAlgorithm
{
public:
  static vtkLatticeBoltzmann* New();
  vtkTypeMacro(vtkLatticeBoltzmann, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Diffusivity of a phase [m²/s], finite and not negative; 0: it does not conduct and is neither stored nor visited.
   * `phase` is a name of `phase_names` or, where no phase has that name, an id. A phase that has nodes must have one;
   * names that the image does not know are ignored. An empty name is ignored.
   */
  void SetDiffusivity(const char* phase, double value);
  void RemoveAllDiffusivities();
  ///@}

  enum Directions
  {
    X = 0,
    Y = 1,
    Z = 2
  };
  ///@{
  /** Axis of the two faces that keep their values; in a picture y leads from the top to the bottom. Default X. */
  vtkSetClampMacro(Direction, int, X, Z);
  vtkGetMacro(Direction, int);
  ///@}
  ///@{
  /** Values on the face where the direction begins (default 1), where it ends (0), and inside at time 0 (0). */
  vtkSetMacro(InletValue, double);
  vtkGetMacro(InletValue, double);
  vtkSetMacro(OutletValue, double);
  vtkGetMacro(OutletValue, double);
  vtkSetMacro(InitialValue, double);
  vtkGetMacro(InitialValue, double);
  ///@}

  enum Quantities
  {
    TEMPERATURE = 0,
    CONCENTRATION = 1
  };
  ///@{
  /** What diffuses: names the output array. Default TEMPERATURE. */
  vtkSetClampMacro(Quantity, int, TEMPERATURE, CONCENTRATION);
  vtkGetMacro(Quantity, int);
  ///@}

  enum SideTypes
  {
    INSULATED = 0,
    PERIODIC = 1
  };
  ///@{
  /** The other sides. Default INSULATED. */
  vtkSetClampMacro(Sides, int, INSULATED, PERIODIC);
  vtkGetMacro(Sides, int);
  ///@}

  enum Collisions
  {
    AUTO_COLLISION = 0, ///< TRT
    BGK = 1,            ///< one relaxation time; faces and mirrors on the outer nodes
    TRT = 2             ///< two; faces half a spacing outside the outer nodes
  };
  ///@{
  /** Default AUTO_COLLISION. */
  vtkSetClampMacro(Collision, int, AUTO_COLLISION, TRT);
  vtkGetMacro(Collision, int);
  ///@}

  enum Lattices
  {
    AUTO_LATTICE = 0, ///< D2Q5 or D3Q7
    D2Q5 = 1,
    D2Q9 = 2,
    D3Q7 = 3,
    D3Q19 = 4
  };
  ///@{
  /** Default AUTO_LATTICE. */
  vtkSetClampMacro(Lattice, int, AUTO_LATTICE, D3Q19);
  vtkGetMacro(Lattice, int);
  ///@}

  ///@{
  /** The last time [s], above 0. Default 1. */
  vtkSetMacro(EndTime, double);
  vtkGetMacro(EndTime, double);
  ///@}
  ///@{
  /** Times after 0 that are kept. Default 10. */
  vtkSetClampMacro(NumberOfSteps, int, 1, 100000);
  vtkGetMacro(NumberOfSteps, int);
  ///@}
  ///@{
  /**
   * δt [s]; 0 (default): at most that of a relaxation of ½, and such that every time is met. A δt that is given meets
   * each time as nearly as pairs of steps do, and the output says the time that it has.
   */
  vtkSetMacro(TimeStep, double);
  vtkGetMacro(TimeStep, double);
  ///@}
  ///@{
  /** Whether the output has the flux. Default off. */
  vtkSetMacro(ComputeFlux, bool);
  vtkGetMacro(ComputeFlux, bool);
  vtkBooleanMacro(ComputeFlux, bool);
  ///@}
  ///@{
  /** Threads of each rank; 0: one for each core that the machine has. Default 1. */
  vtkSetClampMacro(Threads, int, 0, VTK_INT_MAX);
  vtkGetMacro(Threads, int);
  ///@}

  ///@{
  /** Whether all states of a run stay, or only the last one. Off, memory holds one at a time: those who observe
   * vtkSampleAlgorithm::STEP_EVENT have seen each. Default on. */
  vtkSetMacro(KeepStates, bool);
  vtkGetMacro(KeepStates, bool);
  vtkBooleanMacro(KeepStates, bool);
  ///@}
  ///@{
  /** The times that the last update has kept, from 0, and the image of each; null where there is none such. */
  int GetNumberOfStates();
  vtkImageData* GetStateImage(int state);
  ///@}
  ///@{
  /** What kind of mistake the last update ended with: a value of vtkSampleAlgorithm::Failures. */
  vtkGetMacro(Failure, int);
  ///@}

  ///@{
  /** The processes that may work together. Default: the global controller. */
  virtual void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkLatticeBoltzmann();
  ~vtkLatticeBoltzmann() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkLatticeBoltzmann(const vtkLatticeBoltzmann&) = delete;
  void operator=(const vtkLatticeBoltzmann&) = delete;

  struct Internals;
  void Run(vtkImageData* input, const lamella::Team& team);

  std::unique_ptr<Internals> Internal;

  int Direction = X;
  double InletValue = 1;
  double OutletValue = 0;
  double InitialValue = 0;
  int Quantity = TEMPERATURE;
  int Sides = INSULATED;
  int Collision = AUTO_COLLISION;
  int Lattice = AUTO_LATTICE;
  double EndTime = 1;
  int NumberOfSteps = 10;
  double TimeStep = 0;
  bool ComputeFlux = false;
  bool KeepStates = true;
  int Threads = 1;
  int Failure = 0;
  vtkMultiProcessController* Controller = nullptr;
};

#endif
