/// @file
/// Integration of the forward model's equations for one or several parameter sets at once (lanes of a Pack).
///
/// Classical Runge–Kutta of fourth order with the steps of a grid. A step that leaves its regime (kinks.hpp) counts up
/// to the kink alone, where its state is the cubic through both ends with their rates; the rest of the grid's step
/// follows in the new regime. The error of that cubic, of fourth order, enters once for each kink, so that the method
/// keeps its order. Lanes do not wait for each other: each has its own place in the grid and its own rest of a step.
#pragma once

#include <initializer_list>

#include "identify/forward/drive.hpp"
#include "identify/forward/drive_reader.hpp"
#include "identify/forward/kinks.hpp"
#include "identify/forward/mount_kernel.hpp"
#include "identify/forward/pack.hpp"

namespace wems::identify {

/// One simulation of those that run together.
struct LaneRun {
    const double* initial = nullptr;             ///< state
    const double* gain = nullptr;                ///< of the load's axes at all half steps, 3 for each; null = 1
    double* q = nullptr;                         ///< 3 · connections for each sample
    double *states = nullptr, *rates = nullptr;  ///< at each sample; null = unwanted
    double* last = nullptr;                      ///< the last state; null = unwanted
    int diverged_at = -1;                        ///< half step; −1 if it did not
    long evaluations = 0;                        ///< of the equations
};

/// Where kinks are: which axis, its constants, its state.
struct StopPlace {
    int axis, constants;
};
struct BristlePlace {
    int axis, constants, state;  // of the internal ones
};

struct StepPlan {
    DriveRows drive;
    int first_half = 0, steps_per_sample = 1, samples = 1;
    int state_size = 0, at_internal = 0;
    const StopPlace* stops = nullptr;
    int stop_count = 0;
    const BristlePlace* bristles = nullptr;
    int bristle_count = 0;

    /// Numbers of kind T that the integration works on.
    int workSize(int connections) const { return 8 * state_size + 18 * connections + stop_count + 6 * bristle_count; }
};

/// Nothing beside the kernel's equations.
template <class T>
struct NoGuides {
    void correct(const T*, const Forcing<T>&, double, T*) const {}
    void project(T*, const Forcing<T>&) const {}
};

template <class T, int lanes, class Guides>
class Stepper {
public:
    Stepper(const MountKernel<T>& kernel, const StepPlan& plan, const Guides& guides, LaneRun* runs, T* work)
        : kernel_(kernel), plan_(plan), drive_(plan.drive), guides_(guides), runs_(runs) {
        const auto take = [&work](int count) {
            T* taken = work;
            work += count;
            return taken;
        };
        for (T** vector : {&y_, &next_, &stage_, &k1_, &k2_, &k3_, &k4_, &end_rates_}) *vector = take(plan.state_size);
        for (Ends* ends : {&start_, &end_, &at_kink_}) {
            ends->q = take(3 * kernel.connections);
            ends->v = take(3 * kernel.connections);
            ends->stretch = take(plan.bristle_count);
        }
        closed_ = take(plan.stop_count);
        for (T** vector : {&direction_, &anchor_, &stretch_}) *vector = take(plan.bristle_count);
    }

    void run() {
        begin();
        while (emitSamples()) {
            step();
            accept();
        }
    }

private:
    using Ends = AxisMotion<T>;

    void begin() {
        for (int l = 0; l < lanes; ++l) {
            half_[l] = plan_.first_half;
            for (int i = 0; i < plan_.state_size; ++i) setLane(y_[i], l, runs_[l].initial[i]);
        }
        for (int i = 0; i < plan_.stop_count; ++i) closed_[i] = 0.0;
        for (int i = 0; i < plan_.bristle_count; ++i) {
            direction_[i] = 1.0;
            anchor_[i] = 0.0;
            stretch_[i] = y_[plan_.at_internal + plan_.bristles[i].state];
        }
        const Forcing<T> forcing = collect(0.0);
        guides_.project(y_, forcing);
        calc(y_, forcing, 0.0, k1_, start_);  // for the displacements, which the regime depends on
        for (int i = 0; i < plan_.stop_count; ++i) {
            const StopPlace& stop = plan_.stops[i];
            closed_[i] = whereNegative(
                T(0.0) - calcPenetration(kernel_.constants + stop.constants, start_.q[stop.axis]), T(1.0), T(0.0));
        }
        for (int i = 0; i < plan_.bristle_count; ++i) anchor_[i] = start_.q[plan_.bristles[i].axis];
        followDirections(false);
        calc(y_, forcing, 0.0, k1_, start_);
    }

