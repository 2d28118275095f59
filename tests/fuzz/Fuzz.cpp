// Alters files of all kinds that Lamella reads, and looks whether reading one crashes, hangs, says a word that only
// programmers know, or goes well although the file contradicts itself: two of its numbers do not fit together, or it
// has another content than the one that its checksum is of.
//
//   fuzz corpus=FOLDER [inputs=N] [seconds=S] [seed=K] [first=N] [only=.vti] [keep=FOLDER]
//   fuzz FILE...                     reads files that were kept once more, in this process
//
// Inputs are numbered, and a number and a seed give the same bytes anywhere. Processes read them, 2000 each; one that
// ends tells by its last number which input it did not survive.
#include "Mutation.h"

#include "convert/Formats.h"
#include "convert/VtkFiles.h"
#include "files/GridFile.h"
#include "reports/DataTable.h"
#include "reports/Plan.h"
#include "scenes/SceneFile.h"

#include "PackingTable.h"
#include "PhasePicture.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "io/Checkpoint.h"
#include "io/Provenance.h"
#include "outlines/PolygonFile.h"

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
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
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
    if (vtkDataArray* const array = data->GetArray(i))
      static_cast<void>(array->GetRange(-1));
}

void touch(vtkDataObject* data)
{
  touch(data->GetFieldData());
  if (auto* const set = vtkDataSet::SafeDownCast(data))
  {
    touch(set->GetPointData());
    touch(set->GetCellData());
    for (vtkIdType cell = 0; vtkImageData::SafeDownCast(set) == nullptr && cell < set->GetNumberOfCells(); ++cell)
      static_cast<void>(set->GetCell(cell)->GetBounds());
  }
}

/// What reading a file came to.
struct Answer
{
  bool warned = false;
  std::string held{}; ///< a hash of what it holds, where the file has a checksum of that; else empty
};

Answer readGrid(const fs::path& path)
{
  touch(cli::readGrid(path));
  return {};
}

Answer readTable(const fs::path& path)
{
  const reports::DataTable table(path);
  for (std::size_t column = 0; column < table.names().size(); ++column)
    static_cast<void>(table.isNumeric(column) ? table.numbers(column) : std::vector<double>());
  static_cast<void>(readPackingTable(path));
  return {};
}

/// As `lamella convert` does: all of it.
Answer readStep(const fs::path& path)
{
  cli::Reading reading;
  cli::Step step = cli::formatOf("the file", path.string()).open(path.string(), reading);
  if (step.points != nullptr)
    touch(step.points);
  else if (step.volume != nullptr && step.volume->layers() < 1000)
    touch(step.volume->read(step.volume->extent()[4], step.volume->extent()[5]));
  return { .warned = !reading.warnings.empty() };
}

template <class Number>
void add(io::Sha256& hash, const std::vector<Number>& numbers)
{
  hash.update(std::as_bytes(std::span(numbers)));
}

Answer readPicture(const fs::path& path)
{
  micrograph::ReadOptions options;
  options.keepColour = true;
  const micrograph::Picture picture = readPictureFile(path, options).picture;
  Answer answer{ .warned = !picture.warnings.empty() };
  if (picture.format == "PNG")
  {
    io::Sha256 hash;
    hash.update(std::as_bytes(std::span(picture.fileSize)));
    add(hash, picture.grey);
    answer.held = hash.finish();
  }
  return answer;
}

/// As `convert` does, and as a sample.
Answer readVolume(const fs::path& path)
{
  Answer answer = readStep(path);
  answer.warned |= readPicture(path).warned;
  return answer;
}

Answer readPolygons(const fs::path& path)
{
  const micrograph::PolygonFile file = micrograph::readPolygons(path);
  Answer answer{ .warned = !file.warnings.empty() };
  if (path.extension() == ".gz")
  {
    io::Sha256 hash;
    for (const auto& contour : file.lumens.contours)
      add(hash, contour.points);
    answer.held = hash.finish();
  }
  return answer;
}

Answer readPlan(const fs::path& path)
{
  static_cast<void>(reports::readPlan(path));
  return {};
}

Answer readScene(const fs::path& path)
{
  static_cast<void>(cli::readSceneFile(path));
  return {};
}

