#pragma once

#include "files/JsonReport.h"

#include <string>
#include <vector>

namespace lamella::reports
{

/// A report as rows of names and values: objects within as name.name, lists of numbers on one line, lists of objects as
/// tables. Keys in `without` are left out at the top.
[[nodiscard]] std::string jsonHtml(const cli::Json& json, const std::vector<std::string>& without);

/// A number, text, flag or nothing.
[[nodiscard]] std::string valueHtml(const cli::Json& value);

} // namespace lamella::reports
