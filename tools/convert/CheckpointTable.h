#pragma once

#include <vtkSmartPointer.h>

#include <span>
#include <string>

class vtkTable;

/// Checkpoints of long runs (io/Checkpoint.h) as tables.
namespace lamella::cli
{

[[nodiscard]] bool isCheckpoint(const std::string& path);

/// One array of a checkpoint: a row for each place along its first axis, a column NAME:0, NAME:1 … for each number of
/// it.
/// @param arrays the name of one @throws InputError, ParameterError: lists the arrays
[[nodiscard]] vtkSmartPointer<vtkTable> checkpointTable(const std::string& path, std::span<const std::string> arrays);

} // namespace lamella::cli
