#include "Furniture.h"

#include "Text.h"

#include <algorithm>
#include <cmath>

namespace lamella::rendering
{
namespace
{

constexpr double AutomaticSide = 1200; // longest side of the data in a picture whose size follows from the data
constexpr double LargestExact = 2000;  // data up to this many pixels are shown pixel by pixel

int Pixels(double length)
{
  return static_cast<int>(std::lround(length));
}

/// Title and unit as they stand beside the bar.
std::string BarTitle(const ColorBar& bar, int exponent)
{
  const std::string power = exponent == 0 ? "" : "10" + RaisedText(exponent);
  if (bar.unit.empty())
    return power.empty() ? bar.title : bar.title + " (×" + power + ")";
  return bar.title + " (" + (power.empty() ? "" : power + " ") + bar.unit + ")";
}

struct BarText
{
  std::vector<double> ticks;
  std::vector<std::string> labels;
  std::string title;
  double widest = 0;
};

BarText DescribeBar(const ColorBar& bar, double font)
{
  BarText text;
  int exponent = 0;
  if (bar.logarithmic)
  {
    text.ticks = LogarithmicTicks(bar.low, bar.high);
    for (const double tick : text.ticks)
    {
      int own = 0; // each number by itself: 1, 100, 10⁴
      const double number = std::pow(10.0, tick);
      const auto power = static_cast<int>(std::lround(tick));
      const bool whole = std::abs(tick - power) < 1e-9;
      text.labels.push_back(whole && std::abs(power) > 3 ? "10" + RaisedText(power)
                                                         : TickLabels({ std::round(number * 1e6) / 1e6 }, own).front());
      if (own != 0)
        text.labels.back() += "·10" + RaisedText(own);
    }
  }
  else
  {
    text.ticks = NiceTicks(bar.low, bar.high);
    text.labels = TickLabels(text.ticks, exponent);
  }
  text.title = BarTitle(bar, exponent);
  for (const std::string& label : text.labels)
    text.widest = std::max(text.widest, MeasureText(label, font).width);
  return text;
}

double EntryWidth(const LegendEntry& entry, const Layout& layout)
{
  const double sample = entry.kind == LegendEntry::Kind::Line ? 2.2 * layout.font : layout.Patch();
  return sample + 0.45 * layout.font + MeasureText(entry.text, layout.font).width;
}

/// Distances in units of the text's height.
constexpr double Margin = 0.9;
constexpr double Gap = 0.8;
constexpr double RowHeight = 1.55;
constexpr double EntryGap = 1.3;
constexpr double BarThickness = 0.85;

/// A row of the legend.
struct LegendRow
{
  std::vector<std::size_t> entries;
  double width = 0;
};

/// Everything for a given scale and text, from the lower edge upwards.
class Placing
{
public:
  Placing(const Furniture& furniture, double unitsX, double unitsY, double scale, double font)
    : Given(furniture)
    , Font(font)
    , Below(Pixels(Margin * font))
  {
    this->Made.font = font;
    this->Made.scale = scale;
    PixelRect& data = this->Made.data;
    data.width = std::max(1, Pixels(unitsX * scale));
    data.height = std::max(1, Pixels(unitsY * scale));
    data.x = Pixels(Margin * font) + this->Made.Rule();
    this->ContentRight = data.Right() + this->Made.Rule();
    const int columnFrom = this->ContentRight;
    const int column = this->ChooseBar();
    this->MeasureScale();
    this->PlaceLegend(this->BreakLegend());
    if (this->BarBelow)
      this->PlaceBarBelow();
    data.y = this->Below +
      (this->Below > Pixels(Margin * font) ? Pixels(0.45 * font) + (this->BarBelow ? Pixels(0.35 * font) : 0) : 0) +
      this->Made.Rule();
    if (furniture.bar && this->Made.barUpright)
      this->PlaceBarBeside();
    const int top = this->PlaceTitle();
    this->Made.width = std::max(this->ContentRight, columnFrom + column) + Pixels(Margin * font);
    this->Made.height = top + Pixels(Margin * font);
  }

