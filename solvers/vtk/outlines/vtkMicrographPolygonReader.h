/**
 * @class   vtkMicrographPolygonReader
 * @brief   outlines of lumens from a file of polygons
 *
 * Reads JSON lists of points, packed by gzip or not, in the kinds that outlines/PolygonFile.h tells, and the `.vtp`
 * of outlines that vtkMicrographContours and this class make.
 *
 * **Output 0**: the lumens' outlines, as vtkMicrographContours gives them, clipped to the picture; its lower left
 * corner is the origin.
 *
 * **Output 1**: outlines of the cells, outside their walls, where the file has them; else empty. They may touch and
 * cross each other; `lumen` numbers them, and is no lumen's number.
 *
 * On several ranks the first one has all outlines.
 *
 * @sa vtkMicrographContours vtkMicrographLattice
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSetting.h"

class VTKLAMELLASOLVERSVTK_EXPORT vtkMicrographPolygonReader : public vtkPolyDataAlgorithm
{
public:
  static vtkMicrographPolygonReader* New();
  vtkTypeMacro(vtkMicrographPolygonReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The polygons, .json or .json.gz, or outlines in a .vtp that Lamella wrote.
   * @files Outlines (*)
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * One unit of the file's coordinates in metres: 1e-6 for micrometres. 0: what the file says.
   * @group Polygons
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(Unit, double, 0);

  ///@{
  /**
   * What of the file is the picture: low x, low y, high x, high y in the file's coordinates. All 0: the box around all
   * of its points, or what the file says; a window is a part of that.
   * @columns low x, low y, high x, high y
   */
  vtkSetVector4Macro(Window, double);
  vtkGetVector4Macro(Window, double);
  ///@}

  /**
   * The file's y points down, as rows of a picture do.
   * @word y-down
   * @group Polygons
   */
  vtkSwitchMacro(YDown, false);

  ///@{
  /** As vtkMicrographContours. */
  vtkSettingMacro(LeastDiameter, double, 0);
  vtkSettingMacro(LeastSolidity, double, 0);
  ///@}

  /** The cells' outlines, output 1; without lines where the file has none. */
  vtkPolyData* GetCells();

protected:
  vtkMicrographPolygonReader();
  ~vtkMicrographPolygonReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  bool HasWindow() const;
  void Read(vtkPolyData* lumens, vtkPolyData* cells);
  void Crop(vtkPolyData* lumens);
  void Filter(vtkPolyData* lumens);

  char* FileName = nullptr;
  double Window[4] = { 0, 0, 0, 0 };
};
