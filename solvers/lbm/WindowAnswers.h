#pragma once

#include "lattice/SubWindows.h"
#include "lbm/DiffusionStudy.h"

#include <functional>
#include <span>
#include <vector>

/// The window errors of a study's answers: what all kinds of pictures have in common.
namespace lamella::lbm
{

/// Mean and scatter of several pictures' values, of one or more.
void summarise(RefinementStep& step, std::span<const double> values);

/// Values of a window, by answer, 0 where nothing leads across, adding to the nodes, iterations and seconds of the
/// answers' steps.
using WindowSolve = std::function<std::vector<double>(const SubWindow& window, std::span<RefinementStep> steps)>;

/// Cuts the picture into halves and thirds, solves each and gives the answers, whose results are there, their window
/// errors and steps; of a picture that is too small to be cut none.
/// @param options sides and refinement of the picture's own solves
void addWindowErrors(
  std::vector<DiffusionAnswer>& answers, const Lattice& lattice, const StudyOptions& options, const WindowSolve& solve);

} // namespace lamella::lbm
