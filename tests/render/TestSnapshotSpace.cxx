// Pictures of volumes, lines and surfaces.

#include "Pixels.h"
#include "Samples.h"

#include "vtkOffScreenWindows.h"
#include "vtkSnapshot.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>

#include <gtest/gtest.h>

#include <cmath>

using pixels::Rgb;

namespace
{

constexpr Rgb StoneColor{ 0xdc, 0xc0, 0x92 };
constexpr Rgb White{ 255, 255, 255 };

class SnapshotSpace : public testing::Test
{
protected:
  void SetUp() override
  {
    if (vtkOffScreenWindows::GetBackend() == std::string("none"))
      GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
    this->Snapshot->SetShowLegend(false);
  }
  vtkImageData* draw(vtkDataObject* data)
  {
    this->Snapshot->SetInputData(data);
    vtkImageData* picture = this->Snapshot->Draw();
    EXPECT_NE(picture, nullptr) << this->Snapshot->GetErrorMessage();
    return picture;
  }
  pixels::Rect data() const
  {
    const int* r = this->Snapshot->GetDataRectangle();
    return { r[0], r[1], r[2], r[3] };
  }
  vtkNew<vtkSnapshot> Snapshot;
};

} // namespace

TEST_F(SnapshotSpace, SolidStandsInTheLight)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkImageData* picture = this->draw(samples::volume());
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  EXPECT_GT(pixels::shareOf(picture, r, StoneColor), 0.05) << "the top keeps the phase's colour";
  EXPECT_GT(pixels::distinctColors(picture, r), 50U) << "hollows are shaded";
  // corners of the rectangle lie outside the box's outline
  EXPECT_EQ(pixels::at(picture, r.x + 1, r.y + 1), White);
  EXPECT_EQ(pixels::at(picture, r.x + r.width - 2, r.y + r.height - 2), White);
}

TEST_F(SnapshotSpace, FromAboveItIsAPlan)
{
  // Looked at from straight above, with x to the right: each column shows its uppermost solid voxel.
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetAzimuth(-90);
  this->Snapshot->SetElevation(90);
  this->Snapshot->SetShowScaleBar(false);
  vtkImageData* picture = this->draw(samples::volume());
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  EXPECT_NEAR(static_cast<double>(r.width) / r.height, 24.0 / 20, 0.01);
  const auto column = [&](int i, int j)
  { return pixels::at(picture, r.x + (2 * i + 1) * r.width / 48, r.y + (2 * j + 1) * r.height / 40); };
  EXPECT_EQ(column(8, 9), White) << "the hole goes right through";
  EXPECT_EQ(column(2, 2), StoneColor);
  EXPECT_EQ(column(20, 9), StoneColor) << "above the hole along x";
  // the pair that must fail: without the hole it is closed
  auto closed = samples::volume();
  samples::addField<vtkUnsignedCharArray>(closed, "phase", { [](int, int, int) { return 1.0; } });
  picture = this->draw(closed);
  EXPECT_EQ(column(8, 9), StoneColor);
}

TEST_F(SnapshotSpace, FieldOnTheCutBox)
{
  this->Snapshot->SetPreset(vtkSnapshot::CONCENTRATION);
  vtkImageData* picture = this->draw(samples::volume());
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[1], 1);
  // 16 levels, on faces of three directions (full, 0.95 and 0.88 of the colour), and edges
  EXPECT_GE(pixels::distinctColors(picture, r), 40U);
  // the highest level, viridis at 15.5/16, lies on the top
  EXPECT_GT(pixels::shareOf(picture, r, pixels::at(picture, r.x + r.width / 3, r.y + 9 * r.height / 10)), 0.05);
}

TEST_F(SnapshotSpace, TranslucentSolidShowsMore)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetSize(400, 400);
  vtkNew<vtkImageData> opaque;
  opaque->DeepCopy(this->draw(samples::volume()));
  this->Snapshot->SetOpacity(0.3);
  vtkImageData* translucent = this->draw(samples::volume());
  EXPECT_GT(pixels::difference(opaque, translucent, this->data(), 10), 0.3);
}

TEST_F(SnapshotSpace, OnlyTheRange)
{
  this->Snapshot->SetPreset(vtkSnapshot::CONCENTRATION);
  this->Snapshot->OnlyRangeOn();
  this->Snapshot->SetInputData(samples::volume());
  EXPECT_EQ(this->Snapshot->Draw(), nullptr);
  EXPECT_NE(std::string(this->Snapshot->GetErrorMessage()).find("no range"), std::string::npos);
  const auto inked = [&](double low, double high)
  {
    this->Snapshot->SetRange(low, high);
    vtkImageData* picture = this->draw(samples::volume());
    return 1 - pixels::shareOf(picture, this->data(), White);
  };
  const double whole = inked(0, 1);
  const double upper = inked(0.8, 1); // a fifth of the box, with all of its top
  EXPECT_LT(upper, 0.85 * whole);
  EXPECT_GT(upper, 0.3 * whole);
  EXPECT_LT(inked(1.5, 2), 0.05) << "nothing but the edges of the box";
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  EXPECT_EQ(this->Snapshot->Draw(), nullptr) << "phases have no range";
  this->Snapshot->OnlyRangeOff();
  this->Snapshot->SetUntilEvent(5);
  EXPECT_EQ(this->Snapshot->Draw(), nullptr) << "there is nothing inside";
}

