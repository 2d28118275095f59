#pragma once

#include "Input.h"
#include "Session.h"

#include <string>
#include <vector>

/// What commands share that work on a sample and on what else its file holds of every node.
namespace lamella::cli
{

/// Says what is doubtful about the sample itself.
void tellDoubts(Session& session, const Sample& sample);

/// An array of every node.
struct NodeArray
{
  int components = 0;         ///< 0: the file has no such array
  std::vector<double> values; ///< node by node
};

/// A point array of a .vti in the sample's order: its window cut out, not refined.
[[nodiscard]] NodeArray sampleArray(const PictureOptions& picture, const Sample& sample, const char* name);

} // namespace lamella::cli