    /// False once all samples are there.
    bool emitSamples() {
        const int halves = 2 * plan_.steps_per_sample;
        bool due[lanes], any = false, more = false;
        for (int l = 0; l < lanes; ++l) {
            due[l] = active(l) && part_[l] == 0 && half_[l] - plan_.first_half == emitted_[l] * halves;
            any = any || due[l];
        }
        T sum = 0.0;  // not finite if anything is not
        if (any)
            for (int i = 0; i < plan_.state_size; ++i) sum += y_[i];
        for (int l = 0; l < lanes; ++l) {
            if (due[l]) emit(l, lane(sum, l));
            more = more || active(l);
        }
        return more;
    }

    void emit(int l, double sum) {
        LaneRun& out = runs_[l];
        const int column = emitted_[l]++, rows = 3 * kernel_.connections, size = plan_.state_size;
        double* const q = out.q + column * static_cast<long>(rows);
        for (int i = 0; i < rows; ++i) q[i] = lane(start_.q[i], l);
        if (out.states) {
            for (int i = 0; i < size; ++i) {
                out.states[column * static_cast<long>(size) + i] = lane(y_[i], l);
                out.rates[column * static_cast<long>(size) + i] = lane(k1_[i], l);
            }
        }
        if (out.last && !active(l))
            for (int i = 0; i < size; ++i) out.last[i] = lane(y_[i], l);
        if (!(sum - sum == 0)) {
            out.diverged_at = half_[l];
            emitted_[l] = plan_.samples;
        }
    }

    bool active(int l) const { return emitted_[l] < plan_.samples; }

    /// What acts at a part (0…1) of what is left of each lane's grid step.
    Forcing<T> collect(double part_of_rest) const {
        double parts[lanes];
        for (double& part : parts) part = part_of_rest;
        return collect(parts);
    }
    Forcing<T> collect(const double* part_of_rest) const {
        Forcing<T> forcing;
        for (int l = 0; l < lanes; ++l) {
            double part = part_[l] + (1 - part_[l]) * part_of_rest[l];
            if (part_of_rest[l] == 1) part = 1;
            drive_.read(active(l) ? half_[l] + 2 * part : half_[l], runs_[l].gain, l, forcing);
        }
        return forcing;
    }

    void calc(const T* y, const Forcing<T>& forcing, double part_of_rest, T* rates, const Ends& motion) {
        calcRates(kernel_, y, forcing, Regime<T>{closed_, direction_, anchor_, stretch_}, rates, motion);
        for (int l = 0; l < lanes; ++l)
            if (active(l)) ++runs_[l].evaluations;
        guides_.correct(y, forcing, half_[0] + 2 * (part_[0] + (1 - part_[0]) * part_of_rest), rates);
    }

    void step() {
        for (int l = 0; l < lanes; ++l) setLane(h_, l, active(l) ? (1 - part_[l]) * 2 * plan_.drive.half_step : 0.0);
        const Forcing<T> middle = collect(0.5);
        end_forcing_ = collect(1.0);
        const T half = T(0.5) * h_, sixth = T(1.0 / 6) * h_;
        const int size = plan_.state_size;
        for (int i = 0; i < size; ++i) stage_[i] = y_[i] + half * k1_[i];
        calc(stage_, middle, 0.5, k2_, end_);
        for (int i = 0; i < size; ++i) stage_[i] = y_[i] + half * k2_[i];
        calc(stage_, middle, 0.5, k3_, end_);
        for (int i = 0; i < size; ++i) stage_[i] = y_[i] + h_ * k3_[i];
        calc(stage_, end_forcing_, 1, k4_, end_);
        for (int i = 0; i < size; ++i) next_[i] = y_[i] + sixth * (k1_[i] + T(2.0) * (k2_[i] + k3_[i]) + k4_[i]);
        normalize(next_);
        guides_.project(next_, end_forcing_);
        calc(next_, end_forcing_, 1, end_rates_, end_);
    }

