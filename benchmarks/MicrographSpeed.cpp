// From a scan to a lattice in one run on one core: reading, segmenting, outlines, the lattice, wall directions and the
// middle lamella of about 3 Mpixel, each part's user CPU, medians of several turns.
#include "Timing.h"

#include "core/Clock.h"
#include "generators/Generators.h"
#include "generators/MicrographLook.h"
#include "outlines/ContourExtraction.h"
#include "outlines/ContourLattice.h"
#include "outlines/MiddleLamella.h"
#include "outlines/WallDirection.h"
#include "pictures/Picture.h"
#include "pictures/WritePicture.h"
#include "segmentation/Segmentation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <sched.h>
#include <unistd.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::micrograph;

constexpr double megapixels = 3;

double cpu() // of all threads, user and system
{
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Threads that libraries start share this one core.
void stayOnOneCore()
{
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(std::max(0, sched_getcpu()), &one);
  if (sched_setaffinity(0, sizeof one, &one) != 0)
    fmt::print("(not held to one core)\n");
}

/// The picture beside its mirror image, and so on until there are enough pixels.
Picture tiled(const Picture& picture)
{
  const std::int64_t nx = picture.lattice.size[0];
  const std::int64_t ny = picture.lattice.size[1];
  const auto width = std::max(nx, static_cast<std::int64_t>(megapixels * 1e6 / static_cast<double>(ny)));
  Picture large = picture;
  large.lattice = makeLattice(width, ny, 1, 2, picture.lattice.spacing);
  large.fileSize = large.lattice.size;
  large.grey.clear();
  large.colour.clear();
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < width; ++x)
    {
      const std::int64_t from = x % (2 * nx) < nx ? x % nx : nx - 1 - x % nx;
      const auto node = static_cast<std::size_t>(from + nx * y);
      large.grey.push_back(picture.grey[node]);
      if (!picture.colour.empty())
        large.colour.insert(large.colour.end(), &picture.colour[3 * node], &picture.colour[3 * node] + 3);
    }
  }
  return large;
}

Picture generated()
{
  generators::SoftwoodOptions o;
  o.size = { 4096, 3072, 1 };
  o.spacing = 0.25e-6;
  return generators::makeLook(generators::softwood(o), 2);
}

/// Seconds of one turn, by part.
struct Turn
{
  std::map<std::string, double> cpu;
  double wall = 0;
};

const std::vector<std::string> parts{ "read", "segment", "outlines", "lattice", "directions", "lamella" };
const std::string links = "with cut links"; ///< the lattice again, as the diffusion solver has it

void measure(const std::string& name, const Picture& picture, int turns)
{
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("micrograph-speed-{}", getpid());
  std::filesystem::create_directories(folder);
  const auto file = folder / "scan.png";
  writePicture(picture, file);
  std::vector<Turn> all;
  std::string what;
  for (int i = 0; i < turns; ++i)
  {
    Turn turn;
    const auto begin = Clock::now();
    const auto timed = [&](const char* part, const auto& action)
    {
      const double start = cpu();
      auto result = action();
      turn.cpu[part] = cpu() - start;
      return result;
    };
    const Picture scan = timed(
      "read",
      [&]
      {
        ReadOptions read;
        read.pixelSize = picture.lattice.spacing;
        read.keepColour = true;
        return readPicture(file, read);
      });
    const Segmentation phases = timed(
      "segment", [&] { return segment(scan); });
    const Extraction found = timed("outlines", [&] { return extractContours(phases.image, 0); });
    ContourLatticeOptions options;
    options.spacing = scan.lattice.spacing;
    options.lines = 0;
    const ContourLattice lattice = timed("lattice", [&] { return contourLattice(found.contours, options); });
    turn.wall = secondsSince(begin);
    const WallDirections directions = timed(
      "directions", [&] { return wallDirections(found.contours, lattice); });
    const MiddleLamella lamella = timed("lamella", [&] { return middleLamella(lattice, directions); });
    (void)timed(links.c_str(),
      [&]
      {
        options.lines = 4;
        return contourLattice(found.contours, options);
      });
    const auto wall = std::count(lattice.image.phase.begin(), lattice.image.phase.end(), std::uint8_t{ 1 });
    what = fmt::format("{} x {} = {:.2f} Mpixel, {} lumens, {:.0f} % wall, {} pieces of outline, lamella {:.1f} nodes "
                       "across, touching {} of {} cells",
      scan.lattice.size[0], scan.lattice.size[1], 1e-6 * static_cast<double>(scan.lattice.count()), found.report.lumens,
      100 * static_cast<double>(wall) / static_cast<double>(scan.lattice.count()), found.report.points,
      lamella.across.mean, lamella.cellsTouched, lamella.cells);
    all.push_back(turn);
  }
  std::filesystem::remove_all(folder);

  const auto median = [&](const auto& value)
  {
    std::vector<double> values;
    for (const Turn& turn : all)
      values.push_back(value(turn));
    return lamella::median(values);
  };
  const auto upTo = [&](std::size_t count)
  {
    return median(
      [&](const Turn& turn)
      {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i)
        {
          sum += turn.cpu.at(parts[i]);
        }
        return sum;
      });
  };
  fmt::print("{}: {}\n  CPU seconds on one core, medians of {}:", name, what, turns);
  for (const std::string& part : parts)
    fmt::print("  {} {:.2f}", part, median([&](const Turn& turn) { return turn.cpu.at(part); }));
  fmt::print("  (lattice {} {:.2f})", links, median([](const Turn& turn) { return turn.cpu.at(links); }));
  fmt::print(
    "\n  from the file to the lattice {:.2f} ({:.2f} on the clock), with directions {:.2f}, with directions and "
    "lamella {:.2f}\n",
    upTo(4), median([](const Turn& turn) { return turn.wall; }), upTo(5), upTo(6));
  std::fflush(stdout);
}

} // namespace

// micrograph-speed [turns [picture pixel-size-in-metres]]; pictures are put beside their mirror images up to 3 Mpixel
int main(int argc, char** argv)
{
  return told(
    [&]
    {
      stayOnOneCore();
      const int turns = argc > 1 ? std::max(1, static_cast<int>(std::strtol(argv[1], nullptr, 10))) : 7;
      ReadOptions read;
      read.keepColour = true;
      if (argc > 3)
      {
        read.pixelSize = std::strtod(argv[3], nullptr);
        measure(std::filesystem::path(argv[2]).filename(), tiled(readPicture(argv[2], read)), turns);
        return;
      }
      measure("generated softwood", generated(), turns);
      if (const char* const folder = std::getenv("LAMELLA_REAL_DATA"))
      {
        read.pixelSize = 1e-6 / 2.2675;
        const char* const name = "conifer_roxas_scan.jpg";
        measure(name, tiled(readPicture(std::filesystem::path(folder) / name, read)), turns);
      }
    });
}
