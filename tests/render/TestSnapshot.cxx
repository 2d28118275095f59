// Pictures of pixels: exact colours at known places, what lies on them, what stands around them.

#include "Pixels.h"
#include "Samples.h"

#include "vtkOffScreenWindows.h"
#include "vtkSnapshot.h"

#include <vtkPNGReader.h>
#include <vtkPolyData.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

using pixels::Rgb;

namespace
{

constexpr Rgb VoidColor{ 0xf6, 0xf3, 0xea };
constexpr Rgb WallColor{ 0xc6, 0x8e, 0x5a };
constexpr Rgb LamellaColor{ 0x6a, 0x3d, 0x23 };
constexpr Rgb Undefined{ 198, 198, 198 };
constexpr Rgb White{ 255, 255, 255 };
constexpr Rgb Ink{ 28, 28, 30 };

class SnapshotTest : public testing::Test
{
protected:
  vtkImageData* draw()
  {
    this->Snapshot->SetInputData(this->Image);
    vtkImageData* picture = this->Snapshot->Draw();
    EXPECT_NE(picture, nullptr) << this->Snapshot->GetErrorMessage();
    return picture;
  }
  pixels::Rect data() const
  {
    const int* r = this->Snapshot->GetDataRectangle();
    return { r[0], r[1], r[2], r[3] };
  }
  /// Colour in the middle of a pixel of the data.
  Rgb colorOf(vtkImageData* picture, int i, int j) const
  {
    const pixels::Rect r = this->data();
    const int* n = this->Image->GetDimensions();
    return pixels::at(picture, r.x + (2 * i + 1) * r.width / (2 * n[0]), r.y + (2 * j + 1) * r.height / (2 * n[1]));
  }
  /// Pixels of the picture in the data's rectangle that do not have the colour of their phase.
  int wrongPhases(vtkImageData* picture) const
  {
    const pixels::Rect r = this->data();
    const int scale = r.width / this->Image->GetDimensions()[0];
    int wrong = 0;
    for (int y = 0; y < r.height; ++y)
    {
      for (int x = 0; x < r.width; ++x)
      {
        const int phase = samples::tissuePhase(x / scale, y / scale);
        const Rgb expected = phase == 0 ? VoidColor : phase == 1 ? WallColor : LamellaColor;
        wrong += pixels::at(picture, r.x + x, r.y + y) == expected ? 0 : 1;
      }
    }
    return wrong;
  }
  bool canDrawLines() const { return vtkOffScreenWindows::GetBackend() != std::string("none"); }

  vtkSmartPointer<vtkImageData> Image = samples::tissue();
  vtkNew<vtkSnapshot> Snapshot;
};

} // namespace

TEST_F(SnapshotTest, PhasesAreExact)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  EXPECT_EQ(r.width, 1200) << "ten picture pixels for each of 120";
  EXPECT_EQ(r.height, 960);
  EXPECT_EQ(this->wrongPhases(picture), 0);
  EXPECT_EQ(pixels::distinctColors(picture, r), 3U);
  // The pair that must fail: one pixel of another phase is 100 wrong picture pixels.
  this->Image->GetPointData()->GetArray("phase")->SetComponent(
    120 * 40 + 10, 0, (samples::tissuePhase(10, 40) + 1) % 3);
  EXPECT_EQ(this->wrongPhases(this->draw()), 100);
}

TEST_F(SnapshotTest, PhasesNeedNoOpenGL)
{
  setenv("LAMELLA_RENDERER", "x", 1); // does not work without a display
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkImageData* picture = this->draw();
  unsetenv("LAMELLA_RENDERER");
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(this->wrongPhases(picture), 0);
}

TEST_F(SnapshotTest, PhasesKeepTheirColorsByName)
{
  this->Image->GetFieldData()->RemoveArray("phase_names");
  samples::addStrings(this->Image, "phase_names", { "middle lamella", "lumen", "cell wall" });
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkImageData* picture = this->draw();
  EXPECT_EQ(this->colorOf(picture, 10, 8), LamellaColor); // id 0
  this->Snapshot->SetPhaseColor("lumen", 1, 0, 0.5);
  EXPECT_EQ(this->colorOf(this->draw(), 2, 40), (Rgb{ 255, 0, 128 })); // id 1
}

