#include "LongRun.h"

#include "vtkLatticeConversion.h"

#include "io/Checkpoint.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <system_error>

namespace lamella
{

InputMark::Content InputMark::contentOf(vtkImageData* image)
{
  Content content;
  if (image == nullptr)
    return content;
  image->GetExtent(content.extent.data());
  image->GetOrigin(content.origin.data());
  image->GetSpacing(content.spacing.data());
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, content.direction.begin());
  for (vtkFieldData* const data :
    std::initializer_list<vtkFieldData*>{ image->GetPointData(), image->GetCellData(), image->GetFieldData() })
  {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* const array = data->GetAbstractArray(i);
      content.arrays.emplace_back(array, array->GetMTime());
    }
  }
  return content;
}

void InputMark::take(vtkImageData* image)
{
  kept_ = vtkSmartPointer<vtkImageData>::New();
  if (image != nullptr)
    kept_->ShallowCopy(image);
  content_ = contentOf(image);
}

bool InputMark::same(vtkImageData* image) const
{
  return kept_ != nullptr && content_ == contentOf(image);
}

RunStart startOf(const std::string& continueFile, const std::string& checkpointFile, const char* beginning,
  vtkDataObject* input, const Team& team, io::CheckpointOptions& options)
{
  options.path = checkpointFile;
  options.provenance = fieldText(input, "provenance").value_or("");
  std::error_code ignored;
  const bool anew = !continueFile.empty() && io::sameFile(continueFile, checkpointFile) &&
    team.any(team.rank() == 0 && !std::filesystem::exists(continueFile, ignored));
  if (!anew)
    return { continueFile, {} };
  return { {}, "there was no checkpoint '" + continueFile + "' yet: the run began with " + beginning };
}

} // namespace lamella
