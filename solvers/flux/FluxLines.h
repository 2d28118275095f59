#pragma once

#include "flux/FluxField.h"

#include "core/Communicator.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace lamella::flux
{

/// Streamlines of a flux field, each of which carries the same share of the flux that enters the box: they crowd where
/// much flows and are rare where little does.
///
/// Seeds lie on the inlet face: in two dimensions at equal steps of the flux that has entered, in three at the points
/// of a Fibonacci lattice mapped through the flux's distribution over the face. From there a line is followed from face
/// to face of the nodes' cells; inside a cell each component of the flux changes linearly between two opposite faces,
/// for which the path is known in closed form (Pollock 1988, Ground Water 26(6), 743-750). So no step size is needed,
/// and a line never enters what does not conduct.
///
/// A line that crosses from one rank's block to another's, or through a periodic side, goes on there as another piece
/// with the same number; numbers and paths do not depend on how many ranks there are.
struct LinePiece
{
  std::int64_t line = 0;
  std::vector<std::array<double, 3>> points; ///< in nodes: 0 is the first node, −½ the low face
  std::vector<double> flux;                  ///< magnitude, a point
  std::vector<double> value;                 ///< a point
  std::vector<double> length;                ///< from the line's begin, in spacings, a point
};

struct FluxLines
{
  std::vector<LinePiece> pieces;     ///< on this rank
  std::vector<double> length;        ///< of whole lines, in spacings; on every rank
  std::vector<std::uint8_t> arrived; ///< whether it reached the outlet; on every rank
  double inflow = 0;                 ///< flux that enters, summed over the nodes of the inlet face
};

/// Collective.
/// @param block    this rank's nodes
/// @param count    number of lines, ≥ 0
/// @param proceed  called now and then with the share done, between 0 and 1; false ends early with what there is
[[nodiscard]] FluxLines traceLines(const FluxField& field, const FluxSetting& setting, const lbm::Block& block,
  std::int64_t count, const Communicator& ranks, const std::function<bool(double)>& proceed);

/// Seeds on the inlet face in units of nodes: (u, v) with u along the first axis of the face and v along the second.
/// @param inflow flux into each node of the face, u fastest; nothing enters where it is not positive
/// @param size   nodes of the face along u and v (v: 1 in two dimensions)
[[nodiscard]] std::vector<std::array<double, 2>> seedInlet(
  std::span<const double> inflow, std::array<std::int64_t, 2> size, std::int64_t count);

} // namespace lamella::flux
