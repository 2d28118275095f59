#pragma once

#include "lattice/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// What phases conduct that conduct differently in different directions.
namespace lamella::lbm
{

/// A symmetric tensor in the lattice's axes, in VTK's order: XX, YY, ZZ, XY, YZ, XZ.
template <class Real>
using SymmetricTensor = std::array<Real, 6>;

/// The place of (a, b) among them.
[[nodiscard]] constexpr std::size_t tensorPlace(std::size_t a, std::size_t b) noexcept
{
  return a == b ? a : a + b == 1 ? 3 : a + b == 3 ? 4 : 5;
}

/// Principal values, the least first.
[[nodiscard]] std::array<double, 3> principalValues(const SymmetricTensor<double>& tensor);

/// Largest ratio of the principal values of one tensor: elements keep tensors in single precision, and beyond this
/// rounding decides what the least one is.
inline constexpr double mostPrincipal = 1e6;

/// Principal values of a tensor that a material can have. In a picture the values of the third axis do not count.
/// @param of said of one that it cannot, such as "of phase 'wall'"
/// @throws ParameterError: not finite, not positive definite, not plausible(), principal values more than mostPrincipal
/// apart, or the third axis of a picture coupled with the others
std::array<double, 3> requireTensor(
  const SymmetricTensor<double>& tensor, int dimension, const std::function<std::string()>& of);

/// What a picture's phases conduct along an axis of their own and across it, and where that axis points; or tensors of
/// any kind, by phase or by node.
struct DirectedDiffusivity
{
  std::vector<double> along;  ///< one a phase id, ≥ 0
  std::vector<double> across; ///< one a phase id, ≥ 0; as along: the same in every direction
  std::vector<std::array<float, 3>>
    axis{}; ///< one a node, of any length and either sign; 0: none. Empty: none is needed

  /// Where a phase's conductivity is from, one a phase id; empty: all are Axial.
  enum class Source : std::uint8_t
  {
    Axial, ///< along and across
    Phase, ///< `ofPhase`
    Node   ///< `ofNode`
  };
  std::vector<Source> source{};
  std::vector<SymmetricTensor<double>> ofPhase{}; ///< one a phase id; empty where no phase has one
  std::vector<SymmetricTensor<float>> ofNode{};   ///< one a node; empty where no phase's nodes have their own
  /// The least principal value of phases with tensors; `along` and `across` are then both the largest one. Made by
  /// takeTensors().
  std::vector<double> least{};

  [[nodiscard]] Source sourceOf(std::size_t id) const noexcept { return source.empty() ? Source::Axial : source[id]; }
  /// Do some phases have tensors, of their own or of their nodes?
  [[nodiscard]] bool hasTensors() const noexcept;
  /// Is there a phase that goes by its axis?
  [[nodiscard]] bool hasAxes() const noexcept;

  /// The larger one of each phase, which says what conducts (the diffusivities of SteadyDiffusion), and the smaller.
  [[nodiscard]] std::vector<double> larger() const;
  [[nodiscard]] std::vector<double> smaller() const;

  /// The mean tensor of each phase with tensors, of those of its nodes; NaN of others.
  [[nodiscard]] std::vector<SymmetricTensor<double>> means(std::span<const std::uint8_t> phase) const;

  /// Checks the tensors and notes the largest and least principal values of the phases that have any.
  /// @param phase of the nodes that `ofNode` is of, all of the lattice
  /// @throws ParameterError as requireTensor(): which phase or voxel
  void takeTensors(const Lattice& lattice, std::span<const std::uint8_t> phase);
};

} // namespace lamella::lbm
