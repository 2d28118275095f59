#include "View.h"

#include "core/Error.h"

#include "Text.h"
#include "VectorLayer.h"
#include "vtkCamera.h"
#include "vtkMath.h"
#include "vtkRenderer.h"

#include <algorithm>
#include <cmath>

namespace lamella::rendering
{
namespace
{

double Dot(const Point3& a, const Point3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point3 Corner(const std::array<double, 6>& bounds, unsigned index)
{
  return { bounds.at(index & 1U), bounds.at(2 + (index >> 1U & 1U)), bounds.at(4 + (index >> 2U & 1U)) };
}

} // namespace

View::View(const std::array<double, 6>& bounds, double azimuth, double elevation)
  : Bounds(bounds)
{
  const double a = vtkMath::RadiansFromDegrees(azimuth);
  const double e = vtkMath::RadiansFromDegrees(elevation);
  this->Back = { std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e) };
  this->Right = { -std::sin(a), std::cos(a), 0 };
  this->Up = { -std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a), std::cos(e) };
  this->Extent = { 1e300, -1e300, 1e300, -1e300 };
  for (unsigned index = 0; index < 8; ++index)
  {
    const auto [x, y] = this->OnScreen(Corner(bounds, index));
    this->Extent = { std::min(this->Extent[0], x), std::max(this->Extent[1], x), std::min(this->Extent[2], y),
      std::max(this->Extent[3], y) };
  }
}

std::array<double, 2> View::OnScreen(const Point3& point) const
{
  return { Dot(point, this->Right), Dot(point, this->Up) };
}

void View::Aim(vtkRenderer* renderer) const
{
  const double diagonal =
    std::hypot(this->Bounds[1] - this->Bounds[0], this->Bounds[3] - this->Bounds[2], this->Bounds[5] - this->Bounds[4]);
  const double x = 0.5 * (this->Extent[0] + this->Extent[1]);
  const double y = 0.5 * (this->Extent[2] + this->Extent[3]);
  const Point3 centre{ 0.5 * (this->Bounds[0] + this->Bounds[1]), 0.5 * (this->Bounds[2] + this->Bounds[3]),
    0.5 * (this->Bounds[4] + this->Bounds[5]) };
  const double depth = Dot(centre, this->Back);
  Point3 focus{};
  Point3 position{};
  for (std::size_t c = 0; c < 3; ++c)
  {
    focus.at(c) = x * this->Right.at(c) + y * this->Up.at(c) + depth * this->Back.at(c);
    position.at(c) = focus.at(c) + 2 * diagonal * this->Back.at(c);
  }
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * this->Height());
  camera->SetFocalPoint(focus.data());
  camera->SetPosition(position.data());
  camera->SetViewUp(this->Up.data());
  camera->SetClippingRange(diagonal, 3 * diagonal);
}

PixelPoint View::Project(const Point3& point, const PixelRect& rect) const
{
  const auto [x, y] = this->OnScreen(point);
  return { static_cast<int>(std::lround(rect.x + (x - this->Extent[0]) / this->Width() * rect.width)),
    static_cast<int>(std::lround(rect.y + (y - this->Extent[2]) / this->Height() * rect.height)) };
}

void View::DrawScaleBar(Canvas& canvas, const Layout& layout, const Scale& scale, Color ink) const
{
  // The corner that is seen lowest, and the edges from it along the axes.
  unsigned lowest = 0;
  for (unsigned index = 1; index < 8; ++index)
    if (this->OnScreen(Corner(this->Bounds, index))[1] < this->OnScreen(Corner(this->Bounds, lowest))[1] - 1e-12)
      lowest = index;
  const Point3 start = Corner(this->Bounds, lowest);
  unsigned best = 0;
  double longest = -1;
  for (unsigned axis = 0; axis < 2; ++axis)
  {
    const auto from = this->OnScreen(start);
    const auto to = this->OnScreen(Corner(this->Bounds, lowest ^ (1U << axis)));
    const double seen = std::hypot(to[0] - from[0], to[1] - from[1]);
    if (seen > longest)
    {
      longest = seen;
      best = axis;
    }
  }
  const double length = this->Bounds.at(2 * best + 1) - this->Bounds.at(2 * best);
  std::string text;
  const double marked = NiceLength(0.4 * length * scale.lengthPerUnit, scale.metres, text) / scale.lengthPerUnit;
  const PixelPoint a = this->Project(start, layout.data);
  const PixelPoint b = this->Project(Corner(this->Bounds, lowest ^ (1U << best)), layout.data);
  const Point2 along{ (b.x - a.x) / length, (b.y - a.y) / length }; // pixels for one unit along the edge
  const double size = std::max(1e-9, std::hypot(along[0], along[1]));
  Point2 outward{ along[1] / size, -along[0] / size };
  if (outward[1] > 0)
    outward = { -outward[0], -outward[1] };
  const double font = layout.font;
  const double offset = 0.65 * font;
  const double first = 0.5 * (length - marked);
  const auto place = [&](double way, double away) {
    return Point2{ a.x + along[0] * way + outward[0] * away, a.y + along[1] * way + outward[1] * away };
  };
  VectorLayer bar(ink);
  bar.Line({ place(first, offset), place(first + marked, offset) }, std::max(2.0, 0.2 * font));
  std::string whyNot;
  const PixelRect all{ 0, 0, canvas.Width(), canvas.Height() };
  if (!DrawLayers({ bar }, canvas, all, whyNot))
    throw InputError(whyNot, "draw without a scale bar");
  const Point2 label = place(0.5 * length, offset + 0.55 * font);
  const double width = MeasureText(text, font).width;
  const double x = std::abs(outward[0]) < 0.15 ? label[0] - 0.5 * width : outward[0] > 0 ? label[0] : label[0] - width;
  canvas.Text(x, label[1], text, font, ink, Align::Low, Align::High);
}

} // namespace lamella::rendering
