#include "vtkFileConverter.h"

#include "Attempt.h"
#include "convert/Conversion.h"
#include "files/GridFile.h"
#include "session/Session.h"

#include "core/Error.h"
#include "io/Provenance.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace
{

namespace cli = lamella::cli;

/// The command line that does the same.
std::string commandOf(const cli::ConversionWords& words)
{
  std::vector<std::string> line{ "lamella", "convert", words.raw.picture.file, "-o", words.output };
  const auto add = [&](const char* option, const std::string& value)
  {
    if (!value.empty())
      line.insert(line.end(), { option, value });
  };
  for (const std::string& name : words.arrays)
    add("--array", name);
  for (const std::string& name : words.phases)
    add("--phase", name);
  add("--smooth", words.smoothing > 0 ? std::to_string(words.smoothing) : "");
  add("--step", words.step);
  add("--type", words.type);
  add("--range", words.range);
  add("--pixel-size", words.raw.picture.pixelSize);
  add("--raw-size", words.raw.picture.rawSize);
  add("--raw-type", words.raw.type);
  add("--raw-order", words.raw.order);
  add("--raw-header", words.raw.picture.rawHeader > 0 ? std::to_string(words.raw.picture.rawHeader) : "");
  if (words.lossy)
    line.emplace_back("--lossy");
  return lamella::io::quoteCommand(line);
}

void append(vtkStringArray* to, const std::vector<std::string>& texts)
{
  for (const std::string& text : texts)
    to->InsertNextValue(text);
}

} // namespace

vtkStandardNewMacro(vtkFileConverter);

vtkFileConverter::vtkFileConverter()
  : Files(vtkSmartPointer<vtkStringArray>::New())
  , Times(vtkSmartPointer<vtkDoubleArray>::New())
  , Warnings(vtkSmartPointer<vtkStringArray>::New())
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(0);
}

vtkFileConverter::~vtkFileConverter() = default;

void vtkFileConverter::Put(std::string& word, const std::string& value)
{
  if (word != value)
  {
    word = value;
    this->Modified();
  }
}

void vtkFileConverter::SetInputData(vtkDataObject* data)
{
  if (data != this->Input)
  {
    this->Input = data;
    this->Modified();
  }
}

vtkDataObject* vtkFileConverter::GetInputData()
{
  return this->Input;
}

vtkDataObject* vtkFileConverter::GetOutput()
{
  return this->Output;
}

vtkStringArray* vtkFileConverter::GetFiles()
{
  return this->Files;
}

vtkDoubleArray* vtkFileConverter::GetTimes()
{
  return this->Times;
}

vtkStringArray* vtkFileConverter::GetWarnings()
{
  return this->Warnings;
}

void vtkFileConverter::AddArray(const std::string& name)
{
  this->Arrays.push_back(name);
  this->Modified();
}

void vtkFileConverter::ClearArrays()
{
  this->Arrays.clear();
  this->Modified();
}

void vtkFileConverter::AddPhase(const std::string& name)
{
  this->Phases.push_back(name);
  this->Modified();
}

void vtkFileConverter::ClearPhases()
{
  this->Phases.clear();
  this->Modified();
}

void vtkFileConverter::SetRange(double low, double high)
{
  this->Put(this->Range, fmt::format("{},{}", low, high));
}

void vtkFileConverter::ResetRange()
{
  this->Put(this->Range, "");
}

void vtkFileConverter::Update()
{
  this->SetErrorCode(vtkErrorCode::NoError);
  this->Output = nullptr;
  this->Files->Reset();
  this->Times->Reset();
  this->Warnings->Reset();
  this->NumberOfSteps = 0;
  std::exception_ptr thrown;
  {
    const cli::VtkMessages messages; // gone before this object says what was wrong
    try
    {
      this->Convert();
    }
    catch (...)
    {
      thrown = std::current_exception();
    }
  }
  const auto outcome = lamella::attempt(this,
    [&]
    {
      if (thrown)
        std::rethrow_exception(thrown);
    });
  if (outcome == lamella::Outcome::Failed)
    this->SetErrorCode(vtkErrorCode::UserError);
}

void vtkFileConverter::Convert()
{
  cli::Session session(
    [this](double share, const std::string& what)
    {
      this->SetProgressText(what.c_str());
      this->UpdateProgress(share);
      if (this->GetAbortExecute() != 0)
        throw lamella::Cancelled();
      return true;
    });
  cli::ConversionWords words;
  words.raw.picture.file = this->FileName;
  words.raw.type = this->RawType;
  words.raw.order = this->RawOrder;
  words.raw.picture.rawHeader = static_cast<std::uint64_t>(this->RawHeader);
  if (std::any_of(this->RawSize, this->RawSize + 3, [](int n) { return n != 0; }))
    words.raw.picture.rawSize = fmt::format("{},{},{}", this->RawSize[0], this->RawSize[1], this->RawSize[2]);
  words.raw.picture.pixelSize = this->PixelSize != 0 ? fmt::format("{}", this->PixelSize) : "";
  words.output = this->OutputFileName;
  words.arrays = this->Arrays;
  words.phases = this->Phases;
  words.smoothing = this->Smoothing;
  words.step = this->Step != -1 ? std::to_string(this->Step) : "";
  words.type = this->NumberType;
  words.range = this->Range;
  words.lossy = this->Lossy;
  words.overwrite = this->Overwrite;
  if (this->Input == nullptr && this->FileName.empty())
    throw lamella::ParameterError("there is nothing to read", "name a file, or give data");
  std::vector<double> times;
  if (this->OutputFileName.empty())
  {
    if (this->Input != nullptr)
      throw lamella::ParameterError("there is no file to write the data to", "name one");
    cli::Loaded loaded = cli::load(session, words);
    this->Output = loaded.data;
    this->NumberOfSteps = static_cast<int>(loaded.steps);
    times = std::move(loaded.times);
  }
  else
  {
    if (this->Input != nullptr)
      words.raw.picture.file = "the data";
    const std::string command = this->Input == nullptr ? commandOf(words) : this->GetClassName();
    const cli::Converted converted = cli::convert(session, words, command, this->Input);
    append(this->Files, converted.report["files"].get<std::vector<std::string>>());
    this->NumberOfSteps = converted.report["steps"].get<int>();
    times = converted.report["times"].get<std::vector<double>>();
  }
  std::for_each(times.begin(), times.end(), [this](double time) { this->Times->InsertNextValue(time); });
  append(this->Warnings, session.warnings());
}

void vtkFileConverter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n'
     << indent << "OutputFileName: " << this->OutputFileName << '\n'
     << indent << "NumberType: " << this->NumberType << '\n'
     << indent << "Range: " << this->Range << '\n'
     << indent << "Smoothing: " << this->Smoothing << '\n'
     << indent << "Step: " << this->Step << '\n'
     << indent << "Lossy: " << this->Lossy << '\n'
     << indent << "Overwrite: " << this->Overwrite << '\n'
     << indent << "PixelSize: " << this->PixelSize << '\n'
     << indent << "RawSize: " << this->RawSize[0] << ' ' << this->RawSize[1] << ' ' << this->RawSize[2] << '\n'
     << indent << "RawType: " << this->RawType << '\n'
     << indent << "RawOrder: " << this->RawOrder << '\n'
     << indent << "RawHeader: " << this->RawHeader << '\n';
}
