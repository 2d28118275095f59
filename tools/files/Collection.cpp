#include "files/Collection.h"

#include <fmt/format.h>

namespace lamella::cli
{

std::string xmlText(const std::string& text)
{
  std::string xml;
  for (const char c : text)
    xml += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return xml;
}

std::string collectionText(const std::vector<std::string>& files, std::vector<double> times)
{
  std::string text = "<?xml version=\"1.0\"?>\n"
                     "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    if (i > 0 && times[i] <= times[i - 1])
      times[i] = times[i - 1] * (1 + 1e-9);
    text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", times[i], xmlText(files[i]));
  }
  return text + "  </Collection>\n</VTKFile>\n";
}

} // namespace lamella::cli
