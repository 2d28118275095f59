#include "pores/Runs.h"

namespace lamella::pores
{

extern const RunKernels runKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const RunKernels runKernelsV3;
#endif

const RunKernels& runKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const bool newer = []
  {
    __builtin_cpu_init();
    return __builtin_cpu_supports("x86-64-v3") != 0;
  }();
  if (newer)
    return runKernelsV3;
#endif
  return runKernelsBase;
}

} // namespace lamella::pores
