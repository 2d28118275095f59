// Windows with no display: each way to draw, forced once; what is said when one does not work.

#include "Pixels.h"

#include "vtkOffScreenWindows.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace
{

/// A red square in the middle of a blue ground.
vtkSmartPointer<vtkRenderer> makeScene()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(-1, -1, 0);
  points->InsertNextPoint(1, -1, 0);
  points->InsertNextPoint(1, 1, 0);
  points->InsertNextPoint(-1, 1, 0);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0, 1, 2, 3 });
  vtkNew<vtkPolyData> square;
  square->SetPoints(points);
  square->SetPolys(cells);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(square);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(1, 0, 0);
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->AddActor(actor);
  renderer->SetBackground(0, 0, 1);
  renderer->GetActiveCamera()->ParallelProjectionOn();
  renderer->GetActiveCamera()->SetParallelScale(2);
  renderer->GetActiveCamera()->SetPosition(0, 0, 5);
  renderer->ResetCameraClippingRange();
  return renderer;
}

pixels::Rgb pixel(vtkRenderWindow* window, int x, int y)
{
  vtkNew<vtkUnsignedCharArray> data;
  window->GetPixelData(x, y, x, y, 0, data, 0);
  return { data->GetValue(0), data->GetValue(1), data->GetValue(2) };
}

void expectScene(vtkRenderWindow* window)
{
  window->Render();
  const int* size = window->GetSize();
  EXPECT_EQ(pixel(window, size[0] / 2, size[1] / 2), (pixels::Rgb{ 255, 0, 0 }));
  EXPECT_EQ(pixel(window, 2, 2), (pixels::Rgb{ 0, 0, 255 }));
  EXPECT_EQ(pixel(window, size[0] - 3, size[1] - 3), (pixels::Rgb{ 0, 0, 255 }));
}

} // namespace

class EachBackend : public testing::TestWithParam<const char*>
{
protected:
  void SetUp() override
  {
    setenv("LAMELLA_RENDERER", GetParam(), 1);
    if (vtkOffScreenWindows::GetBackend() != std::string(GetParam()))
      GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  }
  void TearDown() override { unsetenv("LAMELLA_RENDERER"); }
};

TEST_P(EachBackend, DrawsAndResizes)
{
  const auto window = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  ASSERT_NE(window, nullptr);
  window->AddRenderer(makeScene());
  window->SetSize(200, 120);
  expectScene(window);
  window->SetSize(333, 217);
  expectScene(window);
}

TEST_P(EachBackend, TwoWindowsTakeTurns)
{
  const auto first = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  const auto second = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  first->AddRenderer(makeScene());
  second->AddRenderer(makeScene());
  first->SetSize(100, 100);
  second->SetSize(150, 90);
  for (int turn = 0; turn < 3; ++turn)
  {
    expectScene(first);
    expectScene(second);
  }
}

TEST_P(EachBackend, CanBeMadeAgainAndAgain)
{
  for (int turn = 0; turn < 5; ++turn)
  {
    const auto window = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
    window->AddRenderer(makeScene());
    window->SetSize(64, 64);
    expectScene(window);
  }
}

INSTANTIATE_TEST_SUITE_P(Forced, EachBackend, testing::Values("osmesa", "egl", "x"),
  [](const auto& backend) { return std::string(backend.param); });

TEST(OffScreenWindows, DifferentKindsLiveSideBySide)
{
  setenv("LAMELLA_RENDERER", "osmesa", 1);
  const auto first = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  setenv("LAMELLA_RENDERER", "egl", 1);
  const auto second = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  unsetenv("LAMELLA_RENDERER");
  if (!first || !second)
    GTEST_SKIP() << "this machine lacks OSMesa or EGL";
  first->AddRenderer(makeScene());
  second->AddRenderer(makeScene());
  first->SetSize(80, 80);
  second->SetSize(80, 80);
  for (int turn = 0; turn < 2; ++turn)
  {
    expectScene(first);
    expectScene(second);
  }
}

TEST(OffScreenWindows, UnknownRequestIsNamed)
{
  setenv("LAMELLA_RENDERER", "mesa", 1);
  EXPECT_FALSE(vtkOffScreenWindows::IsRequestKnown());
  EXPECT_STREQ(vtkOffScreenWindows::GetBackend(), "none");
  EXPECT_STREQ(vtkOffScreenWindows::GetMessage(), "LAMELLA_RENDERER=mesa is not known: use osmesa, egl, x or auto");
  EXPECT_EQ(vtkOffScreenWindows::NewWindow(), nullptr);
  unsetenv("LAMELLA_RENDERER");
  EXPECT_TRUE(vtkOffScreenWindows::IsRequestKnown());
}

TEST(OffScreenWindows, NoDisplayIsSaid)
{
  if (const char* display = std::getenv("DISPLAY"); display && *display)
    GTEST_SKIP() << "DISPLAY is set";
  setenv("LAMELLA_RENDERER", "x", 1);
  EXPECT_STREQ(vtkOffScreenWindows::GetMessage(),
    "LAMELLA_RENDERER=x does not work here (x: DISPLAY is not set); leave it out to try the others");
  unsetenv("LAMELLA_RENDERER");
}

/// Run by ctest with unusable libraries in the loader's path: what is chosen, or said, then.
TEST(OffScreenWindows, FallsBack)
{
  const char* expected = std::getenv("LAMELLA_EXPECT_BACKEND");
  if (!expected)
    GTEST_SKIP() << "needs LAMELLA_EXPECT_BACKEND, which ctest sets together with unusable libraries";
  EXPECT_STREQ(vtkOffScreenWindows::GetBackend(), expected) << vtkOffScreenWindows::GetMessage();
  if (expected == std::string("none"))
  {
    EXPECT_STREQ(vtkOffScreenWindows::GetMessage(),
      "nothing here can draw a picture (osmesa: libOSMesa.so.8 is not installed; egl: libEGL.so.1 is not installed; "
      "x: DISPLAY is not set); install libosmesa6, or libegl1 with libgl1-mesa-dri");
    EXPECT_FALSE(vtkOffScreenWindows::Install());
  }
}

// Last: it changes what vtkRenderWindow::New() gives for the rest of the process.
TEST(OffScreenWindowsInstall, VTKsOwnWindowsNeedNoDisplay)
{
  if (vtkOffScreenWindows::GetBackend() == std::string("none") || vtkOffScreenWindows::GetBackend() == std::string("x"))
    GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
  ASSERT_FALSE(vtkOffScreenWindows::IsInstalled());
  ASSERT_TRUE(vtkOffScreenWindows::Install());
  ASSERT_TRUE(vtkOffScreenWindows::Install()) << "again is no harm";
  EXPECT_TRUE(vtkOffScreenWindows::IsInstalled());
  vtkNew<vtkRenderWindow> window;
  EXPECT_STREQ(window->GetClassName(), "vtkOffScreenRenderWindow");
  window->AddRenderer(makeScene());
  window->SetSize(120, 80);
  expectScene(window);
  vtkNew<vtkRenderWindowInteractor> interactor;
  EXPECT_STREQ(interactor->GetClassName(), "vtkGenericRenderWindowInteractor");
  interactor->SetRenderWindow(window);
  interactor->Initialize();
}
