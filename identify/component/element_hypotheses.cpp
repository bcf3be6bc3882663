#include "identify/component/element_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "models/pi.hpp"

namespace wems::identify {
namespace {

// Parts of the largest displacement at which a stop or a yield displacement is sought: the law is not linear in them.
constexpr double kMissingStops[] = {0.35, 0.55, 0.75, 0.9};
constexpr double kYields[] = {0.03, 0.1, 0.3, 0.8};
constexpr double kFarClearances[] = {0.6, 1.4};  // of the believed one
constexpr double kCommonReach = 0.5;             // of a number that is sought by a start

class Lister {
public:
    Lister(const UnknownTable& table, const AxisLaw& believed, const ElementReach& reach)
        : table_(table), believed_(believed), reach_(reach) {}

    std::vector<Hypothesis> make() {
        addNumber("elastomer_stiffness", "stiffness");
        addNumber("viscous_damping", "damping");
        addNumber("structural_damping", "loss_factor");
        addNumber("friction", "friction_force");
        addNumber("cubic_stiffness", "cubic");
        addNumber("stiffness_drift", "drift");
        addRelaxation();
        addHysteresis();
        for (const Stop& stop : believed_.stops) addStop(stop);
        addBothSides();
        const std::string channel = "force." + reach_.place;
        if (const int delay = row(channel + ".delay"); delay >= 0) setFree(add("sensor_delay", {channel}), delay);
        shareOdds();
        return std::move(list_);
    }

private:
    int row(const std::string& name) const { return findUnknown(table_, name); }
    int own(const std::string& key) const { return row(reach_.place + "." + key); }
    const Unknown& at(int index) const { return table_[index]; }

    Hypothesis& add(const std::string& cause, std::vector<std::string> where) {
        Hypothesis hypothesis;
        hypothesis.cause = cause;
        hypothesis.where = std::move(where);
        list_.push_back(std::move(hypothesis));
        return list_.back();
    }

    void setFree(Hypothesis& hypothesis, int index, double reach = 0) const {
        hypothesis.directions.push_back({{index, reach > 0 ? reach : at(index).reach}});
        hypothesis.reported.push_back(index);
    }

    void addNumber(const std::string& cause, const std::string& key) {
        const int index = own(key);
        if (index < 0) return;
        setFree(add(cause, {reach_.place}), index);
    }

    void addRelaxation() {
        if (believed_.relaxation) return;
        const int ratio = own("stiffness_ratio"), constant = own("time_constant");
        if (ratio < 0 || constant < 0 || !(believed_.stiffness > 0)) return;
        // Half a decade apart, from the fastest stroke to the slowest.
        const double first = std::log(reach_.lowest / 2), last = std::log(reach_.highest * 2);
        const int count = 1 + static_cast<int>(std::ceil((last - first) / std::log(5.0)));
        for (int i = 0; i < count; ++i) {
            const double f = std::exp(first + (last - first) * (i + 0.5) / count), tau = 1 / (kTwoPi * f);
            Hypothesis& hypothesis = add("relaxation", {reach_.place});
            setFree(hypothesis, ratio);
            setFree(hypothesis, constant, kCommonReach * tau);
            hypothesis.start = {{constant, tau}};
        }
    }

    void addHysteresis() {
        if (believed_.hysteresis || own("hysteresis_force") < 0) return;
        for (const double part : kYields) {
            const double yield = part * reach_.displacement;
            Hypothesis& hypothesis = add("hysteresis", {reach_.place});
            setFree(hypothesis, own("hysteresis_force"));
            setFree(hypothesis, own("yield_displacement"), kCommonReach * yield);
            hypothesis.start = {{own("yield_displacement"), yield}};
        }
    }

    void addStop(const Stop& stop) {
        const bool positive = stop.side == Side::positive;
        const std::string key = positive ? "+" : "-", place = reach_.place + "." + key;
        const int clearance = own(key + ".clearance"), stiffness = own(key + ".stiffness");
        const double reached = positive ? reach_.positive : reach_.negative;
        if (clearance < 0 || stiffness < 0) return;
        if (stop.stiffness > 0) {
            setFree(add("stop_stiffness", {place}), stiffness);
            setFree(add("clearance", {place}), clearance);
            for (const double far : kFarClearances) {
                const double c = far * stop.clearance;
                if (std::min(c, stop.clearance) > reached) continue;
                Hypothesis& hypothesis = add("clearance", {place});
                setFree(hypothesis, clearance, kCommonReach * c);
                hypothesis.start = {{clearance, c}};
            }
            return;
        }
        if (!(reached > 0.05 * reach_.displacement)) return;
        for (const double part : kMissingStops) {
            Hypothesis& hypothesis = add("clearance", {place});
            setFree(hypothesis, clearance, kCommonReach * part * reached);
            setFree(hypothesis, stiffness);
            hypothesis.start = {{clearance, part * reached}, {stiffness, 0.5 * at(stiffness).reach}};
        }
    }

    void addBothSides() {
        std::vector<const Stop*> real;
        for (const Stop& stop : believed_.stops)
            if (stop.stiffness > 0) real.push_back(&stop);
        if (real.empty()) return;
        if (const int index = own("dissipation"); index >= 0) setFree(add("stop_dissipation", {reach_.place}), index);
        if (real.size() != 2 || own("offset") < 0) return;
        setFree(add("preload", {reach_.place}), own("offset"));
        for (const char* what : {"clearance", "stiffness"}) {
            Hypothesis& hypothesis = add(what == std::string("clearance") ? what : "stop_stiffness",
                                         {reach_.place + ".+", reach_.place + ".-"});
            Direction direction;
            for (const char* side : {"+", "-"}) {
                const int index = own(std::string(side) + "." + what);
                direction.emplace_back(index, kCommonReach * at(index).believed);
                hypothesis.reported.push_back(index);
            }
            hypothesis.directions = {direction};
        }
    }

    /// Each cause has the same odds, shared by its places and starts, as for whole mounts.
    void shareOdds() {
        std::map<std::string, int> places;
        for (const auto& hypothesis : list_) ++places[hypothesis.cause];
        for (auto& hypothesis : list_)
            hypothesis.log_prior = -std::log(static_cast<double>(places.size()) * places[hypothesis.cause]);
    }

    const UnknownTable& table_;
    const AxisLaw& believed_;
    const ElementReach& reach_;
    std::vector<Hypothesis> list_;
};

}  // namespace

std::vector<Hypothesis> listElementHypotheses(const UnknownTable& table, const AxisLaw& believed,
                                              const ElementReach& reach) {
    return Lister(table, believed, reach).make();
}

}  // namespace wems::identify
