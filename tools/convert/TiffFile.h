#pragma once

#include "convert/Volume.h"
#include "session/OutputFile.h"

#include <string>

namespace lamella::micrograph
{
struct TiffPage;
}

/// Volumes as TIFF files (pictures/TiffFile.h).
namespace lamella::cli
{

/// VTK's type of the values of a page that is plain().
[[nodiscard]] int typeOf(const micrograph::TiffPage& page);

/// Can TIFF hold values of this type, and so many a pixel?
[[nodiscard]] bool tiffHolds(int type, int components);

/// Writes a picture, or a volume with a page a layer; packed without loss, BigTIFF where it may pass 4 GiB.
/// @throws OutputError; Cancelled
void writeTiff(Session& session, Volume& volume, const OutputFile& file, const std::string& notes);

} // namespace lamella::cli
