#include "pores/Runs.h"

namespace lamella::pores
{

extern const RunKernels runKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const RunKernels runKernelsAvx2;
#endif

const RunKernels& runKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const bool newer = []
  {
    __builtin_cpu_init();
    // what it is compiled with, name by name
    return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0 &&
      __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_supports("popcnt") != 0;
  }();
  if (newer)
    return runKernelsAvx2;
#endif
  return runKernelsBase;
}

} // namespace lamella::pores
