// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveFace.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>

#include <string>
#include <unordered_map>

namespace Harmos::qp {

/// A face as part of a solver's state, but for couplings, which follow from it: by entry, so that another
/// number of ranks can read it. @note Collective.
template<class Scalar, class MV>
class FaceArchive {
 public:
  /// @param like any vector of the problem.
  FaceArchive(StateArchive<MV>& archive, std::string name, const MV& like)
      : archive_(archive), name_(std::move(name)), like_(like) {}

  void exchange(ActiveFace& face) {
    const std::size_t length = BT::length(like_);
    if (!archive_.isReading())
      face.resize(length, 0);
    std::vector<double> states(face.begin(), face.end());
    column("active set", states);
    if (archive_.isReading())
      face.assign(states.begin(), states.end());
    if (isAnywhere("slips", !face.slipping.empty()))
      exchangeSlips(face);
    if (isAnywhere("springs", !face.springs.empty()))
      exchangeSprings(face);
  }

 private:
  using BT = BoundTraits<Scalar, MV>;
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  static std::size_t place(int entry) { return static_cast<std::size_t>(entry); }

  // A number an entry.
  void column(const std::string& what, std::vector<double>& values) {
    values.resize(BT::length(like_), 0.0);
    const Teuchos::RCP<MV> v = MVT::Clone(like_, 1);
    std::copy(values.begin(), values.end(), BT::write(*v));
    archive_.vector(name_ + " " + what, *v);
    std::copy_n(BT::read(*v), values.size(), values.begin());
  }

  bool isAnywhere(const std::string& what, bool isHere) {
    bool result = !archive_.isReading() && BT::maximum(like_, isHere ? 1.0 : 0.0) > 0.0;
    archive_.number(name_ + " has " + what, result);
    return result;
  }

  void exchangeSlips(ActiveFace& face) {
    const std::size_t n = BT::length(like_);
    // κ and r of a pair at its first and second entry; the second one's number, from 1, at the first.
    std::vector<double> normals(n), centres(n), sizes(n), partners(n);
    for (const Slip& slip : face.slipping) {
      const std::size_t at[] = {place(slip.first), place(slip.second)};
      for (int k : {0, 1}) {
        normals[at[k]] = slip.normal[k];
        centres[at[k]] = slip.centre[k];
      }
      sizes[at[0]] = slip.curvature;
      sizes[at[1]] = slip.radius;
      partners[at[0]] = 1.0 + static_cast<double>(BT::globalIndex(like_, at[1]));
    }
    column("slips", normals);
    column("centres", centres);
    column("curvatures", sizes);
    column("partners", partners);
    if (!archive_.isReading())
      return;
    std::unordered_map<long long, int> local;
    for (std::size_t i = 0; i < n; ++i)
      if (face[i] == ActiveFace::slips)
        local.emplace(BT::globalIndex(like_, i), static_cast<int>(i));
    face.slipping.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (partners[i] > 0.0) {
        const int second = local.at(static_cast<long long>(partners[i]) - 1);
        const std::size_t j = place(second);
        face.slipping.push_back({static_cast<int>(i),
                                 second,
                                 {centres[i], centres[j]},
                                 sizes[j],
                                 {normals[i], normals[j]},
                                 sizes[i]});
      }
  }

  void exchangeSprings(ActiveFace& face) {
    std::vector<double> sides(BT::length(like_)), centres(sides), curvatures(sides);
    for (const Spring& spring : face.springs) {
      sides[place(spring.entry)] = spring.side;
      centres[place(spring.entry)] = spring.centre;
      curvatures[place(spring.entry)] = spring.curvature;
    }
    column("springs", sides);
    column("spring centres", centres);
    column("spring curvatures", curvatures);
    if (!archive_.isReading())
      return;
    face.springs.clear();
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (sides[i] != 0.0)
        face.springs.push_back({static_cast<int>(i), static_cast<int>(sides[i]), centres[i], curvatures[i]});
  }

  StateArchive<MV>& archive_;
  std::string name_;
  const MV& like_;
};

} // namespace Harmos::qp
