#include "XmlChecks.h"

#include "XmlArrays.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/Plausible.h"

#include "vtkDataCompressor.h"
#include "vtkLZ4DataCompressor.h"
#include "vtkLZMADataCompressor.h"
#include "vtkSmartPointer.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"
#include "vtkZLibDataCompressor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <istream>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace lamella
{
namespace
{

using Extent = std::array<std::int64_t, 6>;

std::string_view nameOf(vtkXMLDataElement* element)
{
  return element->GetName() == nullptr ? std::string_view() : std::string_view(element->GetName());
}

std::vector<vtkXMLDataElement*> nested(vtkXMLDataElement* element, std::string_view name = {})
{
  std::vector<vtkXMLDataElement*> result;
  for (int i = 0; element != nullptr && i < element->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* const part = element->GetNestedElement(i);
    if (name.empty() || nameOf(part) == name)
      result.push_back(part);
  }
  return result;
}

vtkXMLDataElement* first(vtkXMLDataElement* element, std::string_view name)
{
  const auto all = nested(element, name);
  return all.empty() ? nullptr : all.front();
}

/// As many whole numbers as there are, and nothing else.
std::optional<std::vector<std::int64_t>> wholeNumbers(const char* text)
{
  std::vector<std::int64_t> values;
  std::istringstream words(text == nullptr ? "" : text);
  for (std::string word; words >> word;)
  {
    std::istringstream number(word);
    std::int64_t value = 0;
    if (!(number >> value) || !number.eof())
      return std::nullopt;
    values.push_back(value);
  }
  return values;
}

class Checks
{
public:
  Checks(vtkXMLDataParser* parser, const std::string& kind, const std::string& path)
    : parser_(parser)
    , kind_(kind)
    , path_(path)
    , arrays_(parser, path)
  {
  }

  void all();

private:
  using Heads = std::vector<XmlArray>;

  [[noreturn]] void damaged(const std::string& what) const
  {
    throw InputError("'" + path_ + "' is damaged: " + what, "make or copy it again");
  }
  [[nodiscard]] std::int64_t count(vtkXMLDataElement* element, const char* attribute, bool needed) const;
  [[nodiscard]] Extent extent(vtkXMLDataElement* element, const char* attribute) const;
  void requireBytes(double bytes, const std::string& what) const;
  void requireLengths(vtkXMLDataElement* image) const;
  void requireWhole(const Extent& whole, const std::vector<Extent>& pieces) const;
  void requireField(vtkXMLDataElement* primary);
  void requireSamePieces(vtkXMLDataElement* piece, const char* data, Heads& all, bool first);
  [[nodiscard]] double arrayBytes(vtkXMLDataElement* piece, const char* data, double tuples) const;
  void requireData(vtkXMLDataElement* piece, const char* data, std::int64_t tuples);
  void requireCells(vtkXMLDataElement* cells, std::int64_t count, const char* what);
  void image(vtkXMLDataElement* primary, const std::vector<vtkXMLDataElement*>& pieces);
  void cells(const std::vector<vtkXMLDataElement*>& pieces);

  vtkXMLDataParser* parser_;
  const std::string& kind_;
  const std::string& path_;
  XmlArrays arrays_;
  bool lzma_ = false;
};

std::int64_t Checks::count(vtkXMLDataElement* element, const char* attribute, bool needed) const
{
  const char* const text = element->GetAttribute(attribute);
  if (text == nullptr && !needed)
    return 0;
  const auto values = wholeNumbers(text);
  if (!values || values->size() != 1 || values->front() < 0 || values->front() > (std::int64_t{ 1 } << 60))
    damaged(fmt::format("its {} is {}", attribute, text == nullptr ? "missing" : text));
  return values->front();
}

Extent Checks::extent(vtkXMLDataElement* element, const char* attribute) const
{
  const char* const text = element->GetAttribute(attribute);
  const auto values = wholeNumbers(text);
  constexpr std::int64_t most = 2147483646; // VTK makes an int of them, of what is between and of one more or less
  const auto isInt = [](std::int64_t value) { return value >= -most && value <= most; };
  if (!values || values->size() != 6 || !std::ranges::all_of(*values, isInt) ||
    !isInt((*values)[1] - (*values)[0] + 1) || !isInt((*values)[3] - (*values)[2] + 1) ||
    !isInt((*values)[5] - (*values)[4] + 1))
  {
    throw InputError(fmt::format("'{}' holds no points: its extent is {}", path_, text == nullptr ? "missing" : text),
      "look at what wrote it");
  }
  Extent result{};
  std::ranges::copy(*values, result.begin());
  return result;
}

void Checks::requireBytes(double bytes, const std::string& what) const
{
  std::istream& stream = *parser_->GetStream();
  stream.clear();
  stream.seekg(0, std::ios::end);
  const auto size = static_cast<double>(stream.tellg());
  const double ratio = lzma_ ? 10000 : 1100; // bytes that one can stand for: deflate packs at most 1032, LZ4 255
  if (bytes > ratio * size)
    damaged(fmt::format("its {} cannot hold the {} it speaks of", bytesText(size), what));
  const auto available = static_cast<double>(availableMemory());
  if (bytes > available)
  {
    throw MemoryError(
      fmt::format("reading '{}' takes {}, and {} are free", path_, bytesText(bytes), bytesText(available)),
      "cut out a part of it first");
  }
}

/// Spacing and origin where they are given: VTK puts 1 or 0 in the place of what is no number.
void Checks::requireLengths(vtkXMLDataElement* image) const
{
  const auto lengths =
    [&](const char* attribute, std::size_t count, double least, double most, const char* name, const char* rule)
  {
    const char* const text = image->GetAttribute(attribute);
    std::vector<double> value(count + 1);
    if (text != nullptr &&
      (image->GetVectorAttribute(attribute, static_cast<int>(count + 1), value.data()) != static_cast<int>(count) ||
        !std::all_of(value.begin(), value.end() - 1, [&](double v) { return v >= least && v <= most; })))
      throw InputError(fmt::format("the {} of '{}' is {}", name, path_, text), rule);
  };
  constexpr double most = mostPlausible; // metres
  lengths("Spacing", 3, leastPlausible, most, "spacing", "a spacing is three positive lengths, in metres");
  lengths("Origin", 3, -most, most, "origin", "an origin is three lengths, in metres");
  lengths("Direction", 9, -1, 1, "direction", "a direction is nine cosines");
}

/// The pieces make up the whole: VTK leaves what none of them brings as it was in memory. Pieces may share a plane.
void Checks::requireWhole(const Extent& whole, const std::vector<Extent>& pieces) const
{
  std::array<std::vector<std::int64_t>, 3> cuts; // where something begins or ends, along an axis
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    auto& at = cuts[axis];
    at = { whole[2 * axis], whole[2 * axis + 1] + 1 };
    for (const Extent& piece : pieces)
    {
      if (piece[2 * axis] < whole[2 * axis] || piece[2 * axis + 1] > whole[2 * axis + 1] ||
        piece[2 * axis] > piece[2 * axis + 1])
        damaged("a piece of it lies outside of the whole");
      at.insert(at.end(), { piece[2 * axis], piece[2 * axis + 1] + 1 });
    }
    std::ranges::sort(at);
    at.erase(std::unique(at.begin(), at.end()), at.end());
  }
  const std::array<std::size_t, 3> boxes{ cuts[0].size() - 1, cuts[1].size() - 1, cuts[2].size() - 1 };
  constexpr double most = 1 << 24;
  if (static_cast<double>(boxes[0]) * static_cast<double>(boxes[1]) * static_cast<double>(boxes[2]) > most)
    damaged(fmt::format("it is cut into {} pieces", pieces.size()));
  std::vector<bool> there(boxes[0] * boxes[1] * boxes[2], false);
  std::size_t marked = 0;
  for (const Extent& piece : pieces)
  {
    std::array<std::size_t, 6> box{};
    for (std::size_t end = 0; end < 6; ++end)
    {
      const auto& at = cuts[end / 2];
      const auto found = std::ranges::lower_bound(at, piece[end] + static_cast<std::int64_t>(end % 2));
      box[end] = static_cast<std::size_t>(found - at.begin());
    }
    for (std::size_t z = box[4]; z < box[5]; ++z)
    {
      for (std::size_t y = box[2]; y < box[3]; ++y)
        for (std::size_t x = box[0]; x < box[1] && marked < 50 * there.size(); ++x, ++marked)
          there[(z * boxes[1] + y) * boxes[0] + x] = true;
    }
  }
  if (std::ranges::find(there, false) != there.end())
    damaged("its pieces are not the whole");
}

/// Arrays of one place, such as PointData, are the same in all pieces: VTK makes them after those of the first.
void Checks::requireSamePieces(vtkXMLDataElement* piece, const char* data, Heads& all, bool isFirst)
{
  Heads here;
  for (vtkXMLDataElement* const element : nested(first(piece, data)))
  {
    if (nameOf(element) != "DataArray" && nameOf(element) != "Array")
      damaged(fmt::format("'{}' stands among its arrays", nameOf(element)));
    here.push_back(arrays_.head(element));
    if (std::ranges::count(here, here.back().name, &XmlArray::name) > 1)
      damaged(fmt::format("it has two arrays '{}'", here.back().name));
    if (here.back().isText() && kind_ == "ImageData")
      damaged(fmt::format("array '{}' has texts at points or cells", here.back().name));
  }
  if (isFirst)
  {
    all = std::move(here);
    return;
  }
  if (!std::ranges::equal(all, here,
        [](const XmlArray& a, const XmlArray& b)
        { return a.name == b.name && a.type == b.type && a.components == b.components; }))
    damaged("its pieces have different arrays");
}

/// Bytes that the arrays of one element, such as PointData, take for so many tuples.
double Checks::arrayBytes(vtkXMLDataElement* piece, const char* data, double tuples) const
{
  double bytes = 0;
  for (vtkXMLDataElement* const element : nested(first(piece, data)))
  {
    const XmlArray head = arrays_.head(element);
    bytes += tuples * head.bytes * head.components;
  }
  return bytes;
}

void Checks::requireData(vtkXMLDataElement* piece, const char* data, std::int64_t tuples)
{
  for (vtkXMLDataElement* const element : nested(first(piece, data)))
    arrays_.requireTuples(element, arrays_.head(element), tuples);
}

/// A field array says for itself how many tuples it has.
void Checks::requireField(vtkXMLDataElement* primary)
{
  double bytes = 0;
  double tuples = 0;
  const auto elements = nested(first(primary, "FieldData"));
  for (vtkXMLDataElement* const element : elements)
  {
    if (nameOf(element) != "DataArray" && nameOf(element) != "Array")
      damaged(fmt::format("'{}' stands among its field data", nameOf(element)));
    const XmlArray head = arrays_.head(element);
    const auto here = static_cast<double>(count(element, "NumberOfTuples", true));
    tuples += here;
    bytes += here * head.bytes * head.components;
  }
  requireBytes(bytes, fmt::format("{:.0f} values of field data", tuples));
  for (vtkXMLDataElement* const element : elements)
    arrays_.requireTuples(element, arrays_.head(element), count(element, "NumberOfTuples", true));
}

void Checks::requireCells(vtkXMLDataElement* cells, std::int64_t count, const char* what)
{
  if (cells == nullptr || cells->GetNumberOfNestedElements() == 0)
  {
    if (count > 0)
      damaged(fmt::format("its {} {} are missing", count, what));
    return;
  }
  const auto array = [&](std::string_view name)
  {
    const auto all = nested(cells, "DataArray");
    const auto found = std::ranges::find_if(
      all, [&](vtkXMLDataElement* e) { return e->GetAttribute("Name") != nullptr && e->GetAttribute("Name") == name; });
    if (found == all.end())
      damaged(fmt::format("its {} have no '{}'", what, name));
    const XmlArray head = arrays_.head(*found);
    if (head.components != 1 || !head.isWhole())
      damaged(fmt::format("the '{}' of its {} are no whole numbers", name, what));
    return std::pair(*found, head);
  };
  for (vtkXMLDataElement* const other : nested(cells))
    if (const char* const name = other->GetAttribute("Name");
        name != nullptr && std::string_view(name).starts_with("face") && count > 0)
      damaged("it has cells of many faces, which are not read");
  const auto [ends, endsHead] = array("offsets");
  const auto [points, pointsHead] = array("connectivity");
  arrays_.requireTuples(ends, endsHead, count);
  const auto offsets = arrays_.wholeNumbers(ends, endsHead, count);
  if (!std::ranges::is_sorted(offsets) || (!offsets.empty() && offsets.front() < 0))
    damaged(fmt::format("its {} begin and end where there are none", what));
  arrays_.requireTuples(points, pointsHead, offsets.empty() ? 0 : offsets.back());
  if (kind_ == "UnstructuredGrid")
  {
    const auto [types, typesHead] = array("types");
    arrays_.requireTuples(types, typesHead, count);
  }
}

void Checks::image(vtkXMLDataElement* primary, const std::vector<vtkXMLDataElement*>& pieces)
{
  const Extent whole = extent(primary, "WholeExtent");
  requireLengths(primary);
  const auto points = [](const Extent& e, std::size_t axis) { return e[2 * axis + 1] - e[2 * axis] + 1; };
  // As VTK counts cells: an axis along which the whole is flat has one.
  const auto cells = [&](const Extent& e, std::size_t axis)
  { return points(whole, axis) <= 1 && points(e, axis) == 1 ? 1 : points(e, axis) - 1; };
  const auto product = [&](const auto& along, const Extent& e)
  { return static_cast<double>(along(e, 0)) * static_cast<double>(along(e, 1)) * static_cast<double>(along(e, 2)); };
  std::string size;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (points(whole, axis) < 1)
    {
      throw InputError(
        fmt::format("'{}' holds no points: its extent is {}", path_, primary->GetAttribute("WholeExtent")),
        "look at what wrote it");
    }
    size += fmt::format("{}{}", axis == 0 ? "" : " × ", points(whole, axis));
  }
  // All pieces have the same arrays, and each is read into an array for the whole.
  requireBytes(arrayBytes(pieces.front(), "PointData", product(points, whole)) +
      arrayBytes(pieces.front(), "CellData", product(cells, whole)),
    size + " points");
  if (product(points, whole) > 0x1p53)
    damaged("it speaks of " + size + " points");
  std::vector<Extent> extents;
  for (vtkXMLDataElement* const piece : pieces)
    extents.push_back(piece == primary ? whole : extent(piece, "Extent"));
  requireWhole(whole, extents);
  for (std::size_t i = 0; i < pieces.size(); ++i)
  {
    requireData(pieces[i], "PointData", static_cast<std::int64_t>(product(points, extents[i])));
    requireData(pieces[i], "CellData", static_cast<std::int64_t>(product(cells, extents[i])));
  }
}

