#include "scenes/Movie.h"

#include "session/OutputFile.h"

#include "core/Error.h"

#include <vtkImageConstantPad.h>
#include <vtkImageData.h>
#include <vtkImageExtractComponents.h>
#include <vtkNew.h>
#include <vtkOggTheoraWriter.h>
#include <vtkPNGReader.h>

#include <array>

namespace lamella::cli
{

void writeMovie(std::span<const std::filesystem::path> pictures, const std::filesystem::path& movie)
{
  if (pictures.empty())
    return;
  OutputFile file(movie, true);
  vtkNew<vtkPNGReader> reader;
  vtkNew<vtkImageExtractComponents> colours; // Theora has no transparency
  colours->SetInputConnection(reader->GetOutputPort());
  colours->SetComponents(0, 1, 2);
  vtkNew<vtkImageConstantPad> even; // and wants even sizes
  even->SetInputConnection(colours->GetOutputPort());
  even->SetConstant(255);
  vtkNew<vtkOggTheoraWriter> writer;
  writer->SetInputConnection(even->GetOutputPort());
  writer->SetFileName(file.temporary().c_str());
  writer->SetRate(10);
  writer->SetQuality(2);
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, 0 };
  for (const std::filesystem::path& picture : pictures)
  {
    reader->SetFileName(picture.c_str());
    colours->Update();
    std::array<int, 6> own{};
    colours->GetOutput()->GetExtent(own.data());
    if (extent[1] < 0)
    {
      extent = { 0, own[1] | 1, 0, own[3] | 1, 0, 0 };
      even->SetOutputWholeExtent(extent.data());
      even->Update();
      writer->Start();
    }
    if ((own[1] | 1) != extent[1] || (own[3] | 1) != extent[3])
    {
      throw InputError(
        "the pictures of '" + movie.filename().string() + "' differ in size", "give them one: size = [800, 600]");
    }
    writer->Write();
    if (writer->GetError() != 0)
      file.failed();
  }
  writer->End();
  file.commit();
}

} // namespace lamella::cli
