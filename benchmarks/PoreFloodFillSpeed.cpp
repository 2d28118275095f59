// Pores: labels, sizes, boxes and centres of all of them, one thread, user CPU, medians of several runs in one process;
// beside OpenCV's connectedComponentsWithStats on one thread, which gives the same four things, on the same pictures
// into memory that is there already. Volumes: voxels a second. And VTK's own way: Debian's ParaView has no
// vtkImageConnectivityFilter (module ImagingMorphological), so vtkThreshold and vtkConnectivityFilter, as one does it
// there, on cells that hang together over corners.
#include "Timing.h"

#include "generators/Generators.h"
#include "pores/PoreLabelling.h"

#include <vtkCellData.h>
#include <vtkConnectivityFilter.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkThreshold.h>
#include <vtkUnsignedCharArray.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

constexpr unsigned seed = 1;

/// Median of the runs' user CPU seconds.
template <typename Action>
double timed(int runs, const Action& action)
{
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i)
  {
    const double start = userSeconds();
    action();
    seconds.push_back(userSeconds() - start);
  }
  return median(seconds);
}

struct Sample
{
  std::string name;
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< 0: void
};

double porosityOf(const Sample& sample)
{
  return static_cast<double>(std::count(sample.phase.begin(), sample.phase.end(), 0)) /
    static_cast<double>(sample.phase.size());
}

Sample noise(std::int64_t n, int dimension, double porosity)
{
  Sample sample{ fmt::format("random noise, porosity {:.3g}", porosity),
    makeLattice(n, n, dimension == 3 ? n : 1, dimension, 1), {} };
  sample.phase.resize(static_cast<std::size_t>(sample.lattice.count()));
  std::mt19937_64 engine(seed);
  const auto limit = static_cast<std::uint64_t>(porosity * 18446744073709551615.0);
  for (std::uint8_t& node : sample.phase)
    node = engine() < limit ? 0 : 1;
  return sample;
}

Sample softwood(std::int64_t n)
{
  generators::SoftwoodOptions o;
  o.size = { n, n, 1 };
  o.seed = seed;
  PhaseImage image = generators::softwood(o);
  return { "generated softwood", image.lattice, std::move(image.phase) };
}

/// Disks or balls of random places and radii, which overlap, until they cover the share.
Sample balls(std::int64_t n, int dimension, double share, double least, double most)
{
  Sample sample{ fmt::format("{} of radius {:g} to {:g}", dimension == 3 ? "balls" : "disks", least, most),
    makeLattice(n, n, dimension == 3 ? n : 1, dimension, 1), {} };
  const Lattice& l = sample.lattice;
  sample.phase.assign(static_cast<std::size_t>(l.count()), 1);
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11U) / 9007199254740992.0; };
  std::int64_t covered = 0;
  while (static_cast<double>(covered) < share * static_cast<double>(l.count()))
  {
    const double radius = least + (most - least) * uniform();
    const std::array<double, 3> centre{ uniform() * static_cast<double>(n), uniform() * static_cast<double>(n),
      dimension == 3 ? uniform() * static_cast<double>(n) : 0 };
    const auto span = [&](std::size_t axis)
    {
      const std::int64_t top = l.size[axis] - 1;
      return std::array{ std::clamp<std::int64_t>(std::llround(centre[axis] - radius), 0, top),
        std::clamp<std::int64_t>(std::llround(centre[axis] + radius), 0, top) };
    };
    const auto [z0, z1] = span(2);
    const auto [y0, y1] = span(1);
    const auto [x0, x1] = span(0);
    for (std::int64_t z = z0; z <= z1; ++z)
      for (std::int64_t y = y0; y <= y1; ++y)
        for (std::int64_t x = x0; x <= x1; ++x)
          if (std::hypot(static_cast<double>(x) - centre[0], static_cast<double>(y) - centre[1],
                static_cast<double>(z) - centre[2]) <= radius)
          {
            std::uint8_t& node = sample.phase[static_cast<std::size_t>(l.index(x, y, z))];
            covered += node;
            node = 0;
          }
  }
  return sample;
}

struct Ours
{
  double seconds = 0;
  std::int64_t count = 0;
  std::int64_t largest = 0;
};

Ours label(const Sample& sample, int connectivity, int runs, std::vector<std::int32_t>& labels)
{
  pores::LabelOptions options;
  options.connectivity = connectivity;
  Ours ours;
  labels.resize(sample.phase.size());
  ours.seconds = timed(runs,
    [&]
    {
      const pores::PoreLabelling labelling(sample.lattice, Communicator(), sample.phase, 0, options);
      labelling.labels(labels);
      ours.count = labelling.summary().count;
      ours.largest = labelling.summary().largest;
    });
  return ours;
}

