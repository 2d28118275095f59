#include "Drawing.h"

#include "core/Error.h"

#include "Arrays.h"
#include "FlowLines.h"
#include "Quantity.h"
#include "VectorLayer.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSnapshot.h"

#include <algorithm>
#include <cmath>

namespace lamella::rendering
{
namespace
{

/// How the picture lies in space: its two axes, pixels and spacing along them.
struct Plane
{
  std::array<int, 2> axes{ 0, 1 };
  std::array<int, 2> size{ 1, 1 };
  std::array<double, 2> spacing{ 1, 1 };
  std::array<double, 2> origin{ 0, 0 }; ///< of the first pixel's centre
};

Plane FindPlane(vtkImageData* image)
{
  const int* dimensions = image->GetDimensions();
  Plane plane;
  plane.axes = dimensions[2] == 1 ? std::array<int, 2>{ 0, 1 }
    : dimensions[1] == 1          ? std::array<int, 2>{ 0, 2 }
                                  : std::array<int, 2>{ 1, 2 };
  for (std::size_t k = 0; k < 2; ++k)
  {
    const int axis = plane.axes.at(k);
    plane.size.at(k) = dimensions[axis];
    plane.spacing.at(k) = image->GetSpacing()[axis];
    plane.origin.at(k) = image->GetOrigin()[axis] + image->GetExtent()[2 * axis] * image->GetSpacing()[axis];
  }
  return plane;
}

/// Which of `count` pixels of the data lie in each of `extent` pixels of the picture, and with what share.
struct Share
{
  int first = 0;
  std::vector<float> weights;
};

std::vector<Share> Shares(int count, int extent)
{
  std::vector<Share> shares(static_cast<std::size_t>(extent));
  for (int k = 0; k < extent; ++k)
  {
    const double low = static_cast<double>(k) * count / extent;
    const double high = static_cast<double>(k + 1) * count / extent;
    Share& share = shares[static_cast<std::size_t>(k)];
    share.first = std::min(count - 1, static_cast<int>(low + 1e-9));
    for (int i = share.first; i < count && i < high - 1e-9; ++i)
    {
      share.weights.push_back(
        static_cast<float>((std::min<double>(high, i + 1) - std::max<double>(low, i)) / (high - low)));
    }
    if (share.weights.size() == 1)
      share.weights[0] = 1;
  }
  return shares;
}

void PaintPixels(Canvas& canvas, const PixelRect& rect, const Quantity& quantity, const Plane& plane)
{
  const auto columns = Shares(plane.size[0], rect.width);
  const auto rows = Shares(plane.size[1], rect.height);
  std::vector<std::array<float, 3>> sums(static_cast<std::size_t>(rect.width));
  for (int y = 0; y < rect.height; ++y)
  {
    const Share& row = rows[static_cast<std::size_t>(y)];
    const bool sameAsBelow = y > 0 && row.weights.size() == 1 &&
      rows[static_cast<std::size_t>(y) - 1].weights.size() == 1 &&
      rows[static_cast<std::size_t>(y) - 1].first == row.first;
    if (!sameAsBelow)
    {
      std::fill(sums.begin(), sums.end(), std::array<float, 3>{ 0, 0, 0 });
      for (std::size_t v = 0; v < row.weights.size(); ++v)
      {
        const auto base = (static_cast<std::size_t>(row.first) + v) * static_cast<std::size_t>(plane.size[0]);
        for (std::size_t x = 0; x < sums.size(); ++x)
        {
          const Share& column = columns[x];
          for (std::size_t u = 0; u < column.weights.size(); ++u)
          {
            const Color color = quantity.ColorOf(base + static_cast<std::size_t>(column.first) + u);
            const float weight = row.weights[v] * column.weights[u];
            sums[x][0] += weight * color.r;
            sums[x][1] += weight * color.g;
            sums[x][2] += weight * color.b;
          }
        }
      }
    }
    for (std::size_t x = 0; x < sums.size(); ++x)
    {
      const auto channel = [&](std::size_t c)
      { return static_cast<std::uint8_t>(std::lround(std::min(255.0F, sums[x].at(c)))); };
      canvas.SetPixel(rect.x + static_cast<int>(x), rect.y + y, { channel(0), channel(1), channel(2), 255 });
    }
  }
}

PlaneField FlowInPlane(vtkDataArray* array, const Plane& plane)
{
  PlaneField field;
  field.nx = plane.size[0];
  field.ny = plane.size[1];
  const auto count = static_cast<std::size_t>(array->GetNumberOfTuples());
  field.x.resize(count);
  field.y.resize(count);
  const auto part = [&](std::size_t i, std::size_t k)
  {
    const int axis = plane.axes.at(k);
    const double value =
      axis < array->GetNumberOfComponents() ? array->GetComponent(static_cast<vtkIdType>(i), axis) : 0.0;
    return std::isfinite(value) ? static_cast<float>(value) : 0.0F;
  };
  for (std::size_t i = 0; i < count; ++i)
  {
    field.x[i] = part(i, 0);
    field.y[i] = part(i, 1);
  }
  return field;
}

/// From pixels of the data to pixels of the picture.
class ToCanvas
{
public:
  ToCanvas(const PixelRect& rect, const Plane& plane)
    : Rect(rect)
    , ScaleX(static_cast<double>(rect.width) / plane.size[0])
    , ScaleY(static_cast<double>(rect.height) / plane.size[1])
  {
  }
  [[nodiscard]] Point2 operator()(const Point2& p) const
  {
    return { this->Rect.x + p[0] * this->ScaleX, this->Rect.y + p[1] * this->ScaleY };
  }
  [[nodiscard]] Polyline operator()(const Polyline& line) const
  {
    Polyline mapped(line.size());
    std::transform(line.begin(), line.end(), mapped.begin(), [this](const Point2& p) { return (*this)(p); });
    return mapped;
  }
  [[nodiscard]] double Scale() const { return std::min(this->ScaleX, this->ScaleY); }

private:
  const PixelRect& Rect;
  double ScaleX;
  double ScaleY;
};

/// Heads along lines, staggered from line to line so that they form no rows.
void AddHeads(VectorLayer& layer, const std::vector<Polyline>& lines, double apart, double size)
{
  int index = 0;
  for (const Polyline& line : lines)
  {
    double next = apart * (0.25 + 0.5 * std::fmod(++index * 0.6180339887498949, 1.0));
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
      length += Distance(line[i - 1], line[i]);
    if (length < 2.5 * size)
      continue;
    next = std::min(next, 0.6 * length);
    double along = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
    {
      const double step = Distance(line[i - 1], line[i]);
      if (along + step >= next)
      {
        // The mean direction over the head's own length: a head must not follow every bend.
        std::size_t back = i;
        double behind = 0;
        while (back > 0 && behind < size)
        {
          behind += Distance(line[back], line[back - 1]);
          --back;
        }
        layer.Head(line[i], { line[i][0] - line[back][0], line[i][1] - line[back][1] }, size);
        next += apart;
      }
      along += step;
    }
  }
}

/// Lines of other data, or in another unit, would be lines somewhere else; smoothing ones that are far too long has no
/// end.
void RequireWithin(const std::vector<Polyline>& lines, const Plane& plane)
{
  const double far = 10.0 * std::max(plane.size[0], plane.size[1]);
  bool anyInside = lines.empty();
  for (const Polyline& line : lines)
  {
    for (const Point2& p : line)
    {
      anyInside = anyInside || (p[0] >= 0 && p[1] >= 0 && p[0] <= plane.size[0] && p[1] <= plane.size[1]);
      if (!(std::abs(p[0]) <= far && std::abs(p[1]) <= far))
        throw InputError("the lines given lead far out of the picture", "give lines that were made of these data");
    }
  }
  if (!anyInside)
    throw InputError("none of the lines given is in the picture", "give lines that were made of these data");
}

std::vector<Polyline> GivenLines(vtkPolyData* lines, const Plane& plane)
{
  std::vector<Polyline> result;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < lines->GetNumberOfCells(); ++cell)
  {
    lines->GetCellPoints(cell, ids);
    Polyline line;
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      const double* p = lines->GetPoint(ids->GetId(i));
      const auto place = [&](std::size_t k)
      { return (p[plane.axes.at(k)] - plane.origin.at(k)) / plane.spacing.at(k) + 0.5; };
      line.push_back({ place(0), place(1) });
    }
    if (line.size() > 1)
      result.push_back(std::move(line));
  }
  RequireWithin(result, plane);
  return result;
}

