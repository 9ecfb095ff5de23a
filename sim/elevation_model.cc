// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/elevation_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "sim/landforms.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

// Cuts the next word off the front; empty at the end.
absl::string_view NextWord(absl::string_view* text) {
  while (!text->empty() && absl::ascii_isspace(static_cast<unsigned char>(text->front()))) text->remove_prefix(1);
  std::size_t length = 0;
  while (length < text->size() && !absl::ascii_isspace(static_cast<unsigned char>((*text)[length]))) ++length;
  const absl::string_view word = text->substr(0, length);
  text->remove_prefix(length);
  return word;
}

struct Header {
  std::optional<double> ncols, nrows, cellsize, nodata, x, y;

  // Null when the key is none of a header's.
  std::optional<double>* Find(const std::string& key) {
    if (key == "ncols") return &ncols;
    if (key == "nrows") return &nrows;
    if (key == "cellsize") return &cellsize;
    if (key == "nodata_value") return &nodata;
    if (key == "xllcorner" || key == "xllcenter") return &x;
    if (key == "yllcorner" || key == "yllcenter") return &y;
    return nullptr;
  }
};

absl::Status Invalid(absl::string_view name, absl::string_view cause) {
  return absl::InvalidArgumentError(absl::StrCat(name, ": ", cause));
}

// Leaves `text` at the first height.
absl::StatusOr<Header> ParseHeader(absl::string_view name, absl::string_view* text) {
  Header header;
  for (;;) {
    absl::string_view rest = *text;
    const absl::string_view word = NextWord(&rest);
    if (word.empty() || !absl::ascii_isalpha(static_cast<unsigned char>(word.front()))) break;
    std::optional<double>* field = header.Find(absl::AsciiStrToLower(word));
    // "nan" starts a grid of heights, too.
    if (field == nullptr) break;
    double value = 0.0;
    const absl::string_view number = NextWord(&rest);
    if (!absl::SimpleAtod(number, &value)) {
      return Invalid(name, absl::StrCat("'", word.substr(0, 40), "' is not followed by a number"));
    }
    *field = value;
    *text = rest;
  }
  if (!header.ncols || !header.nrows || !header.cellsize) {
    return Invalid(name, "not an ESRI ASCII grid: ncols, nrows and cellsize are needed");
  }
  for (const double size : {*header.ncols, *header.nrows}) {
    if (!(size >= 2.0 && size <= 1e8) || size != std::floor(size)) {
      return Invalid(name, "ncols and nrows must be whole numbers from 2 up");
    }
  }
  if (*header.ncols * *header.nrows > 1e8) return Invalid(name, "more than 100 million heights");
  if (!(*header.cellsize > 0.0) || !std::isfinite(*header.cellsize)) return Invalid(name, "cellsize must be positive");
  return header;
}

// Shifts the heights so that their mean is zero; false when there are none.
bool CentreHeights(HeightGrid* grid, std::vector<double>* heights) {
  double sum = 0.0;
  int64_t count = 0;
  for (const double height : *heights) {
    if (std::isnan(height)) continue;
    sum += height;
    ++count;
  }
  if (count == 0) return false;
  const double mean = sum / static_cast<double>(count);
  for (std::size_t i = 0; i < heights->size(); ++i) grid->heights.pixels[i] = static_cast<float>((*heights)[i] - mean);
  return true;
}

// Catmull-Rom weights of the vertices -1, 0, 1, 2 at u in [0, 1].
std::array<double, 4> CubicWeights(double u) {
  return {0.5 * u * (-1.0 + u * (2.0 - u)), 1.0 + 0.5 * u * u * (-5.0 + 3.0 * u), 0.5 * u * (1.0 + u * (4.0 - 3.0 * u)),
          0.5 * u * u * (u - 1.0)};
}

// The height at (ix + u, iy + v) in cells; falls back to the bilinear patch where one of the 16 vertices is missing.
float RefinedHeight(const HeightGrid& grid, int ix, int iy, const Eigen::Vector2d& uv) {
  const std::array<double, 4> weights_x = CubicWeights(uv.x());
  const std::array<double, 4> weights_y = CubicWeights(uv.y());
  double height = 0.0;
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(iy + j - 1, 0, grid.heights.rows - 1);
    for (int i = 0; i < 4; ++i) {
      const int col = std::clamp(ix + i - 1, 0, grid.heights.cols - 1);
      height += weights_y[static_cast<std::size_t>(j)] * weights_x[static_cast<std::size_t>(i)] *
                static_cast<double>(grid.heights(row, col));
    }
  }
  if (!std::isnan(height)) return static_cast<float>(height);
  const double x = std::min(grid.x_min + grid.cell * (ix + uv.x()), grid.x_max());
  const double y = std::min(grid.y_min + grid.cell * (iy + uv.y()), grid.y_max());
  return static_cast<float>(grid.HeightAt(x, y));
}

}  // namespace

