#pragma once

#include "vtkMPIController.h"
#include "vtkMultiProcessController.h"

#include <gtest/gtest.h>

namespace lamella::vtktest
{

/// Tests that run on any number of ranks: MPI begins and ends with the suite.
class OnRanks : public ::testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    controller_ = vtkMPIController::New();
    controller_->Initialize(nullptr, nullptr, 1);
    vtkMultiProcessController::SetGlobalController(controller_);
  }
  static void TearDownTestSuite()
  {
    vtkMultiProcessController::SetGlobalController(nullptr);
    controller_->Finalize(1);
    controller_->Delete();
  }
  [[nodiscard]] static int rank() { return controller_->GetLocalProcessId(); }
  [[nodiscard]] static int ranks() { return controller_->GetNumberOfProcesses(); }

  inline static vtkMPIController* controller_ = nullptr;
};

} // namespace lamella::vtktest