double Luminance(Color color)
{
  return (0.299 * color.r + 0.587 * color.g + 0.114 * color.b) / 255;
}

class PictureDrawing
{
public:
  PictureDrawing(vtkImageData* image, const SnapshotOptions& options)
    : Image(image)
    , Options(options)
    , InPlane(FindPlane(image))
    , Field(FindQuantity(
        image, { image->GetDimensions()[0], image->GetDimensions()[1], image->GetDimensions()[2] }, options))
  {
  }

  Drawing Run()
  {
    Furniture furniture = Describe(this->Field, this->Options);
    this->ChooseOverlay(furniture);
    if (this->Options.showScaleBar)
    {
      furniture.scale = FindScale(this->Image, this->InPlane.spacing[0]);
      if (furniture.scale)
        furniture.scale->lengthPerUnit *= this->InPlane.spacing[0];
    }
    const double aspect = this->InPlane.spacing[1] / this->InPlane.spacing[0];
    const Layout layout =
      ArrangeOrThrow(furniture, this->InPlane.size[0], this->InPlane.size[1] * aspect, aspect == 1, this->Options);
    const Color background = BackgroundColor(this->Options);
    Drawing drawing{ Canvas(layout.width, layout.height, background), layout.data, this->Field.LegendRange() };
    const Color ink = InkOn(background);
    PaintPixels(drawing.canvas, layout.data, this->Field, this->InPlane);
    this->DrawVectors(drawing.canvas, layout);
    DrawFurniture(drawing.canvas, furniture, layout, ink, true);
    return drawing;
  }

private:
  void ChooseOverlay(Furniture& furniture)
  {
    this->Kind = this->Options.overlay;
    const bool chosen = this->Kind != vtkSnapshot::AUTO_OVERLAY;
    if (!chosen)
    {
      this->Kind = this->Field.preset == vtkSnapshot::FLUX && this->Options.component < 0 ? vtkSnapshot::LINES_OVERLAY
                                                                                          : vtkSnapshot::NO_OVERLAY;
    }
    if (this->Options.overlayLines)
      this->Kind = vtkSnapshot::LINES_OVERLAY;
    if ((this->Kind == vtkSnapshot::LINES_OVERLAY && !this->Options.overlayLines) ||
      this->Kind == vtkSnapshot::ARROWS_OVERLAY)
    {
      this->Flow = FindFlow(this->Image, this->Field, this->Options);
      if (!this->Flow)
      {
        if (chosen)
        {
          throw InputError("lines and arrows need a vector field; there is no array 'flux' in the data",
            "name one, or draw without them");
        }
        this->Kind = vtkSnapshot::NO_OVERLAY;
      }
    }
    if (this->Kind == vtkSnapshot::ISOLINES_OVERLAY && this->Field.IsCategorical())
      throw InputError("phases and grains have no lines of equal value", "draw a scalar, or without lines");
    if (this->Kind == vtkSnapshot::LINES_OVERLAY && !this->Options.overlayLines)
    {
      this->LineField = FlowInPlane(this->Flow, this->InPlane);
      const int count = this->Options.overlayCount > 0 ? this->Options.overlayCount : LinesThatFit(this->LineField);
      this->Lines = EqualFluxLines(this->LineField, count);
      if (this->Lines.empty())
      {
        const double longest = std::max(this->InPlane.size[0], this->InPlane.size[1]);
        this->Lines = EvenlySpacedLines(this->LineField, longest / (1.5 * count));
      }
      else if (this->Options.showLegend)
      {
        this->EqualShares = true;
        furniture.legend.insert(furniture.legend.begin(),
          { "1/" + std::to_string(count) + " of the flow between two lines", this->LineColor(), LegendEntry::Kind::Line,
            this->LineGround() });
      }
    }
    else if (this->Options.overlayLines)
    {
      this->Lines = GivenLines(this->Options.overlayLines, this->InPlane);
    }
  }

