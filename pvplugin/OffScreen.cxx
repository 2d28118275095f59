// Every process that loads the plugin can draw with no display: the ranks of pvbatch that run no Python of their own,
// and servers, too. Where a display works nothing changes.
#include "vtkOffScreenWindows.h"

namespace
{

[[maybe_unused]] const bool Installed = vtkOffScreenWindows::Install();

} // namespace
