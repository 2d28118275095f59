#pragma once

#include "peridynamics/fracture/DynamicsStudy.h"

/// What studyDynamics() asks and says beside the motion itself.
namespace lamella::peridynamics
{

/// What can be said without the sample. @throws ParameterError
void check(const DynamicsStudyOptions& options);

/// ω₀ [J], [J/m in 2D], as RegulationOptions says.
/// @throws ParameterError where nothing can break
[[nodiscard]] double referenceEnergy(const RegulationOptions& options, const BondModel& model, const Lattice& lattice);

/// Puts what is doubtful before the warnings that are there.
void addWarnings(const BondModel& model, DynamicsResult& result);

} // namespace lamella::peridynamics
