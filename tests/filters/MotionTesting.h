#pragma once

#include "FractureTesting.h"

#include "vtkBondDynamics.h"

/// The tests of vtkBondDynamics take the sample of those of vtkBondFracture.
namespace lamella::vtktest
{

class BondDynamics : public BondFracture
{
};

} // namespace lamella::vtktest
