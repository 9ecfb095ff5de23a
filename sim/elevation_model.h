// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Elevation models from files (ESRI ASCII grid) as worlds: refined below their own cells with fractal roughness, gravel
// and rocks, which orbital models are too coarse to show.
#ifndef CURVEREG_SIM_ELEVATION_MODEL_H_
#define CURVEREG_SIM_ELEVATION_MODEL_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "sim/fractal_noise.h"
#include "sim/height_grid.h"
#include "sim/rocks.h"
#include "sim/world.h"

namespace curvereg::sim {

// Parses "ncols, nrows, xllcorner|xllcenter, yllcorner|yllcenter, cellsize [, NODATA_value]" (any case, any order) and
// nrows lines of ncols heights, north first; NODATA becomes a hole. The file's place on the planet is dropped: the
// grid is centred on the origin and its mean height is 0. `name` stands in error messages.
// INVALID_ARGUMENT with name and cause: not such a grid, sizes below 2 or above 10^8 cells, cell size not positive, a
// height that is no number, nothing but holes. DATA_LOSS: fewer or more heights than the header says.
absl::StatusOr<HeightGrid> ParseEsriAsciiGrid(absl::string_view text, absl::string_view name);

// The same from a file. NOT_FOUND: it cannot be opened; DATA_LOSS: it cannot be read.
absl::StatusOr<HeightGrid> ReadEsriAsciiGrid(const std::string& path);

struct ElevationOptions {
  std::string path = "";  // ESRI ASCII grid
  double cell_m = 0.25;   // cells of the model are divided until they are at most 1.5 times this wide
  // Below one cell of the model only; amplitude_m is that of a wavelength of one metre.
  FractalOptions roughness = {.shortest_wavelength_m = 0.5, .amplitude_m = 0.03, .hurst = 0.8};
  double gravel_m = 0.012;
  RockOptions rocks = {};
};

// Bicubic (Catmull-Rom) between the vertices of the model, bilinear beside holes. `factor` >= 1 cells for one.
HeightGrid RefineGrid(const HeightGrid& grid, int factor);

// Reads options.path, refines it and adds what options say. `relief` scales all heights.
absl::StatusOr<World> MakeElevationWorld(const ElevationOptions& options, double relief, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_ELEVATION_MODEL_H_
