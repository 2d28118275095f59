#include "vtkPictureReader.h"

#include "PhasePicture.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"

#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <algorithm>

namespace
{

/// Node of the file that each node of the image lies in.
vtkSmartPointer<vtkIdList> nodesOfFile(
  const lamella::Lattice& image, const lamella::Lattice& file, const std::array<std::int64_t, 3>& first, int refinement)
{
  const std::int64_t deep = image.dimension == 3 ? refinement : 1;
  const auto nodes = vtkSmartPointer<vtkIdList>::New();
  nodes->SetNumberOfIds(image.count());
  vtkIdType node = 0;
  for (std::int64_t z = 0; z < image.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < image.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < image.size[0]; ++x)
      {
        nodes->SetId(node++, file.index(first[0] + x / refinement, first[1] + y / refinement, first[2] + z / deep));
      }
    }
  }
  return nodes;
}

/// What else a .vti holds of its nodes, and of itself where the image is the whole of it. A finer lattice gets what
/// belongs to the pixel as the phase does, its grain and the direction of its wall, and no fields, which were solved on
/// the coarser one.
void carryAlong(vtkImageData* image, const lamella::PhasePicture& picture, const lamella::PictureOptions& options)
{
  const lamella::Lattice file = lamella::latticeOf(picture.file);
  const auto first =
    options.window ? lamella::firstNode(file, *options.window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  const bool whole = !options.window && options.refine == 1;
  const auto nodes = whole ? nullptr : nodesOfFile(lamella::latticeOf(image), file, first, options.refine);
  vtkPointData* const held = picture.file->GetPointData();
  for (int i = 0; i < held->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = held->GetAbstractArray(i);
    const std::string name = array->GetName() != nullptr ? array->GetName() : "";
    const bool ofPixel = name == "grain" || name == "axis";
    if (name.empty() || image->GetPointData()->HasArray(name.c_str()) || (options.refine != 1 && !ofPixel))
    {
      continue;
    }
    if (whole)
    {
      image->GetPointData()->AddArray(array);
      continue;
    }
    const auto part = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
    part->SetName(name.c_str());
    part->SetNumberOfComponents(array->GetNumberOfComponents());
    part->CopyComponentNames(array);
    part->CopyInformation(array->GetInformation());
    part->SetNumberOfTuples(nodes->GetNumberOfIds());
    array->GetTuples(nodes, part);
    image->GetPointData()->AddArray(part);
  }
  vtkFieldData* const fields = picture.file->GetFieldData();
  for (int i = 0; whole && !options.read.pixelSize && i < fields->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = fields->GetAbstractArray(i);
    if (array->GetName() != nullptr && !image->GetFieldData()->HasArray(array->GetName()))
    {
      image->GetFieldData()->AddArray(array);
    }
  }
}

} // namespace

vtkStandardNewMacro(vtkPictureReader);

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
  if (greys == nullptr || *greys == '\0' || name == nullptr || *name == '\0')
  {
    return; // an empty row in a panel
  }
  const auto entry = this->PhaseOfGreys.find(greys);
  if (entry == this->PhaseOfGreys.end() || entry->second != name)
  {
    this->PhaseOfGreys[greys] = name;
    this->Modified();
  }
}

void vtkPictureReader::RemoveAllPhases()
{
  if (!this->PhaseOfGreys.empty())
  {
    this->PhaseOfGreys.clear();
    this->Modified();
  }
}

int vtkPictureReader::GetNumberOfPhases()
{
  return static_cast<int>(this->PhaseOfGreys.size());
}

