#include "vtkSnapshot.h"

#include "Failures.h"
#include "Settings.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "core/PartFile.h"
#include "vtkClassMacros.h"

#include "Drawing.h"
#include "SnapshotOptions.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOffScreenWindows.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace rendering = lamella::rendering;

vtkStandardNewMacro(vtkSnapshot);
vtkPrintSettingsMacro(vtkSnapshot);

namespace
{

constexpr const char* PresetNames[] = { "auto", "phase", "temperature", "concentration", "flux", "grain", "pores",
  "stress", "scalar" };
constexpr const char* OverlayNames[] = { "auto", "none", "lines", "arrows", "isolines" };

std::string Text(const char* text)
{
  return text ? text : "";
}

template <std::size_t N>
int IndexOf(const char* const (&names)[N], const char* name)
{
  const auto* found = std::find(std::begin(names), std::end(names), std::string_view(name ? name : ""));
  return found == std::end(names) ? -1 : static_cast<int>(found - std::begin(names));
}

} // namespace

struct vtkSnapshot::Internals
{
  vtkSmartPointer<vtkDataObject> input;
  vtkSmartPointer<vtkPolyData> lines;
  vtkSmartPointer<vtkImageData> picture;
  rendering::SnapshotOptions options; // those settings that are text
  std::string provenance;
  bool provenanceIsSet = false;
  std::string errorMessage;
  std::string errorHint;
};

vtkSnapshot::vtkSnapshot()
  : Private(std::make_unique<Internals>())
{
}

vtkSnapshot::~vtkSnapshot() = default;

void vtkSnapshot::SetInputData(vtkDataObject* data)
{
  if (this->Private->input != data)
  {
    this->Private->input = data;
    this->Modified();
  }
}

vtkDataObject* vtkSnapshot::GetInputData()
{
  return this->Private->input;
}

bool vtkSnapshot::SetPresetByName(const char* name)
{
  const int index = IndexOf(PresetNames, name);
  if (index >= 0)
    this->SetPreset(index);
  return index >= 0;
}

const char* vtkSnapshot::GetPresetName(int preset)
{
  return PresetNames[std::clamp(preset, 0, static_cast<int>(std::size(PresetNames)) - 1)];
}

bool vtkSnapshot::SetOverlayByName(const char* name)
{
  const int index = IndexOf(OverlayNames, name);
  if (index >= 0)
    this->SetOverlay(index);
  return index >= 0;
}

// A setter and getter for each text.
#define vtkSnapshotTextMacro(Name, member)                                                                             \
  void vtkSnapshot::Set##Name(const char* text)                                                                        \
  {                                                                                                                    \
    if (this->Private->options.member != Text(text))                                                                   \
    {                                                                                                                  \
      this->Private->options.member = Text(text);                                                                      \
      this->Modified();                                                                                                \
    }                                                                                                                  \
  }                                                                                                                    \
  const char* vtkSnapshot::Get##Name()                                                                                 \
  {                                                                                                                    \
    return this->Private->options.member.c_str();                                                                      \
  }
vtkSnapshotTextMacro(ArrayName, arrayName) vtkSnapshotTextMacro(ColorMap, colorMap)
  vtkSnapshotTextMacro(OverlayArrayName, overlayArrayName) vtkSnapshotTextMacro(Title, title)
    vtkSnapshotTextMacro(LegendTitle, legendTitle) vtkSnapshotTextMacro(Unit, unit)
#undef vtkSnapshotTextMacro

      void vtkSnapshot::SetProvenance(const char* provenance)
{
  this->Private->provenance = Text(provenance);
  this->Private->provenanceIsSet = provenance != nullptr;
  this->Modified();
}

const char* vtkSnapshot::GetProvenance()
{
  return this->Private->provenance.c_str();
}

void vtkSnapshot::SetRange(double minimum, double maximum)
{
  this->Private->options.range = { minimum, maximum };
  this->Modified();
}

void vtkSnapshot::ResetRange()
{
  this->Private->options.range.reset();
  this->Modified();
}

bool vtkSnapshot::GetRangeIsSet()
{
  return this->Private->options.range.has_value();
}

void vtkSnapshot::SetPhaseColor(const char* phase, double red, double green, double blue)
{
  this->Private->options.phaseColors[Text(phase)] = { red, green, blue };
  this->Modified();
}

void vtkSnapshot::ClearPhaseColors()
{
  this->Private->options.phaseColors.clear();
  this->Modified();
}

void vtkSnapshot::SetOverlayLines(vtkPolyData* lines)
{
  if (this->Private->lines != lines)
  {
    this->Private->lines = lines;
    this->Modified();
  }
}

vtkPolyData* vtkSnapshot::GetOverlayLines()
{
  return this->Private->lines;
}

const char* vtkSnapshot::GetErrorMessage()
{
  return this->Private->errorMessage.c_str();
}

const char* vtkSnapshot::GetErrorHint()
{
  return this->Private->errorHint.c_str();
}

bool vtkSnapshot::Fail(const std::string& message, const std::string& hint)
{
  this->Private->errorMessage = message;
  this->Private->errorHint = hint;
  vtkErrorMacro(<< message << " (" << hint << ")");
  return false;
}

