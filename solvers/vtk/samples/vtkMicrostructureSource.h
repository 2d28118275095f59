/**
 * @class   vtkMicrostructureSource
 * @brief   seeded samples whose geometry is known
 *
 * Softwood and hardwood tissue, honeycomb, checkerboard, arrays of disks or spheres, laminates, on a lattice of any
 * size: what solvers/generators makes, as vtkImageData with the array `phase` (unsigned char) at points; field data
 * `phase_names`, `pixel_size_source` ("generated") and `provenance`. The same settings and seed give the same bytes
 * everywhere. Tissue can be drawn as a microscope would show it, too: the array `micrograph` (unsigned char), with
 * three components where it is stained, beside the phases, which are its truth.
 *
 * Phases are `lumen` and `wall` for softwood, hardwood and honeycomb, `matrix` and `inclusion` for the others, as ids 0
 * and 1.
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSetting.h"
#include "vtkSmartPointer.h" // for the image that is kept

namespace lamella
{
struct PhaseImage;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkMicrostructureSource : public vtkImageAlgorithm
{
public:
  static vtkMicrostructureSource* New();
  vtkTypeMacro(vtkMicrostructureSource, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Kinds
  {
    SOFTWOOD = 0,
    HONEYCOMB = 1,
    CHECKERBOARD = 2,
    INCLUSIONS = 3, ///< "Disks or spheres": disks in two dimensions, spheres in three
    LAMINATE = 4,   ///< "Layers"
    HARDWOOD = 5    ///< "Hardwood": two dimensions alone
  };
  /**
   * What to make.
   * @group Sample
   * @choice Kinds
   */
  vtkSettingMacro(Kind, int, SOFTWOOD);

  /**
   * Nodes along x, y and z. One along z: a two-dimensional sample.
   * @group Sample
   * @columns x, y, z
   * @rest 1
   * @range [1, inf)
   */
  vtkSettingVector3Macro(Size, int, 200, 200, 1);

  /**
   * Distance of neighbouring nodes in metres.
   * @word pixel-size, spacing
   * @group Sample
   * @unit m
   * @range (0, inf)
   */
  vtkSettingMacro(Spacing, double, 1e-6);

  /**
   * Share of the walls (softwood, hardwood, honeycomb) or of the inclusions (disks, spheres, laminate), between 0 and
   * 1. A checkerboard has one half.
   * @group Sample
   * @when Kind SOFTWOOD HONEYCOMB INCLUSIONS LAMINATE HARDWOOD
   * @range (0, 1)
   */
  vtkSettingMacro(SolidFraction, double, 0.4);

  /**
   * Another seed gives another sample of the same kind.
   * @group Tissue
   * @range [0, inf)
   * @when Kind SOFTWOOD HARDWOOD
   */
  vtkSettingMacro(Seed, vtkIdType, 1);

  /**
   * Mean tracheid diameter across the radial files, along y, in metres.
   * @group Softwood
   * @unit m
   * @advanced
   * @range (0, inf)
   * @when Kind SOFTWOOD
   */
  vtkSettingMacro(TangentialDiameter, double, 30e-6);

  /**
   * Mean tracheid diameter along the radial files, along x, in metres: in earlywood and in latewood.
   * @group Softwood
   * @columns early [m], late [m]
   * @rest same
   * @advanced
   * @range (0, inf)
   * @when Kind SOFTWOOD
   */
  vtkSettingVector2Macro(RadialDiameter, double, 36e-6, 15e-6);

  /**
   * Place in the annual ring of the left and of the right edge: 0 earlywood, 1 latewood.
   * @group Tissue
   * @columns left, right
   * @rest same
   * @range [0, 1]
   * @when Kind SOFTWOOD HARDWOOD
   */
  vtkSettingVector2Macro(RingPosition, double, 0, 0.0);

  /**
   * Mean distance between rays in metres. 0: no rays.
   * @group Softwood
   * @unit m
   * @range [0, inf)
   * @advanced
   * @when Kind SOFTWOOD
   */
  vtkSettingMacro(RayDistance, double, 240e-6);

  /**
   * Three dimensions: mean length of a tracheid along z in metres. Tracheids are closed at both ends.
   * @group Softwood
   * @unit m
   * @advanced
   * @range (0, inf)
   * @when Kind SOFTWOOD
   */
  vtkSettingMacro(TracheidLength, double, 200e-6);

  /**
   * Relative standard deviation of the diameters of tracheids or fibres.
   * @group Tissue
   * @range [0, 0.5]
   * @advanced
   * @when Kind SOFTWOOD HARDWOOD
   */
  vtkSettingMacro(Scatter, double, 0.12);

  /**
   * Mean diameter of a fibre, between the middles of its walls, in metres.
   * @group Hardwood
   * @unit m
   * @advanced
   * @range (0, inf)
   * @when Kind HARDWOOD
   */
  vtkSettingMacro(FibreDiameter, double, 16e-6);

  /**
   * Mean tangential diameter of the vessels in metres: at the start and at the end of the ring.
   * @group Hardwood
   * @columns start [m], end [m]
   * @rest same
   * @range (0, inf)
   * @when Kind HARDWOOD
   */
  vtkSettingVector2Macro(VesselDiameter, double, 64e-6, 40e-6);

  /**
   * Share of the picture in vessels, out to the middle of their walls: at the start and at the end of the ring.
   * @group Hardwood
   * @columns start, end
   * @rest same
   * @range [0, 0.5]
   * @when Kind HARDWOOD
   */
  vtkSettingVector2Macro(VesselShare, double, 0.32, 0.15);

  /**
   * Place in the ring where late vessels begin. Ring-porous wood has about 0.25.
   * @group Hardwood
   * @range [0, 1]
   * @advanced
   * @when Kind HARDWOOD
   */
  vtkSettingMacro(EarlyEnd, double, 0.6);

  /**
   * Share of the groups of vessels that are radial files of two to four.
   * @group Hardwood
   * @range [0, 1]
   * @advanced
   * @when Kind HARDWOOD
   */
  vtkSettingMacro(Multiples, double, 0.45);

  /**
   * Mean distance between rays in metres. 0: no rays.
   * @word ray-distance
   * @group Hardwood
   * @unit m
   * @range [0, inf)
   * @advanced
   * @when Kind HARDWOOD
   */
  vtkSettingMacro(HardwoodRayDistance, double, 95e-6);

  /**
   * Cells along x (honeycomb), along each axis (checkerboard, disks, spheres), or pairs of layers.
   * @group Sample
   * @when Kind HONEYCOMB CHECKERBOARD INCLUSIONS LAMINATE
   * @range [1, inf)
   */
  vtkSettingMacro(Cells, int, 4);

  enum LayerAxes
  {
    X = 0,
    Y = 1,
    Z = 2
  };
  /**
   * The axis across the layers.
   * @group Sample
   * @choice LayerAxes
   * @when Kind LAMINATE
   */
  vtkSettingMacro(Axis, int, X);

  enum Looks
  {
    LABELS = 0,  ///< not at all, phases alone
    MAGENTA = 1, ///< safranin in transmitted light
    BLUE = 2,    ///< astra blue in transmitted light
    GREY = 3     ///< an electron micrograph with bright walls
  };
  /**
   * How tissue is drawn as a micrograph, of two dimensions.
   * @group Micrograph
   * @when Kind SOFTWOOD HARDWOOD
   * @choice Looks
   */
  vtkSettingMacro(Look, int, LABELS);

  /**
   * Standard deviation of the optics' point spread. 0: none.
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(Blur, double, 0.5e-6);

  /**
   * Standard deviation of the noise in a bright place over full scale, half from the light, half from the camera.
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @range [0, 0.5]
   */
  vtkSettingMacro(Noise, double, 0.02);

  /**
   * How much darker the darkest corner is than the brightest place.
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @range [0, 0.95]
   */
  vtkSettingMacro(UnevenLight, double, 0.2);

  /**
   * Specks of dirt a square millimetre, 3 to 12 µm wide.
   * @unit 1/mm²
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @range [0, 10000]
   */
  vtkSettingMacro(Dirt, double, 4);

  /**
   * Torn places a square millimetre: short cracks in the picture. The phases stay whole.
   * @unit 1/mm²
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @range [0, 10000]
   */
  vtkSettingMacro(Tears, double, 0);

  /**
   * Depth of a dark fringe 0.6 µm wide on both sides of the lumens' edges, as of walls out of focus: a share of the
   * stain of a wall. 0.4 is faint.
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @range [0, 3]
   */
  vtkSettingMacro(Rim, double, 0);

  /**
   * Length of a bar in the lower right corner, with its length as text. 0: none.
   * @group Micrograph
   * @when Look MAGENTA BLUE GREY
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(ScaleBar, double, 0);

protected:
  vtkMicrostructureSource();
  ~vtkMicrostructureSource() override = default;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  lamella::PhaseImage Tissue(int n);
  lamella::PhaseImage Sample();
  void Generate();

  vtkSmartPointer<vtkImageData> Image; ///< what was made
  vtkTimeStamp MadeTime;
};
