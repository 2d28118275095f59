#pragma once

#include "convert/Volume.h"

#include <optional>
#include <string>
#include <vector>

/// XDMF 3: words in XML about the arrays of HDF5 files, for programs that read no VTKHDF.
namespace lamella::cli
{

/// The grid of an image whose values lie in a VTKHDF file beside it. @throws InputError for axes that are not those of
/// space: a uniform grid of XDMF has none else
[[nodiscard]] std::string xdmfGrid(Volume& volume, const std::string& file, std::optional<double> time);

/// The whole file: of several steps a collection in time.
[[nodiscard]] std::string xdmfText(const std::vector<std::string>& grids);

} // namespace lamella::cli