TEST_F(SnapshotTest, FewerPixelsThanDataAreAveraged)
{
  // Alternating columns of two phases, two to each picture pixel: each takes the mean of the two colours.
  this->Image = samples::lattice(4000, 60, 1, 1e-6);
  samples::addStrings(this->Image, "phase_names", { "lumen", "wall" });
  samples::addField<vtkUnsignedCharArray>(this->Image, "phase", { [](int i, int, int) { return i % 2; } });
  this->Snapshot->SetShowLegend(false);
  this->Snapshot->SetShowScaleBar(false);
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  const pixels::Rect r = this->data();
  EXPECT_EQ(r.width, 1500);
  const Rgb color = pixels::at(picture, r.x + 600, r.y + r.height / 2);
  for (std::size_t c = 0; c < 3; ++c)
  {
    // 2.67 columns a pixel: between 1/2.67 and 1.67/2.67 of each
    EXPECT_NEAR(color[c], 0.5 * (VoidColor[c] + WallColor[c]), 0.14 * std::abs(VoidColor[c] - WallColor[c]));
  }
}

TEST_F(SnapshotTest, TemperatureRunsThroughTheWholeMap)
{
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->ShowOutlineOff();
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[0], 0);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[1], 1);
  // inferno at 0.5/96 and 95.5/96: within 3 of its published ends, 0x000004 and 0xfcffa4
  const Rgb bottom = this->colorOf(picture, 60, 0);
  const Rgb top = this->colorOf(picture, 60, 95);
  EXPECT_NEAR(bottom[0], 0, 3);
  EXPECT_NEAR(bottom[2], 4, 4);
  EXPECT_NEAR(top[0], 0xfc, 3);
  EXPECT_NEAR(top[1], 0xff, 3);
  EXPECT_NEAR(top[2], 0xa4, 6);
  EXPECT_EQ(this->colorOf(picture, 10, 40), Undefined) << "NaN in the first lumens";
  EXPECT_GE(pixels::distinctColors(picture, this->data()), 90U) << "96 rows";
  // a row has one colour: never shaded, never interpolated across
  EXPECT_EQ(this->colorOf(picture, 30, 50), this->colorOf(picture, 110, 50));
}

TEST_F(SnapshotTest, RangeIsKept)
{
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->SetColorMap("gray");
  this->Snapshot->ShowOutlineOff();
  this->Snapshot->SetRange(0.25, 0.75);
  vtkImageData* picture = this->draw();
  EXPECT_EQ(this->colorOf(picture, 60, 10), (Rgb{ 0, 0, 0 })) << "0.11 lies below";
  EXPECT_EQ(this->colorOf(picture, 60, 85), White) << "0.89 lies above";
  EXPECT_NEAR(this->colorOf(picture, 60, 48)[0], 255 * (48.5 / 96 - 0.25) / 0.5, 1);
}

TEST_F(SnapshotTest, FluxIsRelativeToItsMean)
{
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  this->Snapshot->SetOverlay(vtkSnapshot::NO_OVERLAY);
  this->Snapshot->ShowOutlineOff();
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  // layers of 1 and 4, 8 of 15 weak: mean (8 + 7 × 4)/15 = 2.4; the strong ones carry 1.667 of it
  EXPECT_GE(this->Snapshot->GetDrawnRange()[1], 4 / 2.4);
  EXPECT_LE(this->Snapshot->GetDrawnRange()[1], 1.2 * 4 / 2.4);
  EXPECT_EQ(pixels::distinctColors(picture, this->data()), 3U) << "two layers, and grey where the temperature is NaN";
  this->Snapshot->RelativeFluxOff();
  this->draw();
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[1], 4);
}

TEST_F(SnapshotTest, FluxHasLinesWhereItFlows)
{
  if (!this->canDrawLines())
    GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  this->Snapshot->ShowOutlineOff();
  this->Snapshot->SetOverlayCount(20);
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  // On a row of the picture: whiter than any colour of the map, one run a line.
  const pixels::Rect r = this->data();
  int lines = 0;
  int inStrongLayers = 0;
  bool inLine = false;
  for (int x = 0; x < r.width; ++x)
  {
    const Rgb color = pixels::at(picture, r.x + x, r.y + r.height / 2 + 7);
    const bool white = color[2] > 225;
    lines += white && !inLine ? 1 : 0;
    inStrongLayers += white && !inLine && samples::layerFlux(120 * x / r.width) > 2 ? 1 : 0;
    inLine = white;
  }
  EXPECT_EQ(lines, 20);
  EXPECT_GE(inStrongLayers, 15) << "28 of 36 parts of the flow";
}

