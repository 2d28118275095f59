#include "commands/SampleRun.h"

#include "PhasePicture.h"

#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <utility>

namespace lamella::cli
{

void tellDoubts(Session& session, const Sample& sample)
{
  for (const std::string& warning : sample.warnings)
    session.warn(warning);
}

vtkSmartPointer<vtkImageData> imageOf(Sample& sample, int refine, const std::vector<std::string>& more)
{
  const auto image =
    toImageData(refine > 1 ? lamella::refine(sample.image, refine)
                           : PhaseImage{ sample.image.lattice, std::move(sample.image.phase), sample.image.phases });
  if (sample.file != nullptr)
  {
    std::vector<std::string> arrays{ "grain", "axis", "tensor" };
    arrays.insert(arrays.end(), more.begin(), more.end());
    carryAlong(image, sample.file, sample.window, refine, arrays);
  }
  setFieldText(image, "pixel_size_source", sample.pixelSizeSource);
  if (sample.surfaceDoubt)
    setFieldNumbers(image, "surface_doubt", std::array{ *sample.surfaceDoubt * refine });
  setProvenance(image, sample.provenance);
  return image;
}

namespace
{

ImageSample imageSample(Session& session, Sample sample, int refine, const std::vector<std::string>& more)
{
  tellDoubts(session, sample);
  ImageSample result{ nullptr, sample.pixelSizeSource, sample.provenance };
  result.image = imageOf(sample, refine, more);
  result.image->GetExtent(result.extent.data());
  return result;
}

} // namespace

ImageSample loadImage(Session& session, const PictureOptions& picture, const SettingOptions& settings,
  const SampleCheck& check, int refine, const std::vector<std::string>& more)
{
  Sample sample = loadSample(picture, check);
  Session::checkInterrupt();
  settings.checkNames(sample.image.phases.names());
  return imageSample(session, std::move(sample), refine, more);
}

ImageSample loadGreys(
  Session& session, const PictureOptions& picture, const GreyBins& bins, const std::vector<std::string>& more)
{
  Sample sample = loadSample(picture, {}, bins);
  Session::checkInterrupt();
  return imageSample(session, std::move(sample), 1, more);
}

} // namespace lamella::cli
