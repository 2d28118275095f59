/**
 * @class   vtkPackingReader
 * @brief   packings of others, from a table of centres and radii
 *
 * Reads text with a line of names and one line a grain: the columns x, z, r (or x, y, r) of disks, or x, y, z, r of
 * spheres, in any order, among others; d or diameter instead of r. Commas, semicolons, tabs or blanks separate them.
 * Also reads the `.vtp` of particles that vtkGrainPacking and this class make.
 *
 * **Output 0**: the grains, as vtkGrainPacking gives them. Disks lie in the plane z = 0, with what the table calls z
 * (or y) along y.
 *
 * **Output 1**: a line for each contact: grains that overlap, or that are nearer to each other or to a wall than 1e-3
 * of their mean diameter. A table tells no forces, so they are 0. It is empty for a `.vtp`: the contacts are in a file
 * of their own.
 *
 * @sa vtkGrainPacking vtkMatrixBridges
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSetting.h"

class VTKLAMELLASOLVERSVTK_EXPORT vtkPackingReader : public vtkPolyDataAlgorithm
{
public:
  static vtkPackingReader* New();
  vtkTypeMacro(vtkPackingReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The table: .csv, .txt or .dat, separated by commas, semicolons, tabs or blanks. Or grains in a .vtp that Lamella
   * wrote.
   * @files Tables of grains (*)
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * Length of a table's unit in metres, as 1e-3 for millimetres.
   * @word unit
   * @group Table
   * @unit m
   * @range (0, inf)
   */
  vtkSettingMacro(LengthUnit, double, 1);

  /**
   * Edges of a table's box in metres, from the origin, two of disks. All 0: the box that just holds the grains, which
   * are moved so that it begins at the origin.
   * @word box
   * @group Table
   * @columns x [m], y [m], z [m]
   * @rest 0
   * @range [0, inf)
   */
  vtkSettingVector3Macro(BoxSize, double, 0, 0, 0);

  /** The contacts, output 1. */
  vtkPolyData* GetContacts();

protected:
  vtkPackingReader();
  ~vtkPackingReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  void Read(vtkPolyData* particles, vtkPolyData* contacts);

  char* FileName = nullptr;
};