TEST_F(SnapshotTest, ArrowsPointAlongTheFlux)
{
  if (!this->canDrawLines())
    GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  this->Snapshot->ShowOutlineOff();
  this->Snapshot->SetOverlay(vtkSnapshot::ARROWS_OVERLAY);
  this->Snapshot->SetOverlayCount(2); // blocks of 60: one arrow each, downwards
  vtkImageData* picture = this->draw();
  const pixels::Rect r = this->data();
  const auto widthOfWhite = [&](int y)
  {
    int width = 0;
    for (int x = 0; x < r.width / 2; ++x)
      width += pixels::at(picture, r.x + x, y)[2] > 225 ? 1 : 0;
    return width;
  };
  // Blocks are 600 × 480; the arrow in the lower one spans 0.9 of it: tail near its top, head near its bottom.
  EXPECT_GT(widthOfWhite(r.y + 24 + 16), widthOfWhite(r.y + 440)) << "the head is broader than the shaft";
  EXPECT_GT(widthOfWhite(r.y + 440), 0);
}

TEST_F(SnapshotTest, IsolinesAndOutline)
{
  if (!this->canDrawLines())
    GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  this->Snapshot->ShowOutlineOff();
  vtkNew<vtkImageData> plain;
  plain->DeepCopy(this->draw());
  const pixels::Rect r = this->data();
  this->Snapshot->SetOverlay(vtkSnapshot::ISOLINES_OVERLAY);
  this->Snapshot->SetOverlayCount(5);
  const double isolines = pixels::difference(plain, this->draw(), r, 20);
  EXPECT_GT(isolines, 0.005);
  EXPECT_LT(isolines, 0.05);
  this->Snapshot->SetOverlay(vtkSnapshot::NO_OVERLAY);
  EXPECT_EQ(pixels::difference(plain, this->draw(), r, 0), 0) << "the same again is the same";
  this->Snapshot->ShowOutlineOn();
  const double outline = pixels::difference(plain, this->draw(), r, 20);
  EXPECT_GT(outline, 0.005);
  EXPECT_LT(outline, 0.05);
}

TEST_F(SnapshotTest, GrainsDifferFromTheirNeighbours)
{
  this->Snapshot->SetPreset(vtkSnapshot::GRAIN);
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  for (int a = 0; a < 4; ++a)
  {
    for (int b = 0; b < 4; ++b)
    {
      const Rgb own = this->colorOf(picture, 30 * a + 15, 24 * b + 12);
      if (a < 3)
        EXPECT_NE(own, this->colorOf(picture, 30 * a + 45, 24 * b + 12));
      if (b < 3)
        EXPECT_NE(own, this->colorOf(picture, 30 * a + 15, 24 * b + 36));
    }
  }
}

TEST_F(SnapshotTest, ValuesOnBothSidesOfZeroAreCentred)
{
  this->Snapshot->SetArrayName("stress");
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[0], -1e6);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[1], 1e6);
  const Rgb cold = this->colorOf(picture, 0, 50);
  const Rgb warm = this->colorOf(picture, 119, 50);
  EXPECT_GT(cold[2], cold[0] + 100) << "blue";
  EXPECT_GT(warm[0], warm[2] + 100) << "red";
}

// A tensor is shown by its component along the load, over the stress on the platen; voids are grey, 0 is blue.
TEST_F(SnapshotTest, StressIsThatAlongTheLoad)
{
  this->Image = samples::lattice(50, 40, 1, 1e-6);
  samples::addField(this->Image, "phase", { [](int i, int, int) { return i < 10 ? 0.0 : 1.0; } });
  const auto zero = [](int, int, int) { return 0.0; };
  const auto rising = [](int i, int, int) { return i < 10 ? 0.0 : 2e6 * (i < 20 ? 0 : i < 30 ? 1 : 3); };
  samples::addField(this->Image, "stress", { zero, rising, zero, zero, zero, zero });
  vtkNew<vtkDoubleArray> platen;
  platen->SetName("effective_stress");
  platen->InsertNextValue(2e6);
  this->Image->GetFieldData()->AddArray(platen);
  vtkImageData* picture = this->draw(); // the preset follows from the name, y from the picture
  ASSERT_NE(picture, nullptr);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[0], 0);
  EXPECT_DOUBLE_EQ(this->Snapshot->GetDrawnRange()[1], 3);
  EXPECT_EQ(this->colorOf(picture, 3, 20), Undefined);
  EXPECT_EQ(this->colorOf(picture, 15, 20), (Rgb{ 0x31, 0x36, 0x95 })); // both ends of the map
  EXPECT_EQ(this->colorOf(picture, 40, 20), (Rgb{ 0xa5, 0x00, 0x26 }));
  vtkNew<vtkStringArray> axis;
  axis->SetName("load_axis");
  axis->InsertNextValue("x");
  this->Image->GetFieldData()->AddArray(axis);
  this->Snapshot->SetRange(0, 3);
  picture = this->draw();
  EXPECT_EQ(this->colorOf(picture, 40, 20), (Rgb{ 0x31, 0x36, 0x95 })) << "nothing along x";
}

