/// @file
/// Notes on the blocks of a long recording.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace wems::identify {

/// Keeps one of the notes that differ in their numbers only.
class BlockNotes {
public:
    void add(const std::string& note);
    /// In the order in which they came, with the number of others like each.
    std::vector<std::string> list() const;

private:
    struct Note {
        std::string text;
        long blocks = 0;
    };
    std::map<std::string, std::size_t> index_;
    std::vector<Note> notes_;
};

}  // namespace wems::identify
