#include "vtkFileConverter.h"

#include "Attempt.h"
#include "Settings.h"
#include "convert/Conversion.h"
#include "files/GridFile.h"
#include "session/Session.h"
#include "vtkClassMacros.h"

#include "core/Error.h"
#include "io/Provenance.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>

namespace
{

namespace cli = lamella::cli;

/// The command line that does the same.
std::string commandOf(const cli::ConversionWords& words)
{
  std::vector<std::string> line{ "lamella", "convert", words.raw.file, "-o", words.output };
  const auto add = [&](const char* option, const std::string& value)
  {
    if (!value.empty())
      line.insert(line.end(), { option, value });
  };
  for (const std::string& name : words.arrays)
    add("--array", name);
  add("--step", words.step ? std::to_string(*words.step) : "");
  add("--type", words.type);
  add("--range", words.range ? fmt::format("{}", fmt::join(*words.range, ",")) : "");
  const lamella::micrograph::ReadOptions& read = words.raw.read;
  for (const std::string& name : words.phases)
    add("--phase", name);
  add("--smooth", words.smoothing > 0 ? std::to_string(words.smoothing) : "");
  add("--pixel-size", read.pixelSize ? fmt::format("{}", *read.pixelSize) : "");
  add("--raw-size", read.rawSize ? fmt::format("{}", fmt::join(*read.rawSize, ",")) : "");
  add("--raw-bits", read.rawBits ? std::to_string(*read.rawBits) : "");
  add("--raw-type", words.raw.type);
  add("--raw-order", words.raw.order);
  add("--raw-header", read.rawHeader > 0 ? std::to_string(read.rawHeader) : "");
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
vtkPrintSettingsMacro(vtkFileConverter);

vtkFileConverter::vtkFileConverter()
  : Files(vtkSmartPointer<vtkStringArray>::New())
  , Times(vtkSmartPointer<vtkDoubleArray>::New())
  , Warnings(vtkSmartPointer<vtkStringArray>::New())
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(0);
}

vtkFileConverter::~vtkFileConverter() = default;

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

lamella::cli::ConversionWords vtkFileConverter::GetWords() const
{
  cli::ConversionWords words;
  words.raw.file = this->FileName;
  words.raw.type = this->RawType;
  words.raw.order = this->RawOrder;
  words.raw.read.rawHeader = static_cast<std::uint64_t>(this->RawHeader);
  if (std::any_of(this->RawSize, this->RawSize + 3, [](int n) { return n != 0; }))
    words.raw.read.rawSize = { this->RawSize[0], this->RawSize[1], this->RawSize[2] };
  if (this->RawBits != 0)
    words.raw.read.rawBits = this->RawBits;
  if (this->PixelSize != 0)
    words.raw.read.pixelSize = this->PixelSize;
  words.output = this->OutputFileName;
  words.arrays = this->Arrays;
  if (this->Step != -1)
    words.step = this->Step;
  words.type = this->NumberType;
  if (this->Range[0] != 0 || this->Range[1] != 0)
    words.range = { this->Range[0], this->Range[1] };
  words.phases = this->Phases;
  words.smoothing = this->Smoothing;
  words.lossy = this->Lossy;
  words.overwrite = this->Overwrite;
  return words;
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
  lamella::checkSettings(this);
  cli::Session session(
    [this](double share, const std::string& what)
    {
      this->SetProgressText(what.c_str());
      this->UpdateProgress(share);
      if (this->GetAbortExecute() != 0)
        throw lamella::Cancelled();
      return true;
    });
  cli::ConversionWords words = this->GetWords();
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
      words.raw.file = "the data";
    const std::string command = this->Input == nullptr ? commandOf(words) : this->GetClassName();
    const cli::Converted converted = cli::convert(session, words, command, this->Input);
    append(this->Files, converted.report["files"].get<std::vector<std::string>>());
    this->NumberOfSteps = converted.report["steps"].get<int>();
    times = converted.report["times"].get<std::vector<double>>();
  }
  std::for_each(times.begin(), times.end(), [this](double time) { this->Times->InsertNextValue(time); });
  append(this->Warnings, session.warnings());
}
