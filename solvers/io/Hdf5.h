#pragma once

#include "core/Error.h"

#define H5_USE_110_API // what later versions of HDF5 call as 1.10 does
#include <hdf5.h>

#include <algorithm>
#include <string>
#include <utility>

/// HDF5 by C++: identifiers that close, errors that are thrown. Not installed.
namespace lamella::io::hdf5
{

/// An HDF5 identifier, closed in the end.
class Handle
{
public:
  Handle(hid_t id, herr_t (*close)(hid_t))
    : id_(id)
    , close_(close)
  {
    if (id < 0)
      throw Error(
        "HDF5 cannot make or read a part of the file", "look whether the file is whole and the disk has room");
  }
  ~Handle()
  {
    if (id_ >= 0)
      close_(id_);
  }
  Handle(Handle&& other) noexcept
    : id_(std::exchange(other.id_, -1))
    , close_(other.close_)
  {
  }
  Handle& operator=(Handle&& other) noexcept
  {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  operator hid_t() const noexcept { return id_; } // NOLINT(google-explicit-constructor): as HDF5 takes it

  /// Closes it now. @returns whether that went well: what was written is in the file only then
  [[nodiscard]] bool finish() { return close_(std::exchange(id_, -1)) >= 0; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// HDF5 says nothing by itself meanwhile: its errors become ours.
class Quiet
{
public:
  Quiet()
  {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// @throws Error
inline void good(herr_t status)
{
  if (status < 0)
    throw Error("HDF5 fails on a part of the file", "look whether the file is whole and the disk has room");
}

[[nodiscard]] inline Handle textType(std::size_t length)
{
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  good(H5Tset_size(type, std::max<std::size_t>(1, length)));
  good(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

/// A text as an attribute.
inline void writeText(hid_t at, const char* name, const std::string& text)
{
  const Handle type = textType(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  good(H5Awrite(attribute, type, text.c_str()));
}

/// One text of fixed length, which is what we write: HDF5 writes all that a file has of it, and where a text has any
/// length, addresses.
inline void requireOneText(hid_t type, hid_t space)
{
  constexpr std::size_t longest = std::size_t{ 1 } << 28;
  good(H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && H5Tget_size(type) <= longest &&
        H5Sget_simple_extent_npoints(space) == 1
      ? 0
      : -1);
}

[[nodiscard]] inline std::string readText(hid_t at, const char* name)
{
  const Handle attribute(H5Aopen(at, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  requireOneText(type, Handle(H5Aget_space(attribute), H5Sclose));
  std::string text(H5Tget_size(type), '\0');
  good(H5Aread(attribute, type, text.data()));
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

/// Numbers of an attribute that has so many, whatever they are stored as. @param type as in memory
inline void readNumbers(hid_t attribute, hid_t type, std::size_t count, void* to)
{
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const H5T_class_t kind = H5Tget_class(stored);
  good((kind == H5T_INTEGER || kind == H5T_FLOAT) && H5Sget_simple_extent_npoints(space) == static_cast<hssize_t>(count)
      ? 0
      : -1);
  good(H5Aread(attribute, type, to));
}

/// Numbers of a dataset: whole or real ones, of which something is stored. @returns how many values there are
[[nodiscard]] inline std::size_t countStored(hid_t set)
{
  const Handle type(H5Dget_type(set), H5Tclose);
  const Handle space(H5Dget_space(set), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  constexpr hssize_t most = hssize_t{ 1 } << 48;
  const H5T_class_t kind = H5Tget_class(type);
  good(count >= 0 && count <= most && (kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_STRING) &&
        (count == 0 || H5Dget_storage_size(set) > 0)
      ? 0
      : -1);
  return static_cast<std::size_t>(count);
}

} // namespace lamella::io::hdf5
