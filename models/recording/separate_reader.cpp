#include "models/recording/separate_reader.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "models/common/error.hpp"

namespace wems {
namespace {

/// The other process is no longer there.
struct BrokenOff {};

/// One end of the connection between both processes. Numbers go as they are in memory: it is one program.
class Wire {
public:
    explicit Wire(int descriptor) : descriptor_(descriptor) {}
    ~Wire() { ::close(descriptor_); }
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;

    void putBytes(const void* data, std::size_t size) const {
        const auto* next = static_cast<const char*>(data);
        while (size > 0) {
            const auto count = ::send(descriptor_, next, size, MSG_NOSIGNAL);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) throw BrokenOff{};
            next += count;
            size -= static_cast<std::size_t>(count);
        }
    }
    void getBytes(void* data, std::size_t size) const {
        auto* next = static_cast<char*>(data);
        while (size > 0) {
            const auto count = ::recv(descriptor_, next, size, 0);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) throw BrokenOff{};
            next += count;
            size -= static_cast<std::size_t>(count);
        }
    }
    /// The other side sees the end, whoever else has inherited this one.
    void end() const { ::shutdown(descriptor_, SHUT_RDWR); }
    void put(std::uint64_t number) const { putBytes(&number, sizeof number); }
    std::uint64_t get() const {
        std::uint64_t number = 0;
        getBytes(&number, sizeof number);
        return number;
    }
    void putText(const std::string& text) const {
        put(text.size());
        putBytes(text.data(), text.size());
    }
    std::string getText() const {
        std::string text(get(), '\0');
        getBytes(text.data(), text.size());
        return text;
    }
    void putNumbers(const std::vector<double>& numbers) const {
        put(numbers.size());
        putBytes(numbers.data(), numbers.size() * sizeof(double));
    }
    std::vector<double> getNumbers() const {
        std::vector<double> numbers(get());
        getBytes(numbers.data(), numbers.size() * sizeof(double));
        return numbers;
    }

private:
    int descriptor_;
};

enum class Answer : std::uint64_t { error, result };

void putError(const Wire& wire, const InputError& error) {
    wire.put(static_cast<std::uint64_t>(Answer::error));
    wire.putText(error.location().file);
    wire.put(static_cast<std::uint64_t>(error.location().line));
    wire.putText(error.location().key);
    wire.putText(error.problem());
    wire.putText(error.accepted());
}

/// Throws what the other side threw.
void getAnswer(const Wire& wire) {
    if (wire.get() == static_cast<std::uint64_t>(Answer::result)) return;
    InputLocation location;
    location.file = wire.getText();
    location.line = static_cast<long>(wire.get());
    location.key = wire.getText();
    const std::string problem = wire.getText();
    throw InputError(location, problem, wire.getText());
}

using Stored = std::vector<std::shared_ptr<const StoredNumbers>>;

/// @param stored collects the arrays that stay in the file
void putValue(const Wire& wire, const MatValue& value, Stored& stored) {
    wire.put(static_cast<std::uint64_t>(value.kind));
    wire.put(value.rows);
    wire.put(value.columns);
    wire.putNumbers(value.numbers);
    wire.put(value.stored ? 1 : 0);
    if (value.stored) stored.push_back(value.stored);
    wire.put(value.texts.size());
    for (const std::string& text : value.texts) wire.putText(text);
    wire.put(value.elements.size());
    for (const MatValue& element : value.elements) putValue(wire, element, stored);
    wire.put(value.fields.size());
    for (const auto& [name, field] : value.fields) {
        wire.putText(name);
        putValue(wire, field, stored);
    }
}

void limit(int resource, double value) {
    rlimit limits{};
    if (::getrlimit(resource, &limits) != 0 || static_cast<double>(limits.rlim_max) < value) return;
    limits.rlim_cur = limits.rlim_max = static_cast<rlim_t>(value);
    ::setrlimit(resource, &limits);
}

/// @param size of the file, bytes
void setLimits(double size) {
    constexpr double least_seconds = 20, bytes_a_second = 1e6;  // far below what both libraries reach
    limit(RLIMIT_CPU, least_seconds + size / bytes_a_second);
    limit(RLIMIT_CORE, 0);
#ifndef WEMS_SANITIZED                                        // who need most of the address space
    constexpr double least_memory = 2e9, memory_a_byte = 64;  // bytes; a compressed byte may hold that much
    double pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    limit(RLIMIT_AS,
          pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) + std::max(least_memory, memory_a_byte * size));
#endif
}

