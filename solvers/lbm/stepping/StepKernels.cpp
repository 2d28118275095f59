#include "lbm/stepping/StepKernels.h"

namespace lamella::lbm
{

extern const StepKernels stepKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const StepKernels stepKernelsV3;
extern const StepKernels stepKernelsV4;
#endif

const StepKernels& stepKernels()
{
#ifdef LAMELLA_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4"))
    return stepKernelsV4;
  if (__builtin_cpu_supports("x86-64-v3"))
    return stepKernelsV3;
#endif
  return stepKernelsBase;
}

} // namespace lamella::lbm
