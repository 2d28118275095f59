#pragma once

#include "program/SettingOptions.h"
#include "session/Session.h"

#include <CLI/App.hpp>
#include <vtkSmartPointer.h>

#include <array>
#include <string>

class vtkPolyData;

/// Packings from files, for the commands that take one.
namespace lamella::cli
{

/// Declares --unit and --box, settings of vtkPackingReader.
void addTableOptions(CLI::App& command, SettingOptions& table);

/// Grains, and their contacts where these are known.
struct Grains
{
  vtkSmartPointer<vtkPolyData> grains;
  vtkSmartPointer<vtkPolyData> contacts;
};

/// The particles of a .vtp, or of a scene's earlier step, or a table by vtkPackingReader.
/// @throws InputError, ParameterError
[[nodiscard]] Grains readPacking(Session& session, const std::string& path, const SettingOptions& table);

/// Whether a name ends in .vtp.
[[nodiscard]] bool isParticleFile(const std::string& path);

/// "17.2 mm × 34.4 mm" @param size edges [m]; the third of disks is 0
[[nodiscard]] std::string boxText(const std::array<double, 3>& size);

} // namespace lamella::cli
