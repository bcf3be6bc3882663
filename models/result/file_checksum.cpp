#include "models/result/file_checksum.hpp"

#include <openssl/evp.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

namespace wems {

std::optional<std::string> calcChecksum(const std::string& file) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(file, problem)) return std::nullopt;
    std::ifstream stream(file, std::ios::binary);
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    if (!stream || !context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) return std::nullopt;
    constexpr std::size_t piece = std::size_t{1} << 20;
    std::vector<char> bytes(piece);
    while (stream.read(bytes.data(), static_cast<std::streamsize>(piece)) || stream.gcount() > 0)
        if (EVP_DigestUpdate(context.get(), bytes.data(), stream.gcount()) != 1) return std::nullopt;
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int length = 0;
    if (!stream.eof() || EVP_DigestFinal_ex(context.get(), digest.data(), &length) != 1) return std::nullopt;
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
        constexpr const char* digits = "0123456789abcdef";
        text += digits[digest[i] >> 4U];
        text += digits[digest[i] & 15U];
    }
    return text;
}

}  // namespace wems
