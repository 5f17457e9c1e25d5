// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"
#include "Harmos_BoxTree.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FacetMultipliers.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_MortarSamples.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

namespace Harmos::contact {
namespace {

using fem::Box;
using fem::BoxTree;
using fem::Point;

using Values = std::array<double, maxFacetNodes>; // of the functions of a facet

// What is gathered for a node of the first surface, not yet divided by D_ii.
struct NodeSums {
  double area = 0.0;                             // D_i
  double magnitude = 0.0;                        // ∫|ψ_i|
  double gap = 0.0;                              // ∫ψ_i g
  std::map<long long, double> others;            // M_ik
  std::vector<std::pair<long long, double>> own; // D_ij / D_i on facets all of whose nodes bear multipliers
  std::map<long long, double> ownBeside;         // D_ij = ∫ψ_i φ_j on others,
  double areaBeside = 0.0;                       // and what D_i has of them
};

// For each function j of a facet its dual function divided by ∫φ_j, at each sample: result[j][q] with
// Σ_q weight_q result[j][q] φ_k(q) = δ_jk.
//
// These are the rows of M⁻¹Φ. From a QR factorisation of the weighted values rather than from the mass matrix
// M itself, whose condition is the square: little of a facet may be covered. None if the samples do not
// determine it.
std::optional<std::vector<std::vector<double>>>
dualFunctions(const std::vector<MortarSample>& samples, const std::vector<Values>& values, std::size_t n) {
  std::vector<std::vector<double>> q(n, std::vector<double>(samples.size()));
  std::vector<std::vector<double>> r(n, std::vector<double>(n, 0.0));
  for (std::size_t j = 0; j < n; ++j) {
    double before = 0.0;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      q[j][s] = std::sqrt(samples[s].weight) * values[s][j];
      before += q[j][s] * q[j][s];
    }
    for (int pass = 0; pass < 2; ++pass) // twice is enough (Kahan, Parlett)
      for (std::size_t i = 0; i < j; ++i) {
        double product = 0.0;
        for (std::size_t s = 0; s < samples.size(); ++s)
          product += q[i][s] * q[j][s];
        r[i][j] += product;
        for (std::size_t s = 0; s < samples.size(); ++s)
          q[j][s] -= product * q[i][s];
      }
    double after = 0.0;
    for (double x : q[j])
      after += x * x;
    if (!(after > 1e-20 * before) || !(before > 0.0))
      return std::nullopt;
    r[j][j] = std::sqrt(after);
    for (double& x : q[j])
      x /= r[j][j];
  }
  // R⁻¹Qᵀ from the last row up.
  for (std::size_t j = n; j-- > 0;)
    for (std::size_t s = 0; s < samples.size(); ++s) {
      for (std::size_t k = j + 1; k < n; ++k)
        q[j][s] -= r[j][k] * q[k][s];
      q[j][s] /= r[j][j];
    }
  for (std::vector<double>& row : q)
    for (std::size_t s = 0; s < samples.size(); ++s)
      row[s] /= std::sqrt(samples[s].weight);
  return q;
}

// How the facets of the first surface carry multipliers.
class SurfaceCarriers {
 public:
  explicit SurfaceCarriers(const Surface& surface)
      : surface_(surface),
        share_(surface.numbers.size(), Carriers::usualShare(surface.facetType, surface.isAxisymmetric)),
        isPartial_(static_cast<std::size_t>(surface.numberOfFacets()), false) {}

  bool dependOnCoverage() const { return fem::shapeOf(surface_.facetType).order > 1; }

  void setCovered(int facet, const std::vector<MortarSample>& samples) {
    double covered = 0.0;
    for (const MortarSample& sample : samples)
      covered += sample.weight;
    if (samples.empty() || covered > mostPartial * areaOf(facet))
      return;
    isPartial_[static_cast<std::size_t>(facet)] = true;
    const Facet nodes(surface_, facet);
    for (std::size_t k = nodes.corners(); k < nodes.size(); ++k)
      share_[nodes.node(k)] = Carriers::partialShare(surface_.facetType);
  }

