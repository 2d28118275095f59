/**
 * @class   vtkPoreFloodFill
 * @brief   the pores of an image: which nodes of a phase hang together, how large they are, where, and how many
 *
 * **Input**: vtkImageData with phases at its points: an array of whole numbers, `phase` unless another is chosen with
 * SetInputArrayToProcess(0, ...). An image of one layer along z is two-dimensional.
 *
 * **Output 0**: the input with `pore` (int: 1 to the number of pores, 0 outside) and, if ComputePoreSize is on,
 * `pore_size` (float: size of the node's pore in nodes, NaN outside; exact up to 2^24).
 *
 * **Output 1**: vtkTable, one row a pore in the order of the labels: `pore`, `size` [nodes], `area` [m²] or `volume`
 * [m³], `equivalent_diameter` [m] (of the circle or sphere of that size), `centre_x`, `_y`, `_z` [m] (the mean of its
 * nodes), `x_first`, `x_last`, ... (box, in nodes from the image's first one), `touches_x_min`, `touches_x_max`, ...
 * (1: it has a node in the first, the last layer), `percolates_x`, ... (1: it leads from the first layer to the last;
 * along a periodic axis, it meets itself again). Axes are those of the data: of a picture, y points up.
 *
 * **Output 2**: vtkTable, how sizes are distributed, in classes that each reach twice as far as the one before:
 * `size_from`, `size_to` [nodes], `diameter_from`, `diameter_to` [m], `pores`, `nodes`, `share_of_pores`,
 * `share_of_nodes` and both summed up from the smallest on, `cumulative_share_of_pores`, `cumulative_share_of_nodes`.
 *
 * **Field data** of all outputs: `pore_count`, `pore_total` [nodes], `pore_mean`, `pore_largest`, `porosity` (share of
 * the phase, dropped pores included), `pore_dropped` (number and nodes of those below MinimumSize), `pore_open` and
 * `pore_closed` (shares of pore_total; open: touches a border that is not periodic, or percolates),
 * `pore_percolates` (3 numbers), `pore_connectivity`, `pore_periodic` (3), `pore_phase` (string).
 *
 * Where EstimateWindowError is on and the image can be cut also `window_of`: `porosity`, `pore_density` [1/m², 1/m³],
 * `pore_mean` [nodes], and in their order `window_errors`, how far the material's value may be from the image's (95 %),
 * relative; `window_value`, `window_low`, `window_high`, `window_deviation`, `window_bias`, `window_freedom`,
 * `window_gradient` (axis along which the image changes, NaN: none) and `window_layered` (statistics/WindowError.h).
 *
 * **Periodic axes**: a pore that goes on at the other end is one pore and is put together for its centre and box: the
 * centre lies in the image, the box may end beyond it. What percolates along an axis has no end there; its centre is
 * the mean of the places in the image and its box is the whole axis.
 *
 * **Parallel**: right on distributed images, with whatever pieces, shared points and ghost layers: every node counts
 * once, and labels depend neither on ranks nor on threads (vtkSMPTools). Rank 0 holds the tables; those of the other
 * ranks are empty.
 *
 * @warning An image without a node of the phase is an error, and so is one with more pores than labels. A minimum size
 * that leaves no pore is a warning.
 */

#pragma once

#include "vtkImageAlgorithm.h"
#include "vtkLamellaFiltersModule.h"   // for export macro
#include "vtkMultiProcessController.h" // for the smart pointer
#include "vtkSetting.h"
#include "vtkSmartPointer.h"

#include <string> // for the phase

class vtkTable;

class VTKLAMELLAFILTERS_EXPORT vtkPoreFloodFill : public vtkImageAlgorithm
{
public:
  static vtkPoreFloodFill* New();
  vtkTypeMacro(vtkPoreFloodFill, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The phase whose pores are wanted: its name, or its number where phases have no names. Empty: the first that is
   * called void, pore, lumen or air.
   */
  vtkSettingMacro(Phase, std::string, "");

  /**
   * Over what nodes hang together: 4 or 8 neighbours in a picture, 6, 18 or 26 in a volume.
   * @values 0 = Sides or faces (4 or 6); 4 = 4 (picture: sides); 8 = 8 (picture: and corners); 6 = 6 (volume: faces);
   * 18 = 18 (volume: and edges); 26 = 26 (volume: and corners)
   */
  vtkSettingMacro(Connectivity, int, 0);

  /**
   * Along x, y, z: 1 where the image goes on at its other end.
   * @columns x, y, z
   * @range [0, 1]
   */
  vtkSettingVector3Macro(Periodic, int, 0, 0, 0);

  /**
   * Pores of fewer pixels or voxels get no label and no row in the table.
   * @range [0, inf)
   */
  vtkSettingMacro(MinimumSize, int, 1);

  /**
   * Label 1 is the largest pore; otherwise pores are numbered in the order of memory.
   * @off no-sort-by-size: Number pores in the order of memory, not by size.
   */
  vtkSwitchMacro(SortBySize, true);

  /**
   * Whether the image carries `pore`, and `pore_size` with it. Off, pores are counted and measured only.
   */
  vtkSwitchMacro(ComputeLabels, true);

  /**
   * Also give each node the size of its pore (`pore_size`), to colour by (on a log scale).
   * @advanced
   * @off no-pore-size: Do not give each node the size of its pore.
   */
  vtkSwitchMacro(ComputePoreSize, true);

  /**
   * Also count the pores of the windows that the image is cut into, halves and thirds of it along each axis, and tell
   * how far it speaks for the material that it was cut out of: intervals that hold the material's porosity, pores per
   * area or volume, and their mean size with a probability of 95 %.
   * @word window-error
   * @advanced
   */
  vtkSwitchMacro(EstimateWindowError, false);

  /**
   * More pores are an error. What 32 bits hold, the default, is the most that there can be.
   * @range [1, inf)
   */
  vtkSettingMacro(MaximumNumberOfLabels, int, 2147483647);

  /** The tables, outputs 1 and 2. */
  vtkTable* GetPores();
  vtkTable* GetSizeDistribution();

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkPoreFloodFill();
  ~vtkPoreFloodFill() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Work;

  vtkSmartPointer<vtkMultiProcessController> Controller = vtkMultiProcessController::GetGlobalController();
};
