// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StructuredRectangle.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::fem {

StructuredRectangle::StructuredRectangle(const Point& origin, const std::array<double, 2>& size,
                                         const std::array<int, 2>& subdomains,
                                         const std::array<int, 2>& elements, long long firstNode)
    : origin_(origin), size_(size), subdomains_(subdomains), elements_(elements), firstNode_(firstNode) {
  for (std::size_t d = 0; d < 2; ++d)
    if (!(size[d] > 0.0) || subdomains[d] < 1 || elements[d] < 1)
      throw InputError(
          "a structured rectangle needs positive sizes and at least one subdomain and element a side");
  auto mesh = std::make_shared<Mesh>();
  const int nx = elements[0], ny = elements[1];
  const double hx = size[0] / (static_cast<double>(subdomains[0]) * nx);
  const double hy = size[1] / (static_cast<double>(subdomains[1]) * ny);
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      mesh->coordinates.push_back(i * hx);
      mesh->coordinates.push_back(j * hy);
      if (i == 0 || i == nx || j == 0 || j == ny)
        mesh->boundary.push_back(j * (nx + 1) + i);
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int corner = j * (nx + 1) + i;
      for (int node : {corner, corner + 1, corner + nx + 2, corner + nx + 1})
        mesh->cells.push_back(node);
    }
  mesh_ = mesh;
}

long long StructuredRectangle::numberOfNodes() const {
  const long long columns = static_cast<long long>(subdomains_[0]) * elements_[0] + 1;
  const long long rows = static_cast<long long>(subdomains_[1]) * elements_[1] + 1;
  return columns * rows;
}

PlacedMesh StructuredRectangle::subdomain(int s) const {
  HARMOS_REQUIRE(s >= 0 && s < numberOfSubdomains(), "there is no such subdomain");
  const int column = s % subdomains_[0], row = s / subdomains_[0];
  const int nx = elements_[0], ny = elements_[1];
  PlacedMesh placed;
  placed.mesh = mesh_;
  placed.anchor = {origin_[0] + size_[0] * column / subdomains_[0],
                   origin_[1] + size_[1] * row / subdomains_[1], origin_[2]};
  const long long stride = static_cast<long long>(subdomains_[0]) * nx + 1;
  for (int local : mesh_->boundary) {
    const int i = local % (nx + 1), j = local / (nx + 1);
    placed.boundaryNumbers.push_back(firstNode_ + (static_cast<long long>(row) * ny + j) * stride +
                                     static_cast<long long>(column) * nx + i);
    if (i == 0 && column == 0)
      placed.sets["left"].push_back(local);
    if (i == nx && column == subdomains_[0] - 1)
      placed.sets["right"].push_back(local);
    if (j == 0 && row == 0)
      placed.sets["bottom"].push_back(local);
    if (j == ny && row == subdomains_[1] - 1)
      placed.sets["top"].push_back(local);
  }
  return placed;
}

} // namespace Harmos::fem
