#pragma once

#include "OnRanks.h"
#include "VtkTesting.h"

#include "vtkBondAlgorithm.h"

#include "vtkOutputWindow.h"

#include <gtest/gtest.h>

#include <string>

/// What the tests of filters of bonds share.
namespace lamella::vtktest
{

class OnBonds : public OnRanks
{
protected:
  static void SetUpTestSuite()
  {
    OnRanks::SetUpTestSuite();
    vtkOutputWindow::GetInstance()->SetDisplayModeToNever(); // warnings of thin phases and of seams
  }
};

/// Updates a filter, which is to fail with this in its message, a hint, and an empty image.
inline void expectRefused(vtkBondAlgorithm* filter, const std::string& message, int failure)
{
  SCOPED_TRACE(message);
  const std::string error = errorOf(filter);
  EXPECT_NE(error.find(message), std::string::npos) << error;
  EXPECT_NE(error.find("hint: "), std::string::npos) << error;
  EXPECT_EQ(filter->GetFailure(), failure);
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
}

} // namespace lamella::vtktest
