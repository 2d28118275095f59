#include "files/JsonReport.h"

#include "files/Record.h"

#include <cmath>

namespace lamella::cli
{

Json jsonNumber(double value)
{
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string dump(const Json& json)
{
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void printReport(Session& session, const CommonOptions& options, Json json, const io::Provenance& run,
  const std::function<std::string(const Json&)>& words)
{
  addRecord(json, run);
  session.print(options.json ? dump(json) : options.quiet ? "" : words(json));
}

} // namespace lamella::cli