Answer readCheckpoint(const fs::path& path)
{
  const io::Checkpoint checkpoint = io::readFile(path);
  io::Sha256 hash;
  for (const auto& [name, value] : checkpoint.numbers)
  {
    hash.update(std::as_bytes(std::span(name)));
    hash.update(std::as_bytes(std::span(&value, 1)));
  }
  for (const auto& [name, array] : checkpoint.arrays)
  {
    hash.update(std::as_bytes(std::span(name)));
    std::visit([&](const auto& values) { add(hash, values); }, array.values);
  }
  return { .held = hash.finish() };
}

struct Kind
{
  std::string ending;
  Answer (*read)(const fs::path&);
  int share; ///< of a thousand inputs: the costly ones less
};

const std::vector<Kind>& kinds()
{
  static const std::vector<Kind> all{ { ".vti", readGrid, 160 }, { ".vtp", readGrid, 130 }, { ".vtu", readGrid, 50 },
    { ".png", readPicture, 100 }, { ".tif", readPicture, 80 }, { ".json", readPolygons, 80 },
    { ".gz", readPolygons, 50 }, { ".plan", readPlan, 49 }, { ".csv", readTable, 30 }, { ".toml", readScene, 80 },
    { ".nrrd", readVolume, 40 }, { ".mha", readVolume, 40 }, { ".pgm", readVolume, 15 }, { ".ppm", readVolume, 10 },
    { ".bmp", readVolume, 15 }, { ".jpg", readVolume, 30 }, { ".mhd", readVolume, 15 }, { ".nhdr", readVolume, 15 },
    { ".npy", readVolume, 15 }, { ".nii", readVolume, 15 }, { ".vtk", readVolume, 15 }, { ".vtkhdf", readStep, 1 },
    { ".h5", readCheckpoint, 10 } };
  return all;
}

/// @returns its place in kinds(); their number for none
std::size_t kindOf(const std::string& ending)
{
  return static_cast<std::size_t>(std::ranges::find(kinds(), ending, &Kind::ending) - kinds().begin());
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
          continue;
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
  std::uint64_t first = 0;
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
      const std::size_t kind = kindOf(ending);
      constexpr std::uintmax_t most = 200000;
      if (!entry.is_regular_file() || kind == kinds().size() || (!options.only.empty() && options.only != ending) ||
        entry.file_size() > most)
        continue;
      auto& list = files_[kind];
      list.push_back(bytesOf(entry.path()));
      if (ending == ".vti" || ending == ".vtp" || ending == ".vtu")
        addForms(entry.path(), list);
    }
    for (auto& [kind, list] : files_)
    {
      std::ranges::sort(list); // not in the order of the folder
      shares_.insert(shares_.end(), static_cast<std::size_t>(kinds()[kind].share), kind);
    }
  }

  struct Input
  {
    std::size_t kind = 0;
    std::string bytes;
    bool contradicts = false;
    const std::string* original = nullptr; ///< of one that was altered anyhow
    [[nodiscard]] const std::string& ending() const { return kinds()[kind].ending; }
  };
  [[nodiscard]] Input input(std::uint64_t number) const
  {
    Random random(seed_ * 0x9e3779b97f4a7c15ULL + number);
    Input input;
    input.kind = shares_[random() % shares_.size()];
    const auto& list = files_.at(input.kind);
    const std::string& file = list[random() % list.size()];
    if (auto text = random() % 4 == 0 ? fuzz::contradicting(file, input.ending(), random) : std::nullopt)
    {
      input.bytes = std::move(*text);
      input.contradicts = input.bytes != file;
    }
    else if (input.ending() == ".h5" && random() % 4 == 0) // a process each
    {
      input.bytes = fuzz::mended(file, random);
    }
    else
    {
      input.bytes = fuzz::altered(file, list, random);
      input.original = &file;
    }
    return input;
  }
  [[nodiscard]] std::size_t files(std::size_t kind) const
  {
    const auto found = files_.find(kind);
    return found == files_.end() ? 0 : found->second.size();
  }
  [[nodiscard]] bool empty() const { return shares_.empty(); }

private:
  std::uint64_t seed_;
  std::map<std::size_t, std::vector<std::string>> files_; ///< by kind
  std::vector<std::size_t> shares_;
};

