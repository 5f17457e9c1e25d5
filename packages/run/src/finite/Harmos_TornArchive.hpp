// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <string>

namespace Harmos::run {

/// Displacements of subdomains as part of a checkpoint, by the numbers of the subdomains: another number of
/// ranks can read them.
class TornArchive {
 public:
  /// @param system to outlive it; its subdomains are numbered from rank to rank. @note Collective.
  TornArchive(qp::StateArchive<MultiVector>& archive, const feti::SubdomainSystem& system);

  /// Reading, the vector gets its shape. @note Collective.
  void exchange(const std::string& name, feti::TornVector& values);
  /// Numbers of each subdomain, as many as these have.
  void exchangeNumbers(const std::string& name, feti::TornVector& values);

 private:
  void exchange(const std::string& name, const Teuchos::RCP<const Map>& map, feti::TornVector& values);

  qp::StateArchive<MultiVector>& archive_;
  const feti::SubdomainSystem& system_;
  Teuchos::RCP<const Map> map_;
};

} // namespace Harmos::run
