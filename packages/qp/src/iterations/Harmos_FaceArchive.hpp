// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_SpringOps.hpp"

#include <BelosMultiVecTraits.hpp>

#include <string>

namespace Harmos::qp {

/// An active set as part of a solver's state: which entries are held where, how pairs slip, and which entries
/// are beyond their soft bounds. @param like any vector of the problem. @note Collective.
template<class Scalar, class MV, class OP>
void exchangeFace(StateArchive<MV>& archive, const std::string& name, const Problem<Scalar, MV, OP>& problem,
                  const MV& like, LocalActiveSet& set) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Sets = ActiveSetOps<Scalar, MV>;
  const Teuchos::RCP<MV> states = MVT::Clone(like, 1);
  Sets::activeToVector(set, *states);
  archive.vector(name + " active set", *states);
  if (archive.isReading())
    Sets::vectorToActive(*states, set);
  if (problem.hasDiscs()) {
    const Teuchos::RCP<MV> normals = MVT::Clone(like, 1), curvatures = MVT::Clone(like, 1);
    Sets::slipsToVectors(set, *normals, *curvatures);
    archive.vector(name + " slips", *normals);
    archive.vector(name + " curvatures", *curvatures);
    if (archive.isReading())
      Sets::vectorsToSlips(problem.feasibleSet(), *normals, *curvatures, set);
  }
  if (!problem.hasSoftBounds())
    return;
  const Teuchos::RCP<MV> sides = MVT::Clone(like, 1);
  MVT::MvInit(*sides, 0.0);
  SpringOps<Scalar, MV>::toVector(*problem.softBounds(), set, *sides);
  archive.vector(name + " springs", *sides);
  if (archive.isReading())
    SpringOps<Scalar, MV>::fromVector(*problem.softBounds(), *sides, set);
}

} // namespace Harmos::qp
