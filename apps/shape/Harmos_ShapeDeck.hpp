// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryParts.hpp"
#include "Harmos_DesignModel.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_ShapeMap.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace Harmos::shape {

/// The list "Shape" of a deck, read: what is designed, for what, and within what.
struct ShapeDeck {
  enum class Kind { Gap, Position };

  Kind kind = Kind::Gap;
  std::set<int> surfaces; ///< effects whose gaps are designed, by their places in the scene
  bool byNodes = true;    ///< a number a contact point; else splines
  std::vector<int> axes;  ///< of the splines; none: those along which the surfaces extend most
  std::vector<int> pieces;
  int degree = 2;
  std::vector<double> start, lower, upper; ///< one for all numbers, or one each; no bounds: none
  // Of positions.
  int body = 0;
  std::string part;
  std::set<int> bodies; ///< that move
  fem::Point direction{};
  double depth = 0.0; ///< 0: all of the bodies
  double leastQuality = 0.2;

  std::string quantity; ///< of the cost
  double exponent = 8.0;
  std::set<int> pressed; ///< effects whose pressure is the cost, and is told
  std::string displacedPart;
  int displacedBody = 0;
  fem::Point displacedDirection{};
  double sign = 1.0; ///< −1: the quantity is to be large

  std::vector<double> volume; ///< none, the value, or least and most
  int mostEvaluations = 0;    ///< 0: no such limit
  double mostSeconds = 0.0;   ///< likewise
  Teuchos::ParameterList optimiser;

  /// Adds the list to a deck's specification.
  static void addTo(ParameterSpec& deck);
  /// From a validated deck. @throws InputError for names that are not there and settings that contradict each
  /// other. Local.
  static ShapeDeck fromDeck(const Teuchos::ParameterList& deck, const scene::Scene& scene);

  /// @throws InputError for boundary parts that bodies do not have, with the nearest one. Local.
  void checkParts(const scene::Scene& scene, const scene::PartNames& names) const;

  /// Splines over points, or over a box. @throws InputError for axes along which they do not extend.
  sensitivity::TensorSplineBasis basis(const scene::Scene& scene, const fem::Point& low,
                                       const fem::Point& high) const;
  /// @param weights of the model. @throws InputError for lists of another length.
  sensitivity::DesignSpace space(const std::vector<double>& weights) const;
};

} // namespace Harmos::shape
