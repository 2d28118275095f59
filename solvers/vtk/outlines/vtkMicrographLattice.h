/**
 * @class   vtkMicrographLattice
 * @brief   a lattice of phases from outlines of lumens
 *
 * Puts outlines on a lattice of any spacing, finds along which way the walls run and to which cell they belong, and on
 * demand the middle lamella in them (outlines/ContourLattice.h, WallDirection.h, MiddleLamella.h).
 *
 * **Input**: outlines, as vtkMicrographContours and vtkMicrographPolygonReader give them; or any closed poly-lines or
 * polygons in a plane of z. Second input, for a middle lamella from labels alone: the picture that they were found in.
 *
 * **Output**: vtkImageData over the picture, with the point arrays
 * - `phase`: 0 lumen, 1 wall, 2 middle lamella;
 * - `grain`: number of the cell: the lumen, and in the wall the nearest lumen;
 * - `axis`: 3 floats, unit vector along the wall whose sign means nothing; 0 in lumens;
 * - `lumen_share`: lumen's exact share of the node's pixel.
 *
 * Field data: `phase_names`, `lumen_fraction` and `wall_fraction` (of the geometry), `cropped` [m], `wall_thickness`
 * (2: that 5 % of the outlines' length falls below; median) [m]; with a middle lamella `lamella_thickness` and
 * `lamella_radius` [m] as used, `lamella_share` (of the wall's nodes), `lamella_nodes_across` (2: mean; 5 % have
 * fewer), `lamella_joined`, `lamella_networks`, `lamella_largest_network`, `cells`, `cells_touched`,
 * `cells_cut_off`;
 * `pixel_size_source`, `provenance`.
 *
 * The image's size follows from the outlines, so the input is brought up to date when information is asked for. On
 * several ranks each computes the whole.
 *
 * @sa vtkMicrographContours vtkMicrographPolygonReader vtkSteadyDiffusion
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkOutlineAlgorithm.h"
#include "vtkSmartPointer.h" // for the image that is kept

class vtkPolyData;

class VTKLAMELLASOLVERSVTK_EXPORT vtkMicrographLattice : public vtkOutlineAlgorithm
{
public:
  static vtkMicrographLattice* New();
  vtkTypeMacro(vtkMicrographLattice, vtkOutlineAlgorithm);

  vtkImageData* GetOutput();

  /**
   * Distance of the nodes in metres; it changes a little so that a whole number fits the picture's width. 0: the
   * picture's pixel, of outlines that are from no picture a quarter of the walls' median thickness.
   * @group Lattice
   * @unit m
   * @range [0, inf)
   */
  vtkSettingMacro(Spacing, double, 0);

  /**
   * Nodes that a solver wants across the middle lamella: fewer are warned of.
   * @group Middle Lamella
   * @range [0, inf)
   * @when Lamella GROWTH CONSTANT LABELS
   */
  vtkSettingMacro(Horizon, double, 0);

protected:
  vtkMicrographLattice();
  ~vtkMicrographLattice() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  /// Makes Image, unless it is up to date; says what is wrong.
  bool Rasterise(vtkPolyData* outlines, vtkImageData* picture);
  vtkSmartPointer<vtkImageData> Made(vtkPolyData* outlines, vtkImageData* picture);

  vtkSmartPointer<vtkImageData> Image; ///< what was made
  vtkTimeStamp MadeTime;
};
