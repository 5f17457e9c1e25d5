// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_ParameterList.hpp>

namespace Harmos::rol {

/// ROL's parameters where none are given, for costs that take a solution each.
///
/// | Parameter | Default | Why |
/// |---|---|---|
/// | Step/Type | Trust Region | Lin-Moré's (ROL's default among them): of ROL's methods for bounds the one
/// with the fewest evaluations on the problems of tests/unit/rol/test_minimise.cpp; spectral gradients took
/// ten times as many | | | Augmented Lagrangian | with a constraint that is not linear; its subproblems as
/// above | | Step/Line Search/Descent Method/Type | Quasi-Newton Method | where Step/Type is Line Search:
/// others ask for Hessians, or are slow | | General/Secant/Use as Hessian | true | ROL's own Hessians are
/// differences of gradients, a solution each | | General/Secant/Maximum Storage | 60 | pairs cost nothing
/// beside a solution | | General/Krylov/Iteration Limit | 60 | likewise | | General/Polyhedral
/// Projection/Type | Dai-Fletcher | of one linear constraint; of more of them Semismooth Newton | | Status
/// Test/Gradient Tolerance | 1e-3 | of the first one's | | Status Test/Step Tolerance | 1e-6 | of the box's
/// diagonal | | Status Test/Constraint Tolerance | 1e-6 | of what a constraint changes over the box | |
/// Status Test/Iteration Limit | 300 | | | Status Test/Use Relative Tolerances | true | false: gradient and
/// step in the units of the cost and the design |
///
/// @param isNonlinear whether there is a constraint that is not linear: another family of methods.
Teuchos::ParameterList defaultOptions(bool isNonlinear);

/// Every name that a method of this ROL asks for, with ROL's own default: made by making each method once.
const Teuchos::ParameterList& knownOptions();

/// The given parameters over defaultOptions(); integers become reals where ROL has reals.
/// @throws InputError for a name that no method of ROL asks for (with the nearest that one does), for values
/// of another type, and for a method ("Step", "Type") that is none for such problems. Local; the same on all
/// ranks. Guarded by tests/unit/rol/test_minimise.cpp.
Teuchos::ParameterList completeOptions(const Teuchos::ParameterList& given, bool isNonlinear);

} // namespace Harmos::rol