  // What other ranks have seen of the edges of these facets. @note Collective.
  void share(const std::vector<int>& facets) {
    std::vector<std::pair<long long, char>> known;
    std::vector<std::size_t> places;
    std::vector<long long> asked;
    for (std::size_t i = 0; i < share_.size(); ++i)
      if (share_[i] == Carriers::partialShare(surface_.facetType))
        known.emplace_back(surface_.numbers[i], 1);
    for (int f : facets) {
      const Facet nodes(surface_, f);
      for (std::size_t k = nodes.corners(); k < nodes.size(); ++k) {
        places.push_back(nodes.node(k));
        asked.push_back(surface_.numbers[nodes.node(k)]);
      }
    }
    const auto answers = lookUp(*surface_.comm, known, asked);
    for (std::size_t k = 0; k < places.size(); ++k)
      if (answers[k])
        share_[places[k]] = Carriers::partialShare(surface_.facetType);
  }

  Carriers of(int facet) const {
    const Facet nodes(surface_, facet);
    std::array<double, 4> shares{};
    for (std::size_t e = 0; e < shares.size() && nodes.corners() + e < nodes.size(); ++e)
      shares[e] = share_[nodes.node(nodes.corners() + e)];
    return {surface_.facetType, shares, isPartial_[static_cast<std::size_t>(facet)]};
  }

 private:
  // Where a fiftieth is missing all areas are positive still; sides of facets, taken as straight, hide some
  // thousandths.
  static constexpr double mostPartial = 0.98;

  double areaOf(int f) const {
    const Facet facet(surface_, f);
    const fem::Quadrature rule = fem::quadratureOn(surface_.facetType, 4);
    double area = 0.0;
    for (std::size_t q = 0; q < rule.points.size(); ++q)
      area += rule.weights[q] * facet.at({rule.points[q][0], rule.points[q][1]}).measure;
    return area;
  }

  const Surface& surface_;
  std::vector<double> share_; // of edge nodes
  std::vector<bool> isPartial_;
};

// What a facet gives to the sums of its nodes.
class FacetSums {
 public:
  FacetSums(const std::vector<MortarSample>& samples, const Facet& facet, const Carriers& carriers,
            const FacetMultipliers& multipliers, const Surface& first, const Surface& second)
      : samples_(samples),
        facet_(facet),
        carriers_(carriers),
        multipliers_(multipliers),
        first_(first),
        second_(second) {
    for (const MortarSample& sample : samples) {
      HARMOS_REQUIRE(sample.weight > 0.0, "mortar quadrature needs positive weights");
      functions_.push_back(facetBasis(first.facetType, sample.place).values);
      own_.push_back(multipliers.values(carriers.values(functions_.back())));
      opposite_.push_back(facetBasis(second.facetType, sample.oppositePlace).values);
    }
    duals_ = dualFunctions(samples, own_, multipliers.nodes().size());
  }

  /// Where no node of the facet bears a multiplier: a constant one on it, which is the mean of those of the
  /// nodes next to it.
  static NodeSums constant(const std::vector<MortarSample>& samples, const Facet& facet, const Surface& first,
                           const Surface& second) {
    NodeSums sum;
    for (const MortarSample& sample : samples) {
      const Values own = facetBasis(first.facetType, sample.place).values;
      const Values opposite = facetBasis(second.facetType, sample.oppositePlace).values;
      const Facet other(second, sample.opposite);
      sum.area += sample.weight;
      sum.gap += sample.weight * sample.gap;
      for (std::size_t k = 0; k < facet.size(); ++k)
        sum.ownBeside[first.numbers[facet.node(k)]] += sample.weight * own[k];
      for (std::size_t k = 0; k < other.size(); ++k)
        sum.others[second.numbers[other.node(k)]] += sample.weight * opposite[k];
    }
    sum.areaBeside = sum.magnitude = sum.area;
    return sum;
  }

  /// @param sumAt where the sums of each node of the first surface are.
  void addTo(std::vector<NodeSums>& sums, const std::vector<std::size_t>& sumAt) const {
    for (std::size_t j = 0; duals_ && j < multipliers_.nodes().size(); ++j) {
      const std::size_t k = multipliers_.nodes()[j];
      NodeSums& sum = sums[sumAt[facet_.node(k)]];
      if (multipliers_.isWhole() && sum.own.empty())
        for (const auto& [place, weight] : carriers_.coefficient(k))
          sum.own.emplace_back(first_.numbers[facet_.node(place)], weight);
      add(j, sum);
    }
  }

