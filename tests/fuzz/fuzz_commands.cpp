// libFuzzer targets of whole commands: the bytes draw a recording and a model out of good ones, and the command of
// WEMS_FUZZED_COMMAND is called as the executable calls it. It answers, with all of its files there and readable, or it
// refuses in one line and leaves nothing. An assertion, a signal, an exception that is no InputError is a finding.
// WEMS_KEEP=FOLDER keeps the files of an input, to be given to the executable by hand.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <streambuf>
#include <string>
#include <vector>

#include "identify/cli/program.hpp"
#include "models/common/error.hpp"
#include "models/mount_model.hpp"
#include "tests/fuzz/drawn_model.hpp"
#include "tests/fuzz/drawn_recording.hpp"
#include "tests/fuzz/good_inputs.hpp"
#include "tests/fuzz/promises.hpp"

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using wems::fuzz::DrawnBytes;

const std::string kCommand = WEMS_FUZZED_COMMAND;

/// What is printed goes nowhere.
class Nowhere : public std::streambuf {
    int overflow(int c) override { return c == EOF ? 0 : c; }
    std::streamsize xsputn(const char*, std::streamsize count) override { return count; }
};

std::string readText(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// A folder in memory, where there is one: a command puts its files on the disk.
class Folder {
public:
    Folder() {
        std::string name =
            (fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path().string()) + "/wems-fuzz-XXXXXX";
        wems::fuzz::require(mkdtemp(name.data()) != nullptr);
        path_ = name;
        write(path_ / "modes.csv", readText(WEMS_SOURCE_DIR "/models/shipped/smallsat_bracket.csv"));
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    std::set<std::string> list() const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(path_)) names.insert(entry.path().filename().string());
        return names;
    }

private:
    fs::path path_;
};

[[noreturn]] void report(const std::string& text) {
    std::fprintf(stderr, "%s: %s\n", kCommand.c_str(), text.c_str());
    std::abort();
}

void demand(bool condition, const std::string& text) {
    if (!condition) report(text);
}

/// Options of the command that change what it computes.
Words drawOptions(const Folder& folder, DrawnBytes& bytes) {
    const std::size_t which = bytes.below(8);
    if (kCommand == "fit") {
        static const std::array<Words, 8> choices{{{},
                                                   {"--use", "displacements"},
                                                   {"--use", "accelerations"},
                                                   {"--free", "body.inertia"},
                                                   {"--free", "body.center_of_gravity"},
                                                   {"--mass", "2"},
                                                   {"--axis", "z", "--from", "0.1", "--to", "0.5"},
                                                   {"--memory", "60.1"}}};
        return choices[which];
    }
    if (kCommand == "surface") {
        static const std::array<Words, 4> choices{
            {{}, {"--mass", "2"}, {"--from", "0.1", "--to", "0.5"}, {"--axis", "z"}}};
        return choices[which % 4];
    }
    if (kCommand == "spectra") {
        static const std::array<Words, 4> choices{{{}, {"--band", "5:50"}, {"--resolution", "5"}, {"--q", "25"}}};
        return choices[which % 4];
    }
    return which % 4 == 1 ? Words{"--validate", folder / "good.csv"} : Words{};
}

Words makeCommandLine(const Folder& folder, DrawnBytes& bytes) {
    Words words{"identify",          kCommand,   folder / "run.csv", "--json",
                folder / "out.json", "--report", folder / "out.html"};
    if (kCommand != "surface") words.insert(words.end(), {"--model", folder / "model.toml"});
    if (kCommand == "fit" || kCommand == "diagnose") words.insert(words.end(), {"-o", folder / "out.toml"});
    for (const std::string& word : drawOptions(folder, bytes)) words.push_back(word);
    return words;
}

void checkMessage(const std::string& message) {
    demand(message.find('\n') == std::string::npos, "more than one line: " + message);
    demand(!message.empty(), "a refusal without a word");
    for (const char* internal :
         {"std::", "Eigen", "basic_string", "vector::", "ssert", "internal", "json.exception", "stod"})
        demand(message.find(internal) == std::string::npos, "text of an exception: " + message);
}

void checkOutputs(const Folder& folder, const Words& words) {
    std::set<std::string> expected;
    for (const std::string& word : words)
        if (const std::string name = fs::path(word).filename(); name.rfind("out.", 0) == 0) expected.insert(name);
    for (const std::string& name : expected) demand(fs::exists(folder / name), name + " is missing");
    demand(nlohmann::json::accept(readText(folder / "out.json")), "out.json is no JSON");
    const std::string page = readText(folder / "out.html");
    demand(page.find("</html>") != std::string::npos, "out.html is cut");
    if (expected.count("out.toml") == 0) return;
    try {
        wems::readMountModel(folder / "out.toml");
    } catch (const wems::InputError& error) {
        report(std::string("a result that is refused as input: ") + error.what());
    }
}

void callCommand(const Folder& folder, const Words& words) {
    Words text = words;
    std::vector<char*> arguments;
    for (std::string& word : text) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::set<std::string> before = folder.list();
    try {
        const int status = wems::identify::cli::runIdentify(static_cast<int>(words.size()), arguments.data());
        demand(status == 0 || status == 1, "exit status " + std::to_string(status));
        checkOutputs(folder, words);
    } catch (const wems::InputError& error) {
        checkMessage(error.what());
        demand(folder.list() == before, std::string("refused, but something is left: ") + error.what());
        if (std::getenv("WEMS_SHOW") != nullptr) std::fprintf(stderr, "refused: %s\n", error.what());
    } catch (const std::exception& error) {
        report(std::string("an exception that is no message: ") + error.what());
    }
    for (const std::string& name : folder.list())
        if (before.count(name) == 0) fs::remove(folder / name);
}

void keep(const Folder& folder, const Words& words) {
    const char* kept = std::getenv("WEMS_KEEP");
    if (kept == nullptr) return;
    for (const std::string& name : folder.list())
        fs::copy_file(folder / name, fs::path(kept) / name, fs::copy_options::overwrite_existing);
    for (const std::string& word : words) std::fprintf(stderr, "%s ", fs::path(word).filename().c_str());
    std::fprintf(stderr, "\n");
}

}  // namespace

/// Whatever the library's own handler does, the fuzzer is to see it.
extern "C" void __assert_fail(const char* text, const char* file, unsigned line, const char*) noexcept {  // NOLINT
    report(std::string(file) + ":" + std::to_string(line) + ": assertion failed: " + text);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::vector<wems::fuzz::GoodInput> good = wems::fuzz::makeGoodInputs();
    static const Folder folder;
    static Nowhere nowhere;
    static const bool silent = (std::cout.rdbuf(&nowhere), std::cerr.rdbuf(&nowhere), true);
    wems::fuzz::require(silent);
    DrawnBytes bytes(data, size);
    const auto& input = good[bytes.below(good.size())];
    const Words words = makeCommandLine(folder, bytes);
    const bool damaged = bytes.below(8) == 7;
    auto recording = input.recording;
    makeOdd(recording, bytes);
    std::string text = recording.formatCsv(), model = makeOddModel(input.model, bytes);
    if (damaged) {
        std::string& file = bytes.below(2) == 0 ? text : model;
        file = wems::fuzz::damage(file, bytes);
    }
    write(folder / "run.csv", text);
    write(folder / "good.csv", input.recording.formatCsv());
    write(folder / "model.toml", model);
    keep(folder, words);
    callCommand(folder, words);
    return 0;
}
