#include "vtkPictureReader.h"

#include "Attempt.h"
#include "PhasePicture.h"
#include "Settings.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"

#include <algorithm>

vtkStandardNewMacro(vtkPictureReader);
vtkPrintSettingsMacro(vtkPictureReader);

namespace
{

/// What a .vti holds of itself.
void carryFields(vtkImageData* image, vtkImageData* file)
{
  vtkFieldData* const fields = file->GetFieldData();
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = fields->GetAbstractArray(i);
    if (array->GetName() != nullptr && !image->GetFieldData()->HasArray(array->GetName()))
      image->GetFieldData()->AddArray(array);
  }
}

} // namespace

vtkPictureReader::vtkPictureReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkPictureReader::~vtkPictureReader()
{
  this->SetFileName(nullptr);
  this->SetOtherPhase(nullptr);
  this->SetArrayName(nullptr);
}

void vtkPictureReader::SetPhase(int grey, const char* name)
{
  this->SetPhase(std::to_string(grey).c_str(), name);
}

void vtkPictureReader::SetPhase(const char* greys, const char* name)
{
  if (name != nullptr && *name != '\0')
    lamella::setNamed(this, this->PhaseOfGreys, greys, std::string(name));
}

vtkRemoveAllMacro(vtkPictureReader, Phases, PhaseOfGreys);

int vtkPictureReader::GetNumberOfPhases()
{
  return static_cast<int>(this->PhaseOfGreys.size());
}

lamella::PictureOptions vtkPictureReader::GetOptions() const
{
  lamella::PictureOptions options;
  const auto given = [](auto value) { return value >= 0 ? std::optional(value) : std::nullopt; };
  for (const auto& [greys, name] : this->PhaseOfGreys)
    options.greys.add(greys, name);
  if (this->OtherPhase != nullptr && *this->OtherPhase != '\0')
    options.greys.other = this->OtherPhase;
  if (this->Segment)
  {
    lamella::micrograph::SegmentOptions& scan = options.segment.emplace();
    scan.lumen = static_cast<lamella::micrograph::LumenSide>(this->Lumen);
    scan.channel = static_cast<lamella::micrograph::Channel>(this->Channel);
    scan.graphics = !this->KeepGraphics;
    scan.background = given(this->Background);
    scan.smoothing = given(this->Smoothing);
    scan.threshold = given(this->Threshold);
    scan.smallestLumen = given(std::int64_t(this->SmallestLumen));
    scan.smallestWall = given(std::int64_t(this->SmallestWall));
    scan.opening = given(this->Opening);
    scan.rim = given(this->Rim);
    scan.raySlenderness = this->RaySlenderness;
    scan.grow = this->Grow;
  }
  if (std::any_of(this->Window, this->Window + 6, [](int value) { return value != 0; }))
  {
    options.window.emplace();
    std::copy_n(this->Window, 3, options.window->start.begin());
    std::copy_n(this->Window + 3, 3, options.window->size.begin());
  }
  options.refine = this->Refinement;
  options.array = this->ArrayName != nullptr ? this->ArrayName : "";
  if (this->PixelSize > 0)
    options.read.pixelSize = this->PixelSize;
  if (this->SliceDistance > 0)
    options.read.sliceDistance = this->SliceDistance;
  if (std::any_of(this->RawSize, this->RawSize + 3, [](int value) { return value != 0; }))
  {
    options.read.rawSize.emplace();
    std::copy_n(this->RawSize, 3, options.read.rawSize->begin());
  }
  if (this->RawBits > 0)
    options.read.rawBits = this->RawBits;
  options.read.rawHeader = static_cast<std::uint64_t>(this->RawHeader);
  return options;
}

void vtkPictureReader::Load()
{
  const lamella::PictureOptions options = this->GetOptions();
  lamella::PhasePicture picture = lamella::readPhases(this->FileName, options);
  this->Image = lamella::toImageData(std::move(picture.image));
  lamella::setFieldText(this->Image, "pixel_size_source", picture.pixelSizeSource);
  if (!picture.notes.empty())
    lamella::setFieldTexts(this->Image, "segmentation", picture.notes);
  if (picture.surfaceDoubt)
    lamella::setFieldNumbers(this->Image, "surface_doubt", std::array{ *picture.surfaceDoubt });

  for (const std::string& warning : picture.warnings)
    vtkWarningMacro(<< warning);

  nlohmann::json parameters = lamella::settingsAsJson(this);
  for (const auto& [greys, name] : this->PhaseOfGreys)
    parameters["phases"][greys] = name;
  if (options.greys.other)
    parameters["other"] = *options.greys.other;
  lamella::beginProvenance(this->Image, "picture", parameters, {}, this->FileName);
  if (picture.file != nullptr && !options.segment)
  {
    lamella::carryAlong(this->Image, picture.file, options.window, options.refine);
    if (!options.window && options.refine == 1 && !options.read.pixelSize && !options.read.sliceDistance)
      carryFields(this->Image, picture.file);
  }
}

bool vtkPictureReader::Read()
{
  if (this->Image != nullptr && this->ReadTime > this->GetMTime())
    return true;
  this->Image = nullptr;
  const auto load = [this]
  {
    if (this->FileName == nullptr || *this->FileName == '\0')
      throw lamella::ParameterError("no file is named", "set FileName");
    this->Load();
    this->ReadTime.Modified();
  };
  if (lamella::attempt(this, load) == lamella::Outcome::Done)
    return true;
  this->Image = nullptr;
  return false;
}

int vtkPictureReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  if (this->FileName == nullptr || *this->FileName == '\0')
    return 1; // a panel that has just been opened; an update says that no file is named
  if (!this->Read())
    return 0;
  lamella::announce(outputVector->GetInformationObject(0), lamella::latticeOf(this->Image, lamella::Voxels::Any));
  return 1;
}

int vtkPictureReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  if (!this->Read())
    return 0;
  lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  return 1;
}
