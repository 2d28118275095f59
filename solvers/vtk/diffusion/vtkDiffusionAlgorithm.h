/**
 * @class   vtkDiffusionAlgorithm
 * @brief   diffusion through an image of phases: lattice, sides, what diffuses, threads, what went wrong
 *
 * What diffusion at rest and in time share.
 *
 * **Input**: vtkImageData with phases at its points: an array of whole numbers, `phase` unless another is chosen with
 * SetInputArrayToProcess(0, ...). Nodes are pixel centres; the spacing is the same along every axis (steady
 * diffusion takes any). An image of one layer along z is two-dimensional.
 *
 * **Directions**: x from left to right, y in two dimensions from the top of the picture to its bottom, in three
 * dimensions along rising y; z along rising z.
 *
 * **Parallel**: with a vtkMPIController and as many pieces as processes all ranks work together, whatever pieces the
 * pipeline gave them.
 *
 * @sa vtkSteadyDiffusion, vtkLatticeBoltzmann
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkMultiProcessController.h"  // for the smart pointer
#include "vtkSetting.h"
#include "vtkSmartPointer.h"

#include <functional> // for std::function
#include <map>        // for tables by phase
#include <string>     // for tables by phase

class VTKLAMELLASOLVERSVTK_EXPORT vtkDiffusionAlgorithm : public vtkImageAlgorithm
{
public:
  vtkTypeMacro(vtkDiffusionAlgorithm, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Directions
  {
    X = 0,
    Y = 1,
    Z = 2
  };
  /** Axis of the gradient, between the two faces that keep their values. Default X. */
  vtkGetMacro(Direction, int);

  enum Quantities
  {
    TEMPERATURE = 0,
    CONCENTRATION = 1
  };
  /**
   * What diffuses. It names the output array.
   * @group Diffusion
   * @choice Quantities
   */
  vtkSettingMacro(Quantity, int, TEMPERATURE);

  enum SideTypes
  {
    INSULATED = 0,
    PERIODIC = 1,
    MIXED = 2 ///< values on the two faces of the direction, periodic across
  };
  /**
   * The other sides.
   * @group Diffusion
   * @choice SideTypes
   */
  vtkSettingMacro(Sides, int, INSULATED);

  enum Lattices
  {
    AUTO_LATTICE = 0, ///< "D2Q5 or D3Q7": D2Q5 or D3Q7; D2Q9 or elements for conductivities along and across
    D2Q5 = 1,         ///< "D2Q5"
    D2Q9 = 2,         ///< "D2Q9"
    D3Q7 = 3,         ///< "D3Q7"
    D3Q19 = 4,        ///< "D3Q19"
    Q1 = 5            ///< "Trilinear elements, at rest only"
  };
  /**
   * Links of the lattice; q1: instead of links trilinear elements between the corners of voxels, for diffusion at rest.
   * @group Accuracy and cost
   * @choice Lattices
   * @advanced
   */
  vtkSettingMacro(Lattice, int, AUTO_LATTICE);

  /**
   * Put the flux vectors into the output. Off, they are neither computed nor stored.
   * @group Time
   */
  vtkSwitchMacro(ComputeFlux, true);

  /** As vtkSampleAlgorithm. */
  vtkSettingMacro(Threads, int, 1);

  /** What kind of mistake the last update ended with: a value of vtkSampleAlgorithm::Failures. */
  vtkGetMacro(Failure, int);

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkDiffusionAlgorithm();
  ~vtkDiffusionAlgorithm() override = default;

  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Runs it; what it throws becomes an error of VTK, with its kind in Failure and empty outputs.
  /// @return what RequestData() returns
  int Attempt(const std::function<void()>& run, vtkInformationVector* outputs);

  /// A number of each phase, by its name or, where no phase has that name, its id.
  using PhaseValues = std::map<std::string, double>;

  /// "temperature" or "concentration"; "insulated" or "periodic".
  const char* QuantityName() const;
  const char* SidesName() const;
  int ThreadCount() const;

  int Direction = X;
  vtkSmartPointer<vtkMultiProcessController> Controller = vtkMultiProcessController::GetGlobalController();

private:
  int Failure = 0;
};
