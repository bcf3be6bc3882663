#include "identify/fit/law_verdict.hpp"

namespace wems::identify {
namespace {

// Of the force. A data-sheet stiffness is 10 % off, one way or the other: a law that leaves less is at least as good.
// From three times that on, the law is not the one that was measured.
constexpr double kIdentified = 0.1, kUnexplained = 0.3;
constexpr double kNoise = 2;  // what is left over the noise: twice is what an estimate of the noise is off by at most

}  // namespace

LawVerdict judgeLaw(double residual_fraction, double over_noise) {
    if (residual_fraction < kIdentified || over_noise < kNoise) return LawVerdict::identified;
    // Written so that a residual which is no number is no answer.
    return residual_fraction < kUnexplained ? LawVerdict::doubtful : LawVerdict::unexplained;
}

std::string formatLawVerdict(LawVerdict verdict) {
    switch (verdict) {
        case LawVerdict::identified:
            return "identified";
        case LawVerdict::doubtful:
            return "doubtful";
        case LawVerdict::unexplained:
            return "unexplained";
    }
    return {};
}

std::string describeLawVerdict(LawVerdict verdict) {
    switch (verdict) {
        case LawVerdict::identified:
            return "verdict: identified";
        case LawVerdict::doubtful:
            return "verdict: doubtful; more than a tenth of the force is left, so that the model lacks something";
        case LawVerdict::unexplained:
            return "verdict: unexplained; the law leaves so much of the force that its values do not describe it";
    }
    return {};
}

}  // namespace wems::identify
