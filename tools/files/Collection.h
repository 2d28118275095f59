#pragma once

#include <string>
#include <vector>

namespace lamella::cli
{

/// A text as XML holds it, in elements and in attributes.
[[nodiscard]] std::string xmlText(const std::string& text);

/// What ParaView reads as a time series.
/// @param times of the files, made to rise by 1e-9 of themselves where they do not
[[nodiscard]] std::string collectionText(const std::vector<std::string>& files, std::vector<double> times);

} // namespace lamella::cli
