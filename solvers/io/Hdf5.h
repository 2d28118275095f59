#pragma once

#include "lattice/Error.h"

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

[[nodiscard]] inline std::string readText(hid_t at, const char* name)
{
  const Handle attribute(H5Aopen(at, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  good(H5Aread(attribute, type, text.data()));
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

} // namespace lamella::io::hdf5
