// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// FETI for applications that bring their own matrices: the solver over load steps, its input, single
/// operators, and the errors that they throw. See docs/embedding.md.

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_LocalMatrix.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_SubdomainInput.hpp"
#include "Harmos_TornOperator.hpp"
#include "Harmos_Types.hpp"
