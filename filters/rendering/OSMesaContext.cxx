// A Mesa software context in plain memory, usable in any process, also one that has loaded libGL already.
//
// VTK and GLEW call OpenGL through libGL/libOpenGL and glXGetProcAddress, which on today's Linux belong to libglvnd:
// every gl* function there jumps through a table of the thread's current context. libGLX and libEGL fill that table in
// through a small interface of libGLdispatch (GLdispatch.h of libglvnd, ABI version 1). We do the same for OSMesa, so
// that nothing has to be linked before VTK, preloaded or interposed.

#include "OffScreenContext.h"

#include <array>
#include <cstdint>
#include <dlfcn.h>
#include <vector>

namespace lamella::rendering
{
namespace
{

// From GL/osmesa.h (OSMesa 12 and later), so that its header is not needed to build.
constexpr int OSMESA_FORMAT_RGBA = 0x1908;
constexpr int OSMESA_FORMAT = 0x22;
constexpr int OSMESA_DEPTH_BITS = 0x30;
constexpr int OSMESA_STENCIL_BITS = 0x31;
constexpr int OSMESA_PROFILE = 0x33;
constexpr int OSMESA_CORE_PROFILE = 0x34;
constexpr int OSMESA_CONTEXT_MAJOR_VERSION = 0x36;
constexpr int OSMESA_CONTEXT_MINOR_VERSION = 0x37;
constexpr unsigned GL_UNSIGNED_BYTE_TYPE = 0x1401;

struct OSMesaFunctions
{
  using Proc = void (*)();
  void* (*createContext)(const int*, void*) = nullptr;
  void (*destroyContext)(void*) = nullptr;
  unsigned char (*makeCurrent)(void*, void*, unsigned, int, int) = nullptr;
  void* (*getCurrent)() = nullptr;
  Proc (*getProcAddress)(const char*) = nullptr;
};

/// What libGLdispatch keeps of a context's thread: a tag that says whose it is, a call-back at the thread's end, and
/// room for libGLdispatch itself.
struct ThreadState
{
  int tag = 0x4c616d; // neither GLX (0) nor EGL (1): both then see that no context of theirs is current
  void (*threadDestroyed)(ThreadState*) = nullptr;
  std::array<void*, 6> room{};
};

struct DispatchFunctions
{
  using GetProcAddress = void* (*)(const char*, void*);
  int (*abiVersion)() = nullptr;
  void (*init)() = nullptr;
  int (*newVendorID)() = nullptr;
  void* (*createTable)(GetProcAddress, void*) = nullptr;
  unsigned char (*makeCurrent)(ThreadState*, void*, int, const void*) = nullptr;
  void (*loseCurrent)() = nullptr;
  ThreadState* (*currentState)() = nullptr;
};

template <typename Function>
bool Load(void* library, const char* name, Function& function)
{
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

/// The two libraries, loaded once and kept for the life of the process.
struct Libraries
{
  OSMesaFunctions mesa;
  DispatchFunctions dispatch;
  void* table = nullptr;
  int vendor = 0;
  std::string whyNot;

  static Libraries& Instance()
  {
    static Libraries libraries;
    return libraries;
  }

private:
  Libraries()
  {
    void* mesaLibrary = nullptr;
    for (const char* name : { "libOSMesa.so.8", "libOSMesa.so" })
      mesaLibrary = mesaLibrary ? mesaLibrary : dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!mesaLibrary)
    {
      this->whyNot = "libOSMesa.so.8 is not installed";
      return;
    }
    if (!Load(mesaLibrary, "OSMesaCreateContextAttribs", this->mesa.createContext) ||
      !Load(mesaLibrary, "OSMesaDestroyContext", this->mesa.destroyContext) ||
      !Load(mesaLibrary, "OSMesaMakeCurrent", this->mesa.makeCurrent) ||
      !Load(mesaLibrary, "OSMesaGetCurrentContext", this->mesa.getCurrent) ||
      !Load(mesaLibrary, "OSMesaGetProcAddress", this->mesa.getProcAddress))
    {
      this->whyNot = "libOSMesa is too old (no OSMesaCreateContextAttribs)";
      return;
    }
    void* glvnd = dlopen("libGLdispatch.so.0", RTLD_NOW | RTLD_LOCAL);
    if (!glvnd || !Load(glvnd, "__glDispatchGetABIVersion", this->dispatch.abiVersion) ||
      !Load(glvnd, "__glDispatchInit", this->dispatch.init) ||
      !Load(glvnd, "__glDispatchNewVendorID", this->dispatch.newVendorID) ||
      !Load(glvnd, "__glDispatchCreateTable", this->dispatch.createTable) ||
      !Load(glvnd, "__glDispatchMakeCurrent", this->dispatch.makeCurrent) ||
      !Load(glvnd, "__glDispatchLoseCurrent", this->dispatch.loseCurrent) ||
      !Load(glvnd, "__glDispatchGetCurrentThreadState", this->dispatch.currentState))
    {
      this->whyNot = "libGL is not libglvnd's";
      return;
    }
    if (this->dispatch.abiVersion() != 1)
    {
      this->whyNot = "libGLdispatch has an unknown interface version";
      return;
    }
    this->dispatch.init();
    this->vendor = this->dispatch.newVendorID();
    this->table = this->dispatch.createTable(&Libraries::Resolve, this);
  }

  static void* Resolve(const char* name, void* self)
  {
    return reinterpret_cast<void*>(static_cast<Libraries*>(self)->mesa.getProcAddress(name));
  }
};

class OSMesaContext : public OffScreenContext
{
public:
  OSMesaContext(Libraries& libraries, void* context)
    : Library(libraries)
    , Context(context)
  {
  }
  ~OSMesaContext() override
  {
    if (this->IsCurrent())
      this->ReleaseCurrent();
    this->Library.mesa.destroyContext(this->Context);
  }

