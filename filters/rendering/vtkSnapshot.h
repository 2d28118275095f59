#pragma once

#include "vtkLamellaRenderingModule.h" // for the export macro
#include "vtkObject.h"
#include "vtkSetting.h"

#include <memory> // for the options
#include <string> // for messages

class vtkDataObject;
class vtkImageData;
class vtkPolyData;

/**
 * @class vtkSnapshot
 * @brief Draws a picture fit for a paper of a lattice and its fields, with no display needed
 *
 * Give it a vtkImageData (a picture, nz = 1, or a volume) or a vtkPolyData, choose what to draw with a preset, and
 * Write() a PNG. Around the data, and never over them, stand a scale bar (in micrometres, or in pixels where the field
 * data say `pixel_size_source` = "none"), a legend with the quantity's name and unit, and a title if there is one.
 * Projection is parallel and the aspect of the data is kept.
 *
 * | preset          | array           | how it is drawn |
 * |-----------------|-----------------|--------------------------------------------------------------------------------|
 * | `phase`         | `phase`         | one colour a phase, exact; names from the field data `phase_names` | |
 * `temperature`   | `temperature`   | inferno, 0 to 1; the border between void and solid as a thin line              |
 * | `concentration` | `concentration` | viridis, the same | | `flux`          | `flux`          | magnitude over the
 * mean flux, with lines that carry equal shares of the flow   | | `grain`         | `grain`         | one colour a
 * grain, neighbours apart                                           | | `pores`         | `pore_size`     | viridis on
 * a logarithmic scale; what is no pore is grey                        | | `stress`        | `stress`        | the
 * component along the load over the stress on the platen, blue 0 to red; voids grey | | `scalar`        | any |
 * viridis; coolwarm where values lie on both sides of zero                       | | `auto`          | any | by the
 * array's name                                                            |
 *
 * Where several directions were solved, the arrays' names end in _x, _y, _z: a preset draws the first there is, and
 * SetArrayName() another.
 *
 * Pixels of the data are shown as they are, never interpolated; where the picture has fewer pixels than the data,
 * colours are averaged over each pixel's area. NaN (a phase that does not conduct) is grey. Volumes are drawn in
 * isometric view: `phase` as the surface of all that is not void, other fields on the faces of the box with one octant
 * cut out.
 *
 * Points with the array `radius` (grains of a packing) are drawn as disks or spheres, in their box where the field data
 * tell one. The packing's contacts, given with SetOverlayLines(), are drawn on the disks as bars as wide as their
 * `normal_force`; the disks are then plain unless an array is named. Spheres are left out: they would hide the forces.
 *
 * Drawing is done by vtkOffScreenWindows' OpenGL; pictures of pixels with no lines on them need none.
 *
 * An error is reported with vtkErrorMacro (an observer of vtkCommand::ErrorEvent silences it), and GetErrorMessage()
 * and GetErrorHint() say what is wrong and what to do about it.
 */
