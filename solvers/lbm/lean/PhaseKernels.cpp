#include "lbm/lean/PhaseKernels.h"

#include "core/InstructionSet.h"

namespace lamella::lbm
{

extern const PhaseKernels phaseKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const PhaseKernels phaseKernelsV3;
extern const PhaseKernels phaseKernelsV4;
#endif

const PhaseKernels& phaseKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const PhaseKernels& chosen = fastest(phaseKernelsBase, phaseKernelsV3, phaseKernelsV4);
  return chosen;
#else
  return phaseKernelsBase;
#endif
}

} // namespace lamella::lbm