vtkImageData* vtkSnapshot::Draw()
{
  this->Private->errorMessage.clear();
  this->Private->errorHint.clear();
  this->Private->picture = nullptr;
  vtkDataObject* input = this->Private->input;
  auto* data = vtkDataSet::SafeDownCast(input);
  if (!data || data->GetNumberOfPoints() == 0)
  {
    this->Fail(!input ? "no data to draw were given"
        : !data       ? "data of the kind " + std::string(input->GetClassName()) + " cannot be drawn"
                      : "the data to draw are empty",
      "give a vtkImageData or a vtkPolyData");
    return nullptr;
  }
  auto* image = vtkImageData::SafeDownCast(data);
  auto* geometry = vtkPolyData::SafeDownCast(data);
  if (!image && !geometry)
  {
    this->Fail("data of the kind " + std::string(data->GetClassName()) + " cannot be drawn",
      "give a vtkImageData, or its surface as vtkPolyData");
    return nullptr;
  }
  if (!vtkOffScreenWindows::IsRequestKnown())
  {
    this->Fail(vtkOffScreenWindows::GetMessage(), "or leave the variable out");
    return nullptr;
  }
  const auto& range = this->Private->options.range;
  if (range && !(std::isfinite((*range)[0]) && std::isfinite((*range)[1]) && (*range)[0] < (*range)[1]))
  {
    this->Fail("the range " + std::to_string((*range)[0]) + " to " + std::to_string((*range)[1]) + " is empty",
      "give a finite minimum below a finite maximum");
    return nullptr;
  }
  rendering::SnapshotOptions options = this->Private->options;
  options.preset = this->Preset;
  options.component = this->Component;
  options.relativeFlux = this->RelativeFlux;
  options.overlay = this->Overlay;
  options.overlayCount = this->OverlayCount;
  options.overlayLines = this->Private->lines;
  options.showOutline = this->ShowOutline;
  options.size = { this->Size[0], this->Size[1] };
  options.fontScale = this->FontScale;
  options.background = { this->Background[0], this->Background[1], this->Background[2] };
  options.transparent = this->Transparent;
  options.showLegend = this->ShowLegend;
  options.showScaleBar = this->ShowScaleBar;
  options.azimuth = this->Azimuth;
  options.elevation = this->Elevation;
  options.opacity = this->Opacity;
  options.onlyRange = this->OnlyRange;
  options.untilEvent = this->UntilEvent;
  try
  {
    lamella::checkSettings(this);
    const bool flat =
      image && (image->GetDimensions()[0] == 1 || image->GetDimensions()[1] == 1 || image->GetDimensions()[2] == 1);
    const rendering::Drawing drawing = geometry ? rendering::DrawGeometry(geometry, options)
      : flat                                    ? rendering::DrawPicture(image, options)
                                                : rendering::DrawVolume(image, options);
    const vtkNew<vtkImageData> picture;
    drawing.canvas.CopyTo(picture, this->Transparent);
    this->Private->picture = picture;
    this->DataRectangle[0] = drawing.data.x;
    this->DataRectangle[1] = drawing.data.y;
    this->DataRectangle[2] = drawing.data.width;
    this->DataRectangle[3] = drawing.data.height;
    this->DrawnRange[0] = drawing.range[0];
    this->DrawnRange[1] = drawing.range[1];
  }
  catch (const lamella::Error& error)
  {
    this->Fail(error.what(), error.hint());
  }
  catch (const std::bad_alloc&)
  {
    const lamella::MemoryError error(
      "there is not enough memory for the picture", "draw a smaller one, or a part of the data");
    lamella::keepFailure(std::make_exception_ptr(error)); // its kind is known so
    this->Fail(error.what(), error.hint());
  }
  return this->Private->picture;
}

bool vtkSnapshot::Write(const char* path)
{
  namespace fs = std::filesystem;
  const fs::path target = Text(path);
  std::error_code error;
  this->Private->errorMessage.clear();
  this->Private->errorHint.clear();
  if (target.empty())
    return this->Fail("no file name was given for the picture", "give one that ends in .png");
  if (lamella::endingOf(target) != ".png")
  {
    return this->Fail(
      "pictures are written as PNG, not as '" + target.filename().string() + "'", "let the name end in .png");
  }
  const std::string name = std::string("'").append(target.string()).append("'");
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    return this->Fail("there is no folder '" + folder.string() + "'", "make it first, or write elsewhere");
  if (fs::is_directory(target, error))
    return this->Fail(name + " is a folder", "give the name of a file");
  if (!this->Overwrite && fs::exists(fs::symlink_status(target, error)))
    return this->Fail(name + " exists", "choose another name, or allow overwriting");
  if (access(folder.c_str(), W_OK) != 0)
  {
    return this->Fail(
      "the folder '" + folder.string() + "' cannot be written to", "write elsewhere, or change its permissions");
  }
  if (!this->Draw())
    return false;

  std::string provenance = this->Private->provenance;
  if (!this->Private->provenanceIsSet)
  {
    auto* array = vtkStringArray::SafeDownCast(this->Private->input->GetFieldData()->GetAbstractArray("provenance"));
    provenance = array && array->GetNumberOfValues() > 0 ? std::string(array->GetValue(0)) : "";
  }
  const vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(this->Private->picture);
  writer->WriteToMemoryOn();
  if (!provenance.empty())
    writer->AddText("provenance", provenance.c_str());
  writer->Write();
  vtkUnsignedCharArray* png = writer->GetResult();
  if (!png || png->GetNumberOfValues() == 0)
    return this->Fail("the picture cannot be turned into PNG", "draw a smaller one");

  lamella::PartFile part(target);
  int failure = part.error();
  if (failure == 0)
  {
    failure =
      part.write(std::as_bytes(std::span(png->GetPointer(0), static_cast<std::size_t>(png->GetNumberOfValues()))));
  }
  if (failure == 0)
  {
    failure =
      part.take(target, this->Overwrite ? lamella::PartFile::Existing::goes : lamella::PartFile::Existing::stays);
  }
  if (failure != 0)
  {
    return this->Fail("'" + target.string() + "' cannot be written: " + std::generic_category().message(failure),
      "nothing was written; free some room, or write elsewhere");
  }
  return true;
}
