#pragma once

#include "lbm/DiffusionStudy.h"

#include <cstdint>
#include <span>
#include <string>

/// What is asked before a study of diffusion begins, and told of it when it has ended.
namespace lamella::lbm
{

/// What decides how much memory a study takes.
struct StudySize
{
  Lattice lattice;             ///< not refined
  std::int64_t conducting = 0; ///< nodes of it; as many as there must be, where the phases are not known yet
  Stencil stencil = Stencil::D2Q5;
  int refinement = 1;
  bool fields = false;    ///< they are handed out as well
  bool membranes = false; ///< each node then has an id of its own for its part of them
  int ranks = 1;
  int ranksOnMachine = 1;
};

/// Refuses what does not fit in memory: says how much it needs, how much there is, and which refinement would fit.
/// @throws MemoryError
void requireMemory(const StudySize& size);

/// Memory and time of a study of many nodes, for people, before it begins; empty for a smaller one. With the method
/// that needs the least memory, as benchmarks/LeanDiffusion.cpp measured it.
[[nodiscard]] std::string plan(const StudySize& size, int solves, int threads);

/// Refuses directions without a conducting path, before any is solved; the hint names those that have one. Collective.
/// @throws NoPathError
void requirePaths(SteadyDiffusion& solver, std::span<const int> axes, int dimension);

/// "reached", "picture too coarse", "memory short"; "none" where there was no target.
[[nodiscard]] const char* name(Target target) noexcept;

/// What a target error will take, for people.
[[nodiscard]] std::string text(const TargetPlan& plan);

/// Why a target error was not reached, and what to do about it; empty where it was.
struct Shortfall
{
  std::string message;
  std::string hint;
};
/// @param outlines whether outlines through the pixels are a way out: a picture of two phases
[[nodiscard]] Shortfall shortfall(std::span<const DiffusionAnswer> answers, double target, bool outlines);

/// The largest error of this kind that is known, else NaN.
[[nodiscard]] double worst(std::span<const DiffusionAnswer> answers, double ErrorEstimate::*kind);

} // namespace lamella::lbm
