// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace Harmos::fem::Details {

/// Whether the header of a file in netCDF's classic formats (CDF-1, 2 and 5; NetCDF Users Guide, appendix B)
/// can be what it says: no list or name is longer than the file. netCDF 4.9 asks for as much memory as a
/// damaged one names. Other files: true. Local.
bool isSoundNetcdf(const std::string& path);

} // namespace Harmos::fem::Details
