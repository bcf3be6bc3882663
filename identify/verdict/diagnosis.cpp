#include "identify/verdict/diagnosis.hpp"

namespace wems::identify {

std::string formatVerdict(Diagnosis::Verdict verdict) {
    switch (verdict) {
        case Diagnosis::Verdict::explained:
            return "explained";
        case Diagnosis::Verdict::nothing_missing:
            return "nothing_missing";
        case Diagnosis::Verdict::unexplained:
            return "unexplained";
    }
    return {};
}

}  // namespace wems::identify
