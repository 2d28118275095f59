#include "pictures/TiffEntries.h"

#include "pictures/FileBytes.h"

namespace lamella::micrograph
{

std::optional<std::uint64_t> TiffSource::open()
{
  const auto head = read(0, 8);
  if (!head || (*head)[0] != (*head)[1] || ((*head)[0] != 'I' && (*head)[0] != 'M'))
    return std::nullopt;
  bigEndian = (*head)[0] == 'M';
  const std::uint64_t version = numberFrom(head->data() + 2, 2, bigEndian);
  big = version == 43;
  if (version == 42)
    return numberFrom(head->data() + 4, 4, bigEndian);
  const auto first = big ? read(8, 8) : std::nullopt;
  return first ? std::optional(numberFrom(first->data(), 8, bigEndian)) : std::nullopt;
}

std::uint64_t TiffEntries::number(int tag, std::uint64_t otherwise) const
{
  const auto found = numbers.find(tag);
  return found == numbers.end() ? otherwise : found->second;
}

double TiffEntries::ratio(int tag) const
{
  const auto found = ratios.find(tag);
  return found == ratios.end() ? 0 : found->second;
}

std::optional<TiffEntries> tiffEntries(const TiffSource& source, std::uint64_t at)
{
  const int countBytes = source.big ? 8 : 2;
  const int offsetBytes = source.big ? 8 : 4;
  const std::uint64_t entryBytes = source.big ? 20 : 12;
  constexpr std::uint64_t most = 4096;
  const auto count = source.read(at, static_cast<std::uint64_t>(countBytes));
  const std::uint64_t entries = count ? numberFrom(count->data(), countBytes, source.bigEndian) : most + 1;
  const auto bytes =
    entries > most ? std::nullopt : source.read(at + static_cast<std::uint64_t>(countBytes), entries * entryBytes);
  if (!bytes)
    return std::nullopt;
  TiffEntries result;
  for (std::uint64_t i = 0; i < entries; ++i)
  {
    const std::uint8_t* const entry = bytes->data() + i * entryBytes;
    const int tag = static_cast<int>(numberFrom(entry, 2, source.bigEndian));
    const auto type = numberFrom(entry + 2, 2, source.bigEndian);
    if (numberFrom(entry + 4, offsetBytes, source.bigEndian) != 1)
      continue;
    const std::uint8_t* const value = entry + 4 + offsetBytes;
    constexpr std::uint64_t shortNumber = 3, longNumber = 4, rational = 5;
    if (type == shortNumber || type == longNumber)
    {
      result.numbers[tag] = numberFrom(value, type == shortNumber ? 2 : 4, source.bigEndian);
    }
    else if (type == rational && (tag == TiffEntries::xResolution || tag == TiffEntries::yResolution))
    {
      const std::optional<std::vector<std::uint8_t>> pair = source.big
        ? std::optional(std::vector<std::uint8_t>(value, value + 8))
        : source.read(numberFrom(value, 4, source.bigEndian), 8);
      const auto below = pair ? static_cast<double>(numberFrom(pair->data() + 4, 4, source.bigEndian)) : 0;
      result.ratios[tag] = below > 0 ? static_cast<double>(numberFrom(pair->data(), 4, source.bigEndian)) / below : 0;
    }
  }
  return result;
}

std::optional<std::array<double, 2>> resolution(const TiffEntries& entries)
{
  const double x = entries.ratio(TiffEntries::xResolution);
  const double y = entries.ratios.contains(TiffEntries::yResolution) ? entries.ratio(TiffEntries::yResolution) : x;
  const std::uint64_t code = entries.number(TiffEntries::resolutionUnit, 2);
  const double unit = code == 2 ? 0.0254 : code == 3 ? 0.01 : 0; // inch, centimetre
  if (!(x > 0) || !(y > 0) || !(unit > 0))
    return std::nullopt;
  return std::array<double, 2>{ unit / x, unit / y };
}

} // namespace lamella::micrograph
