/**
 * What the setting of a class is declared with: its name and type once, for the setter, the getter and what switches
 * it. Its default is the initialiser of the member of that name; tools/settings/headers.py says what the comment above
 * holds.
 */

#ifndef vtkSetting_h
#define vtkSetting_h

#include "vtkSetGet.h"

/// SetName() and GetName().
#define vtkSettingMacro(name, type)                                                                                    \
  vtkSetMacro(name, type);                                                                                             \
  vtkGetMacro(name, type)

/// Those of a bool, NameOn() and NameOff().
#define vtkSwitchMacro(name)                                                                                           \
  vtkSettingMacro(name, bool);                                                                                         \
  vtkBooleanMacro(name, bool)

/// Those of an array of two.
#define vtkSettingVector2Macro(name, type)                                                                             \
  vtkSetVector2Macro(name, type);                                                                                      \
  vtkGetVector2Macro(name, type)

/// Those of an array of three.
#define vtkSettingVector3Macro(name, type)                                                                             \
  vtkSetVector3Macro(name, type);                                                                                      \
  vtkGetVector3Macro(name, type)

#endif
