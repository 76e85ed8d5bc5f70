#pragma once

#include <string>
#include <vector>

#include "server/journal/journal.h"

namespace tessera {

namespace proto {
class Change;
class Edit;
}  // namespace proto

/// What a change does, in a few words: "moves sprite 3 to (10.5, 20)". One line, without control characters.
std::string words_for(const proto::Change& change);

/// What an edit does, a few words for each of its changes; the words of further ones are counted alone.
std::string words_for(const proto::Edit& edit);

/// `text` in one line that a terminal shows as it is: control characters are replaced.
std::string harmless(std::string text);

/// "2026-11-22 14:03:05.120", in UTC.
std::string text_of(JournalTime time);

}  // namespace tessera
