#pragma once

#include "reports/Folder.h"

#include <string>
#include <vector>

namespace lamella::reports
{

/// Where results come from: a row a record, with the files that carry it, and below it those that its inputs were made
/// from. Empty where there is none.
/// @param records provenance (io/Provenance.h) by file; what is no object is left out
[[nodiscard]] std::string recordsHtml(const std::vector<JsonFile>& records);

} // namespace lamella::reports