  /// So many that lines do not touch where most of the flow is squeezed into thin walls.
  static int LinesThatFit(const PlaneField& field)
  {
    double sum = 0;
    double squares = 0;
    Point2 mean{ 0, 0 };
    for (std::size_t i = 0; i < field.x.size(); ++i)
    {
      const double square = static_cast<double>(field.x[i]) * field.x[i] + static_cast<double>(field.y[i]) * field.y[i];
      sum += std::sqrt(square);
      squares += square;
      mean = { mean[0] + field.x[i], mean[1] + field.y[i] };
    }
    const double flow = std::hypot(mean[0], mean[1]);
    // Density of the lines where the flow is, over their mean density: the flux-weighted mean of the flux.
    const double crowding = sum > 0 && flow > 0 ? squares / sum * static_cast<double>(field.x.size()) / flow : 1;
    int best = 6;
    for (const int count : { 8, 10, 12, 16, 20, DefaultLines })
      best = count * crowding < MostLinesAcross ? count : best;
    return best;
  }

  [[nodiscard]] Color LineColor() const
  {
    return this->LightLines() ? Color{ 255, 255, 255, 240 } : Color{ 20, 20, 20, 240 };
  }
  /// What the legend's sample of a line lies on.
  [[nodiscard]] Color LineGround() const
  {
    return this->Field.IsCategorical() ? this->Field.idColors.back()
                                       : this->Field.map->At(this->LightLines() ? 0.45 : 0.75);
  }

