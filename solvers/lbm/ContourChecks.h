#pragma once

#include "lbm/ContourDiffusion.h"
#include "lbm/StudyChecks.h"

#include <cstdint>
#include <span>
#include <string>

/// What is asked before a study of diffusion through outlines begins, how far it is, and what is told when it has
/// ended.
namespace lamella::lbm
{

/// What the finest lattice takes, and how fine one may become.
struct ContourBudget
{
  double bytesPerNode = 0;
  double available = 0;       ///< memory that is free [bytes]
  std::int64_t mostNodes = 0; ///< of a lattice for a target's sake: half of that
};
/// @param lamella walls have a phase more, which is drawn anew on each lattice
/// @throws MemoryError where the lattice of this spacing [m] does not fit
[[nodiscard]] ContourBudget contourBudget(const micrograph::ContourSet& contours, double spacing, bool lamella);

/// What a target error will take, for people.
[[nodiscard]] std::string text(const ContourPlan& plan, const ContourBudget& budget);

/// Why a target error was not reached, and what to do about it; empty where it was.
/// @param target > 0
[[nodiscard]] Shortfall shortfall(std::span<const ContourAnswer> answers, double target);
/// The same as a word.
[[nodiscard]] Target targetOf(std::span<const ContourAnswer> answers, double target);

/// The largest error of this kind that is known, else NaN.
[[nodiscard]] double worst(std::span<const ContourAnswer> answers, double ContourAnswer::*kind);

/// How far a study is, from the shares that its solves tell, each of which counts from 0: the finest lattice takes four
/// times as long as each before. How many lattices a target takes nobody knows: each of these counts from 0 to 1.
class ContourProgress
{
public:
  explicit ContourProgress(const ContourStudyOptions& options);
  [[nodiscard]] double operator()(double share);

private:
  [[nodiscard]] double weight(std::size_t solve) const;

  std::size_t axes_;
  std::size_t coarse_; ///< solves before those on the finest lattice
  std::size_t begun_ = 0;
  double before_ = 0;
};

} // namespace lamella::lbm
