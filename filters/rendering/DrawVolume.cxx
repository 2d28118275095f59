#include "Drawing.h"
namespace lamella::rendering
{
Drawing DrawVolume(vtkImageData*, const SnapshotOptions&)
{
  throw SnapshotError{ "volumes", "x" };
}
Drawing DrawGeometry(vtkPolyData*, const SnapshotOptions&)
{
  throw SnapshotError{ "geometry", "x" };
}
}
