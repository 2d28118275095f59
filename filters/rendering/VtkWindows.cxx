#include "WindowSystem.h"

#include "vtkNew.h"
#include "vtkRenderWindow.h"

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

// From 9.4 on VTK tries GLX, EGL and OSMesa by itself, and VTK_DEFAULT_OPENGL_WINDOW names the class to begin with:
// where there is no display, EGL, or it warns of that.

namespace
{

constexpr std::array<std::pair<const char*, const char*>, 3> Classes{ { { "osmesa", "vtkOSOpenGLRenderWindow" },
  { "egl", "vtkEGLRenderWindow" }, { "x", "vtkXOpenGLRenderWindow" } } };

/// What VTK draws with, and how that is said.
struct Choice
{
  std::string Backend = "none";
  std::string Message;

  Choice()
  {
    const std::string request = lamella::rendering::RequestedRenderer();
    vtkNew<vtkRenderWindow> window;
    for (const auto& [name, kind] : Classes)
      if (window->IsA(kind))
        this->Backend = name;
    if (!lamella::rendering::IsRendererKnown(request))
      this->Backend = "none";
    this->Message = !lamella::rendering::IsRendererKnown(request) ? lamella::rendering::UnknownRenderer(request)
      : this->Backend == "none"
      ? std::string("nothing here can draw a picture; install libegl1 with libgl1-mesa-dri, or libosmesa6")
      : "drawing with " + this->Backend;
  }
};

const Choice& CurrentChoice()
{
  static const Choice choice = (lamella::rendering::InstallWindows(), Choice());
  return choice;
}

} // namespace

namespace lamella::rendering
{

bool InstallWindows()
{
  const char* const display = std::getenv("DISPLAY"); // NOLINT(concurrency-mt-unsafe)
  const bool noDisplay = display == nullptr || *display == '\0';
  for (const auto& [name, kind] : Classes)
    if (RequestedRenderer() == name || (RequestedRenderer() == "auto" && noDisplay && std::string_view("egl") == name))
      setenv("VTK_DEFAULT_OPENGL_WINDOW", kind, 0); // NOLINT(concurrency-mt-unsafe)
  return IsRendererKnown(RequestedRenderer());
}

bool WindowsInstalled()
{
  return false;
}

const char* WindowBackend()
{
  return CurrentChoice().Backend.c_str();
}

const char* WindowMessage()
{
  return CurrentChoice().Message.c_str();
}

vtkRenderWindow* NewHiddenWindow()
{
  if (CurrentChoice().Backend == "none")
    return nullptr;
  vtkRenderWindow* const window = vtkRenderWindow::New();
  window->SetShowWindow(false);
  window->SetUseOffScreenBuffers(true);
  return window;
}

} // namespace lamella::rendering
