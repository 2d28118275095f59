#pragma once

#include "lbm/Backend.h"

#include <cstdint>
#include <memory>

namespace lamella::lbm
{

/// Does the lean solver take this lattice? Straight links (D2Q5, D3Q7), even sizes along periodic axes, parts of ranks
/// that can be halved.
[[nodiscard]] bool leanFits(const Problem& problem);
/// Of its arrays, the picture left out.
[[nodiscard]] std::uint64_t leanBytes(const Lattice& lattice);
/// And with pieces?
[[nodiscard]] bool piecesFit(const Problem& problem);

/// The steady system with the least memory: the picture where it is, one float a node, and coarse levels of blocks.
/// Plain multigrid cycles; after each the planes across the direction are balanced (PlaneBalance), and the energies of
/// the balanced fields, which fall like a geometric series, tell how much is left.
///
/// Every node conducts. Thin walls that insulate are too much for it: it says so at once, as a DivergenceError.
///
/// Memory: about 8.5 bytes a node, picture included.
[[nodiscard]] std::unique_ptr<Backend> makeLeanSystem(const Problem& problem);

/// The same with coarse levels of pieces of blocks (PieceMultigrid): for every contrast, and where phases do not
/// conduct.
///
/// Memory: 8 to 13 bytes a node, in noise up to 21; 12 more where single precision is too little.
///
/// @throws NoPathError when no cluster leads across
[[nodiscard]] std::unique_ptr<Backend> makePieceSystem(const Problem& problem);

} // namespace lamella::lbm
