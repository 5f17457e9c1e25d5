// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_ParameterList.hpp>

namespace Harmos::qp {

/// When new directions of conjugate gradients are made conjugate to all earlier ones.
enum class Reorthogonalisation {
  None, ///< to the last one alone: short recurrences
  Full, ///< always
  Auto  ///< from where rounding errors are seen to have spoilt conjugacy
};

/// Parameters of conjugate gradients; the list "PCPG".
struct CgOptions {
  Reorthogonalisation reorthogonalisation = Reorthogonalisation::Auto;
  int storedDirections = 500;

  static ParameterSpec parameterSpec();
  /// @param list validated.
  static CgOptions fromList(const Teuchos::ParameterList& list);
};

} // namespace Harmos::qp
