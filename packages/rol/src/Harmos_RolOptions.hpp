// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_ParameterList.hpp>

namespace Harmos::rol {

/// ROL's parameters where none are given.
///
/// @param isNonlinear whether there is a constraint that is not linear: another family of methods.
Teuchos::ParameterList defaultOptions(bool isNonlinear);

/// Every name that a method of this ROL asks for, with ROL's own default: made by making each method once.
const Teuchos::ParameterList& knownOptions();

/// The given parameters over defaultOptions(); integers become reals where ROL has reals.
/// @throws InputError for a name that no method of ROL asks for (with the nearest that one does), for values of
/// another type, and for a method ("Step", "Type") that is none for such problems. Local; the same on all ranks.
/// Guarded by tests/unit/rol/test_minimise.cpp.
Teuchos::ParameterList completeOptions(const Teuchos::ParameterList& given, bool isNonlinear);

} // namespace Harmos::rol