 private:
  void add(std::size_t j, NodeSums& sum) const {
    double area = 0.0;
    for (std::size_t q = 0; q < samples_.size(); ++q)
      area += samples_[q].weight * own_[q][j];
    sum.area += area;
    if (!multipliers_.isWhole())
      sum.areaBeside += area;
    const auto others = static_cast<std::size_t>(second_.nodesPerFacet());
    for (std::size_t q = 0; q < samples_.size(); ++q) {
      const double weight = area * samples_[q].weight * (*duals_)[j][q];
      sum.magnitude += std::abs(weight);
      sum.gap += weight * samples_[q].gap;
      const Facet other(second_, samples_[q].opposite);
      for (std::size_t k = 0; k < others; ++k)
        sum.others[second_.numbers[other.node(k)]] += weight * opposite_[q][k];
      for (std::size_t k = 0; k < facet_.size() && !multipliers_.isWhole(); ++k)
        sum.ownBeside[first_.numbers[facet_.node(k)]] += weight * functions_[q][k];
    }
  }

  const std::vector<MortarSample>& samples_;
  const Facet& facet_;
  const Carriers& carriers_;
  const FacetMultipliers& multipliers_;
  const Surface &first_, &second_;
  std::vector<Values> functions_, own_, opposite_; // at each sample
  std::optional<std::vector<std::vector<double>>> duals_;
};

// Where counterparts of a facet may be: along the normals alone, for the reach may be many facets wide.
Box boxWithin(const Surface& surface, int f, double reach) {
  const Facet facet(surface, f);
  const Point areaNormal = facet.at(facetCentre(surface.facetType)).areaNormal;
  const Point middle = scaled(1.0 / norm(areaNormal), areaNormal);
  std::vector<Point> points;
  for (std::size_t k = 0; k < facet.size(); ++k)
    for (const Point& normal : {surface.normals[facet.node(k)], middle})
      for (double side : {-1.1, 1.1}) // a little more, as normals between the nodes differ from these
        points.push_back(sum(facet.position(k), scaled(side * reach, normal)));
  return boxOfFacet(surface, f, points);
}

// The same in pieces along the normals, where a box along the axes would hold much that is not opposite: the
// reach may be many facets wide, and normals lie across the axes. In space: there candidates that are not
// opposite say nothing, in the plane they may cut a facet where it need not be.
void addBoxesWithin(const Surface& surface, int f, double reach, std::vector<Box>& boxes) {
  constexpr double slender = 4.0; // times the facet
  constexpr int mostPieces = 32;
  const Box whole = boxWithin(surface, f, reach), own = boxOfFacet(surface, f);
  Point extents = difference(whole.high, whole.low);
  std::sort(extents.begin(), extents.end());
  const double size = norm(difference(own.high, own.low));
  if (surface.dimension == 2 || extents[1] <= slender * size) {
    boxes.push_back(whole);
    return;
  }
  const Facet facet(surface, f);
  const Point areaNormal = facet.at(facetCentre(surface.facetType)).areaNormal;
  const Point middle = scaled(1.0 / norm(areaNormal), areaNormal);
  const int pieces = std::min(mostPieces, static_cast<int>(std::ceil(2.0 * extents[1] / (slender * size))));
  for (int piece = 0; piece < pieces; ++piece) {
    std::vector<Point> points;
    for (std::size_t k = 0; k < facet.size(); ++k)
      for (const Point& normal : {surface.normals[facet.node(k)], middle})
        for (int end : {piece, piece + 1})
          points.push_back(sum(facet.position(k), scaled(1.1 * reach * (2.0 * end / pieces - 1.0), normal)));
    boxes.push_back(fem::widened(fem::boxAround(points), 0.5 * size)); // bulges among it
  }
}

double extent(const Surface& surface) {
  const Point size = difference(surface.wholeBox.high, surface.wholeBox.low);
  return std::max({size[0], size[1], size[2]});
}

void requireSupported(const Surface& first, const Surface& second, double reach) {
  const std::string both = first.name + " and " + second.name;
  if (first.dimension != second.dimension)
    throw InputError(both + ": one surface is in the plane and the other in space");
  if (!(reach >= 0.0))
    throw InputError(both + ": invalid reach " + std::to_string(reach) +
                     "; give a positive distance, or 0 for a tenth of the smaller surface");
}

// Rows that magnify the displacement of the other surface more than this stem from nodes with a hair's
// breadth of coverage at the far end of a facet; they would spoil the condition of the problem for no force
// at all.
constexpr double mostMagnification = 1e4;
constexpr double leastCoverage = 1e-8;
// Weights that are rounding errors: of sums, and of coordinates, which have ε of their distance from the
// origin.
constexpr double negligibleWeight = 1e-13;

double farthestOf(const Surface& surface) {
  double farthest = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    farthest = std::max({farthest, std::abs(surface.wholeBox.low[d]), std::abs(surface.wholeBox.high[d])});
  return farthest;
}

// The points of this rank's own nodes.
class MortarPieces {
 public:
  /// @param first with its sides apart.
  MortarPieces(const Surface& first, const Surface& second, double reach, const MortarOptions& options)
      : first_(first), reach_(reach), carriers_(first) {
    std::vector<Box> boxes;
    agree(*first.comm, [&] {
      setPlaces(options);
      for (int f = 0; f < first.numberOfFacets(); ++f) {
        const Facet facet(first, f);
        bool isAtOwn = false;
        for (std::size_t k = 0; k < facet.size(); ++k)
          isAtOwn = isAtOwn || first.isOwnNode[facet.node(k)] != 0;
        if (isAtOwn)
          atOwn_.push_back(f);
        // Of own facets others want to know whether they are covered as a whole, and have what is passed on.
        if (isAtOwn || ((carriers_.dependOnCoverage() || !options.without.empty()) &&
                        first.isOwnFacet[static_cast<std::size_t>(f)] != 0))
          sampled_.push_back(f);
      }
      for (int f : sampled_)
        addBoxesWithin(first, f, reach, boxes);
    });
    near_ = facetsTouching(second, boxes);
    agree(*first.comm, [&] {
      boxes.clear();
      for (int f = 0; f < near_.numberOfFacets(); ++f)
        boxes.push_back(boxOfFacet(near_, f));
      tree_ = BoxTree(boxes);
    });
  }

