// Another project's use of Lamella::Solvers: layers of two phases, half and half, that conduct 1 and 3. Along the
// layers the answer is the mean of the two, 2; across them the harmonic mean, 1.5; exactly, whatever the resolution, so
// that only the solver's tolerance of 1e-8 and the rounding of the printed digits are left.
#include "lamella/Version.h"
#include "lbm/SteadyDiffusion.h"

#include <mpi.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  int status = 1;
  {
    const auto lattice = lamella::makeLattice(32, 32, 1, 2, 1e-6);
    std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()));
    for (std::int64_t y = 0; y < 32; ++y)
      for (std::int64_t x = 0; x < 32; ++x)
        phase[static_cast<std::size_t>(lattice.index(x, y))] = static_cast<std::uint8_t>(x / 8 % 2);
    const std::array<double, 2> conductivity{ 1.0, 3.0 };
    lamella::lbm::SteadyDiffusion solver(
      lattice, lamella::lbm::decompose(lattice, MPI_COMM_SELF), phase, conductivity, {}, MPI_COMM_SELF);
    const double across = solver.solve(0).effective[0];
    const double along = solver.solve(1).effective[1];
    std::printf("Lamella %s: across the layers %.6f, along them %.6f\n", lamella::version(), across, along);
    status = std::abs(across - 1.5) < 1e-6 && std::abs(along - 2.0) < 1e-6 ? 0 : 1;
  }
  MPI_Finalize();
  return status;
}