void Checks::cells(const std::vector<vtkXMLDataElement*>& pieces)
{
  struct Kind
  {
    const char* count;
    const char* element;
    const char* what;
  };
  static constexpr std::array<Kind, 4> poly{ { { "NumberOfVerts", "Verts", "vertices" },
    { "NumberOfLines", "Lines", "lines" }, { "NumberOfStrips", "Strips", "strips" },
    { "NumberOfPolys", "Polys", "polygons" } } };
  static constexpr std::array<Kind, 1> grid{ { { "NumberOfCells", "Cells", "cells" } } };
  const bool isGrid = kind_ == "UnstructuredGrid";
  const std::span<const Kind> kinds = isGrid ? std::span<const Kind>(grid) : std::span<const Kind>(poly);

  double bytes = 0;
  double allPoints = 0;
  double allCells = 0;
  for (vtkXMLDataElement* const piece : pieces)
  {
    const auto points = static_cast<double>(count(piece, "NumberOfPoints", true));
    double here = 0;
    for (const Kind& kind : kinds)
      here += static_cast<double>(count(piece, kind.count, isGrid));
    // Of a cell there are at least an offset and a point, or a type, in one byte each.
    bytes += arrayBytes(piece, "Points", points) + arrayBytes(piece, "PointData", points) +
      arrayBytes(piece, "CellData", here) + 2 * here;
    allPoints += points;
    allCells += here;
  }
  requireBytes(bytes, fmt::format("{:.0f} points and {:.0f} cells", allPoints, allCells));
  Heads places;
  for (vtkXMLDataElement* const piece : pieces)
  {
    const std::int64_t points = count(piece, "NumberOfPoints", true);
    requireSamePieces(piece, "Points", places, piece == pieces.front());
    if (places.size() != 1 || places.front().components != 3 || places.front().isText())
      damaged("its points have not three coordinates");
    requireData(piece, "Points", points);
    requireData(piece, "PointData", points);
    std::int64_t cells = 0;
    for (const Kind& kind : kinds)
    {
      const std::int64_t here = count(piece, kind.count, isGrid);
      requireCells(first(piece, kind.element), here, kind.what);
      cells += here;
    }
    requireData(piece, "CellData", cells);
  }
}

