#include "scenes/ResultTables.h"

#include "session/OutputFile.h"

#include "io/Hdf5.h"

#include <vtkDoubleArray.h>
#include <vtkStringArray.h>
#include <vtkTable.h>

#include <algorithm>
#include <vector>

namespace lamella::cli
{

namespace
{

using namespace io::hdf5;

void writeColumn(hid_t group, vtkAbstractArray* column, hid_t untimed)
{
  const auto rows = static_cast<hsize_t>(column->GetNumberOfTuples());
  const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  if (auto* const numbers = vtkDoubleArray::SafeDownCast(column))
  {
    const Handle set(
      H5Dcreate2(group, column->GetName(), H5T_IEEE_F64LE, space, H5P_DEFAULT, untimed, H5P_DEFAULT), H5Dclose);
    if (rows > 0)
      good(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers->GetPointer(0)));
    return;
  }
  auto* const texts = vtkStringArray::SafeDownCast(column);
  std::size_t longest = 1;
  for (vtkIdType i = 0; i < texts->GetNumberOfValues(); ++i)
    longest = std::max(longest, texts->GetValue(i).size());
  std::vector<char> block(longest * rows, '\0');
  for (vtkIdType i = 0; i < texts->GetNumberOfValues(); ++i)
  {
    const std::string text = texts->GetValue(i);
    std::copy(text.begin(), text.end(), block.begin() + static_cast<std::ptrdiff_t>(longest) * i);
  }
  const Handle type = textType(longest);
  good(H5Tset_strpad(type, H5T_STR_NULLPAD));
  const Handle set(H5Dcreate2(group, column->GetName(), type, space, H5P_DEFAULT, untimed, H5P_DEFAULT), H5Dclose);
  if (rows > 0)
    good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, block.data()));
}

void writeAll(const std::filesystem::path& path, const std::vector<std::pair<std::string, vtkTable*>>& tables,
  const std::string& provenance)
{
  const Quiet quiet;
  const Handle untimed(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  good(H5Pset_obj_track_times(untimed, false));
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  {
    // an attribute of a file holds 64 KiB at most, and a scene may be longer
    const Handle type = textType(provenance.size());
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle set(H5Dcreate2(file, "provenance", type, space, H5P_DEFAULT, untimed, H5P_DEFAULT), H5Dclose);
    good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, provenance.c_str()));
  }
  for (const auto& [name, table] : tables)
  {
    const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
      writeColumn(group, table->GetColumn(c), untimed);
  }
  if (!file.finish())
    good(-1);
}

} // namespace

void writeArchive(const std::filesystem::path& path, const std::vector<std::pair<std::string, vtkTable*>>& tables,
  const std::string& provenance)
{
  OutputFile file(path, true);
  try
  {
    writeAll(file.temporary(), tables, provenance);
  }
  catch (const Error& error)
  {
    file.failed(error.what());
  }
  file.commit();
}

} // namespace lamella::cli
