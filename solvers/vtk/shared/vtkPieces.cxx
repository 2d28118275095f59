#include "vtkPieces.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMPI.h"
#include "vtkMPICommunicator.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiProcessController.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string>

namespace lamella
{
namespace
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

MPI_Comm* communicatorOf(vtkMultiProcessController* controller)
{
  auto* const communicator =
    controller != nullptr ? vtkMPICommunicator::SafeDownCast(controller->GetCommunicator()) : nullptr;
  return communicator != nullptr ? communicator->GetMPIComm()->GetHandle() : nullptr;
}

/// Which of our errors it is, as a letter that can be sent.
char kindOf(const Error& error)
{
  return dynamic_cast<const InputError*>(&error) != nullptr   ? 'i'
    : dynamic_cast<const ParameterError*>(&error) != nullptr  ? 'p'
    : dynamic_cast<const NoPathError*>(&error) != nullptr     ? 'n'
    : dynamic_cast<const MemoryError*>(&error) != nullptr     ? 'm'
    : dynamic_cast<const DivergenceError*>(&error) != nullptr ? 'd'
                                                              : 'e';
}

[[noreturn]] void throwAs(char kind, const std::string& what, const std::string& hint)
{
  switch (kind)
  {
    case 'i':
      throw InputError(what, hint);
    case 'p':
      throw ParameterError(what, hint);
    case 'n':
      throw NoPathError(what, hint);
    case 'm':
      throw MemoryError(what, hint);
    case 'd':
      throw DivergenceError(what, hint);
    default:
      throw Error(what, hint);
  }
}

} // namespace

bool Team::together(vtkMultiProcessController* controller, vtkInformation* request)
{
  if (communicatorOf(controller) == nullptr || !request->Has(Pipeline::UPDATE_NUMBER_OF_PIECES()))
    return false;
  const int processes = controller->GetNumberOfProcesses();
  return processes > 1 && request->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) == processes;
}

Team::Team(vtkMultiProcessController* controller, vtkInformation* request)
{
  if (together(controller, request))
  {
    // Our messages must not meet ParaView's own on its communicator.
    MPI_Comm_dup(*communicatorOf(controller), &comm_);
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
  }
}

Team::~Team()
{
  if (size_ > 1)
    MPI_Comm_free(&comm_);
}

void Team::sum(std::span<double> values) const
{
  if (size_ > 1)
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_);
}

void Team::sum(std::span<std::int64_t> values) const
{
  if (size_ > 1)
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM, comm_);
}

void Team::maximum(std::span<std::int64_t> values) const
{
  if (size_ > 1)
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_MAX, comm_);
}

bool Team::any(bool value) const
{
  std::array<std::int64_t, 1> flag{ value ? 1 : 0 };
  this->maximum(flag);
  return flag[0] != 0;
}

std::string Team::share(std::string text, bool known) const
{
  if (size_ == 1)
    return text;
  int owner = known ? rank_ : size_;
  MPI_Allreduce(MPI_IN_PLACE, &owner, 1, MPI_INT, MPI_MIN, comm_);
  if (owner == size_)
    return text;
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, owner, comm_);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, owner, comm_);
  return text;
}

void Team::agree(const std::function<void()>& action) const
{
  std::string words; // kind, what + '\0' + hint
  try
  {
    action();
  }
  catch (const Error& error)
  {
    words = kindOf(error) + std::string(error.what()) + '\0' + error.hint();
  }
  catch (const std::bad_alloc&)
  {
    words = kindOf(MemoryError("", "")) + std::string("out of memory") + '\0' +
      "use a smaller window or a coarser lattice, or more ranks";
  }
  int failed = words.empty() ? size_ : rank_; // the lowest rank that failed
  if (size_ > 1)
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MIN, comm_);
  if (failed == size_)
    return;
  if (size_ > 1)
  {
    int length = static_cast<int>(words.size());
    MPI_Bcast(&length, 1, MPI_INT, failed, comm_);
    words.resize(static_cast<std::size_t>(length));
    MPI_Bcast(words.data(), length, MPI_CHAR, failed, comm_);
  }
  const std::size_t cut = words.find('\0');
  throwAs(words.front(), words.substr(1, cut - 1), words.substr(cut + 1));
}