void Checks::all()
{
  vtkXMLDataElement* const primary = first(parser_->GetRootElement(), kind_);
  if (primary == nullptr)
    damaged(fmt::format("it holds no {}", kind_));
  if (const char* const name = parser_->GetRootElement()->GetAttribute("compressor"))
  {
    vtkSmartPointer<vtkDataCompressor> compressor;
    if (std::string_view(name) == "vtkZLibDataCompressor")
    {
      compressor = vtkSmartPointer<vtkZLibDataCompressor>::New();
    }
    else if (std::string_view(name) == "vtkLZ4DataCompressor")
    {
      compressor = vtkSmartPointer<vtkLZ4DataCompressor>::New();
    }
    else if (std::string_view(name) == "vtkLZMADataCompressor")
    {
      compressor = vtkSmartPointer<vtkLZMADataCompressor>::New();
      lzma_ = true;
    }
    else
    {
      damaged(fmt::format("it is packed by {}, which there is not", name));
    }
    parser_->SetCompressor(compressor);
  }
  if (primary->GetAttribute("TimeValues") != nullptr)
  {
    throw InputError(fmt::format("'{}' holds several times in one file, which are not read", path_),
      "write a file for each of them, with a .pvd of all");
  }
  auto pieces = nested(primary, "Piece");
  if (pieces.empty())
    pieces.push_back(primary);
  std::array<Heads, 2> heads;
  for (vtkXMLDataElement* const piece : pieces)
  {
    requireSamePieces(piece, "PointData", heads[0], piece == pieces.front());
    requireSamePieces(piece, "CellData", heads[1], piece == pieces.front());
  }
  if (kind_ == "ImageData")
    image(primary, pieces);
  else
    cells(pieces);
  requireField(primary);
  arrays_.requireApart();
}

} // namespace

void requireSoundXml(vtkXMLDataParser* parser, const std::string& kind, const std::string& path)
{
  Checks(parser, kind, path).all();
}

} // namespace lamella
