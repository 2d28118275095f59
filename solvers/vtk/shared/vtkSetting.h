/**
 * What the setting of a class is declared with: its name, type and default once, for the setter, the getter, what
 * switches it, and the protected member of that name. tools/settings/headers.py says what the comment above holds.
 */

#pragma once

#include "vtkSetGet.h"

/// SetName() and GetName().
#define vtkSettingMacro(name, type, value)                                                                             \
  vtkSetMacro(name, type);                                                                                             \
                                                                                                                       \
protected:                                                                                                             \
  type name = value;                                                                                                   \
                                                                                                                       \
public:                                                                                                                \
  vtkGetMacro(name, type)

/// Those of a bool, NameOn() and NameOff().
#define vtkSwitchMacro(name, value)                                                                                    \
  vtkSettingMacro(name, bool, value);                                                                                  \
  vtkBooleanMacro(name, bool)

/// Those of an array of two: its default is two numbers.
#define vtkSettingVector2Macro(name, type, first, second)                                                              \
  vtkSetVector2Macro(name, type);                                                                                      \
                                                                                                                       \
protected:                                                                                                             \
  type name[2] = { first, second };                                                                                    \
                                                                                                                       \
public:                                                                                                                \
  vtkGetVector2Macro(name, type)

/// Those of an array of three.
#define vtkSettingVector3Macro(name, type, first, second, third)                                                       \
  vtkSetVector3Macro(name, type);                                                                                      \
                                                                                                                       \
protected:                                                                                                             \
  type name[3] = { first, second, third };                                                                             \
                                                                                                                       \
public:                                                                                                                \
  vtkGetVector3Macro(name, type)
