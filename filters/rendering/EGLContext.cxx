// A surfaceless EGL context: Mesa in software or on the graphics card, or the card's own driver, with no X server.

#include "OffScreenContext.h"

#include <array>
#include <dlfcn.h>

namespace lamella::rendering
{
namespace
{

// From EGL/egl.h and EGL/eglext.h, so that their headers are not needed to build.
using EGLHandle = void*;
constexpr int EGL_ALPHA_SIZE = 0x3021;
constexpr int EGL_BLUE_SIZE = 0x3022;
constexpr int EGL_GREEN_SIZE = 0x3023;
constexpr int EGL_RED_SIZE = 0x3024;
constexpr int EGL_SURFACE_TYPE = 0x3033;
constexpr int EGL_NONE = 0x3038;
constexpr int EGL_RENDERABLE_TYPE = 0x3040;
constexpr int EGL_HEIGHT = 0x3056;
constexpr int EGL_WIDTH = 0x3057;
constexpr int EGL_CONTEXT_MAJOR_VERSION = 0x3098;
constexpr int EGL_CONTEXT_MINOR_VERSION = 0x30FB;
constexpr int EGL_CONTEXT_OPENGL_PROFILE_MASK = 0x30FD;
constexpr int EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT = 0x1;
constexpr int EGL_PBUFFER_BIT = 0x1;
constexpr int EGL_OPENGL_BIT = 0x8;
constexpr unsigned EGL_OPENGL_API = 0x30A2;
constexpr unsigned EGL_PLATFORM_SURFACELESS_MESA = 0x31DD;
constexpr unsigned EGL_PLATFORM_DEVICE_EXT = 0x313F;

/// libEGL and a display on it, opened once and kept for the life of the process.
struct Library
{
  void* (*getProcAddress)(const char*) = nullptr;
  unsigned (*initialize)(EGLHandle, int*, int*) = nullptr;
  unsigned (*bindAPI)(unsigned) = nullptr;
  unsigned (*chooseConfig)(EGLHandle, const int*, EGLHandle*, int, int*) = nullptr;
  EGLHandle (*createContext)(EGLHandle, EGLHandle, EGLHandle, const int*) = nullptr;
  unsigned (*destroyContext)(EGLHandle, EGLHandle) = nullptr;
  EGLHandle (*createPbufferSurface)(EGLHandle, EGLHandle, const int*) = nullptr;
  unsigned (*destroySurface)(EGLHandle, EGLHandle) = nullptr;
  unsigned (*makeCurrent)(EGLHandle, EGLHandle, EGLHandle, EGLHandle) = nullptr;
  EGLHandle (*getCurrentContext)() = nullptr;

  EGLHandle display = nullptr;
  EGLHandle config = nullptr;
  std::string whyNot;

  static Library& Instance()
  {
    static Library library;
    return library;
  }

private:
  Library()
  {
    void* egl = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!egl)
    {
      this->whyNot = "libEGL.so.1 is not installed";
      return;
    }
    if (!Load(egl, "eglGetProcAddress", this->getProcAddress) || !Load(egl, "eglInitialize", this->initialize) ||
      !Load(egl, "eglBindAPI", this->bindAPI) || !Load(egl, "eglChooseConfig", this->chooseConfig) ||
      !Load(egl, "eglCreateContext", this->createContext) || !Load(egl, "eglDestroyContext", this->destroyContext) ||
      !Load(egl, "eglCreatePbufferSurface", this->createPbufferSurface) ||
      !Load(egl, "eglDestroySurface", this->destroySurface) || !Load(egl, "eglMakeCurrent", this->makeCurrent) ||
      !Load(egl, "eglGetCurrentContext", this->getCurrentContext))
    {
      this->whyNot = "libEGL.so.1 lacks functions of EGL 1.4";
      return;
    }
    using GetPlatformDisplay = EGLHandle (*)(unsigned, void*, const int*);
    using QueryDevices = unsigned (*)(int, EGLHandle*, int*);
    const auto platformDisplay = reinterpret_cast<GetPlatformDisplay>(this->getProcAddress("eglGetPlatformDisplayEXT"));
    const auto queryDevices = reinterpret_cast<QueryDevices>(this->getProcAddress("eglQueryDevicesEXT"));
    if (!platformDisplay)
    {
      this->whyNot = "libEGL has no platform displays";
      return;
    }
    if (this->Open(platformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)))
      return;
    std::array<EGLHandle, 16> devices{};
    int count = 0;
    if (queryDevices && queryDevices(static_cast<int>(devices.size()), devices.data(), &count))
    {
      for (int i = 0; i < count; ++i)
        if (this->Open(platformDisplay(EGL_PLATFORM_DEVICE_EXT, devices.at(static_cast<std::size_t>(i)), nullptr)))
          return;
    }
    this->whyNot = "EGL has neither a surfaceless platform nor a device that draws OpenGL";
  }

