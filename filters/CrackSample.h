#pragma once

#include "BondScene.h"
#include "CrackInput.h"

#include <cstdint>
#include <optional>
#include <vector>

class vtkImageData;
class vtkInformation;

/// Helpers of vtkCrackPath; not installed.
namespace lamella
{

/// What no unbroken bond joins to the rest of the sample.
struct CrackFragment
{
  std::int64_t nodes = 0;
  std::array<std::array<bool, 2>, 3> touches{}; ///< low and high side of each axis
};

struct CrackFragments
{
  std::vector<CrackFragment> list;          ///< the largest first
  std::vector<std::int32_t> ofPiece;        ///< number of each node of the piece, from 1; 0 in voids
  std::array<bool, 3> severed{};            ///< none reaches from side to side along this axis
  [[nodiscard]] std::int64_t nodes() const; ///< of all
};

/// The image of phases beside the broken bonds. All members are collective.
class CrackSample
{
public:
  /// @throws Error on every rank: as BondScene; an image of another lattice than the bonds
  CrackSample(
    vtkImageData* piece, vtkInformation* phase, vtkInformation* grain, const CrackInput& input, const Team& team);

  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return scene_->phases().names; }
  /// Phases of all nodes, on every rank.
  [[nodiscard]] std::vector<std::uint8_t> phases() const;
  /// Which of them are solid.
  [[nodiscard]] std::vector<std::uint8_t> solid(const std::vector<std::uint8_t>& phases) const;
  /// Three numbers a node of the whole image, on every rank; empty where the image has no such array.
  [[nodiscard]] std::vector<double> displacement(const std::string& name) const;
  /// Bonds are those of the image's model (notches, cut bonds over voids) or, where it tells none, of all solid nodes
  /// within the horizon.
  [[nodiscard]] CrackFragments fragments() const;

private:
  vtkImageData* piece_;
  const CrackInput& input_;
  const Team& team_;
  WholeImage whole_;
  std::optional<BondScene> scene_;
};

} // namespace lamella
