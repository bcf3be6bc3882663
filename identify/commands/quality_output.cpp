#include "identify/commands/quality_output.hpp"

namespace wems::identify::commands {

nlohmann::json makeQualityJson(const QualityVerdict& verdict) {
    using Kind = MeasurementFault::Kind;
    auto faults = nlohmann::json::array();
    for (const MeasurementFault& fault : verdict.faults) {
        nlohmann::json entry{
            {"kind", kindName(fault.kind)}, {"channel", fault.channel}, {"alternatives", fault.alternatives}};
        switch (fault.kind) {
            case Kind::unit:
            case Kind::gain:
            case Kind::sign:
                entry["factor"] = fault.factor;
                break;
            case Kind::exchanged:
                entry["exchanged_with"] = fault.exchanged_with;
                break;
            case Kind::clock_drift:
                entry["drift"] = fault.drift;
                [[fallthrough]];
            case Kind::delay:
                entry["delay"] = fault.delay;
        }
        faults.push_back(entry);
    }
    return {{"verdict", qualityName(verdict.quality)},
            {"reasons", verdict.reasons},
            {"faults", faults},
            {"checked", verdict.checked},
            {"contradiction", verdict.contradiction}};
}

}  // namespace wems::identify::commands
