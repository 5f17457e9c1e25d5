// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_DeckPlaces.hpp"

#include <map>
#include <utility>

namespace Harmos::effects {

/// How the meshes of two surfaces are brought together.
enum class Coupling {
  Automatic, ///< node to node where the nodes match, else mortar
  Nodes,
  Mortar
};

/// Two boundary parts that face each other: what contacts and ties are about.
struct SurfacePair {
  Part first; ///< the one that carries the multipliers
  Part second;
  Coupling coupling = Coupling::Automatic;
  double reach = 0.0;                    ///< counterparts farther than this are none; 0: automatic
  contact::NormalField normal = nullptr; ///< of the first surface, where it is known

  std::vector<scene::Effect::BoundaryPart> parts() const;

  /// What the points are for: a tie has a row in each direction, whatever the normal.
  enum class Purpose { Contact, Tie };

  /// This rank's points of the first surface that have counterparts; a note tells of those that have none.
  /// Nodes of both surfaces, and those that an effect before holds between the same bodies, have none either:
  /// see contact::FacetMultipliers.
  /// @throws InputError on all ranks, see contact::gatherSurface(), contact::matchNodes() and
  ///         contact::mortarPoints().
  /// @note Collective.
  /// @param gap to be added to those of the points, which a note is about.
  std::vector<contact::ContactPoint> points(scene::ConstraintCollector& collector, Purpose purpose,
                                            double gap = 0.0) const;

  /// How far counterparts on deformed bodies may be. @param gap to be added to distances: bodies that are to
  /// be apart by it, or may overlap, are as near as others.
  double reachFor(const contact::Surface& one, const contact::Surface& other, double gap) const;

  /// Distances of the bodies at rest at those nodes of the first surface that have counterparts there, by
  /// node and side: this rank's. Nothing where the surfaces never meet. @note Collective.
  std::map<std::pair<long long, int>, double> gapsAtRest(scene::ConstraintCollector& collector) const;

  /// Rows that take a distance at rest to be zero turn it with no body: it has to be small at finite
  /// displacements. @param largest of this rank. @param what takes it so. @throws InputError on all ranks
  /// above 1e-4 of the first surface's extent. @note Collective.
  void requireNear(scene::ConstraintCollector& collector, double largest, const std::string& what) const;

  static void addTo(ParameterSpec& spec);
  /// @throws InputError for parts that are not there or are the same one.
  static SurfacePair fromList(const Teuchos::ParameterList& list, const std::string& path,
                              const scene::Scene& scene);
};

} // namespace Harmos::effects
