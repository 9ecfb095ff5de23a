// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/elevation_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/testing/test_data.h"

namespace curvereg::sim {
namespace {

constexpr char kSmall[] =
    "NCOLS 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 2\nNODATA_value -9999\n"
    "1 2 3\n"
    "4 -9999 10\n";

std::string ErrorOf(const std::string& text) {
  const absl::StatusOr<HeightGrid> grid = ParseEsriAsciiGrid(text, "a.asc");
  return grid.ok() ? "ok" : std::string(grid.status().message());
}

TEST(ElevationModelTest, ReadsNorthFirstAndCentres) {
  const absl::StatusOr<HeightGrid> grid = ParseEsriAsciiGrid(kSmall, "a.asc");
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->heights.rows, 2);
  EXPECT_EQ(grid->heights.cols, 3);
  EXPECT_DOUBLE_EQ(grid->cell, 2.0);
  EXPECT_DOUBLE_EQ(grid->x_min, -2.0);
  EXPECT_DOUBLE_EQ(grid->y_min, -1.0);
  // Mean of 1, 2, 3, 4 and 10 is 4; the file's last row is the southernmost.
  EXPECT_FLOAT_EQ(grid->heights(0, 0), 0.0F);
  EXPECT_TRUE(std::isnan(grid->heights(0, 1)));
  EXPECT_FLOAT_EQ(grid->heights(0, 2), 6.0F);
  EXPECT_FLOAT_EQ(grid->heights(1, 0), -3.0F);
}

TEST(ElevationModelTest, NamesWhatIsWrong) {
  EXPECT_EQ(ErrorOf(""), "a.asc: not an ESRI ASCII grid: ncols, nrows and cellsize are needed");
  EXPECT_EQ(ErrorOf("ply\nformat ascii 1.0\n"), "a.asc: not an ESRI ASCII grid: ncols, nrows and cellsize are needed");
  EXPECT_EQ(ErrorOf("ncols many"), "a.asc: 'ncols' is not followed by a number");
  EXPECT_EQ(ErrorOf("ncols 3 nrows 1 cellsize 1\n1 2 3"), "a.asc: ncols and nrows must be whole numbers from 2 up");
  EXPECT_EQ(ErrorOf("ncols 2.5 nrows 2 cellsize 1\n1 2 3"), "a.asc: ncols and nrows must be whole numbers from 2 up");
  EXPECT_EQ(ErrorOf("ncols nan nrows 2 cellsize 1\n1 2 3"), "a.asc: ncols and nrows must be whole numbers from 2 up");
  EXPECT_EQ(ErrorOf("ncols 2 nrows 2 cellsize 0\n1 2 3 4"), "a.asc: cellsize must be positive");
  EXPECT_EQ(ErrorOf("ncols 20000 nrows 20000 cellsize 1\n1 2"), "a.asc: more than 100 million heights");
  EXPECT_EQ(ErrorOf("ncols 9000 nrows 9000 cellsize 1\n1 2"), "a.asc: the file ends before its 81000000 heights");
  EXPECT_EQ(ErrorOf("ncols 2 nrows 2 cellsize 1\n1.00 2.00 3.00"), "a.asc: has 3 heights; its header says 4");
  EXPECT_EQ(ErrorOf("ncols 2 nrows 2 cellsize 1\n1 2 3 4 5"), "a.asc: has more than the 4 heights of its header");
  EXPECT_EQ(ErrorOf("ncols 2 nrows 2 cellsize 1\n1 2 x 4"), "a.asc: 'x' is not a height");
  EXPECT_EQ(ErrorOf("ncols 2 nrows 2 cellsize 1 nodata_value 0\n0 0 nan 0"), "a.asc: has no heights, only holes");
  EXPECT_EQ(ReadEsriAsciiGrid("/no/such/file.asc").status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(ReadEsriAsciiGrid("/").ok()) << "a folder";
}

TEST(ElevationModelTest, RefinementKeepsVerticesAndPlanes) {
  HeightGrid grid = MakeHeightGrid(8.0, 6.0, 1.0);
  for (int row = 0; row < grid.heights.rows; ++row) {
    for (int col = 0; col < grid.heights.cols; ++col) grid.heights(row, col) = static_cast<float>(2 * col - row);
  }
  grid.heights(3, 4) = 20.0F;
  const HeightGrid fine = RefineGrid(grid, 4);
  EXPECT_EQ(fine.heights.cols, 33);
  EXPECT_EQ(fine.heights.rows, 25);
  EXPECT_DOUBLE_EQ(fine.cell, 0.25);
  for (int row = 0; row < grid.heights.rows; ++row) {
    for (int col = 0; col < grid.heights.cols; ++col) {
      EXPECT_NEAR(fine.heights(4 * row, 4 * col), grid.heights(row, col), 1e-5F);
    }
  }
  // Away from the peak and the border, cubics follow a plane.
  EXPECT_NEAR(fine.HeightAt(-2.4, -1.7), 2.0 * (-2.4 + 4.0) - (-1.7 + 3.0), 1e-5);
}

TEST(ElevationModelTest, RefinementLeavesHolesOpenAndNothingElse) {
  HeightGrid grid = MakeHeightGrid(8.0, 8.0, 1.0);
  grid.heights(4, 4) = std::nanf("");
  const HeightGrid fine = RefineGrid(grid, 4);
  EXPECT_TRUE(std::isnan(fine.HeightAt(0.1, 0.1)));
  EXPECT_EQ(fine.HeightAt(1.3, 1.3), 0.0);
  EXPECT_EQ(fine.HeightAt(-3.9, 3.9), 0.0);
}

TEST(ElevationModelTest, WorldFromTheFileIsRoughBelowItsCells) {
  testing::TemporaryFolder folder;
  std::string text = "ncols 30 nrows 30 cellsize 1\n";
  for (int i = 0; i < 900; ++i) text += "-4470.5 ";
  const std::string path = folder.File("flat.asc");
  FILE* file = std::fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs(text.c_str(), file);
  std::fclose(file);
  ElevationOptions options;
  options.path = path;
  const absl::StatusOr<World> world = MakeElevationWorld(options, 1.0, 3);
  ASSERT_TRUE(world.ok()) << world.status();
  EXPECT_DOUBLE_EQ(world->ground().cell, 0.25);
  EXPECT_GT(world->rocks().size(), 100U);
  double squares = 0.0;
  for (const float height : world->ground().heights.pixels) squares += static_cast<double>(height * height);
  const double rms = std::sqrt(squares / static_cast<double>(world->ground().heights.size()));
  EXPECT_GT(rms, 0.01);
  EXPECT_LT(rms, 0.08);
}

TEST(ElevationModelTest, RealModels) {
  const auto folder = testing::RealDataPath("terrain");
  if (!folder.has_value()) GTEST_SKIP() << "no real elevation models on this machine";
  const absl::StatusOr<HeightGrid> gale = ReadEsriAsciiGrid(*folder + "/mars_gale_hirise_1m.asc");
  ASSERT_TRUE(gale.ok()) << gale.status();
  EXPECT_EQ(gale->heights.rows, 337);
  EXPECT_EQ(gale->heights.cols, 348);
  const absl::StatusOr<HeightGrid> yard = ReadEsriAsciiGrid(*folder + "/marsyard2021_0p094m.asc");
  ASSERT_TRUE(yard.ok()) << yard.status();
  EXPECT_TRUE(std::isnan(yard->heights(499, 0))) << "the corner lies outside of the yard";
  EXPECT_FALSE(std::isnan(yard->heights(250, 250)));
}

}  // namespace
}  // namespace curvereg::sim
