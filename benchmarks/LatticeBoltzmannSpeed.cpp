// Lattice Boltzmann stepping: updates of nodes a second on every lattice, against what the memory could do, measured in
// the same run: an array as large as the populations read, scaled and written in place. Bound A is that of one step a
// pass over memory (16 Q + 1 bytes an update), bound B that of a pair of steps a pass (8 Q + ½), which is how rows are
// stepped when they are too long for the cache to hold several pairs. Medians of several runs in turns.
//   quick      smaller boxes, fewer repetitions
//   collision=bgk
//   voids      a third of the nodes do not conduct
#include "Keys.h"

#include "core/Clock.h"
#include "lattice/Phases.h"
#include "lbm/stepping/LatticeBoltzmann.h"
#include "lbm/stepping/StepKernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include <sys/mman.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

struct Times
{
  double wall = 0;
  double processor = 0; ///< seconds of all threads over their number
};

template <class F>
Times timed(int threads, F&& f)
{
  const auto from = Clock::now();
  const double t = cpu();
  f();
  return { secondsSince(from), (cpu() - t) / threads };
}

// An array read, scaled and written in place, in large pages like the populations.
class Scaling
{
public:
  explicit Scaling(std::size_t bytes)
    : n_(bytes / sizeof(double))
  {
    constexpr std::size_t huge = std::size_t{ 1 } << 21;
    const std::size_t whole = (bytes + huge - 1) / huge * huge;
    a_.reset(static_cast<double*>(std::aligned_alloc(huge, whole)));
    madvise(a_.get(), whole, MADV_HUGEPAGE);
    std::fill_n(a_.get(), n_, 1.0);
  }
  void pass(int threads)
  {
    double* a = a_.get();
    const auto n = static_cast<std::int64_t>(n_);
#pragma omp parallel for simd schedule(static) num_threads(threads)
    for (std::int64_t i = 0; i < n; ++i)
      a[i] = 0.999 * a[i] + 0.001;
  }
  [[nodiscard]] double bytes() const
  {
    return 16.0 * static_cast<double>(n_);
  }

private:
  struct Free
  {
    void operator()(double* p) const { std::free(p); }
  };
  std::size_t n_;
  std::unique_ptr<double[], Free> a_;
};

PhaseImage cells(std::int64_t n, int dimension, bool voids)
{
  PhaseImage image;
  image.lattice = makeLattice(n, n, dimension == 3 ? n : 1, dimension, 1.0);
  image.phase.resize(static_cast<std::size_t>(image.lattice.count()));
  for (std::int64_t z = 0, i = 0; z < image.lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x, ++i)
        image.phase[i] =
          static_cast<std::uint8_t>(voids ? (x % 15 < 8 && y % 15 < 8 ? 0 : 1) : (x / 5 + y / 7 + z / 3) % 2);
  return image;
}

void measure(lbm::Stencil stencil, std::int64_t n, lbm::Collision collision, bool voids, int threads, int repeats)
{
  const int dimension = stencil == lbm::Stencil::D2Q5 || stencil == lbm::Stencil::D2Q9 ? 2 : 3;
  const PhaseImage image = cells(n, dimension, voids);
  lbm::SteppingOptions o;
  o.stencil = stencil;
  o.collision = collision;
  o.threads = threads;
  const std::vector<double> d{ voids ? 0.0 : 0.1, 1.0 };
  lbm::LatticeBoltzmann solver(image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, d, o);
  const auto stat = solver.statistics();
  const int populations = static_cast<int>(stat.bytesPerUpdate / 8);
  Scaling scaling(static_cast<std::size_t>(8 * populations * stat.stored));
  const std::int64_t steps = 16;
  std::vector<double> bandwidth;
  std::vector<double> rate;
  std::vector<double> wall;
  std::vector<double> share;
  solver.advance(steps);
  scaling.pass(threads);
  for (int r = 0; r < repeats; ++r)
  {
    const Times copy = timed(
      threads,
      [&]
      {
        scaling.pass(threads);
        scaling.pass(threads);
      });
    const Times step = timed(threads, [&] { solver.advance(steps); });
    const double updates = static_cast<double>(stat.stored * steps);
    bandwidth.push_back(2 * scaling.bytes() / copy.processor / 1e9);
    rate.push_back(updates / step.processor / 1e6);
    wall.push_back(updates / step.wall / 1e6);
    share.push_back(rate.back() * 1e6 * (16.0 * populations + 1) / (bandwidth.back() * 1e9));
  }
  const double a = median(share);
  fmt::print("{:6} {:3} {:5}  {:7.1f}  {:8.1f} {:8.1f}  {:7.1f} {:7.1f}  {:6.0f} % {:6.0f} %\n", lbm::name(stencil),
    lbm::name(collision), n, median(bandwidth), median(rate), median(wall),
    static_cast<double>(stat.bytes) / static_cast<double>(stat.stored), stat.bytesPerUpdate, 100 * a,
    100 * a * stat.bytesPerUpdate / (16.0 * populations + 1));
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  return told(
    [&]
    {
      const auto keys = keysOf(argc, argv);
      const bool quick = keys.count("quick") != 0;
      const auto flat = static_cast<std::int64_t>(number(keys, "flat", quick ? 1024 : 2048));
      const auto deep = static_cast<std::int64_t>(number(keys, "deep", quick ? 96 : 256));
      const auto most = static_cast<int>(number(keys, "threads", 2));
      const int repeats = quick ? 3 : 5;
      const auto asked = keys.find("collision");
      const auto collision = asked != keys.end() && asked->second == "bgk" ? lbm::Collision::BGK : lbm::Collision::TRT;
      for (int threads = 1; threads <= most; ++threads)
      {
        fmt::print("{} thread(s), {}; rates by processor time a thread\n"
                   "lattice      size   GB/s    M/s      M/s wall   B/node  B/update bound A  bound B\n",
          threads, lbm::stepKernels().name);
        for (const auto stencil : { lbm::Stencil::D2Q5, lbm::Stencil::D2Q9, lbm::Stencil::D3Q7, lbm::Stencil::D3Q19 })
        {
          const bool plane = stencil == lbm::Stencil::D2Q5 || stencil == lbm::Stencil::D2Q9;
          if (keys.count("only") != 0 && keys.at("only") != lbm::name(stencil))
            continue;
          measure(stencil, plane ? flat : deep, collision, keys.count("voids") != 0, threads, repeats);
        }
      }
    });
}
