#pragma once

#include "segmentation/Rims.h"

#include <opencv2/core.hpp>

namespace lamella::micrograph
{

/// What toHalfHeight() found.
struct HalfHeight
{
  double moved = 0; ///< [pixels]
  double blur = 0;  ///< [pixels]
};

/// Moves the outline of every lumen to half the height of its own edge, between the lumen's grey and that of its own
/// wall just beyond the edge. Walls are stained differently from cell to cell, so that one threshold for all draws
/// lumens with pale walls too large. And Otsu's threshold is the middle between the means of two classes: where walls
/// are thin much of their class is blurred edge, where the middle lamella is dark much of it is not beside an edge.
///
/// How far an edge is blurred, a Gaussian of standard deviation s, follows from its lumen's side of the mean grey over
/// the distance from the outlines, where no other layer is near; it is blurred alike on both sides, and 2.33 s beyond
/// its middle is wall. Such a blur shrinks what is at half height by s²/2 times the curvature, π s² in all for a closed
/// lumen; the level of a lumen of perimeter P is lowered for that by s/(2√(2π)) · 2π/P of its contrast.
/// @param bright CV_32F, lumens brighter than walls
/// @param reach how far beside the outlines to look [pixels]
/// @return how far the outlines moved outwards in the mean [pixels], and s; zeros where there is too little to tell
HalfHeight toHalfHeight(cv::Mat& lumen, const EdgeDistance& edge, const cv::Mat& bright, double reach);

/// s alone: how far edges are blurred, what the picture was smoothed by included [pixels]; 0 where there is too little
/// to tell.
double edgeBlur(const EdgeDistance& edge, const cv::Mat& bright, double reach);

} // namespace lamella::micrograph
