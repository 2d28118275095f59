#include "program/StandardStreams.h"

#include "session/OutputFile.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lamella::cli
{

namespace
{

using namespace std::string_view_literals;

/// Waits for the next bytes; none at the end. @throws InputError; Cancelled
std::string_view nextBytes(std::string& block)
{
  for (;;)
  {
    pollfd wait{ STDIN_FILENO, POLLIN, 0 }; // unlike read(), it ends with a signal
    const bool there = ::poll(&wait, 1, -1) > 0;
    Session::checkInterrupt();
    const ssize_t count = there ? ::read(STDIN_FILENO, block.data(), block.size()) : -1;
    if (count >= 0)
      return { block.data(), static_cast<std::size_t>(count) };
    if (errno != EINTR && errno != EAGAIN)
      throw InputError(std::string("cannot read standard input: ") + std::strerror(errno), "read a file instead");
  }
}

/// What a file that begins so is called by its readers; empty where nobody knows.
std::string endingOfBytes(std::string_view bytes)
{
  constexpr std::array<std::pair<std::string_view, const char*>, 22> beginnings{ { { "\x89PNG", ".png" },
    { "\xff\xd8\xff", ".jpg" }, { "II*\0"sv, ".tif" }, { "II+\0"sv, ".tif" }, { "MM\0*"sv, ".tif" },
    { "MM\0+"sv, ".tif" }, { "BM", ".bmp" }, { "P2", ".pgm" }, { "P3", ".ppm" }, { "P5", ".pgm" }, { "P6", ".ppm" },
    { "\x93NUMPY", ".npy" }, { "NRRD", ".nrrd" }, { "ObjectType", ".mha" }, { "NDims", ".mha" },
    { "# vtk DataFile", ".vtk" }, { "\x89HDF", ".hdf" }, { "\x1f\x8b", ".nii.gz" }, { "\x5c\x01\0\0"sv, ".nii" },
    { "\x1c\x02\0\0"sv, ".nii" }, { "{", ".json" }, { "[", ".json" } } };
  for (const auto& [beginning, ending] : beginnings)
    if (bytes.starts_with(beginning))
      return ending;
  const std::string_view head = bytes.substr(0, 1024);
  for (const auto& [word, ending] : { std::pair{ "\"ImageData\"", ".vti" }, std::pair{ "\"PolyData\"", ".vtp" },
         std::pair{ "\"UnstructuredGrid\"", ".vtu" } })
    if (head.find("<VTKFile") != std::string_view::npos && head.find(word) != std::string_view::npos)
      return ending;
  const bool text =
    std::ranges::none_of(head, [](char c) { return c >= 0 && c < ' ' && c != '\n' && c != '\r' && c != '\t'; });
  return text && head.find(',') != std::string_view::npos && head[0] != '<' ? ".csv" : "";
}

/// All of standard input as a file. @param ending that it has whatever its bytes are; empty: they tell
PartFile readInput(std::string ending)
{
  if (::isatty(STDIN_FILENO) == 1)
  {
    throw InputError("'-' is standard input, and that is a terminal",
      "send a sample into it: lamella generate ... -o - | lamella ... -");
  }
  std::string block(std::size_t{ 1 } << 20, '\0');
  std::string head;
  for (std::string_view bytes = nextBytes(block); !bytes.empty(); bytes = nextBytes(block))
  {
    head += bytes;
    if (head.size() >= 1024)
      break;
  }
  if (head.empty())
    throw InputError("'-' is standard input, and nothing came from it", "see what the program before it says");
  if (ending.empty())
    ending = endingOfBytes(head);
  if (ending.empty())
  {
    throw InputError("what comes from standard input is of no format that its first bytes tell",
      "store it as a file whose name ends as the format wants it; a raw volume needs --raw-size");
  }
  PartFile part(OutputFile::temporaryFolder() / ("-" + ending));
  std::ofstream file(part.path(), std::ios::binary | std::ios::trunc);
  file << head;
  for (std::string_view bytes = nextBytes(block); file && !bytes.empty(); bytes = nextBytes(block))
    file << bytes;
  file.close();
  if (part.error() != 0 || !file)
  {
    throw OutputError(
      fmt::format("cannot keep what comes from standard input in '{}': {}", OutputFile::temporaryFolder().string(),
        std::strerror(part.error() != 0 ? part.error() : errno)),
      "set TMPDIR to a folder with room");
  }
  return part;
}

/// The ending of what an option writes: that of its value's name, or the first that its text names.
std::string usualEnding(const CLI::Option* option)
{
  const std::string text = option->get_type_name() + " " + option->get_description();
  std::smatch found;
  return std::regex_search(text, found, std::regex(R"(\.[a-z]{3,4}\b)")) ? found.str() : "";
}

bool isFile(const CLI::Option* option)
{
  return option->get_positional() || option->get_type_name().starts_with("FILE") ||
    option->get_type_name().starts_with("FOLDER");
}

void setValues(CLI::Option* option, const std::vector<std::string>& values)
{
  option->clear();
  for (const std::string& value : values)
    option->add_result(value);
  option->run_callback();
}

} // namespace

StandardStreams::StandardStreams(Session& session, CLI::App& command)
{
  OutputFile::allowStandardOutput();
  CLI::Option* input = nullptr;
  std::string output;
  for (CLI::Option* const option : command.get_options(isFile))
  {
    const std::string name = option->get_positional() ? option->get_name(true)
      : option->get_snames().empty()                  ? "--" + option->get_lnames().front()
                                                      : "-" + option->get_snames().front();
    std::vector<std::string> values = option->results();
    for (std::string& value : values)
    {
      const bool written = option->get_group() == "Output";
      if (value != "-" && !(written && OutputFile::isStandardOutput(value)))
        continue;
      const std::string ending = written ? usualEnding(option) : "";
      if (written ? ending.empty() : name != "FILE" || input != nullptr)
      {
        throw ParameterError(name + " '-': standard input can stand for FILE, and standard output for what is written",
          "give the name of a file");
      }
      if (written && !output.empty())
      {
        throw ParameterError(fmt::format("{} and {} are both to be written to standard output", output, name),
          "give one of them the name of a file");
      }
      if (value == "-")
        value += ending;
      if (written)
        output = name;
      else
        input = option;
    }
    if (option->count() > 0 && option->results() != values)
      setValues(option, values);
  }
  const CLI::Option* const json = command.get_option_no_throw("--json");
  if (!output.empty() && json != nullptr && json->count() > 0)
    throw ParameterError(fmt::format("--json and {} both write to standard output", output),
      fmt::format("give {} the name of a file, or leave --json out", output));
  if (input == nullptr)
    return;
  const CLI::Option* const raw = command.get_option_no_throw("--raw-size");
  std::array<char, 4096> path{};
  session.onRoot(
    [&]
    {
      input_ = readInput(raw != nullptr && raw->count() > 0 ? ".raw" : "");
      input_->path().string().copy(path.data(), path.size() - 1);
    });
  session.broadcast(path);
  Session::callInput(path.data());
  setValues(input, { path.data() });
}

} // namespace lamella::cli
