#pragma once

#include "vtkPieces.h"

#include "pores/PoreLabelling.h"

#include <span>

class vtkTable;

/// Helpers of vtkPoreFloodFill; not installed.
namespace lamella
{

/// What a node of the lattice is called: "pixels" or "voxels".
[[nodiscard]] const char* nodesOf(const Lattice& lattice);

/// One row a pore, in the order of the labels.
void fillPores(vtkTable* table, std::span<const pores::Pore> pores, const WholeImage& whole);

/// One row a class of sizes.
void fillSizeDistribution(vtkTable* table, std::span<const pores::Pore> pores, const Lattice& lattice);

} // namespace lamella
