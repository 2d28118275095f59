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
  {
    return power.empty() ? bar.title : bar.title + " (×" + power + ")";
  }
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
      {
        text.labels.back() += "·10" + RaisedText(own);
      }
    }
  }
  else
  {
    text.ticks = NiceTicks(bar.low, bar.high);
    text.labels = TickLabels(text.ticks, exponent);
  }
  text.title = BarTitle(bar, exponent);
  for (const std::string& label : text.labels)
  {
    text.widest = std::max(text.widest, MeasureText(label, font).width);
  }
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

/// Everything for a given scale and text; the data's lower left corner is found last, from what stands below it.
Layout Place(const Furniture& furniture, double unitsX, double unitsY, double scale, double font)
{
  Layout layout;
  layout.font = font;
  layout.scale = scale;
  layout.data.width = std::max(1, Pixels(unitsX * scale));
  layout.data.height = std::max(1, Pixels(unitsY * scale));
  const int margin = Pixels(Margin * font);
  const int gap = Pixels(Gap * font);
  const int row = Pixels(RowHeight * font);
  layout.data.x = margin + layout.Rule();
  int contentRight = layout.data.Right() + layout.Rule();
  int below = margin; // top of what has been placed, from the lower edge

  BarText bar;
  int barColumn = 0;
  if (furniture.bar)
  {
    bar = DescribeBar(*furniture.bar, font);
    const double titleLength = MeasureText(bar.title, font).width;
    layout.barUpright =
      layout.data.width < 2.3 * layout.data.height && titleLength < layout.data.height && layout.data.height > 7 * font;
    if (layout.barUpright)
    {
      barColumn = gap + Pixels((BarThickness + 0.45 + 0.6 + 0.8) * font + bar.widest);
    }
  }
  const int fullRight = contentRight + barColumn;

  // Rows of the legend, right-aligned with the data; the first shares its row with the scale bar.
  double scaleWidth = 0;
  if (furniture.scale)
  {
    const double largest = std::max(0.22 * layout.data.width, std::min<double>(4 * font, layout.data.width));
    const double length =
      NiceLength(largest / scale * furniture.scale->lengthPerUnit, furniture.scale->metres, layout.scaleBarText);
    if (furniture.scale->metres || length >= 1) // less than one pixel of the data is no length
    {
      layout.scaleBarLength = std::max(1, Pixels(length / furniture.scale->lengthPerUnit * scale));
      scaleWidth = layout.scaleBarLength + 0.5 * font + MeasureText(layout.scaleBarText, font).width;
    }
  }
  const bool hasScale = layout.scaleBarLength > 0;
  struct Row
  {
    std::vector<std::size_t> entries;
    double width = 0;
  };
  std::vector<Row> rows;
  const bool barBelow = furniture.bar && !layout.barUpright;
  for (std::size_t i = 0; i < furniture.legend.size(); ++i)
  {
    const double width = EntryWidth(furniture.legend[i], layout);
    const double taken = rows.size() == 1 && scaleWidth > 0 && !barBelow ? scaleWidth + 1.5 * EntryGap * font : 0;
    const double room = layout.data.width - taken;
    if (rows.empty())
    {
      rows.emplace_back();
      const double firstRoom =
        layout.data.width - (scaleWidth > 0 && !barBelow ? scaleWidth + 1.5 * EntryGap * font : 0);
      if (width > firstRoom && scaleWidth > 0)
      {
        rows.emplace_back(); // the scale bar has the first row for itself
      }
    }
    else if (!rows.back().entries.empty() && rows.back().width + EntryGap * font + width > room)
    {
      rows.emplace_back();
    }
    Row& last = rows.back();
    last.width += (last.entries.empty() ? 0 : EntryGap * font) + width;
    last.entries.push_back(i);
  }
  const bool scaleRow = hasScale && !barBelow;
  if (rows.empty() && scaleRow)
  {
    rows.emplace_back();
  }
  layout.legend.resize(furniture.legend.size());
  for (auto it = rows.rbegin(); it != rows.rend(); ++it)
  {
    const bool first = std::next(it) == rows.rend();
    double x = std::max<double>(layout.data.x, layout.data.Right() - it->width);
    if (first && scaleRow)
    {
      x = std::max(x, layout.data.x + scaleWidth + EntryGap * font);
    }
    for (const std::size_t i : it->entries)
    {
      layout.legend[i] = { Pixels(x), below + (row - layout.Patch()) / 2 };
      x += EntryWidth(furniture.legend[i], layout) + EntryGap * font;
      contentRight = std::max(contentRight, Pixels(x - EntryGap * font));
    }
    if (first && scaleRow)
    {
      layout.scaleBar = { layout.data.x, below + row / 2 };
      contentRight = std::max(contentRight, Pixels(layout.data.x + scaleWidth));
    }
    below += row;
  }

  if (barBelow)
  {
    // Right part of the width; numbers below it, the title below them.
    const int start = hasScale ? Pixels(std::max(0.3 * layout.data.width, scaleWidth + 3 * font)) : 0;
    const double titleLength = MeasureText(bar.title, font).width;
    const int length = std::max(layout.data.width - start, Pixels(std::max(8 * font, titleLength)));
    const int thickness = Pixels(BarThickness * font);
    const int base = below + Pixels(2.9 * font);
    const int pointed = furniture.bar->above ? thickness : 0;
    const int blunt = furniture.bar->below ? thickness : 0;
    layout.bar = { layout.data.x + start + blunt, base, length - pointed - blunt, thickness };
    if (hasScale)
    {
      layout.scaleBar = { layout.data.x, base + thickness / 2 };
    }
    contentRight = std::max(contentRight, layout.data.x + start + length + Pixels(0.6 * bar.widest));
    below = base + thickness;
  }
  layout.data.y =
    below + (below > margin ? Pixels(0.45 * font) + (barBelow ? Pixels(0.35 * font) : 0) : 0) + layout.Rule();
  if (furniture.bar && layout.barUpright)
  {
    const int thickness = Pixels(BarThickness * font);
    const int pointed = furniture.bar->above ? thickness : 0;
    const int blunt = furniture.bar->below ? thickness : 0;
    layout.bar = { layout.data.Right() + layout.Rule() + gap, layout.data.y + blunt, thickness,
      layout.data.height - pointed - blunt };
  }
  int top = layout.data.Top() + layout.Rule();
  if (!furniture.title.empty())
  {
    layout.title = { layout.data.x - layout.Rule(), top + Pixels(0.75 * font) };
    top += Pixels(0.75 * font + 1.05 * 1.2 * font);
    contentRight = std::max(contentRight, layout.title.x + Pixels(MeasureText(furniture.title, 1.2 * font).width));
  }
  layout.width = std::max(contentRight, fullRight) + margin;
  layout.height = top + margin;
  return layout;
}

