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
  {
    if (take_)
    {
      vtkNew<vtkCallbackCommand> command;
      command->SetClientData(this);
      command->SetCallback([](vtkObject*, unsigned long, void* self, void* state)
        { static_cast<StepWatch*>(self)->hand(static_cast<vtkDataObject*>(state)); });
      tag_ = filter_->AddObserver(vtkSampleAlgorithm::STEP_EVENT, command);
    }
  }
  ~StepWatch()
  {
    if (take_)
      filter_->RemoveObserver(tag_);
  }
  StepWatch(const StepWatch&) = delete;
  StepWatch& operator=(const StepWatch&) = delete;

  void rethrow() const
  {
    if (failed_)
      std::rethrow_exception(failed_);
  }

private:
  void hand(vtkDataObject* state)
  {
    if (failed_)
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
  unsigned long tag_ = 0;
  std::exception_ptr failed_;
};

} // namespace

void runFilter(Session& session, vtkAlgorithm* filter, const char* what, const std::function<void()>& update)
{
  struct Client
  {
    Session& session;
    const char* what;
    bool stopped = false;
  } client{ session, what };
  vtkNew<vtkCallbackCommand> progress;
  progress->SetClientData(&client);
  progress->SetCallback(
    [](vtkObject* caller, unsigned long, void* data, void*)
    {
      auto* const algorithm = static_cast<vtkAlgorithm*>(caller);
      auto* const c = static_cast<Client*>(data);
      const char* const words = algorithm->GetProgressText();
      if (!c->session.progress(algorithm->GetProgress(), words != nullptr ? words : c->what))
      {
        c->stopped = true;
        algorithm->SetAbortExecute(1);
      }
    });
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, progress);
  const StepWatch steps(session, filter);
  (void)VtkMessages::takeErrors();
  (void)takeFailure();
  update();
  filter->RemoveObserver(tag);
  session.endProgress();
  steps.rethrow();
  Session::checkInterrupt();
  if (client.stopped) // by the run that this one is part of
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
