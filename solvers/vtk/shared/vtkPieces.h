#pragma once

#include "lattice/Lattice.h"
#include "lbm/SteadyDiffusion.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

class vtkImageData;
class vtkInformation;
class vtkInformationVector;
class vtkMultiProcessController;

/// What sources and filters of ours share about images that several ranks hold in pieces.
namespace lamella
{

/// The ranks that work on one image together.
///
/// The pipeline decides: asked for as many pieces as the controller has processes (as ParaView and pvbatch do), all of
/// them work together on a communicator of their own; asked for anything else, this process works alone on the whole
/// image and MPI is never called.
class VTKLAMELLASOLVERSVTK_EXPORT Team
{
public:
  Team(vtkMultiProcessController* controller, vtkInformation* outputRequest);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Whether all processes of the controller would work together on this request.
  [[nodiscard]] static bool together(vtkMultiProcessController* controller, vtkInformation* outputRequest);

  [[nodiscard]] MPI_Comm comm() const noexcept { return comm_; } ///< MPI_COMM_SELF when alone
  [[nodiscard]] int rank() const noexcept { return rank_; }
  [[nodiscard]] int size() const noexcept { return size_; }

  /// Collective, in place; nothing to do when alone.
  void sum(std::span<double> values) const;
  void sum(std::span<std::int64_t> values) const;
  void maximum(std::span<std::int64_t> values) const;

  [[nodiscard]] bool any(bool value) const;

  /// Collective. The text of the lowest rank that has one, on every rank: ranks whose piece is empty know nothing of
  /// the image.
  [[nodiscard]] std::string share(std::string text, bool known) const;

  /// Collective. Runs `action`; when it throws a lamella::Error (or std::bad_alloc) on some rank, every rank throws an
  /// error of that kind with the words of the lowest such rank, so that none waits for another.
  void agree(const std::function<void()>& action) const;

private:
  MPI_Comm comm_ = MPI_COMM_SELF;
  int rank_ = 0;
  int size_ = 1;
};

/// The whole image behind a piece.
struct WholeImage
{
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
  Lattice lattice;
  std::array<double, 9> direction{ 1, 0, 0, 0, 1, 0, 0, 0, 1 }; ///< the image's axes in space, by rows
  lbm::Block held; ///< the piece on this rank, ghost and shared layers included; all zero when it is empty

  /// Where a place, in nodes from the image's first one, lies in space [m].
  [[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::array<double, 3> physical(const std::array<double, 3>& place) const;
};

/// Collective. Puts together what the pieces say: the whole extent is the box around all of them.
/// @throws InputError when all are empty or the spacing is not that of a lattice
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT WholeImage wholeImage(
  vtkImageData* piece, const Team& team, Voxels voxels = Voxels::Cubes);
/// The same of an image whose axes are those of space: solvers give vectors, and images of their own, along these.
/// @throws InputError for one that is turned, besides
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT WholeImage uprightImage(
  vtkImageData* piece, const Team& team, Voxels voxels = Voxels::Cubes);

/// What is asked of the output that is asked for, in any pass of the pipeline.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkInformation* requestedOutput(
  vtkInformation* request, vtkInformationVector* outputs);

/// RequestUpdateExtent of a filter that works on all of a poly data alone.
VTKLAMELLASOLVERSVTK_EXPORT void requestWhole(vtkInformation* input);

/// RequestInformation and RequestData of what gives all it has to the first piece, whatever number is asked for.
VTKLAMELLASOLVERSVTK_EXPORT void allInFirstPiece(vtkInformationVector* outputs);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT bool isFirstPiece(vtkInformationVector* outputs);

/// RequestUpdateExtent of a filter that needs the whole image: alone, the input's whole extent; together, whatever
/// piece the pipeline gave this rank.
VTKLAMELLASOLVERSVTK_EXPORT void requestInput(
  vtkInformation* input, vtkInformation* outputRequest, vtkMultiProcessController* controller);

/// RequestInformation of a source that knows its lattice.
VTKLAMELLASOLVERSVTK_EXPORT void announce(vtkInformation* output, const Lattice& lattice);

/// RequestData of a source that has its image whole: shares it, or copies out the extent that is asked for.
VTKLAMELLASOLVERSVTK_EXPORT void deliver(vtkImageData* whole, vtkInformation* outputRequest);

} // namespace lamella
