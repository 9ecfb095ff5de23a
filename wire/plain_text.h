// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Names that came over the wire.
#ifndef CURVEREG_WIRE_PLAIN_TEXT_H_
#define CURVEREG_WIRE_PLAIN_TEXT_H_

#include <string_view>

namespace curvereg::wire {

// Whether `text` is UTF-8 (RFC 3629) without control characters, so that it may stand in a log line or a protobuf
// string.
bool IsPlainText(std::string_view text);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_PLAIN_TEXT_H_
