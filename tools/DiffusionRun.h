#pragma once

#include "Session.h"

#include "lattice/Phases.h"
#include "lbm/DiffusionStudy.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// The parts of `lamella diffusion` around the study itself: memory, ranks, paths.
namespace lamella::cli
{

inline constexpr const char* axisNames[3] = { "x", "y", "z" };

/// Gives every rank the picture of rank 0.
void share(const Session& session, PhaseImage& image);

/// The same of the axes of its nodes.
void share(const Session& session, std::vector<std::array<float, 2>>& axes, std::size_t nodes);

/// Brings the blocks of an array with `components` numbers a node together on rank 0 (`whole` there, empty elsewhere).
void gather(const Session& session, const Lattice& lattice, const Block& block, std::span<const double> part,
  std::span<double> whole, int components);

/// What decides how much memory a diffusion study takes.
struct DiffusionSize
{
  Lattice lattice;             ///< not refined
  std::int64_t conducting = 0; ///< nodes of it; as many as there must be, where the phases are not known yet
  lbm::Stencil stencil = lbm::Stencil::D2Q5;
  int refinement = 1;
  bool fields = false; ///< they are to be written as well
  int ranks = 1;
  int ranksOnMachine = 1;
};

/// Refuses what does not fit in memory: says how much it needs, how much there is, and which refinement would fit.
/// @throws MemoryError
void requireMemory(const DiffusionSize& size);

/// Refuses a direction without a conducting path, before any is solved; the hint names those that have one. One rank
/// asks for all.
/// @throws NoPathError
void requirePaths(const PhaseImage& image, std::span<const double> conductivity, const lbm::StudyOptions& options);

} // namespace lamella::cli
