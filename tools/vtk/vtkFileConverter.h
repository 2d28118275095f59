/**
 * @class   vtkFileConverter
 * @brief   reads, writes and converts files of all formats as `lamella convert` does
 *
 * From a file, or from data (SetInputData), to files (SetOutputFileName) or, where none is named, to data (GetOutput).
 * What each format holds, what is refused and what is kept is the same as on the command line, and so are the words:
 * docs/commands/convert.md. Images in files may be larger than memory: a slab is read and written at a time.
 *
 * Update() does it, each time it is called; it has no part in a pipeline. An error is reported with vtkErrorMacro, its
 * remedy on a second line after `hint: `, and sets ErrorCode. Files appear all, whole, or none. ProgressEvent tells the
 * share that is done; AbortExecute stops it, and nothing is kept.
 *
 * @warning While it runs, messages of VTK, from other threads too, are kept from vtkOutputWindow.
 */

#pragma once

#include "vtkAlgorithm.h"
#include "vtkLamellaConvertModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for data

#include <string> // for words
#include <vector> // for words

class vtkDataObject;
class vtkDoubleArray;
class vtkStringArray;

#ifndef __VTK_WRAP__
namespace lamella::cli
{
struct ConversionWords;
}
#endif

class VTKLAMELLACONVERT_EXPORT vtkFileConverter : public vtkAlgorithm
{
public:
  static vtkFileConverter* New();
  vtkTypeMacro(vtkFileConverter, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * What is read: a file, a folder or pattern of slices (slice_%04d.png), a .pvd, or a pattern of steps (step_*.vti).
   * @files Files (*)
   * @word file, source
   */
  vtkSettingMacro(FileName, std::string, "");

  ///@{
  /** Data instead of a file: an image, poly data, an unstructured grid or a table. Shared, not changed. */
  void SetInputData(vtkDataObject* data);
  vtkDataObject* GetInputData();
  ///@}

  /**
   * What is written; the ending tells the format. A pattern for slices or steps. None: the output holds the data.
   * @files Files (*)
   * @word output, path
   */
  vtkSettingMacro(OutputFileName, std::string, "");

  ///@{
  /**
   * Keep this array; of several one each. None: all.
   * @group Values
   * @columns Array
   */
  void AddArray(const std::string& name);
  void ClearArrays();
  ///@}

  /**
   * Of a series: this step alone, counted from 0. Not given (-1): all.
   * @group Values
   * @range [0, inf)
   * @unset -1
   */
  vtkSettingMacro(Step, int, -1);

  /**
   * Write numbers of this type. Empty: as they are.
   * @word type
   * @group Values
   * @words u8 i8 u16 i16 u32 i32 u64 i64 f32 f64
   */
  vtkSettingMacro(NumberType, std::string, "");

  /**
   * These values become the least and the largest grey of u8, or of u16. Not given (0): values stay.
   * @group Values
   * @columns low, high
   * @unset 0
   */
  vtkSettingVector2Macro(Range, double, 0, 0);

  /**
   * Go on where something is lost: nearest values of another type, cells in a table, gaps in a series, transparency.
   * @group Values
   */
  vtkSwitchMacro(Lossy, false);

  ///@{
  /**
   * Of a volume: write the closed surface of this phase, its name or its value; of several that of their union. None:
   * the volume.
   * @group Surface
   * @columns Phase
   */
  void AddPhase(const std::string& name);
  void ClearPhases();
  ///@}

  /**
   * Iterations of a windowed sinc filter that smooth the surface, such as 20. 0: as it is.
   * @word smooth
   * @group Surface
   * @range [0, inf)
   */
  vtkSettingMacro(Smoothing, int, 0);

  /** Replace files that exist. */
  vtkSwitchMacro(Overwrite, false);

  ///@{
  /** As vtkPictureReader. */
  vtkSettingMacro(PixelSize, double, 0);
  vtkSettingVector3Macro(RawSize, int, 0, 0, 0);
  vtkSettingMacro(RawBits, int, 0);
  vtkSettingMacro(RawHeader, vtkIdType, 0);
  ///@}

  /**
   * Raw volumes: type of the numbers. Empty: from the name or the notes beside it.
   * @group Raw volumes
   * @words u8 i8 u16 i16 u32 i32 u64 i64 f32 f64
   */
  vtkSettingMacro(RawType, std::string, "");

  /**
   * Raw volumes: order of the bytes. Empty: little.
   * @group Raw volumes
   * @words little big
   */
  vtkSettingMacro(RawOrder, std::string, "");

#ifndef __VTK_WRAP__
  /** The settings, as lamella::cli::convert() takes them. */
  lamella::cli::ConversionWords GetWords() const;
#endif

  using vtkAlgorithm::Update;
  void Update() override;

  /** What was read, where no file was to be written. */
  vtkDataObject* GetOutput();
  /** Files that were written, the names of slices and steps and of what stands beside them. */
  vtkStringArray* GetFiles();
  /** How many steps the source has. */
  vtkGetMacro(NumberOfSteps, int);
  /** When the steps that were written are; of what was read, all steps of the source where it tells their times. */
  vtkDoubleArray* GetTimes();
  /** What is doubtful. */
  vtkStringArray* GetWarnings();

protected:
  vtkFileConverter();
  ~vtkFileConverter() override;

private:
  void Convert();

  std::vector<std::string> Arrays;
  std::vector<std::string> Phases;
  int NumberOfSteps = 0;
  vtkSmartPointer<vtkDataObject> Input;
  vtkSmartPointer<vtkDataObject> Output;
  vtkSmartPointer<vtkStringArray> Files;
  vtkSmartPointer<vtkDoubleArray> Times;
  vtkSmartPointer<vtkStringArray> Warnings;
};
