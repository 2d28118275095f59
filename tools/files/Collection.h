#pragma once

#include <string>
#include <vector>

namespace lamella::cli
{

/// What ParaView reads as a time series.
/// @param times of the files, made to rise by 1e-9 of themselves where they do not
[[nodiscard]] std::string collectionText(const std::vector<std::string>& files, std::vector<double> times);

} // namespace lamella::cli
