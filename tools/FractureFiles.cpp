#include "FractureFiles.h"

#include "GridFile.h"
#include "Input.h"
#include "Session.h"

#include "vtkBondFracture.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

#include <filesystem>

namespace lamella::cli
{

StateFiles::StateFiles(const std::string& name, std::size_t states, bool overwrite)
{
  if (name.empty())
  {
    return;
  }
  if (!isVtkImage(name))
  {
    throw ParameterError("-o '" + name + "': the fields are written as .vti",
      "end the name in .vti; broken bonds go to --broken FILE.vtp, the curve to --curve FILE.csv");
  }
  if (states == 1)
  {
    files_.emplace_back(name, overwrite);
    return;
  }
  for (std::size_t i = 0; i < states; ++i)
  {
    files_.emplace_back(withSuffix(name, fmt::format("_{:03}", i)), overwrite);
  }
  collection_.emplace_back(std::filesystem::path(name).replace_extension(".pvd"), overwrite);
}

void StateFiles::needs(std::uint64_t bytes) const
{
  if (!files_.empty())
  {
    files_.front().needs(bytes * files_.size());
  }
}

std::vector<std::string> StateFiles::write(vtkBondFracture* filter, const std::string& provenance)
{
  std::vector<std::string> names;
  std::vector<double> times;
  for (int i = 0; !files_.empty() && i < filter->GetNumberOfStates(); ++i)
  {
    vtkImageData* const image = filter->GetStateImage(i);
    const OutputFile& file = files_.at(static_cast<std::size_t>(i));
    setProvenance(image, provenance);
    writeGrid(image, file);
    names.push_back(file.path().string());
    times.push_back(fieldNumbers(image, "strain").at(0));
    Session::checkInterrupt();
  }
  if (!collection_.empty())
  {
    std::vector<std::string> beside;
    for (const std::string& name : names)
    {
      beside.push_back(std::filesystem::path(name).filename().string());
    }
    collection_.front().write(collectionText(beside, times));
    names.push_back(collection_.front().path().string());
  }
  written_ = times.size();
  return names;
}

void StateFiles::commit()
{
  for (std::size_t i = 0; i < written_; ++i)
  {
    files_[i].commit();
  }
  for (OutputFile& file : collection_)
  {
    file.commit();
  }
}

std::string collectionText(const std::vector<std::string>& files, std::vector<double> times)
{
  std::string text = "<?xml version=\"1.0\"?>\n"
                     "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    if (i > 0 && times[i] <= times[i - 1])
    {
      times[i] = times[i - 1] * (1 + 1e-9);
    }
    std::string name;
    for (const char c : files[i])
    {
      name += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
    }
    text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", times[i], name);
  }
  return text + "  </Collection>\n</VTKFile>\n";
}

} // namespace lamella::cli
