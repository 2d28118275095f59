#pragma once

#include <string>

class vtkXMLDataParser;

namespace lamella
{

/// Refuses a VTK XML file that VTK's reader would not survive, or that says one thing in one place and another
/// elsewhere: sizes that its bytes cannot hold, an extent that is none, pieces that leave gaps or have different
/// arrays, an array that has not the values that it is said to have (XmlArrays.h), cells that begin and end where
/// there are none. Takes the time of reading what is written as text, base64 or cells once; of the rest, and of what is
/// compressed, only heads are looked at.
/// @param parser after Parse(), its stream open; it gets the file's compressor
/// @param kind "ImageData", "PolyData" or "UnstructuredGrid"
/// @throws InputError, MemoryError
void requireSoundXml(vtkXMLDataParser* parser, const std::string& kind, const std::string& path);

} // namespace lamella
