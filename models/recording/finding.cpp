#include "models/recording/finding.hpp"

namespace wems {

const char* kindName(FindingKind kind) {
    switch (kind) {
        case FindingKind::repeated_time:
            return "repeated_time";
        case FindingKind::backward_time:
            return "backward_time";
        case FindingKind::gap:
            return "gap";
        case FindingKind::non_uniform_time:
            return "non_uniform_time";
        case FindingKind::missing_value:
            return "missing_value";
        case FindingKind::empty_channel:
            return "empty_channel";
        case FindingKind::clipped:
            return "clipped";
        case FindingKind::saturated:
            return "saturated";
        case FindingKind::drop_out:
            return "drop_out";
        case FindingKind::hum:
            return "hum";
        case FindingKind::offset:
            return "offset";
        case FindingKind::drift:
            return "drift";
        case FindingKind::constant:
            return "constant";
        case FindingKind::missing_connection:
            return "missing_connection";
        case FindingKind::unknown_connection:
            return "unknown_connection";
        case FindingKind::swapped:
            break;
    }
    return "swapped";
}

}  // namespace wems
