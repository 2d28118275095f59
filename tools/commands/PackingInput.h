#pragma once

#include "session/Session.h"

#include <CLI/App.hpp>
#include <vtkSmartPointer.h>

#include <array>
#include <string>
#include <vector>

class vtkPolyData;

/// Packings from files, for the commands that take one.
namespace lamella::cli
{

/// What a table of grains does not tell.
struct TableOptions
{
  std::string unit;                   ///< --unit LENGTH
  std::string box;                    ///< --box X,Y[,Z]
  std::vector<CLI::Option*> declared; ///< both
};

/// --unit, --box
void addTableOptions(CLI::App& command, TableOptions& options);

/// Grains, and their contacts where these are known.
struct Grains
{
  vtkSmartPointer<vtkPolyData> grains;
  vtkSmartPointer<vtkPolyData> contacts;
};

/// The particles of a .vtp, or of a scene's earlier step, or a table by vtkPackingReader.
/// @throws InputError, ParameterError
[[nodiscard]] Grains readPacking(Session& session, const std::string& path, const TableOptions& options);

/// Whether a name ends in .vtp.
[[nodiscard]] bool isParticleFile(const std::string& path);

/// The first of these that was given on the command line, by its name; empty: none.
[[nodiscard]] std::string firstGiven(const std::vector<CLI::Option*>& options);

/// "17.2 mm × 34.4 mm" @param size edges [m]; the third of disks is 0
[[nodiscard]] std::string boxText(const std::array<double, 3>& size);

} // namespace lamella::cli
