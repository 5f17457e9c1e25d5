// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SizeField.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <vector>

namespace Harmos::run {

/// A cell, and what is estimated of its error.
struct CellError {
  fem::Point centre;
  double size;   ///< of its edges, in the mean
  double square; ///< of its error in the energy norm, or its share of that of a quantity
};

/// Of all cells of all ranks, on every one of them, in an order that does not depend on the ranks. @param
/// squares of the cells of each of this rank's subdomains, see estimateDiscretisationError(). @note
/// Collective.
std::vector<CellError> cellErrors(const Teuchos::Comm<int>& comm,
                                  const std::vector<scene::OwnedSubdomain>& owned,
                                  const std::vector<std::vector<double>>& squares);

/// What a mesh is to be.
struct MeshGoal {
  double error;        ///< in the energy norm
  int order;           ///< p of its elements
  int dimension;       ///< d
  double maximumCells; ///< 0: no limit
  /// Edges that the mesher makes, over what it is asked for.
  double stretch = 1.0;
};

struct NextMesh {
  std::shared_ptr<const fem::SizeField> sizes;
  double cells;                ///< how many there will be, about
  std::vector<double> lengths; ///< of edges at each cell, before sizes grow from cell to cell
};

/// The mesh of fewest cells whose error is what is asked for, if that of a cell goes with its size as η_i² ~
/// h^2p, and their number as h^−d:
///
///     h_i ← r_i h_i,  r_i = C η_i^(−2/(2p+d)),  C^2p Σ η_i^(2d/(2p+d)) = E²
///
/// (all cells then have the same error: Zienkiewicz, Zhu 1987; Li, Bettess, Commun. Numer. Meth. Engng. 11,
/// 1995). Factors are kept from 1/2 to 2: what is estimated on one mesh holds for meshes near to it.
/// Where there would be too many cells, C is the one of as many as there may be.
/// @throws InternalError for no cells. Local. Guarded by tests/unit/run/test_next_mesh.cpp.
NextMesh nextMesh(const std::vector<CellError>& cells, const MeshGoal& goal);

/// The mesh after an answer in which nothing is deformed, of whose errors nothing is known: half the size in
/// cells at these places, where bodies may come to touch.
/// @param stretch as MeshGoal::stretch. Local. Guarded by tests/unit/run/test_next_mesh.cpp.
NextMesh finerAt(const std::vector<CellError>& cells, const std::vector<fem::Point>& places, int dimension,
                 double stretch);

} // namespace Harmos::run
