#include "GridChecks.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLReader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

namespace lamella
{
namespace
{

[[noreturn]] void damaged(const std::string& path, const std::string& what)
{
  throw InputError("'" + path + "' is damaged: " + what, "make or copy it again");
}

/// The number of an attribute; 0 where it is missing or none.
double number(vtkXMLDataElement* element, const char* attribute)
{
  double value = 0;
  return element->GetScalarAttribute(attribute, value) != 0 ? value : 0;
}

template <typename Visit>
void forNested(vtkXMLDataElement* element, const char* name, const Visit& visit)
{
  for (int i = 0; element != nullptr && i < element->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* const nested = element->GetNestedElement(i);
    if (nested->GetName() != nullptr && std::string_view(nested->GetName()) == name)
    {
      visit(nested);
    }
  }
}

/// Bytes that a tuple of a data array takes: type="Float64" and the like end in the bits.
double tupleBytes(vtkXMLDataElement* array)
{
  const char* const type = array->GetAttribute("type");
  const std::string_view text = type == nullptr ? "" : type;
  const double value = text.ends_with("64") ? 8 : text.ends_with("32") ? 4 : text.ends_with("16") ? 2 : 1;
  return value * std::max(1.0, number(array, "NumberOfComponents"));
}

/// Bytes that the arrays of one element, such as PointData, take for so many tuples.
double arrayBytes(vtkXMLDataElement* piece, const char* name, double tuples)
{
  double bytes = 0;
  forNested(piece, name,
    [&](vtkXMLDataElement* data)
    { forNested(data, "DataArray", [&](vtkXMLDataElement* array) { bytes += tuples * tupleBytes(array); }); });
  return bytes;
}

struct Claim
{
  double bytes = 0;
  std::string what;
};

Claim imageClaim(vtkXMLDataElement* image)
{
  Claim claim;
  std::array<double, 6> extent{};
  image->GetVectorAttribute("WholeExtent", 6, extent.data());
  double points = 1;
  double cells = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double count = std::max(0.0, extent[2 * axis + 1] - extent[2 * axis] + 1);
    points *= count;
    cells *= std::max(1.0, count - 1);
    claim.what += fmt::format("{}{:.0f}", axis == 0 ? "" : " × ", count);
  }
  claim.what += " points";
  forNested(image, "Piece",
    [&](vtkXMLDataElement* piece) // all pieces have the same arrays, and each is read into an array for the whole
    {
      claim.bytes =
        std::max(claim.bytes, arrayBytes(piece, "PointData", points) + arrayBytes(piece, "CellData", cells));
    });
  return claim;
}

Claim polyClaim(vtkXMLDataElement* poly)
{
  Claim claim;
  double points = 0;
  double cells = 0;
  forNested(poly, "Piece",
    [&](vtkXMLDataElement* piece)
    {
      const double here = number(piece, "NumberOfPoints");
      double cellsHere = 0;
      for (const char* kind : { "NumberOfVerts", "NumberOfLines", "NumberOfStrips", "NumberOfPolys" })
      {
        cellsHere += number(piece, kind);
      }
      // Of a cell there are at least an offset and a point, in no fewer than 4 bytes each.
      claim.bytes += arrayBytes(piece, "Points", here) + arrayBytes(piece, "PointData", here) +
        arrayBytes(piece, "CellData", cellsHere) + 8 * cellsHere;
      points += here;
      cells += cellsHere;
    });
  claim.what = fmt::format("{:.0f} points and {:.0f} cells", points, cells);
  return claim;
}

Claim gridClaim(vtkXMLDataElement* grid)
{
  Claim claim;
  double points = 0;
  double cells = 0;
  forNested(grid, "Piece",
    [&](vtkXMLDataElement* piece)
    {
      const double pointsHere = number(piece, "NumberOfPoints");
      const double cellsHere = number(piece, "NumberOfCells");
      // Of a cell there are at least an offset of 4 bytes and a type.
      claim.bytes += arrayBytes(piece, "Points", pointsHere) + arrayBytes(piece, "PointData", pointsHere) +
        arrayBytes(piece, "CellData", cellsHere) + 5 * cellsHere;
      points += pointsHere;
      cells += cellsHere;
    });
  claim.what = fmt::format("{:.0f} points and {:.0f} cells", points, cells);
  return claim;
}

/// A field array says for itself how many tuples it has.
Claim fieldClaim(vtkXMLDataElement* data)
{
  Claim claim;
  double tuples = 0;
  forNested(data, "FieldData",
    [&](vtkXMLDataElement* field)
    {
      for (const char* kind : { "DataArray", "Array" })
      {
        forNested(field, kind,
          [&](vtkXMLDataElement* array)
          {
            const double here = number(array, "NumberOfTuples");
            tuples += here;
            claim.bytes += here * tupleBytes(array);
          });
      }
    });
  claim.what = fmt::format("{:.0f} values of field data", tuples);
  return claim;
}

void requireBytes(const Claim& claim, const std::string& path, bool lzma)
{
  std::error_code failed;
  const auto size = static_cast<double>(std::filesystem::file_size(path, failed));
  const double ratio = lzma ? 10000 : 1100; // bytes that one can stand for: deflate packs at most 1032, LZ4 255
  if (!failed && claim.bytes > ratio * size)
  {
    damaged(path, fmt::format("its {} cannot hold the {} it speaks of", bytesText(size), claim.what));
  }
  const auto available = static_cast<double>(availableMemory());
  if (claim.bytes > available)
  {
    throw MemoryError(
      fmt::format("reading '{}' takes {}, and {} are free", path, bytesText(claim.bytes), bytesText(available)),
      "cut out a part of it first");
  }
}

/// Spacing and origin where they are given: VTK puts 1 or 0 in the place of what is no number.
void requireLengths(vtkXMLDataElement* image, const std::string& path)
{
  const auto lengths = [&](const char* attribute, double least, const char* name, const char* rule)
  {
    const char* const text = image->GetAttribute(attribute);
    std::array<double, 3> value{};
    constexpr double most = 1e30; // metres; its cube is a number, too
    if (text != nullptr &&
      (image->GetVectorAttribute(attribute, 3, value.data()) != 3 ||
        !std::ranges::all_of(value, [&](double v) { return v >= least && v <= most; })))
    {
      throw InputError(fmt::format("the {} of '{}' is {}", name, path, text), rule);
    }
  };
  lengths("Spacing", 1e-30, "spacing", "a spacing is three positive lengths, in metres");
  lengths("Origin", -1e30, "origin", "an origin is three lengths, in metres");
}

void requirePoints(vtkXMLDataElement* image, const std::string& path)
{
  std::array<double, 6> extent{};
  if (image->GetVectorAttribute("WholeExtent", 6, extent.data()) != 6 || extent[1] < extent[0] ||
    extent[3] < extent[2] || extent[5] < extent[4])
  {
    const char* const text = image->GetAttribute("WholeExtent");
    throw InputError(fmt::format("'{}' holds no points: its extent is {}", path, text == nullptr ? "missing" : text),
      "look at what wrote it");
  }
}

} // namespace

