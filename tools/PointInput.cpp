#include "PointInput.h"

#include "SampleRun.h"

#include "lattice/Error.h"
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
  const NodeArray directions = sampleArray(picture, sample, "axis");
  for (const char* const word : { "transverse", "transverse-poisson", "shear" })
  {
    if (settings.given(word) && !settings.given("law") && directions.components == 0)
    {
      throw ParameterError(
        fmt::format("--{} of walls that have no direction: '{}' has no array 'axis'", word, picture.file),
        "leave it out, for isotropic walls have one modulus; lamella micrograph writes directions along the walls");
    }
  }
  PointSample result;
  result.pixelSizeSource = sample.pixelSizeSource;
  result.provenance = sample.provenance;
  result.image = toImageData(std::move(sample.image));
  if (directions.components > 0)
  {
    vtkNew<vtkFloatArray> axis;
    axis->SetName("axis");
    axis->SetNumberOfComponents(directions.components);
    axis->SetNumberOfTuples(result.image->GetNumberOfPoints());
    std::transform(directions.values.begin(), directions.values.end(), axis->GetPointer(0),
      [](double value) { return static_cast<float>(value); });
    result.image->GetPointData()->AddArray(axis);
  }
  setFieldText(result.image, "pixel_size_source", result.pixelSizeSource);
  setProvenance(result.image, result.provenance);
  return result;
}

} // namespace lamella::cli
