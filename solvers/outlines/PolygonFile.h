#pragma once

#include "outlines/Contour.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

struct PolygonReadOptions
{
  /// One unit of the file's coordinates [m]; else what the file says.
  std::optional<double> unit;
  /// What of the file is the picture: low x, low y, high x, high y, in the file's coordinates. Else the box around all
  /// of its points (with a `size` in the file: that, of which a window must be a part). Polygons that its border cuts
  /// become open contours.
  std::optional<std::array<double, 4>> window;
  /// The file's y points down, as rows of a picture do.
  bool yDown = false;
};

struct PolygonFile
{
  ContourSet lumens;
  /// Outlines of cells, outside their walls, clipped to the same picture; contour for contour no lumen's partner. Each
  /// by itself is sound (validate() of it alone finds nothing; one that is not is left out with a warning), but they
  /// may touch and cross each other. One that goes around the whole picture is not in it. Nothing: the file has none.
  std::optional<ContourSet> cells;
  Point origin{ 0, 0 }; ///< the picture's lower left corner in the file's coordinates [m]
  double unit = 0;      ///< as used [m]
  std::vector<std::string> warnings;
};

/// Reads a JSON file of polygons, packed by gzip or not. Four kinds are taken:
/// - `{"units": …, "cells": [{"lumen": [[x, y], …], "outer": [[x, y], …]}, …], "outer": …}`, the last two or not;
/// - `{"units": …, "lumens": [[[x, y], …], …]}`;
/// - `[[[x, y], …], …]`, a plain list of lumens: the unit must be given;
/// - what writePolygons() writes.
///
/// Units: "metre", "millimetre", "micrometre", "nanometre", or m, mm, um, µm, nm; -meter and plurals too. A first point
/// that is repeated at the end goes, and so do points repeated in a row; a ring that is open by more than its longest
/// side is closed with a warning; clockwise rings are turned; what has no area is left out with a warning.
/// @throws InputError for a file that cannot be read (no JSON, damaged gzip, more than 1 GiB unpacked), that holds
///   other things than the kinds above, with too few points, no finite numbers or coordinates beyond 1 m from each
///   other, without unit; with lumens that cross themselves or each other, or lie in another; with no lumen in the
///   window; ParameterError for a unit or window outside their range
[[nodiscard]] PolygonFile readPolygons(const std::filesystem::path& path, const PolygonReadOptions& options = {});

/// Writes contours so that readPolygons() gives them back, bit for bit; packed by gzip if the name ends in .gz.
/// @param cells outlines of cells of the same picture, or null
/// @throws InputError when the file cannot be written
void writePolygons(const ContourSet& lumens, const std::filesystem::path& path, const ContourSet* cells = nullptr);

} // namespace lamella::micrograph
