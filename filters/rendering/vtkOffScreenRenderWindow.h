#pragma once

#include "OffScreenContext.h"
#include "vtkOpenGLRenderWindow.h"

#include <memory>

/**
 * A render window that has an OpenGL context of its own and no display: OSMesa's or EGL's, whichever
 * vtkOffScreenWindows chose. It draws into framebuffer objects, as any off-screen VTK window does.
 * Use it on one thread.
 */
class vtkOffScreenRenderWindow : public vtkOpenGLRenderWindow
{
public:
  static vtkOffScreenRenderWindow* New();
  vtkTypeMacro(vtkOffScreenRenderWindow, vtkOpenGLRenderWindow);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// The kind of context to make; to be set before the first rendering.
  void SetBackend(lamella::rendering::Backend backend) { this->Backend = backend; }

  void Initialize() override;
  void Render() override;
  void Start() override;
  void Finalize() override;
  void MakeCurrent() override;
  bool IsCurrent() override;
  void ReleaseCurrent() override;
  void OpenGLInitContext() override;

  vtkTypeBool IsDirect() override { return 1; }
  int SupportsOpenGL() override;
  vtkTypeBool GetEventPending() override { return 0; }
  int* GetScreenSize() VTK_SIZEHINT(2) override;

  // There is nothing on a screen: a window that is "shown" or full-screen stays as it is.
  void SetShowWindow(bool) override {}
  void SetUseOffScreenBuffers(bool) override {}
  void SetWindowInfo(const char*) override {}
  void SetParentInfo(const char*) override {}
  void SetNextWindowInfo(const char*) override {}
  void SetWindowId(void*) override {}
  void SetParentId(void*) override {}
  void SetDisplayId(void*) override {}
  void SetNextWindowId(void*) override {}

  void* GetGenericWindowId() override { return nullptr; }
  void* GetGenericParentId() override { return nullptr; }
  void* GetGenericDrawable() override { return nullptr; }
  void* GetGenericDisplayId() override;
  void* GetGenericContext() override;

protected:
  vtkOffScreenRenderWindow();
  ~vtkOffScreenRenderWindow() override;

  void CreateAWindow() override;
  void DestroyWindow() override;

private:
  lamella::rendering::Backend Backend;
  std::unique_ptr<lamella::rendering::OffScreenContext> Context;
};
