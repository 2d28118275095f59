#pragma once

#include "PlaneField.h"

#include <span>
#include <vector>

/// Lines on a picture of nx × ny pixels. Positions are in pixels: pixel (i, j) covers [i, i + 1] × [j, j + 1].
namespace lamella::rendering
{

/// Lines along a flux that has no sources, such that every two neighbours carry the same share, 1/count, of all that
/// flows: contours of its stream function. Lines crowd where much flows and are rare where little does.
///
/// The stream function is summed along the lines across the mean flow; what each may be shifted by follows from the
/// other component in the mean. Exact for the fluxes of cell-centred finite volumes; O(nx ny).
///
/// @returns nothing when the field has sources (the two components do not agree within a quarter) or does not flow
[[nodiscard]] std::vector<Polyline> EqualFluxLines(const PlaneField& field, int count);

/// Lines along any field, no two closer than `separation` pixels (Jobard and Lefer 1997); none where the field is
/// weaker than a hundredth of its mean.
[[nodiscard]] std::vector<Polyline> EvenlySpacedLines(const PlaneField& field, double separation);

struct Arrow
{
  Point2 tail;
  Point2 tip;
};

/// One arrow for each block of `separation` × `separation` pixels: the block's mean vector, centred in the block, the
/// longest 0.9 blocks long; vectors shorter than an eighth of it are left out.
[[nodiscard]] std::vector<Arrow> BlockArrows(const PlaneField& field, double separation);

/// The border between pixels where `inside` holds and those where it does not, smoothed by a pixel.
[[nodiscard]] std::vector<Polyline> Outline(const std::vector<bool>& inside, int nx, int ny);

/// Turns a picture's lines of level into polylines; `values` stand at (x0 + i, y0 + j).
[[nodiscard]] std::vector<Polyline> Contours(
  std::span<const float> values, int nx, int ny, Point2 origin, std::span<const double> levels);

/// Points every `step` pixels, each the mean of its surroundings along the line with standard deviation `sigma` pixels;
/// the ends stay.
[[nodiscard]] Polyline Smooth(const Polyline& line, double step, double sigma);

} // namespace lamella::rendering
