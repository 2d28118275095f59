#pragma once

#include "lbm/stepping/SlotMap.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lamella::lbm
{

/// The populations and the order in which they are stepped. An odd step follows the even one as soon as the rows
/// around are there; without other ranks, several pairs of steps follow each other like that, as many as keep their
/// rows in cache, and each population is read from memory once for all of them. Threads work on slabs, in whose
/// middle they need not wait for each other; the rows between two slabs are done after that.
class Sweep
{
public:
  /// @param phase of the stored nodes, in their order  @param rate 256 relaxation rates
  Sweep(const SlotMap& map, const Communicator& comm, const StepLoops& loops, std::vector<std::uint8_t> phase,
    std::vector<double> rate, std::array<std::int64_t, 3> size, bool wrapsY, int threads);

  /// Pairs of steps that one pass over memory can take.
  [[nodiscard]] int pairsAtOnce() const noexcept { return depth_; }
  /// Takes pairs of steps, at most pairsAtOnce(). Collective.
  /// @return Σ u² over this rank's nodes in the last even step
  double advance(int pairs);

  [[nodiscard]] double* data() noexcept { return f_.get(); }
  [[nodiscard]] const double* data() const noexcept { return f_.get(); }
  [[nodiscard]] const std::vector<std::uint8_t>& phase() const noexcept { return phase_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Other relaxation rates from now on, 256 of them.
  void relaxAt(const std::vector<double>& rate) { std::copy(rate.begin(), rate.end(), rate_.begin()); }
  /// Relaxation rate of a stored node.
  [[nodiscard]] double rate(std::int32_t node) const noexcept { return rate_[phase_[node]]; }

private:
  struct Free
  {
    void operator()(double* p) const noexcept;
  };
  double even(std::int64_t row) const;
  double odd(std::int64_t row) const;
  double slab(std::int64_t begin, std::int64_t end, int pairs) const;
  double tiles(std::int64_t begin, std::int64_t end) const;
  double gap(std::int64_t boundary, int pairs) const;
  void exchange(bool back);

  const SlotMap& map_;
  const Communicator& comm_;
  StepLoops loops_;
  SlotArrays arrays_{};
  std::vector<std::uint8_t> phase_;
  std::vector<double> rate_;
  std::unique_ptr<double[], Free> f_;
  std::int64_t rowsAll_ = 0;
  std::int64_t lag_ = 1;     ///< rows that a row's neighbours lie apart, at most
  bool interleaved_ = false; ///< odd steps follow even ones at once
  int depth_ = 1;
  std::int64_t plane_ = 0;          ///< rows of a plane, where planes are swept in tiles
  std::int64_t tile_ = 0;           ///< rows of a tile; 0: they are not
  std::vector<std::int64_t> slabs_; ///< first rows; one more than threads
  std::vector<double> send_;
  std::vector<double> receive_;
};

} // namespace lamella::lbm