WholeImage wholeImage(vtkImageData* piece, const Team& team, Voxels voxels)
{
  constexpr auto none = std::numeric_limits<std::int64_t>::lowest();
  const int* const extent = piece->GetExtent();
  const bool empty = piece->GetNumberOfPoints() == 0;
  std::array<std::int64_t, 6> bounds{ none, none, none, none, none, none }; // −low and high of each axis
  if (!empty)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      bounds[2 * axis] = -static_cast<std::int64_t>(extent[2 * axis]);
      bounds[2 * axis + 1] = extent[2 * axis + 1];
    }
  }
  team.maximum(bounds);
  if (bounds[0] == none)
    throw InputError("the image has no nodes", "check that the source before it worked");
  WholeImage whole;
  for (int axis = 0; axis < 3; ++axis)
  {
    whole.extent[2 * axis] = static_cast<int>(-bounds[2 * axis]);
    whole.extent[2 * axis + 1] = static_cast<int>(bounds[2 * axis + 1]);
  }

  // Geometry from the lowest rank that holds something: an empty piece may not know it.
  std::array<double, 15> geometry{};
  std::copy_n(piece->GetOrigin(), 3, geometry.begin());
  std::copy_n(piece->GetSpacing(), 3, geometry.begin() + 3);
  std::copy_n(piece->GetDirectionMatrix()->GetData(), 9, geometry.begin() + 6);
  if (team.size() > 1)
  {
    int owner = empty ? team.size() : team.rank();
    MPI_Allreduce(MPI_IN_PLACE, &owner, 1, MPI_INT, MPI_MIN, team.comm());
    MPI_Bcast(geometry.data(), 15, MPI_DOUBLE, owner, team.comm());
  }
  whole.lattice = latticeOf(whole.extent.data(), geometry.data(), geometry.data() + 3, voxels);
  std::copy_n(geometry.begin() + 6, 9, whole.direction.begin());
  whole.held = empty ? lbm::Block{} : blockOf(extent, whole.extent.data());
  return whole;
}

WholeImage uprightImage(vtkImageData* piece, const Team& team, Voxels voxels)
{
  WholeImage whole = wholeImage(piece, team, voxels);
  requireUpright(whole.direction.data());
  return whole;
}

std::array<double, 3> WholeImage::physical(const std::array<double, 3>& place) const
{
  std::array<double, 3> result{};
  for (std::size_t row = 0; row < 3; ++row)
  {
    result[row] =
      lattice.origin[row] - extent[2 * row] * lattice.spacingAlong(static_cast<int>(row)); // of the node of index 0
    for (std::size_t column = 0; column < 3; ++column)
      result[row] += direction[3 * row + column] * lattice.spacingAlong(static_cast<int>(column)) *
        (extent[2 * column] + place[column]);
  }
  return result;
}

vtkInformation* requestedOutput(vtkInformation* request, vtkInformationVector* outputs)
{
  const int port = request->Has(vtkExecutive::FROM_OUTPUT_PORT()) ? request->Get(vtkExecutive::FROM_OUTPUT_PORT()) : 0;
  return outputs->GetInformationObject(std::max(port, 0));
}

void requestWhole(vtkInformation* input)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

void allInFirstPiece(vtkInformationVector* outputs)
{
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
    outputs->GetInformationObject(port)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
}

bool isFirstPiece(vtkInformationVector* outputs)
{
  const int piece = outputs->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER());
  return piece <= 0;
}

void requestInput(vtkInformation* input, vtkInformation* request, vtkMultiProcessController* controller)
{
  if (Team::together(controller, request) || !input->Has(Pipeline::WHOLE_EXTENT()))
    return;
  int whole[6];
  input->Get(Pipeline::WHOLE_EXTENT(), whole);
  input->Set(Pipeline::UPDATE_EXTENT(), whole, 6);
}

void announce(vtkInformation* output, const Lattice& lattice)
{
  const std::array<int, 6> whole{ 0, static_cast<int>(lattice.size[0]) - 1, 0, static_cast<int>(lattice.size[1]) - 1, 0,
    static_cast<int>(lattice.size[2]) - 1 };
  const std::array<double, 3> spacing{ lattice.spacingAlong(0), lattice.spacingAlong(1), lattice.spacingAlong(2) };
  output->Set(Pipeline::WHOLE_EXTENT(), whole.data(), 6);
  output->Set(vtkDataObject::SPACING(), spacing.data(), 3);
  output->Set(vtkDataObject::ORIGIN(), lattice.origin.data(), 3);
  output->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  vtkDataObject::SetPointDataActiveScalarInfo(output, VTK_UNSIGNED_CHAR, 1);
}

void deliver(vtkImageData* whole, vtkInformation* request)
{
  auto* const output = vtkImageData::SafeDownCast(request->Get(vtkDataObject::DATA_OBJECT()));
  output->ShallowCopy(whole);
  int extent[6];
  request->Get(Pipeline::UPDATE_EXTENT(), extent);
  if (!std::equal(extent, extent + 6, whole->GetExtent()))
    output->Crop(extent);
}

} // namespace lamella
