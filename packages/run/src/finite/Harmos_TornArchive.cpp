// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TornArchive.hpp"

#include "Harmos_Exchange.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>

namespace Harmos::run {

TornArchive::TornArchive(qp::StateArchive<MultiVector>& archive, const feti::SubdomainSystem& system)
    : archive_(archive), system_(system) {
  std::size_t own = 0;
  for (int i = 0; i < system.size(); ++i)
    own += static_cast<std::size_t>(system.matrix(i).rows());
  map_ = Teuchos::rcp(
      new Map(static_cast<Tpetra::global_size_t>(system.primalDimension()), own, 0, system.comm()));
}

void TornArchive::exchange(const std::string& name, feti::TornVector& values) {
  if (archive_.isReading())
    values = system_.zeroVector();
  exchange(name, map_, values);
}

void TornArchive::exchangeNumbers(const std::string& name, feti::TornVector& values) {
  std::size_t own = 0;
  for (const std::vector<double>& part : values)
    own += part.size();
  const auto all =
      static_cast<Tpetra::global_size_t>(globalSum(*system_.comm(), static_cast<long long>(own)));
  exchange(name, Teuchos::rcp(new Map(all, own, 0, system_.comm())), values);
}

void TornArchive::exchange(const std::string& name, const Teuchos::RCP<const Map>& map,
                           feti::TornVector& values) {
  MultiVector x(map, 1);
  if (!archive_.isReading()) {
    const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::size_t place = 0;
    for (const std::vector<double>& part : values)
      for (const double value : part)
        view(place++, 0) = value;
  }
  archive_.vector(name, x);
  if (!archive_.isReading())
    return;
  const auto view = x.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::size_t place = 0;
  for (std::vector<double>& part : values)
    for (double& value : part)
      value = view(place++, 0);
}

} // namespace Harmos::run