class VTKLAMELLARENDERING_EXPORT vtkSnapshot : public vtkObject
{
public:
  static vtkSnapshot* New();
  vtkTypeMacro(vtkSnapshot, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * What is drawn: vtkImageData with point data, or vtkPolyData with point or cell data. Held, not copied.
   */
  void SetInputData(vtkDataObject* data);
  vtkDataObject* GetInputData();

  enum Presets
  {
    AUTO = 0,
    PHASE,
    TEMPERATURE,
    CONCENTRATION,
    FLUX,
    GRAIN,
    PORES,
    STRESS,
    SCALAR
  };
  ///@{
  /**
   * What kind of field it is; auto goes by the name of the array.
   *
   * SetPresetByName() takes the names of the table above and returns false for others.
   * @group Drawing
   * @choice Presets
   */
  vtkSettingMacro(Preset, int, AUTO);
  bool SetPresetByName(const char* name);
  static const char* GetPresetName(int preset);
  ///@}

  ///@{
  /**
   * Array to draw. Empty: the preset's own; with auto the first there is of stress, flux, temperature,
   * concentration, displacement, pore_size, phase, grain, event, else the first array of numbers, or of vectors.
   * @word array
   * @group Drawing
   */
  void SetArrayName(const char* name);
  const char* GetArrayName();
  ///@}

  /**
   * Component of an array that has several: 0, 1, 2 ...; -1: the magnitude; of a stress the component
   * along the load.
   * @group Drawing
   * @names -1 = magnitude; 0 = x; 1 = y; 2 = z
   * @range [-1, 1000]
   */
  vtkSettingMacro(Component, int, -1);

  ///@{
  /**
   * Values at the ends of the colour map, minimum < maximum, both finite; in the numbers that the legend shows.
   * Where none is set: from the data (flux: 0 to a round number that 99.5 % of the pixels do not exceed). Fix it for a
   * series.
   * @word range, value_range
   * @group Drawing
   * @columns minimum, maximum
   */
  void SetRange(double minimum, double maximum);
  void ResetRange();
  bool GetRangeIsSet();
  ///@}

  ///@{
  /**
   * Colour map. Empty: the preset's.
   * @words viridis inferno magma cividis gray coolwarm blue-red
   * @group Drawing
   */
  void SetColorMap(const char* name);
  const char* GetColorMap();
  ///@}

  ///@{
  /**
   * Colour of a phase instead of the one its name or id gives it.
   * @group Drawing
   * @word phase-color
   * @columns Phase, red, green, blue
   * @colour
   */
  void SetPhaseColor(const char* phase, double red, double green, double blue);
  void ClearPhaseColors();
  ///@}

  /**
   * Flux over its mean in the box and stress over that on the platen, which have no unit; else as they are.
   * @off absolute-flux: The flux or stress itself, not over its mean.
   * @group Drawing
   */
  vtkSwitchMacro(RelativeFlux, true);

  enum Overlays
  {
    AUTO_OVERLAY = 0, ///< lines for the preset flux, else none
    NO_OVERLAY,
    LINES_OVERLAY,   ///< lines along the flux: equal shares of the flow, or evenly spaced where the flux has sources
    ARROWS_OVERLAY,  ///< one arrow a block: the mean flux of the block
    ISOLINES_OVERLAY ///< lines of equal value
  };
  ///@{
  /**
   * What is drawn on top of the colours; auto: lines for the flux, else nothing.
   *
   * By name: auto, none, lines, arrows, isolines; false for others.
   * @group Drawing
   * @choice Overlays
   */
  vtkSettingMacro(Overlay, int, AUTO_OVERLAY);
  bool SetOverlayByName(const char* name);
  ///@}

  /**
   * How many lines, or arrows along the longer side. 0: as many as look well.
   * @group Drawing
   * @range [0, 500]
   */
  vtkSettingMacro(OverlayCount, int, 0);

  ///@{
  /**
   * Vector array that lines and arrows follow. Empty: the array drawn if it is a vector, else `flux`.
   * @word overlay-array
   * @group Drawing
   */
  void SetOverlayArrayName(const char* name);
  const char* GetOverlayArrayName();
  ///@}

  ///@{
  /**
   * Computed elsewhere, in the coordinates of the data: streamlines, drawn instead of our own; on grains their
   * contacts; in a volume's phases lines, surfaces and points, as the cracks of vtkCrackPath and broken bonds, coloured
   * by their array `event` if they have one.
   */
  void SetOverlayLines(vtkPolyData* lines);
  vtkPolyData* GetOverlayLines();
  ///@}

  /**
   * The border between void and solid (phases by their names; without such a name, phase 0 is the void) as a thin line.
   * Not for phases and grains, which show it anyway.
   * @word outline
   * @off no-outline: Leave out the thin line between void and solid.
   * @group Drawing
   */
  vtkSwitchMacro(ShowOutline, true);

  /**
   * Width and height of the whole picture in pixels. 0, 0: follows from the data, with a whole number of picture pixels
   * for each of theirs.
   * @group Page
   * @columns width, height
   * @range [64, 16384]
   * @unset 0
   */
  vtkSettingVector2Macro(Size, int, 0, 0);

  /**
   * Size of all text, relative.
   * @group Page
   * @range [0.2, 5]
   */
  vtkSettingMacro(FontScale, double, 1);

  /**
   * Background. Text is dark on light and light on dark backgrounds.
   * @group Page
   * @columns red, green, blue
   * @colour
   * @range [0, 1]
   */
  vtkSettingVector3Macro(Background, double, 1, 1, 1);

  /**
   * Leave the background out, so that the picture can be laid on anything.
   * @group Page
   */
  vtkSwitchMacro(Transparent, false);

  ///@{
  /**
   * A line above the data. Empty: none.
   * @group Page
   */
  void SetTitle(const char* title);
  const char* GetTitle();
  ///@}

  ///@{
  /**
   * Name of the quantity in the legend. Empty: from the array's name.
   * @group Page
   */
  void SetLegendTitle(const char* title);
  const char* GetLegendTitle();
  /**
   * Unit in the legend. Empty: from the array's information (vtkDataArray::UNITS_LABEL()).
   * @group Page
   */
  void SetUnit(const char* unit);
  const char* GetUnit();
  ///@}

  /**
   * Legend and colour bar.
   * @word legend
   * @off no-legend: Leave out the legend.
   * @group Page
   */
  vtkSwitchMacro(ShowLegend, true);
  /**
   * Scale bar.
   * @word scale-bar
   * @off no-scale-bar: Leave out the scale bar.
   * @group Page
   */
  vtkSwitchMacro(ShowScaleBar, true);

  /**
   * Volumes and surfaces: where they are looked at from, around z from the x axis towards y.
   * @group Page
   * @unit degrees
   */
  vtkSettingMacro(Azimuth, double, -60);
  /**
   * Volumes and surfaces: where they are looked at from, above the xy plane.
   * @group Page
   * @unit degrees
   * @range [-90, 90]
   */
  vtkSettingMacro(Elevation, double, 30);

  /**
   * Volumes: draw only voxels whose value lies in the range, which must be given, instead of a block with an octant cut
   * away: what lies scattered inside, as damage from 0.3 to 1.
   * @group Drawing
   */
  vtkSwitchMacro(OnlyRange, false);

  /**
   * Volumes: of cracks or broken bonds inside only those up to this event: one picture of a film. 0: all.
   * @group Drawing
   * @range [0, inf]
   */
  vtkSettingMacro(UntilEvent, int, 0);

  /**
   * Volumes: opacity of the surface of the preset phase. Make it small where lines or cracks inside are to be seen.
   * @group Page
   * @range [0, 1]
   */
  vtkSettingMacro(Opacity, double, 1);

  /**
   * Write() may replace a file.
   */
  vtkSwitchMacro(Overwrite, false);

  ///@{
  /**
   * Written into the PNG as a text chunk `provenance`. Empty: the string `provenance` of the data's field data.
   */
  void SetProvenance(const char* provenance);
  const char* GetProvenance();
  ///@}

  /**
   * Draws and writes a PNG: the file is there whole or not at all.
   * @returns false on an error (see GetErrorMessage())
   */
  bool Write(const char* path);

  /**
   * Draws into memory: RGB, or RGBA with Transparent. Null on an error. The picture is kept until the next drawing.
   */
  vtkImageData* Draw();

  ///@{
  /**
   * The last error in one line, and what to do about it; empty when all went well.
   */
  const char* GetErrorMessage();
  const char* GetErrorHint();
  ///@}

  ///@{
  /**
   * Of the last picture: where the data are, in pixels from the lower left corner (x, y, width, height), and the values
   * at the ends of the colour map.
   */
  vtkGetVector4Macro(DataRectangle, int);
  vtkGetVector2Macro(DrawnRange, double);
  ///@}

protected:
  vtkSnapshot();
  ~vtkSnapshot() override;

private:
  bool Fail(const std::string& message, const std::string& hint);

  int DataRectangle[4] = { 0, 0, 0, 0 };
  double DrawnRange[2] = { 0, 0 };

  struct Internals;
  std::unique_ptr<Internals> Private;
};
