#pragma once

#include "BoxExchange.h"
#include "PhaseIds.h"
#include "vtkPieces.h"

#include "lattice/AxisNames.h"
#include "lattice/Phases.h"
#include "lbm/SteadyDiffusion.h"

#include "vtkDoubleArray.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

class vtkImageData;
class vtkInformation;

/// Helper of the diffusion solvers; not installed.
namespace lamella
{

/// An image of phases as a diffusion solver takes it: blocks of whole rows, whatever pieces the pipeline made.
struct DiffusionScene
{
  /// Collective. @param choice of the array of phases: vtkAlgorithm::GetInputArrayInformation()
  /// @throws Error on every rank; ParameterError for direction z of a picture
  /// @param levels as of phaseIds()
  /// @param gathered whether every rank gets the whole image, for what is not solved in blocks of its own lattice
  DiffusionScene(vtkImageData* input, vtkInformation* choice, int direction, const Team& team, bool gathered = false,
    Voxels voxels = Voxels::Cubes, const std::optional<GreyBins>& levels = {});
  DiffusionScene(const DiffusionScene&) = delete;
  DiffusionScene& operator=(const DiffusionScene&) = delete;

  WholeImage whole;
  PhaseIds phases;
  PhaseImage image; ///< where it is gathered; what follows is empty then, but for `nodes`
  Block block;      ///< of this rank
  std::optional<BoxExchange> outward;
  std::span<const std::uint8_t> ids; ///< of the block
  std::vector<std::int64_t> nodes;   ///< by id, in the whole image

  [[nodiscard]] const Lattice& lattice() const noexcept { return whole.lattice; }
  /// In a picture y leads from the top, which is the high face, to the bottom.
  [[nodiscard]] bool fromTop(int axis) const noexcept { return whole.lattice.dimension == 2 && axis == 1; }

  /// @param choice a value of vtkDiffusionAlgorithm::Lattices
  [[nodiscard]] lbm::Stencil stencil(int choice) const noexcept;

  /// Collective. An array of the piece from what a solver knows of its block.
  /// @param read fills the numbers of the block
  template <class Read>
  [[nodiscard]] vtkSmartPointer<vtkDoubleArray> array(const std::string& name, int components, Read&& read) const
  {
    return array(name, components, *outward, block, whole.held, read);
  }
  template <class Read>
  [[nodiscard]] static vtkSmartPointer<vtkDoubleArray> array(const std::string& name, int components,
    const BoxExchange& outward, const Block& block, const Block& held, Read&& read)
  {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(held.count());
    const std::span<double> values(array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()));
    if (outward.identity())
    {
      read(values);
    }
    else
    {
      std::vector<double> own(static_cast<std::size_t>(block.count() * components));
      read(std::span<double>(own));
      outward.run<double>(own, values, components);
    }
    return array;
  }

private:
  std::vector<std::uint8_t> moved_; ///< holds the ids where they are not the piece's
};

} // namespace lamella
