#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella
{

/// A communicator that also stands for "no MPI at all": a program that never called MPI_Init is one rank, and nothing
/// here calls into MPI then. Reductions return the same value on every rank.
class Communicator
{
public:
  explicit Communicator(MPI_Comm comm = MPI_COMM_SELF);

  [[nodiscard]] int rank() const noexcept { return rank_; }
  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] bool parallel() const noexcept { return size_ > 1; }
  [[nodiscard]] MPI_Comm handle() const noexcept { return comm_; }

  /// Ranks that share this machine's memory with this one, itself included. Collective.
  [[nodiscard]] int sizeOnMachine() const;

  /// Sums in place over all ranks.
  void sum(std::span<double> values) const;
  [[nodiscard]] double sum(double value) const;
  [[nodiscard]] std::int64_t sum(std::int64_t value) const;
  [[nodiscard]] bool any(bool value) const;
  [[nodiscard]] double max(double value) const;
  /// Sum over the ranks before this one.
  [[nodiscard]] std::int64_t sumBefore(std::int64_t value) const;
  /// What the ranks hold, in their order, on rank 0; nothing on the others. At most 2³¹ − 1 values together.
  [[nodiscard]] std::vector<double> gather(std::span<const double> mine) const;
  /// Rank 0's bytes, of any number, on every rank.
  void broadcast(std::vector<std::byte>& bytes) const;
  /// The same for as many as every rank has room for.
  void broadcast(std::span<std::byte> bytes) const;

private:
  MPI_Comm comm_;
  int rank_ = 0;
  int size_ = 1;
};

} // namespace lamella
