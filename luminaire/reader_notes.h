#pragma once

namespace lumifield {

/// What a file's reader notes: defaults taken for absent members and members without effect, or the latter alone.
enum class ReaderNotes { all, ignored };

}  // namespace lumifield
