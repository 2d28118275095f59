#pragma once

#include <memory>
#include <string>

/// OpenGL contexts that need no display. The libraries behind them (libOSMesa, libEGL) are loaded when they are first
/// asked for, never linked: a machine that lacks one falls back on the next.
namespace lamella::rendering
{

enum class Backend
{
  None,
  OSMesa, ///< Mesa in software, in memory only
  EGL,    ///< surfaceless: Mesa or the graphics card's own driver, no X server
  X       ///< a display server, through VTK's own window
};
const char* Name(Backend backend);

/// One OpenGL 3.2 core context that draws into framebuffer objects only.
class OffScreenContext
{
public:
  virtual ~OffScreenContext();
  OffScreenContext(const OffScreenContext&) = delete;
  OffScreenContext& operator=(const OffScreenContext&) = delete;

  /// Makes this context the thread's current one; lets go of any other first, be it GLX's or one of ours.
  bool MakeCurrent();
  void ReleaseCurrent();
  virtual bool IsCurrent() const = 0;
  virtual void* Handle() const = 0; ///< the context, as its library knows it
  virtual void* Display() const { return nullptr; }

  /// Is a context of VTK's own X windows current on this thread?
  static bool IsGLXCurrent();

  /// A context of the given kind, not yet current; null and the reason when there is none.
  static std::unique_ptr<OffScreenContext> Create(Backend backend, std::string& whyNot);

protected:
  OffScreenContext() = default;
  virtual bool DoMakeCurrent() = 0;
  virtual void DoReleaseCurrent() = 0;
};

std::unique_ptr<OffScreenContext> CreateOSMesaContext(std::string& whyNot);
std::unique_ptr<OffScreenContext> CreateEGLContext(std::string& whyNot);

/// Is there an X server behind DISPLAY? `whyNot` says what was found when there is none.
bool XDisplayWorks(std::string& whyNot);

} // namespace lamella::rendering
