/**
 * @class   vtkBondBreakAlgorithm
 * @brief   a bonded sample that breaks: states kept on the way, broken bonds, a curve, checkpoints
 *
 * What fracture in steps of load and motion in time share. Output 0 is the input in one state (State), output 1 the
 * broken bonds (vtkPolyData, a vertex a bond), output 2 a table. All states of a run are kept, so that a change of
 * State runs nothing again. Nor does one of the fields that states show: what is switched off is only left out, and
 * stress and strain energy follow from a state's displacement and its bonds, of the state that is shown. Displacement
 * and velocity that a run was not to keep need another run.
 *
 * @sa vtkBondFracture, vtkBondDynamics
 */

#pragma once

#include "vtkBondLoadAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <cstdint> // for std::int64_t
#include <memory>  // for std::unique_ptr
#include <string>  // for members
#include <utility> // for std::pair
#include <vector>  // for return values

class vtkPolyData;
class vtkTable;

namespace lamella
{
class BondScene;
namespace io // VTK's wrappers do not read lamella::io
{
struct CheckpointOptions;
}
namespace peridynamics
{
struct Bond;
}
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondBreakAlgorithm : public vtkBondLoadAlgorithm
{
public:
  vtkTypeMacro(vtkBondBreakAlgorithm, vtkBondLoadAlgorithm);

  /**
   * The high platen moves the other way, towards the low one; strains and stresses are positive then too.
   * @group Load
   */
  vtkSwitchMacro(Compression, false);

  /**
   * Of a pull: ends when the stress has fallen to this share of the peak. 0 may never be reached: hinges do not part.
   * @word stop
   * @group Breaking
   * @range [0, 1)
   */
  vtkSettingMacro(StopShare, double, 0.05);
  /**
   * Ends at this strain. 0: no limit.
   * @word max-strain
   * @group Breaking
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumStrain, double, 0);
  /**
   * Ends after so many broken bonds. 0: no limit.
   * @word max-broken
   * @group Breaking
   * @range [0, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumBroken, vtkIdType, 0);

  ///@{
  /**
   * States to keep on the way, at numbers of broken bonds; the end is always kept. They change nothing that breaks.
   * @word at-broken
   * @title States to keep: broken bonds
   * @group States
   * @columns Broken bonds
   */
  void AddStateAtBroken(vtkIdType broken);
  void RemoveAllStatesAtBroken();
  ///@}
  /**
   * Whether all states of a run stay, or only the last one. Off, memory holds one at a time: those who observe
   * vtkSampleAlgorithm::STEP_EVENT have seen each.
   */
  vtkSwitchMacro(KeepStates, true);
  ///@{
  /**
   * The state that is shown, from 0, in the order of the run; -1: the end. A change runs nothing again. Beyond the last
   * it is the end.
   * @group State shown
   * @default -1
   */
  void SetState(int state);
  int GetState();
  ///@}
  /** -1 and the number of the last state, for a slider; 0 before the first update. */
  vtkGetVector2Macro(StateRange, int);

  /**
   * A file (.h5) on the server that keeps where the run stands; what is there already is replaced. Empty: none.
   *
   * In HDF5, after every CheckpointEvery, at the end and where the run is interrupted. When it cannot be written the
   * run goes on, and says so.
   * @word checkpoint
   * @group Checkpoints
   * @files Checkpoints (*.h5 *.hdf5)
   * @advanced
   */
  vtkSettingMacro(CheckpointFile, std::string, "");
  /**
   * Events of fracture (default 500) or steps in time (default 1000) between two checkpoints; at least 1. In fracture
   * all that is only there to save work is made anew then, whether a file is written or not: what breaks depends on
   * it in near ties, so a run goes on with the number that it began with.
   * @group Checkpoints
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(CheckpointEvery, vtkIdType, 500);
  /**
   * Wall time before the first checkpoint and between two at least [s]. Above 0 there is none at the end, and none that
   * the run would not go on from alike.
   * @range [0, inf)
   */
  vtkSettingMacro(CheckpointSeconds, double, 0);
  /**
   * A checkpoint of the same run to go on from, as if it had never stopped. Empty: from the start, as where this is
   * Checkpoint File and not there yet.
   *
   * The same bonds break, to the last bit. States that lie before it are not made.
   * @word continue, continue_from
   * @group Checkpoints
   * @files Checkpoints (*.h5 *.hdf5)
   * @advanced
   */
  vtkSettingMacro(ContinueFile, std::string, "");
  /** Events or steps in the last checkpoint of the last update, also of one that was interrupted; 0: none. */
  vtkGetMacro(LastCheckpoint, vtkIdType);

  ///@{
  /**
   * Put the displacement of every node into the output.
   * @group State shown
   * @advanced
   */
  virtual void SetComputeDisplacement(bool on);
  vtkGetMacro(ComputeDisplacement, bool);
  vtkBooleanMacro(ComputeDisplacement, bool);
  ///@}
  ///@{
  /** As vtkBondLoadAlgorithm; a change runs nothing again where the states carry displacements. */
  void SetComputeStress(bool on) override;
  void SetComputeStrainEnergy(bool on) override;
  ///@}

  /** Output 1. */
  vtkPolyData* GetBrokenBonds();
  /** Output 2. */
  vtkTable* GetCurve();
  ///@{
  /** Of the last update. The image is the piece of this rank; null where there is none such. */
  int GetNumberOfStates();
  vtkImageData* GetStateImage(int state);
  ///@}
  /** Largest stress of the last update [Pa]; NaN before it. */
  vtkGetMacro(PeakStress, double);

  /** Later than the last change of a setting, or of State. */
  vtkMTimeType GetMTime() override;

protected:
  vtkBondBreakAlgorithm();
  ~vtkBondBreakAlgorithm() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;

  void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team) override;

