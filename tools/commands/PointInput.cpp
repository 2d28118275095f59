#include "commands/PointInput.h"

#include "commands/SampleRun.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lamella::cli
{

PointSample loadPointSample(Session& session, const PictureOptions& picture, const SettingOptions& settings)
{
  Sample sample = loadSample(picture);
  Session::checkInterrupt();
  settings.checkNames(sample.image.phases.names());
  tellDoubts(session, sample);
  PointSample result;
  result.pixelSizeSource = sample.pixelSizeSource;
  result.provenance = sample.provenance;
  result.image = imageOf(sample);
  const bool directed = result.image->GetPointData()->HasArray("axis") != 0;
  for (const char* const word : { "transverse", "transverse-poisson", "shear" })
  {
    if (settings.given(word) && !settings.given("law") && !directed)
    {
      throw ParameterError(
        fmt::format("--{} of walls that have no direction: '{}' has no array 'axis'", word, picture.file),
        "leave it out, for isotropic walls have one modulus; lamella micrograph writes directions along the walls");
    }
  }
  return result;
}

} // namespace lamella::cli
