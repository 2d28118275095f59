#include "elasticity/ElasticKernels.h"

#include "core/InstructionSet.h"

namespace lamella::elasticity
{

extern const ElasticKernels elasticKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const ElasticKernels elasticKernelsV3;
extern const ElasticKernels elasticKernelsV4;
#endif

const ElasticKernels& elasticKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const ElasticKernels& chosen = fastest(elasticKernelsBase, elasticKernelsV3, elasticKernelsV4);
  return chosen;
#else
  return elasticKernelsBase;
#endif
}

} // namespace lamella::elasticity
