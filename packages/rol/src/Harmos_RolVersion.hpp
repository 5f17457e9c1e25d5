// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// ROL's headers, and the differences between ROL of Trilinos 13.2 and of current Trilinos (16 and later), all of
/// them, in one place.

#include <ROL_Bounds.hpp>
#include <ROL_Constraint.hpp>
#include <ROL_Objective.hpp>
#include <ROL_ParameterList.hpp>
#include <ROL_PartitionedVector.hpp>
#include <ROL_Ptr.hpp>
#include <ROL_ScaledStdVector.hpp>
#include <ROL_StdVector.hpp>
#include <ROL_Types.hpp>
