// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// ROL's headers, and the differences between ROL of Trilinos 13.2 and current ROL (Trilinos 16 and later),
/// all that matter here, in one place. Names are the same in both; what differs is what they do, and none of
/// it needs a switch:
///
/// | | 13.2 | current | here |
/// |---|---|---|---|
/// | tolerances of inexact values and gradients | asked for by trust regions with SPG | by those of Lin-Moré,
/// too | `Tolerances::AsAsked` | | relative tolerances of StatusTest | multiply again at each first iteration
/// | once | made absolute before | | ConstraintStatusTest | knows none | relative ones | likewise | |
/// feasibility tolerance of Bounds | 1e-2 | √ε | for interior points alone | | Solver, Problem::finalize() |
/// | one more argument, with a default | left out |
///
/// Both catch std::exception where an augmented Lagrangian scales its constraints: GuardedFunction.
/// ROL::Ptr is Teuchos::RCP or std::shared_ptr, as ROL was configured: makePtr() alone makes them.
/// ROL::ParameterList is that of Teuchos in all builds within Trilinos. Headers of methods (ROL_Solver.hpp)
/// are included by the sources that need them: they are large.

#include <ROL_Bounds.hpp>
#include <ROL_Constraint.hpp>
#include <ROL_Objective.hpp>
#include <ROL_ParameterList.hpp>
#include <ROL_PartitionedVector.hpp>
#include <ROL_Ptr.hpp>
#include <ROL_ScaledStdVector.hpp>
#include <ROL_StdVector.hpp>
#include <ROL_Types.hpp>
