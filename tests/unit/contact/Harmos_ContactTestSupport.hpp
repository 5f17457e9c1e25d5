// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace Harmos::contact {

using Map = std::function<fem::Point(const fem::Point&)>;

inline fem::StructuredBlock block(fem::CellType type, const fem::Point& origin, const fem::Point& size,
                                  const std::array<int, 3>& subdomains, const std::array<int, 3>& elements,
                                  long long firstNode = 0, const Map& map = nullptr) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.origin = origin;
  options.size = size;
  options.subdomains = subdomains;
  options.elements = elements;
  options.firstNode = firstNode;
  options.map = map;
  return fem::StructuredBlock(options);
}

/// Each rank by itself.
inline const Teuchos::Comm<int>& aloneComm() {
  static const Teuchos::MpiComm<int> comm(MPI_COMM_SELF);
  return comm;
}

/// All subdomains of a body, and on several ranks those of one: s with s mod ranks = rank.
inline std::vector<fem::PlacedMesh> share(const fem::StructuredBlock& body, int rank = 0, int ranks = 1) {
  std::vector<fem::PlacedMesh> meshes;
  for (int s = rank; s < body.numberOfSubdomains(); s += ranks)
    meshes.push_back(body.subdomain(s));
  return meshes;
}

/// Of the meshes that are here: without a communicator a whole surface on each rank; see test_pieces.cpp for
/// pieces.
inline Surface gather(const std::vector<fem::PlacedMesh>& meshes, const std::string& set,
                      const std::string& name, const NormalField& field = nullptr,
                      const Teuchos::Comm<int>& comm = aloneComm()) {
  std::vector<const fem::PlacedMesh*> parts;
  for (const fem::PlacedMesh& mesh : meshes)
    parts.push_back(&mesh);
  return gatherSurface(comm, parts, set, name, field);
}

inline Surface surfaceOf(const fem::StructuredBlock& body, const std::string& set,
                         const NormalField& field = nullptr) {
  return gather(share(body), set, "body/" + set, field);
}

/// The message of an InputError, or nothing.
template<class Work>
std::string messageOf(Work&& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline std::map<long long, fem::Point> positionsOf(const Surface& first, const Surface& second) {
  std::map<long long, fem::Point> positions;
  for (const Surface* surface : {&first, &second})
    for (std::size_t i = 0; i < surface->numbers.size(); ++i)
      positions[surface->numbers[i]] = surface->positions[i];
  return positions;
}

/// Largest |Σ weight · u(x)| of a row, by the sum of its |weight| and the size of u.
inline double rowError(const std::vector<ContactPoint>& points, const Surface& first, const Surface& second,
                       const std::function<double(const fem::Point&)>& u) {
  const auto positions = positionsOf(first, second);
  double size = 0.0, error = 0.0;
  for (const auto& item : positions)
    size = std::max(size, std::abs(u(item.second)));
  for (const ContactPoint& point : points) {
    double sum = 0.0, weights = 0.0;
    for (const ContactPoint::Term& term : point.terms) {
      sum += term.weight * u(positions.at(term.node));
      weights += std::abs(term.weight);
    }
    error = std::max(error, std::abs(sum) / (size * weights));
  }
  return error;
}

/// Rounding of a row: it comes from a factorisation of at most nine columns whose condition is below 100
/// where a tenth of a facet or more is covered, and sums of some hundred terms.
constexpr double rounding = 1e-12;

/// ∫ over the common part of 1 and of x, as the multipliers of the points see it: Σ area · weight and that
/// times x, over the nodes of one surface.
struct Resultant {
  double force = 0.0;
  fem::Point moment{};
};
inline Resultant resultantOf(const std::vector<ContactPoint>& points, const Surface& surface) {
  std::map<long long, fem::Point> positions;
  for (std::size_t i = 0; i < surface.numbers.size(); ++i)
    positions[surface.numbers[i]] = surface.positions[i];
  Resultant result;
  for (const ContactPoint& point : points)
    for (const ContactPoint::Term& term : point.terms) {
      const auto place = positions.find(term.node);
      if (place == positions.end())
        continue;
      const double force = point.area * term.weight;
      result.force += force;
      result.moment = sum(result.moment, scaled(force, place->second));
    }
  return result;
}

/// Surfaces of the same nodes: in a point of a node both have the same weights, with opposite signs; but on
/// triangles of six nodes a node and its partner alone.
inline void expectMatched(const std::vector<ContactPoint>& mortar, const std::vector<ContactPoint>& matched,
                          const Surface& first) {
  std::map<long long, long long> partner;
  for (const ContactPoint& point : matched)
    for (const ContactPoint::Term& term : point.terms)
      if (term.node != point.node)
        partner[point.node] = term.node;
  std::map<long long, std::map<long long, double>> wanted; // of the nodes of the first surface
  std::array<double, 4> shares{};
  shares.fill(Carriers::usualShare(first.facetType));
  const Carriers carriers(first.facetType, shares, false);
  for (int f = 0; f < first.numberOfFacets(); ++f) {
    const Facet facet(first, f);
    for (std::size_t k = 0; k < facet.size(); ++k)
      for (const auto& [i, weight] : carriers.coefficient(k)) {
        std::map<long long, double>& row = wanted[first.numbers[facet.node(k)]];
        row[first.numbers[facet.node(i)]] = weight;
        row[partner.at(first.numbers[facet.node(i)])] = -weight;
      }
  }
  ASSERT_EQ(mortar.size(), matched.size());
  double area = 0.0, whole = 0.0;
  for (std::size_t k = 0; k < mortar.size(); ++k) {
    EXPECT_EQ(mortar[k].node, matched[k].node);
    EXPECT_LT(norm(difference(mortar[k].normal, matched[k].normal)), rounding);
    area += mortar[k].area;
    whole += matched[k].area;
    const std::map<long long, double>& row = wanted.at(mortar[k].node);
    ASSERT_EQ(mortar[k].terms.size(), row.size());
    for (const ContactPoint::Term& term : mortar[k].terms)
      EXPECT_NEAR(term.weight, row.at(term.node), rounding);
  }
  EXPECT_NEAR(area, whole, rounding);
}

inline fem::Point rotated(const fem::Point& x, double angle) {
  return {std::cos(angle) * x[0] - std::sin(angle) * x[1], std::sin(angle) * x[0] + std::cos(angle) * x[1],
          x[2]};
}

} // namespace Harmos::contact