absl::StatusOr<HeightGrid> ParseEsriAsciiGrid(absl::string_view text, absl::string_view name) {
  absl::StatusOr<Header> header = ParseHeader(name, &text);
  if (!header.ok()) return header.status();
  const int rows = static_cast<int>(*header->nrows);
  const int cols = static_cast<int>(*header->ncols);
  const auto expected = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  // A height takes at least two characters: a header that lies must not cost memory.
  if (text.size() + 1 < 2 * expected) {
    return absl::DataLossError(absl::StrCat(name, ": the file ends before its ", expected, " heights"));
  }
  std::vector<double> heights(expected);
  for (std::size_t i = 0; i < expected; ++i) {
    const absl::string_view word = NextWord(&text);
    if (word.empty()) {
      return absl::DataLossError(absl::StrCat(name, ": has ", i, " heights; its header says ", expected));
    }
    double height = 0.0;
    if (!absl::SimpleAtod(word, &height)) {
      return Invalid(name, absl::StrCat("'", word.substr(0, 40), "' is not a height"));
    }
    const bool hole = !std::isfinite(height) || (header->nodata && height == *header->nodata);
    // The file's first row is the northernmost, the grid's is the southernmost.
    const std::size_t row = static_cast<std::size_t>(rows) - 1 - i / static_cast<std::size_t>(cols);
    heights[row * static_cast<std::size_t>(cols) + i % static_cast<std::size_t>(cols)] =
        hole ? std::numeric_limits<double>::quiet_NaN() : height;
  }
  if (!NextWord(&text).empty()) {
    return absl::DataLossError(absl::StrCat(name, ": has more than the ", expected, " heights of its header"));
  }
  HeightGrid grid;
  grid.cell = *header->cellsize;
  grid.x_min = -0.5 * grid.cell * (cols - 1);
  grid.y_min = -0.5 * grid.cell * (rows - 1);
  grid.heights = Image<float>(rows, cols, kHole);
  if (!CentreHeights(&grid, &heights)) return Invalid(name, "has no heights, only holes");
  return grid;
}

absl::StatusOr<HeightGrid> ReadEsriAsciiGrid(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad() || text.fail()) return absl::DataLossError(absl::StrCat(path, ": cannot be read"));
  return ParseEsriAsciiGrid(text.str(), path);
}

HeightGrid RefineGrid(const HeightGrid& grid, int factor) {
  HeightGrid fine = grid;
  fine.cell = grid.cell / factor;
  fine.heights = Image<float>(grid.num_cells_y() * factor + 1, grid.num_cells_x() * factor + 1, kHole);
  for (int row = 0; row < fine.heights.rows; ++row) {
    const int iy = std::min(row / factor, grid.num_cells_y() - 1);
    for (int col = 0; col < fine.heights.cols; ++col) {
      const int ix = std::min(col / factor, grid.num_cells_x() - 1);
      const Eigen::Vector2d uv(static_cast<double>(col - ix * factor) / factor,
                               static_cast<double>(row - iy * factor) / factor);
      fine.heights(row, col) = RefinedHeight(grid, ix, iy, uv);
    }
  }
  return fine;
}

absl::StatusOr<World> MakeElevationWorld(const ElevationOptions& options, double relief, uint64_t key) {
  absl::StatusOr<HeightGrid> model = ReadEsriAsciiGrid(options.path);
  if (!model.ok()) return model.status();
  const int factor = std::max(1, static_cast<int>(std::lround(model->cell / options.cell_m)));
  HeightGrid grid = RefineGrid(*model, factor);
  // Only what the model cannot show: wavelengths below two of its cells.
  FractalOptions roughness = options.roughness;
  roughness.longest_wavelength_m = 2.0 * model->cell;
  roughness.amplitude_m *= std::pow(roughness.longest_wavelength_m, roughness.hurst);
  AddGravel(options.gravel_m, SubKey(key, 2), &grid);
  for (int row = 0; row < grid.heights.rows; ++row) {
    const double y = grid.y_min + grid.cell * row;
    for (int col = 0; col < grid.heights.cols; ++col) {
      const double x = grid.x_min + grid.cell * col;
      const double height = static_cast<double>(grid.heights(row, col)) + FractalNoise(x, y, roughness, SubKey(key, 1));
      grid.heights(row, col) = static_cast<float>(relief * height);
    }
  }
  std::vector<Rock> rocks = ScatterRocks(grid, options.rocks, relief, SubKey(key, 3));
  return World(std::move(grid), std::move(rocks));
}

}  // namespace curvereg::sim
