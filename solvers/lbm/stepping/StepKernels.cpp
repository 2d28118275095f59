#include "lbm/stepping/StepKernels.h"

#include "core/InstructionSet.h"

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
  return fastest(stepKernelsBase, stepKernelsV3, stepKernelsV4);
#else
  return stepKernelsBase;
#endif
}

} // namespace lamella::lbm
