// Another project's use of Lamella::Solvers: half wall, half lumen, in layers. Along the layers the conductivity is
// the mean of the two, across them the harmonic mean; both exactly, whatever the resolution.
#include "generators/Generators.h"
#include "lamella/Version.h"
#include "lbm/SteadyDiffusion.h"

#include <mpi.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  const auto image = lamella::generators::laminate(2, { 32, 32, 1 }, 1e-6, 0, 0.5, 2);
  const std::array<double, 2> conductivity{ 1.0, 3.0 };
  lamella::lbm::SteadyDiffusion solver(
    image.lattice, { { 0, 0, 0 }, image.lattice.size }, image.phase, conductivity, {}, MPI_COMM_SELF);
  const double across = solver.solve(0).effective[0];
  const double along = solver.solve(1).effective[1];
  std::printf("Lamella %s: across the layers %.10f, along them %.10f\n", lamella::version(), across, along);
  MPI_Finalize();
  return std::abs(across - 1.5) < 1e-6 && std::abs(along - 2.0) < 1e-6 ? 0 : 1;
}
