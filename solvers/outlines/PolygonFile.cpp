#include "outlines/PolygonFile.h"

#include "core/Error.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourEdit.h"
#include "outlines/PolygonCells.h"
#include "outlines/PolygonRings.h"
#include "pictures/GzipFile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::micrograph
{
namespace
{

constexpr std::size_t mostText = std::size_t{ 1 } << 30U;

class Reader
{
public:
  Reader(const std::filesystem::path& path, const PolygonReadOptions& options)
    : rings_(path.string())
    , name_(rings_.name())
    , options_(options)
  {
    if (options.unit && !(*options.unit > 0 && std::isfinite(*options.unit)))
    {
      throw ParameterError(
        fmt::format("the unit of the polygons is {:g} m", *options.unit), "give a positive one: 1e-6 for micrometres");
    }
    if (options.window)
    {
      const auto& w = *options.window;
      if (!(w[2] > w[0] && w[3] > w[1]) || !std::all_of(w.begin(), w.end(), [](double v) { return std::isfinite(v); }))
      {
        throw ParameterError(fmt::format("the window {:g}, {:g} to {:g}, {:g} is empty", w[0], w[1], w[2], w[3]),
          "give its low x, low y, high x, high y in the file's coordinates");
      }
    }
    const std::string text = readText(path, mostText);
    try
    {
      json_ = Json::parse(text);
    }
    catch (const Json::parse_error& failure)
    {
      throw InputError(fmt::format("'{}' is no JSON: it goes wrong at byte {}", name_, failure.byte),
        "export the polygons again, as lists of [x, y]");
    }
    catch (const Json::exception&) // a number beyond the range of double
    {
      throw InputError(fmt::format("'{}' has a number that is too large", name_), "give coordinates in micrometres");
    }
  }

  PolygonFile read()
  {
    PolygonFile file;
    if (json_.is_object() && json_.contains("contours"))
      readOwn(file);
    else
      readRings(file);
    file.unit = unit_;
    file.warnings = rings_.warnings();
    return file;
  }

private:
  [[nodiscard]] Polygon ring(const Json& list, const std::string& what)
  {
    return rings_.ring(list, what, unit_, options_.yDown);
  }

  void addRings(const Json& list, const std::string& what, std::vector<Polygon>& to)
  {
    for (std::size_t i = 0; i < list.size(); ++i)
    {
      Polygon p = ring(list[i], fmt::format("{} {}", what, i + 1));
      if (!p.empty())
        to.push_back(std::move(p));
    }
  }

  void addCells(const Json& list, std::vector<Polygon>& lumens, std::vector<Polygon>& outers)
  {
    for (std::size_t i = 0; i < list.size(); ++i)
    {
      const Json& cell = list[i];
      if (!cell.is_object() || !(cell.contains("lumen") || cell.contains("outer")))
        rings_.fail(fmt::format("cell {} has neither \"lumen\" nor \"outer\"", i + 1), polygonKinds);
      for (const auto& [key, to] : { std::pair("lumen", &lumens), std::pair("outer", &outers) })
      {
        if (cell.contains(key))
        {
          Polygon p = ring(cell[key], fmt::format("the {} of cell {}", key, i + 1));
          if (!p.empty())
          {
            to->push_back(std::move(p));
            if (to == &outers)
              cellNumbers_.push_back(i + 1);
          }
        }
      }
    }
  }

  void readRings(PolygonFile& file)
  {
    const bool plain = json_.is_array();
    const char* key = !json_.is_object() ? ""
      : json_.contains("cells")          ? "cells"
      : json_.contains("lumens")         ? "lumens"
                                         : "";
    if (!plain && *key == '\0')
    {
      rings_.fail(json_.is_object() ? std::string("it has neither \"cells\" nor \"lumens\"")
                                    : fmt::format("it is a {}, not a list of polygons", json_.type_name()),
        polygonKinds);
    }
    const Json& list = plain ? json_ : json_[key];
    if (!list.is_array() || list.empty())
    {
      rings_.fail(list.is_array() ? std::string("it has no polygons")
                                  : fmt::format("its \"{}\" are a {}, not a list", key, list.type_name()),
        polygonKinds);
    }
    unit_ = rings_.findUnit(json_, options_.unit);
    std::vector<Polygon> lumens;
    std::vector<Polygon> outers;
    if (key == std::string("cells"))
      addCells(list, lumens, outers);
    else
      addRings(list, "polygon", lumens);
    if (lumens.empty())
      rings_.fail("it has no lumen", polygonKinds);
    std::vector<Polygon> frame = lumens;
    frame.insert(frame.end(), outers.begin(), outers.end());
    if (json_.is_object() && json_.contains("outer") && !json_["outer"].empty())
    {
      Polygon outer = ring(json_["outer"], "the outline of all cells (\"outer\")");
      if (!outer.empty())
        frame.push_back(std::move(outer));
    }
    const auto [low, high] = window(frame);
    file.origin = low;
    checkRings(lumens, "lumen");
    file.lumens = clipped(lumens, low, high);
    if (file.lumens.contours.empty())
    {
      rings_.fail(
        "no lumen lies in the window", "give the window in the file's coordinates: low x, low y, high x, high y");
    }
    requireValid(file.lumens, fmt::format("'{}'", name_));
    if (!outers.empty())
      file.cells = clipCells(outers, cellNumbers_, low, high, [this](std::size_t cell) { leaveOut(cell); });
  }

  void leaveOut(std::size_t cell)
  {
    rings_.warn(fmt::format("the outline of cell {} crosses or touches itself, or is none, and was left out", cell));
  }

  /// Each ring by itself and all together, before anything is clipped: numbers in messages are the file's.
  void checkRings(const std::vector<Polygon>& rings, const char* what) const
  {
    ContourSet all{ { largestPicture, largestPicture }, {} };
    for (const Polygon& p : rings)
      all.contours.push_back({ p, true, static_cast<std::int32_t>(all.contours.size() + 1) });
    const std::vector<ContourFinding> found = findCrossings(all);
    if (found.empty())
      return;
    const ContourFinding& f = found.front();
    const double x = f.at[0] / unit_;
    const double y = f.at[1] / (options_.yDown ? -unit_ : unit_);
    const std::string more = found.size() > 1 ? fmt::format(" ({} more such pairs)", found.size() - 1) : std::string{};
    rings_.fail(f.contour == f.other
        ? fmt::format("{} {} crosses or touches itself near ({:.6g}, {:.6g}){}", what, f.contour + 1, x, y, more)
        : fmt::format(
            "{}s {} and {} cross or touch near ({:.6g}, {:.6g}){}", what, f.contour + 1, f.other + 1, x, y, more),
      "draw them anew with a wall between; every outline passes each place once");
  }

  [[nodiscard]] std::pair<Point, Point> window(const std::vector<Polygon>& all) const
  {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Point low{ infinite, infinite };
    Point high{ -infinite, -infinite };
    if (options_.window)
    {
      const auto& w = *options_.window;
      low = { w[0] * unit_, options_.yDown ? -w[3] * unit_ : w[1] * unit_ };
      high = { w[2] * unit_, options_.yDown ? -w[1] * unit_ : w[3] * unit_ };
    }
    else
    {
      for (const Polygon& p : all)
      {
        for (const Point& q : p)
        {
          for (std::size_t k = 0; k < 2; ++k)
          {
            low[k] = std::min(low[k], q[k]);
            high[k] = std::max(high[k], q[k]);
          }
        }
      }
    }
    if (high[0] - low[0] > largestPicture || high[1] - low[1] > largestPicture)
    {
      rings_.fail(fmt::format("its polygons reach over {:g} × {:g} m", high[0] - low[0], high[1] - low[1]),
        "check the unit of its coordinates; pictures up to 1 m are taken");
    }
    return { low, high };
  }

  [[nodiscard]] ContourSet clipped(const std::vector<Polygon>& all, const Point& low, const Point& high) const
  {
    try
    {
      return clipToWindow(all, low, high);
    }
    catch (const InputError& failure)
    {
      rings_.fail(failure.what(), failure.hint());
    }
  }

  /// A set as writePolygons() puts it.
  [[nodiscard]] ContourSet readSet(const Json& list, const Point& size) const
  {
    ContourSet set{ size, {} };
    if (!list.is_array())
      rings_.fail(fmt::format("its contours are a {}, not a list", list.type_name()), polygonKinds);
    for (std::size_t i = 0; i < list.size(); ++i)
    {
      const Json& c = list[i];
      const std::string what = fmt::format("contour {}", i + 1);
      if (!c.is_object() || !c.contains("points") || !c.value("closed", Json(true)).is_boolean() ||
        !c.value("lumen", Json(0)).is_number_integer())
      {
        rings_.fail(what + " is not an object of points, closed and lumen",
          R"(write {"points": [[x, y], …], "closed": true, "lumen": 1})");
      }
      Contour contour{ rings_.points(c["points"], what), c.value("closed", true), c.value("lumen", std::int32_t{ 0 }) };
      for (Point& p : contour.points)
        p = { p[0] * unit_, p[1] * unit_ };
      set.contours.push_back(std::move(contour));
    }
    return set;
  }

  void readOwn(PolygonFile& file)
  {
    unit_ = rings_.findUnit(json_, options_.unit);
    if (!json_.contains("size"))
      rings_.fail("it does not say the picture's size", R"(write "size": [width, height])");
    const Polygon size = rings_.points(Json::array({ json_["size"] }), "the picture's size");
    const Point metres{ size[0][0] * unit_, size[0][1] * unit_ };
    if (!(metres[0] > 0 && metres[1] > 0 && metres[0] <= largestPicture && metres[1] <= largestPicture))
      rings_.fail(fmt::format("its picture measures {:g} × {:g} m", metres[0], metres[1]), "give a size up to 1 m");
    if (options_.yDown)
    {
      throw ParameterError(
        fmt::format("'{}' says its picture's size, and the way of y was given", name_), "read it as it is");
    }
    file.lumens = readSet(json_["contours"], metres);
    if (file.lumens.contours.empty())
      rings_.fail("it has no contours", polygonKinds);
    requireValid(file.lumens, fmt::format("'{}'", name_));
    if (json_.contains("cells"))
      file.cells = soundCells(readSet(json_["cells"], metres), [this](std::size_t cell) { leaveOut(cell); });
    if (options_.window)
      cropOwn(file);
  }

  void cropOwn(PolygonFile& file) const
  {
    const auto& w = *options_.window;
    const Point low{ w[0] * unit_, w[1] * unit_ };
    const Point high{ w[2] * unit_, w[3] * unit_ };
    try
    {
      file.lumens = cropContours(file.lumens, low, high);
    }
    catch (const InputError& failure)
    {
      rings_.fail(failure.what(), failure.hint());
    }
    file.origin = low;
    if (file.cells)
      file.cells = cropCells(*file.cells, low, high);
  }

  RingReader rings_;
  std::vector<std::size_t> cellNumbers_; ///< in the file, from 1, of the outlines of cells
  const std::string& name_;
  PolygonReadOptions options_;
  Json json_;
  double unit_ = 1;
};

[[nodiscard]] Json jsonOf(const ContourSet& set)
{
  Json list = Json::array();
  for (const Contour& c : set.contours)
    list.push_back({ { "closed", c.closed }, { "lumen", c.lumen }, { "points", c.points } });
  return list;
}

} // namespace

PolygonFile readPolygons(const std::filesystem::path& path, const PolygonReadOptions& options)
{
  return Reader(path, options).read();
}

void writePolygons(const ContourSet& lumens, const std::filesystem::path& path, const ContourSet* cells)
{
  Json json{ { "units", "metre" }, { "size", lumens.size }, { "contours", jsonOf(lumens) } };
  if (cells != nullptr)
    json["cells"] = jsonOf(*cells);
  writeText(json.dump() + "\n", path);
}

} // namespace lamella::micrograph
