#pragma once

#include "session/Session.h"

#include <vtkImageData.h>
#include <vtkMPIController.h>
#include <vtkNew.h>
#include <vtkTrivialProducer.h>

#include <array>
#include <functional>

class vtkAlgorithm;

/// How commands run a filter.
namespace lamella::cli
{

/// Tells of an event of an object as long as it lives.
class Observer
{
public:
  Observer(vtkObject* of, unsigned long event, std::function<void(void* data)> tell);
  ~Observer();
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;

private:
  vtkObject* of_;
  std::function<void(void*)> tell_;
  unsigned long tag_;
};

/// Runs it with a progress bar; Ctrl-C stops it.
/// @param what the bar's words where the filter has none of its own
/// @param update how to run it
/// @throws what the filter, or one before it, ended with; Cancelled
void runFilter(Session& session, vtkAlgorithm* filter, const char* what, const std::function<void()>& update);
/// The same with its Update().
void runFilter(Session& session, vtkAlgorithm* filter, const char* what);

/// The same on all ranks: rank 0 holds the sample, all of them work on it, and rank 0 holds the result.
/// @param image empty on the other ranks
/// @param extent of the whole sample, on every rank
template <class Filter>
void runFilterOnRanks(
  Session& session, Filter* filter, vtkImageData* image, std::array<int, 6> extent, const char* what)
{
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(image);
  producer->SetWholeExtent(extent.data());
  filter->SetInputConnection(producer->GetOutputPort());
  vtkNew<vtkMPIController> controller;
  if (session.ranks() > 1)
  {
    if (controller->GetCommunicator() == nullptr)
      controller->Initialize(nullptr, nullptr, 1); // MPI is the session's; once in a program
    filter->SetController(controller);
  }
  runFilter(session, filter, what,
    [&]
    {
      filter->UpdatePiece(session.rank(), session.ranks(), 0);
      filter->SetController(nullptr);
    });
}

/// Says what VTK classes have warned of. @param tell whether one is to be said; none: all are
void tellWarnings(Session& session, const std::function<bool(const std::string& warning)>& tell = {});

} // namespace lamella::cli