/// The child: the tree first, then parts of the arrays that stayed in the file, as they are asked for.
void serve(const Wire& wire, const std::function<MatFile()>& read) {
    Stored stored;
    try {
        const MatFile content = read();
        wire.put(static_cast<std::uint64_t>(Answer::result));
        wire.putText(content.version);
        wire.put(content.has_objects ? 1 : 0);
        putValue(wire, content.root, stored);
    } catch (const InputError& error) {
        putError(wire, error);
        return;
    }
    while (!stored.empty()) {
        const std::uint64_t index = wire.get(), row = wire.get(), rows = wire.get(), column = wire.get(),
                            columns = wire.get();
        try {
            const std::vector<double> numbers = stored.at(index)->read(row, rows, column, columns);
            wire.put(static_cast<std::uint64_t>(Answer::result));
            wire.putNumbers(numbers);
        } catch (const InputError& error) {
            putError(wire, error);
        }
    }
}

[[noreturn]] void runChild(int descriptor, double size, const std::function<MatFile()>& read) {
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    setLimits(size);
    try {
        const Wire wire(descriptor);
        serve(wire, read);
    } catch (...) {  // the end of the connection, with or without an answer, says it
    }
    ::_exit(0);  // nothing of the parent's is ended twice
}

/// The child as its parent sees it.
class Child {
public:
    Child(std::string file, std::string library, const std::function<MatFile()>& read)
        : file_(std::move(file)), library_(std::move(library)) {
        std::error_code unknown;
        const auto size = std::filesystem::file_size(file_, unknown);
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail();
        process_ = ::fork();
        if (process_ == 0) {
            ::close(ends[0]);
            runChild(ends[1], unknown ? 0 : static_cast<double>(size), read);
        }
        ::close(ends[1]);
        wire_ = std::make_unique<Wire>(ends[0]);
        if (process_ < 0) fail();
    }
    ~Child() {
        wire_->end();
        while (process_ > 0 && ::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    const Wire& wire() const { return *wire_; }
    [[noreturn]] void failBroken() const {
        throw InputError({file_, 0, {}}, "is damaged: " + library_ + ", which reads it, broke off",
                         "a file that its own program opens");
    }

private:
    [[noreturn]] void fail() const { throw InputError({file_, 0, {}}, "no process can be started to read it"); }

    std::string file_, library_;
    pid_t process_ = -1;
    std::unique_ptr<Wire> wire_;
};

class RemoteNumbers : public StoredNumbers {
public:
    RemoteNumbers(std::shared_ptr<const Child> child, std::uint64_t index) : child_(std::move(child)), index_(index) {}

    std::vector<double> read(std::size_t row, std::size_t rows, std::size_t column,
                             std::size_t columns) const override {
        try {
            for (const std::uint64_t number :
                 {index_, std::uint64_t{row}, std::uint64_t{rows}, std::uint64_t{column}, std::uint64_t{columns}})
                child_->wire().put(number);
            getAnswer(child_->wire());
            return child_->wire().getNumbers();
        } catch (const BrokenOff&) {
            child_->failBroken();
        }
    }

private:
    std::shared_ptr<const Child> child_;
    std::uint64_t index_;
};

MatValue getValue(const std::shared_ptr<const Child>& child, std::uint64_t& stored) {
    const Wire& wire = child->wire();
    MatValue value;
    value.kind = static_cast<MatValue::Kind>(wire.get());
    value.rows = wire.get();
    value.columns = wire.get();
    value.numbers = wire.getNumbers();
    if (wire.get() != 0) value.stored = std::make_shared<RemoteNumbers>(child, stored++);
    for (std::uint64_t left = wire.get(); left > 0; --left) value.texts.push_back(wire.getText());
    for (std::uint64_t left = wire.get(); left > 0; --left) value.elements.push_back(getValue(child, stored));
    for (std::uint64_t left = wire.get(); left > 0; --left) {
        std::string name = wire.getText();
        value.fields.emplace_back(std::move(name), getValue(child, stored));
    }
    return value;
}

}  // namespace

MatFile readSeparately(const std::string& file, const std::string& library, const std::function<MatFile()>& read) {
    const auto child = std::make_shared<const Child>(file, library, read);
    try {
        getAnswer(child->wire());
        MatFile content;
        content.version = child->wire().getText();
        content.has_objects = child->wire().get() != 0;
        std::uint64_t stored = 0;
        content.root = getValue(child, stored);
        return content;
    } catch (const BrokenOff&) {
        child->failBroken();
    }
}

}  // namespace wems