/// What processes have in common.
struct Common
{
  struct Count
  {
    std::atomic<std::uint64_t> inputs{ 0 }, contradict{ 0 }, refused{ 0 }, warned{ 0 }, microseconds{ 0 };
  };
  std::array<Count, 32> counts;       ///< by kind
  std::atomic<std::uint64_t> at{ 0 }; ///< the input that is being read
  std::atomic<int> fault{ 0 };
  char what[400] = {};
};

/// How an input was read. A fault: what is wrong with that; empty: nothing.
struct Outcome
{
  Answer answer{};
  bool refused = false;
  std::string fault{};
};

Outcome outcomeOf(const Kind& kind, const fs::path& path)
{
  Outcome outcome;
  try
  {
    outcome.answer = kind.read(path);
  }
  catch (const Error& error)
  {
    outcome.refused = true;
    outcome.fault = std::string_view(error.what()).empty() ? "refused without a word" : "";
  }
  catch (const std::bad_alloc&)
  {
    outcome.fault = "took all memory";
  }
  catch (const std::exception& error)
  {
    outcome.fault = fmt::format("no error of ours: {}", error.what());
  }
  static_cast<void>(cli::VtkMessages::takeErrors());
  outcome.answer.warned |= !cli::VtkMessages::takeWarnings().empty();
  return outcome;
}

/// Processor time of this process. [µs]
std::uint64_t timeUsed()
{
  struct rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto micro = [](const timeval& t)
  { return static_cast<std::uint64_t>(t.tv_sec) * 1000000 + static_cast<std::uint64_t>(t.tv_usec); };
  return micro(usage.ru_utime) + micro(usage.ru_stime);
}

/// Processor time that one input may take, a thousand times what the dear ones do. [s]
constexpr std::uint64_t longest = 10;

void readBatch(const Corpus& corpus, Common& common, const fs::path& folder, std::uint64_t first, std::uint64_t end)
{
  std::map<const std::string*, std::string> held; // of files that were not altered
  const auto outcome = [&](std::size_t kind, const std::string& bytes)
  {
    const fs::path path = folder / ("input" + kinds()[kind].ending);
    write(path, bytes);
    return outcomeOf(kinds()[kind], path);
  };
  std::uint64_t used = timeUsed();
  for (std::uint64_t number = first; number < end; ++number)
  {
    common.at = number;
    const struct rlimit limit = { used / 1000000 + longest, RLIM_INFINITY };
    ::setrlimit(RLIMIT_CPU, &limit);
    const Corpus::Input input = corpus.input(number);
    Outcome found = outcome(input.kind, input.bytes);
    const bool silent = found.fault.empty() && !found.refused && !found.answer.warned;
    if (silent && input.contradicts)
    {
      found.fault = "read in silence, though it contradicts itself";
    }
    else if (silent && input.original != nullptr && !found.answer.held.empty())
    {
      const auto [known, isNew] = held.try_emplace(input.original);
      if (isNew)
        known->second = outcome(input.kind, *input.original).answer.held;
      if (known->second != found.answer.held)
        found.fault = "read in silence, though its checksum is not that of what it holds";
    }
    auto& count = common.counts[input.kind];
    ++count.inputs;
    count.contradict += input.contradicts ? 1 : 0;
    count.refused += found.refused ? 1 : 0;
    count.warned += !found.refused && found.answer.warned ? 1 : 0;
    const std::uint64_t now = timeUsed();
    count.microseconds += now - used;
    used = now;
    if (!found.fault.empty())
    {
      found.fault.copy(common.what, sizeof common.what - 1);
      common.fault = 1;
      ::_exit(3);
    }
  }
  ::_exit(0);
}

