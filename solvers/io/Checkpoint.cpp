#include "io/Checkpoint.h"

#include "core/Error.h"
#include "core/PartFile.h"
#include "io/Hdf5.h"
#include "io/Provenance.h"
#include "io/Survives.h"
#include "lamella/Version.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <exception>
#include <fstream>
#include <istream>
#include <span>
#include <system_error>
#include <utility>

namespace lamella::io
{
namespace
{

using hdf5::good;
using hdf5::Handle;
using hdf5::Quiet;
using hdf5::readText;
using hdf5::textType;
using hdf5::writeText;

constexpr int format = 1;                ///< one more with every change that an older program cannot read
constexpr std::size_t headerBytes = 512; // the least that HDF5 passes over
constexpr std::string_view magic = "Lamella checkpoint\n";

std::string program()
{
  return fmt::format("lamella {}", lamella::version());
}

/// Attributes hold 64 KiB at most; this is a dataset.
void writeLongText(hid_t at, const char* name, const std::string& text)
{
  const Handle type = textType(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle set(H5Dcreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  good(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()));
}

std::string readLongText(hid_t at, const char* name)
{
  const Handle set(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(set), H5Tclose);
  hdf5::requireOneText(type, Handle(H5Dget_space(set), H5Sclose));
  std::string text(H5Tget_size(type), '\0');
  good(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()));
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

hid_t memoryType(const CheckpointArray& array)
{
  return array.values.index() == 0 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

void writeColumns(hid_t set, hid_t space, const CheckpointArray& array)
{
  constexpr std::int64_t most = std::int64_t{ 1 } << 16;
  const std::int64_t rows = array.shape.at(0);
  const std::int64_t count = array.shape.at(1);
  std::vector<double> values;
  for (std::int64_t begin = 0; begin < count; begin += most)
  {
    const std::int64_t end = std::min(count, begin + most);
    values.resize(static_cast<std::size_t>(rows * (end - begin)));
    array.columns(begin, end, values);
    const hsize_t start[2] = { 0, static_cast<hsize_t>(begin) };
    const hsize_t size[2] = { static_cast<hsize_t>(rows), static_cast<hsize_t>(end - begin) };
    good(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, size, nullptr));
    const Handle memory(H5Screate_simple(2, size, nullptr), H5Sclose);
    good(H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()));
  }
}

void writeArray(hid_t file, const std::string& name, const CheckpointArray& array)
{
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const hid_t stored = array.values.index() == 0 ? H5T_IEEE_F64LE : H5T_STD_I64LE;
  const Handle set(H5Dcreate2(file, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  if (array.columns)
    writeColumns(set, space, array);
  std::visit(
    [&](const auto& values)
    {
      if (!values.empty())
        good(H5Dwrite(set, memoryType(array), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    },
    array.values);
  writeText(set, "unit", array.unit);
  writeText(set, "description", array.description);
  writeText(set, "creator", program());
}

/// @param most bytes that its values can take: they are stored as they are
CheckpointArray readArray(hid_t file, const char* name, std::size_t most)
{
  CheckpointArray array;
  const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const Handle space(H5Dget_space(set), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  good(H5Sget_simple_extent_dims(space, shape.data(), nullptr));
  array.shape.assign(shape.begin(), shape.end());
  const Handle type(H5Dget_type(set), H5Tclose);
  if (H5Tget_class(type) == H5T_INTEGER)
    array.values = std::vector<std::int64_t>();
  const std::size_t count = hdf5::countStored(set);
  good(!shape.empty() && H5Tget_class(type) != H5T_STRING && count <= most / sizeof(double) ? 0 : -1);
  std::visit(
    [&](auto& values)
    {
      values.resize(count);
      if (count > 0)
        good(H5Dread(set, memoryType(array), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    },
    array.values);
  array.unit = readText(set, "unit");
  array.description = readText(set, "description");
  return array;
}

/// A new file that is held in memory.
Handle newInMemory()
{
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  good(H5Pset_fapl_core(access, std::size_t{ 1 } << 20, 0));
  return { H5Fcreate("checkpoint", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose };
}

/// One on the disk, behind its header. Without a lock, which not every file system has: a run replaces its files whole.
Handle openStored(const std::filesystem::path& path)
{
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  good(H5Pset_file_locking(access, 0, 1));
  return { H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose };
}

/// A checkpoint as a file in memory; its arrays are given away, one after the other.
Handle encoded(Checkpoint checkpoint)
{
  Handle file = newInMemory();
  writeText(file, "format", fmt::format("lamella checkpoint {}", format));
  writeText(file, "kind", checkpoint.kind);
  writeLongText(file, "scene", checkpoint.scene);
  writeLongText(file, "provenance", checkpoint.provenance);
  {
    const Handle group(H5Gcreate2(file, "numbers", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    for (const auto& [name, value] : checkpoint.numbers)
    {
      const Handle attribute(
        H5Acreate2(group, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
      good(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
    }
    const Handle arrays(H5Gcreate2(file, "arrays", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (auto& [name, array] : checkpoint.arrays)
    {
      writeArray(arrays, name, array);
      array = {};
    }
  }
  good(H5Fflush(file, H5F_SCOPE_GLOBAL));
  return file;
}

/// The bytes of a file in memory, where they are.
std::span<const std::byte> bytesOf(const Handle& file)
{
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  const Handle access(H5Fget_access_plist(file), H5Pclose);
  void* place = nullptr;
  good(size > 0 && H5Fget_vfd_handle(file, access, &place) >= 0 && place != nullptr ? 0 : -1);
  return { *static_cast<const std::byte* const*>(place), static_cast<std::size_t>(size) }; // the core driver's
}

/// @param most bytes that an array can take  @param keeps whether the arrays are wanted, or only that they can be read
Checkpoint contentOf(const std::filesystem::path& path, std::size_t most, bool keeps)
{
  const Quiet quiet;
  const Handle file = openStored(path);
  Checkpoint checkpoint;
  checkpoint.kind = readText(file, "kind");
  checkpoint.scene = readLongText(file, "scene");
  checkpoint.provenance = readLongText(file, "provenance");
  const Handle numbers(H5Gopen2(file, "numbers", H5P_DEFAULT), H5Gclose);
  good(H5Aiterate2(
    numbers, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
    [](hid_t at, const char* name, const H5A_info_t*, void* to) -> herr_t
    {
      double value = 0;
      try
      {
        hdf5::readNumbers(Handle(H5Aopen(at, name, H5P_DEFAULT), H5Aclose), H5T_NATIVE_DOUBLE, 1, &value);
        (*static_cast<std::map<std::string, double>*>(to))[name] = value;
      }
      catch (const std::exception&)
      {
        return -1; // not through HDF5
      }
      return 0;
    },
    &checkpoint.numbers));
  const Handle arrays(H5Gopen2(file, "arrays", H5P_DEFAULT), H5Gclose);
  std::vector<std::string> names;
  good(H5Literate(
    arrays, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
    [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t
    {
      static_cast<std::vector<std::string>*>(to)->emplace_back(name);
      return 0;
    },
    &names));
  for (const std::string& name : names)
  {
    CheckpointArray array = readArray(arrays, name.c_str(), most);
    if (keeps)
      checkpoint.arrays[name] = std::move(array);
  }
  return checkpoint;
}

std::string hashOf(std::span<const std::byte> bytes)
{
  Sha256 hash;
  hash.update(bytes);
  return hash.finish();
}

/// Of the rest of a file; nothing where it cannot be read to its end.
std::string hashOf(std::istream& file)
{
  Sha256 hash;
  std::vector<char> some(std::size_t{ 1 } << 20);
  while (file)
  {
    file.read(some.data(), static_cast<std::streamsize>(some.size()));
    hash.update(std::as_bytes(std::span(some)).first(static_cast<std::size_t>(file.gcount())));
  }
  return file.eof() ? hash.finish() : std::string();
}

/// What stands behind "name " in the header, up to the end of the line.
std::string field(std::string_view header, std::string_view name)
{
  const std::size_t at = header.find(fmt::format("\n{} ", name));
  if (at == std::string_view::npos)
    return {};
  const std::string_view rest = header.substr(at + name.size() + 2);
  return std::string(rest.substr(0, rest.find('\n')));
}

template <class T>
T numberIn(std::string_view header, std::string_view name)
{
  const std::string text = field(header, name);
  T value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

template <class T>
const T& found(const std::map<std::string, T>& all, const std::string& name)
{
  const auto at = all.find(name);
  if (at == all.end())
    throw InputError(fmt::format("the checkpoint has no '{}'", name), "start the run anew");
  return at->second;
}

template <class Values>
const Values& valuesOf(const Checkpoint& checkpoint, const std::string& name)
{
  const CheckpointArray& array = found(checkpoint.arrays, name);
  if (!std::holds_alternative<Values>(array.values))
    throw InputError(fmt::format("the checkpoint's '{}' are numbers of another sort", name), "start the run anew");
  return std::get<Values>(array.values);
}

std::vector<std::string_view> linesOf(std::string_view text)
{
  std::vector<std::string_view> lines;
  while (!text.empty())
  {
    const std::size_t end = std::min(text.size(), text.find('\n'));
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return lines;
}

} // namespace

double Checkpoint::number(const std::string& name) const
{
  return found(numbers, name);
}

std::int64_t Checkpoint::count(const std::string& name) const
{
  const double value = found(numbers, name);
  if (!(value >= 0 && value <= 0x1p53 && value == std::floor(value)))
    throw InputError(fmt::format("the checkpoint's '{}' is {}", name, value), "start the run anew");
  return static_cast<std::int64_t>(value);
}

void Checkpoint::expectFinite(const std::string& name) const
{
  const auto number = numbers.find(name);
  const bool finite = number != numbers.end()
    ? std::isfinite(number->second)
    : std::ranges::all_of(reals(name), [](double value) { return std::isfinite(value); });
  if (!finite)
    throw InputError(fmt::format("the checkpoint's '{}' holds what is no number", name), "start the run anew");
}

const std::vector<double>& Checkpoint::reals(const std::string& name) const
{
  return valuesOf<std::vector<double>>(*this, name);
}

const std::vector<std::int64_t>& Checkpoint::integers(const std::string& name) const
{
  return valuesOf<std::vector<std::int64_t>>(*this, name);
}

void Checkpoint::hold()
{
  for (auto& [name, array] : arrays)
    if (array.columns)
    {
      std::vector<double> all(static_cast<std::size_t>(array.shape.at(0) * array.shape.at(1)));
      array.columns(0, array.shape[1], all);
      array.values = std::move(all);
      array.columns = nullptr;
    }
}

void replaceFile(const std::filesystem::path& path, Checkpoint checkpoint)
{
  const Quiet quiet;
  const Handle file = encoded(std::move(checkpoint));
  const std::span<const std::byte> content = bytesOf(file);
  std::string header = fmt::format("{}format {}\nwritten-by {}\nbytes {}\nsha256 {}\nHDF5 from byte {}\n", magic,
    format, program(), content.size(), hashOf(content), headerBytes);
  header.resize(headerBytes, '\0');
  PartFile part(path, PartFile::OnSignal::stays);
  int error = part.error();
  if (error == 0)
    error = part.write({ std::as_bytes(std::span(header)), content });
  if (error == 0)
    error = part.take(path);
  if (error != 0)
    throw Error(fmt::format("cannot write '{}': {}", path.string(), std::generic_category().message(error)),
      "make room on the disk, or write to another one");
}

Checkpoint readFile(const std::filesystem::path& path)
{
  const std::string name = path.string();
  const char* anew = "continue from an earlier checkpoint, or start the run anew";
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed))
    throw InputError(
      fmt::format("'{}' is a folder, not a checkpoint", name), "give the file that a run wrote as its checkpoint");
  errno = 0;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto whole = file ? static_cast<std::size_t>(file.tellg()) : 0;
  std::string header(std::min(whole, headerBytes), '\0');
  file.seekg(0);
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  const auto unreadable = [&]
  {
    return InputError(fmt::format("cannot read '{}': {}", name, std::generic_category().message(errno)),
      "check the path and its permissions");
  };
  if (!file)
    throw unreadable();
  if (header.empty())
    throw InputError(fmt::format("'{}' is empty", name), anew);
  if (header.substr(0, magic.size()) != magic.substr(0, header.size()))
    throw InputError(fmt::format("'{}' is not a checkpoint{}", name,
                       header.substr(0, 4) == "\x89HDF" ? ", but another HDF5 file" : ""),
      "give a file that a run wrote as its checkpoint");
  const auto version = numberIn<int>(header, "format");
  if (version > format)
    throw InputError(fmt::format("'{}' is newer than this program: its format is {}, written by {}; this is {}, which "
                                 "reads format {}",
                       name, version, field(header, "written-by"), program(), format),
      "continue with the program that wrote it");
  const auto size = numberIn<std::size_t>(header, "bytes");
  if (whole < headerBytes || whole - headerBytes < size)
    throw InputError(fmt::format("'{}' is cut off: it has {} bytes of {}", name, whole,
                       size > 0 ? fmt::format("{}", headerBytes + size) : fmt::format("more than {}", headerBytes)),
      anew);
  if (version < 1 || whole - headerBytes != size || hashOf(file) != field(header, "sha256"))
  {
    if (file.bad())
      throw unreadable();
    throw InputError(fmt::format("'{}' is damaged: its bytes are not those that were written", name), anew);
  }
  // What follows can be wrong only where somebody meant it to be, and mended the hash; HDF5 may not survive that.
  const auto fault = [&] { return fmt::format("'{}' is damaged: what it holds is no checkpoint", name); };
  if (!survives([&] { static_cast<void>(contentOf(path, size, false)); }))
    throw InputError(fault(), anew);
  try
  {
    return contentOf(path, size, true);
  }
  catch (const Error&)
  {
    throw InputError(fault(), anew);
  }
}

void expectScene(const Checkpoint& checkpoint, std::string_view kind, std::string_view scene, std::string_view name)
{
  if (checkpoint.kind != kind)
    throw InputError(fmt::format("'{}' is a checkpoint of {}, not of {}", name, checkpoint.kind, kind),
      "give a checkpoint of this run");
  if (checkpoint.scene == scene)
    return;
  const auto there = linesOf(checkpoint.scene);
  const auto here = linesOf(scene);
  std::string differences;
  int count = 0;
  const auto keyOf = [](std::string_view line) { return line.substr(0, line.find(": ")); };
  const auto valueIn = [&](const std::vector<std::string_view>& lines, std::string_view key)
  {
    const auto at = std::find_if(lines.begin(), lines.end(), [&](std::string_view l) { return keyOf(l) == key; });
    return at == lines.end() ? std::string("nothing") : std::string(at->substr(std::min(at->size(), key.size() + 2)));
  };
  std::vector<std::string_view> keys;
  for (const auto* lines : { &there, &here })
    for (const std::string_view line : *lines)
      if (std::find(keys.begin(), keys.end(), keyOf(line)) == keys.end())
        keys.push_back(keyOf(line));
  for (const std::string_view key : keys)
    if (const std::string then = valueIn(there, key), now = valueIn(here, key); then != now && ++count <= 3)
      differences += fmt::format("{}{}: {} there, {} here", count > 1 ? "; " : "", key, then, now);
  throw InputError(fmt::format("'{}' is a checkpoint of another scene: {}{}", name, differences,
                     count > 3 ? fmt::format("; and {} more", count - 3) : ""),
    "give the file, the values and the options of the run that wrote it");
}

} // namespace lamella::io
