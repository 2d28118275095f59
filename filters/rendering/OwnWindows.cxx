#include "WindowSystem.h"

#include "CallRedirection.h"
#include "OffScreenContext.h"
#include "vtkGenericRenderWindowInteractor.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOffScreenRenderWindow.h"
#include "vtkRenderWindow.h"
#include "vtkVersion.h"

#include <map>
#include <vector>

// Where VTK knows X windows only (before 9.4): windows of our own.

using lamella::rendering::Backend;
using lamella::rendering::OffScreenContext;
using lamella::rendering::RequestedRenderer;

namespace
{

struct Choice
{
  Backend backend = Backend::None;
  std::string message;
};

bool Works(Backend backend, std::string& whyNot)
{
  return backend == Backend::X ? lamella::rendering::XDisplayWorks(whyNot)
                               : OffScreenContext::Create(backend, whyNot) != nullptr;
}

/// The first back end of the list that works, tried in turn.
Choice FirstThatWorks(const std::vector<Backend>& candidates)
{
  Choice choice;
  for (const Backend backend : candidates)
  {
    std::string whyNot;
    if (Works(backend, whyNot))
    {
      choice.backend = backend;
      choice.message = std::string("drawing with ") + lamella::rendering::Name(backend);
      return choice;
    }
    choice.message +=
      (choice.message.empty() ? "" : "; ") + std::string(lamella::rendering::Name(backend)) + ": " + whyNot;
  }
  return choice;
}

Choice Choose(const std::string& request)
{
  for (const Backend backend : { Backend::OSMesa, Backend::EGL, Backend::X })
  {
    if (request == lamella::rendering::Name(backend))
    {
      Choice choice = FirstThatWorks({ backend });
      choice.message = choice.backend == backend ? choice.message + ", as LAMELLA_RENDERER asks"
                                                 : "LAMELLA_RENDERER=" + request + " does not work here (" +
          choice.message + "); leave it out to try the others";
      return choice;
    }
  }
  if (request != "auto")
    return { Backend::None, lamella::rendering::UnknownRenderer(request) };
  // Where VTK draws on a display already, a second kind of context on the same thread would only be in its way.
  Choice choice = OffScreenContext::IsGLXCurrent() ? FirstThatWorks({ Backend::X, Backend::OSMesa, Backend::EGL })
                                                   : FirstThatWorks({ Backend::OSMesa, Backend::EGL, Backend::X });
  if (choice.backend == Backend::None)
  {
    choice.message =
      "nothing here can draw a picture (" + choice.message + "); install libosmesa6, or libegl1 with libgl1-mesa-dri";
  }
  return choice;
}

/// The choice for what LAMELLA_RENDERER says now; found out once for each value.
const Choice& CurrentChoice()
{
  static std::map<std::string, Choice> choices;
  const std::string request = RequestedRenderer();
  auto found = choices.find(request);
  if (found == choices.end())
    found = choices.emplace(request, Choose(request)).first;
  return found->second;
}

vtkObject* NewOffScreenRenderWindow()
{
  vtkOffScreenRenderWindow* window = vtkOffScreenRenderWindow::New();
  window->SetBackend(CurrentChoice().backend);
  return window;
}

vtkObject* NewInteractor()
{
  return vtkGenericRenderWindowInteractor::New();
}

constexpr const char* WindowClasses[] = { "vtkRenderWindow", "vtkOpenGLRenderWindow" };
constexpr const char* InteractorClass = "vtkRenderWindowInteractor";

class OffScreenFactory : public vtkObjectFactory
{
public:
  static OffScreenFactory* New();
  vtkTypeMacro(OffScreenFactory, vtkObjectFactory);
  const char* GetVTKSourceVersion() VTK_FUTURE_CONST override { return VTK_SOURCE_VERSION; }
  const char* GetDescription() VTK_FUTURE_CONST override { return "Lamella: windows that need no display"; }

protected:
  OffScreenFactory()
  {
    for (const char* name : WindowClasses)
      this->RegisterOverride(name, "vtkOffScreenRenderWindow", "draws with no display", 1, NewOffScreenRenderWindow);
    this->RegisterOverride(InteractorClass, "vtkGenericRenderWindowInteractor", "needs no display", 1, NewInteractor);
  }
};
vtkStandardNewMacro(OffScreenFactory);

bool Installed = false;

} // namespace

namespace lamella::rendering
{

bool InstallWindows()
{
  const std::string request = RequestedRenderer();
  std::string whyNot;
  const bool leaveAlone = request == "x" || (request == "auto" && XDisplayWorks(whyNot));
  if (!leaveAlone && !Installed)
  {
    // The factory that was registered first wins: switch the others off for the classes that we make.
    for (const char* name : WindowClasses)
      vtkObjectFactory::SetAllEnableFlags(0, name);
    vtkObjectFactory::SetAllEnableFlags(0, InteractorClass);
    vtkNew<OffScreenFactory> factory;
    vtkObjectFactory::RegisterFactory(factory);
    RedirectDisplayTests();
    Installed = true;
  }
  return leaveAlone && request == "auto" ? true : CurrentChoice().backend != Backend::None;
}

bool WindowsInstalled()
{
  return Installed;
}

const char* WindowBackend()
{
  return Name(CurrentChoice().backend);
}

const char* WindowMessage()
{
  return CurrentChoice().message.c_str();
}

vtkRenderWindow* NewHiddenWindow()
{
  switch (CurrentChoice().backend)
  {
    case Backend::OSMesa:
    case Backend::EGL:
      return static_cast<vtkRenderWindow*>(NewOffScreenRenderWindow());
    case Backend::X:
    {
      vtkRenderWindow* window = vtkRenderWindow::New();
      window->SetShowWindow(false);
      window->SetUseOffScreenBuffers(true);
      return window;
    }
    case Backend::None:
      break;
  }
  return nullptr;
}

} // namespace lamella::rendering
