#pragma once

#include "OutputFile.h"

#include <string>
#include <vector>

class vtkBondFracture;
class vtkImageData;

namespace lamella::cli
{

/// The states of a fracture as files: NAME.vti, or where several are asked for NAME_000.vti, NAME_001.vti, … and
/// NAME.pvd, which tells their strains as times.
class StateFiles
{
public:
  StateFiles() = default;
  /// Opens as many files as there may be states.
  /// @param name of the option -o; empty: no file
  /// @throws ParameterError for another ending than .vti; OutputError
  StateFiles(const std::string& name, std::size_t states, bool overwrite);

  /// @param bytes of one state @throws OutputError when the disk has less room
  void needs(std::uint64_t bytes) const;

  /// Writes the states of the filter's last run. @returns the names, those of the states first
  /// @throws OutputError; Cancelled
  [[nodiscard]] std::vector<std::string> write(vtkBondFracture* filter, const std::string& provenance);
  /// Gives what was written its names. @throws OutputError; Cancelled
  void commit();

private:
  std::vector<OutputFile> files_;
  std::vector<OutputFile> collection_; ///< one or none
  std::size_t written_ = 0;            ///< of the files
};

/// What ParaView reads as a time series.
/// @param times of the files, made to rise by 1e-9 of themselves where they do not
[[nodiscard]] std::string collectionText(const std::vector<std::string>& files, std::vector<double> times);

} // namespace lamella::cli
