#include "commands/FilterRun.h"

#include "Failures.h"
#include "files/GridFile.h"
#include "session/Workspace.h"

#include "core/Error.h"
#include "vtkSampleAlgorithm.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkDataObject.h>

#include <exception>
#include <optional>
#include <utility>

namespace lamella::cli
{

namespace
{

/// Hands the steps of a filter to the scene or the session that waits for them. What fails there stops the filter.
class StepWatch
{
public:
  StepWatch(const Session& session, vtkAlgorithm* filter)
    : filter_(filter)
    , take_(session.onStep())
    , steps_(filter, vtkSampleAlgorithm::STEP_EVENT, [this](void* state) { hand(static_cast<vtkDataObject*>(state)); })
  {
  }

  void rethrow() const
  {
    if (failed_)
      std::rethrow_exception(failed_);
  }

private:
  void hand(vtkDataObject* state)
  {
    if (failed_ || !take_)
      return;
    try
    {
      take_(state);
    }
    catch (...)
    {
      failed_ = std::current_exception();
      filter_->SetAbortExecute(1);
    }
  }

  vtkAlgorithm* filter_;
  std::function<void(vtkDataObject*)> take_;
  std::exception_ptr failed_;
  Observer steps_;
};

} // namespace

Observer::Observer(vtkObject* of, unsigned long event, std::function<void(void* data)> tell)
  : of_(of)
  , tell_(std::move(tell))
{
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(this);
  command->SetCallback(
    [](vtkObject*, unsigned long, void* self, void* data) { static_cast<Observer*>(self)->tell_(data); });
  tag_ = of_->AddObserver(event, command);
}

Observer::~Observer()
{
  of_->RemoveObserver(tag_);
}

void runFilter(Session& session, vtkAlgorithm* filter, const char* what, const std::function<void()>& update)
{
  bool stopped = false;
  std::optional<Observer> progress(std::in_place, filter, vtkCommand::ProgressEvent,
    [&](void*)
    {
      const char* const words = filter->GetProgressText();
      if (!session.progress(filter->GetProgress(), words != nullptr ? words : what))
      {
        stopped = true;
        filter->SetAbortExecute(1);
      }
    });
  const StepWatch steps(session, filter);
  (void)VtkMessages::takeErrors();
  (void)takeFailure();
  update();
  progress.reset();
  session.endProgress();
  steps.rethrow();
  Session::checkInterrupt();
  if (stopped) // by the run that this one is part of
    throw Cancelled();
  if (const std::exception_ptr failure = takeFailure())
  {
    (void)VtkMessages::takeErrors(); // the same in VTK's words
    std::rethrow_exception(failure);
  }
}

void runFilter(Session& session, vtkAlgorithm* filter, const char* what)
{
  runFilter(
    session, filter, what, [filter] { filter->Update(); });
}

void tellWarnings(Session& session, const std::function<bool(const std::string& warning)>& tell)
{
  for (const std::string& warning : VtkMessages::takeWarnings())
    if (!tell || tell(warning))
      session.warn(warning);
}

} // namespace lamella::cli