    void normalize(T* y) const {
        T* e = y + at_quaternion;
        const T factor = reciprocalRoot(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
        for (int i = 0; i < 4; ++i) e[i] = factor * e[i];
    }

    void accept() {
        double parts[lanes];
        const bool kinked = maybeKinked() && findKinks(parts);
        if (kinked) {
            stopAtKinks(parts);
        } else {
            swap(y_, next_);
            swap(k1_, end_rates_);
            swap(start_, end_);
        }
        for (int i = 0; i < plan_.bristle_count; ++i) {
            anchor_[i] = start_.q[plan_.bristles[i].axis];
            stretch_[i] = start_.stretch[i];
            y_[plan_.at_internal + plan_.bristles[i].state] = start_.stretch[i];
        }
        followDirections(kinked);
        for (int l = 0; l < lanes; ++l) {
            if (!active(l)) continue;
            const double part = kinked ? parts[l] : 1.0;
            part_[l] += (1 - part_[l]) * part;
            constexpr double grid_rounding = 1e-9;  // of a step: what is left of it is no step of its own
            if (part == 1 || part_[l] > 1 - grid_rounding) {
                part_[l] = 0;
                kinks_in_step_[l] = 0;
                half_[l] += 2;
            }
        }
    }

    /// @param kinked some lanes have stopped at a kink, which has told theirs
    void followDirections(bool kinked) {
        for (int i = 0; i < plan_.bristle_count; ++i) {
            const T& v = start_.v[plan_.bristles[i].axis];
            const T direction = whereNegative(v, T(-1.0), whereNegative(T(0.0) - v, T(1.0), direction_[i]));
            for (int l = 0; l < lanes; ++l)
                if (!(kinked && at_kink_now_[l])) setLane(direction_[i], l, lane(direction, l));
        }
    }

    /// Cheap test of all lanes: false if none has a kink in this step.
    bool maybeKinked() const {
        T worst = 1.0;
        for (int i = 0; i < plan_.stop_count; ++i) {
            const StopPlace& stop = plan_.stops[i];
            const T* c = kernel_.constants + stop.constants;
            const T sign = T(2.0) * closed_[i] - T(1.0), rate = sign * c[0];
            const T from = sign * calcPenetration(c, start_.q[stop.axis]), v0 = rate * start_.v[stop.axis];
            const T to = sign * calcPenetration(c, end_.q[stop.axis]), v1 = rate * end_.v[stop.axis];
            // A margin that falls at first and rises at last may dip below zero; a parabola's dip is less deep than
            // this.
            const T dip = whereNegative(v0, whereNegative(T(0.0) - v1, from + T(0.5) * h_ * v0, T(1.0)), T(1.0));
            worst = least(worst, least(to, dip));
        }
        for (int i = 0; i < plan_.bristle_count; ++i)
            worst = least(worst, direction_[i] * end_.v[plan_.bristles[i].axis]);
        bool negative = false;
        for (int l = 0; l < lanes; ++l) negative = negative || lane(worst, l) < 0;
        return negative;
    }

    AxisStep<T> axisStep(int axis, int l) const {
        return {lane(start_.q[axis], l), lane(start_.v[axis], l), lane(end_.q[axis], l), lane(end_.v[axis], l),
                lane(h_, l)};
    }
    double stopKink(int i, int l) const {
        const StopPlace& stop = plan_.stops[i];
        const T* c = kernel_.constants + stop.constants;
        return findStopKink(axisStep(stop.axis, l), lane(c[0], l), lane(c[1], l), lane(closed_[i], l) > 0);
    }
    double bristleKink(int i, int l) const {
        const BristlePlace& bristle = plan_.bristles[i];
        return findReversal(axisStep(bristle.axis, l), lane(direction_[i], l),
                            lane(kernel_.constants[bristle.constants + 1], l), lane(start_.stretch[i], l));
    }

    /// @param[out] parts of each lane's step that count: 1 without a kink
    bool findKinks(double* parts) {
        bool any = false;
        for (int l = 0; l < lanes; ++l) {
            parts[l] = 1;
            at_kink_now_[l] = false;
            // Rounding could let a kink return for ever.
            if (!active(l) || kinks_in_step_[l] > 8 + 4 * (plan_.stop_count + plan_.bristle_count)) continue;
            double first = no_kink;
            for (int i = 0; i < plan_.stop_count; ++i) first = earlier(first, stopKink(i, l));
            for (int i = 0; i < plan_.bristle_count; ++i) first = earlier(first, bristleKink(i, l));
            if (first > 1) continue;
            any = true;
            ++kinks_in_step_[l];
            at_kink_now_[l] = true;
            parts[l] = first;
        }
        return any;
    }

    /// The state at the given parts of the step, in the regime that follows there.
    void stopAtKinks(const double* parts) {
        T part = 0.0;
        for (int l = 0; l < lanes; ++l) setLane(part, l, parts[l]);
        const T rest = T(1.0) - part;
        const T of_y0 = (T(1.0) + T(2.0) * part) * rest * rest, of_k0 = part * rest * rest * h_;
        const T of_y1 = part * part * (T(3.0) - T(2.0) * part), of_k1 = T(0.0) - part * part * rest * h_;
        for (int i = 0; i < plan_.state_size; ++i)
            stage_[i] = of_y0 * y_[i] + of_k0 * k1_[i] + of_y1 * next_[i] + of_k1 * end_rates_[i];
        normalize(stage_);
        const Forcing<T> forcing = collect(parts);
        guides_.project(stage_, forcing);
        calc(stage_, forcing, parts[0], k2_, at_kink_);
        changeRegimes(parts);
        swap(y_, stage_);
        swap(k1_, k2_);
        swap(start_, at_kink_);
    }

    /// Of the lanes that stop at a kink: what meets its own there changes over.
    void changeRegimes(const double* parts) {
        constexpr double together = 1e-9;  // of the step
        for (int l = 0; l < lanes; ++l) {
            if (!at_kink_now_[l]) continue;
            for (int i = 0; i < plan_.stop_count; ++i)
                if (stopKink(i, l) <= parts[l] + together) setLane(closed_[i], l, 1 - lane(closed_[i], l));
            for (int i = 0; i < plan_.bristle_count; ++i)
                if (bristleKink(i, l) <= parts[l] + together) setLane(direction_[i], l, -lane(direction_[i], l));
        }
    }

    static double earlier(double a, double b) { return a < b ? a : b; }
    static void swap(T*& a, T*& b) {
        T* const kept = a;
        a = b;
        b = kept;
    }
    static void swap(Ends& a, Ends& b) {
        const Ends kept = a;
        a = b;
        b = kept;
    }

    const MountKernel<T>& kernel_;
    const StepPlan& plan_;
    const DriveReader<T> drive_;
    const Guides& guides_;
    LaneRun* runs_;
    T *y_, *next_, *stage_, *k1_, *k2_, *k3_, *k4_, *end_rates_;
    Ends start_, end_, at_kink_;  // of the step
    T *closed_, *direction_, *anchor_, *stretch_;
    T h_ = 0.0;
    Forcing<T> end_forcing_;
    int half_[lanes] = {}, emitted_[lanes] = {}, kinks_in_step_[lanes] = {};
    bool at_kink_now_[lanes] = {};
    double part_[lanes] = {};  // of the grid's step that is behind
};

}  // namespace wems::identify
