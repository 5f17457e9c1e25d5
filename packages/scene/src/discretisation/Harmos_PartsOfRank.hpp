// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Harmos::scene {

/// This rank's subdomains by body and boundary part: scenes may have thousands of parts. The subdomains have
/// to outlive it.
class PartsOfRank {
 public:
  explicit PartsOfRank(const std::vector<OwnedSubdomain>& owned);

  /// Body and boundary part.
  using Part = std::pair<int, std::string>;
  /// Those with sides, and with nodes, of a part; none where it is not here.
  const std::vector<const fem::PlacedMesh*>& withSides(const Part& part) const;
  const std::vector<const OwnedSubdomain*>& withNodes(const Part& part) const;
  /// All of a body.
  std::vector<const fem::PlacedMesh*> of(int body) const;

 private:
  const std::vector<OwnedSubdomain>& owned_;
  std::map<Part, std::vector<const fem::PlacedMesh*>> sides_;
  std::map<Part, std::vector<const OwnedSubdomain*>> nodes_;
};

} // namespace Harmos::scene