void requireReadable(vtkXMLReader* reader, const std::string& path)
{
  reader->UpdateInformation();
  vtkXMLDataParser* const parser = reader->GetXMLParser();
  vtkXMLDataElement* const root = parser == nullptr ? nullptr : parser->GetRootElement();
  if (reader->GetErrorCode() != 0 || root == nullptr)
  {
    return;
  }
  const char* const compressor = root->GetAttribute("compressor");
  const bool lzma = compressor != nullptr && std::string_view(compressor).find("LZMA") != std::string_view::npos;
  forNested(root, "ImageData",
    [&](vtkXMLDataElement* image)
    {
      requirePoints(image, path);
      requireLengths(image, path);
      requireBytes(imageClaim(image), path, lzma);
      requireBytes(fieldClaim(image), path, lzma);
    });
  forNested(root, "PolyData",
    [&](vtkXMLDataElement* poly)
    {
      requireBytes(polyClaim(poly), path, lzma);
      requireBytes(fieldClaim(poly), path, lzma);
    });
  forNested(root, "UnstructuredGrid",
    [&](vtkXMLDataElement* grid)
    {
      requireBytes(gridClaim(grid), path, lzma);
      requireBytes(fieldClaim(grid), path, lzma);
    });
}

namespace
{

void requireSound(vtkCellArray* cells, vtkIdType points, const std::string& path)
{
  if (cells == nullptr || cells->GetNumberOfCells() == 0)
  {
    return;
  }
  if (!cells->IsValid())
  {
    damaged(path, "its cells begin and end where there are none");
  }
  std::array<double, 2> range{ 0, 0 };
  if (cells->GetNumberOfConnectivityIds() > 0)
  {
    cells->GetConnectivityArray()->GetRange(range.data());
  }
  if (range[0] < 0 || range[1] >= static_cast<double>(points))
  {
    damaged(path,
      fmt::format(
        "a cell has point {:.0f}, and there are {} points, from 0", range[0] < 0 ? range[0] : range[1], points));
  }
}

} // namespace

void requireSoundCells(vtkPolyData* data, const std::string& path)
{
  for (vtkCellArray* const cells : { data->GetVerts(), data->GetLines(), data->GetPolys(), data->GetStrips() })
  {
    requireSound(cells, data->GetNumberOfPoints(), path);
  }
}

void requireSoundCells(vtkUnstructuredGrid* data, const std::string& path)
{
  requireSound(data->GetCells(), data->GetNumberOfPoints(), path);
}

} // namespace lamella
