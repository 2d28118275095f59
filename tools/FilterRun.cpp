#include "FilterRun.h"

#include "GridFile.h"

#include "lattice/Error.h"
#include "vtkSampleAlgorithm.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>

namespace lamella::cli
{

void runFilter(Session& session, vtkAlgorithm* filter, const char* what, const std::function<void()>& update)
{
  struct Client
  {
    Session& session;
    const char* what;
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
        algorithm->SetAbortExecute(1);
      }
    });
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, progress);
  (void)VtkMessages::takeErrors();
  update();
  filter->RemoveObserver(tag);
  session.endProgress();
  Session::checkInterrupt();
}

void runFilter(Session& session, vtkAlgorithm* filter, const char* what)
{
  runFilter(session, filter, what, [filter] { filter->Update(); });
}

void throwFailure(int failure)
try
{
  throwVtkErrors("");
}
catch (const InputError& error)
{
  switch (failure)
  {
    case vtkSampleAlgorithm::PARAMETER_FAILURE:
      throw ParameterError(error.what(), error.hint());
    case vtkSampleAlgorithm::NO_PATH_FAILURE:
      throw NoPathError(error.what(), error.hint());
    case vtkSampleAlgorithm::MEMORY_FAILURE:
      throw MemoryError(error.what(), error.hint());
    case vtkSampleAlgorithm::DIVERGENCE_FAILURE:
      throw DivergenceError(error.what(), error.hint());
    default:
      throw;
  }
}

void tellWarnings(Session& session)
{
  for (const std::string& warning : VtkMessages::takeWarnings())
  {
    session.warn(warning);
  }
}

} // namespace lamella::cli
