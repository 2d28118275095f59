#include "micrograph/TiffDirectory.h"

#include "micrograph/FileBytes.h"

#include <algorithm>
#include <stdexcept>

namespace lamella::micrograph
{
namespace
{

constexpr std::uint64_t mostValues = 1U << 26;

int bytesOfType(int type)
{
  switch (type)
  {
    case 1: // BYTE
    case 2: // ASCII
    case 6: // SBYTE
    case 7: // UNDEFINED
      return 1;
    case 3: // SHORT
    case 8: // SSHORT
      return 2;
    case 4:  // LONG
    case 9:  // SLONG
    case 11: // FLOAT
    case 13: // IFD
      return 4;
    case 5:  // RATIONAL
    case 10: // SRATIONAL
    case 12: // DOUBLE
    case 16: // LONG8
    case 17: // SLONG8
    case 18: // IFD8
      return 8;
    default:
      return 0;
  }
}

} // namespace

std::uint64_t TiffSource::number(std::uint64_t at, int bytes) const
{
  return numberFrom(read(at, static_cast<std::uint64_t>(bytes)).data(), bytes, bigEndian);
}

std::optional<std::uint64_t> TiffSource::open()
{
  const std::vector<std::uint8_t> head = read(0, 4);
  if (head[0] != head[1] || (head[0] != 'I' && head[0] != 'M'))
  {
    return std::nullopt;
  }
  bigEndian = head[0] == 'M';
  const std::uint64_t version = numberFrom(head.data() + 2, 2, bigEndian);
  big = version == 43;
  if (version != 42 && !big)
  {
    return std::nullopt;
  }
  return big ? number(8, 8) : number(4, 4);
}

TiffDirectory::TiffDirectory(const TiffSource& source, std::uint64_t at)
  : source_(&source)
{
  const int countBytes = source.big ? 8 : 2;
  const int offsetBytes = source.big ? 8 : 4;
  const std::uint64_t entryBytes = source.big ? 20 : 12;
  const std::uint64_t count = source.number(at, countBytes);
  if (count > 4096)
  {
    throw std::length_error("a TIFF directory of more than 4096 entries");
  }
  const std::uint64_t first = at + static_cast<std::uint64_t>(countBytes);
  const std::vector<std::uint8_t> bytes = source.read(first, count * entryBytes);
  for (std::uint64_t i = 0; i < count; ++i)
  {
    const std::uint8_t* const entry = bytes.data() + i * entryBytes;
    Entry values;
    values.type = static_cast<int>(numberFrom(entry + 2, 2, source.bigEndian));
    values.count = numberFrom(entry + 4, offsetBytes, source.bigEndian);
    if (values.count > mostValues)
    {
      throw std::length_error("a TIFF entry of more than 67 million values");
    }
    const std::uint64_t size = values.count * static_cast<std::uint64_t>(bytesOfType(values.type));
    const int valueAt = 4 + offsetBytes;
    values.at = size <= static_cast<std::uint64_t>(offsetBytes)
      ? first + i * entryBytes + static_cast<std::uint64_t>(valueAt)
      : numberFrom(entry + valueAt, offsetBytes, source.bigEndian);
    entries_[static_cast<int>(numberFrom(entry, 2, source.bigEndian))] = values;
  }
  next_ = source.number(first + count * entryBytes, offsetBytes);
}

std::uint64_t TiffDirectory::value(int tag, std::uint64_t otherwise) const
{
  const std::vector<std::uint64_t> all = values(tag);
  return all.empty() ? otherwise : all.front();
}

std::vector<std::uint64_t> TiffDirectory::values(int tag) const
{
  const auto found = entries_.find(tag);
  const int size = found == entries_.end() ? 0 : bytesOfType(found->second.type);
  if (size == 0 || found->second.count == 0)
  {
    return {};
  }
  const std::vector<std::uint8_t> bytes =
    source_->read(found->second.at, found->second.count * static_cast<std::uint64_t>(size));
  std::vector<std::uint64_t> result(found->second.count);
  for (std::size_t i = 0; i < result.size(); ++i)
  {
    result[i] = numberFrom(bytes.data() + i * static_cast<std::size_t>(size), size, source_->bigEndian);
  }
  return result;
}

double TiffDirectory::ratio(int tag) const
{
  const auto found = entries_.find(tag);
  if (found == entries_.end() || found->second.type != 5 || found->second.count < 1)
  {
    return 0;
  }
  const auto above = static_cast<double>(source_->number(found->second.at, 4));
  const auto below = static_cast<double>(source_->number(found->second.at + 4, 4));
  return below > 0 ? above / below : 0;
}

std::string TiffDirectory::text(int tag) const
{
  const auto found = entries_.find(tag);
  if (found == entries_.end() || found->second.type != 2)
  {
    return {};
  }
  const std::vector<std::uint8_t> bytes = source_->read(found->second.at, found->second.count);
  return { bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{ 0 }) };
}

} // namespace lamella::micrograph
