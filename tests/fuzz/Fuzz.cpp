// Alters files of all kinds that Lamella reads, and looks whether reading one crashes, hangs, says a word that only
// programmers know, or goes well although the file contradicts itself.
//
//   fuzz corpus=FOLDER [inputs=N] [seconds=S] [seed=K] [only=.vti] [keep=FOLDER]
//   fuzz FILE...                     reads files that were kept once more, in this process
//
// Inputs are numbered, and a number and a seed give the same bytes anywhere. Processes read them, 500 each; one that
// ends tells by its last number which input it did not survive.
#include "Mutation.h"

#include "GridFile.h"
#include "convert/VtkFiles.h"
#include "reports/DataTable.h"
#include "reports/Plan.h"
#include "scenes/SceneFile.h"

#include "PackingTable.h"
#include "PhasePicture.h"

#include "io/Checkpoint.h"
#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "micrograph/PolygonFile.h"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLDataSetWriter.h>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <new>
#include <span>
#include <thread>

namespace
{

namespace fs = std::filesystem;
using namespace lamella;
using fuzz::Random;

std::string bytesOf(const fs::path& path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), {} };
}

void write(const fs::path& path, const std::string& bytes)
{
  std::ofstream(path, std::ios::binary | std::ios::trunc)
    .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Uses all that was read.
void touch(vtkFieldData* data)
{
  for (int i = 0; data != nullptr && i < data->GetNumberOfArrays(); ++i)
  {
    if (vtkDataArray* const array = data->GetArray(i))
    {
      static_cast<void>(array->GetRange(-1));
    }
  }
}

void touch(vtkDataObject* data)
{
  touch(data->GetFieldData());
  if (auto* const set = vtkDataSet::SafeDownCast(data))
  {
    touch(set->GetPointData());
    touch(set->GetCellData());
    for (vtkIdType cell = 0; vtkImageData::SafeDownCast(set) == nullptr && cell < set->GetNumberOfCells(); ++cell)
    {
      static_cast<void>(set->GetCell(cell)->GetBounds());
    }
  }
}

void readGrid(const fs::path& path)
{
  touch(cli::readGrid(path));
}

void readTable(const fs::path& path)
{
  const reports::DataTable table(path);
  for (std::size_t column = 0; column < table.names().size(); ++column)
  {
    static_cast<void>(table.isNumeric(column) ? table.numbers(column) : std::vector<double>());
  }
  static_cast<void>(readPackingTable(path));
}

void readHdf(const fs::path& path)
{
  cli::Step step = cli::openHdf(path);
  if (step.points != nullptr)
  {
    touch(step.points);
  }
  else if (step.volume != nullptr && step.volume->layers() < 1000)
  {
    touch(step.volume->read(step.volume->extent()[4], step.volume->extent()[5]));
  }
}

void readPicture(const fs::path& path)
{
  micrograph::ReadOptions options;
  options.keepColour = true;
  static_cast<void>(readGreys(path, options, ""));
}

struct Kind
{
  std::function<void(const fs::path&)> read;
  int share; ///< of the inputs
};

const std::map<std::string, Kind>& kinds()
{
  static const std::map<std::string, Kind> all{ { ".vti", { readGrid, 25 } }, { ".vtp", { readGrid, 20 } },
    { ".vtu", { readGrid, 8 } }, { ".png", { readPicture, 8 } }, { ".tif", { readPicture, 8 } },
    { ".json", { [](const fs::path& p) { static_cast<void>(micrograph::readPolygons(p)); }, 6 } },
    { ".gz", { [](const fs::path& p) { static_cast<void>(micrograph::readPolygons(p)); }, 2 } },
    { ".plan", { [](const fs::path& p) { static_cast<void>(reports::readPlan(p)); }, 4 } },
    { ".csv", { readTable, 8 } },
    { ".toml", { [](const fs::path& p) { static_cast<void>(cli::readSceneFile(p)); }, 8 } },
    { ".vtkhdf", { readHdf, 1 } },
    { ".h5", { [](const fs::path& p) { static_cast<void>(io::decode(io::readBytes(p), p.string())); }, 2 } } };
  return all;
}

/// A grid in all the ways in which VTK writes one.
void addForms(const fs::path& path, std::vector<std::string>& list)
{
  const auto data = cli::readGrid(path);
  for (const int mode : { vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended })
  {
    for (const bool packed : { false, true })
    {
      for (const bool base64 : { false, true })
      {
        if ((mode == vtkXMLWriter::Ascii && packed) || (mode != vtkXMLWriter::Appended && base64))
        {
          continue;
        }
        vtkNew<vtkXMLDataSetWriter> writer;
        writer->SetInputData(data);
        writer->SetDataMode(mode);
        writer->SetEncodeAppendedData(base64 ? 1 : 0);
        writer->SetCompressorType(packed ? vtkXMLWriter::ZLIB : vtkXMLWriter::NONE);
        writer->SetBlockSize(512);
        const fs::path file = path.string() + ".form";
        writer->SetFileName(file.c_str());
        writer->Write();
        list.push_back(bytesOf(file));
        fs::remove(file);
      }
    }
  }
}

struct Options
{
  std::uint64_t inputs = 20000;
  double seconds = 1e9;
  std::uint64_t seed = 1;
  std::string corpus, only, keep = ".";
};

class Corpus
{
public:
  explicit Corpus(const Options& options)
    : seed_(options.seed)
  {
    for (const auto& entry : fs::directory_iterator(options.corpus))
    {
      const std::string ending = entry.path().extension().string();
      constexpr std::uintmax_t most = 200000;
      if (!entry.is_regular_file() || !kinds().contains(ending) || (!options.only.empty() && options.only != ending) ||
        entry.file_size() > most)
      {
        continue;
      }
      auto& list = files_[ending];
      list.push_back(bytesOf(entry.path()));
      if (ending == ".vti" || ending == ".vtp" || ending == ".vtu")
      {
        addForms(entry.path(), list);
      }
    }
    for (auto& [ending, list] : files_)
    {
      std::ranges::sort(list); // not in the order of the folder
      shares_.insert(shares_.end(), static_cast<std::size_t>(kinds().at(ending).share), ending);
    }
  }

  struct Input
  {
    std::string ending, bytes;
    bool contradicts = false;
  };
  [[nodiscard]] Input input(std::uint64_t number) const
  {
    Random random(seed_ * 0x9e3779b97f4a7c15ULL + number);
    Input input;
    input.ending = shares_[random() % shares_.size()];
    const auto& list = files_.at(input.ending);
    const std::string& file = list[random() % list.size()];
    const bool xml = input.ending.starts_with(".vt") && input.ending.size() == 4;
    if (auto text = xml && random() % 4 == 0 ? fuzz::contradicting(file, random) : std::nullopt)
    {
      input.bytes = std::move(*text);
      input.contradicts = input.bytes != file;
    }
    else
    {
      input.bytes =
        input.ending == ".h5" && random() % 8 != 0 ? fuzz::mended(file, random) : fuzz::altered(file, list, random);
    }
    return input;
  }
  [[nodiscard]] std::string counts() const
  {
    std::string text;
    for (const auto& [ending, list] : files_)
    {
      text += fmt::format(" {} {}", list.size(), ending);
    }
    return text;
  }
  [[nodiscard]] bool empty() const { return shares_.empty(); }

private:
  std::uint64_t seed_;
  std::map<std::string, std::vector<std::string>> files_;
  std::vector<std::string> shares_;
};

/// What processes have in common.
struct Common
{
  std::atomic<std::uint64_t> at{ 0 }; ///< the input that is being read
  std::atomic<std::uint64_t> refused{ 0 };
  std::atomic<int> fault{ 0 };
  char what[400] = {};
};

/// @returns what is wrong with how it was read; empty: nothing
std::string faultOf(const std::string& ending, const fs::path& path, bool contradicts, bool& refused)
{
  try
  {
    kinds().at(ending).read(path);
    return contradicts ? "read in silence, though it contradicts itself" : "";
  }
  catch (const Error& error)
  {
    refused = true;
    return std::string_view(error.what()).empty() ? "refused without a word" : "";
  }
  catch (const std::bad_alloc&)
  {
    return "took all memory";
  }
  catch (const std::exception& error)
  {
    return fmt::format("no error of ours: {}", error.what());
  }
}

void readBatch(const Corpus& corpus, Common& common, const fs::path& folder, std::uint64_t first, std::uint64_t end)
{
  const cli::VtkMessages messages;
  for (std::uint64_t number = first; number < end; ++number)
  {
    common.at = number;
    const Corpus::Input input = corpus.input(number);
    const fs::path path = folder / ("input" + input.ending);
    write(path, input.bytes);
    bool refused = false;
    const std::string fault = faultOf(input.ending, path, input.contradicts, refused);
    static_cast<void>(cli::VtkMessages::takeErrors());
    static_cast<void>(cli::VtkMessages::takeWarnings());
    common.refused += refused ? 1 : 0;
    if (!fault.empty())
    {
      fault.copy(common.what, sizeof common.what - 1);
      common.fault = 1;
      ::_exit(3);
    }
  }
  ::_exit(0);
}

int fuzzAll(const Options& options)
{
  const cli::VtkMessages messages;
  const Corpus corpus(options);
  if (corpus.empty())
  {
    fmt::print(stderr, "error: no files to alter in '{}'\nhint: tests/fuzz/corpus.sh makes them\n", options.corpus);
    return 2;
  }
  fmt::print("files:{}\n", corpus.counts());
  void* const memory = ::mmap(nullptr, sizeof(Common), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto& common = *new (memory) Common;
  const fs::path folder = fs::temp_directory_path() / fmt::format("lamella-fuzz-{}", ::getpid());
  fs::create_directories(folder);
  const auto start = Clock::now();
  int faults = 0;
  std::uint64_t next = 0;
  constexpr std::uint64_t batch = 500;
  constexpr double longest = 30; // seconds for one input, on a busy machine
  while (next < options.inputs && secondsSince(start) < options.seconds && faults < 20)
  {
    const std::uint64_t end = std::min(next + batch, options.inputs);
    common.at = next;
    common.fault = 0;
    const pid_t child = ::fork();
    if (child == 0)
    {
      const struct rlimit noCore = {};
      ::setrlimit(RLIMIT_CORE, &noCore);
      readBatch(corpus, common, folder, next, end);
    }
    int status = 0;
    std::uint64_t seen = next;
    auto since = Clock::now();
    bool hung = false;
    while (::waitpid(child, &status, WNOHANG) == 0)
    {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (common.at != seen)
      {
        seen = common.at;
        since = Clock::now();
      }
      else if (!hung && secondsSince(since) > longest)
      {
        hung = true;
        ::kill(child, SIGKILL);
      }
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
    {
      next = end;
      continue;
    }
    next = common.at + 1;
    ++faults;
    const Corpus::Input input = corpus.input(common.at);
    const fs::path kept =
      fs::path(options.keep) / fmt::format("fuzz-{}-{}{}", options.seed, common.at.load(), input.ending);
    write(kept, input.bytes);
    fmt::print("{}: {}\n", kept.string(),
      hung                    ? fmt::format("not read within {} s", longest)
        : common.fault != 0   ? std::string(common.what)
        : WIFSIGNALED(status) ? fmt::format("ended by signal {}", WTERMSIG(status))
                              : fmt::format("ended with code {}", WEXITSTATUS(status)));
    std::fflush(stdout);
  }
  fs::remove_all(folder);
  fmt::print("{} inputs of seed {} in {:.0f} s, {} refused, {} faults\n", next, options.seed, secondsSince(start),
    common.refused.load(), faults);
  return faults == 0 ? 0 : 1;
}

int readAgain(std::span<char*> files)
{
  const cli::VtkMessages messages;
  int faults = 0;
  for (const std::string file : files)
  {
    bool refused = false;
    const std::string fault = faultOf(fs::path(file).extension().string(), file, false, refused);
    fmt::print("{}: {}\n", file, !fault.empty() ? fault : refused ? "refused" : "read");
    faults += fault.empty() ? 0 : 1;
  }
  return faults == 0 ? 0 : 1;
}

} // namespace

int main(int argc, char** argv)
{
  Options options;
  const std::span<char*> words(argv + 1, argv + argc);
  for (const std::string word : words)
  {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
    {
      return readAgain(words);
    }
    const std::string key = word.substr(0, equals);
    const std::string value = word.substr(equals + 1);
    if (key == "inputs" || key == "seed")
    {
      (key == "inputs" ? options.inputs : options.seed) = std::stoull(value);
    }
    else if (key == "seconds")
    {
      options.seconds = std::stod(value);
    }
    else if (key == "corpus" || key == "only" || key == "keep")
    {
      (key == "corpus" ? options.corpus : key == "only" ? options.only : options.keep) = value;
    }
    else
    {
      fmt::print(stderr, "error: no key '{}'\nhint: corpus, inputs, seconds, seed, only, keep\n", key);
      return 2;
    }
  }
  return fuzzAll(options);
}
