#include "peridynamics/kernels/RowKernels.h"

namespace lamella::peridynamics
{

extern const RowKernels rowKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const RowKernels rowKernelsV3;
extern const RowKernels rowKernelsV4;
#endif

int rowKernelSets(const RowKernels** sets)
{
  int n = 0;
  sets[n++] = &rowKernelsBase;
#ifdef LAMELLA_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v3"))
    sets[n++] = &rowKernelsV3;
  if (__builtin_cpu_supports("x86-64-v4"))
    sets[n++] = &rowKernelsV4;
#endif
  return n;
}

const RowKernels& rowKernels()
{
  static const RowKernels* const best = []
  {
    const RowKernels* sets[3];
    const int n = rowKernelSets(sets);
    return sets[n - 1];
  }();
  return *best;
}

} // namespace lamella::peridynamics
