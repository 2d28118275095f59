#pragma once

#include "vtkXMLDataParser.h"

#include <exception>
#include <string>

class vtkDataCompressor;

/// Reads the XML of .vti, .vtp and .vtu files for the readers of GridReaders.h, and looks at all of it before they do
/// (XmlChecks.h): to them a file in which something is wrong cannot be parsed, and Fault says why. Not installed.
///
/// Of the keys at arrays, which VTK makes anything of that is named there, it hands on units and descriptions
/// (vtkLatticeConversion.h); the ranges are made anew when they are needed. The text of arrays is not kept in memory.
class GridParser : public vtkXMLDataParser
{
public:
  static GridParser* New();
  vtkTypeMacro(GridParser, vtkXMLDataParser);

  int Parse() override;
  void SetCompressor(vtkDataCompressor* compressor) override;
  void CharacterDataHandler(const char* data, int length) override;

  std::string Kind;         ///< "ImageData" and the like
  std::string Path;         ///< for messages
  std::exception_ptr Fault; ///< an Error; none after Parse() that went well
  bool Failed = false;      ///< it, or what unpacks for it, has told of a fault since Parse(); nothing is printed

protected:
  GridParser();
  int ParseXML() override;
  int ParseBuffer(const char* buffer, unsigned int count) override;
};
