/**
 * @class   vtkSampleAlgorithm
 * @brief   takes an image of phases as a sample: which of them are void, threads, what went wrong
 *
 * What the solvers on bonds and those on points share.
 *
 * **Input**: vtkImageData, with phases at its points (array `phase` unless SetInputArrayToProcess(0, ...) names
 * another).
 *
 * @sa vtkBondAlgorithm, vtkPointAlgorithm
 */

#pragma once

#include "vtkDataObjectAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkMultiProcessController.h"  // for the smart pointer
#include "vtkSetting.h"
#include "vtkSmartPointer.h"

#include <functional> // for std::function
#include <string>     // for members
#include <vector>     // for members

class VTKLAMELLASOLVERSVTK_EXPORT vtkSampleAlgorithm : public vtkDataObjectAlgorithm
{
public:
  vtkTypeMacro(vtkSampleAlgorithm, vtkDataObjectAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Phases without bonds or points. None: those called void, pore, lumen, air or 0 that no table names.
   *
   * An empty name is ignored (an empty row in a panel); the update fails for a phase that the image does not know.
   * @title Phases that are void
   * @group Materials
   * @advanced
   */
  void AddVoid(const char* phase);
  void RemoveAllVoids();
  ///@}

  /**
   * Threads of each process. 0: one for each core.
   * @group Accuracy and cost
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(Threads, int, 1);

  enum Axes
  {
    LAST_AXIS = -1, ///< "Last: y of a picture, z of a volume": y of a picture (upwards), z of a volume
    X = 0,
    Y = 1,
    Z = 2
  };

  enum Events
  {
    /// A run that keeps states has come to one: the call data are this vtkDataObject, with its arrays, its time and the
    /// numbers of the state. What the run as a whole found is not in it yet.
    STEP_EVENT = 1100
  };

  enum Failures
  {
    NO_FAILURE = 0,
    INPUT_FAILURE = 1,
    PARAMETER_FAILURE = 2,
    NO_PATH_FAILURE = 3, ///< nothing carries the load
    MEMORY_FAILURE = 4,
    DIVERGENCE_FAILURE = 5,
    OTHER_FAILURE = 6
  };
  /** What kind of mistake the last update ended with. */
  vtkGetMacro(Failure, int);

  ///@{
  /**
   * The first error that a source or filter of Lamella ended with since it was forgotten: its kind, a value of
   * Failures, what was wrong, and what to do about it. Of this process, whichever object it was.
   */
  static int LastFailure();
  static std::string LastMessage();
  static std::string LastHint();
  static void ForgetLastFailure();
  ///@}
  /**
   * The value of a word among the choices of a setting, by the words of the class's header: "vtkSteadyDiffusion",
   * "direction", "all". Where it is none, the last failure says so, and -1000000 comes back.
   */
  static int FindChoice(const char* className, const char* setting, const char* word);

protected:
  vtkSampleAlgorithm();
  ~vtkSampleAlgorithm() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  /// Each rank's piece of the image where the controller's ranks work together, else all of it.
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Runs it; what it throws becomes an error of VTK, with its kind in Failure and empty outputs.
  /// @return what RequestData() returns
  int Attempt(const std::function<void()>& run, vtkInformationVector* outputs);

  const std::vector<std::string>& GivenVoids() const { return this->Voids; }
  int ThreadCount() const;

  vtkSmartPointer<vtkMultiProcessController> Controller; ///< null: each rank works by itself

private:
  std::vector<std::string> Voids;
  int Failure = NO_FAILURE;
};
