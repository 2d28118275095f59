#pragma once

class vtkDataObject;

namespace lamella::cli
{

/// Drops ranges that were worked out on the way: they would be written, as "-nan" where an array holds NaN, and every
/// reader would complain about them.
void forgetRanges(vtkDataObject* data);

} // namespace lamella::cli