// What moves or breaks is the solid: voids are grey. Of an array of another name nobody knows what its 0 means.
TEST_F(SnapshotTest, VoidsNeitherMoveNorBreak)
{
  this->Image = samples::lattice(50, 40, 1, 1e-6);
  samples::addField(this->Image, "phase", { [](int i, int, int) { return i < 10 ? 0.0 : 1.0; } });
  const auto rising = [](int i, int, int) { return i < 10 ? 0.0 : 0.01 * i; };
  for (const char* const name : { "displacement", "damage", "broken", "mine" })
  {
    SCOPED_TRACE(name);
    samples::addField(this->Image, name, { rising, rising, rising });
    this->Snapshot->SetArrayName(name);
    vtkImageData* picture = this->draw();
    ASSERT_NE(picture, nullptr);
    EXPECT_EQ(this->colorOf(picture, 3, 20) == Undefined, std::string(name) != "mine");
    EXPECT_NE(this->colorOf(picture, 12, 20), Undefined);
  }
}

// Pores of 1, 10, 100 and 1000 pixels in what is no pore: a third of the colours each, on a logarithmic scale.
TEST_F(SnapshotTest, PoreSizesAreOnALogarithmicScale)
{
  this->Image = samples::lattice(50, 40, 1, 1e-6);
  samples::addField(this->Image, "pore_size",
    { [](int i, int, int) { return i % 10 < 5 ? std::nan("") : std::pow(10.0, std::min(i / 10, 3)); } });
  vtkImageData* picture = this->draw(); // the preset follows from the name
  ASSERT_NE(picture, nullptr);
  EXPECT_NEAR(this->Snapshot->GetDrawnRange()[0], 1, 1e-12); // in sizes, not in powers of ten
  EXPECT_NEAR(this->Snapshot->GetDrawnRange()[1], 1000, 1e-9);
  EXPECT_EQ(this->colorOf(picture, 2, 20), Undefined);
  EXPECT_EQ(this->colorOf(picture, 7, 20), (Rgb{ 0x44, 0x01, 0x54 })); // both ends of viridis
  EXPECT_EQ(this->colorOf(picture, 37, 20), (Rgb{ 0xfd, 0xe7, 0x25 }));
  const Rgb third = this->colorOf(picture, 17, 20); // viridis at 1/3 is about #31688e
  EXPECT_NEAR(third[0], 0x31, 3);
  EXPECT_NEAR(third[1], 0x68, 3);
  EXPECT_NEAR(third[2], 0x8e, 3);
  this->Snapshot->SetRange(10, 100);
  picture = this->draw();
  EXPECT_EQ(this->colorOf(picture, 7, 20), this->colorOf(picture, 17, 20)); // below the range: its first colour
  this->Snapshot->SetPreset(vtkSnapshot::SCALAR); // the pair that must fail: 10 is next to nothing beside 1000
  this->Snapshot->ResetRange();
  EXPECT_NE(this->colorOf(this->draw(), 17, 20), third);
}

TEST_F(SnapshotTest, NothingStandsOnTheData)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetTitle("Tissue");
  this->draw();
  EXPECT_EQ(this->wrongPhases(this->draw()), 0) << "with title, legend and scale bar";
  const pixels::Rect with = this->data();
  this->Snapshot->SetShowLegend(false);
  this->Snapshot->SetShowScaleBar(false);
  this->Snapshot->SetTitle("");
  vtkImageData* bare = this->draw();
  const pixels::Rect without = this->data();
  EXPECT_EQ(with.width, without.width);
  EXPECT_LT(bare->GetDimensions()[1], with.y + with.height + with.y) << "no room is kept for what is not there";
}

