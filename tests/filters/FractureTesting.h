#pragma once

#include "BondTesting.h"

#include "vtkBondFracture.h"

#include "vtkCallbackCommand.h"
#include "vtkMath.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

/// A sample that breaks along a weak band, and what vtkBondFracture and vtkBondDynamics both do with it.
namespace lamella::vtktest
{

inline constexpr double bandSpacing = 1e-5;

/// Wall with a hole and a softer, weaker band across.
inline int bandRule(int x, int y, int z)
{
  const int middle = 14 + x / 8;
  return (x - 15) * (x - 15) + (y - 20) * (y - 20) + (z - 4) * (z - 4) < 14 ? 0 : std::abs(y - middle) < 3 ? 2 : 1;
}

inline vtkSmartPointer<vtkImageData> band(int nx = 24, int ny = 36, int nz = 1)
{
  const auto image = picture(nx, ny, nz, bandRule, bandSpacing);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "wall", "lamella" });
  return image;
}

inline void configure(vtkBondAlgorithm* filter)
{
  filter->SetYoungsModulus("wall", 4e9);
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetCriticalStretch("wall", 1e-2);
  filter->SetCriticalStretch("lamella", 2e-3);
  filter->SetLike("lamella-wall", "lamella");
}

inline double number(vtkDataObject* data, const char* name, std::size_t i = 0)
{
  const std::vector<double> values = fieldNumbers(data, name);
  EXPECT_GT(values.size(), i) << name;
  return values.size() > i ? values[i] : std::nan("");
}

/// How often a filter has told its progress.
class ProgressCount
{
public:
  explicit ProgressCount(vtkAlgorithm* filter)
  {
    count_->SetClientData(&runs_);
    count_->SetCallback([](vtkObject*, unsigned long, void* runs, void*) { ++*static_cast<int*>(runs); });
    filter->AddObserver(vtkCommand::ProgressEvent, count_);
  }
  [[nodiscard]] int get() const noexcept { return runs_; }

private:
  vtkNew<vtkCallbackCommand> count_;
  int runs_ = 0;
};

/// The band, changed, is refused; there is no curve either.
template <class Filter>
void expectBandRefused(const std::function<void(Filter*)>& change, const char* message, int failure)
{
  vtkNew<Filter> filter;
  configure(filter);
  filter->SetInputData(band());
  change(filter);
  expectRefused(filter, message, failure);
  EXPECT_EQ(filter->GetCurve()->GetNumberOfRows(), 0);
}

class BondFracture : public OnBonds
{
protected:
  /// Breaks 40 bonds of the band, in pieces split along x and into blocks, with and without a layer of ghosts: the same
  /// as alone.
  /// @param set also told whether the filter works alone
  /// @param energy of its largest, by which the energy of nodes may differ
  /// @param numbers relative, by which those of the whole may
  template <class Filter>
  static void expectSameOnRanks(const std::function<void(Filter*, bool)>& set, double energy, double numbers)
  {
    const auto image = band();
    const auto prepare = [&](Filter* filter, bool one)
    {
      configure(filter);
      filter->SetMaximumBroken(40);
      filter->AddStateAtBroken(15);
      filter->ComputeStrainEnergyOn();
      set(filter, one);
    };
    vtkNew<Filter> alone;
    prepare(alone, true);
    alone->SetInputData(image);
    alone->UpdatePiece(0, 1, 0);
    vtkImageData* const whole = alone->GetOutput();
    ASSERT_GT(whole->GetNumberOfPoints(), 0);
    for (const bool blocks : { false, true })
    {
      const auto producer = pieceOf(image, blocks);
      vtkNew<Filter> together;
      prepare(together, false);
      together->SetInputConnection(producer->GetOutputPort());
      together->UpdatePiece(rank(), ranks(), 0);
      vtkImageData* const part = together->GetOutput();
      EXPECT_EQ(fieldText(part, "method"), fieldText(whole, "method"));
      for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
      {
        const vtkIdType other = whole->FindPoint(part->GetPoint(i));
        ASSERT_EQ(points(part, "broken")->GetTuple1(i), points(whole, "broken")->GetTuple1(other));
        const double damage = points(part, "damage")->GetTuple1(i);
        const double expected = points(whole, "damage")->GetTuple1(other);
        ASSERT_TRUE(damage == expected || (std::isnan(damage) && std::isnan(expected))) << i; // in voids
        ASSERT_NEAR(points(part, "strain_energy")->GetTuple1(i), points(whole, "strain_energy")->GetTuple1(other),
          energy * points(whole, "strain_energy")->GetRange()[1]);
      }
      for (const char* const name : { "effective_modulus", "peak_stress", "broken_energy", "bonds", "total_broken" })
        EXPECT_NEAR(number(part, name) / number(whole, name), 1, numbers) << name;
      EXPECT_EQ(together->GetNumberOfStates(), 2);
      vtkPolyData* const broken = together->GetBrokenBonds();
      if (rank() > 0)
      {
        EXPECT_EQ(broken->GetNumberOfPoints(), 0);
        EXPECT_EQ(together->GetCurve()->GetNumberOfRows(), 0);
        continue;
      }
      ASSERT_EQ(broken->GetNumberOfPoints(), alone->GetBrokenBonds()->GetNumberOfPoints());
      EXPECT_GE(broken->GetNumberOfPoints(), 40);
      for (vtkIdType i = 0; i < broken->GetNumberOfPoints(); ++i)
        EXPECT_EQ(vtkMath::Distance2BetweenPoints(broken->GetPoint(i), alone->GetBrokenBonds()->GetPoint(i)), 0);
      EXPECT_EQ(together->GetCurve()->GetNumberOfRows(), alone->GetCurve()->GetNumberOfRows());
    }
  }
};

} // namespace lamella::vtktest
