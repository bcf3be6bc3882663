#include "identify/spectra/margins.hpp"

#include <cmath>

#include "identify/fit/law_history.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "models/error.hpp"

namespace wems::identify {
namespace {

template <class Values>
ConnectionMargin measure(const std::string& name, const Values& q) {
    ConnectionMargin margin;
    margin.name = name;
    margin.lowest = q.minCoeff();
    margin.highest = q.maxCoeff();
    margin.rms = std::sqrt((q.array() - q.mean()).square().mean());
    return margin;
}

void findLeft(const AxisLaw& law, double lowest, double highest, ConnectionMargin& margin) {
    for (const Stop& stop : law.stops) {
        const bool positive = stop.side == Side::positive;
        const double left = stop.clearance - (positive ? highest + law.offset : -(lowest + law.offset));
        auto& target = positive ? margin.left_positive : margin.left_negative;
        target = target ? std::fmin(*target, left) : left;
    }
}

}  // namespace

Margins findMargins(const Recording& recording, const MountModel* model) {
    Margins margins;
    try {
        if (model == nullptr) {
            const RelativeDisplacement relative = calcRelativeDisplacement(recording);
            for (std::size_t i = 0; i < relative.names.size(); ++i)
                margins.connections.push_back(measure(relative.names[i], relative.q.row(i)));
            margins.notes = relative.notes;
            return margins;
        }
        const RunMotion motion = estimateMotion(recording, *model);
        const RelativeHistory relative = calcRelativeHistory(motion, *model);
        const RowMatrix force = calcForceHistory(*model, relative, motion.time);
        const Eigen::VectorXd rest = calcRestDisplacement(*model);
        for (std::size_t i = 0; i < model->connections.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const Eigen::Index column = 3 * i + k;
                const Eigen::VectorXd q = relative.q.col(column);
                const std::string name = model->connections[i].name + "." + "xyz"[k];
                ConnectionMargin margin = measure(name, (q.array() - rest[column]).matrix());
                margin.largest_force = force.col(column).cwiseAbs().maxCoeff();
                findLeft(model->connections[i].axis[k], q.minCoeff(), q.maxCoeff(), margin);
                margins.connections.push_back(margin);
            }
        margins.notes = motion.notes;
    } catch (const InputError& error) {
        // Spectra of single channels need no relative motion; what it takes is said.
        margins.connections.clear();
        margins.notes = {std::string("no relative displacements: ") + error.what()};
    }
    return margins;
}

}  // namespace wems::identify
