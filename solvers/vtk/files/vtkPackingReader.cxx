#include "vtkPackingReader.h"

#include "Attempt.h"
#include "GridReaders.h"
#include "PackingData.h"
#include "PackingTable.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <filesystem>
#include <string>

namespace
{

/// The particles of a .vtp, as they are.
void readParticles(const std::string& path, vtkPolyData* particles)
{
  lamella::readPolyData(path, particles);
  try
  {
    static_cast<void>(lamella::packingFrom(particles));
  }
  catch (const lamella::InputError& error)
  {
    throw lamella::InputError("'" + path + "': " + error.what(), error.hint());
  }
}

} // namespace

vtkStandardNewMacro(vtkPackingReader);
vtkPrintSettingsMacro(vtkPackingReader);

vtkPackingReader::vtkPackingReader()
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

vtkPackingReader::~vtkPackingReader()
{
  this->SetFileName(nullptr);
}

vtkGetOutputMacro(vtkPackingReader, Contacts, vtkPolyData, 1);
vtkAllInFirstPieceMacro(vtkPackingReader);

void vtkPackingReader::Read(vtkPolyData* particles, vtkPolyData* contacts)
{
  const std::string ending = lamella::endingOf(this->FileName);
  const std::filesystem::path path(this->FileName);
  if (ending == ".vtp")
  {
    readParticles(this->FileName, particles);
    return;
  }
  if (ending == ".vti")
  {
    throw lamella::InputError("'" + std::string(this->FileName) + "' is an image, not a packing",
      "give a table x,z,r or the .vtp of lamella packing");
  }
  lamella::PackingTableOptions options;
  options.unit = this->LengthUnit;
  nlohmann::json parameters{ { "length_unit", this->LengthUnit } };
  if (std::any_of(this->BoxSize, this->BoxSize + 3, [](double edge) { return edge != 0; }))
  {
    options.box.emplace();
    std::copy_n(this->BoxSize, 3, options.box->begin());
    parameters["box"] = this->BoxSize;
  }
  const lamella::packing::Packing packing = lamella::readPackingTable(path, options);
  lamella::setPacking(packing, lamella::packing::statistics(packing), this->GetClassName(), particles, contacts);
  for (vtkPolyData* const data : { particles, contacts })
    lamella::beginProvenance(data, "packing_table", parameters, {}, path);
}

int vtkPackingReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPolyData* const particles = vtkPolyData::GetData(outputVector, 0);
  vtkPolyData* const contacts = vtkPolyData::GetData(outputVector, 1);
  particles->Initialize();
  contacts->Initialize();
  if (!lamella::isFirstPiece(outputVector))
    return 1;
  if (lamella::attempt(this, [&] { this->Read(particles, contacts); }) != lamella::Outcome::Done)
  {
    particles->Initialize();
    return 0;
  }
  return 1;
}