void print(const Corpus& corpus, const Common& common)
{
  fmt::print("| kind | files | inputs | that contradict themselves | refused | read with a warning | processor time an "
             "input [ms] |\n|---|---|---|---|---|---|---|\n");
  std::uint64_t all = 0, contradict = 0, refused = 0, warned = 0, time = 0;
  std::size_t files = 0;
  const auto line = [](const std::string& name, std::size_t of, std::uint64_t n, std::uint64_t c, std::uint64_t r,
                      std::uint64_t w, std::uint64_t t)
  {
    fmt::print("| {} | {} | {} | {} | {} | {} | {:.2f} |\n", name, of, n, c, r, w,
      static_cast<double>(t) / 1000 / static_cast<double>(std::max<std::uint64_t>(n, 1)));
  };
  for (std::size_t kind = 0; kind < kinds().size(); ++kind)
  {
    const auto& count = common.counts[kind];
    if (count.inputs > 0)
    {
      line("`" + kinds()[kind].ending + "`", corpus.files(kind), count.inputs, count.contradict, count.refused,
        count.warned, count.microseconds);
    }
    files += corpus.files(kind);
    all += count.inputs;
    contradict += count.contradict;
    refused += count.refused;
    warned += count.warned;
    time += count.microseconds;
  }
  line("all", files, all, contradict, refused, warned, time);
}

/// Files that headers in other ones speak of.
void copyValues(const fs::path& corpus, const fs::path& folder)
{
  for (const auto& entry : fs::directory_iterator(corpus))
    if (entry.path().extension() == ".raw")
      fs::copy_file(entry.path(), folder / entry.path().filename(), fs::copy_options::overwrite_existing);
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
  void* const memory = ::mmap(nullptr, sizeof(Common), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto& common = *new (memory) Common;
  const fs::path shared = "/dev/shm"; // files in memory: no disk is written a million times
  const fs::path folder = (::access(shared.c_str(), W_OK) == 0 ? shared : fs::temp_directory_path()) /
    fmt::format("lamella-fuzz-{}", ::getpid());
  fs::create_directories(folder);
  copyValues(options.corpus, folder);
  const auto start = Clock::now();
  int faults = 0;
  std::uint64_t next = options.first;
  const std::uint64_t last = options.first + options.inputs;
  constexpr std::uint64_t batch = 2000;
  constexpr double asleep = 300; // seconds; far more than `longest` takes on a busy machine
  while (next < last && secondsSince(start) < options.seconds && faults < 20)
  {
    const std::uint64_t end = std::min(next + batch, last);
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
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (common.at != seen)
      {
        seen = common.at;
        since = Clock::now();
      }
      else if (!hung && secondsSince(since) > asleep)
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
      fs::path(options.keep) / fmt::format("fuzz-{}-{}{}", options.seed, common.at.load(), input.ending());
    write(kept, input.bytes);
    copyValues(options.corpus, options.keep);
    fmt::print("{}: {}\n", kept.string(),
      hung                            ? fmt::format("sleeps for {} s", asleep)
        : common.fault != 0           ? std::string(common.what)
        : !WIFSIGNALED(status)        ? fmt::format("ended with code {}", WEXITSTATUS(status))
        : WTERMSIG(status) == SIGXCPU ? fmt::format("takes more than {} s of processor time", longest)
                                      : fmt::format("ended by signal {}", WTERMSIG(status)));
    std::fflush(stdout);
  }
  fs::remove_all(folder);
  print(corpus, common);
  fmt::print(
    "{} inputs of seed {} in {:.0f} s, {} faults\n", next - options.first, options.seed, secondsSince(start), faults);
  return faults == 0 ? 0 : 1;
}

int readAgain(std::span<char*> files)
{
  const cli::VtkMessages messages;
  int faults = 0;
  for (const std::string file : files)
  {
    const std::size_t kind = kindOf(fs::path(file).extension().string());
    if (kind == kinds().size())
    {
      fmt::print(stderr, "error: '{}' is of no kind that is altered here\nhint: a file that was kept\n", file);
      return 2;
    }
    const Outcome outcome = outcomeOf(kinds()[kind], file);
    fmt::print("{}: {}\n", file, !outcome.fault.empty() ? outcome.fault : outcome.refused ? "refused" : "read");
    faults += outcome.fault.empty() ? 0 : 1;
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
      return readAgain(words);
    const std::string key = word.substr(0, equals);
    const std::string value = word.substr(equals + 1);
    if (key == "inputs" || key == "seed" || key == "first")
    {
      (key == "inputs" ? options.inputs : key == "seed" ? options.seed : options.first) = std::stoull(value);
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
      fmt::print(stderr, "error: no key '{}'\nhint: corpus, inputs, seconds, seed, first, only, keep\n", key);
      return 2;
    }
  }
  return fuzzAll(options);
}