  const Layout& Result() const { return this->Made; }

private:
  /// Beside the data or below. @return the width that it takes beside them
  int ChooseBar()
  {
    if (!this->Given.bar)
      return 0;
    this->Bar = DescribeBar(*this->Given.bar, this->Font);
    const PixelRect& data = this->Made.data;
    const double titleLength = MeasureText(this->Bar.title, this->Font).width;
    this->Made.barUpright = data.width < 2.3 * data.height && titleLength < data.height && data.height > 7 * this->Font;
    this->BarBelow = !this->Made.barUpright;
    return this->Made.barUpright
      ? Pixels(Gap * this->Font) + Pixels((BarThickness + 0.45 + 0.6 + 0.8) * this->Font + this->Bar.widest)
      : 0;
  }

  void MeasureScale()
  {
    if (!this->Given.scale)
      return;
    const Scale& scale = *this->Given.scale;
    const double largest =
      std::max(0.22 * this->Made.data.width, std::min<double>(4 * this->Font, this->Made.data.width));
    const double length =
      NiceLength(largest / this->Made.scale * scale.lengthPerUnit, scale.metres, this->Made.scaleBarText);
    if (scale.metres || length >= 1) // less than one pixel of the data is no length
    {
      this->Made.scaleBarLength = std::max(1, Pixels(length / scale.lengthPerUnit * this->Made.scale));
      this->ScaleWidth =
        this->Made.scaleBarLength + 0.5 * this->Font + MeasureText(this->Made.scaleBarText, this->Font).width;
    }
  }

  /// Whether the scale bar stands in the first row of the legend.
  bool ScaleInRow() const { return this->Made.scaleBarLength > 0 && !this->BarBelow; }

  std::vector<LegendRow> BreakLegend() const
  {
    std::vector<LegendRow> rows;
    const double ofScale = this->ScaleWidth > 0 && !this->BarBelow ? this->ScaleWidth + 1.5 * EntryGap * this->Font : 0;
    for (std::size_t i = 0; i < this->Given.legend.size(); ++i)
    {
      const double width = EntryWidth(this->Given.legend[i], this->Made);
      if (rows.empty())
      {
        rows.emplace_back();
        if (width > this->Made.data.width - ofScale && this->ScaleWidth > 0)
          rows.emplace_back(); // the scale bar has the first row for itself
      }
      else if (!rows.back().entries.empty() &&
        rows.back().width + EntryGap * this->Font + width > this->Made.data.width - (rows.size() == 1 ? ofScale : 0))
      {
        rows.emplace_back();
      }
      LegendRow& last = rows.back();
      last.width += (last.entries.empty() ? 0 : EntryGap * this->Font) + width;
      last.entries.push_back(i);
    }
    if (rows.empty() && this->ScaleInRow())
      rows.emplace_back();
    return rows;
  }

  /// Right-aligned with the data; the first row shares its own with the scale bar.
  void PlaceLegend(const std::vector<LegendRow>& rows)
  {
    const int row = Pixels(RowHeight * this->Font);
    const PixelRect& data = this->Made.data;
    this->Made.legend.resize(this->Given.legend.size());
    for (auto it = rows.rbegin(); it != rows.rend(); ++it)
    {
      const bool withScale = std::next(it) == rows.rend() && this->ScaleInRow();
      double x = std::max<double>(data.x, data.Right() - it->width);
      if (withScale)
        x = std::max(x, data.x + this->ScaleWidth + EntryGap * this->Font);
      for (const std::size_t i : it->entries)
      {
        this->Made.legend[i] = { Pixels(x), this->Below + (row - this->Made.Patch()) / 2 };
        x += EntryWidth(this->Given.legend[i], this->Made) + EntryGap * this->Font;
        this->ContentRight = std::max(this->ContentRight, Pixels(x - EntryGap * this->Font));
      }
      if (withScale)
      {
        this->Made.scaleBar = { data.x, this->Below + row / 2 };
        this->ContentRight = std::max(this->ContentRight, Pixels(data.x + this->ScaleWidth));
      }
      this->Below += row;
    }
  }

