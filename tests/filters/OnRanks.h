#pragma once

#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkMPIController.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkTrivialProducer.h"

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

  /// This rank's piece of an image that all hold, in slabs along x with a layer of ghosts, or in blocks without.
  [[nodiscard]] static vtkSmartPointer<vtkTrivialProducer> pieceOf(vtkImageData* image, bool blocks)
  {
    vtkNew<vtkExtentTranslator> translator;
    translator->SetWholeExtent(image->GetExtent());
    translator->SetNumberOfPieces(ranks());
    translator->SetPiece(rank());
    blocks ? translator->SetSplitModeToBlock() : translator->SetSplitModeToXSlab();
    translator->SetGhostLevel(blocks ? 0 : 1);
    translator->PieceToExtent();
    vtkNew<vtkImageData> piece;
    piece->DeepCopy(image);
    piece->Crop(translator->GetExtent());
    auto producer = vtkSmartPointer<vtkTrivialProducer>::New();
    producer->SetOutput(piece);
    producer->SetWholeExtent(image->GetExtent());
    return producer;
  }

  inline static vtkMPIController* controller_ = nullptr;
};

} // namespace lamella::vtktest