void Shift(Layout& layout, int dx, int dy)
{
  layout.data.x += dx;
  layout.data.y += dy;
  layout.bar.x += dx;
  layout.bar.y += dy;
  layout.title = { layout.title.x + dx, layout.title.y + dy };
  if (layout.scaleBar)
  {
    layout.scaleBar = PixelPoint{ layout.scaleBar->x + dx, layout.scaleBar->y + dy };
  }
  for (PixelPoint& point : layout.legend)
  {
    point = { point.x + dx, point.y + dy };
  }
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
    {
      scale = longest <= LargestExact ? std::max(1.0, std::round(scale)) : 1.25 * AutomaticSide / longest;
    }
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
  {
    low = std::floor(low);
  }
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
  {
    DrawPoint(canvas, rect, layout.barUpright, true, bar.map->At(1), ink, rule);
  }
  if (bar.below)
  {
    DrawPoint(canvas, rect, layout.barUpright, false, bar.map->At(0), ink, rule);
  }
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
  {
    canvas.Frame(layout.data, rule, ink);
  }
  if (!furniture.title.empty())
  {
    canvas.Text(layout.title.x, layout.title.y, furniture.title, 1.2 * font, ink, Align::Low, Align::Low);
  }
  if (layout.scaleBar)
  {
    const int thickness = std::max(2, Pixels(0.2 * font));
    canvas.Fill({ layout.scaleBar->x, layout.scaleBar->y - thickness / 2, layout.scaleBarLength, thickness }, ink);
    canvas.Text(layout.scaleBar->x + layout.scaleBarLength + 0.5 * font, layout.scaleBar->y, layout.scaleBarText, font,
      ink, Align::Low, Align::Middle);
  }
  if (furniture.bar)
  {
    DrawBar(canvas, *furniture.bar, layout, ink);
  }
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
