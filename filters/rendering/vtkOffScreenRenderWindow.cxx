#include "vtk_glew.h" // before any other OpenGL header

#include "vtkOffScreenRenderWindow.h"

#include "vtkObjectFactory.h"
#include "vtkOffScreenWindows.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"

#include <algorithm>

using lamella::rendering::OffScreenContext;

vtkStandardNewMacro(vtkOffScreenRenderWindow);

vtkOffScreenRenderWindow::vtkOffScreenRenderWindow()
  : Backend(lamella::rendering::Backend::OSMesa)
{
  this->ShowWindow = false;
  this->UseOffScreenBuffers = true;
  this->MultiSamples = 0;
  this->SetFrameBlitModeToNoBlit();
  this->SetStencilCapable(1);
}

vtkOffScreenRenderWindow::~vtkOffScreenRenderWindow()
{
  this->Finalize();
  vtkCollectionSimpleIterator it;
  this->Renderers->InitTraversal(it);
  while (vtkRenderer* renderer = this->Renderers->GetNextRenderer(it))
    renderer->SetRenderWindow(nullptr);
}

void vtkOffScreenRenderWindow::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Backend: " << lamella::rendering::Name(this->Backend) << "\n";
}

void vtkOffScreenRenderWindow::CreateAWindow()
{
  std::string whyNot;
  this->Context = OffScreenContext::Create(this->Backend, whyNot);
  if (!this->Context)
  {
    vtkErrorMacro(<< vtkOffScreenWindows::GetMessage());
    return;
  }
  this->OwnContext = 1;
  if (this->Size[0] == 0 || this->Size[1] == 0)
    this->Size[0] = this->Size[1] = 300; // as VTK's other windows start
  this->Mapped = 1;
  this->MakeCurrent();
  this->OpenGLInit();
}

void vtkOffScreenRenderWindow::DestroyWindow()
{
  if (this->Context)
  {
    this->MakeCurrent();
    this->ReleaseGraphicsResources(this);
    this->Context->ReleaseCurrent();
    this->Context.reset();
  }
  this->Mapped = 0;
  this->Initialized = false;
}

void vtkOffScreenRenderWindow::Initialize()
{
  if (!this->Context)
    this->CreateAWindow();
}

void vtkOffScreenRenderWindow::Start()
{
  this->Initialize();
  if (this->Context)
    this->Superclass::Start();
}

void vtkOffScreenRenderWindow::Render()
{
  this->Initialize();
  if (this->Initialized) // else the error has been told, and drawing without OpenGL would crash
    this->Superclass::Render();
}

void vtkOffScreenRenderWindow::Finalize()
{
  this->DestroyWindow();
}

void vtkOffScreenRenderWindow::MakeCurrent()
{
  if (this->Context && !this->Context->MakeCurrent())
    vtkErrorMacro("the " << lamella::rendering::Name(this->Backend) << " context cannot be made current");
}

bool vtkOffScreenRenderWindow::IsCurrent()
{
  return this->Context && this->Context->IsCurrent();
}

void vtkOffScreenRenderWindow::ReleaseCurrent()
{
  if (this->Context)
    this->Context->ReleaseCurrent();
}

void vtkOffScreenRenderWindow::OpenGLInitContext()
{
  this->ContextCreationTime.Modified();
  if (this->Initialized)
    return;
  // As the superclass does it, but for one thing: with no X server GLEW reports that GLX has no display after it has
  // found every function, and that is all right here.
  glewExperimental = GL_TRUE;
  const GLenum result = glewInit();
  this->GlewInitValid = result == GLEW_OK || result == GLEW_ERROR_NO_GLX_DISPLAY;
  if (!this->GlewInitValid)
  {
    vtkErrorMacro(
      "the OpenGL functions cannot be found: " << reinterpret_cast<const char*>(glewGetErrorString(result)));
    return;
  }
  if (!GLEW_VERSION_3_2)
  {
    vtkErrorMacro("OpenGL 3.2 or later is needed");
    return;
  }
  this->Initialized = true;
  GLfloat range[2] = { 1, 1 };
  glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, range);
  this->MaximumHardwareLineWidth = range[1];
  while (glGetError() != GL_NO_ERROR)
  {
    // a core profile may refuse the question above
  }
}

int vtkOffScreenRenderWindow::SupportsOpenGL()
{
  this->Initialize();
  this->OpenGLSupportTested = true;
  this->OpenGLSupportResult = this->Initialized ? 1 : 0;
  return this->OpenGLSupportResult;
}

int* vtkOffScreenRenderWindow::GetScreenSize()
{
  this->ScreenSize[0] = std::max(this->Size[0], 1920);
  this->ScreenSize[1] = std::max(this->Size[1], 1080);
  return this->ScreenSize;
}

void* vtkOffScreenRenderWindow::GetGenericDisplayId()
{
  return this->Context ? this->Context->Display() : nullptr;
}

void* vtkOffScreenRenderWindow::GetGenericContext()
{
  return this->Context ? this->Context->Handle() : nullptr;
}