void pictures(std::int64_t n, int runs)
{
  std::vector<Sample> samples{ softwood(n), balls(n, 2, 0.3, 5, 40) };
  for (const double porosity : { 0.05, 0.2, 0.4, 0.5, 0.6, 0.8, 0.95 })
    samples.push_back(noise(n, 2, porosity));
  fmt::print("pictures of {} x {}, ms of user CPU, medians of {}\n", n, n, runs);
  fmt::print("{:<30} {:>8} {:>4} {:>9} {:>9} {:>9} {:>7}\n", "picture", "porosity", "way", "pores", "lamella", "OpenCV",
    "ratio");
  std::vector<std::int32_t> labels;
  cv::setNumThreads(1);
  for (const Sample& sample : samples)
  {
    const int side = static_cast<int>(n);
    cv::Mat white(side, side, CV_8U);
    for (std::int64_t i = 0; i < n * n; ++i)
      white.data[i] = sample.phase[static_cast<std::size_t>(i)] == 0 ? 255 : 0;
    cv::Mat found(side, side, CV_32S);
    cv::Mat stats;
    cv::Mat centroids;
    for (const int connectivity : { 4, 8 })
    {
      const Ours ours = label(sample, connectivity, runs, labels);
      int count = 0;
      const double theirs = timed(
        runs, [&] { count = cv::connectedComponentsWithStats(white, found, stats, centroids, connectivity, CV_32S); });
      fmt::print("{:<30} {:>8.3f} {:>4} {:>9} {:>9.1f} {:>9.1f} {:>7.2f}{}\n", sample.name, porosityOf(sample),
        connectivity, ours.count, 1e3 * ours.seconds, 1e3 * theirs, theirs / ours.seconds,
        count - 1 == ours.count ? "" : fmt::format("  DIFFERENT: OpenCV counts {}", count - 1));
      std::fflush(stdout);
    }
  }
}

void volumes(std::int64_t n, int runs)
{
  const std::vector<Sample> samples{ balls(n, 3, 0.2, 4, 12), balls(n, 3, 0.2, 2, 4), noise(n, 3, 0.2),
    noise(n, 3, 0.31) };
  fmt::print("\nvolumes of {}^3, medians of {}\n", n, runs);
  fmt::print(
    "{:<30} {:>8} {:>4} {:>9} {:>9} {:>9} {:>11}\n", "volume", "porosity", "way", "pores", "largest", "s", "Mvoxels/s");
  std::vector<std::int32_t> labels;
  for (const Sample& sample : samples)
    for (const int connectivity : { 6, 18, 26 })
    {
      const Ours ours = label(sample, connectivity, runs, labels);
      fmt::print("{:<30} {:>8.3f} {:>4} {:>9} {:>9} {:>9.3f} {:>11.0f}\n", sample.name, porosityOf(sample),
        connectivity, ours.count, ours.largest, ours.seconds, 1e-6 * static_cast<double>(n * n * n) / ours.seconds);
      std::fflush(stdout);
    }
}

void besideVtk(std::int64_t n, int runs)
{
  std::vector<Sample> samples{ softwood(n), balls(n, 2, 0.3, 5, 40), noise(n, 2, 0.5) };
  const std::int64_t side = std::llround(std::cbrt(static_cast<double>(n * n)));
  samples.push_back(balls(side, 3, 0.2, 4, 12));
  fmt::print("\nbeside vtkThreshold and vtkConnectivityFilter, over corners, medians of {}\n", runs);
  std::vector<std::int32_t> labels;
  for (const Sample& sample : samples)
  {
    const Lattice& l = sample.lattice;
    vtkNew<vtkImageData> image;
    image->SetDimensions(static_cast<int>(l.size[0]) + 1, static_cast<int>(l.size[1]) + 1,
      l.dimension == 3 ? static_cast<int>(l.size[2]) + 1 : 1);
    vtkNew<vtkUnsignedCharArray> cells;
    cells->SetName("phase");
    cells->SetNumberOfTuples(l.count());
    std::copy(sample.phase.begin(), sample.phase.end(), cells->GetPointer(0));
    image->GetCellData()->SetScalars(cells);
    int count = 0;
    const double theirs = timed(runs,
      [&]
      {
        vtkNew<vtkThreshold> threshold;
        threshold->SetInputData(image);
        threshold->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "phase");
        threshold->SetThresholdFunction(vtkThreshold::THRESHOLD_BETWEEN);
        threshold->SetLowerThreshold(0);
        threshold->SetUpperThreshold(0);
        vtkNew<vtkConnectivityFilter> connectivity;
        connectivity->SetInputConnection(threshold->GetOutputPort());
        connectivity->SetExtractionModeToAllRegions();
        connectivity->ColorRegionsOn();
        connectivity->Update();
        count = connectivity->GetNumberOfExtractedRegions();
      });
    const Ours ours = label(sample, l.dimension == 3 ? 26 : 8, runs, labels);
    fmt::print("{:<30} {}^{} {:>9} pores  {:>9.1f} ms  {:>9.1f} ms  ratio {:.0f}{}\n", sample.name, l.size[0],
      l.dimension, ours.count, 1e3 * ours.seconds, 1e3 * theirs, theirs / ours.seconds,
      count == ours.count ? "" : fmt::format("  DIFFERENT: VTK counts {}", count));
    std::fflush(stdout);
  }
}

} // namespace

// pore-flood-fill-speed [side of the pictures] [side of the volumes] [runs]
int main(int argc, char** argv)
{
  const auto word = [&](int i, long otherwise) { return argc > i ? std::strtol(argv[i], nullptr, 10) : otherwise; };
  const int runs = static_cast<int>(word(3, 7));
  pictures(word(1, 4096), runs);
  volumes(word(2, 400), std::max(3, runs / 2));
  besideVtk(1024, 3);
  return 0;
}
