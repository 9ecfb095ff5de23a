// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The names of methods and of reasons for rejection, as the command line, the wire, the metrics and the documents use
// them. Each list is in the order of its enum.
#ifndef CURVEREG_CORE_METHODS_REGISTRATION_NAMES_H_
#define CURVEREG_CORE_METHODS_REGISTRATION_NAMES_H_

#include <optional>
#include <span>
#include <string_view>

#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

std::span<const Method> AllMethods();
std::string_view MethodName(Method method);
// Empty: no method has this name.
std::optional<Method> MethodFromName(std::string_view name);

// Lower-case name with underscores, e.g. "overlap_too_low".
std::string_view ReasonName(Reason reason);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTRATION_NAMES_H_
