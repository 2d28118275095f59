#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

class vtkDataObject;

/// How sources and filters write where their output comes from: the field array `provenance`, one JSON object
/// (io/Provenance.h). Not installed.
namespace lamella
{

/// What a source made: version, commit, date, seed, input file and its parameters under the name of the step.
/// @throws InputError when the file cannot be read
VTKLAMELLASOLVERSVTK_EXPORT void beginProvenance(vtkDataObject* data, const std::string& step,
  const nlohmann::json& parameters, std::optional<std::uint64_t> seed = {},
  const std::optional<std::filesystem::path>& file = {});

/// Adds a filter's parameters to the record that came with its input (inputs and seed are kept).
VTKLAMELLASOLVERSVTK_EXPORT void continueProvenance(
  vtkDataObject* data, const std::string& step, const nlohmann::json& parameters);

} // namespace lamella
