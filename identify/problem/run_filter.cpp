#include "identify/problem/run_filter.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify {
namespace {

// In units of the highest frequency that is kept: the end of a transition band, and a rate that holds what is left.
constexpr double kStop = 7.6 / 4.4, kLeastRate = 19 / 4.4;
constexpr double kOfNyquist = 0.95;  // where the transition band ends at the latest
constexpr int kTabulated = 2048;     // places of the response: a linear course between them errs by 1e-5
/// Samples in a period of contact. Of displacements alone (VALIDATION.md) the exact model leaves 1.00 times the noise
/// at 15 of them, 1.16 at 7.5, 1.8 at 6 and 206 at 3.7.
constexpr double kOfContact = 14;

double calcPass(double interval, const ExcitedBand& band) {
    return std::min(band.harmonics * band.highest, kOfNyquist * 0.5 / interval / kStop);
}

int findDecimation(double interval, const ExcitedBand& band) {
    return std::max(1,
                    static_cast<int>(std::floor(1.0 / interval / (kLeastRate * band.harmonics * band.highest) + 1e-9)));
}

int findRefinement(double interval, const ExcitedBand& band) {
    // Beyond the transition band nothing is known of a contact.
    if (band.contact > kStop * calcPass(interval, band)) return 1;
    return std::max(1, static_cast<int>(std::ceil(kOfContact * band.contact * interval - 1e-9)));
}

}  // namespace

RunFilter::RunFilter(double interval, const ExcitedBand& band)
    : raw_interval_(interval),
      pass_(calcPass(interval, band)),
      between_(findRefinement(interval, band)),
      every_(between_ > 1 ? 1 : findDecimation(interval, band)),
      kernel_(interval / between_, pass_, kStop * pass_) {
    interval_ = interval * every_ / between_;
    response_.resize(kTabulated + 1);
    for (int i = 0; i <= kTabulated; ++i)
        response_[static_cast<std::size_t>(i)] =
            kernel_.calcResponse(0.5 * i / (kTabulated * static_cast<double>(every_)));
}

bool RunFilter::resolves(double interval, double frequency) {
    return kOfContact * frequency * interval <= 1;
}

double RunFilter::edge() const {
    return (kernel_.halfWidth() + 1) * raw_interval_ / between_;
}

Eigen::MatrixXd RunFilter::apply(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative) const {
    return between_ > 1 ? kernel_.applyBetween(rows, derivative, between_) : kernel_.apply(rows, derivative, every_);
}

double RunFilter::calcResponse(double frequency) const {
    if (response_.empty()) return 1;
    const double place = std::min(2 * frequency * interval_, 1.0) * kTabulated;
    const auto before = static_cast<std::size_t>(std::min(place, kTabulated - 1.0));
    const double share = place - static_cast<double>(before);
    return (1 - share) * response_[before] + share * response_[before + 1];
}

}  // namespace wems::identify