  // In the order of the nodes. @note Collective.
  std::vector<ContactPoint> points(double farthest) {
    // Twice, since samples of all facets at once may take more memory than the bodies.
    if (carriers_.dependOnCoverage()) {
      agree(*first_.comm, [&] {
        for (int f : sampled_)
          carriers_.setCovered(f, samplesOf(f));
      });
      carriers_.share(atOwn_);
    }
    std::vector<NodeSums> sums;
    agree(*first_.comm, [&] { sums = sumsOfNodes(); });
    addPassedOn(sums);
    std::vector<ContactPoint> result;
    agree(*first_.comm, [&] {
      const std::vector<double> whole = tributaryAreas(first_);
      const double unit = 10.0 * std::numeric_limits<double>::epsilon() * farthest;
      for (std::size_t i = 0; i < sums.size(); ++i)
        if (first_.isOwnNode[i] != 0 && sums[i].area > leastCoverage * whole[i] &&
            sums[i].magnitude <= mostMagnification * sums[i].area)
          if (ContactPoint point = pointOf(i, sums[i], unit); !point.terms.empty())
            result.push_back(std::move(point));
      addBeside(result);
    });
    return result;
  }

 private:
  void setPlaces(const MortarOptions& options) {
    for (std::size_t i = 0; i < first_.numbers.size(); ++i) {
      const long long number = first_.numbers[i];
      const bool isCopy = options.joinsEdges && i > 0 && first_.numbers[i - 1] == number;
      sumAt_.push_back(isCopy ? sumAt_.back() : i);
      without_.push_back(std::binary_search(options.without.begin(), options.without.end(), number) ? 1 : 0);
    }
  }

  // Nodes without a multiplier next to points, with what carriers get of theirs; see FacetMultipliers.
  void addBeside(std::vector<ContactPoint>& points) const {
    std::map<std::pair<long long, int>, std::map<long long, double>> shares;
    for (int f : atOwn_) {
      const Facet facet(first_, f);
      const FacetMultipliers multipliers(facet, without_);
      for (std::size_t x = 0; x < facet.size() && !multipliers.isWhole(); ++x)
        for (std::size_t j = 0; j < multipliers.nodes().size() && without_[facet.node(x)] != 0; ++j)
          if (const double share = multipliers.sharesOf(x)[j]; share > 0.0) {
            const std::size_t heir = sumAt_[facet.node(multipliers.nodes()[j])];
            shares[{first_.numbers[heir], sideOf(heir)}][first_.numbers[facet.node(x)]] += share;
          }
    }
    for (ContactPoint& point : points)
      if (const auto found = shares.find({point.node, point.side}); found != shares.end())
        for (const auto& [node, share] : found->second)
          point.beside.push_back({node, share});
  }

