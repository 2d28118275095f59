#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

class vtkPolyData;

namespace lamella::rendering
{

/// vtkSnapshot's settings, as its helpers see them; its header says what each means.
struct SnapshotOptions
{
  int preset = 0;
  std::string arrayName;
  int component = -1;
  std::optional<std::array<double, 2>> range;
  std::string colorMap;
  std::map<std::string, std::array<double, 3>> phaseColors;
  bool relativeFlux = true;
  int overlay = 0;
  int overlayCount = 0;
  std::string overlayArrayName;
  vtkPolyData* overlayLines = nullptr;
  bool showOutline = true;
  std::array<int, 2> size{ 0, 0 };
  double fontScale = 1;
  std::array<double, 3> background{ 1, 1, 1 };
  bool transparent = false;
  std::string title;
  std::string legendTitle;
  std::string unit;
  bool showLegend = true;
  bool showScaleBar = true;
  double azimuth = -60;
  double elevation = 30;
  double opacity = 1;
  bool onlyRange = false;
  int untilEvent = 0;
};

} // namespace lamella::rendering
