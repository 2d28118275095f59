#pragma once

#include <vtkPolyDataAlgorithm.h>

#include <string>
#include <vector>

namespace lamella::cli
{

/// States in files of their own as the time steps 0, 1, ... of one source, so that only one of them is held at a time.
class StateFiles : public vtkPolyDataAlgorithm
{
public:
  static StateFiles* New();
  vtkTypeMacro(StateFiles, vtkPolyDataAlgorithm);

  /// @param names .vtp files
  /// @param strains one a file, written to its field data `strain`; empty: the files tell theirs
  void SetFiles(std::vector<std::string> names, std::vector<double> strains);

protected:
  StateFiles();
  ~StateFiles() override = default;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  std::vector<std::string> Names;
  std::vector<double> Strains;
};

} // namespace lamella::cli
