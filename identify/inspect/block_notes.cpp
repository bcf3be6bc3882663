#include "identify/inspect/block_notes.hpp"

#include <algorithm>
#include <cctype>

namespace wems::identify {

void BlockNotes::add(const std::string& note) {
    std::string kind = note;
    kind.erase(std::remove_if(kind.begin(), kind.end(),
                              [](unsigned char c) { return std::isdigit(c) != 0 || c == '.' || c == '+' || c == '-'; }),
               kind.end());
    const auto [place, is_new] = index_.try_emplace(kind, notes_.size());
    if (is_new) notes_.push_back({note, 0});
    ++notes_[place->second].blocks;
}

std::vector<std::string> BlockNotes::list() const {
    std::vector<std::string> texts;
    for (const Note& note : notes_)
        texts.push_back(note.blocks == 1
                            ? note.text
                            : note.text + " (and the like in " + std::to_string(note.blocks - 1) + " more blocks)");
    return texts;
}

}  // namespace wems::identify