  /// Right part of the width; numbers below it, the title below them.
  void PlaceBarBelow()
  {
    const PixelRect& data = this->Made.data;
    const bool hasScale = this->Made.scaleBarLength > 0;
    const int start = hasScale ? Pixels(std::max(0.3 * data.width, this->ScaleWidth + 3 * this->Font)) : 0;
    const double titleLength = MeasureText(this->Bar.title, this->Font).width;
    const int length = std::max(data.width - start, Pixels(std::max(8 * this->Font, titleLength)));
    const int thickness = Pixels(BarThickness * this->Font);
    const int base = this->Below + Pixels(2.9 * this->Font);
    const int pointed = this->Given.bar->above ? thickness : 0;
    const int blunt = this->Given.bar->below ? thickness : 0;
    this->Made.bar = { data.x + start + blunt, base, length - pointed - blunt, thickness };
    if (hasScale)
      this->Made.scaleBar = { data.x, base + thickness / 2 };
    this->ContentRight = std::max(this->ContentRight, data.x + start + length + Pixels(0.6 * this->Bar.widest));
    this->Below = base + thickness;
  }

  void PlaceBarBeside()
  {
    const PixelRect& data = this->Made.data;
    const int thickness = Pixels(BarThickness * this->Font);
    const int pointed = this->Given.bar->above ? thickness : 0;
    const int blunt = this->Given.bar->below ? thickness : 0;
    this->Made.bar = { data.Right() + this->Made.Rule() + Pixels(Gap * this->Font), data.y + blunt, thickness,
      data.height - pointed - blunt };
  }

  /// @return the top of all
  int PlaceTitle()
  {
    const int top = this->Made.data.Top() + this->Made.Rule();
    if (this->Given.title.empty())
      return top;
    this->Made.title = { this->Made.data.x - this->Made.Rule(), top + Pixels(0.75 * this->Font) };
    this->ContentRight =
      std::max(this->ContentRight, this->Made.title.x + Pixels(MeasureText(this->Given.title, 1.2 * this->Font).width));
    return top + Pixels(0.75 * this->Font + 1.05 * 1.2 * this->Font);
  }

