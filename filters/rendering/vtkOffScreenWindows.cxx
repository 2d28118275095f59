#include "vtkOffScreenWindows.h"

#include "WindowSystem.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkOffScreenWindows);

void vtkOffScreenWindows::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Installed: " << (lamella::rendering::WindowsInstalled() ? "yes" : "no") << "\n";
  os << indent << "Message: " << vtkOffScreenWindows::GetMessage() << "\n";
}

bool vtkOffScreenWindows::Install()
{
  return lamella::rendering::InstallWindows();
}

bool vtkOffScreenWindows::IsInstalled()
{
  return lamella::rendering::WindowsInstalled();
}

bool vtkOffScreenWindows::IsRequestKnown()
{
  return lamella::rendering::IsRendererKnown(lamella::rendering::RequestedRenderer());
}

const char* vtkOffScreenWindows::GetBackend()
{
  return lamella::rendering::WindowBackend();
}

const char* vtkOffScreenWindows::GetMessage()
{
  return lamella::rendering::WindowMessage();
}

vtkRenderWindow* vtkOffScreenWindows::NewWindow()
{
  return lamella::rendering::NewHiddenWindow();
}
