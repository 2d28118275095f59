#pragma once

#include "vtkLamellaRenderingModule.h" // for the export macro
#include "vtkObject.h"

class vtkRenderWindow;

/**
 * @class vtkOffScreenWindows
 * @brief Lets VTK and ParaView draw with no display
 *
 * The VTK inside Debian's ParaView knows X windows only, so that without an X server every rendering ends in a crash.
 * This class offers two other ways, each of which draws the same picture:
 *
 * - `osmesa`: Mesa in software, in plain memory (libOSMesa);
 * - `egl`: EGL with no surface, in software or on a graphics card (libEGL);
 * - `x`: VTK's own window on an X server, where there is one.
 *
 * They are tried in this order. The environment variable LAMELLA_RENDERER=osmesa|egl|x|auto forces one. The libraries
 * are loaded when they are needed: a machine that lacks one falls back on the next.
 *
 * Install() makes the windows of VTK and ParaView themselves (`vtkRenderWindow::New()`) use the first two; it leaves
 * everything as it is where a display works, so the ParaView application is never disturbed. NewWindow() gives a window
 * to draw a picture in, whatever is installed.
 *
 * @warning A window must be used on the thread that drew in it first.
 */
class VTKLAMELLARENDERING_EXPORT vtkOffScreenWindows : public vtkObject
{
public:
  static vtkOffScreenWindows* New();
  vtkTypeMacro(vtkOffScreenWindows, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * From here on render windows need no display, if there is none or if LAMELLA_RENDERER asks for osmesa or egl.
   * To be called before the first window is made; calling it again does nothing.
   * Returns false when neither a display nor another way to draw was found: GetMessage() then says what was tried,
   * and a window made all the same reports that line instead of crashing.
   */
  static bool Install();

  /**
   * Has Install() replaced the windows of VTK and ParaView?
   */
  static bool IsInstalled();

  /**
   * How NewWindow() draws: "osmesa", "egl", "x", or "none" when nothing works. Found out at the first call.
   */
  static const char* GetBackend();

  /**
   * One line: what draws, or what was tried and why it does not work.
   */
  static const char* GetMessage();

  /**
   * Is LAMELLA_RENDERER unset or one of osmesa, egl, x, auto? Tries nothing.
   */
  static bool IsRequestKnown();

#ifndef __VTK_WRAP__
  /**
   * A window that shows nothing on any screen, for the caller to delete; null when nothing works (see GetMessage()).
   */
  static vtkRenderWindow* NewWindow();
#endif

protected:
  vtkOffScreenWindows() = default;
  ~vtkOffScreenWindows() override = default;
};
