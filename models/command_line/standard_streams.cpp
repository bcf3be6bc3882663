#include "models/command_line/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "models/common/error.hpp"

namespace wems {
namespace {

constexpr int kBadInput = 2;  // exit status

/// From where nothing but the simplest calls of the system may be made: says it and ends. Staged files have no name.
template <std::size_t size>
[[noreturn]] void endWith(const char (&message)[size]) {
    const auto written = ::write(STDERR_FILENO, message, size - 1);
    ::_exit(written < 0 ? EXIT_FAILURE : kBadInput);
}

/// A file that is mapped into memory, since it is long, became shorter than what is looked at.
void reportShorterFile(int) {
    endWith("a file became shorter while it was read (accepted: a recording that is complete)\n");
}

[[noreturn]] void reportInternalError() {
    endWith("this cannot be computed (an internal check failed); please report the command line and its files\n");
}

#ifndef WEMS_SANITIZED
void reportSignal(int) {
    reportInternalError();
}
#endif

}  // namespace
}  // namespace wems

#ifndef WEMS_SANITIZED  // where that line is wanted
/// Of the C library, where a failed assert() ends: it would print a line of the source and leave a core.
extern "C" void __assert_fail(const char*, const char*, unsigned, const char*) noexcept {  // NOLINT
    wems::reportInternalError();
}
#endif

namespace wems {

void prepareStandardStreams() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGBUS, reportShorterFile);
    std::set_terminate(reportInternalError);
#ifndef WEMS_SANITIZED  // which say more
    std::signal(SIGABRT, reportSignal);
    std::signal(SIGFPE, reportSignal);
    // On a stack of its own: it may be the stack that is used up.
    static std::array<char, std::size_t{1} << 16> stack;
    stack_t alternative{};
    alternative.ss_sp = stack.data();
    alternative.ss_size = stack.size();
    struct sigaction action {};
    action.sa_handler = reportSignal;
    action.sa_flags = SA_ONSTACK;
    if (::sigaltstack(&alternative, nullptr) == 0) ::sigaction(SIGSEGV, &action, nullptr);
#endif
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest number that is free is this one. Only reading from it: what is printed is an error.
        const int opened = ::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
        if (opened < 0) return;
    }
}

void flushStandardOutput() {
    errno = 0;
    std::cout.flush();
    if (std::cout) return;
    const std::string reason = errno == 0 ? "" : ": " + std::generic_category().message(errno);
    throw InputError({"standard output", 0, {}}, "could not be written completely" + reason);
}

int runProgram(const char* program, int (*work)(int argc, char** argv), int argc, char** argv) {
    std::string problem;
    try {
        prepareStandardStreams();
        const int status = work(argc, argv);
        flushStandardOutput();
        return status;
    } catch (const InputError& error) {
        problem = error.what();
    } catch (const std::bad_alloc&) {
        problem = "there is not enough memory for this";
    } catch (const std::length_error&) {
        problem = "there is not enough memory for this";
    } catch (const std::exception&) {
        problem = "this cannot be computed (an internal error); please report the command line and its files";
    }
    std::cerr << program << ": " << problem << "\n";
    return kBadInput;
}

}  // namespace wems