  /// Runs it all: fills broken bonds and curve, which are given empty, keeps at least one state. Collective.
  virtual void Solve(vtkImageData* input, const lamella::Team& team, vtkPolyData* broken, vtkTable* curve) = 0;

  /// A new state, a shallow copy of the input.
  vtkImageData* NewState(vtkImageData* input);
  /// Hands a state that is complete to those who observe steps.
  void EmitState(vtkImageData* state);
  /// The states kept so far.
  std::vector<vtkImageData*> KeptStates() const;
  std::vector<std::int64_t> StatesAtBroken() const;
  /// Adds what is to be said of the settings, and first that the run begins anew.
  void AddWarnings(const lamella::BondSettings& settings, std::vector<std::string>& warnings) const;
  /// Gives broken bonds and curve the field data of the last state, and says the warnings on rank 0.
  /// @param order the broken bonds, in the order of the run
  void Finish(vtkPolyData* broken, vtkTable* curve, std::vector<lamella::peridynamics::Bond> order,
    const lamella::BondScene& scene, const std::vector<std::string>& warnings, const lamella::Team& team);

  /// Whether the sample is in motion: forces are those of large strains, and pieces that come loose fly on.
  virtual bool Moves() const { return false; }
  /// Whether broken bonds that are pressed bear again.
  virtual bool CracksClose() const { return false; }
  /// The fields that only Solve() makes, by name, and whether they are asked for.
  virtual std::vector<std::pair<std::string, bool>> MadeFields() const;
  /// Switches a field of the states on or off: runs nothing again by itself.
  void Show(bool& setting, bool on);

  /// Of a limit: 0 stands for none, and leaves `limit` as it is. @throws lamella::ParameterError below 0
  static void SetLimit(const char* name, double value, double& limit);
  static void SetLimit(const char* name, vtkIdType value, std::int64_t& limit);

  /// Where checkpoints go.
  /// @return the file to go on from, empty where the run begins
  std::string PrepareCheckpoints(
    vtkImageData* input, const lamella::Team& team, lamella::io::CheckpointOptions& options);
  /// Tells observers at most some twenty times a second. @param text called for the words when it is due
  template <class Text>
  void Tell(double share, Text&& text)
  {
    if (this->Due())
    {
      this->SetProgressText(text().c_str());
      this->UpdateProgress(share);
    }
  }
  /// The next Tell() is heard whatever the time.
  void TellNext();
  bool Due();

  vtkIdType LastCheckpoint = 0;
  bool ComputeDisplacement = true;
  double PeakStress;
  int StateRange[2] = { -1, 0 }; // VTK's macros want an array

private:
  /// All fields that states may show or not.
  std::vector<std::pair<std::string, bool>> ShownFields() const;
  /// Whether the states neither have a field nor what it follows from.
  bool Lacks(const std::string& field) const;
  /// Adds stress and strain energy that are asked for to the state that is shown.
  void Measure(vtkImageData* input, const lamella::Team& team);

  struct Internals;
  std::unique_ptr<Internals> Kept;
};
