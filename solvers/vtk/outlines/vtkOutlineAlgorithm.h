/**
 * @class   vtkOutlineAlgorithm
 * @brief   what takes outlines, and the middle lamella between them
 *
 * Base of what makes lattices of outlines: the outlines as input 0; as input 1, optional, the picture that they were
 * found in; and how the middle lamella in the walls is found (outlines/MiddleLamella.h).
 *
 * @sa vtkMicrographLattice vtkOutlineDiffusion
 */

#pragma once

#include "vtkDataObjectAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"

#include <string> // for the phase

class vtkImageData;

class VTKLAMELLASOLVERSVTK_EXPORT vtkOutlineAlgorithm : public vtkDataObjectAlgorithm
{
public:
  vtkTypeMacro(vtkOutlineAlgorithm, vtkDataObjectAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The picture that the outlines were found in, input 1. */
  void SetPictureConnection(vtkAlgorithmOutput* picture) { this->SetInputConnection(1, picture); }
  void SetPictureData(vtkImageData* picture);
  ///@}

  enum LamellaTypes
  {
    NONE = 0,
    GROWTH = 1,   ///< "Growth": what lumens that grow leave between them: thicker where three cells meet
    CONSTANT = 2, ///< "Constant thickness": of one thickness, about the line as far from two lumens
    LABELS = 3    ///< "Labels": a phase of the picture
  };
  /**
   * How a middle lamella is found in the walls: what lumens that grow leave between them, thicker where three cells
   * meet; of one thickness; or a phase of the picture.
   * @group Middle Lamella
   * @choice LamellaTypes
   */
  vtkSettingMacro(Lamella, int, NONE);

  /**
   * Gap that growing outlines keep, or the constant thickness, in metres. 0: half a micrometre, but not more than an
   * eighth of the walls' median thickness.
   * @group Middle Lamella
   * @unit m
   * @range [0, inf)
   * @when Lamella GROWTH CONSTANT
   */
  vtkSettingMacro(LamellaThickness, double, 0);

  /**
   * Growing outlines stop where their radius of curvature has fallen to so many metres. 0: never. Below 0: a quarter of
   * the walls' median thickness.
   * @group Middle Lamella
   * @unit m
   * @when Lamella GROWTH
   */
  vtkSettingMacro(LamellaRadius, double, -1);

  /**
   * The phase of the picture that is the middle lamella. Empty: the one that is called middle lamella, or lamella.
   * @group Middle Lamella
   * @when Lamella LABELS
   */
  vtkSettingMacro(LamellaPhase, std::string, "");

protected:
  vtkOutlineAlgorithm();
  ~vtkOutlineAlgorithm() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
};