  // A part of the sums of a node, on its way from the rank of a facet.
  struct Part {
    std::array<long long, 4> facet; // nodes of it, which tell the order of the parts
    long long heir, node;           // node: that D or M is about
    int side, kind;                 // of the heir; 0: area and gap, 1: D, 2: M
    double value, gap;
    bool operator<(const Part& other) const {
      return std::tie(facet, heir, side, kind, node) <
             std::tie(other.facet, other.heir, other.side, other.kind, other.node);
    }
  };

  int sideOf(std::size_t place) const {
    int side = 0;
    for (std::size_t k = place; k > 0 && first_.numbers[k - 1] == first_.numbers[place]; --k)
      ++side;
    return side;
  }

  // Nodes with multipliers on the facets that have a node in common with this one.
  std::vector<std::size_t> heirsOf(int f) const {
    const Facet facet(first_, f);
    std::vector<std::size_t> heirs;
    for (int g = 0; g < first_.numberOfFacets(); ++g) {
      const Facet beside(first_, g);
      bool touches = false;
      for (std::size_t j = 0; j < facet.size(); ++j)
        for (std::size_t k = 0; k < beside.size(); ++k)
          touches = touches || facet.node(j) == beside.node(k);
      for (std::size_t k = 0; k < beside.size() && touches; ++k)
        if (without_[beside.node(k)] == 0)
          heirs.push_back(beside.node(k));
    }
    std::sort(heirs.begin(), heirs.end());
    heirs.erase(std::unique(heirs.begin(), heirs.end()), heirs.end());
    return heirs;
  }

  // Of this rank's facets without any multiplier: such are few.
  std::vector<Part> partsToPassOn() const {
    std::vector<Part> parts;
    if (std::find(without_.begin(), without_.end(), 1) == without_.end())
      return parts;
    for (int f = 0; f < first_.numberOfFacets(); ++f) {
      const Facet facet(first_, f);
      if (first_.isOwnFacet[static_cast<std::size_t>(f)] == 0 ||
          !FacetMultipliers(facet, without_).nodes().empty())
        continue;
      const std::vector<MortarSample> samples = samplesOf(f);
      const std::vector<std::size_t> heirs = heirsOf(f);
      const NodeSums sum = FacetSums::constant(samples, facet, first_, near_);
      Part part{};
      for (std::size_t k = 0; k < std::min<std::size_t>(4, facet.size()); ++k)
        part.facet[k] = first_.numbers[facet.node(k)];
      const double share = 1.0 / static_cast<double>(heirs.size());
      for (std::size_t heir : heirs) {
        part.heir = first_.numbers[heir];
        part.side = sideOf(heir);
        const auto add = [&](int kind, long long node, double value, double gap) {
          part.kind = kind;
          part.node = node;
          part.value = share * value;
          part.gap = share * gap;
          parts.push_back(part);
        };
        add(0, 0, sum.area, sum.gap);
        for (const auto& [node, value] : sum.ownBeside)
          add(1, node, value, 0.0);
        for (const auto& [node, value] : sum.others)
          add(2, node, value, 0.0);
      }
    }
    return parts;
  }

  // @note Collective.
  void addPassedOn(std::vector<NodeSums>& sums) const {
    std::vector<Part> parts;
    agree(*first_.comm, [&] { parts = partsToPassOn(); });
    parts = gatherAll(*first_.comm, parts);
    std::sort(parts.begin(), parts.end());
    for (const Part& part : parts) {
      const auto at = std::lower_bound(first_.numbers.begin(), first_.numbers.end(), part.heir);
      const auto place = static_cast<std::size_t>(at - first_.numbers.begin() + part.side);
      if (place >= sums.size() || first_.numbers[place] != part.heir || first_.isOwnNode[place] == 0)
        continue;
      NodeSums& sum = sums[sumAt_[place]];
      if (part.kind == 0) {
        sum.area += part.value;
        sum.areaBeside += part.value;
        sum.magnitude += std::abs(part.value);
        sum.gap += part.gap;
      } else {
        (part.kind == 1 ? sum.ownBeside : sum.others)[part.node] += part.value;
      }
    }
  }

