#include "Text.h"

#include "vtkFreeTypeTools.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkStdString.h"
#include "vtkTextProperty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

namespace lamella::rendering
{
namespace
{

// Letters are drawn this many times larger and averaged: even spacing at every size, where hinting would make it
// uneven.
constexpr int TextOversampling = 4;
constexpr double RaisedSize = 0.68;
constexpr double RaisedBy = 0.36; // of the font's size

constexpr std::pair<std::string_view, char> Raised[] = { { "⁰", '0' }, { "¹", '1' }, { "²", '2' }, { "³", '3' },
  { "⁴", '4' }, { "⁵", '5' }, { "⁶", '6' }, { "⁷", '7' }, { "⁸", '8' }, { "⁹", '9' }, { "⁺", '+' }, { "⁻", '-' } };

struct Run
{
  std::string text;
  bool raised = false;
};

std::vector<Run> SplitRuns(const std::string& text)
{
  std::vector<Run> runs;
  const auto append = [&runs](std::string_view piece, bool raised)
  {
    if (runs.empty() || runs.back().raised != raised)
      runs.push_back({ {}, raised });
    runs.back().text += piece;
  };
  for (std::size_t at = 0; at < text.size();)
  {
    const auto* found = std::find_if(std::begin(Raised), std::end(Raised),
      [&](const auto& entry) { return std::string_view(text).substr(at).starts_with(entry.first); });
    if (found != std::end(Raised))
    {
      append(found->second == '-' ? std::string_view("−") : std::string_view(&found->second, 1), true);
      at += found->first.size();
    }
    else
    {
      append(std::string_view(text).substr(at, 1), false);
      ++at;
    }
  }
  return runs;
}

std::string FindFont()
{
  const char* chosen = std::getenv("LAMELLA_FONT");
  for (const char* file : { chosen, "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
         "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
         "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/matplotlib/mpl-data/fonts/ttf/DejaVuSans.ttf" })
  {
    std::error_code error;
    if (file && *file && std::filesystem::is_regular_file(file, error))
      return file;
  }
  return {};
}

/// One run of letters in large: coverage, width of the pen's way, baseline.
struct LargeText
{
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> coverage;
};

LargeText DrawLarge(const std::string& text, int size)
{
  static const std::string font = FindFont();
  vtkNew<vtkTextProperty> property;
  property->SetFontSize(size);
  property->SetColor(1, 1, 1);
  if (font.empty())
  {
    property->SetFontFamilyToArial();
  }
  else
  {
    property->SetFontFamily(VTK_FONT_FILE);
    property->SetFontFile(font.c_str());
  }
  LargeText large;
  vtkNew<vtkImageData> image;
  std::array<int, 2> extent{ 0, 0 };
  constexpr int dpi = 72; // a point is a pixel
  if (text.empty() ||
    !vtkFreeTypeTools::GetInstance()->RenderString(property, vtkStdString(text), dpi, image, extent.data()))
    return large;
  large.width = extent[0];
  large.height = extent[1];
  const int stride = image->GetDimensions()[0];
  const auto* pixels = static_cast<const unsigned char*>(image->GetScalarPointer());
  large.coverage.resize(static_cast<std::size_t>(large.width) * static_cast<std::size_t>(large.height));
  for (int y = 0; y < large.height; ++y)
  {
    for (int x = 0; x < large.width; ++x)
    {
      large
        .coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(large.width) + static_cast<std::size_t>(x)] =
        pixels[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(x)) + 3];
    }
  }
  return large;
}

/// Rows of a figure's ink, which stands on the baseline: [first, last).
std::pair<int, int> FigureRows(int size)
{
  static std::map<int, std::pair<int, int>> known;
  const auto found = known.find(size);
  if (found != known.end())
    return found->second;
  const LargeText figure = DrawLarge("1", size);
  std::pair<int, int> rows{ figure.height, 0 };
  for (int y = 0; y < figure.height; ++y)
  {
    const auto* row = &figure.coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(figure.width)];
    if (std::any_of(row, row + figure.width, [](std::uint8_t c) { return c > 127; }))
    {
      rows.first = std::min(rows.first, y);
      rows.second = std::max(rows.second, y + 1);
    }
  }
  return known[size] = rows;
}

int LargeSize(double size)
{
  return std::max(4, static_cast<int>(std::lround(size * TextOversampling)));
}

} // namespace

TextMetrics MeasureText(const std::string& text, double size)
{
  TextMetrics metrics;
  const int large = LargeSize(size);
  const auto rows = FigureRows(large);
  metrics.capHeight = static_cast<double>(rows.second - rows.first) / TextOversampling;
  for (const Run& run : SplitRuns(text))
  {
    const int runSize = run.raised ? static_cast<int>(std::lround(large * RaisedSize)) : large;
    metrics.width += static_cast<double>(DrawLarge(run.text, runSize).width) / TextOversampling;
  }
  return metrics;
}

TextImage DrawText(const std::string& text, double size)
{
  const int large = LargeSize(size);
  struct Placed
  {
    LargeText image;
    int x;
    int y;
  };
  std::vector<Placed> placed;
  int pen = 0;
  int bottom = 0;
  int top = 1;
  for (const Run& run : SplitRuns(text))
  {
    const int runSize = run.raised ? static_cast<int>(std::lround(large * RaisedSize)) : large;
    Placed piece{ DrawLarge(run.text, runSize), pen, 0 };
    piece.y = (run.raised ? static_cast<int>(std::lround(large * RaisedBy)) : 0) - FigureRows(runSize).first;
    pen += piece.image.width;
    bottom = std::min(bottom, piece.y);
    top = std::max(top, piece.y + piece.image.height);
    placed.push_back(std::move(piece));
  }

  // The large image starts at a multiple of the oversampling below the baseline, so that the baseline stays sharp.
  constexpr int n = TextOversampling;
  const int below = (-bottom + n - 1) / n * n;
  TextImage result;
  result.originY = static_cast<double>(below) / n;
  result.width = (pen + n - 1) / n;
  result.height = (below + top + n - 1) / n;
  const auto width = static_cast<std::size_t>(result.width);
  std::vector<unsigned> sums(width * static_cast<std::size_t>(result.height), 0);
  for (const Placed& piece : placed)
  {
    for (int y = 0; y < piece.image.height; ++y)
    {
      for (int x = 0; x < piece.image.width; ++x)
      {
        sums[static_cast<std::size_t>((y + piece.y + below) / n) * width +
          static_cast<std::size_t>((x + piece.x) / n)] +=
          piece.image.coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(piece.image.width) +
            static_cast<std::size_t>(x)];
      }
    }
  }
  result.coverage.resize(sums.size());
  std::transform(sums.begin(), sums.end(), result.coverage.begin(),
    [](unsigned sum) { return static_cast<std::uint8_t>(std::min(255U, sum / (n * n))); });
  return result;
}

} // namespace lamella::rendering
