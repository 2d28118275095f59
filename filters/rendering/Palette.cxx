#include "Palette.h"

#include "core/Lower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lamella::rendering
{
namespace
{

// Every eighth of the 256 published colours; linear interpolation between them errs by less than 2 of 255 (cividis: 6).
constexpr std::uint32_t Viridis[] = { 0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453781, 0x424086, 0x3e4989,
  0x3b528b, 0x375b8d, 0x33638d, 0x2f6b8e, 0x2c728e, 0x297a8e, 0x26828e, 0x23898e, 0x21918c, 0x1f978b, 0x1f9f88,
  0x21a685, 0x27ad81, 0x31b57b, 0x3dbc74, 0x4cc26c, 0x5cc863, 0x6ece58, 0x81d34d, 0x95d840, 0xaadc32, 0xc0df25,
  0xd5e21a, 0xeae51a, 0xfde725 };
constexpr std::uint32_t Inferno[] = { 0x000004, 0x040312, 0x0b0724, 0x150b37, 0x210c4a, 0x2f0a5b, 0x3d0965, 0x4a0c6b,
  0x57106e, 0x64156e, 0x71196e, 0x7d1e6d, 0x8a226a, 0x972766, 0xa32c61, 0xb0315b, 0xbc3754, 0xc63d4d, 0xd04545,
  0xda4e3c, 0xe35933, 0xeb6429, 0xf1711f, 0xf67e14, 0xf98c0a, 0xfb9b06, 0xfcaa0f, 0xfbba1f, 0xf9c932, 0xf5d949,
  0xf2e865, 0xf3f586, 0xfcffa4 };
constexpr std::uint32_t Magma[] = { 0x000004, 0x030312, 0x0a0822, 0x130d34, 0x1d1147, 0x29115a, 0x36106b, 0x440f76,
  0x51127c, 0x5d177f, 0x6a1c81, 0x762181, 0x832681, 0x902a81, 0x9c2e7f, 0xaa337d, 0xb73779, 0xc23b75, 0xcf4070,
  0xdb476a, 0xe55064, 0xee5b5e, 0xf4695c, 0xf9785d, 0xfb8761, 0xfd9668, 0xfea571, 0xfeb47b, 0xfec287, 0xfed194,
  0xfde0a1, 0xfceeb0, 0xfcfdbf };
constexpr std::uint32_t Cividis[] = { 0x00224e, 0x00285b, 0x002e6a, 0x053371, 0x1a386f, 0x273e6e, 0x32436d, 0x3b496c,
  0x434e6c, 0x4b546c, 0x535a6d, 0x5a5f6e, 0x61656f, 0x686a71, 0x6f7073, 0x767676, 0x7d7c78, 0x838179, 0x8b8778,
  0x928d78, 0x9a9376, 0xa29975, 0xaaa073, 0xb3a670, 0xbbad6d, 0xc3b369, 0xccba64, 0xd4c15f, 0xddc858, 0xe6d051,
  0xefd748, 0xf8df3c, 0xfee838 };
constexpr std::uint32_t Gray[] = { 0x000000, 0xffffff };
constexpr std::uint32_t CoolWarm[] = { 0x3b4cc0, 0x4e68d8, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2fe, 0xb9d0f9, 0xccd9ed,
  0xdddcdc, 0xecd3c5, 0xf5c4ac, 0xf7b093, 0xf4987a, 0xeb7d62, 0xdd5f4b, 0xca3b37, 0xb40426 };
// ColorBrewer's RdYlBu from its blue end, which colour-blind readers can tell apart.
constexpr std::uint32_t BlueRed[] = { 0x313695, 0x4575b4, 0x74add1, 0xabd9e9, 0xe0f3f8, 0xffffbf, 0xfee090, 0xfdae61,
  0xf46d43, 0xd73027, 0xa50026 };

constexpr std::string_view MapNames[] = { "viridis", "inferno", "magma", "cividis", "gray", "coolwarm", "blue-red" };

// Paul Tol's "bright" and "muted" sets, in an order in which the first few go well with the near-white of a void.
constexpr std::uint32_t Qualitative[] = { 0x4477aa, 0x44aa99, 0xcc6677, 0x88ccee, 0x999933, 0xaa4499, 0x117733,
  0x882255, 0x332288 };
constexpr std::uint32_t VoidColor = 0xf6f3ea;
constexpr std::uint32_t WallColor = 0xc68e5a;
constexpr std::uint32_t LamellaColor = 0x6a3d23;
constexpr std::uint32_t StoneColor = 0xdcc092;
constexpr std::uint32_t MatrixColor = 0xc9c4bb;
constexpr std::uint32_t CementColor = 0x7d6b62; // a matrix between grains: dark enough to be told from both in print

// Light enough for outlines on top, apart enough side by side.
constexpr std::uint32_t GrainSet[] = { 0x86b5da, 0xf0a37b, 0xf1da8f, 0xe79fb1, 0xa8d9ea, 0x7cc3a2, 0xc6d27c, 0xb8a1d4,
  0xd3b48c, 0x9aaec4 };

Color FromHex(std::uint32_t hex)
{
  return { static_cast<std::uint8_t>(hex >> 16U), static_cast<std::uint8_t>(hex >> 8U & 255U),
    static_cast<std::uint8_t>(hex & 255U), 255 };
}

bool ContainsAny(std::string_view name, std::initializer_list<std::string_view> words)
{
  const std::string lower = lamella::lower(std::string(name));
  return std::any_of(
    words.begin(), words.end(), [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

} // namespace

ColorMap::ColorMap(std::span<const std::uint32_t> points)
  : Points(points.begin(), points.end())
{
}

std::span<const std::string_view> ColorMap::Names()
{
  return MapNames;
}

const ColorMap* ColorMap::Find(std::string_view name)
{
  static const ColorMap maps[] = { ColorMap(Viridis), ColorMap(Inferno), ColorMap(Magma), ColorMap(Cividis),
    ColorMap(Gray), ColorMap(CoolWarm), ColorMap(BlueRed) };
  const auto* found = std::find(std::begin(MapNames), std::end(MapNames), name);
  return found == std::end(MapNames) ? nullptr : &maps[found - std::begin(MapNames)];
}

Color ColorMap::At(double t) const
{
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(this->Points.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), this->Points.size() - 2);
  const double share = place - static_cast<double>(low);
  const Color a = FromHex(this->Points[low]);
  const Color b = FromHex(this->Points[low + 1]);
  const auto mix = [share](std::uint8_t x, std::uint8_t y)
  { return static_cast<std::uint8_t>(std::lround((1.0 - share) * x + share * y)); };
  return { mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), 255 };
}

bool IsVoidName(std::string_view name)
{
  return ContainsAny(name, { "void", "pore", "lumen", "air", "empty", "gas" });
}

std::vector<Color> PhaseColors(std::span<const std::string> names)
{
  std::vector<Color> colors;
  std::size_t next = 0;
  const auto take = [&colors](std::uint32_t hex)
  {
    // A second phase of the same kind must not look like the first.
    const Color color = FromHex(hex);
    if (std::find(colors.begin(), colors.end(), color) != colors.end())
      return false;
    colors.push_back(color);
    return true;
  };
  const auto isGrain = [](const std::string& name) {
    return ContainsAny(name, { "grain", "quartz", "sand", "stone", "rock", "mineral" });
  };
  const bool between = std::any_of(names.begin(), names.end(), isGrain);
  for (const std::string& name : names)
  {
    const bool taken = IsVoidName(name)                                  ? take(VoidColor)
      : ContainsAny(name, { "lamella" })                                 ? take(LamellaColor)
      : ContainsAny(name, { "wall", "solid", "wood", "fibre", "fiber" }) ? take(WallColor)
      : isGrain(name)                                                    ? take(StoneColor)
      : ContainsAny(name, { "matrix" })                                  ? take(between ? CementColor : MatrixColor)
                                                                         : false;
    if (!taken)
      colors.push_back(FromHex(Qualitative[next++ % std::size(Qualitative)]));
  }
  return colors;
}

std::vector<Color> GrainColors(std::span<const std::int64_t> ids, int nx, int ny, int nz)
{
  const std::int64_t largest = ids.empty() ? 0 : std::max<std::int64_t>(0, *std::max_element(ids.begin(), ids.end()));
  // Grains with a wall between them are neighbours too, up to the thickness of a cell wall.
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  const std::array<std::int64_t, 3> stride{ 1, nx, static_cast<std::int64_t>(nx) * ny };
  const std::array<int, 3> size{ nx, ny, nz };
  constexpr std::int64_t reach = 12;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(ids.size()); ++i)
    {
      const std::int64_t place = i / stride.at(axis) % size.at(axis);
      const std::int64_t own = ids[static_cast<std::size_t>(i)];
      for (std::int64_t step = 1; step <= reach && place + step < size.at(axis) && own > 0; ++step)
      {
        const std::int64_t other = ids[static_cast<std::size_t>(i + step * stride.at(axis))];
        if (other > 0 && other != own)
        {
          const std::pair<std::int64_t, std::int64_t> pair{ std::max(own, other), std::min(own, other) };
          if (pairs.empty() || pairs.back() != pair)
            pairs.push_back(pair);
          break;
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

  constexpr std::size_t count = std::size(GrainSet);
  std::vector<std::size_t> chosen(static_cast<std::size_t>(largest) + 1, 0);
  auto pair = pairs.begin();
  for (std::int64_t id = 1; id <= largest; ++id)
  {
    std::array<bool, count> taken{};
    for (; pair != pairs.end() && pair->first == id; ++pair)
      taken.at(chosen[static_cast<std::size_t>(pair->second)]) = true;
    // The golden ratio spreads consecutive ids over the set.
    const auto start = static_cast<std::size_t>(std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0) * count);
    std::size_t pick = start % count;
    for (std::size_t tries = 0; tries < count && taken.at(pick); ++tries)
      pick = (pick + 1) % count;
    chosen[static_cast<std::size_t>(id)] = pick;
  }
  std::vector<Color> colors(chosen.size());
  std::transform(
    chosen.begin(), chosen.end(), colors.begin(), [](std::size_t pick) { return FromHex(GrainSet[pick]); });
  colors[0] = FromHex(VoidColor);
  return colors;
}

} // namespace lamella::rendering