  template <typename Function>
  static bool Load(void* library, const char* name, Function& function)
  {
    function = reinterpret_cast<Function>(dlsym(library, name));
    return function != nullptr;
  }

  bool Open(EGLHandle candidate)
  {
    if (!candidate || !this->initialize(candidate, nullptr, nullptr) || !this->bindAPI(EGL_OPENGL_API))
      return false;
    const int wanted[] = { EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_RED_SIZE, 8,
      EGL_GREEN_SIZE, 8, EGL_BLUE_SIZE, 8, EGL_ALPHA_SIZE, 8, EGL_NONE };
    int count = 0;
    if (!this->chooseConfig(candidate, wanted, &this->config, 1, &count) || count < 1)
      return false;
    this->display = candidate;
    return true;
  }
};

class EGLContext : public OffScreenContext
{
public:
  EGLContext(Library& egl, EGLHandle context, EGLHandle surface)
    : Egl(egl)
    , Context(context)
    , Surface(surface)
  {
  }
  ~EGLContext() override
  {
    if (this->IsCurrent())
      this->ReleaseCurrent();
    this->Egl.destroySurface(this->Egl.display, this->Surface);
    this->Egl.destroyContext(this->Egl.display, this->Context);
  }

  bool IsCurrent() const override { return this->Egl.getCurrentContext() == this->Context; }
  void* Handle() const override { return this->Context; }
  void* Display() const override { return this->Egl.display; }

protected:
  bool DoMakeCurrent() override
  {
    return this->Egl.bindAPI(EGL_OPENGL_API) &&
      this->Egl.makeCurrent(this->Egl.display, this->Surface, this->Surface, this->Context);
  }
  void DoReleaseCurrent() override { this->Egl.makeCurrent(this->Egl.display, nullptr, nullptr, nullptr); }

private:
  Library& Egl;
  void* Context;
  void* Surface;
};

} // namespace

std::unique_ptr<OffScreenContext> CreateEGLContext(std::string& whyNot)
{
  Library& egl = Library::Instance();
  if (!egl.display)
  {
    whyNot = egl.whyNot;
    return nullptr;
  }
  egl.bindAPI(EGL_OPENGL_API);
  const int attributes[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2,
    EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE };
  void* context = egl.createContext(egl.display, egl.config, nullptr, attributes);
  if (!context)
  {
    whyNot = "EGL gives no OpenGL 3.2 context";
    return nullptr;
  }
  // VTK asks for the sizes of the window's colour buffers: a tiny surface answers, though nothing is drawn on it.
  const int size[] = { EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE };
  void* surface = egl.createPbufferSurface(egl.display, egl.config, size);
  if (!surface)
  {
    egl.destroyContext(egl.display, context);
    whyNot = "EGL gives no pbuffer";
    return nullptr;
  }
  return std::make_unique<EGLContext>(egl, context, surface);
}

} // namespace lamella::rendering
