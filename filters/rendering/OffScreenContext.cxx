#include "OffScreenContext.h"

#include <cstdlib>
#include <dlfcn.h>
#include <mutex>
#include <set>
#include <string>

namespace lamella::rendering
{
namespace
{

/// Our context that is current on this thread.
thread_local OffScreenContext* Current = nullptr;

void* CallGLX(const char* name)
{
  using Function = void* (*)();
  const auto function = reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
  return function ? function() : nullptr;
}

/// Lets go of a GLX context that is current on this thread, as no second API can be current beside it.
void ReleaseGLX()
{
  using MakeCurrent = int (*)(void*, unsigned long, void*);
  const auto makeCurrent = reinterpret_cast<MakeCurrent>(dlsym(RTLD_DEFAULT, "glXMakeCurrent"));
  if (makeCurrent && OffScreenContext::IsGLXCurrent())
    makeCurrent(CallGLX("glXGetCurrentDisplay"), 0, nullptr);
}

} // namespace

bool OffScreenContext::IsGLXCurrent()
{
  return CallGLX("glXGetCurrentContext") != nullptr;
}

OffScreenContext::~OffScreenContext()
{
  if (Current == this)
    Current = nullptr;
}

bool OffScreenContext::MakeCurrent()
{
  if (this->IsCurrent())
  {
    Current = this;
    return true;
  }
  if (Current && Current != this)
    Current->ReleaseCurrent();
  ReleaseGLX();
  if (!this->DoMakeCurrent())
    return false;
  Current = this;
  return true;
}

void OffScreenContext::ReleaseCurrent()
{
  if (this->IsCurrent())
    this->DoReleaseCurrent();
  if (Current == this)
    Current = nullptr;
}

const char* Name(Backend backend)
{
  switch (backend)
  {
    case Backend::OSMesa:
      return "osmesa";
    case Backend::EGL:
      return "egl";
    case Backend::X:
      return "x";
    case Backend::None:
      break;
  }
  return "none";
}

std::unique_ptr<OffScreenContext> OffScreenContext::Create(Backend backend, std::string& whyNot)
{
  switch (backend)
  {
    case Backend::OSMesa:
      return CreateOSMesaContext(whyNot);
    case Backend::EGL:
      return CreateEGLContext(whyNot);
    default:
      whyNot = "not a back end without a display";
      return nullptr;
  }
}

bool XDisplayWorks(std::string& whyNot)
{
  const char* name = std::getenv("DISPLAY");
  if (!name || !*name)
  {
    whyNot = "DISPLAY is not set";
    return false;
  }
  // libX11 is there already, brought by VTK; asking for it by name keeps our library free of the dependency.
  void* x11 = dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
  using OpenDisplay = void* (*)(const char*);
  using CloseDisplay = int (*)(void*);
  const auto open = x11 ? reinterpret_cast<OpenDisplay>(dlsym(x11, "XOpenDisplay")) : nullptr;
  const auto close = x11 ? reinterpret_cast<CloseDisplay>(dlsym(x11, "XCloseDisplay")) : nullptr;
  if (!open || !close)
  {
    whyNot = "libX11.so.6 cannot be loaded";
    return false;
  }
  void* display = open(nullptr);
  if (!display)
  {
    whyNot = std::string("no X server answers at DISPLAY=") + name;
    return false;
  }
  // A server that loses its last client starts afresh (Xvfb does so unless told otherwise) and turns down who comes
  // meanwhile: VTK, which then ends the program. So the first connection to each display stays open.
  static std::mutex mutex;
  static std::set<std::string> held;
  const std::lock_guard<std::mutex> lock(mutex);
  if (!held.insert(name).second)
    close(display);
  return true;
}

} // namespace lamella::rendering
