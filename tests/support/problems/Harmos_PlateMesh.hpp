// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"
#include "Harmos_TestScene.hpp"

#include <functional>
#include <string>
#include <vector>

namespace Harmos {

/// A structured block as one whole mesh, with its named boundary parts, to be cut by hand.
fem::BodyMesh wholeBlock(const fem::StructuredBlock::Options& options);

/// Centre of a cell by its corners.
fem::Point centreOf(const fem::Mesh& mesh, int cell);

/// The number that a function gives to the centre of each cell: a part, or a region.
std::vector<int> cellsBy(const fem::Mesh& mesh, const std::function<int(const fem::Point&)>& number);

/// A body of the cells with a number, nodes numbered anew, keeping the named sides; sides that no longer have
/// a neighbour are named `cut`.
fem::BodyMesh extracted(const fem::BodyMesh& body, const std::vector<int>& number, int wanted,
                        const std::string& cut);

/// A body of a scene, torn as the parts say, on rank 0 as the meshes of files are. Node numbers begin at
/// firstNode, which is moved past them.
scene::Body tornBody(const fem::BodyMesh& body, const std::vector<int>& part, long long& firstNode,
                     const std::vector<fem::Material>& materials);

} // namespace Harmos