TEST_F(SnapshotTest, ScaleBarHasItsLength)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkImageData* picture = this->draw();
  const pixels::Rect r = this->data();
  // 1200 picture pixels are 60 µm; the bar is at most 0.22 of that: 10 µm, 200 pixels. Its row: the longest run of ink.
  int longest = 0;
  for (int y = 0; y < r.y - 5; ++y)
  {
    int run = 0;
    for (int x = 0; x < picture->GetDimensions()[0]; ++x)
    {
      run = pixels::at(picture, x, y) == Ink ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_EQ(longest, 200);
}

TEST_F(SnapshotTest, UnknownPixelSizeIsShownInPixels)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  vtkNew<vtkImageData> metres;
  metres->DeepCopy(this->draw());
  this->Image->GetFieldData()->RemoveArray("pixel_size_source");
  samples::addStrings(this->Image, "pixel_size_source", { "none" });
  this->Image->SetSpacing(1, 1, 1);
  vtkImageData* unknown = this->draw();
  ASSERT_EQ(metres->GetDimensions()[0], unknown->GetDimensions()[0]);
  const pixels::Rect below{ 0, 0, metres->GetDimensions()[0], this->data().y - 5 };
  EXPECT_GT(pixels::difference(metres, unknown, below, 20), 0.001) << "20 pixels instead of 10 µm";
  EXPECT_EQ(this->wrongPhases(unknown), 0);
}

TEST_F(SnapshotTest, SizeIsExact)
{
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  for (const auto& [width, height] : { std::pair{ 800, 600 }, std::pair{ 333, 777 }, std::pair{ 1920, 400 } })
  {
    this->Snapshot->SetSize(width, height);
    vtkImageData* picture = this->draw();
    ASSERT_NE(picture, nullptr);
    EXPECT_EQ(picture->GetDimensions()[0], width);
    EXPECT_EQ(picture->GetDimensions()[1], height);
    const pixels::Rect r = this->data();
    EXPECT_NEAR(static_cast<double>(r.width) / r.height, 120.0 / 96, 0.02) << "the aspect of the data is kept";
    EXPECT_GE(r.x, 0);
    EXPECT_LE(r.x + r.width, width);
    EXPECT_LE(r.y + r.height, height);
  }
}

TEST_F(SnapshotTest, BackgroundAndInk)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->SetBackground(0, 0, 0.2);
  vtkImageData* picture = this->draw();
  EXPECT_EQ(pixels::at(picture, 0, 0), (Rgb{ 0, 0, 51 }));
  const pixels::Rect below{ 0, 0, picture->GetDimensions()[0], this->data().y - 5 };
  EXPECT_GT(pixels::shareOf(picture, below, { 238, 238, 238 }), 0.002) << "light text on a dark ground";
  EXPECT_EQ(pixels::shareOf(picture, below, Ink), 0);
}

TEST_F(SnapshotTest, TransparentBackground)
{
  this->Snapshot->SetPreset(vtkSnapshot::PHASE);
  this->Snapshot->TransparentOn();
  vtkImageData* picture = this->draw();
  ASSERT_EQ(picture->GetNumberOfScalarComponents(), 4);
  const pixels::Rect r = this->data();
  EXPECT_EQ(pixels::alphaAt(picture, 0, 0), 0);
  EXPECT_EQ(pixels::alphaAt(picture, r.x, r.y), 255);
  EXPECT_EQ(pixels::alphaAt(picture, r.x + r.width - 1, r.y + r.height - 1), 255);
  EXPECT_EQ(this->wrongPhases(picture), 0);
}

TEST_F(SnapshotTest, ExtremeShapes)
{
  for (const auto& [nx, ny] : { std::pair{ 1, 1 }, std::pair{ 100000, 1 }, std::pair{ 1, 5000 }, std::pair{ 2, 700 } })
  {
    this->Image = samples::lattice(nx, ny, 1, 1e-6);
    samples::addField(this->Image, "density", { [](int i, int j, int) { return i + 2.0 * j; } });
    vtkImageData* picture = this->draw();
    ASSERT_NE(picture, nullptr) << nx << " × " << ny;
    EXPECT_LE(picture->GetDimensions()[0], 2600);
    EXPECT_LE(picture->GetDimensions()[1], 2600);
    EXPECT_GE(this->data().width, 1);
    EXPECT_GE(this->data().height, 1);
  }
}

