#pragma once

#include "Listed.h"
#include "Settings.h"
#include "vtkPieces.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"

/// What the sources of many classes define alike, as vtkStandardNewMacro() does New(). Not installed.

/// PrintSelf(), of the settings that the header declares.
#define vtkPrintSettingsMacro(thisClass)                                                                               \
  void thisClass::PrintSelf(ostream& os, vtkIndent indent)                                                             \
  {                                                                                                                    \
    this->Superclass::PrintSelf(os, indent);                                                                           \
    lamella::printSettings(this, os, indent);                                                                          \
  }

/// FillInputPortInformation(), of inputs that are all of one type.
#define vtkInputTypeMacro(thisClass, type)                                                                             \
  int thisClass::FillInputPortInformation(int, vtkInformation* info)                                                   \
  {                                                                                                                    \
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), type);                                                         \
    return 1;                                                                                                          \
  }

/// RequestUpdateExtent(): each rank's piece of the input where the controller's ranks work together, else all of it.
#define vtkRequestPiecesMacro(thisClass)                                                                               \
  int thisClass::RequestUpdateExtent(                                                                                  \
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)                             \
  {                                                                                                                    \
    lamella::requestInput(                                                                                             \
      inputs[0]->GetInformationObject(0), lamella::requestedOutput(request, outputs), this->Controller);               \
    return 1;                                                                                                          \
  }

/// RequestInformation(), of an output that is not divided: allInFirstPiece().
#define vtkAllInFirstPieceMacro(thisClass)                                                                             \
  int thisClass::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)            \
  {                                                                                                                    \
    lamella::allInFirstPiece(outputs);                                                                                 \
    return 1;                                                                                                          \
  }

/// FillOutputPortInformation(): the type of each output's data, in quotes.
#define vtkOutputTypesMacro(thisClass, ...)                                                                            \
  int thisClass::FillOutputPortInformation(int port, vtkInformation* info)                                             \
  {                                                                                                                    \
    static constexpr const char* types[] = { __VA_ARGS__ };                                                            \
    info->Set(vtkDataObject::DATA_TYPE_NAME(), types[port]);                                                           \
    return 1;                                                                                                          \
  }

/// GetName(): the data of an output.
#define vtkGetOutputMacro(thisClass, name, type, port)                                                                 \
  type* thisClass::Get##name()                                                                                         \
  {                                                                                                                    \
    return type::SafeDownCast(this->GetOutputDataObject(port));                                                        \
  }

/// RemoveAllNames(), of what a member lists.
#define vtkRemoveAllMacro(thisClass, names, list)                                                                      \
  void thisClass::RemoveAll##names()                                                                                   \
  {                                                                                                                    \
    lamella::removeAll(this, this->list);                                                                              \
  }

/// AddName() and RemoveAllNames(), of a member that is a vector.
#define vtkAddToListMacro(thisClass, name, names, type, list)                                                          \
  void thisClass::Add##name(type value)                                                                                \
  {                                                                                                                    \
    this->list.push_back(value);                                                                                       \
    this->Modified();                                                                                                  \
  }                                                                                                                    \
  vtkRemoveAllMacro(thisClass, names, list)

/// SetName() and RemoveAllNames(), of a member that is a map of numbers by phase or pair of phases.
#define vtkSetNamedMacro(thisClass, name, names, table)                                                                \
  void thisClass::Set##name(const char* key, double value)                                                             \
  {                                                                                                                    \
    lamella::setNamed(this, this->table, key, value);                                                                  \
  }                                                                                                                    \
  vtkRemoveAllMacro(thisClass, names, table)

/// GetNumberOfStates() and GetStateName(), of a member that is KeptStates.
#define vtkGetStatesMacro(thisClass, name, type, states)                                                               \
  int thisClass::GetNumberOfStates()                                                                                   \
  {                                                                                                                    \
    return this->states.count();                                                                                       \
  }                                                                                                                    \
  type* thisClass::GetState##name(int state)                                                                           \
  {                                                                                                                    \
    return this->states.at(state);                                                                                     \
  }

/// GetState(), the one that is shown, and GetMTime(), by which another one is shown.
#define vtkShownStateMacro(thisClass, states)                                                                          \
  int thisClass::GetState()                                                                                            \
  {                                                                                                                    \
    return this->states.chosen();                                                                                      \
  }                                                                                                                    \
  vtkMTimeType thisClass::GetMTime()                                                                                   \
  {                                                                                                                    \
    return this->states.changed(this->Superclass::GetMTime());                                                         \
  }