lamella::PictureOptions vtkPictureReader::Options() const
{
  lamella::PictureOptions options;
  for (const auto& [greys, name] : this->PhaseOfGreys)
  {
    options.greys.add(greys, name);
  }
  if (this->OtherPhase != nullptr && *this->OtherPhase != '\0')
  {
    options.greys.other = this->OtherPhase;
  }
  if (this->Segment)
  {
    options.segment.emplace();
    options.segment->lumen = static_cast<lamella::micrograph::LumenSide>(this->Lumen);
    if (this->Threshold >= 0)
    {
      options.segment->threshold = this->Threshold;
    }
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
  {
    options.read.pixelSize = this->PixelSize;
  }
  if (std::any_of(this->RawSize, this->RawSize + 3, [](int value) { return value != 0; }))
  {
    options.read.rawSize.emplace();
    std::copy_n(this->RawSize, 3, options.read.rawSize->begin());
  }
  if (this->RawBits > 0)
  {
    options.read.rawBits = this->RawBits;
  }
  options.read.rawHeader = static_cast<std::uint64_t>(this->RawHeader);
  return options;
}

void vtkPictureReader::Load()
{
  const lamella::PictureOptions options = this->Options();
  lamella::PhasePicture picture = lamella::readPhases(this->FileName, options);
  this->Image = lamella::toImageData(std::move(picture.image));
  lamella::setFieldText(this->Image, "pixel_size_source", picture.pixelSizeSource);
  if (!picture.notes.empty())
  {
    lamella::setFieldTexts(this->Image, "segmentation", picture.notes);
  }

  for (const std::string& warning : picture.warnings)
  {
    vtkWarningMacro(<< warning);
  }

  nlohmann::json parameters{ { "refinement", this->Refinement } };
  if (this->Segment)
  {
    parameters["segment"] = true;
  }
  for (const auto& [greys, name] : this->PhaseOfGreys)
  {
    parameters["phases"][greys] = name;
  }
  if (options.greys.other)
  {
    parameters["other"] = *options.greys.other;
  }
  if (options.window)
  {
    parameters["window"] = this->Window;
  }
  if (options.read.pixelSize)
  {
    parameters["pixel_size"] = this->PixelSize;
  }
  lamella::beginProvenance(this->Image, "picture", parameters, {}, this->FileName);
  if (picture.file != nullptr && !options.segment)
  {
    carryAlong(this->Image, picture, options);
  }
}

bool vtkPictureReader::Read()
{
  if (this->Image != nullptr && this->ReadTime > this->GetMTime())
  {
    return true;
  }
  this->Image = nullptr;
  if (this->FileName == nullptr || *this->FileName == '\0')
  {
    vtkErrorMacro("no file is named\nhint: set FileName");
    return false;
  }
  try
  {
    this->Load();
  }
  catch (const lamella::Error& error)
  {
    this->Image = nullptr;
    vtkErrorMacro(<< error.what() << "\nhint: " << error.hint());
    return false;
  }
  catch (const std::exception& error)
  {
    this->Image = nullptr;
    vtkErrorMacro(<< error.what());
    return false;
  }
  this->ReadTime.Modified();
  return true;
}

int vtkPictureReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  if (this->FileName == nullptr || *this->FileName == '\0')
  {
    return 1; // a panel that has just been opened; an update says that no file is named
  }
  if (!this->Read())
  {
    return 0;
  }
  lamella::announce(outputVector->GetInformationObject(0), lamella::latticeOf(this->Image));
  return 1;
}

int vtkPictureReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  if (!this->Read())
  {
    return 0;
  }
  lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  return 1;
}

void vtkPictureReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto text = [](const char* string) { return string != nullptr ? string : "(none)"; };
  os << indent << "FileName: " << text(this->FileName) << "\n"
     << indent << "OtherPhase: " << text(this->OtherPhase) << "\n"
     << indent << "ArrayName: " << text(this->ArrayName) << "\n"
     << indent << "Refinement: " << this->Refinement << "\n"
     << indent << "Segment: " << this->Segment << "\n"
     << indent << "Lumen: " << this->Lumen << "\n"
     << indent << "Threshold: " << this->Threshold << "\n"
     << indent << "PixelSize: " << this->PixelSize << "\n"
     << indent << "RawBits: " << this->RawBits << "\n"
     << indent << "RawHeader: " << this->RawHeader << "\n";
  for (const auto& [greys, name] : this->PhaseOfGreys)
  {
    os << indent << "Phase of grey " << greys << ": " << name << "\n";
  }
}