TEST_F(SnapshotSpace, ASurfaceInsideATranslucentSolid)
{
  const auto sample = samples::volume();
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> events;
  events->SetName("event");
  std::array<double, 6> b{};
  sample->GetBounds(b.data());
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      points->InsertNextPoint(b[static_cast<std::size_t>(k)], b[static_cast<std::size_t>(2 + j)], (b[4] + b[5]) / 2);
  cells->InsertNextCell({ 0, 1, 2 });
  cells->InsertNextCell({ 1, 2, 3 });
  events->InsertNextValue(1);
  events->InsertNextValue(100);
  vtkNew<vtkPolyData> crack;
  crack->SetPoints(points);
  crack->SetPolys(cells);
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetSize(400, 400);
  this->Snapshot->SetOpacity(0.2);
  vtkNew<vtkImageData> without;
  without->DeepCopy(this->draw(sample));
  this->Snapshot->SetOverlayLines(crack);
  vtkNew<vtkImageData> plain;
  plain->DeepCopy(this->draw(sample));
  EXPECT_GT(pixels::difference(without, plain, this->data(), 10), 0.2);
  crack->GetCellData()->AddArray(events); // a colour bar, and a triangle of either end
  vtkImageData* colored = this->draw(sample);
  ASSERT_NE(colored, nullptr);
  EXPECT_GT(pixels::difference(plain, colored, this->data(), 10), 0.2);
  this->Snapshot->SetUntilEvent(50); // the first triangle
  vtkNew<vtkImageData> first;
  first->DeepCopy(this->draw(sample));
  EXPECT_GT(pixels::difference(without, first, this->data(), 10), 0.1);
  EXPECT_GT(pixels::difference(plain, first, this->data(), 10), 0.1);
  this->Snapshot->SetUntilEvent(0);
  const int alone = this->data().width;
  this->Snapshot->SetShowLegend(true);
  ASSERT_NE(this->draw(sample), nullptr);
  EXPECT_LT(this->data().width, alone) << "a colour bar of events and the phase take their room";
}

TEST_F(SnapshotSpace, TransparentBackgroundOfAVolume)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->TransparentOn();
  vtkImageData* picture = this->draw(samples::volume());
  const pixels::Rect r = this->data();
  EXPECT_EQ(pixels::alphaAt(picture, r.x + 1, r.y + 1), 0);
  EXPECT_EQ(pixels::alphaAt(picture, r.x + r.width / 2, r.y + r.height / 2), 255);
}

TEST_F(SnapshotSpace, FlatLinesAreSeenFromAbove)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkDoubleArray> values;
  values->SetName("load");
  for (int k = 0; k < 3; ++k)
  {
    const auto first = points->InsertNextPoint(0, 1e-6 * k, 0);
    points->InsertNextPoint(4e-6, 1e-6 * k, 0);
    cells->InsertNextCell({ first, first + 1 });
    values->InsertNextValue(k);
  }
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(points);
  lines->SetLines(cells);
  // as in the file of a crack's surfaces: a vector of unit length, then numbers; by itself a number is drawn
  vtkNew<vtkDoubleArray> normals;
  normals->SetName("normal");
  normals->SetNumberOfComponents(3);
  for (int k = 0; k < 3; ++k)
    normals->InsertNextTuple3(0, 0, 1);
  lines->GetCellData()->AddArray(normals);
  lines->GetCellData()->AddArray(values);
  vtkImageData* picture = this->draw(lines);
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  // Up the middle: background, then three lines in the colours of 0, 1/2 and 1 of viridis, from below.
  std::vector<Rgb> found;
  for (int y = r.y; y < r.y + r.height; ++y)
  {
    const Rgb color = pixels::at(picture, r.x + r.width / 2, y);
    const bool pure = color == pixels::at(picture, r.x + r.width / 2, y + 1);
    if (color != White && pure && (found.empty() || found.back() != color))
      found.push_back(color);
  }
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0], (Rgb{ 0x44, 0x01, 0x54 }));
  EXPECT_EQ(found[1], (Rgb{ 0x21, 0x91, 0x8c }));
  EXPECT_EQ(found[2], (Rgb{ 0xfd, 0xe7, 0x25 }));
}

TEST_F(SnapshotSpace, SurfacesWithoutArraysAreDrawnPlain)
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0, 0, 0);
  points->InsertNextPoint(1e-3, 0, 0);
  points->InsertNextPoint(0, 1e-3, 0);
  points->InsertNextPoint(0, 0, 1e-3);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0, 2, 1 });
  cells->InsertNextCell({ 0, 1, 3 });
  cells->InsertNextCell({ 0, 3, 2 });
  cells->InsertNextCell({ 1, 2, 3 });
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(points);
  surface->SetPolys(cells);
  vtkImageData* picture = this->draw(surface);
  ASSERT_NE(picture, nullptr);
  EXPECT_GE(pixels::distinctColors(picture, this->data()), 4U);

  // A scale bar in metres, in pixels of a picture whose size nobody gave, and none where coordinates are no lengths.
  const pixels::Rect r = this->data();
  const auto inked = [&](const char* name, const char* text)
  {
    vtkNew<vtkStringArray> words;
    words->SetName(name);
    words->InsertNextValue(text);
    surface->GetFieldData()->Initialize();
    surface->GetFieldData()->AddArray(words);
    this->Snapshot->Modified();
    return pixels::shareOf(this->draw(surface), r, Rgb{ 28, 28, 30 });
  };
  const double bare = inked("length_unit", "1");
  EXPECT_GT(inked("length_unit", "m"), bare + 1e-4);
  EXPECT_GT(inked("pixel_size_source", "none"), bare + 1e-4);
}
