#include "models/command_line/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>

#include "models/error.hpp"

namespace wems {

void prepareStandardStreams() {
    std::signal(SIGPIPE, SIG_IGN);
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
    } catch (const std::exception& error) {
        problem = std::string("this cannot be computed (") + error.what() + "); please report what was run";
    }
    std::cerr << program << ": " << problem << "\n";
    return 2;
}

}  // namespace wems
