#include "ContourShapes.h"
#include "outlines/MiddleLamella.h"
#include "pictures/Picture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

using namespace lamella;
using namespace lamella::micrograph;

namespace
{

struct Tissue
{
  const char* name;
  Point corner; ///< of the label picture, in the polygons' frame [m]; found by matching the lumens, no scaling, no turn
  double solid; ///< share of wall in the label picture
  double dice;  ///< least overlap of the lamella
  double beside; ///< least share of theirs within a node of ours
};

/// Lumens and outer outlines of the cells, counter-clockwise, cells numbered from 1.
struct Cells
{
  ContourSet lumens;
  std::vector<Contour> outer;
};

Contour chain(const nlohmann::json& points, const Point& corner, std::int32_t lumen)
{
  Contour contour{ {}, true, lumen };
  for (std::size_t i = 1; i < points.size(); ++i) // the last point is the first again
  {
    contour.points.push_back(
      { points[i][0].get<double>() * 1e-6 - corner[0], points[i][1].get<double>() * 1e-6 - corner[1] });
  }
  if (lamella::testing::areaOf(contour) < 0)
    std::reverse(contour.points.begin(), contour.points.end());
  return contour;
}

Cells readCells(const std::string& folder, const Tissue& tissue, const std::array<double, 2>& size)
{
  const std::string path = folder + "/spruce_" + tissue.name + "_polygons.json.gz";
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  std::array<char, 65536> buffer;
  for (int got = 0; (got = gzread(file, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(got));
  gzclose(file);
  const nlohmann::json json = nlohmann::json::parse(text);
  Cells cells{ { size, {} }, {} };
  for (const nlohmann::json& cell : json["cells"])
  {
    const auto number = static_cast<std::int32_t>(cells.outer.size()) + 1;
    cells.lumens.contours.push_back(chain(cell["lumen"], tissue.corner, number));
    cells.outer.push_back(chain(cell["outer"], tissue.corner, number));
  }
  return cells;
}

/// Distance to a closed chain and the direction of the segment there as (cos 2θ, sin 2θ).
struct Near
{
  double distance = 1e300;
  Point doubled{ 0, 0 };
};

Near nearOf(const Contour& contour, const Point& p)
{
  Near near;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
  {
    const Point& a = contour.points[i];
    const Point& b = contour.points[(i + 1) % contour.points.size()];
    const Point way{ b[0] - a[0], b[1] - a[1] };
    const double length2 = way[0] * way[0] + way[1] * way[1];
    const double t = std::clamp(((p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1]) / length2, 0.0, 1.0);
    const double distance = std::hypot(p[0] - a[0] - t * way[0], p[1] - a[1] - t * way[1]);
    if (distance < near.distance)
      near = { distance, { (way[0] * way[0] - way[1] * way[1]) / length2, 2 * way[0] * way[1] / length2 } };
  }
  return near;
}

bool inside(const Contour& contour, const Point& p)
{
  bool in = false;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
  {
    const Point& a = contour.points[i];
    const Point& b = contour.points[(i + 1) % contour.points.size()];
    if ((a[1] <= p[1]) != (b[1] <= p[1]) && a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) < p[0])
      in = !in;
  }
  return in;
}

/// Where three cells meet on the lattice.
std::vector<Point> corners(const Lattice& lattice, const std::vector<std::int32_t>& grain)
{
  std::vector<Point> points;
  for (std::int64_t y = 0; y + 1 < lattice.size[1]; ++y)
  {
    for (std::int64_t x = 0; x + 1 < lattice.size[0]; ++x)
    {
      const auto node = static_cast<std::size_t>(lattice.index(x, y));
      const auto above = static_cast<std::size_t>(lattice.index(x, y + 1));
      if (std::set<std::int32_t>{ grain[node], grain[node + 1], grain[above], grain[above + 1] }.size() > 2)
      {
        points.push_back(
          { static_cast<double>(x + 1) * lattice.spacing, static_cast<double>(y + 1) * lattice.spacing });
      }
    }
  }
  return points;
}

/// Share of the lamella of one picture that lies on or beside a node of lamella of another.
double besides(const PhaseImage& of, const PhaseImage& other)
{
  std::int64_t beside = 0;
  std::int64_t all = 0;
  for (std::int64_t y = 0; y < of.lattice.size[1]; ++y)
  {
    for (std::int64_t x = 0; x < of.lattice.size[0]; ++x)
    {
      if (of.phase[static_cast<std::size_t>(of.lattice.index(x, y))] != 2)
        continue;
      ++all;
      bool found = false;
      for (std::int64_t v = std::max<std::int64_t>(0, y - 1); v <= std::min(of.lattice.size[1] - 1, y + 1); ++v)
        for (std::int64_t u = std::max<std::int64_t>(0, x - 1); u <= std::min(of.lattice.size[0] - 1, x + 1); ++u)
          found = found || other.phase[static_cast<std::size_t>(other.lattice.index(u, v))] == 2;
      beside += found;
    }
  }
  return static_cast<double>(beside) / static_cast<double>(all);
}

class SpruceWalls : public ::testing::TestWithParam<Tissue>
{
};

} // namespace

TEST_P(SpruceWalls, DirectionsAndLamella)
{
  const char* const data = std::getenv("LAMELLA_REAL_DATA");
  if (data == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA is not set";
  const Tissue& tissue = GetParam();
  ReadOptions read;
  read.pixelSize = 0.5e-6;
  const Picture labels = readPicture(std::string(data) + "/spruce_" + tissue.name + "_labels_0.5um.png", read);
  const Cells cells = readCells(data, tissue, { labels.lattice.length(0), labels.lattice.length(1) });
  ContourLatticeOptions options;
  options.spacing = 0.5e-6;
  options.lines = 0;
  const ContourLattice lattice = contourLattice(cells.lumens, options);
  ASSERT_EQ(lattice.image.lattice.count(), labels.lattice.count());
  const WallDirections directions = wallDirections(cells.lumens, lattice);

  // Directions: from each cell's lumen to its own outer outline, which the solver never saw.
  const std::vector<Point> meeting = corners(lattice.image.lattice, directions.grain);
  double sum = 0;
  int count = 0;
  for (std::size_t node = 0; node < lattice.image.phase.size(); ++node)
  {
    const auto nx = static_cast<std::size_t>(lattice.image.lattice.size[0]);
    const Point p{ (static_cast<double>(node % nx) + 0.5) * 0.5e-6, (static_cast<double>(node / nx) + 0.5) * 0.5e-6 };
    const std::int32_t cell = directions.grain[node];
    const double thickness =
      static_cast<double>(directions.nearest[node]) + static_cast<double>(directions.second[node]);
    // The picture's lower left shows tissue only where cells are: walls at the tissue's own edge have no other lumen.
    if (lattice.image.phase[node] == 0 || labels.grey[node] == 0 ||
      !inside(cells.outer[static_cast<std::size_t>(cell - 1)], p) ||
      std::any_of(meeting.begin(), meeting.end(),
        [&](const Point& m) { return std::hypot(m[0] - p[0], m[1] - p[1]) < thickness; }))
      continue;
    const Near lumen = nearOf(cells.lumens.contours[static_cast<std::size_t>(cell - 1)], p);
    const Near outer = nearOf(cells.outer[static_cast<std::size_t>(cell - 1)], p);
    const double share = lumen.distance / (lumen.distance + outer.distance);
    const Point truth{ (1 - share) * lumen.doubled[0] + share * outer.doubled[0],
      (1 - share) * lumen.doubled[1] + share * outer.doubled[1] };
    const double c = static_cast<double>(directions.axis[node][0]);
    const double s = static_cast<double>(directions.axis[node][1]);
    const double cosine = ((c * c - s * s) * truth[0] + 2 * c * s * truth[1]) / std::hypot(truth[0], truth[1]);
    sum += std::acos(std::clamp(cosine, -1.0, 1.0)) / 2 * 180 / std::numbers::pi;
    ++count;
  }
  RecordProperty("nodes", count);
  RecordProperty("mean_degrees", std::to_string(sum / count));
  EXPECT_GT(count, 40000);
  EXPECT_LT(sum / count, 0.5) << "0.02 and 0.20 when written";

  // Lamella: both are about one node thick, and theirs runs between outlines that were drawn, not half-way between
  // lumens; so what counts is that each lies within a node of the other.
  const MiddleLamella found = middleLamella(lattice, directions);
  const PhaseImage theirs = lamellaFromLabels(labels.lattice, labels.grey);
  const NodesAcross across = nodesAcross(lattice, directions, theirs.phase);
  RecordProperty("dice", std::to_string(overlap(found.image.phase, theirs.phase, 2)));
  RecordProperty("theirs_beside_ours", std::to_string(besides(theirs, found.image)));
  RecordProperty("ours_beside_theirs", std::to_string(besides(found.image, theirs)));
  RecordProperty("nodes_across", std::to_string(found.across.mean));
  RecordProperty("nodes_across_theirs", std::to_string(across.mean));
  EXPECT_GT(overlap(found.image.phase, theirs.phase, 2), tissue.dice);
  EXPECT_GT(besides(theirs, found.image), tissue.beside);
  EXPECT_GT(besides(found.image, theirs), 0.93);
  EXPECT_NEAR(found.across.mean, across.mean, 1);
  EXPECT_GT(found.largestNetwork, 0.99);
  EXPECT_EQ(found.cellsTouched, found.cells);
  EXPECT_LE(found.cellsCutOff, 1)
    << "a cell in a corner of the earlywood's picture, between whose lamella and the rest "
       "lies the border";
  // Their rasteriser counts pixels on an outline as void, a few thousandths of the wall.
  EXPECT_NEAR(1 - lattice.lumenFraction, tissue.solid, 0.005 * tissue.solid);
}

INSTANTIATE_TEST_SUITE_P(Tissues, SpruceWalls,
  ::testing::Values(
    Tissue{ "EW", { 60e-6, 20e-6 }, 0.1997, 0.78, 0.995 }, Tissue{ "LW", { 12e-6, 22e-6 }, 0.6094, 0.5, 0.95 }),
  [](const auto& tissue) { return std::string(tissue.param.name); });
