// main() of tests that use MPI, on one rank (no mpirun needed) or several. Only rank 0 tells what runs; every rank
// tells what fails, and the program fails when any rank did.
#include <gtest/gtest.h>

#include <mpi.h>

#include <cstdio>

namespace
{

/// Prints failures with the rank they happened on, and nothing else.
class FailurePrinter : public testing::EmptyTestEventListener
{
public:
  explicit FailurePrinter(int rank)
    : rank_(rank)
  {
  }

private:
  void OnTestPartResult(const testing::TestPartResult& result) override
  {
    if (result.failed())
    {
      std::fprintf(stderr, "rank %d: %s:%d: %s\n", rank_, result.file_name() != nullptr ? result.file_name() : "?",
        result.line_number(), result.message());
    }
  }

  int rank_;
};

} // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  if (GTEST_FLAG_GET(list_tests))
    return RUN_ALL_TESTS();
  MPI_Init(&argc, &argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank != 0)
  {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter(rank)); // the list owns it
  }
  int failed = RUN_ALL_TESTS();
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
