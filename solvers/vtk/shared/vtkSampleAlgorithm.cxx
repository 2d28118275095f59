#include "vtkSampleAlgorithm.h"

#include "Attempt.h"
#include "Failures.h"
#include "SettingTable.h"
#include "ThreadCount.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <new>

namespace
{

/// Calls it with the last failure, if there is one.
void told(const std::function<void(const std::exception&)>& tell)
{
  try
  {
    if (const std::exception_ptr error = lamella::lastFailure())
      std::rethrow_exception(error);
  }
  catch (const std::exception& error)
  {
    tell(error);
  }
}

} // namespace

vtkPrintSettingsMacro(vtkSampleAlgorithm);

vtkSampleAlgorithm::vtkSampleAlgorithm()
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
}

void vtkSampleAlgorithm::AddVoid(const char* phase)
{
  if (phase != nullptr && *phase != '\0' &&
    std::find(this->Voids.begin(), this->Voids.end(), phase) == this->Voids.end())
  {
    this->Voids.emplace_back(phase);
    this->Modified();
  }
}

vtkRemoveAllMacro(vtkSampleAlgorithm, Voids, Voids);
vtkInputTypeMacro(vtkSampleAlgorithm, "vtkImageData");
vtkRequestPiecesMacro(vtkSampleAlgorithm);

int vtkSampleAlgorithm::Attempt(const std::function<void()>& run, vtkInformationVector* outputs)
{
  lamella::Failure failure = lamella::Failure::None;
  const lamella::Outcome outcome = lamella::attempt(this, run, &failure);
  this->Failure = static_cast<int>(failure);
  return lamella::concluded(this, outcome, outputs);
}

int vtkSampleAlgorithm::LastFailure()
{
  int kind = NO_FAILURE;
  told([&](const std::exception& error) { kind = static_cast<int>(lamella::kindOf(error)); });
  return kind;
}

std::string vtkSampleAlgorithm::LastMessage()
{
  std::string message;
  told(
    [&](const std::exception& error)
    {
      const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
      message = memory ? "there is not enough memory" : error.what();
    });
  return message;
}

std::string vtkSampleAlgorithm::LastHint()
{
  std::string hint;
  told(
    [&](const std::exception& error)
    {
      const auto* const ours = dynamic_cast<const lamella::Error*>(&error);
      hint = ours != nullptr ? ours->hint() : "";
    });
  return hint;
}

void vtkSampleAlgorithm::ForgetLastFailure()
{
  (void)lamella::takeFailure();
}

int vtkSampleAlgorithm::FindChoice(const char* className, const char* setting, const char* word)
{
  constexpr int none = -1000000;
  try
  {
    for (const lamella::Setting& one : lamella::settingsOf(className != nullptr ? className : ""))
    {
      if (setting == nullptr || word == nullptr || std::string(one.word) != setting)
        continue;
      for (const lamella::SettingChoice& choice : one.choices)
        if (std::string(choice.word) == word)
          return choice.value;
      lamella::refuseWord(one, word);
    }
  }
  catch (const lamella::Error&)
  {
    lamella::keepFailure(std::current_exception());
  }
  return none;
}

int vtkSampleAlgorithm::ThreadCount() const
{
  return lamella::threadCount(this->Threads);
}