TEST_F(SnapshotTest, DirectionsByTheirEndings)
{
  this->Image->GetPointData()->GetArray("temperature")->SetName("temperature_y");
  this->Image->GetPointData()->GetArray("flux")->SetName("flux_y");
  this->Snapshot->SetPreset(vtkSnapshot::TEMPERATURE);
  EXPECT_NE(this->draw(), nullptr);
  this->Snapshot->SetPreset(vtkSnapshot::AUTO);
  this->Snapshot->SetArrayName("flux_y");
  this->Snapshot->SetOverlay(vtkSnapshot::NO_OVERLAY);
  vtkImageData* picture = this->draw();
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(this->colorOf(picture, 10, 40), Undefined) << "drawn as a flux, which knows what does not conduct";
}

TEST_F(SnapshotTest, GivenLinesAreDrawn)
{
  if (!this->canDrawLines())
    GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(30e-6, 0, 0);
  points->InsertNextPoint(30e-6, 48e-6, 0);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0, 1 });
  vtkNew<vtkPolyData> line;
  line->SetPoints(points);
  line->SetLines(cells);
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  this->Snapshot->ShowOutlineOff();
  this->Snapshot->SetOverlayLines(line);
  vtkImageData* picture = this->draw();
  const pixels::Rect r = this->data();
  EXPECT_GT(pixels::at(picture, r.x + r.width / 2, r.y + r.height / 3)[2], 225) << "a white line at x = 30 µm";
  EXPECT_LT(pixels::at(picture, r.x + r.width / 3, r.y + r.height / 3)[2], 225);
}

class SnapshotBackends
  : public SnapshotTest
  , public testing::WithParamInterface<const char*>
{
};

TEST_P(SnapshotBackends, EachDrawsTheSame)
{
  setenv("LAMELLA_RENDERER", GetParam(), 1);
  if (vtkOffScreenWindows::GetBackend() != std::string(GetParam()))
  {
    const std::string whyNot = vtkOffScreenWindows::GetMessage();
    unsetenv("LAMELLA_RENDERER");
    GTEST_SKIP() << whyNot;
  }
  this->Snapshot->SetPreset(vtkSnapshot::FLUX);
  vtkNew<vtkImageData> forced;
  forced->DeepCopy(this->draw());
  unsetenv("LAMELLA_RENDERER");
  vtkImageData* usual = this->draw();
  ASSERT_EQ(forced->GetDimensions()[0], usual->GetDimensions()[0]);
  // Mesa draws the same in all; a graphics card may differ by an edge's shade here and there.
  EXPECT_LT(pixels::difference(forced, usual, pixels::whole(usual), 16), 0.002);
}

INSTANTIATE_TEST_SUITE_P(Forced, SnapshotBackends, testing::Values("osmesa", "egl", "x"),
  [](const auto& backend) { return std::string(backend.param); });

TEST(SnapshotOfRealData, LatewoodPhasesAreExact)
{
  const char* folder = std::getenv("LAMELLA_REAL_DATA");
  if (!folder || !*folder)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName((std::filesystem::path(folder) / "spruce_LW_labels_0.5um.png").c_str());
  reader->Update();
  vtkImageData* labels = reader->GetOutput();
  const int* n = labels->GetDimensions();
  auto image = samples::lattice(n[0], n[1], 1, 0.5e-6);
  samples::addStrings(image, "phase_names", { "lumen", "middle lamella", "cell wall" });
  const auto phaseOf = [&](int i, int j)
  { return static_cast<int>(labels->GetScalarComponentAsDouble(i, j, 0, 0)) / 127; };
  samples::addField<vtkUnsignedCharArray>(image, "phase", { [&](int i, int j, int) { return phaseOf(i, j); } });
  vtkNew<vtkSnapshot> snapshot;
  snapshot->SetInputData(image);
  vtkImageData* picture = snapshot->Draw();
  ASSERT_NE(picture, nullptr) << snapshot->GetErrorMessage();
  const int* r = snapshot->GetDataRectangle();
  ASSERT_EQ(r[2], 2 * n[0]);
  int wrong = 0;
  for (int y = 0; y < r[3]; ++y)
  {
    for (int x = 0; x < r[2]; ++x)
    {
      const int phase = phaseOf(x / 2, y / 2);
      const Rgb expected = phase == 0 ? VoidColor : phase == 1 ? LamellaColor : WallColor;
      wrong += pixels::at(picture, r[0] + x, r[1] + y) == expected ? 0 : 1;
    }
  }
  EXPECT_EQ(wrong, 0);
}
