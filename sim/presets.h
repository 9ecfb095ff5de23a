// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Simulations by name: the paper's three data sets with its figures, and those that each make one thing harder.
#ifndef CURVEREG_SIM_PRESETS_H_
#define CURVEREG_SIM_PRESETS_H_

#include <optional>
#include <span>
#include <string_view>

#include "sim/simulation_options.h"

namespace curvereg::sim {

struct Preset {
  std::string_view name;
  std::string_view description;  // one line, for a person
};

// All presets in the order in which a person wants to read them.
std::span<const Preset> Presets();

// Options of a preset; nullopt for an unknown name. `gale` has no elevation file yet: set
// world.elevation.path. `strangers`, the name of `negatives` before, is known in this release only.
std::optional<SimulationOptions> PresetOptions(std::string_view name);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_PRESETS_H_