  const Furniture& Given;
  double Font;
  Layout Made;
  BarText Bar;
  bool BarBelow = false;
  double ScaleWidth = 0; ///< with its text
  int ContentRight = 0;
  int Below; ///< top of what has been placed, from the lower edge
};

Layout Place(const Furniture& furniture, double unitsX, double unitsY, double scale, double font)
{
  return Placing(furniture, unitsX, unitsY, scale, font).Result();
}

void Shift(Layout& layout, int dx, int dy)
{
  layout.data.x += dx;
  layout.data.y += dy;
  layout.bar.x += dx;
  layout.bar.y += dy;
  layout.title = { layout.title.x + dx, layout.title.y + dy };
  if (layout.scaleBar)
    layout.scaleBar = PixelPoint{ layout.scaleBar->x + dx, layout.scaleBar->y + dy };
  for (PixelPoint& point : layout.legend)
    point = { point.x + dx, point.y + dy };
}

} // namespace

int Layout::Rule() const
{
  return std::max(1, Pixels(this->font / 18));
}

int Layout::Patch() const
{
  return std::max(3, Pixels(0.85 * this->font));
}

std::optional<Layout> Arrange(const Furniture& furniture, double unitsX, double unitsY, bool pixelated,
  const SizeRequest& request, std::string& smallest)
{
  const double longest = std::max(unitsX, unitsY);
  if (request.width <= 0 || request.height <= 0)
  {
    double scale = AutomaticSide / longest;
    if (pixelated)
      scale = longest <= LargestExact ? std::max(1.0, std::round(scale)) : 1.25 * AutomaticSide / longest;
    const double side = std::sqrt(std::max(1.0, unitsX * scale) * std::max(1.0, unitsY * scale));
    const double font = request.fontScale * std::clamp(0.0265 * side, 15.0, 60.0);
    return Place(furniture, unitsX, unitsY, scale, font);
  }

  const double font =
    request.fontScale * std::clamp(0.0225 * std::sqrt(static_cast<double>(request.width) * request.height), 8.0, 160.0);
  // The largest scale at which everything fits, by bisection: what stands around the data depends on its size.
  const auto fits = [&](double scale)
  {
    const Layout layout = Place(furniture, unitsX, unitsY, scale, font);
    return layout.width <= request.width && layout.height <= request.height;
  };
  double low = 8.0 / longest;
  double high = std::max<double>(request.width, request.height) / longest;
  if (!fits(low))
  {
    const Layout least = Place(furniture, unitsX, unitsY, low, font);
    smallest = std::to_string(least.width) + " × " + std::to_string(least.height);
    return std::nullopt;
  }
  for (int i = 0; i < 40; ++i)
  {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  // A whole number of picture pixels for each of the data's looks best, if it costs little room.
  if (pixelated && low >= 1 && std::floor(low) > 0.8 * low)
    low = std::floor(low);
  Layout layout = Place(furniture, unitsX, unitsY, low, font);
  Shift(layout, (request.width - layout.width) / 2, (request.height - layout.height) / 2);
  layout.width = request.width;
  layout.height = request.height;
  return layout;
}

namespace
{

/// The pointed end of a bar, beyond `base`, in the colour of what lies there. Smooth edges by exact shares of pixels.
void DrawPoint(Canvas& canvas, const PixelRect& bar, bool upright, bool high, Color color, Color ink, int rule)
{
  const int width = upright ? bar.width : bar.height;
  constexpr int n = 4;
  const PixelRect box = upright
    ? PixelRect{ bar.x - rule, high ? bar.Top() : bar.y - width - rule, width + 2 * rule, width + rule }
    : PixelRect{ high ? bar.Right() : bar.x - width - rule, bar.y - rule, width + rule, width + 2 * rule };
  std::vector<std::uint8_t> filled(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
  std::vector<std::uint8_t> edge(filled.size());
  for (int y = 0; y < box.height; ++y)
  {
    for (int x = 0; x < box.width; ++x)
    {
      int inner = 0;
      int outer = 0;
      for (int s = 0; s < n * n; ++s)
      {
        const double px = x + (s % n + 0.5) / n;
        const double py = y + (static_cast<double>(s / n) + 0.5) / n;
        // away from the bar, and aside of its axis
        const double along = upright ? (high ? py : box.height - py) : (high ? px : box.width - px);
        const double aside = std::abs((upright ? px : py) - 0.5 * width - rule);
        const bool isInner = along >= 0 && along < width - 2 * aside;
        const bool isOuter =
          along >= 0 && along < width + rule * 1.2 - 2 * (aside - rule) && aside < 0.5 * width + rule;
        inner += isInner ? 1 : 0;
        outer += isOuter && !isInner ? 1 : 0;
      }
      const std::size_t k =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(box.width) + static_cast<std::size_t>(x);
      filled[k] = static_cast<std::uint8_t>(255 * inner / (n * n));
      edge[k] = static_cast<std::uint8_t>(255 * std::min(outer, n * n) / (n * n));
    }
  }
  canvas.Cover(box, edge, ink);
  canvas.Cover(box, filled, color);
}

void DrawBar(Canvas& canvas, const ColorBar& bar, const Layout& layout, Color ink)
{
  const PixelRect& rect = layout.bar;
  const int rule = layout.Rule();
  const int length = layout.barUpright ? rect.height : rect.width;
  canvas.Frame(rect, rule, ink);
  if (bar.above)
    DrawPoint(canvas, rect, layout.barUpright, true, bar.map->At(1), ink, rule);
  if (bar.below)
    DrawPoint(canvas, rect, layout.barUpright, false, bar.map->At(0), ink, rule);
  for (int k = 0; k < length; ++k)
  {
    const Color color = bar.map->At((k + 0.5) / length);
    canvas.Fill(layout.barUpright ? PixelRect{ rect.x, rect.y + k, rect.width, 1 }
                                  : PixelRect{ rect.x + k, rect.y, 1, rect.height },
      color);
  }
  const double font = layout.font;
  const BarText text = DescribeBar(bar, font);
  const int mark = std::max(2, Pixels(0.22 * font));
  for (std::size_t i = 0; i < text.ticks.size(); ++i)
  {
    const int at = Pixels((text.ticks[i] - bar.low) / (bar.high - bar.low) * (length - 1));
    if (layout.barUpright)
    {
      const int y = rect.y + at;
      canvas.Fill({ rect.Right() + rule, y - rule / 2, mark, rule }, ink);
      canvas.Text(
        rect.Right() + rule + mark + 0.22 * font, y + 0.5, text.labels[i], font, ink, Align::Low, Align::Middle);
    }
    else
    {
      const int x = rect.x + at;
      canvas.Fill({ x - rule / 2, rect.y - rule - mark, rule, mark }, ink);
      canvas.Text(x + 0.5, rect.y - rule - mark - 0.25 * font, text.labels[i], font, ink, Align::Middle, Align::High);
    }
  }
  if (layout.barUpright)
  {
    const double x = rect.Right() + rule + mark + 0.22 * font + text.widest + 0.6 * font;
    canvas.Text(x, layout.data.y + 0.5 * layout.data.height, text.title, font, ink, Align::Middle, Align::High, true);
  }
  else
  {
    canvas.Text(rect.x + 0.5 * rect.width, rect.y - 2.75 * font, text.title, font, ink, Align::Middle, Align::Low);
  }
}

} // namespace

void DrawFurniture(Canvas& canvas, const Furniture& furniture, const Layout& layout, Color ink, bool framed)
{
  const double font = layout.font;
  const int rule = layout.Rule();
  if (framed)
    canvas.Frame(layout.data, rule, ink);
  if (!furniture.title.empty())
    canvas.Text(layout.title.x, layout.title.y, furniture.title, 1.2 * font, ink, Align::Low, Align::Low);
  if (layout.scaleBar)
  {
    const int thickness = std::max(2, Pixels(0.2 * font));
    canvas.Fill({ layout.scaleBar->x, layout.scaleBar->y - thickness / 2, layout.scaleBarLength, thickness }, ink);
    canvas.Text(layout.scaleBar->x + layout.scaleBarLength + 0.5 * font, layout.scaleBar->y, layout.scaleBarText, font,
      ink, Align::Low, Align::Middle);
  }
  if (furniture.bar)
    DrawBar(canvas, *furniture.bar, layout, ink);
  for (std::size_t i = 0; i < furniture.legend.size(); ++i)
  {
    const LegendEntry& entry = furniture.legend[i];
    const int side = layout.Patch();
    const PixelPoint& corner = layout.legend[i];
    const double middle = corner.y + 0.5 * side;
    double textStart = corner.x + side;
    if (entry.kind == LegendEntry::Kind::Patch)
    {
      canvas.Frame({ corner.x, corner.y, side, side }, rule, ink);
      canvas.Fill({ corner.x, corner.y, side, side }, entry.color);
    }
    else
    {
      const int thickness = std::max(2, Pixels(0.1 * font));
      const int length = Pixels(2.2 * font);
      canvas.Frame({ corner.x, corner.y, length, side }, rule, ink);
      canvas.Fill({ corner.x, corner.y, length, side }, entry.ground);
      canvas.Fill({ corner.x, Pixels(middle - 0.5 * thickness), length, thickness }, entry.color);
      textStart = corner.x + length;
    }
    canvas.Text(textStart + 0.45 * font, middle, entry.text, font, ink, Align::Low, Align::Middle);
  }
}

} // namespace lamella::rendering