  /// Light on maps that are dark over most of their length, and the other way round.
  [[nodiscard]] bool LightLines() const
  {
    return !this->Field.IsCategorical() && Luminance(this->Field.map->At(0.35)) < 0.5;
  }

  /// Outline, then a halo that sets lines and arrows off the colours below, then these.
  void DrawVectors(Canvas& canvas, const Layout& layout)
  {
    const bool light = this->LightLines();
    std::vector<VectorLayer> layers{ VectorLayer(light ? Color{ 255, 255, 255, 120 } : Color{ 30, 30, 30, 130 }),
      VectorLayer(light ? Color{ 0, 0, 0, 90 } : Color{ 255, 255, 255, 110 }), VectorLayer(this->LineColor()) };
    const ToCanvas map(layout.data, this->InPlane);
    this->AddOutline(layers[0], map, layout.font);
    switch (this->Kind)
    {
      case vtkSnapshot::LINES_OVERLAY:
        this->AddLines(layers[1], layers[2], map, layout.font);
        break;
      case vtkSnapshot::ARROWS_OVERLAY:
        this->AddArrows(layers[1], layers[2], map, layout.font);
        break;
      case vtkSnapshot::ISOLINES_OVERLAY:
        this->AddIsolines(layers[1], layers[2], map, layout.font);
        break;
      default:
        break;
    }
    std::string whyNot;
    if (!DrawLayers(layers, canvas, layout.data, whyNot))
      throw InputError(whyNot, "draw without lines (overlay none, no outline): that needs no OpenGL");
  }

  void AddOutline(VectorLayer& layer, const ToCanvas& map, double unit)
  {
    const std::vector<bool> solid =
      this->Options.showOutline && !this->Field.IsCategorical() ? FindSolid(this->Image) : std::vector<bool>{};
    if (!solid.empty())
      for (const Polyline& line : Outline(solid, this->InPlane.size[0], this->InPlane.size[1]))
        layer.Line(map(Smooth(line, 0.5, 0.8)), std::max(1.0, unit / 20));
  }

  static double LineWidth(double unit) { return std::max(1.2, 0.085 * unit); }