  bool IsCurrent() const override
  {
    return this->Library.mesa.getCurrent() == this->Context && this->Library.dispatch.currentState() == &this->State;
  }
  void* Handle() const override { return this->Context; }

protected:
  bool DoMakeCurrent() override
  {
    return this->Library.mesa.makeCurrent(
             this->Context, this->Buffer.data(), GL_UNSIGNED_BYTE_TYPE, BufferSize, BufferSize) &&
      this->Library.dispatch.makeCurrent(&this->State, this->Library.table, this->Library.vendor, nullptr);
  }
  void DoReleaseCurrent() override
  {
    this->Library.dispatch.loseCurrent();
    this->Library.mesa.makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE_TYPE, 0, 0);
  }

private:
  static constexpr int BufferSize = 16; // never drawn into: VTK draws into framebuffer objects
  Libraries& Library;
  void* Context;
  ThreadState State;
  std::vector<std::uint32_t> Buffer = std::vector<std::uint32_t>(BufferSize * BufferSize);
};

} // namespace

std::unique_ptr<OffScreenContext> CreateOSMesaContext(std::string& whyNot)
{
  Libraries& libraries = Libraries::Instance();
  if (!libraries.table)
  {
    whyNot = libraries.whyNot;
    return nullptr;
  }
  const int attributes[] = { OSMESA_FORMAT, OSMESA_FORMAT_RGBA, OSMESA_DEPTH_BITS, 24, OSMESA_STENCIL_BITS, 8,
    OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 2, 0, 0 };
  void* context = libraries.mesa.createContext(attributes, nullptr);
  if (!context)
  {
    whyNot = "libOSMesa gives no OpenGL 3.2 context";
    return nullptr;
  }
  auto result = std::make_unique<OSMesaContext>(libraries, context);
  if (!result->MakeCurrent())
  {
    whyNot = "the OSMesa context cannot be made current";
    return nullptr;
  }
  result->ReleaseCurrent();
  return result;
}

} // namespace lamella::rendering
