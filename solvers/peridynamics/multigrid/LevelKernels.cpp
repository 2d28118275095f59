#include "peridynamics/multigrid/LevelKernels.h"

#include "core/InstructionSet.h"

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
  static const LevelKernels& best = fastest(levelKernelsBase, levelKernelsV3, levelKernelsV4);
  return best;
#else
  return levelKernelsBase;
#endif
}

} // namespace lamella::peridynamics
