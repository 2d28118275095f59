#pragma once

#include "segmentation/Evidence.h"
#include "segmentation/Segmentation.h"

#include <vector>

namespace lamella::micrograph
{

/// What a user has to be told of a segmentation, the gravest first.
///
/// The limits stand between what whole tissue of every kind shows and what is wrong, with room on both sides; what they
/// were chosen on and how they do on other pictures is in docs/solvers/segmentation.md.
/// @param options what was asked for: the side that a user has chosen himself is not doubted
[[nodiscard]] std::vector<Remark> doubtsOf(
  const Evidence& evidence, const SegmentReport& report, const SegmentOptions& options, const Picture& picture);

/// Whether the lumens look like the cells of a tissue, so that words of wood are in place.
[[nodiscard]] bool looksLikeCells(const Evidence& evidence, const SegmentReport& report);

} // namespace lamella::micrograph
