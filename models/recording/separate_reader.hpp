/// @file
/// Libraries that read foreign binary files, in a process of their own.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "models/recording/mat_file.hpp"

namespace wems {

/// Calls `read` in a child process, without standard streams, with limits of memory and processor time that grow with
/// the file, and passes on what it returns or throws as InputError. Arrays that it leaves in the file are read there,
/// too: the child lives as long as one of them.
/// @param library what to call it in the message
/// @throws InputError also if the child crashes or meets a limit: the file is damaged
MatFile readSeparately(const std::string& file, const std::string& library, const std::function<MatFile()>& read);

}  // namespace wems
