#pragma once

#include <cstdint>
#include <string>
#include <vector>

class vtkXMLDataElement;
class vtkXMLDataParser;

/// The bytes of single arrays in a VTK XML file, looked at before VTK reads them. Not installed.
///
/// VTK 9.2 believes what a file says of its arrays. It calls members of an array whose type it does not know, writes
/// texts beyond the end of an array that was said to have fewer, divides by the size of blocks, takes memory for
/// as many blocks as a header names, follows offsets to any place of the file, and gives what it did not find as memory
/// that nobody has written. So nothing of an array goes to VTK that has not exactly the values that it is said to have.
namespace lamella
{

/// What the head of an array says.
struct XmlArray
{
  std::string name;
  std::string type; ///< "Float64" and the like, "String"
  int bytes = 1;    ///< of a value; of a letter in texts
  int components = 1;
  [[nodiscard]] bool isText() const { return type == "String"; }
  [[nodiscard]] bool isWhole() const { return type.find("Int") != std::string::npos; }
};

/// Looks at the arrays of one file, whose XML has been parsed.
class XmlArrays
{
public:
  /// @param parser after Parse(), with the file's compressor, its stream open
  /// @param path for messages
  XmlArrays(vtkXMLDataParser* parser, std::string path);

  /// @throws InputError: no name, a type that there is not, components that are none
  [[nodiscard]] XmlArray head(vtkXMLDataElement* element) const;

  /// Refuses an array that has not exactly so many tuples: in text, in base64 or appended, compressed or not. Of
  /// compressed data the lengths are known from the head, what the blocks hold only when they are read.
  /// @throws InputError
  void requireTuples(vtkXMLDataElement* element, const XmlArray& head, std::int64_t tuples);

  /// Values of an array of whole numbers that requireTuples() has let through.
  [[nodiscard]] std::vector<std::int64_t> wholeNumbers(
    vtkXMLDataElement* element, const XmlArray& head, std::int64_t tuples);

  /// Refuses appended arrays that share a part of their bytes. After all requireTuples(). @throws InputError
  void requireApart();

private:
  struct Place
  {
    std::int64_t first = 0; ///< byte in the file
    std::int64_t end = 0;   ///< one behind the last that may belong to it
    bool base64 = false;
    bool appended = false;
  };
  struct Span
  {
    std::int64_t first = 0, end = 0;
    std::string name;
  };

  [[noreturn]] void damaged(const XmlArray& head, const std::string& what) const;
  [[nodiscard]] Place placeOf(vtkXMLDataElement* element, const XmlArray& head) const;
  [[nodiscard]] bool isText(vtkXMLDataElement* element) const;
  [[nodiscard]] std::uint64_t word(const std::vector<unsigned char>& bytes, std::size_t index) const;
  [[nodiscard]] std::vector<unsigned char> read(const Place& place, const XmlArray& head, std::uint64_t bytes) const;
  [[nodiscard]] std::int64_t endOf(
    const Place& place, std::int64_t first, std::uint64_t bytes, const XmlArray& head) const;
  [[nodiscard]] std::uint64_t countText(const Place& place, const XmlArray& head) const;
  [[nodiscard]] std::uint64_t bytesHeld(const Place& place, const XmlArray& head);
  void requireTexts(vtkXMLDataElement* element, const XmlArray& head, std::uint64_t letters, std::uint64_t texts);

  vtkXMLDataParser* parser_;
  std::string path_;
  std::int64_t size_ = 0;     ///< of the file
  std::int64_t appended_ = 0; ///< byte at which appended data begin; 0: there are none
  bool appendedRaw_ = false;
  std::size_t word_ = 4; ///< bytes of a number in the head of binary data
  bool swap_ = false;
  std::vector<Span> spans_;
};

} // namespace lamella