  std::vector<NodeSums> sumsOfNodes() const {
    std::vector<NodeSums> sums(first_.numbers.size());
    for (int f : atOwn_) {
      const Facet facet(first_, f);
      const FacetMultipliers multipliers(facet, without_);
      if (multipliers.nodes().empty())
        continue;
      if (const std::vector<MortarSample> samples = samplesOf(f); !samples.empty())
        FacetSums(samples, facet, carriers_.of(f), multipliers, first_, near_).addTo(sums, sumAt_);
    }
    return sums;
  }

  std::vector<MortarSample> samplesOf(int f) const {
    const std::vector<int> candidates = tree_.touching(boxWithin(first_, f, reach_));
    if (candidates.empty())
      return {};
    return first_.dimension == 2 ? planeSamples(first_, f, near_, candidates, reach_)
                                 : spaceSamples(first_, f, near_, candidates, reach_);
  }

  // D_ij / D_i.
  static std::map<long long, double> ownWeights(const NodeSums& sum, double negligible) {
    std::map<long long, double> weights(sum.own.begin(), sum.own.end());
    if (sum.ownBeside.empty())
      return weights;
    for (auto& [node, weight] : weights)
      weight *= (sum.area - sum.areaBeside) / sum.area;
    for (const auto& [node, integral] : sum.ownBeside)
      if (std::abs(integral) > negligible * sum.area)
        weights[node] += integral / sum.area;
    return weights;
  }

  ContactPoint pointOf(std::size_t i, const NodeSums& sum, double unit) const {
    const double size = first_.dimension == 2 ? sum.area : std::sqrt(sum.area);
    const double negligible = std::max(negligibleWeight, unit / size);
    ContactPoint point;
    point.node = first_.numbers[i];
    point.side = sideOf(i);
    point.position = first_.positions[i];
    std::map<long long, double> weights = ownWeights(sum, negligible);
    for (const auto& [node, integral] : sum.others) {
      if (std::abs(integral) <= negligible * sum.area)
        continue;
      double& weight = weights[node];
      const double own = weight;
      weight -= integral / sum.area;
      // A node of both surfaces: of what cancels there, rounding errors are left.
      if (own != 0.0 && std::abs(weight) <= 10.0 * negligible * std::abs(own))
        weights.erase(node);
    }
    for (const auto& [node, weight] : weights)
      point.terms.push_back({node, weight});
    point.normal = first_.normals[i];
    point.gap = sum.gap / sum.area;
    point.area = sum.area;
    return point;
  }

  const Surface& first_;
  double reach_;
  SurfaceCarriers carriers_;
  std::vector<std::size_t> sumAt_;   // of each node: where its sums are
  std::vector<char> without_;        // of each node: whether it has no multiplier
  std::vector<int> atOwn_, sampled_; // facets: those around own nodes, and all whose samples are wanted
  Surface near_;                     // facets of the second surface
  BoxTree tree_{{}};
};

} // namespace

double reachOf(const Surface& first, const Surface& second, double given) {
  return given > 0.0 ? given : 0.1 * std::min(extent(first), extent(second));
}

std::vector<ContactPoint> mortarPoints(const Surface& first, const Surface& second,
                                       const MortarOptions& options) {
  requireSupported(first, second, options.reach);
  const double distance = reachOf(first, second, options.reach);
  Surface sides;
  agree(*first.comm, [&] { sides = splitAtEdges(first); });
  const std::vector<ContactPoint> points =
      MortarPieces(sides, second, distance, options).points(std::max(farthestOf(first), farthestOf(second)));
  if (!options.mayBeApart && globalMax(*first.comm, static_cast<long long>(points.size())) == 0)
    throw InputError(first.name + " and " + second.name +
                     ": the surfaces never meet: no facet of the first faces a facet of the second within " +
                     scientific(distance) + "; check positions and names or give a longer reach");
  return points;
}

std::vector<ContactPoint> mortarPoints(const Surface& first, const Surface& second, double reach) {
  MortarOptions options;
  options.reach = reach;
  return mortarPoints(first, second, options);
}

} // namespace Harmos::contact
