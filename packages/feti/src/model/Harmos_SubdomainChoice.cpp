// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainChoice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti {
namespace {

// Of a compact part in nodes.
struct PartNodes {
  double all, boundary;
};

PartNodes nodesOf(const WholeBodies& bodies, double parts) {
  const double m = bodies.nodes / parts;
  if (parts <= 1.0)
    return {m, 0.0};
  const double power = 1.0 / bodies.dimension, sides = bodies.dimension == 3 ? 6.0 : 4.0;
  const double all = m * (1.0 + bodies.dimension * std::pow(m, -power));
  return {all, std::min(all, sides * std::pow(m, 1.0 - power))};
}

double entriesOf(const WholeBodies& bodies, double nodes) {
  const double c2 = bodies.dofsPerNode * bodies.dofsPerNode;
  const double dense = 0.5 * c2 * nodes * nodes; // of few nodes
  const double sparse = bodies.dimension == 3
                            ? 5.5 * c2 * std::pow(nodes, 4.0 / 3.0)
                            : c2 * nodes * std::max(5.0, 3.4 * std::log2(std::max(nodes, 2.0)) - 13.0);
  return std::min(dense, sparse);
}

// Factorisations take the squares of columns' lengths.
double flopsOf(double entries, double rows) {
  return entries * entries / std::max(rows, 1.0);
}

double motionsOf(const WholeBodies& bodies) {
  return bodies.dofsPerNode == 1 ? 1.0 : bodies.dimension == 3 ? 6.0 : 3.0;
}

struct Prediction {
  double seconds, bytes;
};

Prediction predictParts(const WholeBodies& bodies, int ranks, double parts, const MachineRates& rates) {
  constexpr int products = 30, sets = 10;
  constexpr double onAll = 1.8e-3, shared = 4.4e-3; // seconds of a part with six motions
  const double ofRank = std::ceil(parts / ranks), motions = motionsOf(bodies);
  const FactorizationEstimate part = typicalPart(bodies, parts);
  StepShape shape;
  shape.ranks = ranks;
  shape.rows = 0.5 * part.boundary * ofRank;
  shape.sharedRows = ranks > 1 ? 6.0 * std::pow(shape.rows, 2.0 / 3.0) : 0.0;
  shape.neighbours = std::min(ranks - 1, 8);
  shape.coarseDimension = motions * parts;
  shape.motions = motions;
  shape.ownMotions = motions * ofRank;
  const bool isDistributed = isDistributedCheaper(shape.coarse(), StepRates());
  const double coarse = isDistributed ? 0.0 : coarseFactorEntries(shape.coarse());
  const double ofCoarse = (onAll * (isDistributed ? ofRank : parts) + shared * ofRank) * motions / 6.0 +
                          sets * flopsOf(coarse, shape.coarseDimension) / rates.schurFlops;
  shape.isCoarseDistributed = isDistributed;
  const double step = predictStep(shape).sum();
  Prediction best = {std::numeric_limits<double>::infinity(), 0.0};
  for (const DualForms& forms : dualForms()) {
    const FormPrediction p = predict(forms, part, 1, Precision::Double, rates, true);
    const double seconds = ofRank * p.seconds(products) + products * p.relativeProducts * step + ofCoarse;
    if (seconds < best.seconds)
      best = {seconds, ofRank * p.bytes};
  }
  return best;
}

} // namespace

FactorizationEstimate typicalPart(const WholeBodies& bodies, double parts) {
  const PartNodes nodes = nodesOf(bodies, parts);
  const double c = bodies.dofsPerNode, inner = nodes.all - nodes.boundary;
  FactorizationEstimate part;
  part.rows = static_cast<int>(c * nodes.all);
  part.boundary = static_cast<int>(c * nodes.boundary);
  part.entries = entriesOf(bodies, nodes.all);
  part.flops = flopsOf(part.entries, part.rows);
  part.interiorEntries = entriesOf(bodies, inner);
  part.interiorFlops = flopsOf(part.interiorEntries, c * inner);
  part.schurFlops = part.interiorFlops + part.boundary * 1.0 * part.boundary * part.boundary / 3.0 +
                    2.0 * part.interiorEntries * part.boundary;
  // Of the nodes that an equation at the boundary couples, some three fifths are there too.
  part.blockEntries = 0.6 * part.boundary * c * bodies.stencil;
  part.couplingEntries = 0.4 * part.boundary * c * bodies.stencil;
  return part;
}

SubdomainChoice chooseSubdomains(const WholeBodies& bodies, int ranks, double memoryMiB,
                                 const MachineRates& rates) {
  constexpr double leastNodes = 30.0, mebi = 1048576.0;
  const double mostParts = std::max(1.0, std::floor(bodies.nodes / leastNodes));
  SubdomainChoice best = {1, std::numeric_limits<double>::infinity()}, leanest = best;
  double leastBytes = std::numeric_limits<double>::infinity();
  for (int doubled = 1; doubled < (1 << 24); doubled *= 2)
    for (int k : {doubled, 3 * doubled / 2}) {
      const double parts = std::min(static_cast<double>(k) * ranks, mostParts);
      const Prediction p = predictParts(bodies, ranks, parts, rates);
      const SubdomainChoice choice = {static_cast<int>(parts), p.seconds};
      if (p.bytes < leastBytes) {
        leastBytes = p.bytes;
        leanest = choice;
      }
      if (p.seconds < best.seconds && (memoryMiB <= 0.0 || p.bytes <= memoryMiB * mebi))
        best = choice;
      if (parts == mostParts)
        return std::isfinite(best.seconds) ? best : leanest;
    }
  return std::isfinite(best.seconds) ? best : leanest;
}

} // namespace Harmos::feti
