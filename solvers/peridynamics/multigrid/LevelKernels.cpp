#include "peridynamics/multigrid/LevelKernels.h"

namespace lamella::peridynamics
{

extern const LevelKernels levelKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const LevelKernels levelKernelsV3;
extern const LevelKernels levelKernelsV4;
#endif

const LevelKernels& levelKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const LevelKernels& best = []() -> const LevelKernels&
  {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4"))
      return levelKernelsV4;
    return __builtin_cpu_supports("x86-64-v3") ? levelKernelsV3 : levelKernelsBase;
  }();
  return best;
#else
  return levelKernelsBase;
#endif
}

} // namespace lamella::peridynamics
