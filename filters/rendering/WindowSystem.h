#pragma once

#include <cstdlib>
#include <string>

class vtkRenderWindow;

/// What vtkOffScreenWindows does, in one of two ways: OwnWindows.cxx where VTK knows X windows only, VtkWindows.cxx
/// where it chooses between GLX, EGL and OSMesa by itself (from 9.4 on).
namespace lamella::rendering
{

/// What LAMELLA_RENDERER says: osmesa, egl, x; auto where it says nothing.
inline std::string RequestedRenderer()
{
  const char* value = std::getenv("LAMELLA_RENDERER");
  return value && *value ? value : "auto";
}

inline std::string UnknownRenderer(const std::string& request)
{
  return "LAMELLA_RENDERER=" + request + " is not known: use osmesa, egl, x or auto";
}

inline bool IsRendererKnown(const std::string& request)
{
  return request == "auto" || request == "osmesa" || request == "egl" || request == "x";
}

bool InstallWindows();
bool WindowsInstalled();
const char* WindowBackend();
const char* WindowMessage();
vtkRenderWindow* NewHiddenWindow(); ///< null when nothing draws

} // namespace lamella::rendering