  void AddLines(VectorLayer& halo, VectorLayer& core, const ToCanvas& map, double unit)
  {
    std::vector<Polyline> lines;
    for (const Polyline& line : this->Lines)
    {
      lines.push_back(map(Smooth(line, std::max(0.25, 1.5 / map.Scale()), this->EqualShares ? 1.2 : 0.5)));
      core.Line(lines.back(), LineWidth(unit));
      halo.Line(lines.back(), 2.2 * LineWidth(unit));
    }
    AddHeads(core, lines, 9 * unit, 0.62 * unit);
  }

  void AddArrows(VectorLayer& halo, VectorLayer& core, const ToCanvas& map, double unit)
  {
    const double longest = std::max(this->InPlane.size[0], this->InPlane.size[1]);
    const int count = this->Options.overlayCount > 0 ? this->Options.overlayCount : DefaultArrows;
    for (const Arrow& arrow : BlockArrows(FlowInPlane(this->Flow, this->InPlane), longest / count))
    {
      const Point2 tail = map(arrow.tail);
      const Point2 tip = map(arrow.tip);
      const double length = Distance(tail, tip);
      const double head = std::min(0.75 * unit, 0.6 * length);
      const double part = 0.7 * head / length;
      const Point2 neck{ tip[0] - part * (tip[0] - tail[0]), tip[1] - part * (tip[1] - tail[1]) };
      core.Line({ tail, neck }, 1.2 * LineWidth(unit));
      halo.Line({ tail, neck }, 2.4 * LineWidth(unit));
      core.Head(tip, { tip[0] - tail[0], tip[1] - tail[1] }, head);
    }
  }

  void AddIsolines(VectorLayer& halo, VectorLayer& core, const ToCanvas& map, double unit)
  {
    const int count = this->Options.overlayCount > 0 ? this->Options.overlayCount : DefaultIsolines;
    std::vector<double> levels;
    for (int k = 1; k <= count; ++k)
      levels.push_back(this->Field.low + (this->Field.high - this->Field.low) * k / (count + 1));
    for (const Polyline& line :
      Contours(this->Field.values, this->InPlane.size[0], this->InPlane.size[1], { 0.5, 0.5 }, levels))
    {
      const Polyline smooth = map(Smooth(line, std::max(0.25, 1.5 / map.Scale()), 0.5));
      core.Line(smooth, 0.8 * LineWidth(unit));
      halo.Line(smooth, 2.0 * LineWidth(unit));
    }
  }

  static constexpr int DefaultLines = 24;
  static constexpr double MostLinesAcross = 110; // as crowded as they may be, counted over the whole width
  static constexpr int DefaultArrows = 24;
  static constexpr int DefaultIsolines = 9;

  vtkImageData* Image;
  const SnapshotOptions& Options;
  Plane InPlane;
  Quantity Field;
  int Kind = 0;
  vtkDataArray* Flow = nullptr;
  PlaneField LineField;
  std::vector<Polyline> Lines;
  bool EqualShares = false;
};

} // namespace

Drawing DrawPicture(vtkImageData* image, const SnapshotOptions& options)
{
  return PictureDrawing(image, options).Run();
}

Layout ArrangeOrThrow(
  const Furniture& furniture, double unitsX, double unitsY, bool pixelated, const SnapshotOptions& options)
{
  std::string smallest;
  const auto layout =
    Arrange(furniture, unitsX, unitsY, pixelated, { options.size[0], options.size[1], options.fontScale }, smallest);
  if (!layout)
  {
    throw InputError("a picture of " + std::to_string(options.size[0]) + " × " + std::to_string(options.size[1]) +
        " pixels leaves no room for the data",
      "ask for at least " + smallest + ", a smaller font scale, or no legend");
  }
  return *layout;
}

Color BackgroundColor(const SnapshotOptions& options)
{
  const auto channel = [&](std::size_t c)
  { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(options.background.at(c), 0.0, 1.0))); };
  return { channel(0), channel(1), channel(2), static_cast<std::uint8_t>(options.transparent ? 0 : 255) };
}

Color InkOn(Color background)
{
  return Luminance(background) > 0.45 ? Color{ 28, 28, 30, 255 } : Color{ 238, 238, 238, 255 };
}

} // namespace lamella::rendering
