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

#ifndef vtkFileConverter_h
#define vtkFileConverter_h

#include "vtkAlgorithm.h"
#include "vtkLamellaConvertModule.h" // for export macro
#include "vtkSmartPointer.h"         // for data

#include <string> // for words
#include <vector> // for words

class vtkDataObject;
class vtkDoubleArray;
class vtkStringArray;

class VTKLAMELLACONVERT_EXPORT vtkFileConverter : public vtkAlgorithm
{
public:
  static vtkFileConverter* New();
  vtkTypeMacro(vtkFileConverter, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * What is read: a file, a folder or pattern of slices, a .pvd, or a pattern of steps.
   * @word file, source
   */
  void SetFileName(const std::string& name) { this->Put(this->FileName, name); }
  const std::string& GetFileName() const { return this->FileName; }
  ///@}

  ///@{
  /** Data instead of a file: an image, poly data, an unstructured grid or a table. Shared, not changed. */
  void SetInputData(vtkDataObject* data);
  vtkDataObject* GetInputData();
  ///@}

  ///@{
  /**
   * What is written; the ending tells the format. A pattern for slices or steps. None: the output holds the data.
   * @word output, path
   */
  void SetOutputFileName(const std::string& name) { this->Put(this->OutputFileName, name); }
  const std::string& GetOutputFileName() const { return this->OutputFileName; }
  ///@}

  ///@{
  /** Arrays to keep. None: all. */
  void AddArray(const std::string& name);
  void ClearArrays();
  ///@}

  ///@{
  /** Phases of a volume whose closed surface, that of their union, is written in its place. None: the volume. */
  void AddPhase(const std::string& name);
  void ClearPhases();
  ///@}

  ///@{
  /**
   * Iterations of a windowed sinc filter that smooth the surface. 0: as it is.
   * @word smooth
   */
  vtkSetMacro(Smoothing, int);
  vtkGetMacro(Smoothing, int);
  ///@}

  ///@{
  /** Of a series: the step, counted from 0. -1: all. */
  vtkSetMacro(Step, int);
  vtkGetMacro(Step, int);
  ///@}

  ///@{
  /**
   * u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64. None: as the numbers are.
   * @word type
   */
  void SetNumberType(const std::string& type) { this->Put(this->NumberType, type); }
  const std::string& GetNumberType() const { return this->NumberType; }
  ///@}

  ///@{
  /** Values that become the least and the largest grey, low < high. None: values stay. */
  void SetRange(double low, double high);
  void ResetRange();
  ///@}

  ///@{
  /** Go on where something is lost. */
  vtkSetMacro(Lossy, bool);
  vtkGetMacro(Lossy, bool);
  vtkBooleanMacro(Lossy, bool);
  ///@}

  ///@{
  /** Replace files that exist. */
  vtkSetMacro(Overwrite, bool);
  vtkGetMacro(Overwrite, bool);
  vtkBooleanMacro(Overwrite, bool);
  ///@}

  ///@{
  /** Edge of a pixel [m]. 0: what the file says. */
  vtkSetMacro(PixelSize, double);
  vtkGetMacro(PixelSize, double);
  ///@}

  ///@{
  /** Of a raw volume: voxels along x, y, z. 0: what its name or its notes say. */
  vtkSetVector3Macro(RawSize, int);
  vtkGetVector3Macro(RawSize, int);
  /** Of a raw volume: type of its numbers, as of NumberType. None: what its name or its notes say. */
  void SetRawType(const std::string& type) { this->Put(this->RawType, type); }
  const std::string& GetRawType() const { return this->RawType; }
  /** Of a raw volume: little or big, the order of bytes. None: what its name or its notes say. */
  void SetRawOrder(const std::string& order) { this->Put(this->RawOrder, order); }
  const std::string& GetRawOrder() const { return this->RawOrder; }
  /** Of a raw volume: bytes before the first voxel. */
  vtkSetClampMacro(RawHeader, vtkIdType, 0, VTK_ID_MAX);
  vtkGetMacro(RawHeader, vtkIdType);
  ///@}

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
  vtkFileConverter(const vtkFileConverter&) = delete;
  void operator=(const vtkFileConverter&) = delete;

  void Put(std::string& word, const std::string& value);
  void Convert();

  std::string FileName;
  std::string OutputFileName;
  std::string NumberType;
  std::string Range;
  std::string RawType;
  std::string RawOrder;
  std::vector<std::string> Arrays;
  std::vector<std::string> Phases;
  int Smoothing = 0;
  int Step = -1;
  bool Lossy = false;
  bool Overwrite = false;
  double PixelSize = 0;
  int RawSize[3] = { 0, 0, 0 };
  vtkIdType RawHeader = 0;
  int NumberOfSteps = 0;
  vtkSmartPointer<vtkDataObject> Input;
  vtkSmartPointer<vtkDataObject> Output;
  vtkSmartPointer<vtkStringArray> Files;
  vtkSmartPointer<vtkDoubleArray> Times;
  vtkSmartPointer<vtkStringArray> Warnings;
};

#endif
