#pragma once

#include <cstdint>

namespace hemi {

/// Hash of numbers in their order, 64 bits: FNV-1a over their bytes, the lowest first.
/// Source: G. Fowler, L. C. Noll, K.-P. Vo, "The FNV Non-Cryptographic Hash Algorithm".
class Fnv1a {
public:
    void add(std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte) {
            hash_ = (hash_ ^ (value & 0xFFu)) * 0x100000001B3u;
            value >>= 8;
        }
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0xCBF29CE484222325u;
};

} // namespace hemi
