#pragma once

#include <string>

#include "proto/stream.pb.h"

namespace tessera {

/// What an edit does, for people: "place sprite 7 at (100, 50)", "3 changes".
std::string words_of(const proto::Edit& edit);

/// The outcome for people, in one line: "revision 8: place sprite 7 at (100, 50)".
std::string words_of(const proto::Edit& edit, const proto::EditAnswer& answer);
std::string words_of(const proto::Edit& edit, const proto::EditRefused& refusal);

}  // namespace tessera
